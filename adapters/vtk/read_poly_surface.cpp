#include "vtk/read_poly_surface.h"

#include <vtkCellArray.h>
#include <vtkCellArrayIterator.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataReader.h>
#include <vtkSmartPointer.h>
#include <vtkXMLPolyDataReader.h>

#include <filesystem>

#include "vasohex/core/error.h"
#include "vasohex/surface/read_surface.h"
#include "vtk/silence.h"

namespace vasohex {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw Error(ErrorCode::bad_input, "surface " + path + ": " + what);
}

template <class Reader>
vtkSmartPointer<vtkPolyData> read_with(const std::string& path) {
  vtkNew<Reader> reader;
  const Silence silence;
  reader->SetFileName(path.c_str());
  reader->Update();
  if (silence.complained()) {
    fail(path, "damaged, or not polydata: " + silence.complaint());
  }
  return reader->GetOutput();
}

void add_polygons(const std::string& path, vtkCellArray* cells, TriSurface& surface) {
  const auto cell = vtk::TakeSmartPointer(cells->NewIterator());
  for (cell->GoToFirstCell(); !cell->IsDoneWithTraversal(); cell->GoToNextCell()) {
    vtkIdType count = 0;
    const vtkIdType* points = nullptr;
    cell->GetCurrentCell(count, points);
    if (const std::string wrong = add_face(surface, {points, points + count}); !wrong.empty()) {
      fail(path, "polygon " + std::to_string(cell->GetCurrentCellId()) + ": " + wrong);
    }
  }
}

void add_strips(const std::string& path, vtkCellArray* cells, TriSurface& surface) {
  const auto cell = vtk::TakeSmartPointer(cells->NewIterator());
  for (cell->GoToFirstCell(); !cell->IsDoneWithTraversal(); cell->GoToNextCell()) {
    vtkIdType count = 0;
    const vtkIdType* p = nullptr;
    cell->GetCurrentCell(count, p);
    for (vtkIdType i = 0; i + 2 < count; ++i) {
      const std::string wrong = i % 2 == 0 ? add_face(surface, {p[i], p[i + 1], p[i + 2]})
                                           : add_face(surface, {p[i + 1], p[i], p[i + 2]});
      if (!wrong.empty()) {
        fail(path, "triangle strip " + std::to_string(cell->GetCurrentCellId()) + ": " + wrong);
      }
    }
  }
}

}  // namespace

TriSurface read_poly_surface(const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) {
    fail(path, "no such file");
  }
  const vtkSmartPointer<vtkPolyData> data =
      path.ends_with(".vtp") ? read_with<vtkXMLPolyDataReader>(path) : read_with<vtkPolyDataReader>(path);
  TriSurface surface;
  for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i) {
    Vec3 p;
    data->GetPoint(i, p.data());
    if (!p.allFinite()) {
      fail(path, "point " + std::to_string(i) + " has a coordinate that is not finite");
    }
    surface.points.push_back(p);
  }
  add_polygons(path, data->GetPolys(), surface);
  add_strips(path, data->GetStrips(), surface);
  if (surface.triangles.empty()) {
    fail(path, "no triangles; it must hold the surface of a lumen");
  }
  return surface;
}

}  // namespace vasohex
