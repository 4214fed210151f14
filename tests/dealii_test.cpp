// Meshes and blocks as grids of deal.II: what deal.II integrates over them is what we do. Runs on any number of
// ranks.

#include <deal.II/base/mpi.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/distributed/fully_distributed_tria.h>
#include <deal.II/distributed/tria.h>
#include <deal.II/fe/fe_nothing.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/fe/mapping_q.h>
#include <deal.II/fe/mapping_q_cache.h>
#include <deal.II/grid/tria.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "dealii/dealii_grid.h"
#include "errors.h"
#include "gallery.h"
#include "measures.h"
#include "vasohex/skeleton/read_skeleton.h"
#include "vasohex/vasohex.h"

namespace vasohex {
namespace {

using dealii::MappingQCache;
using dealii::Triangulation;
using Forest = dealii::parallel::distributed::Triangulation<3>;
using Parts = dealii::parallel::fullydistributed::Triangulation<3>;

SkeletonMesh mesh_of(const Skeleton& skeleton, int order, int elements,
                     NodeFamily family = NodeFamily::gauss_lobatto) {
  SkeletonMeshOptions options;
  options.mesh = {order, family};
  options.grading.elements = elements;
  return mesh_skeleton(skeleton, options);
}

const Skeleton& iliac() {
  static const Skeleton skeleton = read_skeleton(std::string(VASOHEX_MESHES) + "/iliac_bifurcation.swc");
  return skeleton;
}

struct Measures {
  double volume = 0;
  double flux = 0;  ///< of x / 3 through the boundary: the volume too, if cells have no gaps between them
  std::vector<double> areas;
  std::size_t cells = 0;
};

/// Gauss points along an edge for areas to 1e-13: the walls of coarse elements are strongly curved.
constexpr int kPoints = 28;

/// What deal.II integrates over the cells of all ranks.
Measures measure(const Triangulation<3>& triangulation, const dealii::MappingQCache<3>& mapping,
                 std::size_t boundaries) {
  const dealii::FE_Nothing<3> nothing;
  const dealii::QGauss<3> cube((3 * mapping.get_degree()) / 2 + 1);  // the volume is a polynomial's integral
  const dealii::QGauss<2> square(kPoints);
  dealii::FEValues<3> values(mapping, nothing, cube, dealii::update_JxW_values);
  dealii::FEFaceValues<3> face_values(
      mapping, nothing, square,
      dealii::update_JxW_values | dealii::update_normal_vectors | dealii::update_quadrature_points);
  Measures own;
  own.areas.assign(boundaries, 0.0);
  for (const auto& cell : triangulation.active_cell_iterators()) {
    if (!cell->is_locally_owned()) {
      continue;
    }
    ++own.cells;
    values.reinit(cell);
    for (const unsigned int q : values.quadrature_point_indices()) {
      own.volume += values.JxW(q);
    }
    for (const unsigned int f : cell->face_indices()) {
      if (cell->face(f)->at_boundary()) {
        face_values.reinit(cell, f);
        const unsigned int id = cell->face(f)->boundary_id();
        if (id < 1 || id > boundaries) {
          ADD_FAILURE() << "boundary id " << id << " of " << cell->id().to_string();
          continue;
        }
        for (const unsigned int q : face_values.quadrature_point_indices()) {
          own.areas.at(id - 1) += face_values.JxW(q);
          own.flux += face_values.JxW(q) * (face_values.quadrature_point(q) * face_values.normal_vector(q)) / 3;
        }
      }
    }
  }
  if (dynamic_cast<const dealii::parallel::TriangulationBase<3>*>(&triangulation)) {
    const MPI_Comm all = MPI_COMM_WORLD;
    own.volume = dealii::Utilities::MPI::sum(own.volume, all);
    own.flux = dealii::Utilities::MPI::sum(own.flux, all);
    own.cells = dealii::Utilities::MPI::sum(own.cells, all);
    dealii::Utilities::MPI::sum(std::vector<double>(own.areas), all, own.areas);
  }
  return own;
}

void expect_equal(const Measures& measured, const HexMesh& mesh, double tolerance = 1e-12) {
  const double volume = measures::volume(mesh);
  EXPECT_NEAR(measured.volume / volume, 1, tolerance);
  EXPECT_NEAR(measured.flux / measured.volume, 1, 1e-11);
  const std::vector<double> areas = measures::areas(mesh, kPoints + 1);
  ASSERT_EQ(areas.size(), measured.areas.size());
  for (std::size_t s = 0; s < areas.size(); ++s) {
    EXPECT_NEAR(measured.areas[s] / areas[s], 1, tolerance) << mesh.surfaces[s];
  }
}

/// Calls f(name, triangulation) for an empty triangulation of every kind.
template <class F>
void for_every_kind(F&& f) {
  {
    SCOPED_TRACE("serial");
    Triangulation<3> triangulation;
    f(triangulation);
  }
  {
    SCOPED_TRACE("p4est");
    Forest triangulation(MPI_COMM_WORLD);
    f(triangulation);
  }
  {
    SCOPED_TRACE("fully distributed");
    Parts triangulation(MPI_COMM_WORLD);
    f(triangulation);
  }
}

TEST(Grid, VolumeAndAreasAreThoseOfTheMesh) {
  for (const Skeleton& skeleton : {gallery::tube(8, 1), iliac()}) {
    for (const int order : {1, 2, 3, 4}) {
      const HexMesh mesh =
          mesh_of(skeleton, order, 2, order % 2 ? NodeFamily::equispaced : NodeFamily::gauss_lobatto).result.mesh;
      SCOPED_TRACE("order " + std::to_string(order));
      const DealiiGrid grid(mesh);
      for_every_kind([&](Triangulation<3>& triangulation) {
        grid.create(triangulation);
        MappingQCache<3> mapping(order);
        grid.map(triangulation, mapping);
        const Measures measured = measure(triangulation, mapping, mesh.surfaces.size());
        EXPECT_EQ(measured.cells, static_cast<std::size_t>(mesh.element_count()));
        expect_equal(measured, mesh);
        for (const auto& cell : triangulation.active_cell_iterators()) {
          EXPECT_EQ(cell->material_id(), grid.info().material_id);
        }
      });
    }
  }
}

TEST(Grid, TakesEveryShapeOfTheGallery) {
  for (const gallery::Shape& shape : gallery::shapes()) {
    SCOPED_TRACE(shape.name);
    const HexMesh mesh = mesh_of(shape.skeleton, 2, 1).result.mesh;
    const DealiiGrid grid(mesh);
    for_every_kind([&](Triangulation<3>& triangulation) {
      grid.create(triangulation);
      MappingQCache<3> mapping(2);
      grid.map(triangulation, mapping);
      expect_equal(measure(triangulation, mapping, mesh.surfaces.size()), mesh);
    });
  }
}

/// The same elements, each turned by one of the 24 rotations of the cube.
HexMesh turned(HexMesh mesh, int seed) {
  std::vector<std::array<int, 3>> axes;  // signed: 1 + axis of the old cube along each new direction
  for (const std::array<int, 3>& a :
       {std::array<int, 3>{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}) {
    const bool even = (a[1] - a[0] + 3) % 3 == 1;
    for (int signs = 0; signs < 8; ++signs) {
      const int mirrored = (signs & 1) + (signs >> 1 & 1) + (signs >> 2 & 1);
      if ((mirrored % 2 == 0) == even) {
        axes.push_back({});
        for (int d = 0; d < 3; ++d) {
          axes.back()[d] = (signs >> d & 1 ? -1 : 1) * (a[d] + 1);
        }
      }
    }
  }
  EXPECT_EQ(axes.size(), 24u);
  std::mt19937 random(seed);
  const int n = mesh.order + 1, per = mesh.nodes_per_element();
  std::vector<std::array<int, 3>> turn(mesh.element_count());
  std::vector<int> old = mesh.elements;
  for (int e = 0; e < mesh.element_count(); ++e) {
    turn[e] = axes[random() % 24];
    for (int at = 0; at < per; ++at) {
      const std::array<int, 3> now{at % n, at / n % n, at / n / n};
      std::array<int, 3> before{};
      for (int d = 0; d < 3; ++d) {
        before[std::abs(turn[e][d]) - 1] = turn[e][d] > 0 ? now[d] : mesh.order - now[d];
      }
      mesh.elements[e * per + at] = old[e * per + before[0] + n * (before[1] + n * before[2])];
    }
  }
  for (HexMesh::BoundaryFace& f : mesh.boundary) {
    for (int d = 0; d < 3; ++d) {
      if (std::abs(turn[f.element][d]) - 1 == f.face / 2) {
        f.face = 2 * d + (turn[f.element][d] > 0 ? f.face % 2 : 1 - f.face % 2);
        break;
      }
    }
  }
  return mesh;
}

TEST(Grid, ElementsMayBeTurnedAnyWay) {
  const HexMesh mesh = turned(mesh_of(iliac(), 3, 1).result.mesh, 1);
  const DealiiGrid grid(mesh);
  for_every_kind([&](Triangulation<3>& triangulation) {
    grid.create(triangulation);
    if (!dynamic_cast<Parts*>(&triangulation)) {
      triangulation.refine_global(1);
    }
    MappingQCache<3> mapping(3);
    grid.map(triangulation, mapping);
    expect_equal(measure(triangulation, mapping, mesh.surfaces.size()), mesh);
  });
}

TEST(Grid, RefusesMirroredElements) {
  HexMesh mesh = mesh_of(gallery::tube(4, 1), 2, 1).result.mesh;
  const int n = 3, element = 7;
  for (int row = 0; row < n * n; ++row) {
    std::swap(mesh.elements[element * 27 + n * row], mesh.elements[element * 27 + n * row + 2]);
  }
  const std::string message = error_of([&] { DealiiGrid{mesh}; });
  EXPECT_NE(message.find("element 7"), std::string::npos) << message;
}

TEST(Grid, RefinementFollowsTheCoarseCells) {
  // pieces of polynomials of the same degree: nothing changes
  for (const int order : {1, 2, 3, 4}) {
    SCOPED_TRACE("order " + std::to_string(order));
    const HexMesh mesh = mesh_of(iliac(), order, 1).result.mesh;
    const DealiiGrid grid(mesh);
    Forest forest(MPI_COMM_WORLD);
    grid.create(forest);
    forest.refine_global(1);
    for (const auto& cell : forest.active_cell_iterators()) {
      if (cell->is_locally_owned() && cell->center()[2] > 0) {
        cell->set_refine_flag();
      }
    }
    forest.execute_coarsening_and_refinement();
    EXPECT_GT(forest.n_global_levels(), 2u);
    MappingQCache<3> mapping(order);
    grid.map(forest, mapping);
    expect_equal(measure(forest, mapping, mesh.surfaces.size()), mesh);
  }
}

TEST(Blocks, RefinedAndProjectedAreTheMeshOfAsManyElements) {
  // the mesh generator divides blocks into equal parts where refinement halves them
  for (const Skeleton& skeleton : {gallery::tube(8, 1), iliac()}) {
    const SkeletonMesh coarse = mesh_of(skeleton, 2, 1);
    const std::shared_ptr<const ImplicitSurface> surface(coarse.surface.get(), [](const ImplicitSurface*) {});
    const DealiiGrid grid(coarse.blocks, surface);
    Forest forest(MPI_COMM_WORLD);
    grid.create(forest);
    for (const int level : {0, 1, 2}) {
      for (const int order : {1, 2, 3}) {
        SCOPED_TRACE("level " + std::to_string(level) + ", order " + std::to_string(order));
        const BlockTopology topology = build_topology(coarse.blocks.vertex_count, coarse.blocks.blocks);
        Grading grading;
        grading.elements = 1 << level;
        const Sheets sheets = grade(coarse.blocks, topology, grading);
        const HexMesh mesh =
            generate_mesh(coarse.blocks, topology, sheets, *coarse.surface, {order, NodeFamily::gauss_lobatto}, {})
                .mesh;
        MappingQCache<3> mapping(order);
        grid.map(forest, mapping);
        const Measures measured = measure(forest, mapping, mesh.surfaces.size());
        EXPECT_EQ(measured.cells, static_cast<std::size_t>(mesh.element_count()));
        expect_equal(measured, mesh, 1e-9);  // projections end at 1e-10 and 1e-8 radii
      }
      forest.refine_global(1);
    }
  }
}

TEST(Blocks, RefinementOfAPipeConvergesToTheCylinder) {
  const double length = 8, exact = std::numbers::pi * length;
  const SkeletonMesh coarse = mesh_of(gallery::tube(length, 1), 2, 1);
  const std::shared_ptr<const ImplicitSurface> surface(coarse.surface.get(), [](const ImplicitSurface*) {});
  const DealiiGrid grid(coarse.blocks, surface);
  for (const int order : {1, 2, 3}) {
    Forest forest(MPI_COMM_WORLD);
    grid.create(forest);
    double before = 0;
    for (int level = 0; level < 3; ++level) {
      MappingQCache<3> mapping(order);
      grid.map(forest, mapping);
      const double error = std::abs(measure(forest, mapping, 3).volume / exact - 1);
      if (level > 0) {
        EXPECT_GT(std::log2(before / error), 2 * order - 0.3) << "order " << order << ", level " << level;
      }
      before = error;
      forest.refine_global(1);
    }
  }
}

TEST(Manifolds, PutRefinementOntoTheCoarseCells) {
  const HexMesh mesh = mesh_of(iliac(), 3, 1).result.mesh;
  const DealiiGrid grid(mesh);
  for (const bool p4est : {false, true}) {
    Triangulation<3> serial;
    Forest forest(MPI_COMM_WORLD);
    Triangulation<3>& triangulation = p4est ? forest : serial;
    grid.create(triangulation);
    grid.attach_manifolds(triangulation);
    triangulation.refine_global(1);
    std::vector<dealii::Point<3>> vertices = triangulation.get_vertices();
    MappingQCache<3> truth(3);
    // of deal.II's own making, out of the manifolds alone
    MappingQCache<3> own(3);
    own.initialize(dealii::MappingQ<3>(3), triangulation);
    const Measures measured = measure(triangulation, own, mesh.surfaces.size());
    expect_equal(measured, mesh, 1e-11);
    grid.map(triangulation, truth);
    double most = 0;
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      most = std::max(most, vertices[v].distance(triangulation.get_vertices()[v]));
    }
    EXPECT_LT(most, 1e-11 * 10) << "radii are about 10";
  }
  Parts parts(MPI_COMM_WORLD);
  EXPECT_NE(error_of([&] { grid.attach_manifolds(parts); }).find("fullydistributed"), std::string::npos);
}

TEST(FromBlockFile, EveryRankMakesItsOwnPart) {
  for (const Skeleton& skeleton : {gallery::linked(6), iliac()}) {
    SkeletonMeshOptions options;
    options.grading.elements = 2;
    options.mesh = {3, NodeFamily::gauss_lobatto};
    const BlockFile file = block_file(mesh_skeleton(skeleton, options), options);
    const HexMesh whole = mesh_blocks(file, file.grading, options.mesh).mesh;
    const DealiiGrid grid(file, file.grading, options.mesh, MPI_COMM_WORLD);
    Parts parts(MPI_COMM_WORLD);
    grid.create(parts);
    EXPECT_EQ(parts.n_global_active_cells(), static_cast<std::size_t>(whole.element_count()));
    const std::size_t ranks = dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
    EXPECT_LE(parts.n_locally_owned_active_cells(), whole.element_count() / ranks + 1);
    MappingQCache<3> mapping(3);
    grid.map(parts, mapping);
    expect_equal(measure(parts, mapping, whole.surfaces.size()), whole);
    EXPECT_EQ(grid.info().boundaries.size(), whole.surfaces.size());
    Triangulation<3> serial;
    EXPECT_NE(error_of([&] { grid.create(serial); }).find("fullydistributed"), std::string::npos);
  }
}

TEST(FromBlockFile, ForestsAreRefinedBlocks) {
  const SkeletonMeshOptions options;
  const BlockFile file = block_file(mesh_of(iliac(), 3, 1), options);
  Grading grading;
  grading.elements = 2;
  const HexMesh whole = mesh_blocks(file, grading, {3, NodeFamily::gauss_lobatto}).mesh;
  const DealiiGrid grid(file);
  Forest forest(MPI_COMM_WORLD);
  grid.create(forest);
  forest.refine_global(1);
  MappingQCache<3> mapping(3);
  grid.map(forest, mapping);
  expect_equal(measure(forest, mapping, whole.surfaces.size()), whole, 1e-9);
}

TEST(Info, TellsWhereTheEndsAre) {
  const SkeletonMesh m = mesh_of(iliac(), 3, 2);
  const MeshInfo info = DealiiGrid(m.result.mesh).info();
  EXPECT_EQ(info.units, "mm");
  ASSERT_EQ(info.boundaries.size(), 4u);
  EXPECT_EQ(info.material_id, 5u);
  const std::vector<double> areas = measures::areas(m.result.mesh, 20);
  for (std::size_t s = 0; s < 4; ++s) {
    const BoundaryInfo& b = info.boundaries[s];
    EXPECT_EQ(b.id, s + 1);
    EXPECT_EQ(b.name, m.blocks.surfaces[s]);
    EXPECT_EQ(&info.boundary(b.name), &b);
    EXPECT_NEAR(b.area / areas[s], 1, 1e-9);
    EXPECT_EQ(b.role, s == 0 ? BoundaryRole::wall : s == 1 ? BoundaryRole::inlet : BoundaryRole::outlet);
    if (s > 0) {
      const SectionFrame& end = m.blocks.ends[s - 1];
      EXPECT_LT((b.centre - end.origin).norm(), 0.01 * end.radius);
      EXPECT_LT((b.normal - end.normal()).norm(), 1e-9);
      EXPECT_NEAR(b.radius / end.radius, 1, 0.01);
    }
  }
  const std::string message = error_of([&] { info.boundary("outlet_7"); });
  EXPECT_NE(message.find("wall, inlet, outlet_1, outlet_2"), std::string::npos) << message;
}

}  // namespace
}  // namespace vasohex

int main(int argc, char** argv) {
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
