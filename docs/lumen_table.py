#!/usr/bin/python3
"""Meshes every real lumen at orders 1, 2, 3 and writes docs/lumens.md.

    docs/lumen_table.py VASOHEX [--data FOLDER] [--referee SCRIPT] [--tables surfaces,segmentations,..]
                        [-o docs/lumens.md]

VASOHEX is the program; FOLDER holds the lumens (default: $VASOHEX_DATA). SCRIPT is an independent checker of MSH files
that prints `key: value` lines and compares with a surface (default: $VASOHEX_REFEREE); without it those columns stay
empty. With --tables, those are made anew and the others of the page kept. Needs nothing but Python.
"""
import argparse
import array
import json
import os
import re
import subprocess
import sys
import tempfile

LUMENS = ["s01_aorta_iliac_vmr0110/demo.vtp", "s01_aorta_iliac_vmr0110/seqseg_6_steps.vtp",
          "s02_carotid_stenosis/lumen.stl", "s02_carotid_stenosis/leftlumen_capped.stl",
          "s03_ica_tree/surface_mesh.vtk", "s03_ica_tree/surface_mesh_stenosis.vtk", "s07_aneurysm_id1/id1_model.vtp",
          "s08_aneurysm_palabos/aneurysm.stl", "s08_aneurysm_palabos/aneurysm_marching.stl",
          "s11_six_branch_junction/bifurcation_Y.stl", "s11_six_branch_junction/SixBranch.stl",
          "s12_aortic_arch_gmsh/aorta2.stl"]
ORDERS = (1, 2, 3)
STAIRCASES = ("s02_carotid_stenosis/lumen.stl", "s02_carotid_stenosis/leftlumen_capped.stl")
STAIRCASE_ELEMENTS = 14
SEGMENTATIONS = ["s09_pulmonary_PA000016/PA000016.nii.gz", "s10_pulmonary_trunk_seg/pulmonary_artery.nii.gz",
                 "s15_brain_mra_seg_2/Subject0002-MRA.nii.gz"]
SEGMENTATION_ELEMENTS = 2
SYNTHAORTA = "s13_synthaorta"
MODELS = (1, 2, 12, 23, 50, 66)
SYNTHAORTA_ELEMENTS = (2, 4)
HEADINGS = {"surfaces": "Surfaces", "segmentations": "Segmentations", "synthaorta": "Surface and skeleton"}


class Tools:
    """The program, the referee, and a folder for what they exchange."""

    def __init__(self, program, referee, folder):
        self.program, self.referee = program, referee
        self.mesh_file, self.figures = os.path.join(folder, "lumen.msh"), os.path.join(folder, "lumen.json")

    def mesh(self, inputs, order, elements):
        """The figures of a mesh, or the last line of the error. Elements: per block edge; None: by default."""
        for file in (self.mesh_file, self.figures):
            if os.path.exists(file):
                os.remove(file)
        division = ["-n", str(elements)] if elements else []
        with tempfile.TemporaryFile("w+") as said:
            run = subprocess.Popen([self.program, "mesh", *inputs, "-o", self.mesh_file, "--order", str(order),
                                    *division, "--json", self.figures], stdout=said, stderr=said)
            _, status, used = os.wait4(run.pid, 0)
            run.returncode = os.waitstatus_to_exitcode(status)
            if run.returncode not in (0, 3):
                said.seek(0)
                return said.read().strip().splitlines()[-1]
        with open(self.figures) as file:
            return {"peak_gigabytes": used.ru_maxrss / 1e6, **json.load(file)}

    def distances(self, surface, keys):
        if not self.referee:
            return [""] * len(keys)
        out = subprocess.run(["/usr/bin/python3", self.referee, self.mesh_file, "--surface", surface, "--certify",
                              "off"], capture_output=True, text=True)
        lines = dict(line.split(": ", 1) for line in out.stdout.splitlines() if ": " in line)
        return [f"{float(lines[k]):.4f}" if k in lines else "" for k in keys]


def not_certified(figures):
    return figures["validity"]["invalid"] + figures["validity"]["undecided"]


