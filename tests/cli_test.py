"""Drives the program as a user would: cli_test.py VASOHEX MESHES HAS_GMSH(0|1)"""
import json
import math
import pathlib
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM, MESHES = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
HAS_GMSH = sys.argv[3] == "1"
HELIX, ILIAC = str(MESHES / "helix.swc"), str(MESHES / "iliac_bifurcation.swc")

SWC = "1 0 0 0 0 1 -1\n2 0 0 0 5 1 1\n3 0 0 0 10 1 2\n"
JSON = ('{"format": "vascular-graph-1", "points": [[0, 0, 0], [0, 0, 5], [0, 0, 10]], "radius": [1, 1, 1], '
        '"branches": [[0, 1, 2]]}')

# two tubes that cross: axes 0.9 apart, radii 1 and 0.5
CROSSING = ('{"format": "vascular-graph-1", "units": "mm", "points": ['
            + ", ".join(f"[{x}, 0, 0]" for x in range(-9, 10)) + ", "
            + ", ".join(f"[0, {y}, 0.9]" for y in range(-9, 10)) + '], "radius": ['
            + ", ".join(["1"] * 19 + ["0.5"] * 19) + '], "branches": ['
            + str(list(range(19))) + ", " + str(list(range(19, 38))) + "]}")

# what is wrong, name of the file, its text (None: there is none), what the message must name
BAD_INPUTS = (
    ("empty file", "a.swc", "", ["a.swc"]),
    ("empty file", "a.json", "", ["a.json", "line 1"]),
    ("radius 0", "a.swc", SWC.replace("5 1 1", "5 0 1"), ["a.swc", "line 2", "radius 0", "must be > 0"]),
    ("radius 0", "a.json", JSON.replace("[1, 1, 1]", "[1, 0, 1]"), ["a.json", "radius[1]", "must be > 0"]),
    ("radius < 0", "a.swc", SWC.replace("5 1 1", "5 -0.3 1"), ["a.swc", "line 2", "-0.3", "must be > 0"]),
    ("radius < 0", "a.json", JSON.replace("[1, 1, 1]", "[1, 1, -2]"), ["a.json", "radius[2]", "must be > 0"]),
    ("NaN", "a.swc", SWC.replace("0 5 1", "nan 5 1"), ["a.swc", "line 2", "nan", "must be a finite number"]),
    ("NaN", "a.json", JSON.replace("[0, 0, 5]", "[0, 0, NaN]"), ["a.json", "line 1"]),
    ("missing parent", "a.swc", SWC.replace("5 1 1", "5 1 9"), ["a.swc", "line 2", "parent 9", "must be"]),
    ("duplicate id", "a.swc", SWC.replace("3 0 0 0 10", "1 0 0 0 10"), ["a.swc", "line 3", "line 1"]),
    ("no such point", "a.json", JSON.replace("[0, 1, 2]]", "[0, 1, 3]]"), ["a.json", "branches[0][2]", "0 to 2"]),
    ("two columns", "a.swc", "1 2\n", ["a.swc", "line 1", "7"]),
    ("a cycle", "a.swc", SWC.replace("0 1 -1", "0 1 3"), ["a.swc", "line", "JSON"]),
    ("unknown extension", "a.xyz", SWC, ["a.xyz", ".swc", ".json"]),
    ("missing file", "none.swc", None, ["none.swc", "exists"]),
)

