"""Gmsh judges our MSH files of all example skeletons, without any code of ours: referee_test.py VASOHEX MESHES

Gmsh opens each file; det J > 0 at all its quadrature points; the volume under the boundary quadrangles (divergence
theorem) is that of the hexahedra; every face of only one hexahedron is exactly one quadrangle, on exactly one named
surface; caps are flat; names and ids are those that README.md promises.
"""
import collections
import json
import math
import pathlib
import subprocess
import sys
import tempfile

import gmsh
import numpy as np

ORDERS = (1, 2, 3)


def promised_surfaces(path):
    """Number of ends, and names of the surfaces in the order of their ids, from the skeleton alone."""
    if path.suffix == ".swc":
        rows = [line.split() for line in path.read_text().splitlines() if not line.startswith("#")]
        pairs = [(row[0], row[6]) for row in rows if int(row[6]) >= 0]
        names = {}
    else:
        skeleton = json.loads(path.read_text())
        pairs = [pair for branch in skeleton["branches"] for pair in zip(branch, branch[1:])]
        names = skeleton["names"]
    degree = collections.Counter(point for pair in pairs for point in pair)
    ends = [point for point, count in degree.items() if count == 1]
    if names:
        assert sorted(names) == sorted(str(point) for point in ends), "the examples name all ends or none"
        return {"wall", *names.values()}, len(ends)
    return {"wall", "inlet", *(f"outlet_{i}" for i in range(1, len(ends)))}, len(ends)


def elements_of(dimension, entity=-1):
    """Type, order and node tags [elements, nodes] of the one type of elements there is."""
    types, _, nodes = gmsh.model.mesh.getElements(dimension, entity)
    assert len(types) == 1, f"{len(types)} types of elements of dimension {dimension}"
    name, _, order, count, local, _ = gmsh.model.mesh.getElementProperties(types[0])
    return types[0], name, order, nodes[0].reshape(-1, count).astype(np.int64), np.array(local).reshape(count, -1)


def map_at_quadrature_points(type_, order, entity=-1):
    """Weights [q], Jacobians [elements, q, 3 columns, 3], points [elements, q, 3]; exact for degree 3 p - 1,
    that of det J and of x times the normal, per direction."""
    places, weights = gmsh.model.mesh.getIntegrationPoints(type_, f"Gauss{max(3, 3 * order - 1)}")
    jacobians, determinants, points = gmsh.model.mesh.getJacobians(type_, places, entity)
    q = len(weights)
    return (np.array(weights), np.array(jacobians).reshape(-1, q, 3, 3), np.array(determinants).reshape(-1, q),
            np.array(points).reshape(-1, q, 3))


def check_volume(hexes, hex_order, quads, quad_order):
    weights, _, determinants, points = map_at_quadrature_points(hexes, hex_order)
    assert determinants.min() > 0, f"det J is {determinants.min()} somewhere"
    volume = float((determinants * weights).sum())
    centre = points.reshape(-1, 3).mean(axis=0)
    weights, jacobians, _, points = map_at_quadrature_points(quads, quad_order)
    normals = np.cross(jacobians[:, :, 0], jacobians[:, :, 1])
    enclosed = float((((points - centre) * normals).sum(axis=2) * weights).sum()) / 3
    assert abs(enclosed - volume) < 1e-10 * volume, f"volume {volume}, inside the boundary {enclosed}"
    return volume


def check_boundary(nodes, local, quad_nodes):
    """nodes, local: of the hexahedra; every face is known by all its nodes, sorted."""
    faces = []
    for direction in range(3):
        for side in (-1, 1):
            on_face = np.flatnonzero(np.abs(local[:, direction] - side) < 1e-12)
            faces.append(np.sort(nodes[:, on_face], axis=1))
    faces, count = np.unique(np.concatenate(faces), axis=0, return_counts=True)
    assert count.max() <= 2, "more than two hexahedra share a face"
    boundary = faces[count == 1]
    quads = np.sort(quad_nodes, axis=1)
    distinct = np.unique(quads, axis=0)
    assert len(distinct) == len(quads), "a face is covered twice"
    assert distinct.shape == boundary.shape and (distinct == boundary).all(), "quadrangles are not the boundary faces"