def lumen_row(tools, path, name, order, failed, elements=None):
    j = tools.mesh([path], order, elements)
    name += f", {elements} elements" if elements else ""
    if isinstance(j, str):
        return f"| {name} | {order} | {j} |" + " |" * 8
    distance = tools.distances(path, ("wall_to_surface_mean", "surface_to_wall_p99"))
    linear, curved = j["quality"]["scaled_jacobian_linear"], j["quality"]["scaled_jacobian"]
    failed += [f"- {name}, order {order}: {f['text']}. Most likely: {f['reason']}." for f in j["not_certified"]]
    return (f"| {name} | {order} | {j['elements']:,} | {not_certified(j)} | {curved['min']:.3f} | "
            f"{linear['min']:.3f} | {linear['mean']:.3f} | "
            f"{distance[0]} | {distance[1]} | {len(j['reach']['unreached'])} | "
            f"{j['seconds']['total']:.1f} |")


def lumen_table(tools, data):
    lines = ["Published surfaces, one command each, elements per block edge by default: 10 at order 1, 6 above. Scaled "
             "Jacobians are ours; distances (in mean radii) are an independent referee's, of the whole mesh's wall to the facets and of "
             "the facets' points to the wall. Not reached: places of the wall further than .15 local radii from the "
             "mesh; `vasohex mesh` names them. The carotid (s02) is a staircase of voxels: there linear elements come "
             f"as near as curved ones when they are smaller, {STAIRCASE_ELEMENTS} per block edge.", "",
             "| lumen | order | hexes | not certified | scaled Jacobian min | straight-sided min | "
             "mean | wall to surface, mean | surface to wall, 99 % | not reached | seconds |",
             "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|"]
    failed = []
    for lumen in LUMENS:
        for order in ORDERS:
            lines.append(lumen_row(tools, os.path.join(data, lumen), lumen, order, failed))
            print(lines[-1], flush=True)
            if order == 1 and lumen in STAIRCASES:
                lines.append(lumen_row(tools, os.path.join(data, lumen), lumen, order, failed, STAIRCASE_ELEMENTS))
                print(lines[-1], flush=True)
    return lines + ["", "What is not certified:" if failed else "All are certified.", ""] + failed


def segmentation_row(tools, path, name, order):
    j = tools.mesh([path], order, SEGMENTATION_ELEMENTS)
    if isinstance(j, str):
        return f"| {name} | {order} | {j} |" + " |" * 8
    linear, curved = j["quality"]["scaled_jacobian_linear"], j["quality"]["scaled_jacobian"]
    return (f"| {name} | {order} | {j['elements']:,} | {not_certified(j)} | {len(j['not_certified'])} | "
            f"{len(j['repairs'])} | {curved['min']:.3f} | {curved['p1']:.3f} | {linear['mean']:.3f} | "
            f"{j['seconds']['total']:.0f} | {j['peak_gigabytes']:.1f} |")


def segmentation_table(tools, data):
    lines = [f"One command each, {SEGMENTATION_ELEMENTS} elements per block edge. What is not certified and what was "
             "repaired `vasohex mesh` lists, each with its place. Seconds of wall time on 2 cores.", "",
             "| segmentation | order | hexes | not certified | in places | repairs | scaled Jacobian min | 1 % | mean, "
             "straight-sided | seconds | peak memory, GB |",
             "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|"]
    for segmentation in SEGMENTATIONS:
        for order in ORDERS:
            lines.append(segmentation_row(tools, os.path.join(data, segmentation), segmentation, order))
            print(lines[-1], flush=True)
    return lines