# further arguments of `vasohex mesh helix.swc`, what the message must name; -o out.msh is added where there is no -o
BAD_ARGUMENTS = (
    (["-o", "out.xyz"], ["out.xyz", ".msh", ".vtu"]),
    (["-o", "nowhere/out.msh"], ["nowhere/out.msh", "no folder nowhere"]),
    (["-o", "."], [".msh"]),
    (["-o", "out.msh", "-o", "./out.msh"], ["out.msh", "twice"]),
    (["-o", "out.msh", "--json", "out.msh"], ["out.msh", "twice"]),
    (["--json", HELIX], [HELIX, "the input"]),
    (["--json", "nowhere/out.json"], ["nowhere/out.json"]),
    (["--order", "0"], ["--order", ">= 1"]),
    (["--order", "2.5"], ["--order", "2.5", ">= 1"]),
    (["--order", "10"], ["out.msh", "order 10", "at most 9"]),
    (["--order", "11", "-o", "out.vtu"], ["out.vtu", "order 11", "at most 10"]),
    (["--order", "3", "--nodes", "gauss_lobatto"], ["out.msh", "equispaced"]),
    (["--nodes", "chebyshev"], ["--nodes", "chebyshev", "equispaced"]),
    (["--elements", "0"], ["--elements", ">= 1"]),
    (["--elements"], ["--elements"]),
    (["--radial", "many"], ["--radial", "many", ">= 1"]),
    (["--units", "km"], ["--units", "km", "mm"]),
    (["--inlet", "-1"], ["--inlet", ">= 0"]),
    (["--inlet", "7"], [HELIX, "point 7", "end"]),
    (["--inlet", "1000"], [HELIX, "1000", "0 to 52"]),
    (["--threads", "-2"], ["--threads", ">= 0"]),
    (["--block-length", "nan"], ["--block-length", "> 0"]),
    (["--layers", "6", "--radial", "5"], [HELIX, "radial.1", "at least 7"]),
    (["--layers", "3", "--first-layer", "abc"], ["--first-layer", "abc", "0.02r"]),
    (["--layers", "3", "--first-layer", "0"], ["--first-layer", "0", "0.02r"]),
    (["--layers", "3", "--first-layer", "inf"], ["--first-layer", "inf", "0.02r"]),
    (["--layers", "3", "--growth", "0"], ["--growth", "> 0"]),
    (["--first-layer", "abc"], ["--first-layer", "--layers"]),
    (["--growth", "2"], ["--growth", "--layers"]),
    (["--sheet", "nosuch=3"], [HELIX, "nosuch", "sheets run from"]),
    (["--sheet", "axial.1"], ["axial.1", "NAME=COUNT"]),
    (["--sheet", "axial.1=3", "--sheet", "axial.1=4"], [HELIX, "axial.1", "3 and 4"]),
    (["--sheet", "axial.1=0"], ["axial.1", "at least 1"]),
    (["--nosuch"], ["--nosuch", "vasohex mesh --help"]),
    (["--config", "nowhere.toml"], ["nowhere.toml"]),
)


def tube_off(around=24, rows=40, length=10.0):
    """A tube of radius 1 along z as OFF, outward quadrilaterals, closed by flat caps."""
    points = [(math.cos(2 * math.pi * i / around), math.sin(2 * math.pi * i / around), length * row / rows)
              for row in range(rows + 1) for i in range(around)] + [(0, 0, 0), (0, 0, length)]
    faces = [(row * around + i, row * around + (i + 1) % around, (row + 1) * around + (i + 1) % around,
              (row + 1) * around + i) for row in range(rows) for i in range(around)]
    top = rows * around
    faces += [((i + 1) % around, i, len(points) - 2) for i in range(around)]
    faces += [(top + i, top + (i + 1) % around, len(points) - 1) for i in range(around)]
    return "\n".join(["OFF", f"{len(points)} {len(faces)} 0", *(f"{x} {y} {z}" for x, y, z in points),
                      *(" ".join(map(str, (len(face), *face))) for face in faces)]) + "\n"


def vasohex(*arguments, cwd=None):
    return subprocess.run([PROGRAM, *map(str, arguments)], cwd=cwd, capture_output=True, text=True, timeout=120)


def displaced(msh):
    """The bytes of an MSH 4.1 file of ours, its first node moved by the diameter of the mesh."""
    start = msh.index(b"$Nodes\n") + len(b"$Nodes\n")
    _, count, _, _ = struct.unpack_from("<4Q", msh, start)
    coordinates = start + 4 * 8 + 3 * 4 + 8 + 8 * count
    x, y, z = struct.unpack_from("<3d", msh, coordinates)
    values = struct.unpack_from(f"<{3 * count}d", msh, coordinates)
    return (msh[:coordinates] + struct.pack("<3d", x + max(values) - min(values), y, z) + msh[coordinates + 24:])


