#include "vasohex/block_file.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "vasohex/core/atomic_file.h"
#include "vasohex/core/json_place.h"
#include "vasohex/mesh_part.h"
#include "vasohex/skeleton/own_frame.h"
#include "vasohex/surface/moved_surface.h"

namespace vasohex {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "vasohex-blocks-2";
constexpr std::array<const char*, 3> kKinds{"radial", "axial", "core"};

// ---------------------------------------------------------------------------------------------------- writing

Json json_of(const Vec3& x) { return {x.x(), x.y(), x.z()}; }

Json json_of(const std::vector<Vec3>& points) {
  Json j = Json::array();
  for (const Vec3& p : points) {
    j.push_back(json_of(p));
  }
  return j;
}

Json json_of(const Law& law) {
  if (const auto* geometric = std::get_if<GeometricLaw>(&law)) {
    return {{"law", "geometric"}, {"growth", geometric->growth}};
  }
  if (const auto* tanh = std::get_if<TanhLaw>(&law)) {
    return {{"law", "tanh"}, {"stretching", tanh->stretching}};
  }
  if (std::holds_alternative<CustomLaw>(law)) {
    throw Error(ErrorCode::bad_input, "a grading law that is a function cannot be written to a file");
  }
  return {{"law", "uniform"}};
}

Json json_of(const Grading& grading) {
  Json j{{"elements", grading.elements}};
  for (const auto& [name, count] :
       {std::pair("radial", grading.radial), std::pair("axial", grading.axial), std::pair("core", grading.core)}) {
    if (count) {
      j[name] = *count;
    }
  }
  if (grading.layers) {
    const WallLayers& l = *grading.layers;
    j["layers"] = {
        {"layers", l.layers}, {"first_height", l.first_height}, {"relative", l.relative}, {"growth", l.growth}};
  }
  for (const Grading::Request& r : grading.requests) {
    Json request{{"sheet", r.sheet}};
    if (r.count) {
      request["count"] = *r.count;
    }
    if (r.law) {
      request["law"] = json_of(*r.law);
    }
    j["requests"].push_back(request);
  }
  return j;
}

Json json_of(const Network& network) {
  Json j;
  Json& nodes = j["nodes"] = Json::array();
  for (const NetworkNode& n : network.nodes) {
    nodes.push_back({{"position", json_of(n.position)},
                     {"radius", n.radius},
                     {"degree", n.degree},
                     {"point", n.point},
                     {"seam", n.seam},
                     {"name", n.name}});
  }
  Json& branches = j["branches"] = Json::array();
  for (const Branch& b : network.branches) {
    branches.push_back({{"nodes", b.nodes},
                        {"points", json_of(b.points)},
                        {"radii", b.radii},
                        {"tangents", json_of(b.tangents)},
                        {"arc", b.arc}});
  }
  return j;
}

void add_blocks(Json& j, const BlockStructure& b) {
  j["nodes"] = json_of(b.nodes);
  const std::size_t per_block = b.block_nodes.size() / b.blocks.size();
  Json& blocks = j["blocks"] = Json::array();
  for (std::size_t i = 0; i < b.blocks.size(); ++i) {
    const auto first = b.block_nodes.begin() + static_cast<std::ptrdiff_t>(i * per_block);
    Json directions = Json::array();
    for (const DirectionKind kind : b.kinds[i]) {
      directions.push_back(kKinds[static_cast<int>(kind)]);
    }
    blocks.push_back({{"vertices", b.blocks[i]},
                      {"nodes", std::vector<int>(first, first + static_cast<std::ptrdiff_t>(per_block))},
                      {"directions", directions},
                      {"place", b.places[i]},
                      {"region", b.block_region[i]}});
  }
  Json& regions = j["regions"] = Json::array();
  for (const std::vector<Stretch>& region : b.regions) {
    Json stretches = Json::array();
    for (const Stretch& s : region) {
      stretches.push_back({s.branch, s.from, s.to});
    }
    regions.push_back(stretches);
  }
  Json& boundary = j["boundary"] = Json::array();
  for (const BlockStructure::BoundaryFace& f : b.boundary) {
    boundary.push_back({f.block, f.face, f.surface});
  }
  j["surfaces"] = b.surfaces;
  Json& ends = j["ends"] = Json::array();
  for (const SectionFrame& e : b.ends) {
    ends.push_back({{"origin", json_of(e.origin)}, {"x", json_of(e.x)}, {"y", json_of(e.y)}, {"radius", e.radius}});
  }
  Json& junctions = j["junctions"] = Json::array();
  for (const BlockStructure::Junction& k : b.junctions) {
    junctions.push_back({{"node", k.node},
                         {"degree", k.degree},
                         {"prototype", k.prototype},
                         {"sj_min", k.min_jacobian},
                         {"certified", k.certified},
                         {"candidates", k.candidates}});
  }
  j["certificate"] = {{"certified", b.certified}, {"scaled_jacobian_min", b.min_jacobian}};
}

// ---------------------------------------------------------------------------------------------------- reading

Vec3 vec3_of(const JsonPlace& j) {
  j.size("[x, y, z]", 3);
  return {j[0].number(), j[1].number(), j[2].number()};
}

std::vector<Vec3> points_of(const JsonPlace& j) {
  std::vector<Vec3> points(j.size("an array of [x, y, z]"));
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = vec3_of(j[i]);
  }
  return points;
}

