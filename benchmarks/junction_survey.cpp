// Meshes seeded random junctions, nasty and named ones and random networks, and prints tables in Markdown of what
// came out, which docs/quality.md holds. What falls short of its goal is listed by name, whatever it is.
//
//   junction_survey                                  all of it
//   junction_survey --kinds random --count 10        ten junctions of each number of branches
//   junction_survey --only k7/12 --orders 3 --vtu k7_12.vtu
//   junction_survey --write docs/quality.md          puts the tables between the markers there

#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "survey_cases.h"
#include "survey_figures.h"
#include "vasohex/core/atomic_file.h"
#include "vasohex/core/parallel.h"
#include "vasohex/quality/scaled_jacobian.h"
#include "vtk/write_vtu.h"

namespace vasohex::survey {
namespace {

constexpr const char* kBegin = "<!-- survey -->";
constexpr const char* kEnd = "<!-- /survey -->";

struct Options {
  std::vector<std::string> kinds;
  std::vector<int> orders;
  std::optional<int> count;
  std::vector<std::string> only;
  int threads = 0;
  std::string write, json, vtu;
  bool list = false;
};

std::vector<int> orders_of(Kind kind, const Options& options) {
  if (!options.orders.empty()) {
    return options.orders;
  }
  return kind == Kind::random ? std::vector<int>{1, 2, 3, 4} : std::vector<int>{1, 3};
}

std::vector<Case> chosen_cases(const Options& options) {
  std::vector<Case> chosen;
  for (const Kind kind : all_kinds()) {
    if (!options.kinds.empty() &&
        std::find(options.kinds.begin(), options.kinds.end(), name_of(kind)) == options.kinds.end()) {
      continue;
    }
    for (Case& c : cases_of(kind, options.count)) {
      if (options.only.empty() || std::find(options.only.begin(), options.only.end(), c.name) != options.only.end()) {
        chosen.push_back(std::move(c));
      }
    }
  }
  if (chosen.empty()) {
    throw Error(ErrorCode::bad_input, "no such case; --list shows their names");
  }
  return chosen;
}

/// Every case at every order, side by side; the result is in their order.
std::vector<Figures> survey(const std::vector<Case>& cases, const Options& options) {
  std::vector<std::pair<const Case*, int>> jobs;
  for (const Case& c : cases) {
    for (const int order : orders_of(c.kind, options)) {
      jobs.emplace_back(&c, order);
    }
  }
  std::vector<Figures> figures(jobs.size());
  std::atomic<int> done = 0;
  Run run;
  run.threads = options.threads;
  parallel_for(run, jobs.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      figures[i] = measure(*jobs[i].first, jobs[i].second);
      const Figures& f = figures[i];
      std::fprintf(stderr, "%d of %zu: %s order %d, min %.3f%s\n", ++done, jobs.size(), f.subject->name.c_str(),
                   f.order, f.min, f.certified() ? "" : ", NOT CERTIFIED");
    }
  });
  return figures;
}

/// A file whose text between the markers can be replaced.
struct MarkedFile {
  std::string path, before, after;

  explicit MarkedFile(const std::string& file) : path(file) {
    std::ifstream in(path, std::ios::binary);
    std::stringstream read;
    read << in.rdbuf();
    const std::string text = read.str();
    const std::size_t begin = text.find(kBegin), end = text.find(kEnd);
    if (!in || begin == std::string::npos || end == std::string::npos || end < begin) {
      throw Error(ErrorCode::bad_input, path + ": must hold the lines " + kBegin + " and " + kEnd);
    }
    before = text.substr(0, begin) + kBegin + '\n';
    after = text.substr(end);
  }
  void write(const std::string& between) const {
    AtomicFile file(path);
    file.stream() << before << between << after;
    file.commit();
  }
};

void write_vtu_of(const Case& subject, int order, const std::string& path) {
  SkeletonMesh m;
  const Figures f = measure(subject, order, &m);
  if (!f.error.empty()) {
    throw Error(ErrorCode::bad_input, subject.name + ": " + f.error);
  }
  const HexMesh& mesh = m.result.mesh;
  const std::vector<double> quality = scaled_jacobian(mesh.order, mesh.family, mesh.nodes, mesh.elements);
  const CellScalars scalars[]{{"scaled_jacobian", quality}};
  write_vtu(mesh, path, scalars);
}

void run(const Options& options) {
  const std::vector<Case> cases = chosen_cases(options);
  std::optional<MarkedFile> page;
  if (!options.write.empty()) {
    page.emplace(options.write);  // before the work: it may not be usable
  }
  if (options.list) {
    for (const Case& c : cases) {
      std::printf("%s\n", c.name.c_str());
    }
    return;
  }
  if (!options.vtu.empty()) {
    if (cases.size() != 1 || options.orders.size() != 1) {
      throw Error(ErrorCode::bad_input, "--vtu: one case and one order, please: --only NAME --orders P");
    }
    write_vtu_of(cases.front(), options.orders.front(), options.vtu);
  }
  const std::vector<Figures> figures = survey(cases, options);
  std::string tables =
      "## Survey of junctions\n\nWritten by `benchmarks/junction_survey.cpp`, 6 elements per block edge. "
      "*Certified*: all "
      "elements and all blocks.\n";
  std::string lists;
  for (const Kind kind : all_kinds()) {
    std::vector<Figures> of_kind;
    std::copy_if(figures.begin(), figures.end(), std::back_inserter(of_kind),
                 [&](const Figures& f) { return f.subject->kind == kind; });
    if (!of_kind.empty()) {
      tables += "\n" + table(kind, of_kind);
      lists += shortfalls(of_kind);
    }
  }
  std::printf("%s", tables.c_str());
  std::printf("\n%s%s", lists.empty() ? "" : "Below the goal or not certified:\n", lists.c_str());
  if (page) {
    page->write(tables);
  }
  if (!options.json.empty()) {
    AtomicFile file(options.json);
    file.stream() << json(figures);
    file.commit();
  }
}

}  // namespace
}  // namespace vasohex::survey

int main(int argc, char** argv) {
  vasohex::survey::Options options;
  CLI::App app("Meshes random, nasty and named junctions and random networks; prints tables of their quality");
  app.add_option("--kinds", options.kinds, "Tables to make: random,nasty,named,trees; default: all")
      ->delimiter(',')
      ->check(CLI::IsMember({"random", "nasty", "named", "trees"}));
  app.add_option("--orders", options.orders, "Polynomial orders; default: 1,2,3,4 for random, 1,3 for the others")
      ->delimiter(',')
      ->check(CLI::Range(1, 9));
  app.add_option("--count", options.count,
                 "Seeds of junctions of 3 to 5 branches and of networks; of more branches a quarter")
      ->check(CLI::PositiveNumber);
  app.add_option("--only", options.only, "This case alone, by its name: k7/12, \"Y 20\"; may be given several times");
  app.add_option("--threads", options.threads, "Cases side by side, each on one thread; 0: all cores")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--write", options.write, "Markdown file whose text between the survey's markers is replaced");
  app.add_option("--json", options.json, "File for all figures of all cases");
  app.add_option("--vtu", options.vtu, "File for the mesh of the one case at the one order");
  app.add_flag("--list", options.list, "Print the names of the cases");
  CLI11_PARSE(app, argc, argv);
  try {
    vasohex::survey::run(options);
  } catch (const vasohex::Error& e) {
    std::fprintf(stderr, "error: %s\n", e.what());
    return 2;
  }
  return 0;
}
