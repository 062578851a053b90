// The judge: measures in a child process, decides in this one.
//
// The figures (topology, accuracy, side, coverage) are taken where OpenCASCADE may crash or hang;
// the verdict is arithmetic on them. A child that dies while it measures is itself a verdict: what
// cannot be measured is not delivered. The bounds are kCheckStrictness times those promised,
// because a percentile or a maximum from samples varies from draw to draw. Weak spot: a
// self-intersection shallower than the tolerance passes; BRepCheck does not see it and neither does
// distance.
#include "phront/cad/check.h"

#include <BRepBndLib.hxx>
#include <BRep_Builder.hxx>
#include <Bnd_Box.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include "exchange/guard.h"
#include "judge/check_against.h"
#include "judge/check_measure.h"
#include "judge/check_topology.h"
#include "phront/cad/shape_occt.h"

namespace phront::cad {
namespace {

using Json = nlohmann::json;

constexpr double kDefaultTolerance = 0.01;  // of |d|
constexpr double kMaxFactor = 10;           // largest deviation allowed, in tolerances
constexpr double kShareBeyond = 0.01;       // of the area may deviate more than the tolerance
constexpr double kWrongSide = 0.001;        // of the area may lie on the wrong side of a solid
constexpr double kWrongSideOfSheet = 0.01;  // sheets fold back a little at lips: no side to rely on
constexpr double kBuried = 0.002;           // of the area may lie inside the result
// The triangles start the exact search, carry the sides and screen search points: fine against the
// part and against d, yet no finer, since queries and meshing are most of the time.
constexpr double kDeflectionOfDiagonal = 4e-4;
constexpr double kDeflectionOfDistance = 0.015;
// Of the time: what takes longer to tessellate is measured from coarser triangles.
constexpr double kMeshShare = 0.4;
constexpr std::uint64_t kAccuracySeed = 0x9e3779b97f4a7c15;
constexpr std::uint64_t kCoverageSeed = 0xbf58476d1ce4e5b9;

/// All that the child measures.
struct Figures {
  TopologyFigures topology;
  AccuracyFigures accuracy;
  CoverageFigures coverage;
  bool outEmpty = false;
  bool solidIn = false;
  int untessellated = 0;
  std::string inError;   ///< IN cannot be measured
  std::string outError;  ///< OUT cannot be tessellated
};

Json toJson(const Vec3& v) { return Json::array({v.x(), v.y(), v.z()}); }

/// Reads the values of an array one after the other, in the order they were written.
class ArrayReader {
 public:
  explicit ArrayReader(const Json& array) : array_(array) {}
  template <class T>
  ArrayReader& operator>>(T& value) {
    array_.at(next_++).get_to(value);
    return *this;
  }
  ArrayReader& operator>>(Vec3& value) {
    const Json& v = array_.at(next_++);
    value = Vec3(v.at(0).get<double>(), v.at(1).get<double>(), v.at(2).get<double>());
    return *this;
  }