std::vector<double> numbers_of(const JsonPlace& j, std::size_t n) {
  std::vector<double> numbers(j.size("an array of " + std::to_string(n) + " numbers", static_cast<std::int64_t>(n)));
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    numbers[i] = j[i].number();
  }
  return numbers;
}

Law law_of(const JsonPlace& j) {
  const std::string name = j["law"].text();
  if (name == "uniform") {
    return UniformLaw{};
  }
  if (name == "geometric") {
    return GeometricLaw{j["growth"].positive()};
  }
  if (name == "tanh") {
    return TanhLaw{j["stretching"].positive()};
  }
  j["law"].fail("\"uniform\", \"geometric\" or \"tanh\"");
}

Grading grading_of(const JsonPlace& j) {
  constexpr int kMost = 1'000'000;
  Grading grading;
  grading.elements = j["elements"].integer(1, kMost);
  for (const auto& [name, count] :
       {std::pair("radial", &grading.radial), std::pair("axial", &grading.axial), std::pair("core", &grading.core)}) {
    if (j.has(name)) {
      *count = j[name].integer(1, kMost);
    }
  }
  if (j.has("layers")) {
    const JsonPlace l = j["layers"];
    grading.layers = WallLayers{l["layers"].integer(1, kMost), l["first_height"].positive(), l["relative"].boolean(),
                                l["growth"].positive()};
  }
  for (std::size_t i = 0; j.has("requests") && i < j["requests"].size("an array"); ++i) {
    const JsonPlace requests = j["requests"];
    Grading::Request r{requests[i]["sheet"].text(), {}, {}};
    if (requests[i].has("count")) {
      r.count = requests[i]["count"].integer(1, kMost);
    }
    if (requests[i].has("law")) {
      r.law = law_of(requests[i]["law"]);
    }
    grading.requests.push_back(r);
  }
  return grading;
}

Network network_of(const JsonPlace& j) {
  Network network;
  const JsonPlace nodes = j["nodes"];
  for (std::size_t i = 0; i < nodes.size("an array of nodes"); ++i) {
    const JsonPlace n = nodes[i];
    network.nodes.push_back({vec3_of(n["position"]), n["radius"].positive(), n["degree"].integer(0, INT32_MAX),
                             n["point"].integer(-1, INT32_MAX), n["seam"].boolean(), n["name"].text()});
  }
  const JsonPlace branches = j["branches"];
  for (std::size_t i = 0; i < branches.size("an array of branches"); ++i) {
    Branch b;
    branches[i]["nodes"].size("two nodes", 2);
    for (int end = 0; end < 2; ++end) {
      b.nodes[end] = branches[i]["nodes"][end].integer(0, static_cast<int>(network.nodes.size()) - 1);
    }
    b.points = points_of(branches[i]["points"]);
    if (b.points.size() < 2) {
      branches[i]["points"].fail("at least two points");
    }
    b.radii = numbers_of(branches[i]["radii"], b.points.size());
    for (std::size_t k = 0; k < b.radii.size(); ++k) {
      branches[i]["radii"][k].positive();
    }
    b.tangents = points_of(branches[i]["tangents"]);
    if (b.tangents.size() != b.points.size()) {
      branches[i]["tangents"].fail("as many vectors as there are points");
    }
    b.arc = numbers_of(branches[i]["arc"], b.points.size());
    if (!std::is_sorted(b.arc.begin(), b.arc.end(), std::less_equal<>()) || b.arc[0] != 0) {
      branches[i]["arc"].fail("arc lengths that increase from 0");
    }
    network.branches.push_back(std::move(b));
  }
  return network;
}

