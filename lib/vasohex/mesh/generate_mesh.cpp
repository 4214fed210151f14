#include "vasohex/mesh/generate_mesh.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <mutex>
#include <string>

#include "vasohex/core/parallel.h"
#include "vasohex/core/reference_hex.h"
#include "vasohex/mesh/relax_wall.h"
#include "vasohex/mesh/wall_node.h"

namespace vasohex {
namespace {

/// Which lattice points of a block it writes: those on vertices, edges and faces that no earlier block has.
class Ownership {
 public:
  explicit Ownership(const BlockTopology& topology)
      : topology_(topology),
        vertex_(topology.vertex_count, -1),
        edge_(topology.edges.size(), -1),
        face_(topology.faces.size(), -1) {
    const auto claim = [](int& owner, std::size_t b) {
      if (owner < 0) {
        owner = static_cast<int>(b);
      }
    };
    for (std::size_t b = 0; b < topology.blocks.size(); ++b) {
      for (const int v : topology.blocks[b]) {
        claim(vertex_[v], b);
      }
      for (const auto& use : topology.block_edges[b]) {
        claim(edge_[use.edge], b);
      }
      for (const auto& use : topology.block_faces[b]) {
        claim(face_[use.face], b);
      }
    }
  }

  /// [27] by side along i, j, k: 0 at the start, 1 between, 2 at the end.
  std::array<bool, 27> of_block(int b) const {
    std::array<bool, 27> owned{};
    owned[13] = true;
    for (int c = 0; c < 8; ++c) {
      owned[2 * (c & 1) + 6 * (c >> 1 & 1) + 18 * (c >> 2 & 1)] = vertex_[topology_.blocks[b][c]] == b;
    }
    constexpr std::array<int, 3> place{1, 3, 9};
    for (int e = 0; e < 12; ++e) {
      const int d = e / 4, c = hex_edge(e)[0];
      int at = place[d];
      for (int axis = 0; axis < 3; ++axis) {
        at += 2 * (c >> axis & 1) * place[axis];
      }
      owned[at] = edge_[topology_.block_edges[b][e].edge] == b;
    }
    for (int f = 0; f < 6; ++f) {
      owned[13 + (f % 2 == 1 ? 1 : -1) * place[f / 2]] = face_[topology_.block_faces[b][f].face] == b;
    }
    return owned;
  }

 private:
  const BlockTopology& topology_;
  std::vector<int> vertex_, edge_, face_;
};

/// Parameters of the nodes along an edge: `division` has the ends of the elements, `family` the nodes within one.
std::vector<double> node_parameters(const std::vector<double>& division, const std::vector<double>& family) {
  std::vector<double> t;
  for (std::size_t e = 0; e + 1 < division.size(); ++e) {
    for (std::size_t i = e == 0 ? 0 : 1; i < family.size(); ++i) {
      t.push_back(division[e] + family[i] * (division[e + 1] - division[e]));
    }
  }
  t.back() = 1;
  return t;
}

/// The same parameters from the other end.
std::vector<double> turned_around(std::vector<double> t) {
  for (double& x : t) {
    x = 1 - x;
  }
  std::reverse(t.begin(), t.end());
  return t;
}

/// A curve between the core and the wall by arc length.
class LineLength {
 public:
  /// \param line control points; `shift` is added in proportion to the parameter.
  LineLength(const Vec3* line, const Vec3& shift, const std::vector<double>& slopes, int n) {
    for (int s = 0; s <= kPieces; ++s) {
      for (int half = 0; half < (s == kPieces ? 1 : 2); ++half) {
        Vec3 d = shift;
        for (int i = 0; i < n; ++i) {
          d += slopes[(2 * s + half) * n + i] * line[i];
        }
        speed_[2 * s + half] = d.norm();
      }
    }
    length_[0] = 0;
    for (int s = 0; s < kPieces; ++s) {
      length_[s + 1] = length_[s] + (speed_[2 * s] + 4 * speed_[2 * s + 1] + speed_[2 * s + 2]) / (6.0 * kPieces);
    }
  }
  static constexpr int kPieces = 16;
  double total() const { return length_[kPieces]; }
  /// Parameter at distance `s` from the start: cubic Hermite between the pieces.
  double at(double s) const {
    int i = 0;
    while (i + 1 < kPieces && length_[i + 1] < s) {
      ++i;
    }
    const double h = length_[i + 1] - length_[i];
    const double u = (s - length_[i]) / h;
    const double m0 = h / speed_[2 * i], m1 = h / speed_[2 * i + 2];
    const double t0 = static_cast<double>(i) / kPieces, t1 = static_cast<double>(i + 1) / kPieces;
    return (1 + 2 * u) * (1 - u) * (1 - u) * t0 + u * (1 - u) * (1 - u) * m0 + u * u * (3 - 2 * u) * t1 +
           u * u * (u - 1) * m1;
  }

