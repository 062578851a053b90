// The tolerance that OpenCASCADE gives to an intersection curve is what its approximation in both
// parameter planes may be off, or the worst of all curves of the pair. Seen: curves that lie on
// both faces to 1e-5 mm with a tolerance of 17 mm, and approximations of a few micrometres that
// swing out by hundreds of mm between their ends. The edges and vertices made of them swallow all
// within that reach. Weak spot: a tolerance that is rightly large stays.
#include "rebuild/section_curves.h"

#include <BOPDS_Curve.hxx>
#include <BOPDS_Interf.hxx>
#include <BOPDS_VectorOfCurve.hxx>
#include <BOPDS_VectorOfInterfFF.hxx>
#include <BOPTools_AlgoTools2D.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRep_Tool.hxx>
#include <BndLib_Add3dCurve.hxx>
#include <Bnd_Box.hxx>
#include <Geom2d_Curve.hxx>
#include <GeomAPI_Interpolate.hxx>
#include <GeomAPI_ProjectPointOnSurf.hxx>
#include <GeomAdaptor_Curve.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_Surface.hxx>
#include <IntTools_Curve.hxx>
#include <IntTools_FaceFace.hxx>
#include <Precision.hxx>
#include <ShapeAnalysis_Surface.hxx>
#include <Standard_Failure.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColStd_HArray1OfReal.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TColgp_HArray1OfPnt.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "patches/patch_tools.h"

namespace phront::cad {
namespace {

constexpr int kSamples = 48;
constexpr double kMargin = 2;   // what lies between samples
constexpr double kWorth = 0.5;  // of the tolerance given: a gain worth the change
constexpr double kAstray =
    0.05;  // of its length: farther off it is none of its faces' intersection
// Of the doubtful tolerance: curves worth a second intersection, and ends that are one.
constexpr double kLong = 1000;
constexpr double kSameEnd = 10;

/// How far a curve is off a face: itself, and its parameter curve's image off it.
struct Deviation {
  double curve = 0;
  double image = 0;
};

class SectionCurve {
 public:
  SectionCurve(BOPDS_Curve& section, const TopoDS_Face& first, const TopoDS_Face& second,
               IntTools_Context& context)
      : section_(section), faces_{first, second}, context_(context) {}

  [[nodiscard]] bool hasEnds() {
    return section_.Curve().HasBounds() && section_.Curve().Bounds(first_, last_, from_, to_);
  }
  [[nodiscard]] const gp_Pnt& from() const { return from_; }
  [[nodiscard]] const gp_Pnt& to() const { return to_; }
  [[nodiscard]] double chord() const { return from_.Distance(to_); }

  /// Is its tolerance no longer small for what lies between its ends?
  [[nodiscard]] bool isOutrageous() const {
    const bool closed = chord() <= Precision::Confusion();
    const double size = closed ? lengthOf(section_.Curve().Curve(), first_, last_) : chord();
    return section_.Tolerance() > kAstray * size;
  }

  /// Does it leave its faces, and not only a little for its length?
  [[nodiscard]] bool isAstray() const {
    const Handle(Geom_Curve) curve = section_.Curve().Curve();
    return offFaces(curve, first_, last_) > kAstray * lengthOf(curve, first_, last_);
  }

  /// Tolerance and parameter curves as measured, where that makes the tolerance much less.
  bool tighten() {
    const IntTools_Curve& given = section_.Curve();
    std::array<Handle(Geom2d_Curve), 2> images{given.FirstCurve2d(), given.SecondCurve2d()};
    double off = 0;
    std::array<double, 2> offImage{};
    for (std::size_t f = 0; f < 2; ++f) {
      const Deviation deviation = measure(f, given.Curve(), images[f], first_, last_);
      off = std::max(off, deviation.curve);
      offImage[f] = deviation.image;
    }
    const double tolerance = kMargin * off + Precision::Confusion();
    if (tolerance > kWorth * section_.Tolerance()) return false;
    for (std::size_t f = 0; f < 2; ++f)
      if (offImage[f] > tolerance) images[f].Nullify();
    IntTools_Curve settled = given;
    settled.SetCurves(given.Curve(), images[0], images[1]);
    replace(settled, tolerance);
    return true;
  }