/// Reads everything of the blocks; what they say of each other is checked afterwards.
BlockStructure blocks_of(const JsonPlace& j, const Network& network) {
  BlockStructure b;
  b.degree = j["degree"].integer(1, 20);
  b.vertex_count = j["vertex_count"].integer(8, INT32_MAX);
  b.nodes = points_of(j["nodes"]);
  const int last_node = static_cast<int>(b.nodes.size()) - 1;
  const JsonPlace regions = j["regions"];
  for (std::size_t r = 0; r < regions.size("an array of regions"); ++r) {
    auto& region = b.regions.emplace_back();
    for (std::size_t i = 0; i < regions[r].size("an array of [branch, from, to]"); ++i) {
      const JsonPlace s = regions[r][i];
      s.size("[branch, from, to]", 3);
      region.push_back(
          {s[0].integer(0, static_cast<int>(network.branches.size()) - 1), s[1].number(), s[2].number()});
    }
  }
  const int per_block = (b.degree + 1) * (b.degree + 1) * (b.degree + 1);
  const JsonPlace blocks = j["blocks"];
  if (blocks.size("an array of blocks") == 0) {
    blocks.fail("at least one block");
  }
  for (std::size_t i = 0; i < blocks.value().size(); ++i) {
    const JsonPlace block = blocks[i];
    const JsonPlace vertices = block["vertices"], nodes = block["nodes"], directions = block["directions"];
    vertices.size("8 vertices", 8);
    auto& corners = b.blocks.emplace_back();
    for (int c = 0; c < 8; ++c) {
      corners[c] = vertices[c].integer(0, b.vertex_count - 1);
    }
    nodes.size(std::to_string(per_block) + " nodes", per_block);
    for (int k = 0; k < per_block; ++k) {
      b.block_nodes.push_back(nodes[k].integer(0, last_node));
    }
    directions.size("three kinds", 3);
    auto& kinds = b.kinds.emplace_back();
    for (int d = 0; d < 3; ++d) {
      const auto kind = std::find(kKinds.begin(), kKinds.end(), directions[d].text());
      if (kind == kKinds.end()) {
        directions[d].fail("\"radial\", \"axial\" or \"core\"");
      }
      kinds[d] = static_cast<DirectionKind>(kind - kKinds.begin());
    }
    b.places.push_back(block["place"].integer(-static_cast<int>(network.nodes.size()),
                                              static_cast<int>(network.branches.size()) - 1));
    b.block_region.push_back(block["region"].integer(0, static_cast<int>(b.regions.size()) - 1));
  }
  const JsonPlace surfaces = j["surfaces"];
  for (std::size_t s = 0; s < surfaces.size("an array of names"); ++s) {
    b.surfaces.push_back(surfaces[s].text());
  }
  if (b.surfaces.empty()) {
    surfaces.fail("at least the wall");
  }
  const JsonPlace ends = j["ends"];
  ends.size("one frame for each surface but the wall", static_cast<int>(b.surfaces.size()) - 1);
  for (std::size_t e = 0; e < ends.value().size(); ++e) {
    b.ends.push_back(
        {vec3_of(ends[e]["origin"]), vec3_of(ends[e]["x"]), vec3_of(ends[e]["y"]), ends[e]["radius"].positive()});
  }
  const JsonPlace boundary = j["boundary"];
  for (std::size_t i = 0; i < boundary.size("an array of [block, face, surface]"); ++i) {
    const JsonPlace f = boundary[i];
    f.size("[block, face, surface]", 3);
    b.boundary.push_back({f[0].integer(0, static_cast<int>(b.blocks.size()) - 1), f[1].integer(0, 5),
                          f[2].integer(0, static_cast<int>(b.surfaces.size()) - 1)});
  }
  const JsonPlace junctions = j["junctions"];
  for (std::size_t i = 0; i < junctions.size("an array of junctions"); ++i) {
    const JsonPlace k = junctions[i];
    BlockStructure::Junction junction;
    junction.node = k["node"].integer(0, static_cast<int>(network.nodes.size()) - 1);
    junction.degree = k["degree"].integer(0, INT32_MAX);
    junction.prototype = k["prototype"].text();
    junction.min_jacobian = k["sj_min"].number();
    junction.certified = k["certified"].boolean();
    junction.candidates = k["candidates"].integer(0, INT32_MAX);
    b.junctions.push_back(junction);
  }
  b.certified = j["certificate"]["certified"].integer(0, static_cast<int>(b.blocks.size()));
  b.min_jacobian = j["certificate"]["scaled_jacobian_min"].number();
  return b;
}

