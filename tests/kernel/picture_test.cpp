// Pictures: which edges become lines, where shading has creases, and the pixels that are drawn.
#include "phront/picture.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <set>
#include <string>

#include "io/picture_scene.h"
#include "meshes.h"
#ifdef PHRONT_TEST_VTK
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>
#endif

namespace phront {
namespace {

namespace fs = std::filesystem;

TEST(PictureScene, BoxHasTwelveLinesAndFlatFaces) {
  const io::SceneView view = io::makeView({.mesh = test::box(Vec3(0, 0, 0), Vec3(1, 2, 3))});
  EXPECT_EQ(view.lines.size(), 12U);
  EXPECT_EQ(view.triangles.size(), 12U);
  EXPECT_EQ(view.points.size(), 24U);  // four per face: a crease on every edge
  for (const Vec3& n : view.normals) {
    EXPECT_NEAR(n.cwiseAbs().maxCoeff(), 1, 1e-15);
    EXPECT_NEAR(n.norm(), 1, 1e-15);
  }
}

TEST(PictureScene, UnlabelledBoxIsCreasedByAngleAlone) {
  TriMesh mesh = test::box(Vec3(0, 0, 0), Vec3(1, 1, 1));
  mesh.faceOf.clear();
  mesh.edgeOf.clear();
  mesh.vertexOf.clear();
  EXPECT_EQ(io::makeView({.mesh = mesh}).lines.size(), 12U);
}

TEST(PictureScene, SmoothSphereHasNoLineAndRoundShading) {
  const TriMesh mesh = test::sphere(2, 4);
  const io::SceneView view = io::makeView({.mesh = mesh});
  EXPECT_TRUE(view.lines.empty());
  ASSERT_EQ(view.points.size(), mesh.points.size());
  for (std::size_t i = 0; i < view.points.size(); ++i) {
    // Neighbouring triangles are some 5 degrees apart; their mean is far closer to the true normal.
    EXPECT_GT(view.normals[i].dot(view.points[i].normalized()), std::cos(0.015));
  }
}

TEST(PictureScene, FreeEdgesAndFaceBordersAreLines) {
  TriMesh square;
  square.points = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  EXPECT_EQ(io::makeView({.mesh = square}).lines.size(), 4U);
  square.faceOf = {0, 1};
  EXPECT_EQ(io::makeView({.mesh = square}).lines.size(), 5U);
}

TEST(PictureScene, ColorByFaceGivesEachFaceItsOwnColor) {
  const TriMesh mesh = test::box(Vec3(0, 0, 0), Vec3(1, 1, 1));
  const io::SceneView view = io::makeView({.mesh = mesh, .colorByFace = true});
  std::set<std::array<std::uint8_t, 3>> colors(view.colors.begin(), view.colors.end());
  EXPECT_EQ(colors.size(), 6U);
}

TEST(PictureScene, AllViewsFitAtOneScale) {
  const std::vector<PictureItem> items{{.mesh = test::sphere(1, 3, Vec3(100, 0, 0))},
                                       {.mesh = test::sphere(3, 3)}};
  const io::Scene scene = io::makeScene(items, {.width = 800, .height = 400});
  EXPECT_NEAR((scene.views[0].center - Vec3(100, 0, 0)).norm(), 0, 0.02);
  EXPECT_NEAR(scene.up.dot(scene.towardsEye), 0, 1e-15);
  EXPECT_GT(scene.halfHeight, 3);
  EXPECT_LT(scene.halfHeight, 3.6);
  EXPECT_GE(scene.radius, 3);
}

TEST(Picture, RefusesWhatCannotBeDrawn) {
  const PictureItem good{.mesh = test::box(Vec3(0, 0, 0), Vec3(1, 1, 1))};
  const auto code = [](const PictureItem& item, const fs::path& path,
                       const PictureOptions& options) {
    const auto done = writePicture(std::vector<PictureItem>{item}, path, options);
    return done ? ErrorCode::Failed : done.error().code;
  };
  EXPECT_EQ(code(good, "picture.jpg", {}), ErrorCode::InvalidArgument);
  EXPECT_EQ(code(good, "p.png", {.width = 0}), ErrorCode::InvalidArgument);
  EXPECT_EQ(code(good, "p.png", {.height = 1'000'000}), ErrorCode::InvalidArgument);
  EXPECT_EQ(code(good, "p.png", {.view = Vec3::Zero()}), ErrorCode::InvalidArgument);
  EXPECT_EQ(code(good, "p.png", {.view = Vec3(0, 0, std::nan(""))}), ErrorCode::InvalidArgument);
  PictureItem bad = good;
  bad.mesh.triangles[0][0] = 99;
  EXPECT_EQ(code(bad, "p.png", {}), ErrorCode::InvalidArgument);
  bad = good;
  bad.mesh.points[0].x() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(code(bad, "p.png", {}), ErrorCode::InvalidArgument);
  const auto none = writePicture({}, "p.png");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::InvalidArgument);
}

#ifdef PHRONT_TEST_VTK

/// Draws into a file of its own and reads it back.
class PicturePixels : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "phront_picture_XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// False, with the test skipped or failed, when there is no picture.
  bool draw(const std::vector<PictureItem>& items, const PictureOptions& options) {
    const fs::path path = folder_ / "picture.png";
    const auto done = writePicture(items, path, options);
    if (!done && done.error().message.find("EGL") != std::string::npos)
      skip_ = done.error().message;
    if (!done && skip_.empty()) ADD_FAILURE() << done.error().message;
    if (!done) return false;
    reader_->SetFileName(path.c_str());
    reader_->Update();
    image_ = reader_->GetOutput();
    return true;
  }

