// Distance to several bodies at once and stratified sampling of their surfaces.
//
// The distance to a model is the least over its bodies; a body is asked only when its box could
// beat the best so far. Samples are drawn on the triangles (area known exactly, trims respected)
// and then lifted to the exact face, so the facets' chordal error is not part of what is measured.
// Strata of equal area within each face keep the variance of the percentiles low (Cochran, Sampling
// Techniques, 1977, ch. 5). Weak spot: weights are areas of triangles, not of the curved faces; the
// difference is second order in the angle between neighbouring triangles.
#include "judge/check_sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "phront/cad/shape_occt.h"

namespace phront::cad {
namespace {

// Chordal errors are measured on samples; the true maximum may be somewhat larger.
constexpr double kDeflectionSlack = 4;
// Triangles that deviate less than this share of the diagonal are planes: as good as exact.
constexpr double kPlanarShare = 2e-8;

// Where the sides of a triangle are looked at, in heights; flatter ones than this have none.
constexpr double kBesideSurface = 1e-3;
constexpr double kMostBesideSurface = 1e-6;  // of the diagonal
constexpr double kLeastHeight = 1e-6;

double triangleArea(const TriMesh& mesh, std::size_t t) {
  const auto& c = mesh.triangles[t];
  const auto point = [&](int k) -> const Vec3& {
    return mesh.points[static_cast<std::size_t>(c[static_cast<std::size_t>(k)])];
  };
  return 0.5 * (point(1) - point(0)).cross(point(2) - point(0)).norm();
}

}  // namespace

void WeightedErrors::add(double error, double weight) {
  items_.push_back({std::isnan(error) ? std::numeric_limits<double>::infinity() : error, weight});
}

double WeightedErrors::max() const {
  double best = 0;
  for (const Item& item : items_) best = std::max(best, item.error);
  return best;
}

double WeightedErrors::quantile(double fraction) const {
  if (items_.empty()) return 0;
  std::vector<Item> sorted = items_;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Item& a, const Item& b) { return a.error < b.error; });
  double total = 0;
  for (const Item& item : sorted) total += item.weight;
  double sum = 0;
  for (const Item& item : sorted) {
    sum += item.weight;
    if (sum >= fraction * total) return item.error;
  }
  return sorted.back().error;
}

double WeightedErrors::shareAbove(double bound) const {
  double total = 0;
  double above = 0;
  for (const Item& item : items_) {
    total += item.weight;
    if (item.error > bound) above += item.weight;
  }
  return total > 0 ? above / total : 0;
}

Result<ModelDistance> ModelDistance::build(const std::vector<Body>& bodies,
                                           const TessellateOptions& options,
                                           const std::string& what) {
  ModelDistance model;
  for (const Body& body : bodies) {
    if (faceCount(body.shape) == 0) continue;
    auto tessellation = tessellate(body, options);
    if (!tessellation) {
      return fail(ErrorCode::Failed,
                  what + " cannot be tessellated: " + tessellation.error().message,
                  tessellation.error().where);
    }
    auto distance = TrueDistance::build(occtShape(body.shape), std::move(*tessellation));
    if (!distance) return tl::unexpected<Error>(distance.error());
    model.add(body, std::make_shared<const TrueDistance>(std::move(*distance)), options.deflection);
  }
  return std::move(model).finished(what);
}

Result<ModelDistance> ModelDistance::of(const Body& body,
                                        std::shared_ptr<const TrueDistance> distance) {
  ModelDistance model;
  model.add(body, std::move(distance), 0);
  return std::move(model).finished("the body");
}

void ModelDistance::add(const Body& body, std::shared_ptr<const TrueDistance> distance,
                        double deflection) {
  const Tessellation& tessellation = distance->tessellation();
  const double measured = tessellation.measuredDeflection;
  faces_ += faceCount(body.shape);
  untessellated_ += tessellation.untessellatedFaces;
  deflection_ = std::max(deflection_, measured);
  area_ += phront::area(tessellation.mesh);
  hasSolids_ = hasSolids_ || body.kind == BodyKind::Solid;
  const Box3 box = phront::boundingBox(tessellation.mesh);
  box_.extend(box);
  parts_.push_back(Part{occtShape(body.shape), body.kind == BodyKind::Solid,
                        measured <= kPlanarShare * box.diagonal().norm(), std::move(distance),
                        kDeflectionSlack * std::max(measured, deflection)});
}

Result<ModelDistance> ModelDistance::finished(const std::string& what) && {
  if (parts_.empty() || !(area_ > 0))
    return fail(ErrorCode::Failed, what + " has no face that can be tessellated");
  return std::move(*this);
}

double ModelDistance::distance(const Vec3& x) const {
  double best = std::numeric_limits<double>::infinity();
  for (const Part& part : parts_) {
    const SurfaceDistance& surface = part.distance->surface();
    if (part.planar) {
      const FootPoint foot = surface.foot(x, best);
      if (foot.triangle != kNone) best = std::min(best, foot.distance);
      continue;
    }
    if (parts_.size() > 1) {
      if (surface.box().exteriorDistance(x) - part.slack >= best) continue;
      if (surface.foot(x, best + part.slack).triangle == kNone) continue;
    }
    best = std::min(best, part.distance->foot(x).distance);
  }
  return best;
}

double ModelDistance::meshDistance(const Vec3& x) const {
  double best = std::numeric_limits<double>::infinity();
  for (const Part& part : parts_) {
    if (part.distance->surface().box().exteriorDistance(x) >= best) continue;
    const FootPoint foot = part.distance->surface().foot(x, best);
    if (foot.triangle != kNone) best = std::min(best, foot.distance);
  }
  return best;
}

