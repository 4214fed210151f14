#!/usr/bin/python3
"""Runs dealii_scaling on 1, 2 and 4 ranks and writes a table:  write_dealii_scaling.py PROGRAM BLOCKS.json [-o FILE]"""
import argparse
import json
import os
import subprocess

HERE = os.path.dirname(os.path.abspath(__file__))
ORDER = 2
HEADER = "| ranks | cells | of one rank | CPU s: points | per 1000 own cells | CPU s: triangulation | peak MB |"
#        title, way, N for 1, 2, 4 ranks
SERIES = [("Strong: p4est, blocks refined three times", "forest", (3, 3, 3)),
          ("Strong: fully distributed, 8 elements per block edge", "parts", (8, 8, 8)),
          ("The same, but every rank makes the whole mesh first", "whole", (8, 8, 8)),
          ("Weak: fully distributed, 6, 8, 10 elements per block edge", "parts", (6, 8, 10))]


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
             f"Written by `benchmarks/write_dealii_scaling.py`: the abdominal aorta of `meshes/` (block file of {size:.1f} MB), order",
             f"{ORDER}, on a machine of {os.cpu_count()} cores. Figures are those of the rank that needs most. *Points* is what vasohex does:",
             "reading the file, making the part, filling the `MappingQCache`; it needs no communication. *Triangulation* is",
             "deal.II's and p4est's part; waiting for other ranks counts there, all the more with more ranks than cores. Memory is",
             "the peak above that of a process that has only started MPI.", ""]
    for title, way, counts in SERIES:
        lines += [f"## {title}", "", HEADER, "| --- | --- | --- | --- | --- | --- | --- |"]
        for ranks, n in zip((1, 2, 4), counts):
            r = run(args.program, args.blocks, way, ranks, n)
            lines.append(f"| {ranks} | {r['cells']:,.0f} | {r['own_max']:,.0f} | {r['own_cpu']:.2f} | "
                         f"{1000 * r['own_cpu'] / r['own_max']:.4f} | {r['create_cpu']:.2f} | {r['peak_mb']:.0f} |")
            print(title, lines[-1], flush=True)
        lines.append("")
    with open(args.output, "w") as f:
        f.write("\n".join(lines))


if __name__ == "__main__":
    main()