def check_names(surfaces, ends):
    groups = gmsh.model.getPhysicalGroups()
    name_of = {gmsh.model.getPhysicalName(dimension, tag): (dimension, tag) for dimension, tag in groups}
    assert set(name_of) == surfaces | {"lumen"} and len(groups) == ends + 2, f"{sorted(name_of)}"
    assert sorted(tag for _, tag in groups) == list(range(1, len(groups) + 1)), "ids are not 1, 2, ..."
    assert name_of["wall"] == (2, 1) and name_of["lumen"] == (3, len(groups))
    inlets = [tag for name, (_, tag) in name_of.items() if name.startswith("inlet")]
    outlets = [tag for name, (_, tag) in name_of.items() if not name.startswith(("inlet", "wall", "lumen"))]
    assert max(inlets) < min(outlets), "inlets do not come before the other ends"
    for dimension in (2, 3):
        grouped = [entity for d, tag in groups if d == dimension
                   for entity in gmsh.model.getEntitiesForPhysicalGroup(d, tag)]
        assert sorted(grouped) == sorted(tag for _, tag in gmsh.model.getEntities(dimension)), \
            "an entity has no name or two"
    return {name: tag for name, (dimension, tag) in name_of.items() if dimension == 2 and name != "wall"}


def check_caps(caps, x_of):
    for name, tag in caps.items():
        for entity in gmsh.model.getEntitiesForPhysicalGroup(2, tag):
            x = x_of[np.unique(elements_of(2, entity)[3])]
            width = np.linalg.svd(x - x.mean(axis=0), compute_uv=False) / math.sqrt(len(x))
            assert width[2] < 1e-9 * width[0], f"cap {name} is not flat: {width}"


def check(path, order, surfaces, ends):
    gmsh.clear()
    gmsh.open(str(path))
    hexes, hex_name, hex_order, nodes, local = elements_of(3)
    quads, quad_name, quad_order, quad_nodes, _ = elements_of(2)
    assert "Hexahedron" in hex_name and "Quadrilateral" in quad_name and hex_order == quad_order == order
    tags, x, _ = gmsh.model.mesh.getNodes()
    every = np.arange(1, len(tags) + 1)
    assert (np.sort(tags) == every).all() and (np.unique(nodes) == every).all(), "tags with gaps, or loose nodes"
    x_of = np.full((len(tags) + 1, 3), np.nan)
    x_of[tags] = x.reshape(-1, 3)
    volume = check_volume(hexes, order, quads, order)
    check_boundary(nodes, local, quad_nodes)
    check_caps(check_names(surfaces, ends), x_of)
    print(f"{path.stem}: {len(nodes)} hexahedra, {len(quad_nodes)} quadrangles, volume {volume:.6g}", flush=True)
    return volume


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    examples = sorted([*folder.glob("*.swc"), *folder.glob("*.json")])
    assert len(examples) >= 5, f"{len(examples)} examples in {folder}"
    gmsh.initialize()
    gmsh.option.setNumber("General.Verbosity", 2)
    with tempfile.TemporaryDirectory() as scratch:
        for example in examples:
            surfaces, ends = promised_surfaces(example)
            volumes = []
            for order in ORDERS:
                mesh = pathlib.Path(scratch, f"{example.stem}_order_{order}.msh")
                subprocess.run([program, "mesh", str(example), "-o", str(mesh), "--order", str(order),
                                "--elements", "2", "--quiet"], check=True)
                volumes.append(check(mesh, order, surfaces, ends))
            # chords cut off (2 pi / n)^2 / 6 of a circle's area, parabolas of order 2 next to nothing: n = 8
            assert 0.88 < volumes[0] / volumes[2] < 0.93 and abs(volumes[1] / volumes[2] - 1) < 0.005, f"{volumes}"
            if example.stem == "helix":  # radius of the tube 1, two turns of radius 4 and rise 6
                exact = math.pi * 2 * math.hypot(2 * math.pi * 4, 6)
                assert abs(volumes[2] / exact - 1) < 0.002, f"{volumes[2]}, must be {exact}"
    gmsh.finalize()


main()
