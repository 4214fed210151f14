#include "vasohex/blocks/topology.h"

#include <algorithm>
#include <map>
#include <string>

#include "vasohex/core/error.h"
#include "vasohex/core/reference_hex.h"

namespace vasohex {

BlockTopology build_topology(int vertex_count, const std::vector<std::array<int, 8>>& blocks) {
  BlockTopology t;
  t.vertex_count = vertex_count;
  t.blocks = blocks;
  t.block_edges.resize(blocks.size());
  t.block_faces.resize(blocks.size());
  std::map<std::array<int, 2>, int> edge_number;
  const auto edge_of = [&](int a, int b) {
    const std::array<int, 2> key{std::min(a, b), std::max(a, b)};
    const auto [it, is_new] = edge_number.try_emplace(key, static_cast<int>(t.edges.size()));
    if (is_new) {
      t.edges.push_back(key);
    }
    return it->second;
  };
  std::map<std::array<int, 4>, int> face_number;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    for (int e = 0; e < 12; ++e) {
      const auto [from, to] = hex_edge(e);
      const int v = blocks[b][from], w = blocks[b][to];
      t.block_edges[b][e] = {edge_of(v, w), v > w};
    }
    for (int f = 0; f < 6; ++f) {
      std::array<int, 4> v{};
      for (int c = 0; c < 4; ++c) {
        v[c] = blocks[b][hex_face(f)[c]];
      }
      const int origin = static_cast<int>(std::min_element(v.begin(), v.end()) - v.begin());
      BlockTopology::FaceUse use;
      use.mirror_a = origin & 1;
      use.mirror_b = origin & 2;
      use.swapped = v[origin ^ 1] > v[origin ^ 2];
      std::array<int, 4> own{v[origin], v[origin ^ 1], v[origin ^ 2], v[origin ^ 3]};
      if (use.swapped) {
        std::swap(own[1], own[2]);
      }
      std::array<int, 4> key = own;
      std::sort(key.begin(), key.end());
      const auto [it, is_new] = face_number.try_emplace(key, static_cast<int>(t.faces.size()));
      if (is_new) {
        t.faces.push_back(own);
        t.face_edges.push_back({edge_of(own[0], own[1]), edge_of(own[0], own[2])});
        t.face_block_count.push_back(0);
      }
      use.face = it->second;
      t.block_faces[b][f] = use;
      if (++t.face_block_count[use.face] > 2) {
        throw Error(ErrorCode::internal,
                    "block " + std::to_string(b) + ": its face " + std::to_string(f) + " is shared by three blocks");
      }
    }
  }
  return t;
}

LatticeNumbering::LatticeNumbering(const BlockTopology& topology, std::vector<int> edge_intervals)
    : topology_(&topology), edge_intervals_(std::move(edge_intervals)) {
  node_count_ = topology.vertex_count;
  for (const int n : edge_intervals_) {
    edge_offset_.push_back(node_count_);
    node_count_ += n - 1;
  }
  for (const auto& [first, second] : topology.face_edges) {
    face_offset_.push_back(node_count_);
    node_count_ += (edge_intervals_[first] - 1) * (edge_intervals_[second] - 1);
  }
  for (std::size_t b = 0; b < topology.blocks.size(); ++b) {
    block_offset_.push_back(node_count_);
    const auto n = intervals(static_cast<int>(b));
    node_count_ += (n[0] - 1) * (n[1] - 1) * (n[2] - 1);
  }
}

std::array<int, 3> LatticeNumbering::intervals(int block) const {
  const auto& edges = topology_->block_edges[block];
  return {edge_intervals_[edges[0].edge], edge_intervals_[edges[4].edge], edge_intervals_[edges[8].edge]};
}

void LatticeNumbering::block_nodes(int block, std::vector<int>& ids) const {
  const auto n = intervals(block);
  const std::array<int, 3> size{n[0] + 1, n[1] + 1, n[2] + 1};
  const std::array<int, 3> stride{1, size[0], size[0] * size[1]};
  ids.resize(static_cast<std::size_t>(size[0]) * size[1] * size[2]);
  int inner = block_offset_[block];
  for (int k = 1; k < n[2]; ++k) {
    for (int j = 1; j < n[1]; ++j) {
      for (int i = 1; i < n[0]; ++i) {
        ids[i + stride[1] * j + stride[2] * k] = inner++;
      }
    }
  }
  for (int f = 0; f < 6; ++f) {
    const auto [da, db] = hex_face_axes(f);
    const BlockTopology::FaceUse& use = topology_->block_faces[block][f];
    const int along_first = use.swapped ? n[db] : n[da];
    const int base = (f % 2) * n[f / 2] * stride[f / 2];
    for (int b = 1; b < n[db]; ++b) {
      for (int a = 1; a < n[da]; ++a) {
        int s = use.mirror_a ? n[da] - a : a;
        int t = use.mirror_b ? n[db] - b : b;
        if (use.swapped) {
          std::swap(s, t);
        }
        ids[base + a * stride[da] + b * stride[db]] = face_offset_[use.face] + (s - 1) + (along_first - 1) * (t - 1);
      }
    }
  }
  for (int e = 0; e < 12; ++e) {
    const int d = e / 4;
    const int corner = hex_edge(e)[0];
    const BlockTopology::EdgeUse& use = topology_->block_edges[block][e];
    int base = 0;
    for (int axis = 0; axis < 3; ++axis) {
      base += ((corner >> axis) & 1) * n[axis] * stride[axis];
    }
    for (int i = 1; i < n[d]; ++i) {
      ids[base + i * stride[d]] = edge_offset_[use.edge] + (use.reversed ? n[d] - i : i) - 1;
    }
  }
  for (int c = 0; c < 8; ++c) {
    int at = 0;
    for (int axis = 0; axis < 3; ++axis) {
      at += ((c >> axis) & 1) * n[axis] * stride[axis];
    }
    ids[at] = topology_->blocks[block][c];
  }
}

}  // namespace vasohex
