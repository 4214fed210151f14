// Closest points of a triangulated torus: ours beside CGAL's AABB tree and VTK's locators, where these are installed.
#include <benchmark/benchmark.h>

#include <random>

#include "triangle_shapes.h"
#include "vasohex/surface/smooth_surface.h"
#include "vasohex/surface/triangle_surface.h"

#ifdef VASOHEX_CGAL
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>
#endif
#ifdef VASOHEX_VTK
#include <vtkCellArray.h>
#include <vtkCellLocator.h>
#include <vtkGenericCell.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStaticCellLocator.h>
#endif

namespace {

using namespace vasohex;

/// 12,288 points, 24,576 triangles, radius 1; queries within .1 of the wall.
struct Setting {
  TorusShape shape;
  TriSurface triangles = shape.triangles(64);
  std::vector<Vec3> queries;
  Setting() {
    std::mt19937 generator(1);
    const auto random = [&] { return generator() / 4294967296.0; };
    for (int i = 0; i < 4096; ++i) {
      const Vec3& p = triangles.points[generator() % triangles.points.size()];
      queries.push_back(p + 0.1 * (Vec3(random(), random(), random()) * 2 - Vec3::Ones()) / std::sqrt(3.0));
    }
  }
};

const Setting& setting() {
  static const Setting s;
  return s;
}

template <class Query>
void run(benchmark::State& state, Query&& query) {
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(query(setting().queries[i]));
    i = (i + 1) % setting().queries.size();
  }
  state.SetItemsProcessed(state.iterations());
}

void ours(benchmark::State& state) {
  const TriangleTree tree(setting().triangles);
  run(state, [&](const Vec3& x) { return tree.closest(x).distance2; });
}
BENCHMARK(ours);

void ours_value_of_facets(benchmark::State& state) {
  const TriangleSurface surface(prepare_surface(setting().triangles), setting().shape.network());
  run(state, [&](const Vec3& x) {
    Vec3 gradient;
    return surface.value(x, gradient);
  });
}
BENCHMARK(ours_value_of_facets);

void ours_value_of_jets(benchmark::State& state) {
  const auto smooth = make_smooth_surface(prepare_surface(setting().triangles), setting().shape.network());
  run(state, [&](const Vec3& x) {
    Vec3 gradient;
    return smooth.surface->value(x, gradient);
  });
}
BENCHMARK(ours_value_of_jets);

#ifdef VASOHEX_CGAL
void cgal(benchmark::State& state) {
  using Kernel = CGAL::Simple_cartesian<double>;
  using Triangles = std::vector<Kernel::Triangle_3>;
  const auto point = [](const Vec3& p) { return Kernel::Point_3(p.x(), p.y(), p.z()); };
  Triangles triangles;
  for (const auto& t : setting().triangles.triangles) {
    const auto& p = setting().triangles.points;
    triangles.emplace_back(point(p[t[0]]), point(p[t[1]]), point(p[t[2]]));
  }
  using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::iterator>;
  CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>> tree(triangles.begin(), triangles.end());
  tree.build();
  tree.accelerate_distance_queries();
  run(state, [&](const Vec3& x) { return CGAL::squared_distance(tree.closest_point(point(x)), point(x)); });
}
BENCHMARK(cgal);
#endif

#ifdef VASOHEX_VTK
template <class Locator>
void vtk(benchmark::State& state) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const Vec3& p : setting().triangles.points) {
    points->InsertNextPoint(p.data());
  }
  vtkNew<vtkCellArray> cells;
  for (const auto& t : setting().triangles.triangles) {
    const vtkIdType ids[] = {t[0], t[1], t[2]};
    cells->InsertNextCell(3, ids);
  }
  vtkNew<vtkPolyData> surface;
  surface->SetPoints(points);
  surface->SetPolys(cells);
  vtkNew<Locator> locator;
  locator->SetDataSet(surface);
  locator->BuildLocator();
  vtkNew<vtkGenericCell> cell;
  run(state, [&](const Vec3& x) {
    double closest[3], distance2 = 0;
    vtkIdType id = 0;
    int sub = 0;
    locator->FindClosestPoint(x.data(), closest, cell, id, sub, distance2);
    return distance2;
  });
}
BENCHMARK(vtk<vtkCellLocator>);
BENCHMARK(vtk<vtkStaticCellLocator>);
#endif

}  // namespace

BENCHMARK_MAIN();
