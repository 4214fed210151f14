#include "input.h"

#include <algorithm>
#include <filesystem>

#include "json_point.h"
#include "option_checks.h"
#include "vasohex/core/short_text.h"
#include "vasohex/core/text_lines.h"
#include "vasohex/skeleton/extract_skeleton.h"
#include "vasohex/skeleton/label_skeleton.h"
#include "vasohex/skeleton/read_skeleton.h"
#include "vasohex/surface/read_surface.h"
#include "vasohex/surface/smooth_surface.h"
#include "vasohex/surface/triangle_surface.h"
#ifdef VASOHEX_HAS_VTK
#include "vtk/read_labelmap.h"
#include "vtk/read_poly_surface.h"
#endif

namespace vasohex::cli {
namespace {

/// Triangles beside which inside and outside are checked: each takes a sum over all triangles.
constexpr int kSignSamples = 100;

enum class Kind { skeleton, surface, labelmap };

Kind kind_of(const std::string& path) {
  const std::string ext = lower_extension(path);
  const auto is_one_of = [&](std::initializer_list<const char*> all) {
    return std::find(all.begin(), all.end(), ext) != all.end();
  };
  if (is_one_of({".swc", ".json"})) {
    return Kind::skeleton;
  }
  if (is_one_of({".stl", ".ply", ".obj", ".off", ".vtp", ".vtk"})) {
    return Kind::surface;
  }
  if (is_one_of({".nii", ".nrrd", ".mha", ".mhd", ".vti"}) ||
      (ext == ".gz" && lower_extension(std::filesystem::path(path).stem()) == ".nii")) {
    return Kind::labelmap;
  }
  throw Error(
      ErrorCode::bad_input,
      path + ": unknown extension '" + ext +
          "'; a skeleton is .swc or .json, a surface .stl, .ply, .obj, .off, .vtp or .vtk, a labelmap .nii, .nii.gz, "
          ".nrrd, .mha, .mhd or .vti");
}

[[noreturn, maybe_unused]] void needs_vtk(const std::string& path) {
  usage(path + ": this program was built without VTK, which reads " + lower_extension(path) + " files");
}

TriSurface read_triangles(const std::string& path) {
  if (lower_extension(path) != ".vtp" && lower_extension(path) != ".vtk") {
    return read_surface(path);
  }
#ifdef VASOHEX_HAS_VTK
  return read_poly_surface(path);
#else
  needs_vtk(path);
#endif
}

void load_surface(const Input& input, const std::string& path, bool with_skeleton, const Run& run, Loaded& loaded) {
  TriSurface triangles = read_triangles(path);
  if (!input.units.empty()) {
    triangles.units = input.units;
  }
  const auto prepared =
      std::make_shared<PreparedSurface>(with_context(path, [&] { return prepare_surface(std::move(triangles)); }));
  loaded.repairs.insert(loaded.repairs.end(), prepared->repairs.begin(), prepared->repairs.end());
  *loaded.figures = {{"file", path},
                     {"triangles", prepared->surface.triangles.size()},
                     {"components", prepared->components},
                     {"ends", prepared->ends.size()}};
  if (with_skeleton) {
    Extraction extraction =
        with_context(path, [&] { return extract_skeleton(prepared->surface, prepared->ends, {}, run); });
    loaded.skeleton = std::move(extraction.skeleton);
    loaded.skeleton.units = prepared->surface.units;
    loaded.repairs.insert(loaded.repairs.end(), extraction.notes.begin(), extraction.notes.end());
  }
  loaded.lumen.emplace();
  loaded.lumen->ends = prepared->ends;
  loaded.lumen->surface = [prepared, facets = input.facets, figures = loaded.figures,
                           run](const Network& network) -> std::shared_ptr<const ImplicitSurface> {
    auto triangles = std::make_shared<TriangleSurface>(*prepared, network);
    const SignCheck sign = check_sign(*triangles, kSignSamples);
    (*figures)["winding_number"] = {{"points", sign.samples}, {"contradictions", sign.contradictions}};
    if (sign.contradictions > 0) {
      (*figures)["winding_number"]["at"] = xyz(sign.place);
    }
    if (facets) {
      (*figures)["kind"] = "facets";
      return triangles;
    }
    SmoothSurface smooth = make_smooth_surface(*prepared, network, {}, run);
    const SmoothReport& r = smooth.report;
    (*figures)["kind"] = "smooth";
    (*figures)["deviation"] = {{"max", r.deviation_max}, {"mean", r.deviation_mean}, {"at", xyz(r.deviation_place)}};
    (*figures)["points"] = {
        {"all", r.points}, {"curved_triangles", r.curved}, {"facets", r.flat}, {"creases", r.creased}};
    return std::move(smooth.surface);
  };
  loaded.lumen->wall = [prepared](const ImplicitSurface& surface) { return points_on(prepared->surface, surface); };
}

void load_labelmap(const Input& input, const std::string& path, bool with_skeleton, const Run& run, Loaded& loaded) {
#ifdef VASOHEX_HAS_VTK
  const auto volume = std::make_shared<LabelVolume>(read_labelmap(path, input.labels));
  if (!input.units.empty()) {
    volume->units = input.units;
  }
  LabelSkeleton found = with_context(path, [&] { return extract_skeleton(*volume, {}, run); });
  loaded.repairs.insert(loaded.repairs.end(), found.repairs.begin(), found.repairs.end());
  *loaded.figures = {{"file", path},
                     {"voxels", std::count(volume->inside.begin(), volume->inside.end(), 1)},
                     {"components", found.components},
                     {"tunnels", found.tunnels},
                     {"ends", found.ends.size()},
                     {"kind", "level set"}};
  if (with_skeleton) {
    loaded.skeleton = std::move(found.skeleton);
    loaded.skeleton.units = volume->units;
  }
  loaded.lumen.emplace();
  loaded.lumen->ends = found.ends;
  loaded.lumen->surface = [level_set =
                               found.level_set](const Network& network) -> std::shared_ptr<const ImplicitSurface> {
    return make_level_set_surface(level_set, network);
  };
  loaded.lumen->wall = [volume](const ImplicitSurface& surface) { return points_on(*volume, surface); };
#else
  (void)input, (void)with_skeleton, (void)run, (void)loaded;
  needs_vtk(path);
#endif
}

}  // namespace

void Input::add_to(CLI::App& command) {
  command
      .add_option("INPUT", path,
                  "Skeleton (.swc, .json), surface (.stl, .ply, .obj, .off, .vtp, .vtk) or labelmap (.nii, .nii.gz, "
                  ".nrrd, .mha, .mhd, .vti)")
      ->required();
  command.add_option("--skeleton", skeleton, "Skeleton of a surface or labelmap, instead of one found in it");
  command.add_option("--surface", surface, "Surface or labelmap that the mesh of a skeleton conforms to");
  command.add_option("--labels", labels, "Labels of a labelmap that are lumen; default: all above 0");
  command.add_flag("--facets", facets, "Follow the facets of a surface exactly, instead of a smooth surface");
  command.add_option("--units", units, "Unit of the input: um, mm, cm or m. Overrides what the file says")
      ->check(CLI::IsMember({"um", "mm", "cm", "m"}));
  command.add_option("--inlet", inlet, "Point of the skeleton (index from 0, in file order) whose end is the inlet")
      ->check(whole_number(0));
}

void Input::add_repair(CLI::App& command, SkeletonMeshOptions& options) {
  command.add_flag("--repair", options.repair,
                   "Part vessels that overlap or touch, leave out stray pieces and branches that end inside others");
}

bool Input::has_lumen() const { return kind_of(path) != Kind::skeleton || !surface.empty(); }

bool Input::has_triangles() const {
  return has_lumen() && kind_of(surface.empty() ? path : surface) == Kind::surface;
}

std::vector<std::string> Input::files() const {
  std::vector<std::string> all{path};
  for (const std::string& file : {skeleton, surface}) {
    if (!file.empty()) {
      all.push_back(file);
    }
  }
  return all;
}

Loaded load(const Input& input, const Run& run) {
  const Kind kind = kind_of(input.path);
  if (kind == Kind::skeleton && !input.skeleton.empty()) {
    usage("--skeleton " + input.skeleton + ": " + input.path + " is a skeleton already; give its lumen by --surface");
  }
  if (kind != Kind::skeleton && !input.surface.empty()) {
    usage("--surface " + input.surface + ": " + input.path + " is a lumen already; give its skeleton by --skeleton");
  }
  const std::string skeleton = kind == Kind::skeleton ? input.path : input.skeleton;
  const std::string lumen = kind == Kind::skeleton ? input.surface : input.path;
  if (!skeleton.empty() && kind_of(skeleton) != Kind::skeleton) {
    usage("--skeleton " + skeleton + ": not a skeleton; give a .swc or .json file");
  }
  if (!lumen.empty() && kind_of(lumen) == Kind::skeleton) {
    usage("--surface " + lumen + ": not a lumen; give a surface or a labelmap");
  }
  const bool of_labels = !lumen.empty() && kind_of(lumen) == Kind::labelmap;
  if (!input.labels.empty() && !of_labels) {
    usage("--labels: there is no labelmap");
  }
  if (input.facets && (lumen.empty() || of_labels)) {
    usage("--facets: there is no surface of triangles");
  }
  Loaded loaded;
  if (!skeleton.empty()) {
    loaded.skeleton = read_skeleton(skeleton);
    if (!input.units.empty()) {
      loaded.skeleton.units = input.units;
    }
  }
  if (of_labels) {
    load_labelmap(input, lumen, skeleton.empty(), run, loaded);
  } else if (!lumen.empty()) {
    load_surface(input, lumen, skeleton.empty(), run, loaded);
  }
  return loaded;
}

SkeletonMesh mesh(const Input& input, const Loaded& loaded, SkeletonMeshOptions options, const Run& run) {
  options.network.inlet = input.inlet;
  SkeletonMesh m = with_context(input.path, [&] {
    return loaded.lumen ? mesh_lumen(loaded.skeleton, *loaded.lumen, options, run)
                        : mesh_skeleton(loaded.skeleton, options, run);
  });
  m.network.repairs.insert(m.network.repairs.begin(), loaded.repairs.begin(), loaded.repairs.end());
  return m;
}

}  // namespace vasohex::cli
