#include "judge/wall_verdict.h"

#include <fmt/format.h>

#include <BRep_Builder.hxx>
#include <TopoDS_Compound.hxx>
#include <nlohmann/json.hpp>

#include "exchange/guard.h"
#include "patches/patch_tools.h"
#include "phront/cad/shape_occt.h"

namespace phront::cad {
namespace {

using Json = nlohmann::json;

constexpr double kShareBeyond = 0.01;  // of the area may be off by more than the tolerance
constexpr double kMaxFactor = 10;      // largest deviation allowed, in tolerances
constexpr double kBuried = 0.002;
constexpr double kDeflectionOfDiagonal = 4e-4;
constexpr double kDeflectionOfThickness = 0.015;
// Of the time: what takes longer to tessellate is measured from coarser triangles.
constexpr double kMeshShare = 0.4;
constexpr int kPerFace = 20;  // samples, at least
constexpr int kBuriedSamples = 6000;

std::string at(const Vec3& p) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x(), p.y(), p.z());
}

std::string bytesOf(const CheckResult& r) {
  const Json json =
      Json::array({r.solids, r.shells, r.faces, r.valid, r.closed, r.volume, r.accuracyP99,
                   r.accuracyMax, r.coverageP99, r.coverageMax, r.buried, r.untessellatedFaces,
                   r.worstPoint.x(), r.worstPoint.y(), r.worstPoint.z(), r.reasons});
  std::string bytes;
  Json::to_cbor(json, bytes);
  return bytes;
}

CheckResult resultOf(const std::string& bytes) {
  const Json json = Json::from_cbor(bytes);
  CheckResult r;
  std::size_t next = 0;
  const auto read = [&](auto& value) { json.at(next++).get_to(value); };
  read(r.solids);
  read(r.shells);
  read(r.faces);
  read(r.valid);
  read(r.closed);
  read(r.volume);
  read(r.accuracyP99);
  read(r.accuracyMax);
  read(r.coverageP99);
  read(r.coverageMax);
  read(r.buried);
  read(r.untessellatedFaces);
  read(r.worstPoint.x());
  read(r.worstPoint.y());
  read(r.worstPoint.z());
  read(r.reasons);
  return r;
}

void judgeTopology(const TopologyFigures& t, CheckResult& result) {
  result.solids = t.solids;
  result.shells = t.shells;
  result.faces = t.faces;
  result.valid = t.valid;
  result.closed = t.closed();
  result.volume = t.volume;
  if (!t.valid) result.reasons.emplace_back("OpenCASCADE's BRepCheck finds the shell invalid.");
  if (t.solids == 0) result.reasons.emplace_back("The shell holds no solid.");
  if (!t.closed())
    result.reasons.push_back(
        fmt::format("The shell is not closed: {} edges are used once, {} more "
                    "than twice.",
                    t.freeEdges, t.overusedEdges));
  if (t.badSolids > 0 || !(t.volume > 0))
    result.reasons.emplace_back("A solid of the shell has no positive volume.");
}

}  // namespace

void WallFigures::addSamples(const ModelDistance& out, int samples, SampleRng& rng,
                             const std::function<WallPoint(const Vec3&)>& pointAt) {
  const std::vector<SurfaceSample> points = out.surfaceSamples(samples, kPerFace, rng);
  const std::size_t stride = points.size() / kBuriedSamples + 1;
  double asked = 0;
  double inside = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SurfaceSample& s = points[i];
    const WallPoint found = pointAt(s.point);
    all.add(found.error, s.weight);
    if (found.farSide) walls.add(found.error, s.weight);
    if (found.error > max) {
      max = found.error;
      worst = s.point;
    }
    if (i % stride != 0) continue;
    asked += s.weight;
    if (out.buried(s.body, s.triangle)) inside += s.weight;
  }
  if (asked > 0) buried = inside / asked;
}

void WallFigures::addMissing(const Vec3& point, double error, double weight) {
  missing.add(error, weight);
  if (error <= missingMax) return;
  missingMax = error;
  worstMissing = point;
}

TessellateOptions wallMesh(const Body& in, const ShellCheckOptions& options) {
  const double thickness = options.walls.thickness();
  const MeshSize size = meshSize({diagonalOf(occtShape(in.shape)), thickness, true},
                                 kDeflectionOfDiagonal, kDeflectionOfThickness);
  TessellateOptions mesh;
  mesh.deflection = size.deflection;
  mesh.angle = size.angle;
  mesh.distance = thickness;
  mesh.timeLimit = kMeshShare * options.timeLimit;
  return mesh;
}

std::optional<ModelDistance> measurableWall(const std::vector<Body>& out,
                                            const TessellateOptions& mesh, CheckResult& result) {
  const BRep_Builder builder;
  TopoDS_Compound all;
  builder.MakeCompound(all);
  for (const Body& body : out) builder.Add(all, occtShape(body.shape));
  judgeTopology(measureTopology(all), result);
  if (!result.reasons.empty()) return std::nullopt;
  Result<ModelDistance> distance = ModelDistance::build(out, mesh, "the shell");
  if (!distance) {
    result.reasons.push_back("The shell cannot be measured: " + distance.error().message);
    return std::nullopt;
  }
  result.untessellatedFaces = distance->untessellatedFaces();
  if (result.untessellatedFaces > 0)
    result.reasons.push_back(
        fmt::format("{} faces of the shell cannot be tessellated.", result.untessellatedFaces));
  return std::move(*distance);
}

void judgeWalls(const WallFigures& f, double tolerance, CheckResult& result) {
  const double bound = kCheckStrictness * tolerance;
  const double most = kMaxFactor * bound;
  result.accuracyP99 = f.walls.quantile(0.99);
  result.accuracyMax = f.max;
  result.coverageP99 = f.missing.quantile(0.99);
  result.coverageMax = f.missingMax;
  result.buried = f.buried;
  result.worstPoint = f.max > f.missingMax ? f.worst : f.worstMissing;
  const double share = kCheckStrictness * kShareBeyond;
  if (f.walls.shareAbove(bound) > share || f.all.shareAbove(bound) > share || f.max > most)
    result.reasons.push_back(
        fmt::format("The walls do not have their thickness: the worst point is {:.3g} mm off, near "
                    "{}.",
                    f.max, at(f.worst)));
  if (f.missing.empty())
    result.reasons.emplace_back("Nothing of the walls could be confirmed.");
  else if (f.missing.shareAbove(bound) > share || f.missingMax > most)
    result.reasons.push_back(
        fmt::format("A part of a wall is missing or buried: the shell is {:.3g} mm away from {}.",
                    f.missingMax, at(f.worstMissing)));
  if (f.buried > kCheckStrictness * kBuried)
    result.reasons.push_back(fmt::format(
        "The shell overlaps itself: {:.3g} % of its area lies inside it.", 100 * f.buried));
}

Result<CheckResult> checkInChild(double seconds,
                                 const std::function<Result<CheckResult>()>& check) {
  GuardLimits limits;
  limits.seconds = seconds;
  const auto bytes = runInChild("checking the shell", limits, [&]() -> Result<std::string> {
    const Result<CheckResult> measured = check();
    if (!measured) return tl::unexpected(measured.error());
    return bytesOf(*measured);
  });
  if (!bytes) return tl::unexpected(bytes.error());
  return resultOf(*bytes);
}

}  // namespace phront::cad
