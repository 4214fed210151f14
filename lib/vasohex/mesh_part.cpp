#include "vasohex/mesh_part.h"

#include <algorithm>
#include <string>
#include <utility>

#include "vasohex/blocks/move_blocks.h"
#include "vasohex/core/error.h"
#include "vasohex/mesh/move_mesh.h"
#include "vasohex/skeleton/own_frame.h"
#include "vasohex/surface/moved_surface.h"

namespace vasohex {
namespace {

/// The blocks that share a vertex with a marked one, and those.
std::vector<char> with_neighbours(const BlockTopology& topology, const std::vector<char>& marked) {
  std::vector<char> vertex(topology.vertex_count, 0), out(marked.size(), 0);
  for (std::size_t b = 0; b < marked.size(); ++b) {
    for (const int v : topology.blocks[b]) {
      vertex[v] |= marked[b];
    }
  }
  for (std::size_t b = 0; b < marked.size(); ++b) {
    for (const int v : topology.blocks[b]) {
      out[b] |= vertex[v];
    }
  }
  return out;
}

/// Numbers the used entries of [0, n) anew, in their order.
class Renumbering {
 public:
  explicit Renumbering(std::size_t n) : number_(n, -1) {}
  void use(int i) { number_[i] = 0; }
  int finish() {
    int next = 0;
    for (int& n : number_) {
      n = n < 0 ? -1 : next++;
    }
    return next;
  }
  int operator[](int i) const { return number_[i]; }
  bool used(int i) const { return number_[i] >= 0; }

 private:
  std::vector<int> number_;
};

struct SomeBlocks {
  BlockStructure blocks;
  BlockTopology topology;
  Sheets sheets;
  std::vector<int> original;  ///< [blocks] index in the whole structure
};

/// The chosen blocks alone. Vertices keep their order, so that edges and faces run the same way.
SomeBlocks choose(const BlockStructure& all, const BlockTopology& topology, const Sheets& sheets,
                  const std::vector<char>& chosen) {
  SomeBlocks some;
  BlockStructure& out = some.blocks;
  out.degree = all.degree;
  out.surfaces = all.surfaces;
  out.ends = all.ends;
  out.units = all.units;
  const int per_block = (all.degree + 1) * (all.degree + 1) * (all.degree + 1);
  Renumbering vertices(all.vertex_count), nodes(all.nodes.size()), regions(all.regions.size()),
      blocks(all.blocks.size());
  for (std::size_t b = 0; b < chosen.size(); ++b) {
    if (chosen[b]) {
      blocks.use(static_cast<int>(b));
      regions.use(all.block_region[b]);
      for (const int v : all.blocks[b]) {
        vertices.use(v);
      }
      for (int i = 0; i < per_block; ++i) {
        nodes.use(all.block_nodes[b * per_block + i]);
      }
    }
  }
  out.vertex_count = vertices.finish();
  nodes.finish();
  regions.finish();
  blocks.finish();
  for (std::size_t n = 0; n < all.nodes.size(); ++n) {
    if (nodes.used(static_cast<int>(n))) {
      out.nodes.push_back(all.nodes[n]);
    }
  }
  for (std::size_t r = 0; r < all.regions.size(); ++r) {
    if (regions.used(static_cast<int>(r))) {
      out.regions.push_back(all.regions[r]);
    }
  }
  for (std::size_t b = 0; b < chosen.size(); ++b) {
    if (chosen[b]) {
      some.original.push_back(static_cast<int>(b));
      auto& corners = out.blocks.emplace_back();
      for (int c = 0; c < 8; ++c) {
        corners[c] = vertices[all.blocks[b][c]];
      }
      for (int i = 0; i < per_block; ++i) {
        out.block_nodes.push_back(nodes[all.block_nodes[b * per_block + i]]);
      }
      out.kinds.push_back(all.kinds[b]);
      out.places.push_back(all.places[b]);
      out.block_region.push_back(regions[all.block_region[b]]);
    }
  }
  for (const BlockStructure::BoundaryFace& f : all.boundary) {
    if (chosen[f.block]) {
      out.boundary.push_back({blocks[f.block], f.face, f.surface});
    }
  }
  some.topology = build_topology(out.vertex_count, out.blocks);
  some.sheets.sheets = sheets.sheets;
  some.sheets.of_edge.resize(some.topology.edges.size());
  some.sheets.edge_reversed.resize(some.topology.edges.size());
  for (std::size_t b = 0; b < out.blocks.size(); ++b) {
    for (int e = 0; e < 12; ++e) {
      const int here = some.topology.block_edges[b][e].edge, there = topology.block_edges[some.original[b]][e].edge;
      some.sheets.of_edge[here] = sheets.of_edge[there];
      some.sheets.edge_reversed[here] = sheets.edge_reversed[there];
    }
  }
  return some;
}

/// Keeps the elements that are owned or share a vertex with such a one; drops the nodes that nobody needs then.
void keep_neighbourhood(MeshPart& part, const std::vector<std::int64_t>& ids, int rank, int ranks) {
  HexMesh& mesh = part.result.mesh;
  const int p = mesh.order, per_element = mesh.nodes_per_element(), count = mesh.element_count();
  const auto corner = [&](int e, int c) {
    const int at = p * ((c & 1) + (p + 1) * ((c >> 1 & 1) + (p + 1) * (c >> 2 & 1)));
    return mesh.elements[static_cast<std::size_t>(e) * per_element + at];
  };
  std::vector<char> own_vertex(mesh.nodes.size(), 0);
  for (int e = 0; e < count; ++e) {
    if (owner_of(ids[e], part.total, ranks) == rank) {
      for (int c = 0; c < 8; ++c) {
        own_vertex[corner(e, c)] = 1;
      }
    }
  }
  Renumbering elements(count), nodes(mesh.nodes.size());
  for (int e = 0; e < count; ++e) {
    bool near = false;
    for (int c = 0; c < 8; ++c) {
      near = near || own_vertex[corner(e, c)];
    }
    if (near) {
      elements.use(e);
      for (int i = 0; i < per_element; ++i) {
        nodes.use(mesh.elements[static_cast<std::size_t>(e) * per_element + i]);
      }
    }
  }
  elements.finish();
  HexMesh kept;
  kept.order = mesh.order;
  kept.family = mesh.family;
  kept.surfaces = mesh.surfaces;
  kept.volume = mesh.volume;
  kept.units = mesh.units;
  kept.nodes.resize(nodes.finish());
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (nodes.used(static_cast<int>(n))) {
      kept.nodes[nodes[static_cast<int>(n)]] = mesh.nodes[n];
    }
  }
  for (int e = 0; e < count; ++e) {
    if (elements.used(e)) {
      for (int i = 0; i < per_element; ++i) {
        kept.elements.push_back(nodes[mesh.elements[static_cast<std::size_t>(e) * per_element + i]]);
      }
      kept.element_block.push_back(mesh.element_block[e]);
      kept.element_branch.push_back(mesh.element_branch[e]);
      part.ids.push_back(ids[e]);
      part.owner.push_back(owner_of(ids[e], part.total, ranks));
    }
  }
  for (const HexMesh::BoundaryFace& f : mesh.boundary) {
    if (elements.used(f.element)) {
      kept.boundary.push_back({elements[f.element], f.face, f.surface});
    }
  }
  mesh = std::move(kept);
}

}  // namespace

