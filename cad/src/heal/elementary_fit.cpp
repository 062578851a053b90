// Linear least squares give a start, Gauss-Newton on the geometric distance the rest.
//
// Starts: the plane from the spread of the points; the sphere from |p|^2 = 2 c.p + k; the axis of a
// cylinder from the spread of the normals, which lie in a plane through the origin; the axis of a
// cone from the plane that the tips of its normals lie in, its apex from the tangent planes; the
// axis of a torus as the line that all normal lines meet, the null vector of their Pluecker
// coordinates (Pottmann & Randrup 1998, "Rotational and helical surface approximation").
// Points are scaled to unit size first. Weak spot: shallow pieces of large cylinders and tori are
// planes within the tolerance, and are then given out as planes.
#include "heal/elementary_fit.h"

#include <Eigen/Dense>
#include <Geom_ConicalSurface.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_Plane.hxx>
#include <Geom_SphericalSurface.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <algorithm>
#include <cmath>
#include <functional>
#include <gp_Ax3.hxx>
#include <numbers>
#include <vector>

#include "heal/free_angle.h"

namespace phront::cad {
namespace {

using Eigen::VectorXd;
using Residual = std::function<double(const VectorXd&, const Vec3&)>;

constexpr std::size_t kFewest = 9;
constexpr int kNewtonSteps = 8;
constexpr std::size_t kNewtonPoints = 80;  // all points decide, these are enough to find it
// Starts farther off than this share of the size belong to another kind of surface.
constexpr double kHopeless = 0.02;
constexpr double kDifference = 1e-6;  // step of the numerical derivative, of unit size
// Surfaces that turn less than this (rad) over all points are not worth telling from a plane.
constexpr double kLeastTurn = 1e-3;
// Normals may disagree by this (rad): a surface is not only met but followed.
constexpr double kNormalSlack = 0.02;
// Nothing nearer than this (rad) to the seam, a pole; of the size, to an apex.
constexpr double kClear = 0.05;

/// Two unit vectors across `axis`.
std::pair<Vec3, Vec3> across(const Vec3& axis) {
  const Vec3 x = axis.unitOrthogonal();
  return {x, axis.cross(x)};
}

/// Axis turned by two small angles.
Vec3 tilted(const Vec3& axis, double a, double b) {
  const auto [x, y] = across(axis);
  return (axis + a * x + b * y).normalized();
}

class Fitter {
 public:
  Fitter(std::span<const SurfacePoint> points, double tolerance) {
    for (const SurfacePoint& p : points) centre_ += p.point / static_cast<double>(points.size());
    for (const SurfacePoint& p : points) size_ = std::max(size_, (p.point - centre_).norm());
    for (const SurfacePoint& p : points) {
      points_.push_back({(p.point - centre_) / size_, p.normal});
      meanNormal_ += p.normal;
    }
    tolerance_ = tolerance / size_;
  }

  std::optional<ElementaryFit> run() {
    if (!(size_ > 0) || !std::isfinite(size_)) return std::nullopt;
    using Way = std::optional<ElementaryFit> (Fitter::*)();
    for (const Way way :
         {&Fitter::plane, &Fitter::sphere, &Fitter::cylinder, &Fitter::cone, &Fitter::torus}) {
      if (auto fit = (this->*way)()) return fit;
    }
    return std::nullopt;
  }

 private:
  std::optional<ElementaryFit> plane() {
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const SurfacePoint& p : points_) spread += p.point * p.point.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(spread);
    if (eigen.eigenvalues()[1] < 1e-12 * eigen.eigenvalues()[2]) return std::nullopt;  // a line
    Vec3 n = eigen.eigenvectors().col(0);
    if (n.dot(meanNormal_) < 0) n = -n;
    const auto normal = [&](const Vec3&) { return n; };
    const double deviation = worst([&](const Vec3& p) { return n.dot(p); }, normal);
    if (deviation > tolerance_) return std::nullopt;
    return ElementaryFit{new Geom_Plane(toPoint(Vec3::Zero()), gp_Dir(n.x(), n.y(), n.z())),
                         deviation* size_};
  }

