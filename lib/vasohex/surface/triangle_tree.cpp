#include "vasohex/surface/triangle_tree.h"

#include <algorithm>
#include <cmath>

namespace vasohex {

ClosestPoint closest_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x) {
  ClosestPoint r;
  const Vec3 ab = b - a, ac = c - a, ax = x - a;
  const double d1 = ab.dot(ax), d2 = ac.dot(ax);
  const auto at = [&](int feature, double u, double v) {  // a + u ab + v ac
    r.feature = feature;
    r.weights = Vec3(1 - u - v, u, v);
    r.point = a + u * ab + v * ac;
    r.distance2 = (x - r.point).squaredNorm();
    return r;
  };
  if (d1 <= 0 && d2 <= 0) {
    return at(0, 0, 0);
  }
  const Vec3 bx = x - b;
  const double d3 = ab.dot(bx), d4 = ac.dot(bx);
  if (d3 >= 0 && d4 <= d3) {
    return at(1, 1, 0);
  }
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 > d3) {
    return at(3, d1 / (d1 - d3), 0);
  }
  const Vec3 cx = x - c;
  const double d5 = ab.dot(cx), d6 = ac.dot(cx);
  if (d6 >= 0 && d5 <= d6) {
    return at(2, 0, 1);
  }
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 > d6) {
    return at(5, 0, d2 / (d2 - d6));
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0 && (d4 - d3) + (d5 - d6) > 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return at(4, 1 - w, w);
  }
  const double sum = va + vb + vc;
  if (!(sum > 1e-14 * ab.squaredNorm() * ac.squaredNorm())) {  // without area: one of the edges
    const auto along = [](const Vec3& edge, const Vec3& to) {
      const double length2 = edge.squaredNorm();
      return length2 > 0 ? std::clamp(edge.dot(to) / length2, 0.0, 1.0) : 0.0;
    };
    const double s = along(ab, ax), t = along(ac, ax), w = along(c - b, bx);
    ClosestPoint best = at(3, s, 0);
    for (const ClosestPoint& candidate : {at(5, 0, t), at(4, 1 - w, w)}) {
      best = candidate.distance2 < best.distance2 ? candidate : best;
    }
    return best;
  }
  return at(6, vb / sum, vc / sum);
}

struct TriangleTree::Item {
  Box box;
  Vec3 middle;
  int triangle;
};

namespace {

double half_area(const Box& box) {
  const Vec3 d = box.max - box.min;
  return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
}

void add(Box& box, const Box& other) {
  box.add(other.min);
  box.add(other.max);
}

constexpr int kLeaf = 4;

/// Where [begin, end) is best divided: 16 bins along the longest side of the middles, least sum of area times count.
template <class Item>
int divide(std::vector<Item>& items, int begin, int end) {
  Box middles;
  for (int i = begin; i < end; ++i) {
    middles.add(items[i].middle);
  }
  int axis = 0;
  const double length = (middles.max - middles.min).maxCoeff(&axis);
  const int half = begin + (end - begin) / 2;
  if (!(length > 0)) {
    return half;
  }
  constexpr int kBins = 16;
  const auto bin = [&](const Item& item) {
    return std::min(kBins - 1, static_cast<int>(kBins * (item.middle[axis] - middles.min[axis]) / length));
  };
  std::array<Box, kBins> box;
  std::array<int, kBins> count{};
  for (int i = begin; i < end; ++i) {
    add(box[bin(items[i])], items[i].box);
    ++count[bin(items[i])];
  }
  std::array<double, kBins> right{};
  Box grown;
  int sum = 0;
  for (int b = kBins - 1; b > 0; --b) {
    if (count[b] > 0) {
      add(grown, box[b]);
    }
    sum += count[b];
    right[b] = sum > 0 ? half_area(grown) * sum : 0;
  }
  grown = Box();
  sum = 0;
  double best = std::numeric_limits<double>::infinity();
  int best_bin = -1;
  for (int b = 1; b < kBins; ++b) {
    if (count[b - 1] > 0) {
      add(grown, box[b - 1]);
    }
    sum += count[b - 1];
    const double cost = (sum > 0 ? half_area(grown) * sum : 0) + right[b];
    if (sum > 0 && sum < end - begin && cost < best) {
      best = cost;
      best_bin = b;
    }
  }
  const auto middle = std::stable_partition(items.begin() + begin, items.begin() + end,
                                            [&](const Item& item) { return bin(item) < best_bin; });
  const int at = static_cast<int>(middle - items.begin());
  return at > begin && at < end ? at : half;
}

}  // namespace