  /// The straight line between its ends instead, if that is no worse.
  bool straighten() {
    if (chord() <= Precision::Confusion()) return false;
    TColgp_Array1OfPnt poles(1, 2);
    poles(1) = from_;
    poles(2) = to_;
    TColStd_Array1OfReal knots(1, 2);
    knots(1) = 0;
    knots(2) = chord();
    TColStd_Array1OfInteger multiplicities(1, 2);
    multiplicities.Init(2);
    const Handle(Geom_Curve) line = new Geom_BSplineCurve(poles, knots, multiplicities, 1);
    const double off = offFaces(line, 0, chord());
    if (off > offFaces(section_.Curve().Curve(), first_, last_)) return false;
    replace(IntTools_Curve(line, {}, {}), kMargin * off + Precision::Confusion());
    return true;
  }

  /// From a polygon of points on both faces: the smooth curve through them where that is nearer to
  /// the faces. False when neither is near.
  bool adopt(const IntTools_Curve& polygon) {
    if (!polygon.HasBounds() || !polygon.Bounds(first_, last_, from_, to_)) return false;
    Handle(Geom_Curve) best = polygon.Curve();
    double off = offFaces(best, first_, last_);
    if (const Handle(Geom_Curve) smooth = smoothThrough(best); !smooth.IsNull()) {
      const double offSmooth = offFaces(smooth, first_, last_);
      if (offSmooth < off) {
        best = smooth;
        off = offSmooth;
      }
    }
    if (off > kAstray * lengthOf(best, first_, last_)) return false;
    replace(IntTools_Curve(best, {}, {}), kMargin * off + Precision::Confusion());
    return true;
  }

 private:
  [[nodiscard]] static double lengthOf(const Handle(Geom_Curve) & curve, double first,
                                       double last) {
    double length = 0;
    gp_Pnt before = curve->Value(first);
    for (int i = 1; i <= kSamples; ++i) {
      const gp_Pnt next = curve->Value(std::lerp(first, last, static_cast<double>(i) / kSamples));
      length += before.Distance(next);
      before = next;
    }
    return length;
  }

  [[nodiscard]] Deviation measure(std::size_t f, const Handle(Geom_Curve) & curve,
                                  const Handle(Geom2d_Curve) & image, double first,
                                  double last) const {
    const Handle(Geom_Surface) surface = BRep_Tool::Surface(faces_[f]);
    GeomAPI_ProjectPointOnSurf& projector = context_.ProjPS(faces_[f]);
    ShapeAnalysis_Surface whole(surface);
    Deviation deviation;
    for (int i = 0; i <= kSamples; ++i) {
      const double t = std::lerp(first, last, static_cast<double>(i) / kSamples);
      const gp_Pnt p = curve->Value(t);
      double nearest = std::numeric_limits<double>::infinity();
      if (!image.IsNull()) {
        const gp_Pnt2d uv = image->Value(t);
        nearest = surface->Value(uv.X(), uv.Y()).Distance(p);
        deviation.image = std::max(deviation.image, nearest);
      }
      if (nearest > Precision::Confusion()) {
        projector.Perform(p);
        if (projector.IsDone() && projector.NbPoints() > 0) {
          nearest = std::min<double>(nearest, projector.LowerDistance());
        } else {  // beyond the face's own parameters
          whole.ValueOfUV(p, Precision::Confusion());
          nearest = std::min(nearest, whole.Gap());
        }
      }
      deviation.curve = std::max(deviation.curve, nearest);
    }
    return deviation;
  }

