#!/usr/bin/python3
"""Error of pressure drop and wall shear stress of a flow against degrees of freedom, for orders 1 to 5.

    docs/hp_study.py VASOHEX_STOKES INPUT OUT.png [--table OUT.md]

Geometry and velocity have the same order (velocity at least 2), each order on meshes of 1, 2, .. elements per block
edge, 50 ml/s for lengths in mm. The reference is the run with the highest order and the most elements, which is not
drawn. Needs Debian's python3-matplotlib.
"""
import argparse
import json
import subprocess
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

RUNS = {1: (1, 2, 3, 4, 6, 8), 2: (1, 2, 3, 4, 6), 3: (1, 2, 3, 4), 4: (1, 2, 3), 5: (1, 2, 3)}
REFERENCE = (5, 4)


def run(program, source, order, elements):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([program, source, "-o", folder, "-p", str(order), "-n", str(elements), "--tolerance", "1e-10",
                        "--flow-rate", "50000"], check=True, stdout=subprocess.DEVNULL)
        with open(f"{folder}/flow.json") as f:
            j = json.load(f)
    inlet = next(e for e in j["ends"] if e["name"] == "inlet")
    return {"order": order, "elements": elements, "dofs": j["dofs"], "iterations": j["iterations"],
            "pressure": inlet["pressure"], "shear": j["wall_shear_stress"]["mean"]}


def main():
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("program")
    ap.add_argument("input")
    ap.add_argument("out")
    ap.add_argument("--table")
    args = ap.parse_args()
    reference = run(args.program, args.input, *REFERENCE)
    print("reference:", reference)
    rows = []
    for order, counts in RUNS.items():
        for elements in counts:
            row = run(args.program, args.input, order, elements)
            for key in ("pressure", "shear"):
                row[key + "_error"] = abs(row[key] / reference[key] - 1)
            rows.append(row)
    figure, axes = plt.subplots(1, 2, figsize=(11, 4.5), sharex=True)
    for axis, key, title in zip(axes, ("pressure", "shear"), ("pressure drop", "mean wall shear stress")):
        for order in RUNS:
            of_order = [r for r in rows if r["order"] == order]
            axis.loglog([r["dofs"] for r in of_order], [r[key + "_error"] for r in of_order], "o-",
                        label=f"order {order}")
        axis.set_title(f"relative error of the {title}")
        axis.set_xlabel("degrees of freedom")
        axis.grid(True, which="major", alpha=0.3)
    axes[0].legend()
    figure.tight_layout()
    figure.savefig(args.out, dpi=110)
    lines = ["| order | elements per block edge | dofs | iterations | pressure drop, Pa | its error | error of mean "
             "shear stress |",
             "| --- | --- | --- | --- | --- | --- | --- |"]
    lines += [f"| {r['order']} | {r['elements']} | {r['dofs']} | {r['iterations']} | {r['pressure']:.5f} | "
              f"{r['pressure_error']:.1e} | {r['shear_error']:.1e} |" for r in rows]
    text = "\n".join(lines) + "\n"
    if args.table:
        with open(args.table, "w") as f:
            f.write(text)
    print(text, end="")


if __name__ == "__main__":
    main()
