// Points, normals and feet on one face.
//
// Feet on plane, cylinder, cone, sphere and torus come from ElSLib's closed forms: Newton fails at
// their poles. Other surfaces: Newton on the two orthogonality conditions with the full Hessian of
// the squared distance where it is positive definite, Gauss-Newton else, halved until the distance
// falls (Ma & Hewitt 2003 describe the plain iteration). Weak spot: a start in another basin gives
// a local minimum; callers start from the nearest triangle and compare distances.
#include "tessellate/face_surface.h"

#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <ElSLib.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_BezierSurface.hxx>
#include <gp_Cone.hxx>
#include <gp_Cylinder.hxx>
#include <gp_Pln.hxx>
#include <gp_Sphere.hxx>
#include <gp_Torus.hxx>

#include <Eigen/Eigenvalues>

namespace phront::cad {
namespace {

constexpr int kNewtonSteps = 30;
constexpr double kLeastCurvature = 0.005;  // of the squared distance, relative to the metric
constexpr double kLooseResidual = 1e3;     // of the tolerance, where round-off stops the descent
constexpr int kPlaneSamples = 9;           // per direction, for surfaces without poles
// sin of the angle between Su and Sv, and length of either against the other scale, below which a
// point counts as singular: well above round-off of a cross product.
constexpr double kSingularSine = 1e-9;

SurfaceType typeOf(GeomAbs_SurfaceType type) {
  switch (type) {
    case GeomAbs_Plane:
      return SurfaceType::Plane;
    case GeomAbs_Cylinder:
      return SurfaceType::Cylinder;
    case GeomAbs_Cone:
      return SurfaceType::Cone;
    case GeomAbs_Sphere:
      return SurfaceType::Sphere;
    case GeomAbs_Torus:
      return SurfaceType::Torus;
    case GeomAbs_SurfaceOfRevolution:
      return SurfaceType::Revolution;
    case GeomAbs_SurfaceOfExtrusion:
      return SurfaceType::Extrusion;
    case GeomAbs_BSplineSurface:
    case GeomAbs_BezierSurface:
      return SurfaceType::Bspline;
    default:
      return SurfaceType::Other;
  }
}

// ElSLib looks for the foot on one side of the axis: of a cone by which nappe a point is level
// with, though beyond the apex the foot may well be on the first; of a torus that crosses its axis
// always on the point's own. The foot wanted is on the part of the surface where the face is.

void coneParameters(const gp_Cone& cone, const gp_Pnt& p, double vOfFace, double& u, double& v) {
  ElSLib::Parameters(cone, p, u, v);
  const auto radius = [&](double at) { return cone.RefRadius() + at * std::sin(cone.SemiAngle()); };
  const double across = u + std::numbers::pi;
  // Along the generator on the other side.
  gp_Pnt from;
  gp_Vec du;
  gp_Vec dv;
  ElSLib::D1(across, 0, cone, from, du, dv);
  const double vAcross = gp_Vec(from, p).Dot(dv);
  const double nappe = radius(vOfFace);
  const bool here = radius(v) * nappe >= 0;
  const bool there = radius(vAcross) * nappe >= 0;
  const bool nearer = ElSLib::Value(across, vAcross, cone).SquareDistance(p) <
                      ElSLib::Value(u, v, cone).SquareDistance(p);
  if (there && (!here || nearer)) {
    u = across;
    v = vAcross;
  }
}

void torusParameters(const gp_Torus& torus, const gp_Pnt& p, double vLow, double vHigh, double& u,
                     double& v) {
  ElSLib::Parameters(torus, p, u, v);
  if (torus.MajorRadius() > torus.MinorRadius()) return;
  constexpr double kTurn = 2 * std::numbers::pi;
  const auto inFace = [&](double at) {
    return at + kTurn * std::ceil((vLow - at) / kTurn) <= vHigh;
  };
  const gp_Vec arm(torus.Location(), p);
  const double along = arm.Dot(gp_Vec(torus.Axis().Direction()));
  const double away = std::sqrt(std::max(0.0, arm.SquareMagnitude() - along * along));
  const double across = u + std::numbers::pi;
  const double vAcross = std::atan2(along, -away - torus.MajorRadius());
  const bool here = inFace(v);
  const bool there = inFace(vAcross);
  const bool nearer = ElSLib::Value(across, vAcross, torus).SquareDistance(p) <
                      ElSLib::Value(u, v, torus).SquareDistance(p);
  if (there && (!here || nearer)) {
    u = across;
    v = vAcross;
  }
}

/// Where the distance has no minimum near by (beyond a centre of curvature): Newton's step with the
/// absolute curvatures, relative to the metric (modified Newton; Gill & Murray 1974).
Eigen::Vector2d descent(const Eigen::Matrix2d& hessian, const Eigen::Matrix2d& metric,
                        const Eigen::Vector2d& gradient) {
  const Eigen::Matrix2d regular = metric + 1e-9 * metric.trace() * Eigen::Matrix2d::Identity();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix2d> solver(hessian, regular);
  const Eigen::Vector2d curvatures = solver.eigenvalues().cwiseAbs().cwiseMax(kLeastCurvature);
  return solver.eigenvectors() *
         (solver.eigenvectors().transpose() * gradient).cwiseQuotient(curvatures);
}

}  // namespace

FaceSurface::FaceSurface(const TopoDS_Face& face) : adaptor_(face, Standard_False) {
  type_ = typeOf(adaptor_.GetType());
  mirrored_ = adaptor_.Trsf().IsNegative();
  flipped_ = (face.Orientation() == TopAbs_REVERSED) != mirrored_;
  uPeriodic_ = adaptor_.IsUPeriodic();
  vPeriodic_ = adaptor_.IsVPeriodic();
  low_ = {adaptor_.FirstUParameter(), adaptor_.FirstVParameter()};
  high_ = {adaptor_.LastUParameter(), adaptor_.LastVParameter()};
  BRepTools::UVBounds(face, faceLow_.x(), faceHigh_.x(), faceLow_.y(), faceHigh_.y());
  if (adaptor_.GetType() == GeomAbs_OffsetSurface) findBasis();
}

void FaceSurface::findBasis() {
  const Handle(Adaptor3d_Surface) basis = adaptor_.BasisSurface();
  const Eigen::Vector2d middle = 0.5 * (faceLow_ + faceHigh_);
  gp_Pnt p;
  gp_Vec bu, bv;
  basis->D1(middle.x(), middle.y(), p, bu, bv);
  const gp_Vec step(p, adaptor_.Value(middle.x(), middle.y()));
  const gp_Vec cross = bu ^ bv;
  if (!(cross.Magnitude() > kSingularSine * bu.Magnitude() * bv.Magnitude())) return;
  // Measured, because locations may mirror and scale.
  height_ = step.Dot(cross / cross.Magnitude());
  if (height_ != 0) basis_ = basis;
}

bool FaceSurface::analytic() const {
  return type_ == SurfaceType::Plane || type_ == SurfaceType::Cylinder ||
         type_ == SurfaceType::Cone || type_ == SurfaceType::Sphere || type_ == SurfaceType::Torus;
}

Vec3 FaceSurface::point(const Eigen::Vector2d& uv) const {
  return toVec3(adaptor_.Value(uv.x(), uv.y()).XYZ());
}

bool FaceSurface::pointAndNormal(const Eigen::Vector2d& uv, Vec3& point, Vec3& normal) const {
  gp_Pnt p;
  gp_Vec du, dv;
  adaptor_.D1(uv.x(), uv.y(), p, du, dv);
  point = toVec3(p.XYZ());
  const Vec3 su = toVec3(du.XYZ());
  const Vec3 sv = toVec3(dv.XYZ());
  const Vec3 cross = su.cross(sv);
  const double area = cross.norm();
  const double lengths = su.norm() * sv.norm();
  // At a pole one derivative vanishes against its size elsewhere: compare with the face's extent.
  const Eigen::Vector2d span = faceHigh_ - faceLow_;
  const double lu = su.norm() * span.x();
  const double lv = sv.norm() * span.y();
  if (!(area > kSingularSine * lengths) || !(std::min(lu, lv) > kSingularSine * std::max(lu, lv))) {
    return false;
  }
  normal = cross / (flipped_ ? -area : area);
  return true;
}

Eigen::Vector2d FaceSurface::clamped(Eigen::Vector2d uv) const {
  if (!uPeriodic_) uv.x() = std::clamp(uv.x(), low_.x(), high_.x());
  if (!vPeriodic_) uv.y() = std::clamp(uv.y(), low_.y(), high_.y());
  return uv;
}

SurfaceFoot FaceSurface::foot(const Vec3& x, double tolerance, Eigen::Vector2d start) const {
  if (!analytic()) return newtonFoot(x, tolerance, start);
  const gp_Pnt p = toPnt(x);
  double u = 0;
  double v = 0;
  switch (type_) {
    case SurfaceType::Plane:
      ElSLib::Parameters(adaptor_.Plane(), p, u, v);
      break;
    case SurfaceType::Cylinder:
      ElSLib::Parameters(adaptor_.Cylinder(), p, u, v);
      break;
    case SurfaceType::Cone:
      coneParameters(adaptor_.Cone(), p, 0.5 * (faceLow_.y() + faceHigh_.y()), u, v);
      break;
    case SurfaceType::Sphere:
      ElSLib::Parameters(adaptor_.Sphere(), p, u, v);
      break;
    default:
      torusParameters(adaptor_.Torus(), p, faceLow_.y(), faceHigh_.y(), u, v);
      break;
  }
  // The parameters come in the principal period; bring them next to the start.
  SurfaceFoot foot;
  foot.converged = true;
  foot.uv = {u, v};
  constexpr double kTurn = 2 * 3.14159265358979323846;
  if (uPeriodic_) foot.uv.x() += kTurn * std::round((start.x() - u) / kTurn);
  if (vPeriodic_) foot.uv.y() += kTurn * std::round((start.y() - v) / kTurn);
  foot.point = point(foot.uv);
  return foot;
}

/// The surface at (u,v) as seen from x.
struct FaceSurface::Bending {
  Vec3 residual;           ///< from x to the surface
  Vec3 su, sv;             ///< first derivatives
  Eigen::Matrix2d second;  ///< residual . second derivatives
};

// OpenCASCADE takes an offset surface's derivatives from higher ones of its basis, one by one and
// uncached. What Newton's step needs is cheaper: S = B + h n, and n.S_uu = -n_u.S_u because
// n.S_u = 0. The tangential part of the residual is left out; it is nought at the foot.
std::optional<FaceSurface::Bending> FaceSurface::bendingOfOffset(const Eigen::Vector2d& uv,
                                                                 const Vec3& x) const {
  gp_Pnt p;
  gp_Vec bu, bv, buu, bvv, buv;
  basis_->D2(uv.x(), uv.y(), p, bu, bv, buu, bvv, buv);
  const gp_Vec cross = bu ^ bv;
  const double area = cross.Magnitude();
  if (!(area > kSingularSine * bu.Magnitude() * bv.Magnitude())) return std::nullopt;
  const gp_Vec n = cross / area;
  const auto alongNormal = [&](const gp_Vec& derivative) {
    return toVec3(((derivative - n * n.Dot(derivative)) * (height_ / area)).XYZ());
  };
  const Vec3 hnu = alongNormal((buu ^ bv) + (bu ^ buv));
  const Vec3 hnv = alongNormal((buv ^ bv) + (bu ^ bvv));
  Bending at;
  at.residual = toVec3((p.XYZ() + n.XYZ() * height_)) - x;
  at.su = toVec3(bu.XYZ()) + hnu;
  at.sv = toVec3(bv.XYZ()) + hnv;
  const double scale = -at.residual.dot(toVec3(n.XYZ())) / height_;
  const double mixed = scale * hnu.dot(at.sv);
  at.second << scale * hnu.dot(at.su), mixed, mixed, scale * hnv.dot(at.sv);
  return at;
}

FaceSurface::Bending FaceSurface::bendingAt(const Eigen::Vector2d& uv, const Vec3& x) const {
  if (!basis_.IsNull()) {
    if (const std::optional<Bending> at = bendingOfOffset(uv, x)) return *at;
  }
  gp_Pnt p;
  gp_Vec du, dv, duu, dvv, duv;
  adaptor_.D2(uv.x(), uv.y(), p, du, dv, duu, dvv, duv);
  Bending at;
  at.residual = toVec3(p.XYZ()) - x;
  at.su = toVec3(du.XYZ());
  at.sv = toVec3(dv.XYZ());
  const double mixed = at.residual.dot(toVec3(duv.XYZ()));
  at.second << at.residual.dot(toVec3(duu.XYZ())), mixed, mixed, at.residual.dot(toVec3(dvv.XYZ()));
  return at;
}

SurfaceFoot FaceSurface::newtonFoot(const Vec3& x, double tolerance,
                                    const Eigen::Vector2d& start) const {
  SurfaceFoot foot;
  Eigen::Vector2d& uv = foot.uv;
  uv = clamped(start);
  double best = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kNewtonSteps; ++step) {
    const Bending at = bendingAt(uv, x);
    const Vec3& r = at.residual;
    const Vec3& su = at.su;
    const Vec3& sv = at.sv;
    foot.point = x + r;
    best = r.squaredNorm();
    Eigen::Vector2d g(r.dot(su), r.dot(sv));
    Eigen::Matrix2d first;
    first << su.dot(su), su.dot(sv), su.dot(sv), sv.dot(sv);
    Eigen::Matrix2d h = first + at.second;
    // Directions blocked by a bound of the surface take no part.
    foot.atBound = false;
    for (int k = 0; k < 2; ++k) {
      const bool periodic = k == 0 ? uPeriodic_ : vPeriodic_;
      if (periodic) continue;
      const bool blocked = (uv[k] <= low_[k] && g[k] > 0) || (uv[k] >= high_[k] && g[k] < 0);
      if (!blocked) continue;
      foot.atBound |= std::abs(g[k]) > tolerance * (k == 0 ? su : sv).norm();
      g[k] = 0;
      h(0, 1) = h(1, 0) = first(0, 1) = first(1, 0) = 0;
      h(k, k) = first(k, k) = std::max(first(k, k), 1e-300);
    }
    const double residual = std::max(std::abs(g.x()) / std::max(su.norm(), 1e-300),
                                     std::abs(g.y()) / std::max(sv.norm(), 1e-300));
    // The residual is |r| sin(angle): the tangential miss for feet close by, an upper bound else.
    foot.converged = residual <= tolerance;
    if (foot.converged) return foot;
    const double determinant = h.determinant();
    const bool definite = h(0, 0) > 0 && determinant > 1e-12 * h(0, 0) * std::abs(h(1, 1));
    const Eigen::Vector2d delta = definite ? h.inverse() * g : descent(h, first, g);
    if (!delta.allFinite()) return foot;
    double factor = 1;
    bool moved = false;
    for (int halving = 0; halving < 12; ++halving, factor *= 0.5) {
      const Eigen::Vector2d next = clamped(uv - factor * delta);
      const double d2 = (point(next) - x).squaredNorm();
      if (d2 < best) {
        uv = next;
        moved = true;
        break;
      }
    }
    // No step lowers the distance any more: at round-off of the squared distance.
    if (!moved) {
      foot.converged = residual <= kLooseResidual * tolerance;
      return foot;
    }
  }
  return foot;
}