  [[nodiscard]] double offFaces(const Handle(Geom_Curve) & curve, double first, double last) const {
    double off = 0;
    for (std::size_t f = 0; f < 2; ++f)
      off = std::max(off, measure(f, curve, {}, first, last).curve);
    return off;
  }

  // Null unless the curve is a polygon of some points.
  static Handle(Geom_Curve) smoothThrough(const Handle(Geom_Curve) & curve) {
    const Handle(Geom_BSplineCurve) polygon = Handle(Geom_BSplineCurve)::DownCast(curve);
    if (polygon.IsNull() || polygon->Degree() != 1 || polygon->NbPoles() < 3) return {};
    const Handle(TColgp_HArray1OfPnt) points = new TColgp_HArray1OfPnt(1, polygon->NbPoles());
    const Handle(TColStd_HArray1OfReal) parameters =
        new TColStd_HArray1OfReal(1, polygon->NbPoles());
    for (int i = 1; i <= polygon->NbPoles(); ++i) {
      points->SetValue(i, polygon->Pole(i));
      parameters->SetValue(i, polygon->Knot(i));
    }
    try {
      GeomAPI_Interpolate interpolate(points, parameters, Standard_False, Precision::Confusion());
      interpolate.Perform();
      if (interpolate.IsDone()) return Handle(Geom_Curve)(interpolate.Curve());
    } catch (const Standard_Failure&) {  // points too close to one another
    }
    return {};
  }

  void replace(IntTools_Curve curve, double tolerance) {
    double first = 0;
    double last = 0;
    gp_Pnt from;
    gp_Pnt to;
    curve.Bounds(first, last, from, to);
    curve.SetCurves(curve.Curve(), imageFor(0, curve.Curve(), curve.FirstCurve2d(), first, last),
                    imageFor(1, curve.Curve(), curve.SecondCurve2d(), first, last));
    curve.SetTolerance(tolerance);
    curve.SetTangentialTolerance(std::min(curve.TangentialTolerance(), tolerance));
    section_.SetCurve(curve);
    section_.SetTolerance(tolerance);
    Bnd_Box box;
    BndLib_Add3dCurve::Add(GeomAdaptor_Curve(curve.Curve(), first, last), tolerance, box);
    section_.SetBox(box);
  }

  /// Images that are missing OpenCASCADE makes itself; where it cannot, it gives up all faces.
  [[nodiscard]] Handle(Geom2d_Curve)
      imageFor(std::size_t f, const Handle(Geom_Curve) & curve, const Handle(Geom2d_Curve) & image,
               double first, double last) const {
    if (!image.IsNull()) return image;
    try {
      const TopoDS_Edge edge = BRepBuilderAPI_MakeEdge(curve, first, last).Edge();
      Handle(Geom2d_Curve) made;
      double reached = 0;
      BOPTools_AlgoTools2D::CurveOnSurface(edge, faces_[f], made, reached);
      return {};
    } catch (const Standard_Failure&) {
    }
    ShapeAnalysis_Surface surface(BRep_Tool::Surface(faces_[f]));
    std::vector<gp_Pnt2d> points;
    std::vector<double> parameters;
    for (int i = 0; i <= kSamples; ++i) {
      parameters.push_back(std::lerp(first, last, static_cast<double>(i) / kSamples));
      const gp_Pnt p = curve->Value(parameters.back());
      points.push_back(i == 0 ? surface.ValueOfUV(p, Precision::Confusion())
                              : surface.NextValueOfUV(points.back(), p, Precision::Confusion()));
    }
    try {
      return pcurveThrough(points, parameters);
    } catch (const Standard_Failure&) {  // all but a point
      return straightPcurve(points.front(), points.back(), first, last);
    }
  }