  [[nodiscard]] double level(int x, int y) const {  // mean of the three channels; y from below
    double sum = 0;
    for (int c = 0; c < 3; ++c) sum += image_->GetScalarComponentAsDouble(x, y, 0, c);
    return sum / 3;
  }
  [[nodiscard]] bool isBackground(int x, int y) const { return level(x, y) > 240; }
  [[nodiscard]] int drawn(int fromX, int toX, int fromY, int toY) const {
    int count = 0;
    for (int y = fromY; y < toY; ++y) {
      for (int x = fromX; x < toX; ++x) count += isBackground(x, y) ? 0 : 1;
    }
    return count;
  }

  fs::path folder_;
  std::string skip_;
  vtkNew<vtkPNGReader> reader_;
  vtkImageData* image_ = nullptr;
};

TEST_F(PicturePixels, SpheresOfOneAndTwoFillDiscsOfOneToFour) {
  const std::vector<PictureItem> items{{.mesh = test::sphere(1, 5)}, {.mesh = test::sphere(2, 5)}};
  if (!draw(items, {.width = 1000, .height = 500})) GTEST_SKIP() << skip_;
  EXPECT_EQ(image_->GetDimensions()[0], 1000);
  EXPECT_EQ(image_->GetDimensions()[1], 500);
  const int captions = 45;
  const double small = drawn(0, 500, captions, 500);
  const double large = drawn(500, 1000, captions, 500);
  EXPECT_GT(small, 20'000);
  EXPECT_NEAR(large / small, 4, 0.08);  // a pixel along the rim of a disc of 100 pixels radius
  EXPECT_EQ(drawn(0, 1000, 0, captions), 0);  // no captions were asked for
  for (const int x : {2, 498, 502, 997}) EXPECT_TRUE(isBackground(x, 497));
}

TEST_F(PicturePixels, BoxFromTheFrontHasItsProportionsAndDarkEdges) {
  const std::vector<PictureItem> items{
      {.mesh = test::box(Vec3(5, 0, 0), Vec3(6, 3, 1)), .caption = "a box"}};
  if (!draw(items, {.width = 600, .height = 400, .view = Vec3(1, 0, 0)})) GTEST_SKIP() << skip_;
  const int captions = 36;
  int left = 600;
  int right = -1;
  int low = 400;
  int high = -1;
  for (int y = captions; y < 400; ++y) {
    for (int x = 0; x < 600; ++x) {
      if (isBackground(x, y)) continue;
      left = std::min(left, x);
      right = std::max(right, x);
      low = std::min(low, y);
      high = std::max(high, y);
    }
  }
  ASSERT_GT(right, left);
  EXPECT_NEAR(static_cast<double>(right - left) / (high - low), 3, 0.06);  // a pixel on each side
  EXPECT_NEAR(left + right, 599, 4);
  EXPECT_NEAR(low + high, 400 + captions - 1, 4);
  EXPECT_LT(level(left + 1, (low + high) / 2), 120);            // a line
  EXPECT_GT(level((left + right) / 2, (low + high) / 2), 120);  // a lit face
  EXPECT_GT(drawn(0, 600, 0, captions), 50);                    // the caption
}

TEST_F(PicturePixels, SamePictureTwiceAndOddItemsToo) {
  TriMesh degenerate = test::box(Vec3(0, 0, 0), Vec3(1, 1, 1));
  degenerate.points[1] = degenerate.points[0];
  const std::vector<PictureItem> items{
      {.mesh = {}, .caption = "nothing"},
      {.mesh = degenerate, .caption = std::string(500, 'w') + "\xff\n$x$"}};
  if (!draw(items, {.width = 200, .height = 100})) GTEST_SKIP() << skip_;
  EXPECT_EQ(drawn(0, 100, 12, 100), 0);
  EXPECT_GT(drawn(100, 200, 12, 100), 500);
  const int before = drawn(0, 200, 0, 100);
  ASSERT_TRUE(draw(items, {.width = 200, .height = 100}));
  EXPECT_EQ(drawn(0, 200, 0, 100), before);
}

TEST_F(PicturePixels, CannotWriteIsSaid) {
  const std::vector<PictureItem> items{{.mesh = test::box(Vec3(0, 0, 0), Vec3(1, 1, 1))}};
  if (!draw(items, {.width = 100, .height = 100})) GTEST_SKIP() << skip_;
  const auto done =
      writePicture(items, folder_ / "no" / "folder.png", {.width = 100, .height = 100});
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::CannotWrite);
}

#else

TEST(Picture, SaysThatItIsNotBuiltIn) {
  const auto done = writePicture(
      std::vector<PictureItem>{{.mesh = test::box(Vec3(0, 0, 0), Vec3(1, 1, 1))}}, "p.png");
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::NotSupported);
}

#endif

}  // namespace
}  // namespace phront
