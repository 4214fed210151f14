#include "vasohex/blocks/polynomial_blocks.h"

#include <algorithm>
#include <cmath>

#include "vasohex/core/reference_hex.h"
#include "vasohex/surface/project.h"

namespace vasohex {
namespace {

/// Of the wall's model, over the mean length of the blocks.
constexpr double kWallReach = 0.04;

Vec3 nearest_on_axis(const std::vector<Vec3>& axis, const Vec3& p) {
  Vec3 best = axis.front();
  double least = (p - best).squaredNorm();
  for (std::size_t i = 0; i + 1 < axis.size(); ++i) {
    const Vec3 c = axis[i] + nearest_on_segment(p, axis[i], axis[i + 1]) * (axis[i + 1] - axis[i]);
    if ((p - c).squaredNorm() < least) {
      least = (p - c).squaredNorm();
      best = c;
    }
  }
  return best;
}

}  // namespace

PolynomialBlocks::PolynomialBlocks(const BlockProblem& problem, const BlockTopology& topology, int degree)
    : problem_(&problem), topology_(&topology), degree_(degree), wall_(*problem.surface, 0) {
  nodes_1d_ = family_nodes(NodeFamily::gauss_lobatto, degree);
  const LatticeNumbering numbering(topology, std::vector<int>(topology.edges.size(), degree));
  std::vector<int> block_ids;
  for (std::size_t b = 0; b < topology.blocks.size(); ++b) {
    numbering.block_nodes(static_cast<int>(b), block_ids);
    ids_.insert(ids_.end(), block_ids.begin(), block_ids.end());
  }
  x = Points::Zero(numbering.node_count(), 3);
  kinds_.assign(x.rows(), NodeKind::free);
  std::vector<std::array<bool, 6>> is_section(topology.blocks.size(), {false, false, false, false, false, false});
  for (const BlockProblem::Section& s : problem.sections) {
    is_section[s.block][s.face] = true;
  }
  for (int b = 0; b < block_count(); ++b) {
    for (int f = 0; f < 6; ++f) {
      if (topology.face_block_count[topology.block_faces[b][f].face] == 1 && !is_section[b][f]) {
        wall_faces_.push_back({b, f});
        for_face(f, [&](int, int, int at) { kinds_[id(b, at)] = NodeKind::wall; });
      }
    }
  }
  plane_.assign(x.rows(), -1);
  for (std::size_t s = 0; s < problem.sections.size(); ++s) {
    const BlockProblem::Section& section = problem.sections[s];
    for_face(section.face, [&](int, int, int at) {
      const int node = id(section.block, at);
      if (section.slides) {
        plane_[node] = static_cast<int>(s);
      } else {
        kinds_[node] = NodeKind::fixed;
      }
    });
  }
  for (int i = 0; i < x.rows(); ++i) {
    if (kinds_[i] == NodeKind::wall) {
      wall_nodes_.push_back(i);
    }
  }
  wall_ = WallModel(*problem.surface, wall_nodes_.size() + wall_faces_.size() * degree * degree);
  normals_ = Points::Zero(x.rows(), 3);
  std::vector<double> middles;
  for (int i = 0; i < degree; ++i) {
    middles.push_back(0.5 * (nodes_1d_[i] + nodes_1d_[i + 1]));
  }
  wall_values_ = lagrange_values(nodes_1d_, middles);
}

void PolynomialBlocks::adopt_nodes(const std::vector<Vec3>& nodes) {
  for (std::size_t i = 0; i < ids_.size(); ++i) {
    x.row(ids_[i]) = nodes[i];
  }
  update_lengths();
}

void PolynomialBlocks::place() {
  const int n = degree_ + 1;
  for (int b = 0; b < block_count(); ++b) {
    for (int at = 0; at < n * n * n; ++at) {
      const std::array<double, 3> u{nodes_1d_[at % n], nodes_1d_[at / n % n], nodes_1d_[at / n / n]};
      x.row(id(b, at)) = trilinear(problem_->vertices, problem_->blocks[b], u);
    }
  }
  place_sections(true);
  const Points before = x;
  // Each wall node is aimed at from the axis of its block; where blocks of two axes meet, from the centre.
  std::vector<int> aim(x.rows(), -1);
  std::vector<char> shared(x.rows(), 0);
  for (const auto& [b, f] : wall_faces_) {
    const int mine = problem_->block_aim[b];
    for_face(f, [&, b = b](int, int, int at) {
      const int node = id(b, at);
      if (aim[node] < 0) {
        aim[node] = mine;
      } else if (aim[node] != mine) {
        shared[node] = 1;
        if (problem_->aims[mine].axis.empty()) {
          aim[node] = mine;
        }
      }
    });
  }
  update_lengths();
  for (const int i : wall_nodes_) {
    if (plane_[i] >= 0) {
      continue;
    }
    const BlockProblem::Aim& from = problem_->aims[aim[i]];
    const Vec3 p = x.row(i);
    const Vec3 base = shared[i] || from.axis.empty() ? from.centre : nearest_on_axis(from.axis, p);
    const Vec3 direction = p - base;
    const double distance = direction.norm();
    if (distance > 1e-9 * mean_length_) {
      const double radius = problem_->surface->radius(base);
      const auto t = shoot(*problem_->surface, base, direction / distance, radius, 4 * (radius + distance));
      if (t) {
        x.row(i) = base + *t * direction / distance;
      }
    }
  }
  retract(x);
  carry_inside(before);
  update_lengths();
}

void PolynomialBlocks::place_sections(bool sliding) {
  std::vector<char> done(x.rows(), 0);
  for (const BlockProblem::Section& s : problem_->sections) {
    if (s.slides && !sliding) {
      continue;
    }
    const int n = degree_ + 1;
    for_face(s.face, [&](int, int, int at) {
      const int node = id(s.block, at);
      if (done[node]) {
        return;
      }
      done[node] = 1;
      x.row(node) =
          place_section_point(*problem_->surface, s.frame, s.quad, nodes_1d_[at % n], nodes_1d_[at / n % n]);
    });
  }
}

Vec3 PolynomialBlocks::plane_normal(int node) const {
  return plane_[node] < 0 ? Vec3(Vec3::Zero()) : problem_->sections[plane_[node]].frame.normal();
}

double PolynomialBlocks::wall_value(std::size_t point, const Vec3& x, const Vec3& outward, Vec3& gradient) {
  return keeps_sides_ ? wall_.value_facing(point, x, outward, gradient) : wall_.value(point, x, gradient);
}

void PolynomialBlocks::retract(Points& y) {
  const double reach = 0.5 * mean_length_;
  for (std::size_t w = 0; w < wall_nodes_.size(); ++w) {
    const int i = wall_nodes_[w];
    const Vec3 outward = normals_.row(i);  // as last time
    Vec3 p = y.row(i), gradient;
    const Vec3 plane = plane_normal(i);
    for (int iteration = 0; iteration < 12; ++iteration) {
      const double f = wall_value(w, p, outward, gradient);
      gradient -= plane.dot(gradient) * plane;
      Vec3 step = -f / std::max(gradient.squaredNorm(), 1e-300) * gradient;
      const double length = step.norm();
      if (length > reach) {
        step *= reach / length;
      }
      p += step;
      if (length < 1e-3 * mean_length_) {  // after this step 1e-6 is left
        break;
      }
    }
    y.row(i) = p;
    const double g = gradient.norm();
    normals_.row(i) = g > 0 ? Vec3(gradient / g) : Vec3(Vec3::UnitZ());
  }
}

void PolynomialBlocks::land() {
  wall_.forget();
  retract(x);
}

void PolynomialBlocks::carry_inside(const Points& before) {
  const int n = degree_ + 1;
  std::vector<char> done(x.rows(), 0);
  for (const auto& [b, f] : wall_faces_) {
    const int d = f / 2;
    const int stride = d == 0 ? 1 : d == 1 ? n : n * n;
    for (int at = 0; at < n * n * n; ++at) {
      const int node = id(b, at);
      if (done[node] || kinds_[node] != NodeKind::free) {
        continue;
      }
      done[node] = 1;
      const int position = at / stride % n;
      const double part = f % 2 == 1 ? nodes_1d_[position] : 1 - nodes_1d_[position];
      const int wall = id(b, at + ((f % 2 == 1 ? degree_ : 0) - position) * stride);
      x.row(node) += part * (x.row(wall) - before.row(wall));
    }
  }
}

void PolynomialBlocks::update_lengths() {
  const int n = degree_ + 1;
  lengths_.assign(block_count(), {0, 0, 0});
  inverse_lengths_.resize(3 * block_count());
  mean_length_ = 0;
  for_lattice_edges([&](int b, int d, const std::array<int, 3>&, int from, int to) {
    lengths_[b][d] += (x.row(to) - x.row(from)).norm() / (n * n);
  });
  for (int b = 0; b < block_count(); ++b) {
    for (int d = 0; d < 3; ++d) {
      mean_length_ += lengths_[b][d] / (3 * block_count());
      inverse_lengths_[3 * b + d] = 1 / lengths_[b][d];
    }
  }
  wall_.set_reach(kWallReach * mean_length_);
}

void PolynomialBlocks::adopt_lengths(const PolynomialBlocks& other) {
  lengths_ = other.lengths_;
  inverse_lengths_ = other.inverse_lengths_;
  mean_length_ = other.mean_length_;
  wall_.set_reach(kWallReach * mean_length_);
}

Energy PolynomialBlocks::energy(const Points& y, const EnergyTerms& terms, Points* gradient) {
  if (gradient) {
    gradient->setZero(y.rows(), 3);
  }
  kernel::DistortionInput in;
  in.degree = degree_;
  in.blocks = block_count();
  in.ids = ids_.data();
  in.nodes = y.data();
  in.inverse_length = inverse_lengths_.data();
  in.shape_weight = terms.shape_weight;
  in.jacobian_weight = terms.jacobian_weight;
  in.epsilon = terms.epsilon;
  in.power = terms.power;
  Energy e;
  for (const Samples& s : terms.samples) {
    look_at(s, in);
    in.jacobian_goal = terms.jacobian_goal - s.allowance;
    const kernel::DistortionOutput out = kernel::distortion(in, gradient ? gradient->data() : nullptr);
    e.value += out.energy;
    e.min_jacobian = std::min(e.min_jacobian, out.min_jacobian + s.allowance);
    e.min_det = std::min(e.min_det, out.min_det);
    e.gap_cost = s.added.empty() ? e.gap_cost : 2;
  }
  e.value += wall_distance(y, terms.wall_weight, gradient, e.wall_gap);
  if (gradient) {
    make_tangential(*gradient);
  }
  return e;
}

void PolynomialBlocks::make_tangential(Points& v) const {
  for (const int i : wall_nodes_) {
    v.row(i) -= normals_.row(i).dot(v.row(i)) * normals_.row(i);
  }
  for (int i = 0; i < v.rows(); ++i) {
    if (kinds_[i] == NodeKind::fixed) {
      v.row(i).setZero();
    } else if (plane_[i] >= 0) {
      const Vec3 plane = plane_normal(i);
      v.row(i) -= v.row(i).dot(plane) * plane;
    }
  }
}

void PolynomialBlocks::smooth(int sweeps) {
  std::vector<std::vector<int>> neighbours(x.rows());
  for_lattice_edges([&](int, int, const std::array<int, 3>&, int from, int to) {
    neighbours[from].push_back(to);
    neighbours[to].push_back(from);
  });
  for (auto& list : neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    Points y = x;
    for (int i = 0; i < x.rows(); ++i) {
      if (kinds_[i] == NodeKind::fixed) {
        continue;
      }
      Vec3 sum = Vec3::Zero();
      int count = 0;
      for (const int j : neighbours[i]) {
        if ((kinds_[i] == NodeKind::free || kinds_[j] != NodeKind::free) && (plane_[i] < 0 || plane_[j] >= 0)) {
          sum += x.row(j).transpose();
          ++count;
        }
      }
      if (count > 0) {
        y.row(i) = 0.5 * x.row(i) + 0.5 / count * sum.transpose();
      }
    }
    retract(y);
    x = y;
  }
}

PolynomialBlocks PolynomialBlocks::elevated(int degree) const {
  PolynomialBlocks e(*problem_, *topology_, degree);
  const int n = degree_ + 1, m = degree + 1;
  const std::vector<double> values = lagrange_values(nodes_1d_, e.nodes_1d_);
  std::vector<Vec3> a(m * n * n), c(m * m * n);
  for (int b = 0; b < block_count(); ++b) {
    for (int r = 0; r < n * n; ++r) {
      for (int i = 0; i < m; ++i) {
        a[i + m * r].setZero();
        for (int s = 0; s < n; ++s) {
          a[i + m * r] += values[i * n + s] * x.row(id(b, s + n * r)).transpose();
        }
      }
    }
    for (int k = 0; k < n; ++k) {
      for (int j = 0; j < m; ++j) {
        for (int i = 0; i < m; ++i) {
          c[i + m * (j + m * k)].setZero();
          for (int s = 0; s < n; ++s) {
            c[i + m * (j + m * k)] += values[j * n + s] * a[i + m * (s + n * k)];
          }
        }
      }
    }
    for (int at = 0; at < m * m * m; ++at) {
      Vec3 p = Vec3::Zero();
      for (int s = 0; s < n; ++s) {
        p += values[at / m / m * n + s] * c[at % (m * m) + m * m * s];
      }
      e.x.row(e.id(b, at)) = p;
    }
  }
  const Points before = e.x;
  e.update_lengths();
  e.place_sections(false);
  e.retract(e.x);
  e.carry_inside(before);
  e.update_lengths();
  return e;
}

std::vector<Vec3> PolynomialBlocks::block_nodes() const {
  const int n = degree_ + 1;
  std::vector<Vec3> all;
  all.reserve(static_cast<std::size_t>(block_count()) * n * n * n);
  for (int b = 0; b < block_count(); ++b) {
    for (int at = 0; at < n * n * n; ++at) {
      all.push_back(x.row(id(b, at)));
    }
  }
  return all;
}

std::vector<Vec3> PolynomialBlocks::wall_shifts() const {
  const int n = degree_ + 1;
  constexpr int m = kProjectionDegree + 1;
  const std::vector<double> to_fine =
      lagrange_values(nodes_1d_, family_nodes(NodeFamily::gauss_lobatto, kProjectionDegree));
  std::vector<Vec3> shifts;
  shifts.reserve(wall_faces_.size() * m * m);
  std::array<int, 25> ids;
  for (const auto& [b, f] : wall_faces_) {
    for_face(f, [&, b = b](int s, int t, int at) { ids[s + n * t] = id(b, at); });
    const double radius = problem_->surface->radius(x.row(ids[n * n / 2]));
    for (int t = 0; t < m; ++t) {
      for (int s = 0; s < m; ++s) {
        Vec3 p = Vec3::Zero();
        for (int j = 0; j < n; ++j) {
          for (int i = 0; i < n; ++i) {
            p += to_fine[s * n + i] * to_fine[t * n + j] * x.row(ids[i + n * j]).transpose();
          }
        }
        // the mesh's nodes on the rim of an end stay in its plane
        const auto beside = [&](int i) { return i == 0 ? 0 : i == m - 1 ? degree_ : n / 2; };
        const Vec3 plane = plane_normal(ids[beside(s) + n * beside(t)]);
        const Vec3 start = p;
        Vec3 gradient;
        for (int iteration = 0; iteration < 6; ++iteration) {
          const double value = problem_->surface->value(p, gradient);
          gradient -= plane.dot(gradient) * plane;
          const Vec3 step = -value / std::max(gradient.squaredNorm(), 1e-300) * gradient;
          p += step;
          if (!(step.norm() > 1e-3 * radius)) {
            break;
          }
        }
        const Vec3 away = p - start;
        shifts.push_back(away.norm() < 0.5 * radius ? away : Vec3(Vec3::Zero()));
      }
    }
  }
  return shifts;
}

std::vector<double> PolynomialBlocks::projection(const std::vector<Vec3>& shifts, const SampleTables& tables,
                                                 const SampleTables& fine) const {
  const int n = degree_ + 1, samples = tables.samples;
  constexpr int m = kProjectionDegree + 1;
  constexpr int kGroup = kernel::kGroup;
  const std::size_t cube = static_cast<std::size_t>(samples) * samples * samples;
  const std::size_t groups = (block_count() + kGroup - 1) / kGroup;
  std::vector<double> added(groups * cube * 9 * kGroup, 0.0);
  for (std::size_t face = 0; face < wall_faces_.size(); ++face) {
    const auto [b, f] = wall_faces_[face];
    const Vec3* shift = &shifts[face * m * m];
    const int d = f / 2;
    const auto [du, dv] = hex_face_axes(f);
    std::vector<double> part(samples, 0.0);  // of the way to the wall
    for (int w = 0; w < samples; ++w) {
      for (int i = 0; i < n; ++i) {
        part[w] += tables.value[w * n + i] * (f % 2 == 1 ? nodes_1d_[i] : 1 - nodes_1d_[i]);
      }
    }
    std::vector<Vec3> along(samples * m, Vec3::Zero()), slope(samples * m, Vec3::Zero());  // [m][samples]
    for (int j = 0; j < m; ++j) {
      for (int s = 0; s < samples; ++s) {
        for (int i = 0; i < m; ++i) {
          along[s + samples * j] += fine.value[s * m + i] * shift[i + m * j];
          slope[s + samples * j] += fine.slope[s * m + i] * shift[i + m * j];
        }
      }
    }
    for (int t = 0; t < samples; ++t) {
      for (int s = 0; s < samples; ++s) {
        Vec3 value = Vec3::Zero(), slope_u = Vec3::Zero(), slope_v = Vec3::Zero();
        for (int j = 0; j < m; ++j) {
          value += fine.value[t * m + j] * along[s + samples * j];
          slope_u += fine.value[t * m + j] * slope[s + samples * j];
          slope_v += fine.slope[t * m + j] * along[s + samples * j];
        }
        for (int w = 0; w < samples; ++w) {
          std::array<int, 3> at{};
          at[d] = w;
          at[du] = s;
          at[dv] = t;
          double* out =
              &added[9 * kGroup * (at[2] + samples * (at[1] + samples * at[0]) + cube * (b / kGroup)) + b % kGroup];
          for (int c = 0; c < 3; ++c) {
            out[kGroup * (3 * d + c)] += (f % 2 == 1 ? 1 : -1) * value[c];
            out[kGroup * (3 * du + c)] += part[w] * slope_u[c];
            out[kGroup * (3 * dv + c)] += part[w] * slope_v[c];
          }
        }
      }
    }
  }
  const int last = block_count() - 1;
  for (std::size_t i = cube * 9 * (last / kGroup); i < cube * 9 * groups; ++i) {
    std::fill(&added[i * kGroup] + last % kGroup + 1, &added[i * kGroup] + kGroup, added[i * kGroup + last % kGroup]);
  }
  return added;
}

double PolynomialBlocks::wall_distance(const Points& y, double wall_weight, Points* gradient, double& gap) {
  const int n = degree_ + 1, m = degree_;
  constexpr int kMost = kBlockDegree + 1;
  double total = 0, gap2 = 0;
  const double samples = static_cast<double>(wall_faces_.size()) * m * m;
  std::size_t sample = wall_nodes_.size();
  for (const auto& [b, f] : wall_faces_) {
    const double length = (lengths_[b][0] + lengths_[b][1] + lengths_[b][2]) / 3;
    const double weight = wall_weight / (samples * length * length);
    std::array<int, kMost * kMost> ids;
    std::array<Vec3, kMost * kMost> along, g_along;
    for_face(f, [&, b = b](int s, int t, int at) { ids[s + n * t] = id(b, at); });
    for (int t = 0; t < n; ++t) {
      for (int s = 0; s < m; ++s) {
        Vec3 p = Vec3::Zero();
        for (int i = 0; i < n; ++i) {
          p += wall_values_[s * n + i] * y.row(ids[i + n * t]).transpose();
        }
        along[s + m * t] = p;
        g_along[s + m * t].setZero();
      }
    }
    for (int t = 0; t < m; ++t) {
      for (int s = 0; s < m; ++s) {
        Vec3 p = Vec3::Zero(), g;
        for (int j = 0; j < n; ++j) {
          p += wall_values_[t * n + j] * along[s + m * j];
        }
        const Vec3 outward = (normals_.row(ids[s + n * t]) + normals_.row(ids[s + 1 + n * t]) +
                              normals_.row(ids[s + n * (t + 1)]) + normals_.row(ids[s + 1 + n * (t + 1)]))
                                 .transpose()
                                 .normalized();
        const double value = wall_value(sample++, p, outward, g);
        const double g2 = std::max(g.squaredNorm(), 1e-300);
        total += weight * value * value / g2;
        gap2 = std::max(gap2, value * value / (g2 * length * length));
        if (gradient) {
          // the change of |gradient| is of second order in the distance and left out
          const Vec3 slope = 2 * weight * value / g2 * g;
          for (int j = 0; j < n; ++j) {
            g_along[s + m * j] += wall_values_[t * n + j] * slope;
          }
        }
      }
    }
    if (gradient) {
      for (int t = 0; t < n; ++t) {
        for (int s = 0; s < m; ++s) {
          for (int i = 0; i < n; ++i) {
            gradient->row(ids[i + n * t]) += wall_values_[s * n + i] * g_along[s + m * t].transpose();
          }
        }
      }
    }
  }
  gap = std::sqrt(gap2);
  return total;
}

}  // namespace vasohex