  std::optional<ElementaryFit> sphere() {
    Eigen::MatrixXd a(points_.size(), 4);
    VectorXd b(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      a.row(row) << 2 * points_[i].point.transpose(), 1;
      b[row] = points_[i].point.squaredNorm();
    }
    const VectorXd s = a.colPivHouseholderQr().solve(b);
    VectorXd x(4);
    x << s.head<3>(), std::sqrt(std::max(0.0, s[3] + s.head<3>().squaredNorm()));
    const Residual residual = [](const VectorXd& v, const Vec3& p) {
      return (p - v.head<3>()).norm() - v[3];
    };
    if (!newton(x, residual)) return std::nullopt;
    const Vec3 c = x.head<3>();
    const double r = x[3];
    if (!(r > 0) || 1 / r < kLeastTurn) return std::nullopt;
    const auto normal = [&](const Vec3& p) -> Vec3 { return (p - c).normalized(); };
    const double deviation = worst([&](const Vec3& p) { return residual(x, p); }, normal);
    if (deviation > tolerance_) return std::nullopt;

    // The axis across the middle of the points about which they reach the least latitude.
    Vec3 middle = Vec3::Zero();
    for (const SurfacePoint& p : points_) middle += normal(p.point);
    if (middle.norm() < kClear * static_cast<double>(points_.size())) return std::nullopt;
    middle.normalize();
    const auto [e1, e2] = across(middle);
    Vec3 axis = e1;
    double least = 2;
    constexpr int kTurns = 24;
    for (int i = 0; i < kTurns; ++i) {
      const double angle = std::numbers::pi * i / kTurns;
      const Vec3 candidate = std::cos(angle) * e1 + std::sin(angle) * e2;
      double latitude = 0;
      for (const SurfacePoint& p : points_) {
        latitude = std::max(latitude, std::abs(normal(p.point).dot(candidate)));
      }
      if (latitude < least - 1e-9) {
        least = latitude;
        axis = candidate;
      }
    }
    if (std::asin(std::min(1.0, least)) > std::numbers::pi / 2 - kClear) return std::nullopt;
    const auto frame = frameAround(c, axis);
    if (!frame) return std::nullopt;
    return ElementaryFit{new Geom_SphericalSurface(*frame, r * size_), deviation* size_};
  }

  std::optional<ElementaryFit> cylinder() {
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const SurfacePoint& p : points_) spread += p.normal * p.normal.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(spread);
    const auto count = static_cast<double>(points_.size());
    if (eigen.eigenvalues()[1] < kLeastTurn * kLeastTurn * count) return std::nullopt;
    const Vec3 axis = eigen.eigenvectors().col(0);
    const auto [e1, e2] = across(axis);
    Eigen::MatrixXd a(points_.size(), 3);
    VectorXd b(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const double u = e1.dot(points_[i].point);
      const double v = e2.dot(points_[i].point);
      a.row(static_cast<Eigen::Index>(i)) << 2 * u, 2 * v, 1;
      b[static_cast<Eigen::Index>(i)] = u * u + v * v;
    }
    const VectorXd s = a.colPivHouseholderQr().solve(b);
    VectorXd x(5);  // centre across the axis (2), tilt (2), radius
    x << s[0], s[1], 0, 0, std::sqrt(std::max(0.0, s[2] + s[0] * s[0] + s[1] * s[1]));
    const auto axisOf = [&](const VectorXd& v) { return tilted(axis, v[2], v[3]); };
    const auto radial = [&](const VectorXd& v, const Vec3& p) -> Vec3 {
      const Vec3 d = p - (v[0] * e1 + v[1] * e2);
      const Vec3 z = axisOf(v);
      return d - z * z.dot(d);
    };
    const Residual residual = [&](const VectorXd& v, const Vec3& p) {
      return radial(v, p).norm() - v[4];
    };
    if (!newton(x, residual)) return std::nullopt;
    if (!(x[4] > 0) || 1 / x[4] < kLeastTurn) return std::nullopt;
    const auto normal = [&](const Vec3& p) -> Vec3 { return radial(x, p).normalized(); };
    const double deviation = worst([&](const Vec3& p) { return residual(x, p); }, normal);
    if (deviation > tolerance_) return std::nullopt;
    const auto frame = frameAround(x[0] * e1 + x[1] * e2, axisOf(x));
    if (!frame) return std::nullopt;
    return ElementaryFit{new Geom_CylindricalSurface(*frame, x[4] * size_), deviation* size_};
  }

