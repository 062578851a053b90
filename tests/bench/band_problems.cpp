#include "band_problems.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>

#include "../kernel/meshes.h"
#ifdef PHRONT_BENCH_CAD
#include "phront/cad/exchange.h"
#include "phront/cad/tessellate.h"
#endif

namespace phront::bench {
namespace {

constexpr double kCells = 200;  // along the largest side

BandProblem problemOf(std::string name, TriMesh mesh) {
  const double h = boundingBox(mesh).sizes().maxCoeff() / kCells;
  return {std::move(name), std::move(mesh), h, false};
}

#ifdef PHRONT_BENCH_CAD
void addParts(std::vector<BandProblem>& problems) {
  const char* given = std::getenv("PHRONT_BENCH_PARTS");
  std::string list = given == nullptr ? "" : given;
  while (!list.empty()) {
    const std::size_t end = list.find(':');
    const std::filesystem::path path = list.substr(0, end);
    list = end == std::string::npos ? "" : list.substr(end + 1);
    const auto model = cad::readModel(path);
    if (!model || model->bodies.empty()) {
      fmt::print(stderr, "{}: left out, it cannot be read\n", path.string());
      continue;
    }
    const cad::Body& body = model->bodies.front();
    const double diagonal = cad::boundingBox(body.shape).diagonal().norm();
    auto tessellation = cad::tessellate(body, {.deflection = 1e-4 * diagonal});
    if (!tessellation) {
      fmt::print(stderr, "{}: left out, no triangles\n", path.string());
      continue;
    }
    problems.push_back(problemOf(path.stem().string(), std::move(tessellation->mesh)));
  }
}
#endif

std::vector<BandProblem> allProblems() {
  std::vector<BandProblem> problems;
  problems.push_back(problemOf("sphere_20k", test::icosphere(5)));
  problems.back().isSphere = true;
  problems.push_back(problemOf("torus_500k", test::torus(2, 0.6, 1000, 250)));
#ifdef PHRONT_BENCH_CAD
  addParts(problems);
#endif
  for (const BandProblem& p : problems) {
    fmt::print("{}: {} triangles, h = {:g}\n", p.name, p.mesh.triangles.size(), p.h);
  }
  return problems;
}

}  // namespace

const std::vector<BandProblem>& bandProblems() {
  static const std::vector<BandProblem> problems = allProblems();
  return problems;
}

}  // namespace phront::bench