 private:
  const Json& array_;
  std::size_t next_ = 0;
};

std::string bytesOf(const Figures& f) {
  const TopologyFigures& t = f.topology;
  const AccuracyFigures& a = f.accuracy;
  const CoverageFigures& c = f.coverage;
  const Json json = Json::array({t.solids,
                                 t.shells,
                                 t.faces,
                                 t.valid,
                                 t.freeEdges,
                                 t.overusedEdges,
                                 t.looseFaces,
                                 t.volume,
                                 t.badSolids,
                                 t.widestGap,
                                 toJson(t.atGap),  //
                                 a.p99,
                                 a.max,
                                 a.shareBeyond,
                                 a.rightSide,
                                 a.buried,
                                 toJson(a.worst),  //
                                 c.p99,
                                 c.max,
                                 c.shareBeyond,
                                 c.kept,
                                 c.firm,
                                 c.found,
                                 c.confirmed,
                                 c.keptShare,
                                 toJson(c.worst),
                                 toJson(c.anyKept),  //
                                 f.outEmpty,
                                 f.solidIn,
                                 f.untessellated,
                                 f.inError,
                                 f.outError});
  std::string bytes;
  Json::to_cbor(json, bytes);  // binary doubles: infinities survive, no digit is lost
  return bytes;
}

Figures figuresOf(const std::string& bytes) {
  const Json json = Json::from_cbor(bytes);
  Figures f;
  TopologyFigures& t = f.topology;
  AccuracyFigures& a = f.accuracy;
  CoverageFigures& c = f.coverage;
  ArrayReader read(json);
  read >> t.solids >> t.shells >> t.faces >> t.valid >> t.freeEdges >> t.overusedEdges;
  read >> t.looseFaces >> t.volume >> t.badSolids >> t.widestGap >> t.atGap;
  read >> a.p99 >> a.max >> a.shareBeyond >> a.rightSide >> a.buried >> a.worst;
  read >> c.p99 >> c.max >> c.shareBeyond >> c.kept >> c.firm >> c.found >> c.confirmed >>
      c.keptShare;
  read >> c.worst >> c.anyKept;
  read >> f.outEmpty >> f.solidIn >> f.untessellated >> f.inError >> f.outError;
  return f;
}

TopoDS_Shape compoundOf(const Model& model) {
  BRep_Builder builder;
  TopoDS_Compound compound;
  builder.MakeCompound(compound);
  for (const Body& body : model.bodies) {
    if (!body.shape.empty()) builder.Add(compound, occtShape(body.shape));
  }
  return compound;
}

bool isEmpty(const Model& model) {
  return std::all_of(model.bodies.begin(), model.bodies.end(),
                     [](const Body& body) { return faceCount(body.shape) == 0; });
}

/// Of a box around poles: a factor of two too large at worst, but hundreds of times faster than a
/// tight box of freeform faces.
double roughDiagonal(const Model& model) {
  Bnd_Box box;
  BRepBndLib::Add(compoundOf(model), box, Standard_False);
  if (box.IsVoid() || box.IsOpen()) return boundingBox(model).diagonal().norm();
  return box.CornerMin().Distance(box.CornerMax());
}

std::string at(const Vec3& p) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x(), p.y(), p.z());
}

std::vector<std::string> topologyFaults(const Figures& f, double tolerance) {
  std::vector<std::string> reasons;
  const TopologyFigures& t = f.topology;
  if (!t.valid) reasons.emplace_back("OpenCASCADE's BRepCheck finds the result invalid.");
  if (f.untessellated > 0) {
    reasons.push_back(
        fmt::format("{} faces of the result cannot be tessellated.", f.untessellated));
  }
  if (!(t.widestGap <= kCheckStrictness * kMaxFactor * tolerance)) {
    reasons.push_back(fmt::format("The faces of the result meet only within {:.3g} mm near {}.",
                                  t.widestGap, at(t.atGap)));
  }
  if (!f.solidIn) return reasons;
  if (t.solids == 0) reasons.emplace_back("The result holds no solid.");
  if (!t.closed()) {
    reasons.push_back(
        fmt::format("The result is not closed: {} edges are used once, {} more than "
                    "twice in their shell, {} faces are in no shell.",
                    t.freeEdges, t.overusedEdges, t.looseFaces));
  }
  if (t.badSolids > 0 || !(t.volume > 0)) {
    reasons.push_back(fmt::format("{} of {} solids of the result have no positive volume.",
                                  t.badSolids, t.solids));
  }
  return reasons;
}

void judgeAccuracy(const Figures& f, double tolerance, std::vector<std::string>& reasons) {
  const AccuracyFigures& a = f.accuracy;
  if (!(a.shareBeyond <= kCheckStrictness * kShareBeyond)) {
    reasons.push_back(fmt::format(
        "The result is inaccurate: {:.3g} % of its area deviates by more than {:.3g} mm from the "
        "distance wanted, the worst by {:.3g} mm near {}.",
        100 * a.shareBeyond, kCheckStrictness * tolerance, a.max, at(a.worst)));
  } else if (!(a.max <= kCheckStrictness * kMaxFactor * tolerance)) {
    reasons.push_back(
        fmt::format("The result is inaccurate in places: it deviates by {:.3g} mm near {}.", a.max,
                    at(a.worst)));
  }
  // Valid, closed and everywhere at its distance is a solid that overlaps itself, too.
  if (!(a.buried <= kCheckStrictness * kBuried)) {
    reasons.push_back(fmt::format(
        "The result overlaps itself: {:.3g} % of its area lies inside it.", 100 * a.buried));
  }
  if (!(1 - a.rightSide <= kCheckStrictness * (f.solidIn ? kWrongSide : kWrongSideOfSheet))) {
    reasons.push_back(
        fmt::format("{:.3g} % of the result's area lies on the wrong side of the "
                    "input.",
                    100 * (1 - a.rightSide)));
  }
}

