// Planar wires of a CAD file as a drawing. Curves parallel to the plane z = 0 keep their x and y;
// others are seen from the front of their plane: z upwards, and the larger of x and y to the right.
#include <fmt/format.h>

#include <BRepAdaptor_Curve.hxx>
#include <GCPnts_QuasiUniformDeflection.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <cmath>

#include <Eigen/SVD>

#include "drawing/readers.h"

namespace phront::cad {
namespace {

constexpr double kAutomaticTolerance = 1e-5;  // of the size
constexpr double kRoundOff = 1e-7;            // of the size: coordinates in a file have few digits
constexpr double kParallel = 1 - 1e-12;       // cosine

using Polyline = std::vector<Vec3>;

Polyline pointsOf(const BRepAdaptor_Curve& curve, double tolerance) {
  Polyline points;
  const auto add = [&](const gp_Pnt& p) { points.emplace_back(p.X(), p.Y(), p.Z()); };
  if (curve.GetType() == GeomAbs_Line) {
    add(curve.Value(curve.FirstParameter()));
    add(curve.Value(curve.LastParameter()));
    return points;
  }
  const GCPnts_QuasiUniformDeflection chords(curve, tolerance);
  for (int i = 1; chords.IsDone() && i <= chords.NbPoints(); ++i) add(chords.Value(i));
  return points;
}

struct View {
  Vec3 right = Vec3::UnitX();
  Vec3 up = Vec3::UnitY();
  double offPlane = 0;  ///< farthest point
};

View viewOf(const std::vector<Polyline>& curves) {
  Eigen::Index count = 0;
  for (const Polyline& curve : curves) count += static_cast<Eigen::Index>(curve.size());
  Eigen::Matrix3Xd all(3, count);
  for (const Polyline& curve : curves) {
    for (const Vec3& p : curve) all.col(--count) = p;
  }
  const Vec3 centre = all.rowwise().mean();
  const Eigen::Matrix3Xd around = all.colwise() - centre;
  View view;
  if (around.row(2).cwiseAbs().maxCoeff() <= kRoundOff * around.cwiseAbs().maxCoeff()) return view;
  const Eigen::JacobiSVD<Eigen::Matrix3d> axes(Eigen::Matrix3d(around * around.transpose()),
                                               Eigen::ComputeFullU);
  const Vec3 normal = axes.matrixU().col(2);
  view.offPlane = (normal.transpose() * around).cwiseAbs().maxCoeff();
  if (std::abs(normal.z()) > kParallel) return view;
  view.up = (Vec3::UnitZ() - normal.z() * normal).normalized();
  view.right = view.up.cross(normal).normalized();
  Eigen::Index largest = 0;
  view.right.cwiseAbs().maxCoeff(&largest);
  if (view.right[largest] < 0) view.right = -view.right;
  return view;
}

}  // namespace

Result<RawDrawing> readWires(const Loaded& loaded, double tolerance) {
  TopTools_IndexedMapOfShape edges;
  for (const NamedShape& named : loaded.shapes) {
    if (TopExp_Explorer(named.shape, TopAbs_FACE).More()) {
      return fail(ErrorCode::UnreadableInput,
                  "it holds faces: a drawing is made of planar curves only");
    }
    TopExp::MapShapes(named.shape, TopAbs_EDGE, edges);
  }
  std::vector<BRepAdaptor_Curve> adaptors;
  Box3 box;
  for (int i = 1; i <= edges.Extent(); ++i) {
    const BRepAdaptor_Curve curve(TopoDS::Edge(edges(i)));
    if (!curve.Is3DCurve()) continue;
    adaptors.push_back(curve);
    constexpr int kLook = 8;
    for (int k = 0; k <= kLook; ++k) {
      const double t =
          curve.FirstParameter() + (curve.LastParameter() - curve.FirstParameter()) * k / kLook;
      const gp_Pnt p = curve.Value(t);
      box.extend(Vec3(p.X(), p.Y(), p.Z()));
    }
  }
  if (box.isEmpty()) return fail(ErrorCode::UnreadableInput, "it holds no curves");
  const double size = box.diagonal().norm();
  const double chord = tolerance > 0 ? tolerance : kAutomaticTolerance * size;
  std::vector<Polyline> curves;
  for (const BRepAdaptor_Curve& curve : adaptors) curves.push_back(pointsOf(curve, chord));
  const View view = viewOf(curves);
  if (!(view.offPlane <= chord + kRoundOff * size)) {
    return fail(ErrorCode::UnreadableInput,
                fmt::format("its curves do not lie in one plane: they are up to {:.3g} mm off",
                            view.offPlane));
  }
  RawDrawing drawing;
  drawing.unitInMm = loaded.unitInMm;
  drawing.warnings = loaded.warnings;
  for (const Polyline& curve : curves) {
    Chain chain;
    for (const Vec3& p : curve) chain.points.emplace_back(view.right.dot(p), view.up.dot(p));
    drawing.chains.push_back(std::move(chain));
  }
  return drawing;
}

}  // namespace phront::cad
