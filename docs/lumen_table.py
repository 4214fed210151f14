#!/usr/bin/python3
"""Meshes every real lumen at orders 1, 2, 3 and writes docs/lumens.md.

    docs/lumen_table.py VASOHEX [--data FOLDER] [--referee SCRIPT] [--elements N] [--only TEXT] [-o docs/lumens.md]

VASOHEX is the program; FOLDER holds the lumens (default: $VASOHEX_DATA). SCRIPT is an independent checker of MSH files
that prints `key: value` lines and compares with a surface (default: $VASOHEX_REFEREE); without it those columns stay
empty. Needs nothing but Python.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile

LUMENS = ["s01_aorta_iliac_vmr0110/demo.vtp", "s01_aorta_iliac_vmr0110/seqseg_6_steps.vtp",
          "s02_carotid_stenosis/lumen.stl", "s02_carotid_stenosis/leftlumen_capped.stl", "s03_ica_tree/surface_mesh.vtk",
          "s03_ica_tree/surface_mesh_stenosis.vtk", "s07_aneurysm_id1/id1_model.vtp",
          "s08_aneurysm_palabos/aneurysm.stl", "s08_aneurysm_palabos/aneurysm_marching.stl",
          "s11_six_branch_junction/bifurcation_Y.stl", "s11_six_branch_junction/SixBranch.stl",
          "s12_aortic_arch_gmsh/aorta2.stl"]


def referee_figures(script, mesh, surface):
    out = subprocess.run(["/usr/bin/python3", script, mesh, "--surface", surface, "--certify", "off"],
                         capture_output=True, text=True)
    return dict(line.split(": ", 1) for line in out.stdout.splitlines() if ": " in line)


def row(program, referee, path, name, order, elements, folder):
    mesh, figures = os.path.join(folder, "lumen.msh"), os.path.join(folder, "lumen.json")
    for file in (mesh, figures):
        if os.path.exists(file):
            os.remove(file)
    out = subprocess.run([program, "mesh", path, "-o", mesh, "--order", str(order), "-n", str(elements), "--json",
                          figures], capture_output=True, text=True)
    if out.returncode not in (0, 3):
        return f"| {name} | {order} | {out.stderr.strip().splitlines()[-1]} |" + " |" * 8
    j = json.load(open(figures))
    far = referee_figures(referee, mesh, path) if referee else {}
    distance = ["" if key not in far else f"{float(far[key]):.4f}" for key in ("wall_to_surface_mean",
                                                                               "surface_to_wall_p99")]
    linear, curved = j["quality"]["scaled_jacobian_linear"], j["quality"]["scaled_jacobian"]
    bad = j["validity"]["invalid"] + j["validity"]["undecided"]
    return (f"| {name} | {order} | {j['elements']:,} | {bad or '0'} | {curved['min']:.3f} | {linear['min']:.3f} | "
            f"{linear['mean']:.3f} | {distance[0]} | {distance[1]} | {j['unconverged_projections']} | "
            f"{j['seconds']['total']:.1f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("--data", default=os.environ.get("VASOHEX_DATA"))
    parser.add_argument("--referee", default=os.environ.get("VASOHEX_REFEREE"))
    parser.add_argument("--elements", type=int, default=3)
    parser.add_argument("--only", default="")
    parser.add_argument("-o", "--output", default=os.path.join(os.path.dirname(os.path.abspath(__file__)), "lumens.md"))
    a = parser.parse_args()
    if not a.data:
        sys.exit("where are the lumens? --data FOLDER or VASOHEX_DATA")
    lines = ["# Real lumens", "",
             f"Written by `docs/lumen_table.py`: published surfaces, one command each, {a.elements} elements per block edge. "
             "Scaled Jacobians are ours; distances (in mean radii) are an independent referee's, of the whole mesh's wall to "
             "the facets and of the facets' points to the wall. Rows with invalid elements are what is not solved.", "",
             "| lumen | order | hexes | not certified | scaled Jacobian min | straight-sided min | mean | wall to surface, "
             "mean | surface to wall, 99 % | projections failed | seconds |",
             "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|"]
    with tempfile.TemporaryDirectory() as folder:
        for lumen in LUMENS:
            for order in (1, 2, 3):
                if a.only in lumen:
                    lines.append(row(a.program, a.referee, os.path.join(a.data, lumen), lumen, order, a.elements, folder))
                    print(lines[-1], flush=True)
    with open(a.output, "w") as file:
        file.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