bool ModelDistance::inside(const Vec3& x) const {
  for (std::size_t b = 0; b < parts_.size(); ++b)
    if (inside(b, x)) return true;
  return false;
}

bool ModelDistance::inside(std::size_t body, const Vec3& x) const {
  const Part& part = parts_[body];
  return part.solid && part.distance->surface().box().contains(x) &&
         std::abs(part.distance->surface().windingNumber(x)) > 0.5;
}

std::optional<bool> ModelDistance::beforeSheet(const Vec3& x) const {
  TrueDistance::Foot nearest;
  nearest.distance = std::numeric_limits<double>::infinity();
  for (const Part& part : parts_) {
    const TrueDistance::Foot foot = part.distance->foot(x);
    if (foot.distance < nearest.distance) nearest = foot;
  }
  if (nearest.feature.kind != FeatureKind::Face) return std::nullopt;
  return nearest.sign > 0;
}

double ModelDistance::winding(const Vec3& x) const {
  double sum = 0;
  for (const Part& part : parts_) {
    if (part.solid && part.distance->surface().box().contains(x))
      sum += part.distance->surface().windingNumber(x);
  }
  return sum;
}

bool ModelDistance::buried(std::size_t body, Index triangle) const {
  const TriMesh& mesh = parts_[body].distance->tessellation().mesh;
  const auto& corners = mesh.triangles[static_cast<std::size_t>(triangle)];
  const auto corner = [&](int k) -> const Vec3& {
    return mesh.points[static_cast<std::size_t>(corners[static_cast<std::size_t>(k)])];
  };
  double longest = 0;
  for (int k = 0; k < 3; ++k) longest = std::max(longest, (corner((k + 1) % 3) - corner(k)).norm());
  const Vec3 twiceArea = (corner(1) - corner(0)).cross(corner(2) - corner(0));
  const double height = twiceArea.norm() / longest;
  if (!parts_[body].solid || !(height > kLeastHeight * longest)) return false;
  const Vec3 middle = (corner(0) + corner(1) + corner(2)) / 3;
  // Nearer than the other side of a slot that is about to close.
  const double aside =
      std::min(kBesideSurface * height, kMostBesideSurface * box_.diagonal().norm());
  const Vec3 step = aside * twiceArea.normalized();
  return winding(middle + step) > 0.5 || winding(middle - step) > 1.5;
}

SurfaceSample ModelDistance::sampleAt(std::size_t body, Index triangle, const Vec3& bary) const {
  const TrueDistance& distance = *parts_[body].distance;
  const TriMesh& mesh = distance.tessellation().mesh;
  const auto& corners = mesh.triangles[static_cast<std::size_t>(triangle)];
  const auto corner = [&](int k) -> const Vec3& {
    return mesh.points[static_cast<std::size_t>(corners[static_cast<std::size_t>(k)])];
  };
  const Vec3 onTriangle = corner(0) * bary[0] + corner(1) * bary[1] + corner(2) * bary[2];
  const Vec3 normal = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();

  SurfaceSample sample{body, triangle, onTriangle, normal, 0};
  const auto face = static_cast<std::size_t>(mesh.face(triangle));
  const auto& features = distance.tessellation().features.faces;
  if (face < features.size() && features[face].plane) {
    const Plane& plane = *features[face].plane;
    sample.point -= plane.normal * (plane.normal.dot(onTriangle) - plane.offset);
    sample.normal = plane.normal;
    return sample;
  }
  Vec3 exactPoint;
  Vec3 exactNormal;
  if (distance.pointAndNormal(triangle, bary, exactPoint, exactNormal)) {
    sample.point = exactPoint;
    sample.normal = exactNormal;
  }
  return sample;
}

std::vector<SurfaceSample> ModelDistance::surfaceSamples(int count, int perFace,
                                                         SampleRng& rng) const {
  std::vector<SurfaceSample> samples;
  for (std::size_t b = 0; b < parts_.size(); ++b) {
    const TriMesh& mesh = parts_[b].distance->tessellation().mesh;
    const std::size_t faceLimit = parts_[b].distance->tessellation().features.faces.size();
    std::vector<std::vector<Index>> ofFace(std::max<std::size_t>(faceLimit, 1));
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto face = static_cast<std::size_t>(mesh.face(static_cast<Index>(t)));
      if (face < ofFace.size()) ofFace[face].push_back(static_cast<Index>(t));
    }
    for (const std::vector<Index>& triangles : ofFace) {
      std::vector<double> cumulated;
      double faceArea = 0;
      for (const Index t : triangles) {
        faceArea += triangleArea(mesh, static_cast<std::size_t>(t));
        cumulated.push_back(faceArea);
      }
      if (!(faceArea > 0)) continue;
      const int n = std::max(perFace, static_cast<int>(std::ceil(count * faceArea / area_)));
      for (int i = 0; i < n; ++i) {
        const double at = (i + rng()) / n * faceArea;
        const auto hit = std::upper_bound(cumulated.begin(), cumulated.end(), at);
        const auto index = std::min<std::size_t>(static_cast<std::size_t>(hit - cumulated.begin()),
                                                 triangles.size() - 1);
        const double r = std::sqrt(rng());
        const double s = rng();
        SurfaceSample sample = sampleAt(b, triangles[index], Vec3(1 - r, r * (1 - s), r * s));
        sample.weight = faceArea / n;
        samples.push_back(sample);
      }
    }
  }
  return samples;
}

}  // namespace phront::cad