std::optional<Plane> FaceSurface::plane(double tolerance) const {
  if (type_ == SurfaceType::Plane) {
    Vec3 p, n;
    const Eigen::Vector2d middle = 0.5 * (faceLow_ + faceHigh_);
    if (!pointAndNormal(middle, p, n)) return std::nullopt;
    return Plane{n, n.dot(p)};
  }
  if (analytic()) return std::nullopt;
  std::vector<Vec3> samples;
  constexpr int kMaxPoles = 4000;  // beyond, sampling is as good and cheaper
  if (adaptor_.GetType() == GeomAbs_BSplineSurface &&
      adaptor_.NbUPoles() * adaptor_.NbVPoles() < kMaxPoles) {
    const Handle(Geom_BSplineSurface) s = adaptor_.BSpline();
    for (int i = 1; i <= s->NbUPoles(); ++i) {
      for (int j = 1; j <= s->NbVPoles(); ++j) samples.push_back(toVec3(s->Pole(i, j).XYZ()));
    }
  } else {
    for (int i = 0; i < kPlaneSamples; ++i) {
      for (int j = 0; j < kPlaneSamples; ++j) {
        const Eigen::Vector2d t(i / (kPlaneSamples - 1.0), j / (kPlaneSamples - 1.0));
        samples.push_back(point(faceLow_ + t.cwiseProduct(faceHigh_ - faceLow_)));
      }
    }
  }
  // The normal at a regular point of the face; a plane has the same everywhere.
  Vec3 p, n;
  const Eigen::Vector2d middle = 0.5 * (faceLow_ + faceHigh_);
  if (!pointAndNormal(middle, p, n)) return std::nullopt;
  Vec3 mean = Vec3::Zero();
  for (const Vec3& s : samples) mean += s;
  mean /= static_cast<double>(samples.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Vec3& s : samples) covariance += (s - mean) * (s - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  Vec3 normal = solver.eigenvectors().col(0);
  if (normal.dot(n) < 0) normal = -normal;
  for (const Vec3& s : samples) {
    if (!(std::abs(normal.dot(s - mean)) <= tolerance)) return std::nullopt;
  }
  // A planar surface that folds over itself has two normals; such a face counts as curved.
  if (normal.dot(n) < 1 - 1e-6) return std::nullopt;
  return Plane{normal, normal.dot(mean)};
}

}  // namespace phront::cad
