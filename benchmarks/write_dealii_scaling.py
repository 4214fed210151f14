#!/usr/bin/python3
"""Runs dealii_scaling on 1, 2 and 4 ranks and writes a table:  write_dealii_scaling.py PROGRAM BLOCKS.json [-o FILE]"""
import argparse
import json
import os
import subprocess

HERE = os.path.dirname(os.path.abspath(__file__))
ORDER = 2
HEADER = "| ranks | cells | most cells of a rank | CPU s | CPU s per 1000 own cells | peak MB |"
#        title, way, N for 1, 2, 4 ranks
SERIES = [("Strong, p4est, blocks refined twice", "forest", (2, 2, 2)),
          ("Strong, fully distributed, 4 elements per block edge", "parts", (4, 4, 4)),
          ("The same, but every rank makes the whole mesh", "whole", (4, 4, 4)),
          ("Weak, fully distributed, 3, 4, 5 elements per block edge", "parts", (3, 4, 5))]


def run(program, blocks, way, ranks, n):
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                       OMPI_MCA_rmaps_base_oversubscribe="1")
    out = subprocess.run(["mpirun", "-n", str(ranks), program, way, blocks, str(ORDER), str(n)], env=environment,
                         capture_output=True, text=True, check=True).stdout
    return json.loads(out.strip().splitlines()[-1])


def main():
    ap = argparse.ArgumentParser(description=__doc__)
    ap.add_argument("program")
    ap.add_argument("blocks")
    ap.add_argument("-o", "--output", default=os.path.join(HERE, "..", "docs", "dealii_scaling.md"))
    args = ap.parse_args()
    size = os.path.getsize(args.blocks) / 1e6
    lines = ["# Making grids on several ranks", "",
             f"Written by `benchmarks/write_dealii_scaling.py`: block file of the abdominal aorta of `meshes/` ({size:.1f} MB),",
             f"order {ORDER}, from reading the file to the filled `MappingQCache`. CPU seconds and memory are those of the rank",
             "that needs most; memory is the peak above that of a process that has only started MPI.", ""]
    for title, way, counts in SERIES:
        lines += [f"## {title}", "", HEADER,
                  "| --- | --- | --- | --- | --- | --- |"]
        for ranks, n in zip((1, 2, 4), counts):
            r = run(args.program, args.blocks, way, ranks, n)
            lines.append(f"| {ranks} | {r['cells']:,.0f} | {r['own_max']:,.0f} | {r['cpu_max']:.2f} | "
                         f"{1000 * r['cpu_max'] / r['own_max']:.3f} | {r['peak_mb_max']:.0f} |")
            print(title, lines[-1], flush=True)
        lines.append("")
    with open(args.output, "w") as f:
        f.write("\n".join(lines))


if __name__ == "__main__":
    main()
