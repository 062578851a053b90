#include "judge/wall_verdict.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "exchange/guard.h"

namespace phront::cad {
namespace {

using Json = nlohmann::json;

constexpr double kShareBeyond = 0.01;  // of the area may be off by more than the tolerance
constexpr double kMaxFactor = 10;      // largest deviation allowed, in tolerances
constexpr double kBuried = 0.002;

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

}  // namespace

void WallFigures::addPoint(const Vec3& point, double error, bool wall, double weight) {
  all.add(error, weight);
  if (wall) walls.add(error, weight);
  if (error <= max) return;
  max = error;
  worst = point;
}

void WallFigures::addMissing(const Vec3& point, double error, double weight) {
  missing.add(error, weight);
  if (error <= missingMax) return;
  missingMax = error;
  worstMissing = point;
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
