#include "offset_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "phront/advect.h"
#include "phront/cad/offset_shape.h"
#include "phront/cad/tessellate.h"
#include "phront/iso_surface.h"
#include "phront/mesh_io.h"
#include "phront/surface_distance.h"

namespace phront::cli {
namespace {

// Triangles of a part follow its faces to this share of |d|.
constexpr double kDeflectionOfDistance = 0.002;

// Triangles between exact nodes cut their chords; this share of |d| is what a mesh may miss by
// default. A finer mesh is a smaller --tol away.
constexpr double kMeshToleranceOfDistance = 0.05;

struct MeshOffset {
  TriMesh mesh;
  double p99 = 0;  ///< 99th percentile by area of |phi - d| at triangle centres
  double largest = 0;
  Index stopped = 0;     ///< nodes that met another front before d
  bool bridged = false;  ///< gaps in the surface did not count
  bool open = false;     ///< so the result may be, too
};

// Area-weighted | phi - d | at the triangles' centres and corners.
void measure(const SurfaceDistance& surface, double distance, MeshOffset& offset) {
  std::vector<std::pair<double, double>> errors;  // error, area
  double total = 0;
  for (const auto& t : offset.mesh.triangles) {
    const Vec3& a = offset.mesh.points[static_cast<std::size_t>(t[0])];
    const Vec3& b = offset.mesh.points[static_cast<std::size_t>(t[1])];
    const Vec3& c = offset.mesh.points[static_cast<std::size_t>(t[2])];
    const double weight = 0.5 * (b - a).cross(c - a).norm();
    const double error = std::abs(surface.signedDistance((a + b + c) / 3) - distance);
    errors.emplace_back(error, weight);
    total += weight;
  }
  std::sort(errors.begin(), errors.end());
  double sum = 0;
  for (const auto& [error, weight] : errors) {
    sum += weight;
    if (sum <= 0.99 * total) offset.p99 = error;
    offset.largest = error;
  }
}

// Grid spacing at which chords over the tightest curvature of an offset, 1/|d|, stay within the
// tolerance: h^2 / (8 |d|) = tolerance / 2, if the automatic spacing is not finer already.
double spacingFor(double distance, double tolerance) {
  return std::sqrt(4 * tolerance * std::abs(distance));
}

double toleranceOf(std::optional<double> asked, double distance) {
  return asked.value_or(kMeshToleranceOfDistance * std::abs(distance));
}

Result<MeshOffset> offsetOne(TriMesh mesh, double distance, bool parametric, double tolerance,
                             const CommonOptions& options, const Progress& progress) {
  // The front passes over what is narrower than |d| as if it were not there.
  const Result<SurfaceDistance> surface =
      SurfaceDistance::build(std::move(mesh), SignRule::Topology, std::abs(distance));
  if (!surface) return tl::unexpected(surface.error());
  MeshOffset offset;
  offset.open = !surface->closed();
  offset.bridged = surface->closed() && !surface->watertight();
  if (parametric) {
    AdvectOptions advect;
    advect.distance = distance;
    advect.threads = options.threads;
    const Result<AdvectResult> moved = advectMesh(*surface, advect, progress);
    if (!moved) return tl::unexpected(moved.error());
    offset.mesh = surface->mesh();
    offset.mesh.points = moved->points;
    offset.stopped = static_cast<Index>(
        std::count_if(moved->status.begin(), moved->status.end(),
                      [](AdvectStatus s) { return s != AdvectStatus::Arrived; }));
  } else {
    IsoSurfaceOptions iso;
    iso.level = distance;
    iso.threads = options.threads;
    iso.largestSpacing = spacingFor(distance, tolerance);
    Result<IsoSurface> front = isoSurface(*surface, iso, progress);
    if (!front) return tl::unexpected(front.error());
    offset.mesh = std::move(front->mesh);
  }
  measure(*surface, distance, offset);
  return offset;
}

int finish(const MeshOffset& offset, const TriMesh& in, const std::filesystem::path& inPath,
           const std::filesystem::path& out, double distance, bool parametric,
           std::optional<double> tolerance, const CommonOptions& options) {
  endProgress(options);
  if (interrupted()) return kInterrupted;
  const double allowed = toleranceOf(tolerance, distance);
  const nlohmann::json report = {{"distance", distance},
                                 {"tolerance", allowed},
                                 {"points", offset.mesh.points.size()},
                                 {"triangles", offset.mesh.triangles.size()},
                                 {"deviation_p99", offset.p99},
                                 {"deviation_max", offset.largest},
                                 {"nodes_stopped", offset.stopped}};
  if (const Result<void> ok = writeReport(report, options); !ok) return reportError(ok.error());
  if (offset.mesh.triangles.empty()) {
    if (!options.quiet)
      fmt::print(stderr, "the part is thinner than 2|d| everywhere: its offset is empty\n");
    return kDone;
  }
  // Moved nodes are judged as nodes: the triangles between them are the input's own.
  const bool pass = parametric ? offset.stopped == 0 : offset.p99 <= allowed;
  const std::filesystem::path target = pass || options.keep ? out : cad::rejectedPath(out);
  if (const Result<void> ok = writeMesh(offset.mesh, target); !ok) return reportError(ok.error());
  if (const Result<void> ok = drawMeshes(in, inPath.filename().string(), offset.mesh,
                                         fmt::format("offset {:+g}", distance), options);
      !ok)
    return reportError(ok.error());
  const std::string figures = fmt::format(
      "{} points, {} triangles; measured deviation {:.3g} (99 % of the area), largest {:.3g}",
      offset.mesh.points.size(), offset.mesh.triangles.size(), offset.p99, offset.largest);
  if (pass) {
    if (!options.quiet) fmt::print(stderr, "{}: {}\n", target.string(), figures);
    return kDone;
  }
  const std::string why =
      offset.stopped > 0
          ? fmt::format("{} node(s) met another part of the front before the distance was reached",
                        offset.stopped)
          : fmt::format("the deviation is above the tolerance of {:.3g}", allowed);
  return reportError({ErrorCode::OutOfTolerance,
                      fmt::format("{}; written to {}: {}", why, target.string(), figures),
                      {}});
}

}  // namespace

int offsetMeshFile(const std::filesystem::path& in, const std::filesystem::path& out,
                   double distance, bool parametric, std::optional<double> tolerance,
                   const CommonOptions& options) {
  const Result<TriMesh> mesh = readSurface(in, options);
  if (!mesh) return reportError(mesh.error());
  const Result<MeshOffset> offset =
      offsetOne(*mesh, distance, parametric, toleranceOf(tolerance, distance), options,
                makeProgress(options));
  if (!offset) {
    endProgress(options);
    return reportError(offset.error());
  }
  if ((offset->bridged || offset->open) && !options.quiet) {
    endProgress(options);
    fmt::print(stderr, "warning: {}\n",
               offset->bridged
                   ? "gaps in the mesh, all narrower than |d|, were bridged"
                   : "openings of the mesh are not offset; the result has borders there");
  }
  return finish(*offset, *mesh, in, out, distance, parametric, tolerance, options);
}

int offsetModelToMesh(const cad::Model& model, const std::filesystem::path& in,
                      const std::filesystem::path& out, double distance, bool parametric,
                      std::optional<double> tolerance, const CommonOptions& options) {
  TriMesh input;
  MeshOffset all;
  const Progress progress = makeProgress(options);
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const double count = static_cast<double>(model.bodies.size());
    cad::TessellateOptions tessellation;
    tessellation.distance = std::abs(distance);
    tessellation.deflection = kDeflectionOfDistance * std::abs(distance);
    tessellation.smoothTolerance = tessellation.deflection;
    Result<cad::Tessellation> mesh = cad::tessellate(model.bodies[i], tessellation);
    if (!mesh) {
      endProgress(options);
      return reportError(mesh.error());
    }
    appendMesh(input, mesh->mesh);
    const Result<MeshOffset> offset = offsetOne(
        std::move(mesh->mesh), distance, parametric, toleranceOf(tolerance, distance), options,
        progress.part(static_cast<double>(i) / count, (i + 1.0) / count, "front"));
    if (!offset) {
      endProgress(options);
      return reportError(offset.error());
    }
    appendMesh(all.mesh, offset->mesh);
    all.p99 = std::max(all.p99, offset->p99);
    all.largest = std::max(all.largest, offset->largest);
    all.stopped += offset->stopped;
  }
  return finish(all, input, in, out, distance, parametric, tolerance, options);
}

}  // namespace phront::cli
