// A blood vessel that forks, offset outwards (its wall) and inwards (a boundary layer): the points
// of the mesh are advected, its triangles stay. On a made-up vessel, and on a scan where there is
// one.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "carotid/figure.h"
#include "carotid/schemes.h"
#include "common/bifurcation.h"
#include "common/continued.h"
#include "common/mesh_change.h"
#include "common/report.h"
#include "phront/mesh_io.h"

using namespace thesis;
using phront::AdvectResult;
using phront::AdvectStatus;
using phront::TriMesh;

namespace {

TriMesh moved(const TriMesh& mesh, const AdvectResult& front) {
  TriMesh image = mesh;
  image.points = front.points;
  return image;
}

struct Landing {
  int arrived = 0;
  Norms offLevel;  // of those that arrived
};

Landing landing(const phront::SurfaceDistance& wall, const AdvectResult& front, double distance) {
  Landing result;
  double squares = 0;
  for (std::size_t p = 0; p < front.points.size(); ++p) {
    if (front.status[p] != AdvectStatus::Arrived) continue;
    const double error = std::abs(wall.foot(front.points[p]).distance - std::abs(distance));
    ++result.arrived;
    result.offLevel.max = std::max(result.offLevel.max, error);
    squares += error * error;
  }
  result.offLevel.rms = std::sqrt(squares / std::max(result.arrived, 1));
  return result;
}

/// What nine in ten points of the borders do not exceed: from where the exact scheme brings them.
/// (Not all: scans are cut off, which leaves triangles on the border that have no normal.)
double slip(const TriMesh& mesh, const AdvectResult& front, const AdvectResult& exact) {
  std::vector<double> ways;
  for (const auto& border : borders(mesh)) {
    for (const phront::Index point : border) {
      const auto p = static_cast<std::size_t>(point);
      if (exact.status[p] != AdvectStatus::Arrived) continue;
      ways.push_back((front.points[p] - exact.points[p]).norm());
    }
  }
  if (ways.empty()) return 0;
  const auto tenth = ways.begin() + static_cast<std::ptrdiff_t>(9 * (ways.size() - 1) / 10);
  std::nth_element(ways.begin(), tenth, ways.end());
  return *tenth;
}

std::string schemeName(const Run& run) {
  return run.spacing > 0 ? fmt::format("grid, h {:g}", run.spacing) : "exact";
}
std::string endsName(const Run& run) { return run.ends == Ends::Free ? "free" : "continued"; }

void printLandings(const std::string& title, const TriMesh& mesh, const std::vector<Run>& runs,
                   const std::filesystem::path& csv) {
  const auto wall = orStop(phront::SurfaceDistance::build(mesh));
  Table table(
      title,
      fmt::format("mm; max, rms: of ||phi| - |d|| over the points that arrived, phi to the "
                  "triangles; slip: of a border's point against the exact scheme, 9 in 10 have "
                  "less; inverted: normal turned by over 90 degrees; crossed: triangles that "
                  "others go through; ends continued: longer by {:g} and closed for the field",
                  kContinued),
      {"scheme", "ends", "d", "arrived", "max", "rms", "slip", "inverted", "of area", "crossed"});
  for (const Run& run : runs) {
    for (std::size_t i = 0; i < kDistances.size(); ++i) {
      const AdvectResult& front = run.fronts[i];
      const auto [arrived, offLevel] = landing(wall, front, kDistances[i]);
      const TriMesh image = moved(mesh, front);
      const Inverted turned = inverted(mesh, image);
      table.row({schemeName(run), endsName(run), fmt::format("{:+g}", kDistances[i]),
                 fmt::format("{}", arrived), fmt::format("{:.2g}", offLevel.max),
                 fmt::format("{:.2g}", offLevel.rms),
                 fmt::format("{:.2g}", slip(mesh, front, runs.front().fronts[i])),
                 fmt::format("{}", turned.triangles), fmt::format("{:.1g}", turned.areaShare),
                 fmt::format("{}", crossedTriangles(image))});
    }
  }
  table.print();
  table.writeCsv(csv);
}

void printTimes(const std::string& title, const std::vector<Run>& runs,
                const std::filesystem::path& csv) {
  const auto name = [](const std::string& what, double distance) {
    return fmt::format("{} {:+g}", what, distance);
  };
  Table table(title + ": seconds on one thread",
              "seed: exact distances near the wall (exact scheme: tree of triangles); sweep: all "
              "sweeps, and signs; iso: phi = d as a surface, on a grid of that h with exact values "
              "of its own; advect: all points",
              {"scheme", "ends", "nodes", "seed", "sweep", name("iso", kWall), name("iso", kLayer),
               name("advect", kWall), name("advect", kLayer)});
  for (const Run& run : runs) {
    std::vector<std::string> row{schemeName(run), endsName(run)};
    row.push_back(run.nodes > 0 ? fmt::format("{}", run.nodes) : "-");
    row.push_back(fmt::format("{:.3f}", run.seed));
    for (const double seconds : {run.sweep, run.iso[0], run.iso[1]}) {
      row.push_back(run.nodes > 0 ? fmt::format("{:.3f}", seconds) : "-");
    }
    for (const double seconds : run.advect) row.push_back(fmt::format("{:.3f}", seconds));
    table.row(std::move(row));
  }
  table.print();
  table.writeCsv(csv);
}

void offsetBothWays(const std::string& name, const std::string& what, const TriMesh& mesh,
                    double coarsest, const std::filesystem::path& folder) {
  std::vector<Run> runs{exactScheme(mesh), gridScheme(mesh, coarsest, Ends::Free)};
  for (const double h : {coarsest, coarsest / 2, coarsest / 4}) {
    runs.push_back(gridScheme(mesh, h, Ends::Continued));
  }
  const std::string title =
      fmt::format("{}, {} points, {} triangles, {} free borders: so have its offsets", what,
                  mesh.points.size(), mesh.triangles.size(), borders(mesh).size());
  printLandings(title, mesh, runs, folder / (name + "_landings.csv"));
  printTimes(what, runs, folder / (name + "_times.csv"));

  const Run& finest = runs.back();
  orStop(phront::writeMesh(mesh, folder / (name + ".vtu")));
  orStop(phront::writeMesh(moved(mesh, finest.fronts[0]), folder / (name + "_wall.vtu")));
  orStop(phront::writeMesh(moved(mesh, finest.fronts[1]), folder / (name + "_layer.vtu")));
  drawVessel(name, mesh, finest, folder / (name + ".png"));
}

}  // namespace

int main(int argc, char** argv) {
  const auto folder = outputFolder(argc, argv);
  offsetBothWays("bifurcation", "made-up bifurcation", bifurcation(36), 0.4, folder);

  const std::filesystem::path scan = argc > 2 ? argv[2] : "../shared/cases/carotid.stl";
  if (!std::filesystem::exists(scan)) {
    fmt::print("no scan of a carotid artery at {}: left out\n", scan.string());
    return 0;
  }
  offsetBothWays("carotid", "carotid artery of a patient", orStop(phront::readMesh(scan)), 0.2,
                 folder);
}