 private:
  std::array<double, 2 * kPieces + 1> speed_{};
  std::array<double, kPieces + 1> length_{};
};

}  // namespace

MeshResult generate_mesh(const BlockStructure& blocks, const BlockTopology& topology, const Sheets& sheets,
                         const ImplicitSurface& surface, const MeshOptions& options, const Run& run) {
  if (options.order < 1) {
    throw Error(ErrorCode::bad_input, "order " + std::to_string(options.order) + ": must be at least 1");
  }
  const int p = options.order;
  const int n = blocks.degree + 1;
  const std::vector<double> gauss = family_nodes(NodeFamily::gauss_lobatto, blocks.degree);
  const std::vector<double> family = family_nodes(options.family, p);
  std::vector<double> half_pieces(2 * LineLength::kPieces + 1);
  for (std::size_t i = 0; i < half_pieces.size(); ++i) {
    half_pieces[i] = static_cast<double>(i) / (2 * LineLength::kPieces);
  }
  const std::vector<double> line_slopes = lagrange_derivatives(gauss, half_pieces);

  // parameters and Lagrange tables of every sheet, in its direction and against it
  struct Table {
    std::shared_ptr<const std::vector<double>> t;
    std::vector<double> values;
  };
  std::vector<std::array<Table, 2>> tables(sheets.sheets.size());
  for (std::size_t s = 0; s < sheets.sheets.size(); ++s) {
    std::vector<double> division = divide(sheets.sheets[s].law, sheets.sheets[s].count);
    for (int reversed = 0; reversed < 2; ++reversed) {
      Table& table = tables[s][reversed];
      table.t = std::make_shared<const std::vector<double>>(node_parameters(division, family));
      table.values = lagrange_values(gauss, *table.t);
      division = turned_around(std::move(division));
    }
  }
  std::vector<int> intervals(topology.edges.size());
  for (std::size_t e = 0; e < intervals.size(); ++e) {
    intervals[e] = p * sheets.sheets[sheets.of_edge[e]].count;
  }
  const LatticeNumbering numbering(topology, intervals);
  const Ownership ownership(topology);

  // per block: which face is wall, which faces are ends
  std::vector<int> wall_face(topology.blocks.size(), -1);
  std::vector<std::array<int, 6>> end_surface(topology.blocks.size(), {0, 0, 0, 0, 0, 0});
  for (const BlockStructure::BoundaryFace& f : blocks.boundary) {
    if (f.surface == 0) {
      wall_face[f.block] = f.face;
    } else {
      end_surface[f.block][f.face] = f.surface;
    }
  }

  MeshResult result;
  HexMesh& mesh = result.mesh;
  mesh.order = p;
  mesh.family = options.family;
  mesh.units = blocks.units;
  mesh.surfaces = blocks.surfaces;
  mesh.nodes.resize(numbering.node_count());
  std::vector<int> first_element(topology.blocks.size() + 1, 0);
  for (std::size_t b = 0; b < topology.blocks.size(); ++b) {
    const auto c = numbering.intervals(static_cast<int>(b));
    first_element[b + 1] = first_element[b] + c[0] / p * (c[1] / p) * (c[2] / p);
  }
  const int per_element = mesh.nodes_per_element();
  mesh.elements.resize(static_cast<std::size_t>(first_element.back()) * per_element);
  mesh.element_block.resize(first_element.back());
  mesh.element_branch.resize(first_element.back());

  std::vector<std::shared_ptr<const ImplicitSurface>> surfaces(blocks.regions.size());
  parallel_for(run, surfaces.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      surfaces[r] = surface.part(blocks.regions[r]);
    }
  });

  struct Count {
    double residual = 0;
    int unconverged = 0, shrunk = 0;
    Vec3 place = Vec3::Zero();  // of the first that did not converge
  };
  std::vector<Count> counts(topology.blocks.size());
  std::vector<std::vector<WallShift>> shifts(topology.blocks.size());
  std::mutex progress;
  std::size_t done = 0;
  parallel_for(run, topology.blocks.size(), 4, [&](std::size_t begin, std::size_t end) {
    std::vector<int> ids;
    std::vector<Vec3> half, lines;
    for (std::size_t b = begin; b < end; ++b) {
      const int block = static_cast<int>(b);
      const ImplicitSurface& around = *surfaces[blocks.block_region[b]];
      numbering.block_nodes(block, ids);
      const auto c = numbering.intervals(block);
      const std::array<int, 3> size{c[0] + 1, c[1] + 1, c[2] + 1};
      const std::array<int, 3> stride{1, size[0], size[0] * size[1]};
      const std::array<bool, 27> owned = ownership.of_block(block);
      // lines run along `d`: towards the wall where the block has one
      const int wall = wall_face[b];
      const int d = wall >= 0 ? wall / 2 : 0, d1 = (d + 1) % 3, d2 = (d + 2) % 3;
      const std::array<int, 3> control_stride{1, n, n * n};
      std::array<const Table*, 3> table{};
      std::array<const Sheet*, 3> sheet{};
      const Table* towards_wall = nullptr;
      const bool wall_at_end = wall % 2 == 1;
      for (int axis = 0; axis < 3; ++axis) {
        const auto [s, reversed] = sheets.of_block(topology, block, axis);
        sheet[axis] = &sheets.sheets[s];
        table[axis] = &tables[s][reversed];
        if (axis == d) {
          towards_wall = &tables[s][wall_at_end == reversed];
        }
      }
      // contract d1, then d2: lines[v][u][i] control points of the lines
      half.resize(static_cast<std::size_t>(n) * n * size[d1]);
      lines.resize(static_cast<std::size_t>(size[d1]) * size[d2] * n);
      const int* control = &blocks.block_nodes[b * n * n * n];
      for (int w = 0; w < n; ++w) {
        for (int u = 0; u < size[d1]; ++u) {
          for (int i = 0; i < n; ++i) {
            Vec3 x = Vec3::Zero();
            for (int k = 0; k < n; ++k) {
              x += table[d1]->values[u * n + k] *
                   blocks.nodes[control[i * control_stride[d] + k * control_stride[d1] + w * control_stride[d2]]];
            }
            half[(w * size[d1] + u) * n + i] = x;
          }
        }
      }
      for (int v = 0; v < size[d2]; ++v) {
        for (int ui = 0; ui < size[d1] * n; ++ui) {
          Vec3 x = Vec3::Zero();
          for (int k = 0; k < n; ++k) {
            x += table[d2]->values[v * n + k] * half[k * size[d1] * n + ui];
          }
          lines[static_cast<std::size_t>(v) * size[d1] * n + ui] = x;
        }
      }
      double radius = 0;
      if (wall >= 0) {
        const std::size_t middle = static_cast<std::size_t>(size[d2] / 2) * size[d1] + size[d1] / 2;
        radius = around.radius(lines[middle * n + (wall_at_end ? n - 1 : 0)]);
      }
      constexpr std::array<int, 3> place{1, 3, 9};
      const auto side = [](int i, int last) { return i == 0 ? 0 : i == last ? 2 : 1; };
      for (int v = 0; v < size[d2]; ++v) {
        for (int u = 0; u < size[d1]; ++u) {
          const int class12 = side(u, c[d1]) * place[d1] + side(v, c[d2]) * place[d2];
          if (!owned[class12] && !owned[class12 + place[d]] && !owned[class12 + 2 * place[d]]) {
            continue;
          }
          const Vec3* line = &lines[(static_cast<std::size_t>(v) * size[d1] + u) * n];
          Vec3 shift = Vec3::Zero();
          Vec3 normal = Vec3::Zero(), slope = Vec3::Zero();  // slope: of the line at the wall
          if (wall >= 0) {
            int end_here = 0;
            for (const auto& [axis, at] : {std::pair(d1, u), std::pair(d2, v)}) {
              if (at == 0 || at == c[axis]) {
                end_here = std::max(end_here, end_surface[b][2 * axis + (at == 0 ? 0 : 1)]);
              }
            }
            const Vec3 start = line[wall_at_end ? n - 1 : 0];
            const Vec3 plane = end_here > 0 ? blocks.ends[end_here - 1].normal() : Vec3::Zero();
            for (int i = 0; i < n; ++i) {
              slope += line_slopes[(wall_at_end ? 2 * LineLength::kPieces : 0) * n + i] * line[i];
            }
            const Vec3 outward = (wall_at_end ? 1 : -1) * slope.normalized();
            const WallNode w = onto_wall(around, start, outward, end_here > 0 ? &plane : nullptr, radius);
            counts[b].residual = std::max(counts[b].residual, w.residual);
            if (w.converged) {
              shift = w.point - start;
            } else {
              counts[b].place = counts[b].unconverged++ == 0 ? start : counts[b].place;
            }
            normal = w.normal;
          }
          const std::vector<double>* t = table[d]->t.get();
          std::vector<double> own_t, own_values;
          const std::vector<double>* values = &table[d]->values;
          std::shared_ptr<const std::vector<double>> own_fade;
          if (wall >= 0 && sheet[d]->layers) {
            // layers are measured along each line, and across the wall where the line leans
            const WallLayers& layers = *sheet[d]->layers;
            const LineLength length(line, wall_at_end ? shift : Vec3(-shift), line_slopes, n);
            const Vec3 wall_point = line[wall_at_end ? n - 1 : 0] + shift;
            const Vec3 tangent = (wall_at_end ? shift : Vec3(-shift)) + slope;
            const double upright = std::max(0.5, std::abs(tangent.normalized().dot(normal)));
            const double height = layers.first_height * (layers.relative ? around.radius(wall_point) : 1.0);
            bool shrunk = false;
            const std::vector<double> from_wall =
                divide_wall_line(layers, height / upright, sheet[d]->count, length.total(), shrunk);
            counts[b].shrunk += shrunk;
            std::vector<double> division;
            for (std::size_t i = from_wall.size(); i-- > 0;) {
              division.push_back(wall_at_end ? length.at(length.total() - from_wall[i])
                                             : length.at(from_wall[from_wall.size() - 1 - i]));
            }
            division.front() = 0;
            division.back() = 1;
            own_t = node_parameters(division, family);
            own_values = lagrange_values(gauss, own_t);
            t = &own_t;
            values = &own_values;
            own_fade = std::make_shared<const std::vector<double>>(wall_at_end ? own_t : turned_around(own_t));
          }
          const int base = u * stride[d1] + v * stride[d2], at_wall = wall_at_end ? c[d] : 0;
          if (wall >= 0 && owned[class12 + side(at_wall, c[d]) * place[d]]) {
            shifts[b].push_back({ids[base + at_wall * stride[d]], shift, own_fade ? own_fade : towards_wall->t});
          }
          for (int i = 0; i < size[d]; ++i) {
            if (!owned[class12 + side(i, c[d]) * place[d]]) {
              continue;
            }
            Vec3 x = (wall_at_end ? (*t)[i] : 1 - (*t)[i]) * shift;
            for (int k = 0; k < n; ++k) {
              x += (*values)[i * n + k] * line[k];
            }
            mesh.nodes[ids[base + i * stride[d]]] = x;
          }
        }
      }
      int element = first_element[b];
      for (int k = 0; k < c[2]; k += p) {
        for (int j = 0; j < c[1]; j += p) {
          for (int i = 0; i < c[0]; i += p) {
            int* out = &mesh.elements[static_cast<std::size_t>(element) * per_element];
            for (int kk = 0; kk <= p; ++kk) {
              for (int jj = 0; jj <= p; ++jj) {
                for (int ii = 0; ii <= p; ++ii) {
                  *out++ = ids[i + ii + stride[1] * (j + jj) + stride[2] * (k + kk)];
                }
              }
            }
            mesh.element_block[element] = block;
            mesh.element_branch[element] = blocks.places[b];
            ++element;
          }
        }
      }
      const std::lock_guard lock(progress);
      if (++done % 16 == 0 || done == topology.blocks.size()) {
        run.progress("mesh", static_cast<double>(done) / topology.blocks.size());
      }
    }
  });
  std::vector<WallShift> all_shifts;
  for (std::vector<WallShift>& of_block : shifts) {
    std::move(of_block.begin(), of_block.end(), std::back_inserter(all_shifts));
    of_block = {};
  }
  result.relaxed = relax_wall(mesh, numbering, wall_face, std::move(all_shifts), surface, run);
  for (const Count& k : counts) {
    result.wall_residual_max = std::max(result.wall_residual_max, k.residual);
    result.unconverged_place = result.unconverged == 0 ? k.place : result.unconverged_place;
    result.unconverged += k.unconverged;
    result.shrunk_lines += k.shrunk;
  }
  for (const BlockStructure::BoundaryFace& f : blocks.boundary) {
    const auto c = numbering.intervals(f.block);
    const std::array<int, 3> m{c[0] / p, c[1] / p, c[2] / p};
    const auto [da, db] = hex_face_axes(f.face);
    for (int b = 0; b < m[db]; ++b) {
      for (int a = 0; a < m[da]; ++a) {
        mesh.boundary.push_back({first_element[f.block] + hex_face_point(f.face, a, b, m), f.face, f.surface});
      }
    }
  }
  return result;
}

}  // namespace vasohex
