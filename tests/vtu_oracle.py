"""VTK reads our VTU and VTP files, its shape functions must give the map of curved_box.h: vtu_oracle.py ORACLE_FILES"""
import itertools
import subprocess
import sys
import tempfile

from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import reference
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLUnstructuredGridReader

CELLS = (2, 1, 3)


def curved_box_point(p, u, v, w):
    return (2 * u + 0.3 * v ** p * w, v + 0.2 * w ** p * u + 0.1 * u ** p, 1.5 * w + 0.25 * u * v ** p)


def read(path, reader_class=vtkXMLUnstructuredGridReader):
    failed = []
    reader = reader_class()
    reader.AddObserver("ErrorEvent", lambda *_: failed.append(1))
    reader.SetFileName(path)
    reader.Update()
    assert not failed, f"VTK cannot read {path}"
    return reader.GetOutput()


def location(cell, parametric):
    x = [0.0] * 3
    cell.EvaluateLocation(reference(0), parametric, x, [0.0] * cell.GetNumberOfPoints())
    return x


def compare(p, what, x, t):
    wanted = curved_box_point(p, *t)
    # VTK's own shape functions lose digits as the order grows
    assert max(abs(a - b) for a, b in zip(x, wanted)) < 1e-10, f"order {p}, {what}: {x}, not {wanted}"


def positions(e):
    return e % CELLS[0], e // CELLS[0] % CELLS[1], e // CELLS[0] // CELLS[1]


def check_skeleton(lines):
    """The ring of oracle_files.cpp, exact."""
    points = vtk_to_numpy(lines.GetPoints().GetData())
    radii = vtk_to_numpy(lines.GetPointData().GetArray("Radius"))
    assert points.tolist() == [[i / 3.0, i * i, 0.1] for i in range(5)], points
    assert radii.tolist() == [1 / (i + 3.0) for i in range(5)], radii
    chains = [[cell.GetPointId(k) for k in range(cell.GetNumberOfPoints())]
              for cell in (lines.GetCell(c) for c in range(lines.GetNumberOfCells()))]
    edges = sorted(tuple(sorted(e)) for chain in chains for e in zip(chain, chain[1:]))
    assert len(chains) == 2 and edges == [(0, 1), (0, 2), (1, 2), (2, 3), (3, 4)], chains
    assert vtk_to_numpy(lines.GetCellData().GetArray("branch")).tolist() == [0, 1]


SAMPLES = (0.0, 0.3, 0.85)


def check_volume(p, grid):
    count = CELLS[0] * CELLS[1] * CELLS[2]
    assert grid.GetNumberOfCells() == count
    data = grid.GetCellData()
    assert vtk_to_numpy(data.GetArray("block")).tolist() == [10 + e for e in range(count)]
    assert vtk_to_numpy(data.GetArray("branch")).tolist() == [-1 - e for e in range(count)]
    assert vtk_to_numpy(data.GetArray("a <&\"> b")).tolist() == [0.5 * e for e in range(count)]
    for e in range(count):
        cell = grid.GetCell(e)
        assert cell.GetCellType() == (12 if p == 1 else 72)
        assert cell.GetNumberOfPoints() == (p + 1) ** 3
        for s in itertools.product(SAMPLES, repeat=3):
            t = [(c + a) / n for c, a, n in zip(positions(e), s, CELLS)]
            compare(p, f"cell {e} at {s}", location(cell, s), t)


def check_boundary(p, grid, volume_points):
    faces = [(e, f) for e in range(CELLS[0] * CELLS[1] * CELLS[2]) for f in range(6)
             if positions(e)[f // 2] == (CELLS[f // 2] - 1 if f % 2 else 0)]
    assert grid.GetNumberOfCells() == len(faces)
    assert vtk_to_numpy(grid.GetCellData().GetArray("surface")).tolist() == [f // 2 + 1 for _, f in faces]
    nodes = vtk_to_numpy(grid.GetPointData().GetArray("node"))
    assert (vtk_to_numpy(grid.GetPoints().GetData()) == volume_points[nodes]).all()
    for c, (e, f) in enumerate(faces):
        cell = grid.GetCell(c)
        assert cell.GetCellType() == (9 if p == 1 else 70)
        d, side = f // 2, f % 2
        a, b = ((d + 1) % 3, (d + 2) % 3) if side else ((d + 2) % 3, (d + 1) % 3)
        for s in itertools.product(SAMPLES, repeat=2):
            at = [0.0] * 3
            at[d], at[a], at[b] = side, s[0], s[1]
            t = [(c + q) / n for c, q, n in zip(positions(e), at, CELLS)]
            compare(p, f"boundary face {c} at {s}", location(cell, (*s, 0)), t)


def main():
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.argv[1], folder], check=True)
        for p in range(1, 10):
            grid = read(f"{folder}/p{p}.vtu")
            check_volume(p, grid)
            check_boundary(p, read(f"{folder}/p{p}_boundary.vtu"), vtk_to_numpy(grid.GetPoints().GetData()))
        check_skeleton(read(f"{folder}/ring.vtp", vtkXMLPolyDataReader))


main()
