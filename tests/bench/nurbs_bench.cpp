// Offset surfaces of the freeform faces of CAD files beside OpenCASCADE's own approximation: poles,
// errors, failures.
//
// Usage: phront_nurbs_bench FOLDER [PERCENT]
//
// Every freeform face (B-spline, Bezier, offset surfaces, revolutions and extrusions of such
// curves) is offset by PERCENT (2) of its part's diagonal, to 1e-2, 1e-3 and 1e-4 of that, by
// phront::cad::offsetGeom and by GeomConvert_ApproxSurface of a Geom_OffsetSurface (as
// GeomConvert::SurfaceToBSplineSurface calls it: degree up to 14, C2 where the surface is, else
// C1). Where that turns out more exact than asked, ours is also made to its error as tolerance.
// Errors of both are measured alike, on a grid, against the point P + d n of the same (u,v). Smooth
// faces are also offset there and back.
#include <fmt/format.h>

#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <GeomConvert.hxx>
#include <GeomConvert_ApproxSurface.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_Conic.hxx>
#include <Geom_ElementarySurface.hxx>
#include <Geom_Line.hxx>
#include <Geom_OffsetSurface.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_SweptSurface.hxx>
#include <Standard_Failure.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "exchange/guard.h"
#include "phront/cad/exchange.h"
#include "phront/cad/shape_occt.h"
#include "surfaces/offset_geom.h"