  BOPDS_Curve& section_;
  std::array<TopoDS_Face, 2> faces_;
  IntTools_Context& context_;
  double first_ = 0;
  double last_ = 0;
  gp_Pnt from_;
  gp_Pnt to_;
};

/// One pair of faces and their intersection curves.
class SectionPair {
 public:
  SectionPair(const TopoDS_Face& first, const TopoDS_Face& second,
              const Handle(IntTools_Context) & context, double doubtful)
      : first_(first), second_(second), context_(context), doubtful_(doubtful) {}

  /// Returns how many curves were changed.
  int settle(BOPDS_VectorOfCurve& curves) {
    int changed = 0;
    std::vector<BOPDS_Curve> good;
    std::vector<BOPDS_Curve> astray;
    for (int c = 0; c < curves.Length(); ++c) {
      BOPDS_Curve curve = curves(c);
      SectionCurve section(curve, first_, second_, *context_);
      if (curve.Tolerance() <= doubtful_ || !section.hasEnds() || !section.isOutrageous()) {
        good.push_back(curve);
        continue;
      }
      const bool isAstray = section.isAstray();
      if (isAstray && section.chord() > kLong * doubtful_) {
        astray.push_back(curve);
        continue;
      }
      if ((isAstray && section.straighten()) || section.tighten()) ++changed;
      good.push_back(curve);
    }
    if (!astray.empty()) {
      for (const BOPDS_Curve& curve : insteadOf(astray)) good.push_back(curve);
      changed += static_cast<int>(astray.size());
    }
    if (changed == 0) return 0;
    curves.Clear();
    for (const BOPDS_Curve& curve : good) curves.Append(curve);
    return changed;
  }

 private:
  /// Curves between the same ends, as the points that are walked have them, without approximation;
  /// where there are none the curves as they are.
  std::vector<BOPDS_Curve> insteadOf(const std::vector<BOPDS_Curve>& astray) {
    IntTools_FaceFace intersection;
    intersection.SetContext(context_);
    intersection.SetParameters(Standard_False, Standard_True, Standard_True,
                               Precision::Confusion());
    intersection.Perform(first_, second_);
    std::vector<BOPDS_Curve> instead;
    if (!intersection.IsDone()) return astray;
    intersection.PrepareLines3D();
    for (const IntTools_Curve& line : intersection.Lines()) {
      BOPDS_Curve curve;
      SectionCurve section(curve, first_, second_, *context_);
      if (section.adopt(line) && sharesEnds(section, astray)) instead.push_back(curve);
    }
    return instead.empty() ? astray : instead;
  }

  [[nodiscard]] bool sharesEnds(const SectionCurve& section,
                                const std::vector<BOPDS_Curve>& astray) const {
    return std::any_of(astray.begin(), astray.end(), [&](BOPDS_Curve curve) {
      SectionCurve other(curve, first_, second_, *context_);
      const auto meet = [&](const gp_Pnt& a, const gp_Pnt& b) {
        return a.Distance(b) < kSameEnd * doubtful_;
      };
      return other.hasEnds() &&
             ((meet(section.from(), other.from()) && meet(section.to(), other.to())) ||
              (meet(section.from(), other.to()) && meet(section.to(), other.from())));
    });
  }

  const TopoDS_Face& first_;
  const TopoDS_Face& second_;
  const Handle(IntTools_Context) & context_;
  double doubtful_;
};

}  // namespace

int settleSectionCurves(BOPDS_DS& ds, const Handle(IntTools_Context) & context, double doubtful) {
  int count = 0;
  BOPDS_VectorOfInterfFF& pairs = ds.InterfFF();
  for (int i = 0; i < pairs.Length(); ++i) {
    int a = 0;
    int b = 0;
    pairs(i).Indices(a, b);
    const TopoDS_Face first = TopoDS::Face(ds.Shape(a));
    const TopoDS_Face second = TopoDS::Face(ds.Shape(b));
    count += SectionPair(first, second, context, doubtful).settle(pairs(i).ChangeCurves());
  }
  return count;
}

}  // namespace phront::cad
