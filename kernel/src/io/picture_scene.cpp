// Turns labelled meshes into what is drawn. Shading normals are angle-weighted means over the
// corners around a point that are connected without crossing a feature edge (Thuermer & Wuethrich
// 1998), so fillets look round and edges stay sharp. Weak spot: a mesh of many small labelled
// facets becomes dark with lines.
#include "io/picture_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geom/mesh_topology.h"

namespace phront::io {
namespace {

const double kCosFeatureAngle = std::cos(30.0 / 180 * 3.14159265358979323846);  // as picture.h says
constexpr double kMargin = 1.06;  // of the view, so that nothing touches its border

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

std::vector<Vec3> triangleNormals(const TriMesh& mesh) {
  std::vector<Vec3> normals;
  normals.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const Vec3& a = mesh.points[at(t[0])];
    const Vec3 n = (mesh.points[at(t[1])] - a).cross(mesh.points[at(t[2])] - a);
    const double length = n.norm();
    normals.push_back(length > 0 ? Vec3(n / length) : Vec3(Vec3::Zero()));
  }
  return normals;
}

bool isFeature(const TriMesh& mesh, const std::vector<Vec3>& normals,
               std::span<const Index> sides) {
  if (sides.size() != 2) return true;
  const Index a = sides[0] / 3;
  const Index b = sides[1] / 3;
  if (mesh.face(a) != mesh.face(b)) return true;
  if (sideStart(mesh, sides[0]) == sideStart(mesh, sides[1])) return true;  // misoriented
  // Triangles without area have no normal; an edge to one is no crease.
  const bool flat = normals[at(a)].isZero() || normals[at(b)].isZero();
  return !flat && normals[at(a)].dot(normals[at(b)]) < kCosFeatureAngle;
}

double cornerAngle(const TriMesh& mesh, std::size_t triangle, std::size_t k) {
  const auto& t = mesh.triangles[triangle];
  const Vec3& p = mesh.points[at(t[k])];
  const Vec3 u = mesh.points[at(t[(k + 1) % 3])] - p;
  const Vec3 v = mesh.points[at(t[(k + 2) % 3])] - p;
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

/// Hues a golden-ratio step apart: neighbouring numbers differ well.
std::array<double, 3> hueOf(Index face) {
  constexpr double kGolden = 0.61803398874989485;
  constexpr double kSaturation = 0.45;
  constexpr double kValue = 0.92;
  const double hue = 6 * std::fmod(kGolden * (face + 1), 1.0);
  std::array<double, 3> color{};
  for (int c = 0; c < 3; ++c) {
    const double k = std::fmod(5 - 2 * c + hue, 6.0);
    color[at(c)] = kValue * (1 - kSaturation * std::clamp(std::min(k, 4 - k), 0.0, 1.0));
  }
  return color;
}

std::array<std::uint8_t, 3> bytesOf(const std::array<double, 3>& color) {
  std::array<std::uint8_t, 3> bytes{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double value = std::isfinite(color[c]) ? std::clamp(color[c], 0.0, 1.0) : 0.5;
    bytes[c] = static_cast<std::uint8_t>(std::lround(255 * value));
  }
  return bytes;
}

/// Extent of a view's points along an axis.
struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void add(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
  [[nodiscard]] double middle() const { return (low + high) / 2; }
  [[nodiscard]] double half() const { return (high - low) / 2; }
};

}  // namespace

SceneView makeView(const PictureItem& item) {
  const TriMesh mesh =
      weld(item.mesh);  // soups too: an edge is free only where nothing is beside it
  const std::vector<Vec3> normals = triangleNormals(mesh);
  const MeshEdges edges = meshEdges(mesh);

  SceneView view;
  view.caption = item.caption;
  DisjointSets corners(3 * mesh.triangles.size());
  const auto cornerAt = [&](Index side, bool end) {
    return end ? side - side % 3 + (side + 1) % 3 : side;
  };
  for (const MeshEdge& edge : edges.edges) {
    const auto sides = edges.sidesOf(edge);
    if (isFeature(mesh, normals, sides)) {
      view.lines.push_back({mesh.points[at(edge.low)], mesh.points[at(edge.high)]});
    } else {
      corners.unite(cornerAt(sides[0], false), cornerAt(sides[1], true));
      corners.unite(cornerAt(sides[0], true), cornerAt(sides[1], false));
    }
  }

  std::vector<Index> pointOfRoot(3 * mesh.triangles.size(), kNone);
  const std::array<std::uint8_t, 3> plain = bytesOf(item.color);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<Index, 3> triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      Index& point = pointOfRoot[at(corners.find(static_cast<Index>(3 * t + k)))];
      if (point == kNone) {
        point = static_cast<Index>(view.points.size());
        view.points.push_back(mesh.points[at(mesh.triangles[t][k])]);
        view.normals.push_back(Vec3::Zero());
        view.colors.push_back(item.colorByFace ? bytesOf(hueOf(mesh.face(static_cast<Index>(t))))
                                               : plain);
      }
      view.normals[at(point)] += cornerAngle(mesh, t, k) * normals[t];
      triangle[k] = point;
    }
    view.triangles.push_back(triangle);
  }
  for (Vec3& n : view.normals) {
    const double length = n.norm();
    if (length > 0) n /= length;
  }
  return view;
}

Scene makeScene(std::span<const PictureItem> items, const PictureOptions& options) {
  Scene scene;
  scene.width = options.width;
  scene.height = options.height;
  scene.towardsEye = options.view.normalized();
  const bool steep = std::abs(scene.towardsEye.z()) > 0.999;  // z is no use as "up" then
  const Vec3 right =
      (steep ? Vec3(Vec3::UnitY()) : Vec3(Vec3::UnitZ())).cross(scene.towardsEye).normalized();
  scene.up = scene.towardsEye.cross(right);

  double halfWidth = 0;
  double halfHeight = 0;
  scene.radius = 0;
  for (const PictureItem& item : items) {
    SceneView view = makeView(item);
    Range x;
    Range y;
    Range z;
    for (const Vec3& p : view.points) {
      x.add(right.dot(p));
      y.add(scene.up.dot(p));
      z.add(scene.towardsEye.dot(p));
    }
    if (!view.points.empty()) {
      view.center = x.middle() * right + y.middle() * scene.up + z.middle() * scene.towardsEye;
      halfWidth = std::max(halfWidth, x.half());
      halfHeight = std::max(halfHeight, y.half());
      scene.radius = std::max({scene.radius, x.half() + y.half() + z.half()});
    }
    scene.views.push_back(std::move(view));
  }
  const double aspect =
      options.width / static_cast<double>(items.size()) / ((1 - kCaptionShare) * options.height);
  scene.halfHeight = kMargin * std::max(halfHeight, halfWidth / aspect);
  if (!(scene.halfHeight > 0)) scene.halfHeight = 1;
  if (!(scene.radius > 0)) scene.radius = 1;
  return scene;
}

}  // namespace phront::io