  std::optional<ElementaryFit> cone() {
    const auto count = static_cast<double>(points_.size());
    const Vec3 mean = meanNormal_ / count;
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d tangents = Eigen::Matrix3d::Zero();
    Vec3 right = Vec3::Zero();
    for (const SurfacePoint& p : points_) {
      spread += (p.normal - mean) * (p.normal - mean).transpose();
      tangents += p.normal * p.normal.transpose();
      right += p.normal * p.normal.dot(p.point);
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(spread);
    if (eigen.eigenvalues()[1] < kLeastTurn * kLeastTurn * count) return std::nullopt;
    const Vec3 apex0 = tangents.ldlt().solve(right);
    if (!apex0.allFinite() || apex0.norm() > 1 / kLeastTurn) return std::nullopt;
    Vec3 axis = eigen.eigenvectors().col(0);
    if (axis.dot(apex0) > 0) axis = -axis;  // from the apex towards the points, roughly
    const double sine = std::abs(axis.dot(mean));
    VectorXd x(6);  // apex (3), tilt (2), half angle
    x << apex0, 0, 0, std::asin(std::min(1.0, sine));
    const auto axisOf = [&](const VectorXd& v) { return tilted(axis, v[3], v[4]); };
    const Residual residual = [&](const VectorXd& v, const Vec3& p) {
      const Vec3 z = axisOf(v);
      const Vec3 d = p - v.head<3>();
      const double h = z.dot(d);
      return (d - h * z).norm() * std::cos(v[5]) - h * std::sin(v[5]);
    };
    if (!newton(x, residual)) return std::nullopt;
    const double half = x[5];
    if (!(half > kLeastTurn) || half > std::numbers::pi / 2 - kLeastTurn) return std::nullopt;
    const Vec3 z = axisOf(x);
    const Vec3 apex = x.head<3>();
    double lowest = std::numeric_limits<double>::infinity();
    for (const SurfacePoint& p : points_) lowest = std::min(lowest, z.dot(p.point - apex));
    if (lowest < kClear * kClear) return std::nullopt;
    const auto radial = [&](const Vec3& p) -> Vec3 {
      const Vec3 d = p - apex;
      return (d - z * z.dot(d)).normalized();
    };
    const auto normal = [&](const Vec3& p) -> Vec3 {
      return std::cos(half) * radial(p) - std::sin(half) * z;
    };
    const double deviation = worst([&](const Vec3& p) { return residual(x, p); }, normal);
    if (deviation > tolerance_) return std::nullopt;
    // The reference circle at the lowest point keeps the radius positive.
    const auto frame = frameAround(apex + lowest * z, z);
    if (!frame) return std::nullopt;
    return ElementaryFit{new Geom_ConicalSurface(*frame, half, lowest * std::tan(half) * size_),
                         deviation* size_};
  }

  std::optional<ElementaryFit> torus() {
    Eigen::Matrix<double, 6, 6> lines = Eigen::Matrix<double, 6, 6>::Zero();
    for (const SurfacePoint& p : points_) {
      Eigen::Matrix<double, 6, 1> row;
      row << p.point.cross(p.normal), p.normal;
      lines += row * row.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(lines);
    const Eigen::Matrix<double, 6, 1> line = eigen.eigenvectors().col(0);
    const double length = line.head<3>().norm();
    if (length < kLeastTurn) return std::nullopt;
    const Vec3 axis = line.head<3>() / length;
    const Vec3 foot = axis.cross(Vec3(line.tail<3>() / length));
    if (foot.norm() > 1 / kLeastTurn) return std::nullopt;
    Eigen::MatrixXd a(points_.size(), 3);
    VectorXd b(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Vec3 d = points_[i].point - foot;
      const double h = axis.dot(d);
      const double r = (d - h * axis).norm();
      a.row(static_cast<Eigen::Index>(i)) << 2 * r, 2 * h, 1;
      b[static_cast<Eigen::Index>(i)] = r * r + h * h;
    }
    const VectorXd s = a.colPivHouseholderQr().solve(b);
    VectorXd x(7);  // centre (3), tilt (2), radii
    x << foot + s[1] * axis, 0, 0, s[0], std::sqrt(std::max(0.0, s[2] + s[0] * s[0] + s[1] * s[1]));
    const auto axisOf = [&](const VectorXd& v) { return tilted(axis, v[3], v[4]); };
    const auto radial = [&](const VectorXd& v, const Vec3& p) -> Vec3 {
      const Vec3 z = axisOf(v);
      const Vec3 d = p - v.head<3>();
      return (d - z * z.dot(d)).normalized();
    };
    const Residual residual = [&](const VectorXd& v, const Vec3& p) {
      return (p - v.head<3>() - v[5] * radial(v, p)).norm() - v[6];
    };
    if (!newton(x, residual)) return std::nullopt;
    const double major = x[5];
    const double minor = x[6];
    if (!(minor > 0) || !(major > minor * (1 + kClear)) || 1 / minor < kLeastTurn ||
        major > 1 / kLeastTurn) {
      return std::nullopt;
    }
    const Vec3 c = x.head<3>();
    const auto normal = [&](const Vec3& p) -> Vec3 {
      return (p - c - major * radial(x, p)).normalized();
    };
    const double deviation = worst([&](const Vec3& p) { return residual(x, p); }, normal);
    if (deviation > tolerance_) return std::nullopt;
    const auto frame = frameAround(c, axisOf(x));
    if (!frame) return std::nullopt;
    return ElementaryFit{new Geom_ToroidalSurface(*frame, major * size_, minor * size_),
                         deviation* size_};
  }

  /// Gauss-Newton; false when the numbers run away.
  bool newton(VectorXd& x, const Residual& residual) const {
    if (!x.allFinite()) return false;
    const std::size_t stride = points_.size() / kNewtonPoints + 1;
    const auto rows = static_cast<Eigen::Index>((points_.size() - 1) / stride + 1);
    for (int step = 0; step < kNewtonSteps; ++step) {
      VectorXd r(rows);
      Eigen::MatrixXd j(rows, x.size());
      for (Eigen::Index i = 0; i < rows; ++i) {
        const Vec3& p = points_[static_cast<std::size_t>(i) * stride].point;
        r[i] = residual(x, p);
        for (Eigen::Index k = 0; k < x.size(); ++k) {
          VectorXd up = x;
          VectorXd down = x;
          up[k] += kDifference;
          down[k] -= kDifference;
          j(i, k) = (residual(up, p) - residual(down, p)) / (2 * kDifference);
        }
      }
      if (r.cwiseAbs().maxCoeff() > kHopeless) return false;
      const VectorXd change = j.colPivHouseholderQr().solve(r);
      if (!change.allFinite() || change.norm() > 10) return false;
      x -= change;
      if (change.norm() < 1e-14) break;
    }
    return x.allFinite();
  }

  /// Largest residual; infinite where the normals disagree.
  template <class Distance, class Normal>
  double worst(const Distance& distance, const Normal& normal) const {
    double result = 0;
    double sense = 0;
    for (const SurfacePoint& p : points_) {
      result = std::max(result, std::abs(distance(p.point)));
      const double cosine = normal(p.point).dot(p.normal);
      if (sense == 0) sense = cosine > 0 ? 1 : -1;
      if (!(sense * cosine > std::cos(kNormalSlack))) {
        return std::numeric_limits<double>::infinity();
      }
    }
    return std::isfinite(result) ? result : std::numeric_limits<double>::infinity();
  }

  /// Frame with the seam in the middle of the angle that the points leave free; nullopt when they
  /// leave too little.
  std::optional<gp_Ax3> frameAround(const Vec3& origin, const Vec3& axis) const {
    const auto [e1, e2] = across(axis);
    std::vector<double> angles;
    for (const SurfacePoint& p : points_) {
      const Vec3 d = p.point - origin;
      angles.push_back(std::atan2(d.dot(e2), d.dot(e1)));
    }
    const FreeAngle free = widestFreeAngle(std::move(angles));
    if (free.width < 2 * kClear) return std::nullopt;
    const Vec3 x = std::cos(free.middle) * e1 + std::sin(free.middle) * e2;
    return gp_Ax3(toPoint(origin), gp_Dir(axis.x(), axis.y(), axis.z()),
                  gp_Dir(x.x(), x.y(), x.z()));
  }

  [[nodiscard]] gp_Pnt toPoint(const Vec3& scaled) const {
    const Vec3 p = centre_ + size_ * scaled;
    return {p.x(), p.y(), p.z()};
  }

  std::vector<SurfacePoint> points_;
  Vec3 centre_ = Vec3::Zero();
  Vec3 meanNormal_ = Vec3::Zero();
  double size_ = 0;
  double tolerance_ = 0;
};

}  // namespace

std::optional<ElementaryFit> fitElementary(std::span<const SurfacePoint> points, double tolerance) {
  if (points.size() < kFewest || !(tolerance > 0)) return std::nullopt;
  return Fitter(points, tolerance).run();
}

}  // namespace phront::cad
