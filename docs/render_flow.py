#!/usr/bin/python3
"""Draws a flow of vasohex_stokes: pressure, velocity in a section, wall shear stress, side by side.

    docs/render_flow.py FOLDER OUT.png [--view X Y Z] [--up X Y Z] [--size W H] [--zoom F]

The section is the plane that the vessels spread least from. Needs Debian's python3-vtk9.
"""
import argparse
import json
import os

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

from render import write_png


def read(folder, name):
    parallel = os.path.exists(f"{folder}/{name}.pvtu")
    reader = vtk.vtkXMLPUnstructuredGridReader() if parallel else vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(f"{folder}/{name}.pvtu" if parallel else f"{folder}/{name}.vtu")
    reader.Update()
    return reader.GetOutput()


def surface_of(grid):
    surface = vtk.vtkDataSetSurfaceFilter()
    surface.SetInputData(grid)
    surface.SetNonlinearSubdivisionLevel(2)
    surface.Update()
    return surface.GetOutput()


def section_of(grid):
    points = vtk_to_numpy(grid.GetPoints().GetData())
    centre = points.mean(0)
    axes = np.linalg.svd(points[:: max(1, len(points) // 20000)] - centre, full_matrices=False)[2]
    plane = vtk.vtkPlane()
    plane.SetOrigin(centre)
    plane.SetNormal(axes[2])
    cutter = vtk.vtkCutter()
    cutter.SetInputData(grid)
    cutter.SetCutFunction(plane)
    cutter.Update()
    return cutter.GetOutput()


def panel(title, data, array, high_quantile, place, args, camera_of):
    """A renderer of data coloured by an array, its bar beside it."""
    values = vtk_to_numpy(data.GetPointData().GetArray(array))
    size = np.linalg.norm(values, axis=1) if values.ndim == 2 else values
    table = vtk.vtkLookupTable()
    table.SetHueRange(0.66, 0.0)
    table.Build()
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(data)
    mapper.SetScalarModeToUsePointFieldData()
    mapper.SelectColorArray(array)
    mapper.SetLookupTable(table)
    if values.ndim == 2:
        table.SetVectorModeToMagnitude()
    mapper.SetScalarRange(float(size.min()), float(np.quantile(size, high_quantile)))
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetInterpolationToPhong()
    bar = vtk.vtkScalarBarActor()
    bar.SetLookupTable(table)
    bar.SetTitle(title)
    bar.SetNumberOfLabels(5)
    bar.SetLabelFormat("%.3g")
    bar.UnconstrainedFontSizeOn()
    bar.SetWidth(0.14)
    bar.SetHeight(0.5)
    bar.SetPosition(0.06, 0.45)
    for text in (bar.GetTitleTextProperty(), bar.GetLabelTextProperty()):
        text.SetColor(0, 0, 0)
        text.ItalicOff()
        text.SetFontSize(16)
        text.ShadowOff()
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    renderer.SetViewport(place / 3, 0, (place + 1) / 3, 1)
    renderer.AddActor(actor)
    renderer.AddActor2D(bar)
    if camera_of:
        renderer.SetActiveCamera(camera_of.GetActiveCamera())
    else:
        camera = renderer.GetActiveCamera()
        camera.SetPosition(*args.view)
        camera.SetFocalPoint(0, 0, 0)
        camera.SetViewUp(*args.up)
        camera.ParallelProjectionOn()
        renderer.ResetCamera()
        camera.Zoom(args.zoom)
    return renderer


def main():
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("folder")
    ap.add_argument("out")
    ap.add_argument("--view", nargs=3, type=float, default=(0, -1, 0.15))
    ap.add_argument("--up", nargs=3, type=float, default=(0, 0, 1))
    ap.add_argument("--size", nargs=2, type=int, default=(1500, 1000))
    ap.add_argument("--zoom", type=float, default=0.9)
    args = ap.parse_args()
    volume, wall = read(args.folder, "flow"), read(args.folder, "wall")
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetSize(*args.size)
    window.SetMultiSamples(8)
    first = panel("pressure, Pa", surface_of(volume), "pressure", 1, 0, args, None)
    window.AddRenderer(first)
    with open(f"{args.folder}/flow.json") as f:
        unit = json.load(f)["units"] or "unit"
    window.AddRenderer(panel(f"velocity, {unit}/s", section_of(volume), "velocity", 1, 1, args, first))
    window.AddRenderer(panel("wall shear, Pa", surface_of(wall), "wall_shear_stress_magnitude", 0.99, 2, args, first))
    write_png(window, args.out)


if __name__ == "__main__":
    main()
