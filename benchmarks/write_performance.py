#!/usr/bin/python3
"""Runs the benchmark `stages` and writes docs/performance.md:  benchmarks/write_performance.py STAGES [-o FILE]"""
import argparse
import json
import os
import subprocess

HERE = os.path.dirname(os.path.abspath(__file__))
NAMES = {"network": "cleaning, splines, resampling",
         "convolution_surface": "convolution surface, calibrated",
         "blocks_and_optimisation": "blocks, junctions optimised, certified",
         "grading_transfinite_projection": "grading, transfinite maps, projection",
         "quality_and_certificate": "quality and certificate of every element",
         "write_msh_file": "MSH 4.1 written",
         "gmsh_transfinite_order_3": "**Gmsh: transfinite + setOrder(3)**"}


def main():
    ap = argparse.ArgumentParser(description=__doc__)
    ap.add_argument("stages")
    ap.add_argument("-o", "--output", default=os.path.join(HERE, "..", "docs", "performance.md"))
    args = ap.parse_args()
    out = subprocess.run([args.stages, "--benchmark_format=json", "--benchmark_repetitions=3",
                          "--benchmark_report_aggregates_only=true"], capture_output=True, text=True, check=True)
    rows = {}
    for b in json.loads(out.stdout)["benchmarks"]:
        if b["aggregate_name"] == "median":
            rows[b["run_name"].split("/")[0]] = b
    lines = ["# Time per stage", "",
             "Written by `benchmarks/write_performance.py`: the abdominal aorta of `meshes/` at order 3, 6 elements per block",
             "edge, one thread, CPU time, median of 3; in the same run Gmsh builds 375 transfinite blocks of as many hexahedra.",
             "", "| stage | CPU s | hexahedra | nodes |", "| --- | --- | --- | --- |"]
    for key, name in NAMES.items():
        r = rows[key]
        counts = [f"{int(r[k]):,}" if k in r else "" for k in ("hexes", "nodes")]
        lines.append(f"| {name} | {r['cpu_time'] / 1e3:.3f} | {counts[0]} | {counts[1]} |")
    ours, gmsh = rows["grading_transfinite_projection"], rows["gmsh_transfinite_order_3"]
    per_node = (gmsh["cpu_time"] / gmsh["nodes"]) / (ours["cpu_time"] / ours["nodes"])
    lines += ["", f"Grading + transfinite maps + projection take **{gmsh['cpu_time'] / ours['cpu_time']:.1f} times less CPU** than "
              f"Gmsh ({per_node:.1f} times per node).", ""]
    with open(args.output, "w") as f:
        f.write("\n".join(lines))
    print("\n".join(lines))


if __name__ == "__main__":
    main()