TriangleTree::TriangleTree(const TriSurface& surface) {
  std::vector<Item> items(surface.triangles.size());
  for (std::size_t t = 0; t < items.size(); ++t) {
    for (const int p : surface.triangles[t]) {
      items[t].box.add(surface.points[p]);
    }
    items[t].middle = 0.5 * (items[t].box.min + items[t].box.max);
    items[t].triangle = static_cast<int>(t);
  }
  if (!items.empty()) {
    nodes_.emplace_back();
    build(items, 0, static_cast<int>(items.size()), 0);
  }
  corners_.reserve(items.size());
  for (const Item& item : items) {
    const auto& [a, b, c] = surface.triangles[item.triangle];
    corners_.push_back({surface.points[a], surface.points[b], surface.points[c], item.triangle});
  }
}

void TriangleTree::build(std::vector<Item>& items, int begin, int end, int node) {
  std::array<int, kWidth + 1> cut{begin, end, end, end, end};
  int parts = 1;
  while (parts < kWidth) {  // the largest part in two
    int largest = 0;
    for (int p = 1; p < parts; ++p) {
      largest = cut[p + 1] - cut[p] > cut[largest + 1] - cut[largest] ? p : largest;
    }
    if (cut[largest + 1] - cut[largest] <= kLeaf) {
      break;
    }
    const int middle = divide(items, cut[largest], cut[largest + 1]);
    for (int p = parts; p > largest; --p) {
      cut[p + 1] = cut[p];
    }
    cut[largest + 1] = middle;
    ++parts;
  }
  std::array<int, kWidth> child{};
  for (int p = 0; p < kWidth; ++p) {
    Box box;
    for (int i = cut[p]; p < parts && i < cut[p + 1]; ++i) {
      add(box, items[i].box);
    }
    const int count = p < parts ? cut[p + 1] - cut[p] : 0;
    const bool leaf = count <= kLeaf;
    if (count > 0 && !leaf) {
      child[p] = static_cast<int>(nodes_.size());
      nodes_.emplace_back();
    }
    Node& n = nodes_[node];
    for (int d = 0; d < 3; ++d) {
      n.min[d][p] = count > 0 ? box.min[d] : std::numeric_limits<double>::infinity();
      n.max[d][p] = count > 0 ? box.max[d] : std::numeric_limits<double>::infinity();
    }
    n.first[p] = leaf ? cut[p] : child[p];
    n.count[p] = count == 0 ? -1 : leaf ? count : 0;
  }
  for (int p = 0; p < parts; ++p) {
    if (child[p] > 0) {
      build(items, cut[p], cut[p + 1], child[p]);
    }
  }
}

ClosestPoint TriangleTree::closest(const Vec3& x, double furthest) const {
  ClosestPoint best;
  best.distance2 = furthest * furthest;
  struct Entry {
    double distance2;
    std::int32_t node;
  };
  std::array<Entry, 128> stack;
  int top = 0;
  if (!nodes_.empty()) {
    stack[top++] = {0, 0};
  }
  int nearest = -1;
  while (top > 0) {
    const Entry entry = stack[--top];
    if (entry.distance2 >= best.distance2) {
      continue;
    }
    const Node& node = nodes_[entry.node];
    std::array<double, kWidth> distance2;
    for (int k = 0; k < kWidth; ++k) {
      double sum = 0;
      for (int d = 0; d < 3; ++d) {
        const double below = node.min[d][k] - x[d], above = x[d] - node.max[d][k];
        double out = below > above ? below : above;
        out = out > 0 ? out : 0;
        sum += out * out;
      }
      distance2[k] = sum;
    }
    // leaves at once, nodes onto the stack, the nearest on top
    const int base = top;
    for (int k = 0; k < kWidth; ++k) {
      if (!(distance2[k] < best.distance2)) {
        continue;
      }
      if (node.count[k] == 0) {
        int at = top++;
        for (; at > base && stack[at - 1].distance2 < distance2[k]; --at) {
          stack[at] = stack[at - 1];
        }
        stack[at] = {distance2[k], node.first[k]};
        continue;
      }
      for (int i = node.first[k]; i < node.first[k] + node.count[k]; ++i) {
        const Corners& t = corners_[i];
        const ClosestPoint candidate = closest_on_triangle(t.a, t.b, t.c, x);
        if (candidate.distance2 < best.distance2) {
          best = candidate;
          nearest = i;
        }
      }
    }
  }
  best.triangle = nearest < 0 ? -1 : corners_[nearest].triangle;
  return best;
}

}  // namespace vasohex
