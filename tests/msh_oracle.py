"""meshio reads our MSH files of orders 1 and 2 (it has no more) and must see the map of curved_box.h: msh_oracle.py ORACLE_FILES"""
import subprocess
import sys
import tempfile

import meshio
import numpy as np

CELLS = (2, 1, 3)
# corners, then middles of edges in VTK's order, at parametric coordinates in halves
CORNERS = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]


def curved_box_points(p, t):
    u, v, w = t.T
    return np.stack([2 * u + 0.3 * v ** p * w, v + 0.2 * w ** p * u + 0.1 * u ** p, 1.5 * w + 0.25 * u * v ** p], axis=1)


def main():
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.argv[1], folder], check=True)
        for p, hexes, quads in ((1, "hexahedron", "quad"), (2, "hexahedron27", "quad9")):
            mesh = meshio.read(f"{folder}/p{p}.msh")
            cells = mesh.cells_dict[hexes]
            assert len(cells) == 6 and mesh.cells_dict[quads].shape == (22, (p + 1) ** 2)
            places = np.array(CORNERS + [np.add(CORNERS[a], CORNERS[b]) // 2 for a, b in EDGES if p == 2]) / 2
            for e, cell in enumerate(cells):
                at = np.array([e % CELLS[0], e // CELLS[0] % CELLS[1], e // CELLS[0] // CELLS[1]])
                error = mesh.points[cell[:len(places)]] - curved_box_points(p, (at + places) / CELLS)
                assert np.abs(error).max() < 1e-14, f"order {p}, hexahedron {e}"
            assert {name: tuple(ids) for name, ids in mesh.field_data.items()} == {
                "wall": (1, 2), "inlet": (2, 2), "outlet_1": (3, 2), "lumen": (4, 3)}
            tags = mesh.cell_data_dict["gmsh:physical"]
            assert sorted(set(tags[quads])) == [1, 2, 3] and set(tags[hexes]) == {4}


main()