void judgeCoverage(const Figures& f, double tolerance, std::vector<std::string>& reasons) {
  const CoverageFigures& c = f.coverage;
  if (f.outEmpty) {
    if (c.kept + c.found > 0) {
      reasons.push_back(fmt::format(
          "The result is empty, but the offset is not: {:.3g} % of the input's area has one, for "
          "example at {}.",
          100 * c.keptShare, at(c.anyKept)));
    }
    return;
  }
  if (c.firm == 0) {
    reasons.emplace_back("The result is not empty, but the offset of the input is.");
  } else if (!c.confirmed) {
    reasons.push_back(
        fmt::format("So little of the input has an offset ({:.2g} % of its area) that "
                    "the result cannot be confirmed.",
                    100 * c.keptShare));
  } else if (!(c.shareBeyond <= kCheckStrictness * kShareBeyond)) {
    reasons.push_back(fmt::format(
        "Parts of the offset are missing: {:.3g} % of its area lies farther than {:.3g} mm from "
        "the result, the worst {:.3g} mm near {}.",
        100 * c.shareBeyond, kCheckStrictness * tolerance, c.max, at(c.worst)));
  } else if (!(c.max <= kCheckStrictness * kMaxFactor * tolerance)) {
    reasons.push_back(
        fmt::format("A part of the offset is missing: at {} the result is {:.3g} mm away.",
                    at(c.worst), c.max));
  }
}

CheckResult judge(const Figures& f, double tolerance) {
  CheckResult result;
  result.solids = f.topology.solids;
  result.shells = f.topology.shells;
  result.faces = f.topology.faces;
  result.valid = f.topology.valid;
  result.closed = f.topology.closed();
  result.volume = f.topology.volume;
  result.accuracyP99 = f.accuracy.p99;
  result.accuracyMax = f.accuracy.max;
  result.coverageP99 = f.coverage.p99;
  result.coverageMax = f.coverage.max;
  result.rightSide = f.accuracy.rightSide;
  result.buried = f.accuracy.buried;
  result.trueOffsetEmpty = f.coverage.kept + f.coverage.found == 0;
  result.untessellatedFaces = f.untessellated;
  result.worstPoint = f.coverage.max > f.accuracy.max ? f.coverage.worst : f.accuracy.worst;

  if (!f.outEmpty) {
    result.reasons = topologyFaults(f, tolerance);
    if (f.outError.empty()) judgeAccuracy(f, tolerance, result.reasons);
  }
  if (f.outError.empty()) {
    judgeCoverage(f, tolerance, result.reasons);
  } else {
    result.reasons.push_back("The result cannot be measured: " + f.outError + ".");
  }
  return result;
}

TessellateOptions meshFor(double diagonal, bool solid, const CheckOptions& check) {
  const MeshSize size =
      meshSize({diagonal, check.distance, solid}, kDeflectionOfDiagonal, kDeflectionOfDistance);
  TessellateOptions mesh;
  mesh.deflection = size.deflection;
  mesh.angle = size.angle;
  mesh.distance = std::abs(check.distance);
  mesh.timeLimit = kMeshShare * check.timeLimit;
  return mesh;
}

/// Runs in the child, as the next one.
Figures measureAgainst(const ModelDistance& in, const Model& out, const TessellateOptions& mesh,
                       MeasureOptions options, const CheckOptions& check) {
  Figures figures;
  figures.outEmpty = isEmpty(out);
  figures.solidIn = in.hasSolids();
  SampleRng coverageRng(kCoverageSeed);
  if (figures.outEmpty) {
    figures.coverage = measureCoverage(in, nullptr, options, coverageRng);
    return figures;
  }
  const TopoDS_Shape shape = compoundOf(out);
  figures.topology = measureTopology(shape);
  const double tolerance = options.tolerance / kCheckStrictness;
  options.search = topologyFaults(figures, tolerance).empty();  // else the verdict stands already
  const auto outDistance = ModelDistance::build(out.bodies, mesh, "the result");
  if (outDistance) {
    SampleRng accuracyRng(kAccuracySeed);
    figures.untessellated = outDistance->untessellatedFaces();
    figures.accuracy = measureAccuracy(in, *outDistance, options, accuracyRng);
    figures.coverage = measureCoverage(in, &*outDistance, options, coverageRng);
  } else {
    figures.outError = outDistance.error().message;
    figures.coverage = measureCoverage(in, nullptr, options, coverageRng);
  }
  // Meshing again takes time; only a pass can suffer.
  if (check.meshPlainly && judge(figures, tolerance).pass()) {
    const double diagonal = in.box().diagonal().norm();
    figures.untessellated = static_cast<int>(
        facesWithoutTriangles(shape, usualMeshSize({diagonal, options.distance, figures.solidIn}))
            .size());
  }
  return figures;
}

