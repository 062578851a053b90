#include "carotid/figure.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cstdio>

#include "common/cutaway.h"
#include "phront/picture.h"

namespace thesis {

using phront::Vec3;

namespace {

constexpr double kOffNodes = 0.01;  // mm: a plane through nodes would cut slivers
constexpr double kTilt = 0.25;      // of the view, to look into the ends

struct Plane {
  Vec3 point;
  Vec3 normal;
};

/// The plane nearest to the points (least squares) runs along a vessel and its branches.
Plane flattest(const std::vector<Vec3>& points) {
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : points) middle += p / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vec3& p : points) spread += (p - middle) * (p - middle).transpose();
  const Vec3 normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
  return {middle, normal.dot(phront::PictureOptions{}.view) < 0 ? Vec3(-normal) : normal};
}

}  // namespace

void drawVessel(const std::string& name, const phront::TriMesh& mesh, const Run& run,
                const std::filesystem::path& png) {
  const auto [point, normal] = flattest(mesh.points);
  const auto& [wall, layer] = run.fronts;
  std::vector<phront::PictureItem> items(2);
  items[0].mesh = mesh;
  items[0].caption = name;
  items[0].color = {0.80, 0.42, 0.38};
  items[1].mesh = cutaway(mesh.triangles, {layer.points, mesh.points, wall.points},
                          point + kOffNodes * normal, normal);
  items[1].caption = fmt::format("cut open: wall {:+g} mm, layer {:+g} mm", kWall, kLayer);
  items[1].colorByFace = true;
  phront::PictureOptions options;
  options.width = 1600;
  options.height = 1100;
  options.view = normal + kTilt * Vec3::UnitZ();
  const auto drawn = phront::writePicture(items, png, options);
  if (!drawn) fmt::print(stderr, "no picture: {}\n", drawn.error().message);
}

}  // namespace thesis