class Cli(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def files(self):
        return {path.name: path.read_bytes() for path in self.folder.iterdir()}

    def run_well(self, *arguments, code=0):
        result = vasohex(*arguments, cwd=self.folder)
        self.assertEqual((result.returncode, result.stderr), (code, ""), arguments)
        return result.stdout

    def check_refused(self, arguments, named):
        """Exit code 2, one line that names what matters, and the folder as it was."""
        before = self.files()
        result = vasohex(*arguments, cwd=self.folder)
        self.assertEqual(result.returncode, 2, result)
        self.assertEqual(result.stdout, "")
        self.assertRegex(result.stderr, r"\Avasohex: [^\n]+\n\Z")
        for part in named:
            self.assertIn(part, result.stderr)
        self.assertEqual(self.files(), before)

    def test_bad_inputs(self):
        (self.folder / "out.msh").write_text("older")
        (self.folder / "out.vtu").write_text("older")
        for wrong, name, text, named in BAD_INPUTS:
            if text is not None:
                (self.folder / name).write_text(text)
            for arguments in (["mesh", name, "-o", "out.msh", "--json", "out.json"], ["info", name, "--json", "i.json"],
                              ["blocks", name, "-o", "out.vtu", "-o", "b.json"]):
                with self.subTest(wrong, command=arguments[0]):
                    self.check_refused(arguments, named)

    def test_good_forms_of_the_bad_inputs(self):
        for name, text in (("a.swc", SWC), ("a.json", JSON)):
            (self.folder / name).write_text(text)
            self.run_well("mesh", name, "-o", "out.msh", "--elements", "1")

    def test_bad_arguments(self):
        (self.folder / "out.msh").write_text("older")
        for arguments, named in BAD_ARGUMENTS:
            with self.subTest(" ".join(arguments)):
                output = [] if "-o" in arguments else ["-o", "out.msh"]
                self.check_refused(["mesh", HELIX, *output, *arguments], named)

    def test_usage(self):
        for arguments, named in (([], ["vasohex --help"]), (["mend"], ["mend", "mesh", "check", "info", "blocks"]),
                                 (["mesh"], ["INPUT", "vasohex mesh --help"]), (["mesh", HELIX], ["-o"]),
                                 (["blocks", HELIX], ["-o"]), (["blocks", HELIX, "-o", "b.msh"], ["b.msh", ".vtu"]),
                                 (["info", HELIX, HELIX], [HELIX]), (["check"], ["MESH"]),
                                 (["check", "none.msh"], ["none.msh"])):
            with self.subTest(" ".join(arguments)):
                self.check_refused(arguments, named)

    def test_interrupted(self):
        for command, stop in ((["mesh", ILIAC, "-o", "a.msh", "-n", "40", "-p", "4"], signal.SIGINT),
                              (["mesh", ILIAC, "-o", "a.vtu", "-n", "40", "-p", "4", "-q"], signal.SIGTERM)):
            with self.subTest(command), subprocess.Popen([PROGRAM, *command], cwd=self.folder, text=True,
                                                         stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
                time.sleep(0.3)
                process.send_signal(stop)
                _, said = process.communicate(timeout=120)
                self.assertEqual(process.returncode, 128 + stop)
                self.assertRegex(said, r"\Avasohex: [^\n]*cancelled[^\n]*\n\Z")
                self.assertEqual(self.files(), {})

    def test_output_that_cannot_be_replaced(self):
        (self.folder / "out.msh").mkdir()
        result = vasohex("mesh", HELIX, "-o", "out.msh", cwd=self.folder)
        self.assertEqual(result.returncode, 2, result)
        self.assertRegex(result.stderr, r"\Avasohex: [^\n]*out\.msh[^\n]*folder[^\n]*\n\Z")
        self.assertEqual([p.name for p in self.folder.iterdir()], ["out.msh"])

    def test_orders(self):
        for order in (1, 2, 3):
            out = self.run_well("mesh", ILIAC, "-o", "a.msh", "-o", "a.vtu", "--json", "a.json", "-p", order, "-n", 2)
            self.assertIn(f"hexahedra of order {order}", out)
            self.assertEqual(set(self.files()), {"a.msh", "a.vtu", "a.json"})
            figures = json.loads((self.folder / "a.json").read_text())
            self.assertEqual((figures["order"], figures["elements"]), (order, figures["blocks"] * 8))
            self.assertEqual(figures["validity"]["certified"], figures["elements"])
            self.assertEqual((figures["validity"]["invalid"], figures["validity"]["undecided"]), (0, 0))
            self.assertEqual((figures["components"], figures["loops"], figures["units"]), (1, 0, "mm"))

    def test_figures(self):
        self.run_well("mesh", ILIAC, "-o", "a.msh", "--json", "a.json", "-p", 2, "-n", 2)
        figures = json.loads((self.folder / "a.json").read_text())
        self.assertLessEqual({"blocks", "elements", "nodes", "order", "components", "junctions", "quality", "validity",
                              "wall_residual_max", "repairs", "seconds"}, set(figures))
        self.assertEqual(len(figures["junctions"]), 1)
        junction = figures["junctions"][0]
        self.assertLessEqual({"node", "degree", "prototype", "sj_min"}, set(junction))
        self.assertEqual((junction["node"], junction["degree"]), (7, 3))
        quality = figures["quality"]
        for measure in ("scaled_jacobian", "scaled_jacobian_linear"):
            self.assertEqual(set(quality[measure]), {"min", "p1", "mean"})
            self.assertTrue(0 < quality[measure]["min"] <= quality[measure]["p1"] <= quality[measure]["mean"] <= 1)
        self.assertEqual(set(quality["skewness"]), {"max", "p99", "mean"})
        self.assertEqual(set(figures["validity"]), {"certified", "invalid", "undecided", "bound_min"})
        self.assertGreater(figures["validity"]["bound_min"], 0)
        self.assertTrue(0 <= figures["wall_residual_max"] < 1e-6)
        self.assertEqual(set(figures["seconds"]),
                         {"read", "surface", "blocks", "optimise", "mesh", "certify", "write", "total"})
        self.assertEqual([s["name"] for s in figures["surfaces"]], ["wall", "inlet", "outlet_1", "outlet_2"])
        self.assertEqual([s["id"] for s in figures["surfaces"]], [1, 2, 3, 4])
        self.assertEqual(figures["volumes"], [{"name": "lumen", "id": 5}])

    def test_same_bytes_for_any_number_of_threads(self):
        for threads in (1, 2, 3):
            self.run_well("mesh", ILIAC, "-o", f"{threads}.msh", "-o", f"{threads}.vtu", "-p", 3, "-n", 3,
                          "--layers", 2, "--threads", threads, "--quiet")
        for extension in ("msh", "vtu"):
            one, two, three = ((self.folder / f"{threads}.{extension}").read_bytes() for threads in (1, 2, 3))
            self.assertTrue(one == two == three, extension)

    def test_units_and_inlet(self):
        self.run_well("mesh", HELIX, "-o", "a.msh", "--json", "a.json", "--units", "cm", "--inlet", 52, "-n", 1)
        figures = json.loads((self.folder / "a.json").read_text())
        self.assertEqual(figures["units"], "cm")
        inlet = figures["surfaces"][1]
        self.assertEqual(inlet["name"], "inlet")
        self.assertAlmostEqual(inlet["centre"][2], 12, places=2)  # two turns of rise 6

    def test_counts(self):
        self.run_well("mesh", HELIX, "-o", "a.msh", "--json", "a.json", "--radial", 4, "--core", 3, "--axial", 1)
        figures = json.loads((self.folder / "a.json").read_text())
        sections = figures["blocks"] // 5
        self.assertEqual(figures["elements"], sections * (3 * 3 + 4 * 3 * 4))
        self.run_well("mesh", HELIX, "-o", "a.msh", "--json", "b.json", "-n", 2, "--sheet", "axial.1=5")
        more = json.loads((self.folder / "b.json").read_text())
        self.assertEqual(more["elements"], (sections * 2 + 3) * (2 * 2 + 4 * 2 * 2))

    def check_with_gmsh(self):
        self.run_well("mesh", ILIAC, "-o", "a.msh", "--json", "a.json", "-p", 2, "-n", 2)
        self.assertIn("invalid 0", self.run_well("check", "a.msh", "--json", "b.json"))
        made, read = (json.loads((self.folder / name).read_text()) for name in ("a.json", "b.json"))
        self.assertEqual(made["validity"], read["validity"])
        self.assertEqual(made["quality"], read["quality"])
        self.assertEqual(read["surfaces"], ["wall", "inlet", "outlet_1", "outlet_2"])
        (self.folder / "bent.msh").write_bytes(displaced((self.folder / "a.msh").read_bytes()))
        self.assertRegex(self.run_well("check", "bent.msh", "--json", "c.json", code=3), r"invalid [1-9]")
        figures = json.loads((self.folder / "c.json").read_text())
        self.assertGreater(figures["validity"]["invalid"], 0)
        self.assertLess(figures["worst"][0]["scaled_jacobian"], 0)
        before = self.files()
        self.check_refused(["check", "a.json"], ["a.json", ".msh"])
        self.check_refused(["check", "a.msh", "--json", "a.msh"], ["a.msh", "the input"])
        self.assertEqual(self.files(), before)

    def check_without_gmsh(self):
        self.run_well("mesh", HELIX, "-o", "a.msh", "-n", 1)
        self.check_refused(["check", "a.msh"], ["a.msh", "-DVASOHEX_GMSH=ON"])

    test_check = check_with_gmsh if HAS_GMSH else check_without_gmsh

    def test_info(self):
        out = self.run_well("info", ILIAC, "--json", "a.json")
        for part in ("25 points, 3 branches, 1 component(s), 0 loop(s), unit mm", "1 junction(s) of 3 branches",
                     "end inlet", "end outlet_1", "end outlet_2"):
            self.assertIn(part, out)
        figures = json.loads((self.folder / "a.json").read_text())
        self.assertEqual((figures["points"], figures["branches"], figures["loops"]), (25, 3, 0))
        self.assertEqual(figures["junctions_by_degree"], {"3": 1})
        self.assertEqual([end["name"] for end in figures["ends"]], ["inlet", "outlet_1", "outlet_2"])
        out = self.run_well("info", MESHES / "willis_cycle.json")
        self.assertIn("1 component(s), 1 loop(s)", out)

    def test_lumen(self):
        (self.folder / "tube.off").write_text(tube_off())
        text = self.run_well("mesh", "tube.off", "-o", "out.msh", "--order", "2", "-n", "2", "--json", "out.json",
                             "--units", "mm")
        self.assertIn("flat cap", text)
        figures = json.loads((self.folder / "out.json").read_text())
        self.assertEqual(figures["lumen"]["ends"], 2)
        self.assertLess(figures["lumen"]["deviation"]["max"], 0.02)
        self.assertEqual([s["name"] for s in figures["surfaces"]], ["wall", "inlet", "outlet_1"])
        self.assertEqual((figures["validity"]["invalid"], figures["unconverged_projections"]), (0, 0))
        self.assertGreater(figures["quality"]["scaled_jacobian"]["min"], 0.75)
        self.assertEqual(figures["lumen"]["winding_number"], {"points": 200, "contradictions": 0})
        self.assertEqual((figures["wall_relaxed"]["nodes"], figures["reach"]["unreached"]), (0, []))
        self.assertTrue(figures["reach"]["points"] > 1000 and figures["reach"]["max"] < 0.02)
        self.run_well("skeleton", "tube.off", "-o", "tube.swc", "-o", "tube.json", "-o", "tube.vtp")
        skeleton = json.loads((self.folder / "tube.json").read_text())
        for (x, y, z), radius in zip(skeleton["points"], skeleton["radius"]):
            self.assertLess(math.hypot(x, y), 0.05)
            self.assertAlmostEqual(radius, 1, delta=0.03)
        self.assertEqual(sorted(round(z, 6) for _, _, z in skeleton["points"])[::len(skeleton["points"]) - 1], [0, 10])
        # linear elements by default, smaller than curved ones
        for order, elements in ((1, 10), (2, 6)):
            self.run_well("mesh", "tube.off", "-o", "out.msh", "--order", order, "--json", "out.json")
            figures = json.loads((self.folder / "out.json").read_text())
            self.assertEqual(figures["elements"], figures["blocks"] * elements**3)
        # one given for the other, and facets
        self.run_well("mesh", "tube.swc", "--surface", "tube.off", "-o", "out.msh", "-n", "2")
        self.run_well("mesh", "tube.off", "--skeleton", "tube.json", "--facets", "-o", "out.msh", "-n", "2")

    def test_dirty_lumens(self):
        """Repaired, and each repair is told with its place."""
        tube = tube_off().splitlines()
        points, faces = int(tube[1].split()[0]), int(tube[1].split()[1])
        first = 2 + points  # line of the first face

        def dirty(change):
            lines = list(tube)
            change(lines)
            lines[1] = f"{sum(len(line.split()) == 3 for line in lines[2:])} {len(lines) - 2 - points} 0"
            return "\n".join(lines) + "\n"

        def flip(lines):
            for i in range(300, 310):
                count, *corners = lines[first + i].split()
                lines[first + i] = " ".join([count, *corners[::-1]])

        for wrong, text, named, lumens in (
                ("a hole", dirty(lambda lines: lines.pop(first + 300)), r"hole of 4 edges in the wall closed.*\(", 1),
                ("flipped", dirty(flip), r"turned", 1),
                ("two shells", "\n".join(["OFF", f"{2 * points} {2 * faces} 0", *tube[2:first],
                                          *(" ".join([str(float(line.split()[0]) + 5), *line.split()[1:]])
                                            for line in tube[2:first]), *tube[first:],
                                          *(" ".join([line.split()[0], *(str(int(c) + points) for c in line.split()[1:])])
                                            for line in tube[first:])]) + "\n", r"2 component\(s\)", 2)):
            with self.subTest(wrong):
                (self.folder / "a.off").write_text(text)
                out = self.run_well("mesh", "a.off", "-o", "out.msh", "-n", 2, "-p", 2, "--json", "a.json")
                self.assertRegex(out, named)
                figures = json.loads((self.folder / "a.json").read_text())
                self.assertEqual((figures["components"], figures["validity"]["invalid"]), (lumens, 0))
                self.assertEqual(figures["lumen"]["winding_number"]["contradictions"], 0)

    def test_bad_lumens(self):
        tube = tube_off()
        for wrong, name, text, named in (
                ("empty", "a.off", "", ["a.off"]), ("empty", "a.stl", "", ["a.stl"]),
                ("not a number", "a.off", tube.replace("1.0 0.0 0.0", "1.0 nan 0.0", 1), ["a.off", "line 3", "nan"]),
                ("cut off", "a.off", tube[:len(tube) // 2], ["a.off"]),
                ("no such point", "a.off", tube.replace("4 0 1 25 24", "4 0 1 25 9999"), ["a.off", "9999"]),
                ("empty", "a.nii", "", ["a.nii"]), ("missing", "none.stl", None, ["none.stl"])):
            if text is not None:
                (self.folder / name).write_text(text)
            for command, output in (("mesh", "out.msh"), ("skeleton", "out.json")):
                with self.subTest(wrong, file=name, command=command):
                    self.check_refused([command, name, "-o", output], named)
        (self.folder / "tube.off").write_text(tube)
        (self.folder / "a.swc").write_text(SWC)
        for arguments, named in ((["a.swc", "--skeleton", "a.swc"], ["--skeleton", "--surface"]),
                                 (["tube.off", "--surface", "tube.off"], ["--surface", "--skeleton"]),
                                 (["a.swc", "--surface", "a.swc"], ["--surface", "not a lumen"]),
                                 (["tube.off", "--labels", "1"], ["--labels", "no labelmap"]),
                                 (["a.swc", "--facets"], ["--facets"])):
            with self.subTest(" ".join(arguments)):
                self.check_refused(["mesh", *arguments, "-o", "out.msh"], named)

    def test_findings(self):
        (self.folder / "a.json").write_text(CROSSING)
        out = self.run_well("info", "a.json", "--json", "i.json")
        self.assertIn("1 place where vessels overlap:", out)
        self.assertIn("error: the vessels from point 0 to point 18 and from point 19 to point 37 overlap by 1.2", out)
        self.assertIn("what helps: ", out)
        finding, = json.loads((self.folder / "i.json").read_text())["findings"]
        self.assertEqual((finding["kind"], finding["severity"], finding["branches"]), ("overlap", "error", [0, 1]))
        self.assertAlmostEqual(finding["figure"], 1.2, places=3)
        self.assertAlmostEqual(finding["at"][2], 0.6, places=3)
        self.assertLessEqual({"text", "cure"}, set(finding))
        self.assertNotIn("overlap", self.run_well("info", HELIX))
        for command, arguments in (("mesh", ["-n", 1]), ("blocks", [])):
            with self.subTest(command):
                result = vasohex(command, "a.json", "-o", "o.vtu", *arguments, cwd=self.folder)
                self.assertRegex(result.stderr, r"\A1 place where vessels overlap; [^\n]*their meshes overlap there; "
                                 r"see vasohex info, or use --repair\n\Z")
                self.assertNotIn("thinner", result.stdout)
                self.assertEqual(vasohex(command, "a.json", "-o", "o.vtu", "-q", *arguments, cwd=self.folder).stderr, "")
                self.assertIn("thinner there by up to 4", self.run_well(command, "a.json", "-o", "o.vtu", "--repair",
                                                                       *arguments))
        self.run_well("mesh", "a.json", "-o", "o.vtu", "-n", 1, "--repair", "--json", "m.json")
        figures = json.loads((self.folder / "m.json").read_text())
        self.assertEqual(figures["findings"], [])
        self.assertEqual(figures["not_certified"], [])
        self.assertEqual(sum("thinner" in line for line in figures["repairs"]), 1)
        self.assertEqual(figures["validity"]["certified"], figures["elements"])

    def test_blocks(self):
        out = self.run_well("blocks", ILIAC, "-o", "a.vtu", "-o", "a.json")
        figures = json.loads((self.folder / "a.json").read_text())
        count = len(figures["blocks"])
        self.assertIn(f"{count} blocks of degree {figures['degree']}, {count} certified", out)
        per_block = (figures["degree"] + 1) ** 3
        used = set()
        for block in figures["blocks"]:
            self.assertEqual((len(block["vertices"]), len(block["nodes"]), len(block["directions"])), (8, per_block, 3))
            used.update(block["nodes"])
        self.assertEqual(used, set(range(len(figures["nodes"]))))
        self.assertEqual(figures["surfaces"], ["wall", "inlet", "outlet_1", "outlet_2"])
        self.assertIn(figures["sheets"][0], out)
        vtu = (self.folder / "a.vtu").read_bytes()
        self.assertIn(f'NumberOfCells="{count}"'.encode(), vtu)

    def test_quiet(self):
        self.assertEqual(self.run_well("mesh", HELIX, "-o", "a.msh", "-n", 1, "--quiet"), "")

    def test_version(self):
        self.assertRegex(self.run_well("--version"), r"\A\d+\.\d+\.\d+\n\Z")

    def test_config(self):
        flags = ["-p", "2", "-n", "3", "--layers", "1", "--growth", "1.5", "--sheet", "axial.1=2", "--sheet",
                 "axial.2=4", "--quiet"]
        self.run_well("mesh", HELIX, "-o", "flags.msh", *flags)
        (self.folder / "a.toml").write_text('# a comment\norder = 2\nelements=3\nlayers = 1\ngrowth = 1.5\n'
                                            'sheet = ["axial.1=2", "axial.2=4"]\noutput = "file.msh"\nquiet = true\n')
        self.assertEqual(self.run_well("mesh", HELIX, "--config", "a.toml"), "")
        files = self.files()
        self.assertEqual(files["flags.msh"], files["file.msh"])
        self.run_well("mesh", HELIX, "--config", "a.toml", "-p", "1", "--json", "a.json")  # the command line wins
        self.assertEqual(json.loads((self.folder / "a.json").read_text())["order"], 1)
        for text, named in (("ordre = 2\n", ["ordre", "--help"]), ("order = x\n", ["--order", ">= 1"]),
                            ("order\n", ["--order"]), ("", ["empty"]), ("[mesh]\norder = 2\n", ["[mesh]"]),
                            ("quiet = maybe\n", ["quiet"]), ("config = b.toml\n", ["config"])):
            with self.subTest(text):
                (self.folder / "b.toml").write_text(text)
                self.check_refused(["mesh", HELIX, "-o", "out.msh", "--config", "b.toml"], ["b.toml", *named])


unittest.main(argv=sys.argv[:1], verbosity=2)