/// Neighbours share control points, and the boundary is exactly the faces of one block.
void check_conforming(const BlockStructure& b) {
  for (std::size_t i = 0; i < b.blocks.size(); ++i) {
    auto v = b.blocks[i];
    std::sort(v.begin(), v.end());
    if (std::adjacent_find(v.begin(), v.end()) != v.end()) {
      throw Error(ErrorCode::bad_input, "blocks[" + std::to_string(i) + "].vertices names a vertex twice");
    }
  }
  BlockTopology topology;
  try {
    topology = build_topology(b.vertex_count, b.blocks);
  } catch (const Error& e) {
    throw Error(ErrorCode::bad_input, e.what());
  }
  const LatticeNumbering numbering(topology, std::vector<int>(topology.edges.size(), b.degree));
  std::vector<int> node_at(numbering.node_count(), -1), ids;
  for (std::size_t i = 0; i < b.blocks.size(); ++i) {
    numbering.block_nodes(static_cast<int>(i), ids);
    for (std::size_t k = 0; k < ids.size(); ++k) {
      const int node = b.block_nodes[i * ids.size() + k];
      int& known = node_at[ids[k]];
      if (known >= 0 && known != node) {
        throw Error(ErrorCode::bad_input, "blocks[" + std::to_string(i) + "].nodes[" + std::to_string(k) + "] is " +
                                              std::to_string(node) + ", must be " + std::to_string(known) +
                                              " as in the neighbour that shares it");
      }
      known = node;
    }
  }
  std::vector<int> listed(topology.faces.size(), 0);
  for (std::size_t i = 0; i < b.boundary.size(); ++i) {
    const int face = topology.block_faces[b.boundary[i].block][b.boundary[i].face].face;
    if (topology.face_block_count[face] != 1 || ++listed[face] > 1) {
      throw Error(ErrorCode::bad_input, "boundary[" + std::to_string(i) + "] is " +
                                            (listed[face] > 1 ? "listed twice" : "a face of two blocks") +
                                            ", must be a face of one block, once");
    }
  }
  const auto open = std::count(topology.face_block_count.begin(), topology.face_block_count.end(), 1);
  if (static_cast<std::size_t>(open) != b.boundary.size()) {
    throw Error(ErrorCode::bad_input, "boundary has " + std::to_string(b.boundary.size()) + " faces, must have the " +
                                          std::to_string(open) + " that belong to one block");
  }
}

}  // namespace

BlockFile block_file(const SkeletonMesh& mesh, const SkeletonMeshOptions& options) {
  return {mesh.network, options.surface, mesh.blocks, options.grading};
}

void write_block_file(const BlockFile& file, const std::string& path) {
  with_context("block file " + path, [&] {
    Json j;
    j["format"] = kFormat;
    j["units"] = file.blocks.units;
    j["degree"] = file.blocks.degree;
    j["control_points"] = "gauss_lobatto, i fastest";
    j["vertex_count"] = file.blocks.vertex_count;
    add_blocks(j, file.blocks);
    j["network"] = json_of(file.network);
    j["surface"] = {{"calibration_passes", file.surface.calibration_passes}};
    j["grading"] = json_of(file.grading);
    Json& sheets = j["sheets"] = Json::array();  // names, for those who look for one
    for (const Sheet& s :
         grade(file.blocks, build_topology(file.blocks.vertex_count, file.blocks.blocks), file.grading).sheets) {
      sheets.push_back(s.name);
    }
    AtomicFile out(path);
    out.stream() << j.dump() << '\n';
    out.commit();
  });
}

BlockFile read_block_file(const std::string& path) {
  return with_context("block file " + path, [&] {
    std::error_code status;
    std::ifstream in(path, std::ios::binary);
    if (!in || std::filesystem::is_directory(path, status)) {
      throw Error(ErrorCode::bad_input, "cannot be opened; check that it exists and is a file that may be read");
    }
    nlohmann::json document;
    try {
      document = nlohmann::json::parse(in);
    } catch (const nlohmann::json::exception& e) {
      const std::string what = e.what();
      const std::size_t place = what.find("parse error");
      throw Error(ErrorCode::bad_input, "not JSON: " + (place == std::string::npos ? what : what.substr(place)));
    }
    const JsonPlace j(document, "");
    if (j["format"].text() != kFormat) {
      j["format"].fail(std::string("\"") + kFormat + "\", as `vasohex blocks` writes it");
    }
    BlockFile file;
    file.network = network_of(j["network"]);
    file.surface.calibration_passes = j["surface"]["calibration_passes"].integer(0, 100);
    file.blocks = blocks_of(j, file.network);
    file.blocks.units = file.network.units = j["units"].text();
    file.grading = grading_of(j["grading"]);
    check_conforming(file.blocks);
    return file;
  });
}

std::unique_ptr<ImplicitSurface> make_surface(const BlockFile& file, const Run& run) {
  const OwnFrame frame = own_frame(file.network);
  return std::make_unique<MovedSurface>(make_convolution_surface(in_frame(file.network, frame), file.surface, run),
                                        frame);
}

MeshResult mesh_blocks(const BlockFile& file, const Grading& grading, const MeshOptions& options, const Run& run) {
  return std::move(mesh_part(file, grading, options, 0, 1, run).result);
}

}  // namespace vasohex