Figures measure(const Model& in, const Model& out, const MeasureOptions& options,
                const CheckOptions& check) {
  const bool solid = std::any_of(in.bodies.begin(), in.bodies.end(),
                                 [](const Body& b) { return b.kind == BodyKind::Solid; });
  const TessellateOptions mesh = meshFor(roughDiagonal(in), solid, check);
  const auto distance = ModelDistance::build(in.bodies, mesh, "the input");
  if (distance) return measureAgainst(*distance, out, mesh, options, check);
  Figures figures;
  figures.inError = distance.error().message;
  return figures;
}

Result<MeasureOptions> resolve(const CheckOptions& options) {
  if (!std::isfinite(options.distance) || options.distance == 0) {
    return fail(ErrorCode::InvalidArgument, "the distance of a check must be finite and not zero");
  }
  if (options.tolerance && !(*options.tolerance > 0 && std::isfinite(*options.tolerance))) {
    return fail(ErrorCode::InvalidArgument, "the tolerance of a check must be positive");
  }
  if (options.samples < 1 || !(options.timeLimit > 0)) {
    return fail(ErrorCode::InvalidArgument,
                "a check needs at least one sample and a positive time limit");
  }
  if (!(options.mitreLimit > 1) || !std::isfinite(options.mitreLimit))
    return fail(ErrorCode::InvalidArgument, "the mitre limit must be a number above 1");
  const double tolerance =
      kCheckStrictness * options.tolerance.value_or(kDefaultTolerance * std::abs(options.distance));
  MeasureOptions measure{options.distance, tolerance, kMaxFactor * tolerance, options.samples};
  if (options.join == Join::Mitre) measure.mitreLimit = options.mitreLimit;
  return measure;
}

/// Measures under guard, then decides.
Result<CheckResult> judgedInChild(const CheckOptions& options, double tolerance,
                                  const std::function<Figures()>& measured) {
  GuardLimits limits;
  limits.seconds = options.timeLimit;
  const auto bytes = runInChild("checking the result", limits,
                                [&]() -> Result<std::string> { return bytesOf(measured()); });
  if (!bytes) {
    if (bytes.error().code != ErrorCode::Failed) return tl::unexpected<Error>(bytes.error());
    CheckResult unmeasured;
    unmeasured.reasons.push_back("The result cannot be measured: " + bytes.error().message + ".");
    return unmeasured;
  }
  const Figures figures = figuresOf(*bytes);
  if (!figures.inError.empty()) return fail(ErrorCode::Failed, figures.inError);
  return judge(figures, tolerance / kCheckStrictness);
}

}  // namespace

Result<CheckResult> checkOffset(const Model& in, const Model& out, const CheckOptions& options,
                                const Progress& progress) {
  const auto resolved = resolve(options);
  if (!resolved) return tl::unexpected<Error>(resolved.error());
  if (isEmpty(in)) return fail(ErrorCode::InvalidArgument, "the input of a check has no faces");
  if (!progress.report(0)) return fail(ErrorCode::Cancelled, "the check was cancelled");
  Result<CheckResult> check = judgedInChild(options, resolved->tolerance,
                                            [&] { return measure(in, out, *resolved, options); });
  if (!progress.report(1)) return fail(ErrorCode::Cancelled, "the check was cancelled");
  return check;
}

Result<CheckResult> checkAgainst(const ModelDistance& in, const Model& out,
                                 const CheckOptions& options) {
  const auto resolved = resolve(options);
  if (!resolved) return tl::unexpected<Error>(resolved.error());
  const TessellateOptions mesh = meshFor(in.box().diagonal().norm(), in.hasSolids(), options);
  return judgedInChild(options, resolved->tolerance,
                       [&] { return measureAgainst(in, out, mesh, *resolved, options); });
}

}  // namespace phront::cad
