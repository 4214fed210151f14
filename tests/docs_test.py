"""README.md and docs/cli.md against the program: docs_test.py VASOHEX SOURCE [--write]

Every command in README.md prints what stands there (decimal numbers may differ), the C++ example is
tests/consumer/main.cpp, the one in docs/dealii.md is tests/consumer/lumen_volume.cpp, and docs/cli.md has just the
options of each --help and the keys of each JSON file.
--write puts today's output and example into README.md.
"""
import itertools
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

PROGRAM, SOURCE = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
README = SOURCE / "README.md"
CONSOLE = re.compile(r"```console\n(.*?)```", re.S)
EXAMPLE = re.compile(r"```cpp\n(.*?)```", re.S)


def vasohex(folder, *arguments):
    return subprocess.run([PROGRAM, *arguments], cwd=folder, capture_output=True, text=True, timeout=300,
                          check=True).stdout


def session(folder, text):
    """A console block with the output that its commands print now."""
    commands = re.findall(r"^\$ vasohex (.*)$", text, re.M)
    assert commands, f"no command in {text}"
    return "".join(f"$ vasohex {command}\n{vasohex(folder, *command.split())}" for command in commands)


def today(folder):
    """README.md as it would have to be."""
    (folder / "meshes").symlink_to(SOURCE / "meshes")
    text = CONSOLE.sub(lambda block: f"```console\n{session(folder, block.group(1))}```", README.read_text())
    return EXAMPLE.sub(lambda _: f"```cpp\n{(SOURCE / 'tests/consumer/main.cpp').read_text()}```", text)


def without_decimals(text):
    return re.sub(r"-?\d+\.\d+(e-?\d+)?", "#", re.sub(r" +", " ", text))


def section(title):
    text = (SOURCE / "docs" / "cli.md").read_text()
    return re.search(rf"^## {title}\n(.*?)(?=^## |\Z)", text, re.S | re.M).group(1)


def first_column(text):
    return re.findall(r"^\| `([^|]*)` \|", text, re.M)


def expanded(path):
    """a.{b,c} as a.b, a.c."""
    parts = [part.split(",") for part in re.split(r"[{}]", path)]
    return {"".join(choice) for choice in itertools.product(*parts)}


def keys(value, path=""):
    if isinstance(value, dict):
        return {key for name, child in value.items()
                for key in keys(child, f"{path}.{'N' if name.isdigit() else name}".lstrip("."))}
    if isinstance(value, list) and (not value or isinstance(value[0], dict)):
        return {key for child in value for key in keys(child, path + "[]")}
    return {path}


class Docs(unittest.TestCase):
    maxDiff = None

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def test_readme(self):
        text = README.read_text()
        self.assertGreaterEqual(len(CONSOLE.findall(text)), 3)
        self.assertEqual(len(EXAMPLE.findall(text)), 1)
        self.assertEqual(without_decimals(text), without_decimals(today(self.folder)), "see docs_test.py --write")

    def test_dealii(self):
        example, = EXAMPLE.findall((SOURCE / "docs" / "dealii.md").read_text())
        self.assertEqual(example, (SOURCE / "tests/consumer/lumen_volume.cpp").read_text())

    def test_options(self):
        for command in ("mesh", "check", "info", "skeleton", "blocks"):
            rows = first_column(section(f"vasohex {command}") + section("Options of every command"))
            written = {option for row in rows for option in re.findall(r"(?<![\w-])--?[a-z][a-z-]*", row)}
            shown = re.findall(r"^  (-\S+)", vasohex(self.folder, command, "--help"), re.M)
            self.assertEqual({option for names in shown for option in names.split(",")}, written, command)

    def test_json_keys(self):
        written = {}
        for command in ("mesh", "check", "info", "blocks"):
            rows = first_column(section(f"JSON of vasohex {command}"))
            written[command] = set().union(*(expanded(row) for row in rows))
        made = {command: set() for command in written}
        stub = self.folder / "stub.swc"  # something to find: a side branch that ends inside its parent
        stub.write_text("1 0 0 0 -5 1 -1\n2 0 0 0 0 1 1\n3 0 0 0 5 1 2\n4 0 0 0.6 0 0.3 2\n")
        meshes = SOURCE / "meshes"
        for skeleton in map(str, (meshes / "helix.swc", meshes / "trifurcation.json", stub)):
            for command, arguments in (("mesh", [skeleton, "-o", "a.msh", "--layers", "1", "--json"]),
                                       ("check", ["a.msh", "--json"]), ("info", [skeleton, "--json"]),
                                       ("blocks", [skeleton, "-o"])):
                vasohex(self.folder, command, *arguments, "a.json")
                made[command] |= keys(json.loads((self.folder / "a.json").read_text()))
        for command in made:
            self.assertEqual(made[command], written[command], command)


if "--write" in sys.argv:
    with tempfile.TemporaryDirectory() as scratch:
        README.write_text(today(pathlib.Path(scratch)))
else:
    unittest.main(argv=sys.argv[:1], verbosity=2)
