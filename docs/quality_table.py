#!/usr/bin/python3
"""Meshes every case at every order and writes docs/quality.md; with --large, networks of hundreds of branches instead.

    docs/quality_table.py VASOHEX [--data FOLDER] [--referee SCRIPT] [--only TEXT] [-o docs/quality.md]
    docs/quality_table.py VASOHEX --large [--limit SECONDS] [--data FOLDER] [--only TEXT] [-o docs/large_networks.md]

VASOHEX is the program; FOLDER holds the real vessels (default: $VASOHEX_DATA; without it only meshes/ is run). SCRIPT is
an independent checker of MSH files that prints `key: value` lines (default: $VASOHEX_REFEREE); its figures stand in the
table wherever it is given, ours otherwise; large networks are not shown to it. Runs longer than SECONDS are stopped, and
the table says so. What benchmarks/junction_survey has written between its markers stays.
Needs nothing but Python.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
MESHES = os.path.join(HERE, "..", "meshes")

OWN = ["helix.swc", "iliac_bifurcation.swc", "abdominal_aorta.json", "trifurcation.json", "willis_cycle.json"]
REAL = ["s01_aorta_iliac_vmr0110/aorta.contours.swc",
        "s01_aorta_iliac_vmr0110/demo.derived_skeleton.graph.json",
        "s03_ica_tree/example_centerline_ICA.swc",
        "s06_coronary_721A/721A_Centreline.graph.json",
        "s11_six_branch_junction/bifurcation_Y.axes.graph.json",
        ] + [f"s13_synthaorta/skeleton_{i}.graph.json" for i in (1, 2, 12, 23, 50, 66)]
TREES = [f"s04_brain_arteries_brava/{name}.graph.json"
         for name in ("P1_whole_brain_BraVa", "BG001.CNG", "BG0003.CNG", "BG07.CNG")]
GRAPHS = [f"s05_willis_graphs/{name}_U.graph.json" for name in ("0_7001", "0_E43977", "0_E77626", "0_E90792")] + [
    f"s14_cortical_microvessels/{name}.graph.json"
    for name in ("one_loop", "penetrating_artery", "sample_1", "test_smaller_vasculature")] + [
    "s09_pulmonary_PA000016/PA000016.derived_skeleton.graph.json",
    "s15_brain_mra_seg_2/Subject0002-MRA.derived_skeleton.graph.json"]
COARSE = ["-n", "2"]
LAYERS = ["--layers", "6", "--first-layer", "0.02r", "--growth", "1.3"]
LAYERED = ["iliac_bifurcation.swc", "abdominal_aorta.json", "s13_synthaorta/skeleton_1.graph.json",
           "s13_synthaorta/skeleton_66.graph.json"]

# the referee's figures that must be 0
ZERO = ["non_hex", "open_faces", "overfull_faces", "mismatched_faces", "same_side_faces", "untagged_boundary",
        "stray_or_double_quads", "mismatched_quads", "inward_quads", "orphan_nodes", "duplicate_nodes",
        "duplicate_hexes", "inverted", "bernstein_negative", "bernstein_undecided"]


# benchmarks/junction_survey.cpp knows these too
SURVEY, SURVEY_END = "<!-- survey -->", "<!-- /survey -->"


def survey_of(path):
    """The survey in an older version of the file, markers included."""
    if os.path.exists(path):
        _, begin, rest = open(path).read().partition(SURVEY)
        survey, end, _ = rest.partition(SURVEY_END)
        if begin and end:
            return begin + survey + end
    return f"{SURVEY}\n{SURVEY_END}"


def referee_figures(script, path):
    out = subprocess.run(["/usr/bin/python3", script, path, "--certify", "on"], capture_output=True, text=True)
    if out.returncode != 0:
        sys.exit(f"referee: {out.stderr}")
    figures = {}
    for line in out.stdout.splitlines():
        key, _, value = line.partition(": ")
        try:
            figures[key] = float(value)
        except ValueError:
            pass
    return figures


def run(program, referee, path, order, options, limit):
    with tempfile.TemporaryDirectory() as folder:
        mesh, stats = os.path.join(folder, "m.msh"), os.path.join(folder, "s.json")
        try:
            done = subprocess.run([program, "mesh", path, "-o", mesh, "-p", str(order), "--json", stats, "-q", *options],
                                  capture_output=True, text=True, timeout=limit)
        except subprocess.TimeoutExpired:
            return {"exit": "none", "error": f"not finished in {limit} s"}
        row = {"exit": done.returncode, "error": done.stderr.strip()}
        if os.path.exists(stats):
            row.update(json.load(open(stats)))
            if referee:
                row["referee"] = referee_figures(referee, mesh)
    return row


def table_row(name, order, row):
    if "quality" not in row:
        return f"| {name} | {order} | failed: exit {row['exit']} {row['error']} |" + " |" * 11
    q, v, r = row["quality"], row["validity"], row.get("referee")
    if r:
        linear, curved = (r["sj_linear_min"], r["sj_linear_p1"], r["sj_linear_mean"]), (r["sj_min"], r["sj_mean"])
        faults = [f"{k} {r[k]:g}" for k in ZERO if r.get(k, 0) != 0]
        if r["genus"] != row["loops"]:
            faults.append(f"genus {r['genus']:g}")
        if r["end_patches"] and not r["planarity_max"] < 1e-6:
            faults.append(f"planarity {r['planarity_max']:.1e}")
        verdict = ", ".join(faults) or "0 faults"
    else:
        linear = tuple(q["scaled_jacobian_linear"][k] for k in ("min", "p1", "mean"))
        curved = (q["scaled_jacobian"]["min"], q["scaled_jacobian"]["mean"])
        verdict = "not asked"
    if "layers" in row:
        verdict += f"; first layer kept on {100 * row['layers']['first_kept']:.1f} % of the wall"
    certified = "all" if v["invalid"] + v["undecided"] == 0 else f"{v['invalid']} invalid, {v['undecided']} undecided"
    return (f"| {name} | {order} | {row['elements']:,} | {row['blocks']} | {certified} | {linear[0]:.3f} | {linear[1]:.3f} | "
            f"{linear[2]:.3f} | {curved[0]:.3f} | {curved[1]:.3f} | {row['loops']} | {row['wall_residual_max']:.0e} | "
            f"{row['seconds']['total']:.2f} | {verdict} |")


def failures(name, order, row):
    """One line for each junction or branch that is not certified."""
    return [f"- {name}, order {order}: {f['text']}. Most likely: {f['reason']}" for f in row.get("not_certified", [])]


def main():
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("program")
    ap.add_argument("--data", default=os.environ.get("VASOHEX_DATA"))
    ap.add_argument("--referee", default=os.environ.get("VASOHEX_REFEREE"))
    ap.add_argument("--only", default="")
    ap.add_argument("--large", action="store_true")
    ap.add_argument("--limit", type=int, default=600)
    ap.add_argument("-o", "--output")
    args = ap.parse_args()
    args.output = args.output or os.path.join(HERE, "large_networks.md" if args.large else "quality.md")

    def path(case):
        if case in OWN:
            return os.path.join(MESHES, case)
        return os.path.join(args.data, case) if args.data else None

    head = ("| case | order | hexes | blocks | certified | linear min | linear 1 % | linear mean | order-p min | order-p mean | "
            "loops | wall residual / r | s | referee |\n|" + " --- |" * 14)
    what = ("Two elements per block edge where not said otherwise; below the tables stands whatever is not certified." if
            args.large else "Six elements per block edge. *First layer kept*: its height is within 10 % of what was asked for.")
    lines = ["# Large networks" if args.large else "# Quality of every case", "",
             "Written by `docs/quality_table.py`. Scaled Jacobians: *linear* of the straight-sided hexahedra, minimum over the",
             "8 corners; *order-p* of the curved ones, minimum over (2p+1)^3 points. *Certified*: Bernstein bound of det J.",
             "*s*: wall seconds of the whole program on 2 cores, certificate included. *Referee*: an independent checker of the",
             "MSH file (conformity, tags, orientation, duplicates, certificate, genus = loops, planarity of the ends < 1e-6).",
             what, ""]
    begin = time.time()
    small = (("Inputs of our own", OWN, (1, 2, 3, 5), []), ("Real vessels", REAL, (1, 2, 3), []),
             ("Boundary layers: 6 layers, the first 0.02 r, growth 1.3", LAYERED, (1, 2, 3), LAYERS))
    large = (("Large trees", TREES, (1, 2, 3), COARSE), ("Six elements per block edge", TREES, (1,), []),
             ("Six elements per block edge, curved", TREES, (2, 3), []),
             ("Large graphs with loops, dense and derived skeletons", GRAPHS, (1, 3), COARSE))
    for title, cases, orders, options in large if args.large else small:
        lines += [f"## {title}", "", head]
        failed = []
        for case in cases:
            if path(case) is None or args.only not in case:
                continue
            for order in orders:
                row = run(args.program, None if args.large else args.referee, path(case), order, options,
                          args.limit)
                name = case.rsplit(".graph", 1)[0].rsplit(".", 1)[0] if case in OWN else case.rsplit(".graph", 1)[0]
                lines.append(table_row(name, order, row))
                failed += failures(name, order, row)
                print(f"{time.time() - begin:6.0f} s  {lines[-1]}", flush=True)
        lines += ["", *failed, ""] if failed else [""]
    if not args.large:
        lines += [survey_of(args.output), ""]
    with open(args.output, "w") as f:
        f.write("\n".join(lines))


if __name__ == "__main__":
    main()
