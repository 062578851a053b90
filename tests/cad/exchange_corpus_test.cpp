// Reading and writing of the collected parts, good and bad, where they are at hand.
#include <gtest/gtest.h>
#include <unistd.h>

#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <GProp_GProps.hxx>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "phront/cad/exchange.h"
#include "phront/cad/shape_occt.h"

namespace phront::cad {
namespace {

namespace fs = std::filesystem;

fs::path corpusFolder() { return fs::path(PHRONT_SOURCE_DIR) / ".." / "shared" / "corpus"; }

std::vector<fs::path> partsIn(const fs::path& folder) {
  std::vector<fs::path> parts;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (shapeFormatOf(entry.path())) parts.push_back(entry.path());
  }
  std::sort(parts.begin(), parts.end());
  return parts;
}

// The default is for a machine that is not busy with other tests.
const ReadOptions kPatient{.timeLimit = 300};
const ReadOptions kPatientAsIs{.timeLimit = 300, .repair = false};

struct Summary {
  int solids = 0;
  int sheets = 0;
  int faces = 0;
  int valid = 0;
  double volume = 0;
};

Summary summaryOf(const Model& model) {
  Summary summary;
  for (const Body& body : model.bodies) {
    const TopoDS_Shape& shape = occtShape(body.shape);
    summary.faces += faceCount(body.shape);
    summary.valid += BRepCheck_Analyzer(shape).IsValid() ? 1 : 0;
    if (body.kind == BodyKind::Sheet) {
      ++summary.sheets;
      continue;
    }
    ++summary.solids;
    GProp_GProps properties;
    // Adaptive: the default integration is wrong by up to 1e-3 on trimmed B-splines.
    BRepGProp::VolumeProperties(shape, properties, 1e-6);
    summary.volume += properties.Mass();
  }
  return summary;
}

struct Promise {
  int faces = 0;
  int solids = 0;
};

// Columns name (first), faces, solids of the manifest; faces and solids come before any quoted
// text.
std::map<std::string, Promise> manifest() {
  std::map<std::string, Promise> promises;
  std::ifstream stream(corpusFolder() / "MANIFEST.csv");
  for (std::string line; std::getline(stream, line);) {
    std::vector<std::string> columns;
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, ',');) columns.push_back(field);
    if (columns.size() < 8 || columns[0] == "name") continue;
    promises[columns[0]] = {std::atoi(columns[6].c_str()), std::atoi(columns[7].c_str())};
  }
  return promises;
}

TEST(Corpus, EveryPartIsReadAsPromised) {
  if (!fs::exists(corpusFolder())) GTEST_SKIP() << "the collected parts are not here";
  const auto promises = manifest();
  ASSERT_GT(promises.size(), 30U);
  for (const fs::path& path : partsIn(corpusFolder())) {
    const std::string name = path.filename().string();
    const auto model = readModel(path, kPatient);
    ASSERT_TRUE(model) << model.error().message;
    const Summary summary = summaryOf(*model);
    EXPECT_EQ(summary.valid, static_cast<int>(model->bodies.size())) << name;
    const auto promise = promises.find(name);
    if (promise == promises.end()) continue;
    EXPECT_EQ(summary.faces, promise->second.faces) << name;
    // Faces without a solid may close when sewn: then there are more solids than in the file.
    EXPECT_GE(summary.solids, promise->second.solids) << name;
    EXPECT_TRUE(promise->second.solids == 0 || summary.solids == promise->second.solids) << name;
  }
}

TEST(Corpus, EveryPartSurvivesStepAndBrep) {
  if (!fs::exists(corpusFolder())) GTEST_SKIP() << "the collected parts are not here";
  const std::string mine = "phront_corpus_" + std::to_string(::getpid());
  for (const fs::path& path : partsIn(corpusFolder())) {
    const auto model = readModel(path, kPatient);
    ASSERT_TRUE(model) << model.error().message;
    const Summary before = summaryOf(*model);
    for (const char* extension : {".step", ".brep"}) {
      const fs::path copy = fs::temp_directory_path() / (mine + extension);
      const std::string name = path.filename().string() + " as " + extension;
      const auto written = writeModel(*model, copy);
      ASSERT_TRUE(written) << written.error().message;
      const auto again = readModel(copy, kPatientAsIs);
      fs::remove(copy);
      ASSERT_TRUE(again) << name << ": " << again.error().message;
      const Summary after = summaryOf(*again);
      EXPECT_EQ(after.solids, before.solids) << name;
      EXPECT_EQ(after.sheets, before.sheets) << name;
      EXPECT_EQ(after.faces, before.faces) << name;
      EXPECT_EQ(after.valid, before.valid) << name;
      // The integration's own scatter; the writers keep 15 digits.
      EXPECT_NEAR(after.volume, before.volume, 3e-5 * std::abs(before.volume)) << name;
    }
  }
}

TEST(BadCorpus, EveryFileEndsWithASentenceOrAModel) {
  const fs::path folder = corpusFolder() / "bad";
  if (!fs::exists(folder)) GTEST_SKIP() << "the collected bad files are not here";
  int files = 0;
  for (const fs::path& path : partsIn(folder)) {
    ++files;
    const std::string name = path.filename().string();
    const auto start = std::chrono::steady_clock::now();
    const auto model = readModel(path);
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    EXPECT_LT(seconds, 30) << name;
    if (model) {
      EXPECT_FALSE(model->bodies.empty()) << name;
      const Summary summary = summaryOf(*model);
      EXPECT_TRUE(summary.solids == 0 || summary.volume > 0) << name;
    } else {
      EXPECT_TRUE(model.error().code == ErrorCode::UnreadableInput ||
                  model.error().code == ErrorCode::ResourceLimit)
          << name;
      EXPECT_NE(model.error().message.find(name), std::string::npos) << model.error().message;
    }
  }
  EXPECT_GT(files, 30);
}

}  // namespace
}  // namespace phront::cad
