// Every solid of the corpus must give a closed mesh. Skipped where the corpus is absent.
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>

#include "phront/cad/exchange.h"
#include "phront/cad/tessellate.h"

namespace phront::cad {
namespace {

TEST(TessellateCorpus, SolidsGiveClosedMeshes) {
  const std::filesystem::path folder =
      std::filesystem::path(PHRONT_SOURCE_DIR) / ".." / "shared" / "corpus";
  if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << "no corpus beside the sources";
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (shapeFormatOf(entry.path())) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  int solids = 0;
  int closed = 0;
  for (const auto& file : files) {
    const auto model = readModel(file);
    if (!model) continue;  // reading has its own test
    for (const Body& body : model->bodies) {
      if (body.kind != BodyKind::Solid) continue;
      SCOPED_TRACE(file.filename().string());
      const double diagonal = boundingBox(body.shape).diagonal().norm();
      const auto t = tessellate(body, {.deflection = 1e-4 * diagonal});
      ++solids;
      ASSERT_TRUE(t) << t.error().message;
      const bool isClosed = diagnose(t->mesh).closedManifold();
      EXPECT_TRUE(isClosed);
      EXPECT_GT(signedVolume(t->mesh), 0);
      closed += isClosed;
    }
  }
  std::printf("%d of %d solids closed\n", closed, solids);
  EXPECT_GT(solids, 40);
}

}  // namespace
}  // namespace phront::cad