namespace phront::cad {
namespace {

constexpr int kGrid = 61;
constexpr double kSecondsEach = 60;
constexpr double kNoNormal = 1e-8;    // of the largest |S_u x S_v|
constexpr double kDegenerate = 1e-6;  // of the largest |S_u x S_v|
constexpr double kRoundOff = 1e-9;    // of |d|: errors below are none

struct Approximation {
  int poles = 0;
  double error = 0;
  double seconds = 0;
};

Handle(Geom_Surface) bare(Handle(Geom_Surface) surface) {
  while (surface->IsKind(STANDARD_TYPE(Geom_RectangularTrimmedSurface)))
    surface = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface)->BasisSurface();
  return surface;
}

/// Trim curves may leave the surface by round-off, which OpenCASCADE does not take.
void clip(ParameterBox& box, const Geom_Surface& surface) {
  ParameterBox all;
  surface.Bounds(all.u.low, all.u.high, all.v.low, all.v.high);
  if (!surface.IsUPeriodic())
    box.u = {std::max(box.u.low, all.u.low), std::min(box.u.high, all.u.high)};
  if (!surface.IsVPeriodic())
    box.v = {std::max(box.v.low, all.v.low), std::min(box.v.high, all.v.high)};
}

bool freeform(const Handle(Geom_Surface) & surface) {
  if (surface->IsKind(STANDARD_TYPE(Geom_ElementarySurface))) return false;
  if (const auto swept = Handle(Geom_SweptSurface)::DownCast(surface); !swept.IsNull()) {
    return !swept->BasisCurve()->IsKind(STANDARD_TYPE(Geom_Conic)) &&
           !swept->BasisCurve()->IsKind(STANDARD_TYPE(Geom_Line));
  }
  return true;
}

/// Calls visit(u, v) at the nodes of a grid over a box.
template <class Visit>
void overGrid(const ParameterBox& box, const Visit& visit) {
  for (int i = 0; i <= kGrid; ++i) {
    for (int j = 0; j <= kGrid; ++j)
      visit(box.u.low + (box.u.high - box.u.low) * i / kGrid,
            box.v.low + (box.v.high - box.v.low) * j / kGrid);
  }
}

/// Largest |S_u x S_v|.
double largestArea(const Geom_Surface& surface, const ParameterBox& box) {
  gp_Pnt p;
  gp_Vec du;
  gp_Vec dv;
  double largest = 0;
  overGrid(box, [&](double u, double v) {
    surface.D1(u, v, p, du, dv);
    largest = std::max(largest, du.Crossed(dv).Magnitude());
  });
  return largest;
}

/// Largest distance from P + d n where there is a normal. Where the original folds back on itself
/// S_u x S_v turns over; either side is right there.
double errorOf(const Geom_Surface& original, const Geom_Surface& offset, const ParameterBox& box,
               double distance) {
  gp_Pnt p;
  gp_Vec du;
  gp_Vec dv;
  const double largest = largestArea(original, box);
  double most = 0;
  overGrid(box, [&](double u, double v) {
    original.D1(u, v, p, du, dv);
    gp_Vec n = du.Crossed(dv);
    if (!(n.Magnitude() > kNoNormal * largest)) return;
    n.Normalize();
    const gp_Pnt q = offset.Value(u, v);
    most = std::max(most, std::min(q.Distance(p.Translated(n * distance)),
                                   q.Distance(p.Translated(n * -distance))));
  });
  return most;
}

Handle(Geom_BSplineSurface)
    asSpline(const Handle(Geom_Surface) & surface, const ParameterBox& box) {
  if (const auto spline = Handle(Geom_BSplineSurface)::DownCast(surface); !spline.IsNull())
    return spline;
  return GeomConvert::SurfaceToBSplineSurface(
      new Geom_RectangularTrimmedSurface(surface, box.u.low, box.u.high, box.v.low, box.v.high));
}

std::string text(const Approximation& a) {
  return fmt::format("{} {:.17g} {:.17g}", a.poles, a.error, a.seconds);
}

std::optional<Approximation> parsed(const Result<std::string>& bytes) {
  if (!bytes) return std::nullopt;
  Approximation a;
  if (std::sscanf(bytes->c_str(), "%d %lf %lf", &a.poles, &a.error, &a.seconds) != 3)
    return std::nullopt;
  return a;
}

template <class Make>
std::optional<Approximation> timed(const Make& make, std::string& why) {
  const Result<std::string> bytes =
      runInChild("offsetting", {.seconds = kSecondsEach}, [&]() -> Result<std::string> {
        const auto start = std::chrono::steady_clock::now();
        Result<Approximation> made = make();
        if (!made) return tl::unexpected(made.error());
        made->seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        return text(*made);
      });
  if (!bytes) why = bytes.error().message;
  return parsed(bytes);
}

Result<Approximation> occt(const Handle(Geom_Surface) & surface, const ParameterBox& box,
                           double distance, double tolerance) {
  const Handle(Geom_OffsetSurface) offset = new Geom_OffsetSurface(surface, distance);
  const Handle(Geom_Surface) part =
      new Geom_RectangularTrimmedSurface(offset, box.u.low, box.u.high, box.v.low, box.v.high);
  const GeomAbs_Shape continuity = offset->IsCNu(2) && offset->IsCNv(2) ? GeomAbs_C2 : GeomAbs_C1;
  const GeomConvert_ApproxSurface approx(part, tolerance, continuity, continuity, 14, 14, 400, 1);
  if (!approx.HasResult()) return fail(ErrorCode::Failed, "no result");
  const Handle(Geom_BSplineSurface) made = approx.Surface();
  return Approximation{made->NbUPoles() * made->NbVPoles(), errorOf(*surface, *made, box, distance),
                       0};
}

Result<Approximation> phront(const Handle(Geom_Surface) & surface, const ParameterBox& box,
                             double distance, double tolerance) {
  const Result<std::vector<OffsetPiece>> pieces = offsetGeom(
      surface, box, {.distance = distance, .tolerance = tolerance, .knots = KnotRule::Fewest});
  if (!pieces) return tl::unexpected(pieces.error());
  Approximation sum;
  for (const OffsetPiece& piece : *pieces) {
    const Handle(Geom_BSplineSurface) spline = asSpline(piece.surface, piece.box);
    sum.poles += spline->NbUPoles() * spline->NbVPoles();
    sum.error = std::max(sum.error, errorOf(*surface, *piece.surface, piece.box, distance));
  }
  return sum;
}

struct Tally {
  int faces = 0, ours = 0, theirs = 0, fewer = 0, fewerAndTighter = 0;
  double seconds = 0, theirSeconds = 0;
  std::vector<double> ratios;
};

void compare(const std::string& name, const Handle(Geom_Surface) & surface, const ParameterBox& box,
             double distance, std::map<int, Tally>& tallies) {
  for (const int power : {2, 3, 4}) {
    const double tolerance = std::abs(distance) * std::pow(10.0, -power);
    std::string why;
    std::string whyNot;
    const auto ours = timed([&] { return phront(surface, box, distance, tolerance); }, why);
    const auto theirs = timed([&] { return occt(surface, box, distance, tolerance); }, whyNot);
    Tally& tally = tallies[power];
    ++tally.faces;
    const bool right = ours && ours->error <= tolerance;
    const bool theirsRight = theirs && theirs->error <= tolerance;
    tally.ours += right;
    tally.theirs += theirsRight;
    tally.fewer += right && (!theirsRight || ours->poles <= theirs->poles);
    std::optional<Approximation> tight = ours;
    if (right && theirsRight && ours->error > theirs->error &&
        theirs->error > kRoundOff * std::abs(distance))
      tight = timed([&] { return phront(surface, box, distance, theirs->error); }, why);
    tally.fewerAndTighter +=
        right &&
        (!theirsRight || (tight && tight->poles <= theirs->poles &&
                          tight->error <= std::max(theirs->error, kRoundOff * std::abs(distance))));
    if (ours) tally.seconds += ours->seconds;
    if (theirs) tally.theirSeconds += theirs->seconds;
    if (right && theirsRight) tally.ratios.push_back(double(ours->poles) / theirs->poles);
    const auto cell = [&](const std::optional<Approximation>& a, const std::string& trouble) {
      return a ? fmt::format("{:6d} {:8.2e} {:7.3f}", a->poles, a->error / tolerance, a->seconds)
               : fmt::format("{:>23.90}", trouble);
    };
    fmt::print("{:44.44} 1e-{} | {} | {}{}\n", name, power, cell(ours, why), cell(theirs, whyNot),
               right ? "" : "  <-- missed");
    std::fflush(stdout);
  }
}

/// There and back to 1e-3 of |d|, where the original is smooth: one piece, nowhere near folding.
struct Return {
  int smooth = 0, within = 0;
};

/// (S_d,u x S_d,v) . (S_u x S_v) over its square, of S_d = S + d n: 1 for a plane, 0 where it
/// folds, and where S itself is degenerate.
double stretch(const Geom_Surface& surface, double u, double v, double distance, double largest) {
  gp_Pnt p;
  gp_Vec du;
  gp_Vec dv;
  gp_Vec duu;
  gp_Vec dvv;
  gp_Vec duv;
  surface.D2(u, v, p, du, dv, duu, dvv, duv);
  const gp_Vec cross = du.Crossed(dv);
  const double area = cross.Magnitude();
  if (!(area > kDegenerate * largest)) return 0;
  const gp_Vec normal = cross / area;
  const auto slope = [&](const gp_Vec& ofCross) {
    return (ofCross - normal * normal.Dot(ofCross)) / area;
  };
  const gp_Vec nu = slope(duu.Crossed(dv) + du.Crossed(duv));
  const gp_Vec nv = slope(duv.Crossed(dv) + du.Crossed(dvv));
  return (du + nu * distance).Crossed(dv + nv * distance).Dot(normal) / area;
}

/// Parameters all over a range and in each span of the knots, where ripples lie.
std::vector<double> spread(const TColStd_Array1OfReal& knots) {
  std::vector<double> all;
  for (int k = knots.Lower(); k < knots.Upper(); ++k) {
    for (const double share : {0.0, 0.25, 0.5, 0.75})
      all.push_back(knots(k) + share * (knots(k + 1) - knots(k)));
  }
  for (int i = 0; i <= kGrid; ++i)
    all.push_back(knots.First() + (knots.Last() - knots.First()) * i / kGrid);
  return all;
}

/// Nowhere degenerate or near folding.
bool isSmooth(const Handle(Geom_Surface) & surface, const ParameterBox& box, double distance) {
  constexpr double kLeastStretch = 0.3;
  const GeomAdaptor_Surface spans(surface, box.u.low, box.u.high, box.v.low, box.v.high);
  TColStd_Array1OfReal us(1, spans.NbUIntervals(GeomAbs_CN) + 1);
  TColStd_Array1OfReal vs(1, spans.NbVIntervals(GeomAbs_CN) + 1);
  spans.UIntervals(us, GeomAbs_CN);
  spans.VIntervals(vs, GeomAbs_CN);
  const std::vector<double> lines = spread(vs);
  const double largest = largestArea(*surface, box);
  for (const double u : spread(us)) {
    for (const double v : lines)
      if (!(stretch(*surface, u, v, distance, largest) > kLeastStretch)) return false;
  }
  return true;
}

Result<Approximation> thereAndBack(const Handle(Geom_Surface) & surface, const ParameterBox& box,
                                   double distance, double tolerance) {
  if (!isSmooth(surface, box, distance)) return fail(ErrorCode::NotSupported, "not smooth");
  NurbsOffsetOptions options{
      .distance = distance, .tolerance = tolerance, .knots = KnotRule::Fewest, .reversible = true};
  const Result<std::vector<OffsetPiece>> there = offsetGeom(surface, box, options);
  if (!there) return tl::unexpected(there.error());
  if (there->size() != 1) return fail(ErrorCode::NotSupported, "not smooth");
  options.distance = -distance;
  const Result<std::vector<OffsetPiece>> back =
      offsetGeom(there->front().surface, there->front().box, options);
  if (!back) return tl::unexpected(back.error());
  Approximation most;
  for (const OffsetPiece& piece : *back) {
    overGrid(piece.box, [&](double u, double v) {
      most.error = std::max(most.error, surface->Value(u, v).Distance(piece.surface->Value(u, v)));
    });
  }
  return most;
}

void goAndReturn(const std::string& name, const Handle(Geom_Surface) & surface,
                 const ParameterBox& box, double distance, Return& sum) {
  const double tolerance = 1e-3 * std::abs(distance);
  std::string why;
  const auto made = timed([&] { return thereAndBack(surface, box, distance, tolerance); }, why);
  if (!made && why.find("not smooth") != std::string::npos) return;
  ++sum.smooth;
  const bool within = made && made->error <= 2 * tolerance;
  sum.within += within;
  if (!within)
    fmt::print("{:44.44} there and back: {}\n", name,
               made ? fmt::format("{:.2f} tolerances off", made->error / tolerance) : why);
}

void compareFile(const std::filesystem::path& path, double percent, std::map<int, Tally>& tallies,
                 Return& returned) {
  const Result<Model> model = readModel(path);
  if (!model) {
    fmt::print("{}: {}\n", path.filename().string(), model.error().message);
    return;
  }
  const double distance = 0.01 * percent * boundingBox(*model).diagonal().norm();
  int number = 0;
  for (const Body& body : model->bodies) {
    for (TopExp_Explorer faces(occtShape(body.shape), TopAbs_FACE); faces.More(); faces.Next()) {
      const TopoDS_Face& face = TopoDS::Face(faces.Current());
      ++number;
      const Handle(Geom_Surface) surface = bare(BRep_Tool::Surface(face));
      if (!freeform(surface)) continue;
      ParameterBox box;
      BRepTools::UVBounds(face, box.u.low, box.u.high, box.v.low, box.v.high);
      clip(box, *surface);
      const std::string type = std::string(surface->DynamicType()->Name()).substr(5, 12);
      const std::string name = fmt::format("{:.24} {} {}", path.stem().string(), number, type);
      compare(name, surface, box, distance, tallies);
      goAndReturn(name, surface, box, distance, returned);
    }
  }
}

int run(const std::filesystem::path& folder, double percent) {
  std::vector<std::filesystem::path> files;
  if (std::filesystem::is_directory(folder)) {
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      if (entry.is_regular_file() && shapeFormatOf(entry.path())) files.push_back(entry.path());
  } else {
    files.push_back(folder);
  }
  std::sort(files.begin(), files.end());
  std::map<int, Tally> tallies;
  fmt::print("{:44} tol  |  poles  err/tol       s |  OpenCASCADE's\n", "face");
  Return returned;
  for (const auto& file : files) compareFile(file, percent, tallies, returned);
  for (auto& [power, t] : tallies) {
    std::sort(t.ratios.begin(), t.ratios.end());
    const double median = t.ratios.empty() ? 0 : t.ratios[t.ratios.size() / 2];
    fmt::print(
        "1e-{}: {} faces, within tolerance {} ({:.1f} %), OpenCASCADE {} ({:.1f} %); at most as "
        "many poles {} ({:.1f} %), and so with a tolerance that is OpenCASCADE's error {} ({:.1f} "
        "%); poles to OpenCASCADE's, "
        "median {:.2f}; {:.1f} s to {:.1f} s\n",
        power, t.faces, t.ours, 100.0 * t.ours / t.faces, t.theirs, 100.0 * t.theirs / t.faces,
        t.fewer, 100.0 * t.fewer / t.faces, t.fewerAndTighter, 100.0 * t.fewerAndTighter / t.faces,
        median, t.seconds, t.theirSeconds);
  }
  fmt::print("there and back within twice the tolerance: {} of {} smooth faces\n", returned.within,
             returned.smooth);
  return 0;
}

}  // namespace
}  // namespace phront::cad

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3) {
    std::fputs("usage: phront_nurbs_bench FILE-OR-FOLDER [PERCENT]\n", stderr);
    return 2;
  }
  return phront::cad::run(argv[1], argc > 2 ? std::atof(argv[2]) : 2);
}