def write_boundary(folder, model, path):
    """The quadrilaterals around SynthAorta's finest mesh of a model, as OBJ."""
    nodes, hexes, faces = array.array("f"), array.array("I"), {}
    for values, file in ((nodes, f"MeshNodes/MeshNodes_{model}.bin"),
                         (hexes, "ConnectivityMatrices/ConnMat_Ord_1_Ref_8.bin")):
        with open(os.path.join(folder, file), "rb") as stream:
            values.frombytes(stream.read())
    for e in range(0, len(hexes), 8):
        for corners in ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)):
            quad = tuple(hexes[e + c] for c in corners)
            key = tuple(sorted(quad))
            if faces.pop(key, None) is None:
                faces[key] = quad
    with open(path, "w") as out:
        out.writelines("v %.7g %.7g %.7g\n" % tuple(nodes[i:i + 3]) for i in range(0, len(nodes), 3))
        out.writelines("f %d %d %d %d\n" % quad for quad in faces.values())


def synthaorta_row(tools, surface, skeleton, model, elements):
    alone = tools.mesh([skeleton], max(ORDERS), elements)
    errors, bad, best = [], 0, None
    for order in ORDERS:
        best = tools.mesh([skeleton, "--surface", surface], order, elements)
        if isinstance(best, str):
            return f"| {model} | {elements} | {best} |" + " |" * 6
        bad += not_certified(best)
        errors += tools.distances(surface, ("surface_to_wall_p99",))
    return (f"| {model} | {elements} | {best['elements']:,} | {bad} | "
            f"{best['quality']['scaled_jacobian']['min']:.3f} | "
            f"{alone['quality']['scaled_jacobian']['min']:.3f} | " + " | ".join(errors) + " |")


def synthaorta_table(tools, data, folder):
    lines = ["Six aortas of SynthAorta: the skeleton, and the boundary of the authors' finest mesh as the lumen. "
             f"Scaled Jacobians at order {max(ORDERS)}, beside those of the skeleton alone; elements "
             "not certified, summed over the orders; distance of 99 % of the given surface's points to the wall "
             "(referee, in mean radii).", "",
             "| model | elements per edge | hexes | not certified | scaled Jacobian min | skeleton alone | "
             + " | ".join(f"distance, order {p}" for p in ORDERS) + " |",
             "|--:|--:|--:|--:|--:|--:|" + "--:|" * len(ORDERS)]
    data = os.path.join(data, SYNTHAORTA)
    for model in MODELS:
        surface = os.path.join(folder, f"{model}.obj")
        write_boundary(data, model, surface)
        for elements in SYNTHAORTA_ELEMENTS:
            lines.append(synthaorta_row(tools, surface, os.path.join(data, f"skeleton_{model}.swc"), model, elements))
            print(lines[-1], flush=True)
    return lines


def sections_of(page):
    """The lines below each heading of a page."""
    if not os.path.exists(page):
        return {}
    with open(page) as file:
        parts = [part.strip().splitlines() for part in re.split(r"^## ", file.read(), flags=re.MULTILINE)[1:]]
    return {part[0]: part[2:] for part in parts}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--data", default=os.environ.get("VASOHEX_DATA"))
    parser.add_argument("--referee", default=os.environ.get("VASOHEX_REFEREE"))
    parser.add_argument("--tables", default=",".join(HEADINGS))
    parser.add_argument("-o", "--output", default=os.path.join(os.path.dirname(os.path.abspath(__file__)), "lumens.md"))
    a = parser.parse_args()
    if not a.data:
        sys.exit("where are the lumens? --data FOLDER or VASOHEX_DATA")
    asked = a.tables.split(",")
    if not set(asked) <= set(HEADINGS):
        sys.exit(f"--tables {a.tables}: some of {', '.join(HEADINGS)}, please")
    sections = sections_of(a.output)
    with tempfile.TemporaryDirectory() as folder:
        tools = Tools(a.program, a.referee, folder)
        for name in asked:
            sections[HEADINGS[name]] = (lumen_table(tools, a.data) if name == "surfaces" else
                                        segmentation_table(tools, a.data) if name == "segmentations" else
                                        synthaorta_table(tools, a.data, folder))
    lines = ["# Real lumens", "", "Written by `docs/lumen_table.py`.", ""]
    for heading in HEADINGS.values():
        lines += ["## " + heading, "", *sections[heading], ""] if heading in sections else []
    with open(a.output, "w") as file:
        file.write("\n".join(lines))


if __name__ == "__main__":
    main()