MeshPart mesh_part(const BlockFile& file, const Grading& grading, const MeshOptions& options, int rank, int ranks,
                   const Run& run, std::shared_ptr<const ImplicitSurface> lumen) {
  // as mesh_skeleton: in the network's own frame
  const OwnFrame frame = own_frame(file.network);
  const BlockTopology topology = build_topology(file.blocks.vertex_count, file.blocks.blocks);
  const Sheets sheets = grade(file.blocks, topology, in_frame(grading, frame));
  MeshPart part;
  std::vector<std::int64_t> first{0};
  for (std::size_t b = 0; b < topology.blocks.size(); ++b) {
    std::int64_t elements = 1;
    for (int d = 0; d < 3; ++d) {
      elements *= sheets.sheets[sheets.of_block(topology, static_cast<int>(b), d).first].count;
    }
    first.push_back(first.back() + elements);
  }
  part.total = first.back();
  if (part.total < ranks) {
    throw Error(ErrorCode::bad_input, "a mesh of " + std::to_string(part.total) +
                                          " elements cannot be dealt out to " + std::to_string(ranks) +
                                          " ranks; use at most as many ranks as elements");
  }
  std::vector<char> own(topology.blocks.size());
  for (std::size_t b = 0; b < own.size(); ++b) {
    own[b] = owner_of(first[b], part.total, ranks) <= rank && owner_of(first[b + 1] - 1, part.total, ranks) >= rank;
  }
  // Around this rank's elements are those of others, and what is done to their walls depends on elements further away.
  // The next ring of blocks makes sure that every node is made by the same block as in the whole mesh.
  int fewest = kRelaxReach;
  for (const Sheet& sheet : sheets.sheets) {
    fewest = std::min(fewest, sheet.count);
  }
  std::vector<char> chosen = own;
  for (int ring = 0; ring < kRelaxReach / fewest + 2; ++ring) {
    chosen = with_neighbours(topology, chosen);
  }
  SomeBlocks some = choose(file.blocks, topology, sheets, chosen);
  move_inward(some.blocks, frame);
  if (!lumen) {
    lumen = make_surface(file, run);
  }
  const MovedSurface surface(std::move(lumen), frame.inverse());
  part.result = generate_mesh(some.blocks, some.topology, some.sheets, surface, options, run);
  move_outward(part.result, frame);
  std::vector<std::int64_t> ids;
  for (const int b : some.original) {
    for (std::int64_t id = first[b]; id < first[b + 1]; ++id) {
      ids.push_back(id);
    }
  }
  for (int& b : part.result.mesh.element_block) {
    b = some.original[b];
  }
  if (ranks > 1) {
    keep_neighbourhood(part, ids, rank, ranks);
  } else {
    part.owner.assign(ids.size(), 0);
    part.ids = std::move(ids);
  }
  return part;
}

}  // namespace vasohex
