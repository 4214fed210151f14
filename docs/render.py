#!/usr/bin/python3
"""Draws a VTU file of vasohex to a PNG: curved surface, curved element edges.

    docs/render.py FILE.vtu OUT.png [--color block|branch|scaled_jacobian] [--view X Y Z] [--up X Y Z] [--zoom F]
                   [--focus X Y Z] [--size W H] [--cut NX NY NZ D]

--cut leaves out the elements whose centre lies beyond the plane n . x = D. Needs Debian's python3-vtk9.
"""
import argparse

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy

# corners of the 12 edges, in the order of VTK's Lagrange hexahedron (file version 2.2)
EDGES = [(0, 1), (1, 2), (3, 2), (0, 3), (4, 5), (5, 6), (7, 6), (4, 7), (0, 4), (1, 5), (2, 6), (3, 7)]


def edge_lines(grid, ids, order):
    """Every element edge once, as a smooth polyline."""
    points = vtk_to_numpy(grid.GetPoints().GetData())
    inner = order - 1
    t = np.linspace(0, 1, max(2, 2 * order + 1))
    nodes = np.linspace(0, 1, order + 1)
    basis = np.array([[np.prod([(x - b) / (a - b) for b in nodes if b != a]) for a in nodes] for x in t])
    all_rows = []
    for e, (a, b) in enumerate(EDGES):
        middle = [ids[:, 8 + e * inner + i] for i in range(inner)]
        all_rows.append(np.stack([ids[:, a], *middle, ids[:, b]], axis=1))
    rows = np.concatenate(all_rows)
    _, first = np.unique(np.sort(rows[:, [0, -1]], axis=1), axis=0, return_index=True)
    lines = np.einsum("ti,lic->ltc", basis, points[rows[first]]).reshape(-1, 3)
    poly, pts, cells = vtk.vtkPolyData(), vtk.vtkPoints(), vtk.vtkCellArray()
    pts.SetData(numpy_to_vtk(np.ascontiguousarray(lines), deep=1))
    n = len(t)
    cells.SetData(numpy_to_vtkIdTypeArray(np.arange(0, n * len(first) + 1, n, dtype=np.int64), deep=1),
                  numpy_to_vtkIdTypeArray(np.arange(n * len(first), dtype=np.int64), deep=1))
    poly.SetPoints(pts)
    poly.SetLines(cells)
    return poly


def write_png(window, path):
    window.Render()
    image = vtk.vtkWindowToImageFilter()
    image.SetInput(window)
    writer = vtk.vtkPNGWriter()
    writer.SetFileName(path)
    writer.SetInputConnection(image.GetOutputPort())
    writer.Write()


def main():
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("file")
    ap.add_argument("out")
    ap.add_argument("--color", default="block")
    ap.add_argument("--view", nargs=3, type=float, default=(0, 1, 0.15))
    ap.add_argument("--up", nargs=3, type=float, default=(0, 0, 1))
    ap.add_argument("--focus", nargs=3, type=float)
    ap.add_argument("--zoom", type=float, default=1.0)
    ap.add_argument("--size", nargs=2, type=int, default=(1000, 1400))
    ap.add_argument("--cut", nargs=4, type=float)
    args = ap.parse_args()
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(args.file)
    reader.Update()
    grid = reader.GetOutput()
    if args.cut:
        n, d = np.array(args.cut[:3]), args.cut[3]
        conn = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(grid.GetNumberOfCells(), -1)
        centre = vtk_to_numpy(grid.GetPoints().GetData())[conn[:, :8]].mean(1)
        keep = vtk.vtkIdList()
        for i in np.flatnonzero(centre @ n <= d):
            keep.InsertNextId(int(i))
        extract = vtk.vtkExtractCells()
        extract.SetInputData(grid)
        extract.SetCellList(keep)
        extract.Update()
        grid = extract.GetOutput()
    ids = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(grid.GetNumberOfCells(), -1)
    order = round(ids.shape[1] ** (1 / 3)) - 1

    surface = vtk.vtkDataSetSurfaceFilter()
    surface.SetInputData(grid)
    surface.SetNonlinearSubdivisionLevel(2 if order > 1 else 0)
    normals = vtk.vtkPolyDataNormals()
    normals.SetInputConnection(surface.GetOutputPort())
    normals.SplittingOff()
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(normals.GetOutputPort())
    mapper.SetScalarModeToUseCellFieldData()
    mapper.SelectColorArray(args.color)
    table = vtk.vtkLookupTable()
    values = vtk_to_numpy(grid.GetCellData().GetArray(args.color))
    if args.color == "scaled_jacobian":
        table.SetHueRange(0.0, 0.62)
        mapper.SetScalarRange(0.3, 1.0)
        table.Build()
    else:
        low, high = int(values.min()), int(values.max())
        table.SetNumberOfTableValues(high - low + 1)
        rng = np.random.default_rng(3)
        for i in range(high - low + 1):
            r, g, b = 0.55 + 0.4 * rng.random(3)
            table.SetTableValue(i, r, g, b, 1)
        mapper.SetScalarRange(low, high)
    mapper.SetLookupTable(table)
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    lines = vtk.vtkPolyDataMapper()
    lines.SetInputData(edge_lines(grid, ids, order))
    lines.SetResolveCoincidentTopologyToPolygonOffset()
    wire = vtk.vtkActor()
    wire.SetMapper(lines)
    wire.GetProperty().SetColor(0.08, 0.08, 0.1)
    wire.GetProperty().SetLineWidth(1.2)
    wire.GetProperty().SetLighting(False)
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    renderer.AddActor(actor)
    renderer.AddActor(wire)
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(8)
    window.SetSize(*args.size)
    window.AddRenderer(renderer)
    camera = renderer.GetActiveCamera()
    box = grid.GetBounds()
    focus = np.array(args.focus or [(box[0] + box[1]) / 2, (box[2] + box[3]) / 2, (box[4] + box[5]) / 2])
    camera.SetFocalPoint(*focus)
    camera.SetPosition(*(focus + np.array(args.view)))
    camera.SetViewUp(*args.up)
    camera.ParallelProjectionOn()
    renderer.ResetCamera()
    camera.SetFocalPoint(*focus)
    camera.SetPosition(*(focus + 1000 * np.array(args.view) / np.linalg.norm(args.view)))
    camera.Zoom(args.zoom)
    renderer.ResetCameraClippingRange()
    write_png(window, args.out)


if __name__ == "__main__":
    main()
