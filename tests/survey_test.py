"""A short run of the survey: survey_test.py JUNCTION_SURVEY VASOHEX QUALITY_TABLE

The tables come out the same for any number of threads, are put between the markers and nowhere else, and stay there
when the rest of the file is written.
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

SURVEY, VASOHEX, QUALITY_TABLE = sys.argv[1:4]
TITLES = ("Random junctions", "Nasty cases", "Named junctions", "Random networks")


def survey(*options):
    return subprocess.run([SURVEY, *options], capture_output=True, text=True)


def figures(path):
    """All but the times."""
    return [{k: v for k, v in row.items() if k != "cpu_seconds"} for row in json.loads(path.read_text())]


class SurveyTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_every_table_is_written_and_kept(self):
        page = self.folder / "quality.md"
        page.write_text("before\n<!-- survey -->\nold\n<!-- /survey -->\nafter\n")
        done = survey("--count", "2", "--orders", "1", "--only", "k3/1", "--only", "k3/2", "--only", "k5/2", "--only",
                      "link 1 r, dumbbell, twist 45", "--only", "Y 120", "--only", "tree/1", "--write", str(page))
        self.assertEqual(done.returncode, 0, done.stderr)
        text = page.read_text()
        self.assertTrue(text.startswith("before\n<!-- survey -->\n## ") and text.endswith("<!-- /survey -->\nafter\n"))
        self.assertNotIn("old", text)
        for title in TITLES:
            self.assertIn(f"### {title}\n", text)
        self.assertIn("| 3 | 1 | 2 | 100.0 % |", text)
        kept = text[text.index("<!-- survey -->"):text.index("<!-- /survey -->")]
        subprocess.run(["/usr/bin/python3", QUALITY_TABLE, VASOHEX, "--only", "no case", "-o", str(page)], check=True)
        self.assertIn("## Inputs of our own", page.read_text())
        self.assertIn(kept, page.read_text())

    def test_same_figures_for_any_number_of_threads(self):
        one, two = self.folder / "1.json", self.folder / "2.json"
        for path in (one, two):
            done = survey("--kinds", "random", "--count", "2", "--orders", "1,3", "--only", "k3/1", "--only", "k4/2",
                          "--threads", path.stem, "--json", str(path))
            self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual([(row["case"], row["order"]) for row in figures(one)],
                         [("k3/1", 1), ("k3/1", 3), ("k4/2", 1), ("k4/2", 3)])
        self.assertEqual(figures(one), figures(two))

    def test_names(self):
        names = survey("--list").stdout.splitlines()
        self.assertEqual(len(names), len(set(names)))
        self.assertIn("k8/50", names)
        self.assertEqual(survey("--only", "k9/1").returncode, 2)
        self.assertEqual(survey("--write", str(self.folder / "none.md"), "--only", "Y 120").returncode, 2)

    def test_mesh_of_one_case(self):
        path = self.folder / "y.vtu"
        self.assertEqual(survey("--only", "Y 120", "--orders", "2", "--vtu", str(path)).returncode, 0)
        self.assertIn(b"scaled_jacobian", path.read_bytes())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
