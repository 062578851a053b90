// Hostile and damaged files: each must end soon, as one sentence or as a model that is right.
#include <gtest/gtest.h>

#include <unistd.h>
#include <BRepGProp.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <GProp_GProps.hxx>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

#include "phront/cad/exchange.h"
#include "phront/cad/shape_occt.h"

namespace phront::cad {
namespace {

namespace fs = std::filesystem;

double volumeOf(const Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(occtShape(shape), properties);
  return properties.Mass();
}

class BadInput : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() / ("phront_bad_input_" + std::to_string(::getpid()) + "_" +
                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path put(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  // A shape as the text of a file of the given name's format.
  std::string textOf(const TopoDS_Shape& shape, const std::string& name) const {
    Model model;
    Body body;
    body.shape = makeShape(shape);
    model.bodies.push_back(body);
    EXPECT_TRUE(writeModel(model, folder_ / name));
    std::ifstream stream(folder_ / name, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
  }
  std::string box() const { return textOf(BRepPrimAPI_MakeBox(10, 20, 30).Solid(), "box.step"); }

  // Refused with a sentence that holds `part`.
  static void expectRefused(const fs::path& path, const std::string& part) {
    const auto model = readModel(path);
    ASSERT_FALSE(model) << "read although: " << part;
    EXPECT_EQ(model.error().code, ErrorCode::UnreadableInput);
    EXPECT_NE(model.error().message.find(part), std::string::npos) << model.error().message;
    EXPECT_EQ(model.error().message.find("reading " + path.filename().string()), 0U)
        << model.error().message;
    EXPECT_EQ(model.error().message.find('\n'), std::string::npos);
  }
  // Read as one solid box of 6000 mm^3, with a warning that holds `warning` (empty: none at all).
  static void expectBox(const fs::path& path, const std::string& warning, double scale = 1) {
    const auto model = readModel(path);
    ASSERT_TRUE(model) << model.error().message;
    ASSERT_EQ(model->bodies.size(), 1U);
    EXPECT_EQ(model->bodies[0].kind, BodyKind::Solid);
    const double volume = 6000 * scale * scale * scale;
    EXPECT_NEAR(volumeOf(model->bodies[0].shape), volume, 1e-9 * volume);
    expectWarning(*model, warning);
  }
  static void expectSheet(const fs::path& path, const std::string& warning) {
    const auto model = readModel(path);
    ASSERT_TRUE(model) << model.error().message;
    ASSERT_EQ(model->bodies.size(), 1U);
    EXPECT_EQ(model->bodies[0].kind, BodyKind::Sheet);
    expectWarning(*model, warning);
  }
  static void expectWarning(const Model& model, const std::string& warning) {
    std::string all;
    for (const std::string& sentence : model.warnings) all += sentence + "\n";
    if (warning.empty()) {
      EXPECT_EQ(all, "");
    } else {
      EXPECT_NE(all.find(warning), std::string::npos) << all;
    }
  }

 private:
  fs::path folder_;
};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  if (at != std::string::npos) text.replace(at, from.size(), to);
  return text;
}

// The statement (without '#n = ' and ';') that begins with `keyword`, its number, and its place.
struct Statement {
  std::string number;  // "#12"
  std::string text;
  std::size_t begin = 0;
};

Statement statementOf(const std::string& file, const std::string& keyword) {
  const std::size_t at = file.find(" " + keyword + "(");
  EXPECT_NE(at, std::string::npos) << keyword;
  const std::size_t hash = file.rfind('#', at);
  Statement statement;
  statement.number = file.substr(hash, file.find_first_of(" =", hash) - hash);
  statement.begin = at + 1;
  statement.text = file.substr(at + 1, file.find(';', at) - at - 1);
  return statement;
}

std::string withStatement(std::string file, const Statement& old, const std::string& text) {
  return file.replace(old.begin, old.text.size(), text);
}

// The references of a statement, "#12".
std::vector<std::string> references(const std::string& text) {
  std::vector<std::string> found;
  for (std::size_t i = text.find('#'); i != std::string::npos; i = text.find('#', i + 1)) {
    found.push_back(text.substr(i, text.find_first_not_of("0123456789", i + 1) - i));
  }
  return found;
}

std::string shellOver(const std::vector<std::string>& faces) {
  std::string text;
  for (const std::string& face : faces) text += (text.empty() ? "" : ",") + face;
  return "CLOSED_SHELL('',(" + text + "))";
}

TEST_F(BadInput, NotThere) {
  expectRefused("no_such_file.step", "there is no such file");
  expectRefused(fs::temp_directory_path(), "folder");
}

TEST_F(BadInput, NoCadFile) {
  for (const char* name : {"a.step", "a.iges", "a.brep"}) {
    expectRefused(put(name, ""), "empty");
    expectRefused(put(name, "hello, this is no CAD file\n"), "it is not a");
    std::string noise;
    for (unsigned i = 0, x = 1; i < 20'000; ++i) {
      x = x * 1664525U + 1013904223U;
      noise += static_cast<char>(x >> 24);
    }
    expectRefused(put(name, noise), "it is not a");
  }
  expectRefused(put("a.step", "PK\x03\x04 and so on"), "unpack");
  expectRefused(put("a.dat", "hello"), "neither STEP");
}

TEST_F(BadInput, CutShort) {
  const std::string step = box();
  expectRefused(put("a.step", step.substr(0, step.size() / 2)), "cut short");
  expectRefused(put("b.step", step.substr(0, step.find("DATA;"))), "cut short");
  expectBox(put("c.step", step.substr(0, step.find("END-ISO"))), "last line");
  expectRefused(
      put("d.step", step.substr(0, step.find("DATA;")) + "DATA;\nENDSEC;\nEND-ISO-10303-21;\n"),
      "no geometry");
  const TopoDS_Shape torus = BRepPrimAPI_MakeTorus(5, 1).Solid();
  const std::string iges = textOf(torus, "t.iges");
  expectRefused(put("a.iges", iges.substr(0, iges.size() / 2 / 81 * 81)), "terminate line");
  expectRefused(put("b.iges", " " + iges), "column 73");
  const std::string brep = textOf(torus, "t.brep");
  expectRefused(put("a.brep", brep.substr(0, brep.size() / 3)), "");
  expectRefused(put("b.brep", brep.substr(0, brep.size() * 9 / 10)), "");
}

TEST_F(BadInput, ByteOrderMarkAndLineEnds) {
  std::string crlf = "\xEF\xBB\xBF";
  for (const char c : box()) crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
  expectBox(put("a.step", crlf), "");
}

TEST_F(BadInput, FalseName) { expectBox(put("a.igs", box()), "named as IGES but holds STEP"); }

TEST_F(BadInput, NumbersThatAreNone) {
  const std::string step = box();
  const Statement point = statementOf(step, "CARTESIAN_POINT");
  const auto with = [&](const char* list) {
    return put("a.step",
               withStatement(step, point, std::string("CARTESIAN_POINT('',(") + list + "))"));
  };
  expectRefused(with("NaN,0.,0."), "NaN");
  expectRefused(with("-nan,0.,0."), "nan");
  expectRefused(with("0.,INF,0."), "INF");
  expectRefused(with("0.,1.E999,0."), "1.E999");
  expectRefused(with("1.E300,0.,0."), "beyond any part");
  const std::string brep = textOf(BRepPrimAPI_MakeBox(1, 2, 3).Solid(), "t.brep");
  expectRefused(put("a.brep", replaced(brep, "\n1 0 0", "\n1 nan 0")), "nan");
}

TEST_F(BadInput, HugeCoordinate) {
  expectRefused(put("a.step", textOf(BRepPrimAPI_MakeBox(1, 1, 1e8).Solid(), "t.step")), "reaches");
}

TEST_F(BadInput, TwoCoordinates) {
  const std::string step = box();
  const Statement vertex = statementOf(step, "VERTEX_POINT");
  const std::string point = references(vertex.text).front();
  const std::size_t at = step.find(point + " = CARTESIAN_POINT");
  ASSERT_NE(at, std::string::npos);
  Statement old;
  old.begin = step.find("CARTESIAN_POINT", at);
  old.text = step.substr(old.begin, step.find(';', at) - old.begin);
  expectRefused(put("a.step", withStatement(step, old, "CARTESIAN_POINT('',(1.,2.))")),
                "2 coordinates");
}

TEST_F(BadInput, Circles) {
  const std::string step = box();
  for (const char* keyword : {"CLOSED_SHELL", "ORIENTED_EDGE", "AXIS2_PLACEMENT_3D"}) {
    const Statement statement = statementOf(step, keyword);
    const std::string target = references(statement.text).front();
    expectRefused(put("a.step", withStatement(step, statement,
                                              replaced(statement.text, target, statement.number))),
                  "refers to itself");
  }
  // A longer circle: the loop of the first face names that face. OpenCASCADE may crash on it.
  const Statement face = statementOf(step, "ADVANCED_FACE");
  const std::string loop = references(face.text).front();
  const auto model = readModel(put("b.step", withStatement(step, statementOf(step, "EDGE_LOOP"),
                                                           "EDGE_LOOP('',(" + loop + "))")));
  if (model) {
    EXPECT_FALSE(model->warnings.empty());
  } else {
    EXPECT_NE(model.error().message.find("circle"), std::string::npos) << model.error().message;
  }
}

TEST_F(BadInput, NoVertexPoint) {
  const std::string step = box();
  expectRefused(
      put("a.step", withStatement(step, statementOf(step, "VERTEX_POINT"), "VERTEX_POINT('',$)")),
      "no point");
}

TEST_F(BadInput, ImpossibleSplines) {
  const std::string step = box();
  const Statement face = statementOf(step, "ADVANCED_FACE");
  const std::string surface = references(face.text).back();
  const std::string points = "#9001,#9002),(#9003,#9004";
  std::string corners;
  for (int i = 1; i <= 4; ++i) {
    corners += "#900" + std::to_string(i) + " = CARTESIAN_POINT('',(" + std::to_string(i % 2) +
               ".," + std::to_string(i / 3) + ".,0.));\n";
  }
  const auto with = [&](const std::string& degree, const std::string& multiplicity) {
    const std::string spline = "#9000 = B_SPLINE_SURFACE_WITH_KNOTS(''," + degree + ",1,((" +
                               points + ")),.UNSPECIFIED.,.F.,.F.,.F.,(" + multiplicity +
                               ",2),(2,2),(0.,1.),(0.,1.),.UNSPECIFIED.);\n";
    const std::string edited = withStatement(step, face, replaced(face.text, surface, "#9000"));
    return put("a.step", replaced(edited, "DATA;\n", "DATA;\n" + corners + spline));
  };
  expectRefused(with("1", "-5"), "multiplicity below one");
  expectRefused(with("0", "2"), "degree");
}

TEST_F(BadInput, UnfoldingBomb) {
  // Thirty levels, each holding the one below twice: a thousand million parts in four kilobytes.
  std::string file = box();
  const Statement root = statementOf(file, "ADVANCED_BREP_SHAPE_REPRESENTATION");
  const std::string context = references(root.text).back();
  const std::string axis = references(root.text).front();
  std::string below = root.number;
  std::string bomb;
  for (int level = 0; level < 30; ++level) {
    const std::string id = std::to_string(10'000 + 10 * level);
    bomb += "#" + id + "1 = REPRESENTATION_MAP(" + axis + "," + below + ");\n";
    bomb += "#" + id + "2 = MAPPED_ITEM('',#" + id + "1," + axis + ");\n";
    bomb += "#" + id + "3 = MAPPED_ITEM('',#" + id + "1," + axis + ");\n";
    bomb +=
        "#" + id + "4 = SHAPE_REPRESENTATION('',(#" + id + "2,#" + id + "3)," + context + ");\n";
    below = "#" + id + "4";
  }
  expectRefused(put("a.step", replaced(file, "DATA;\n", "DATA;\n" + bomb)), "unfold");
}

TEST_F(BadInput, Units) {
  const std::string step = box();
  expectBox(put("a.step", replaced(step, "SI_UNIT(.MILLI.,.METRE.)", "SI_UNIT($,.METRE.)")),
            "1e+04 x 2e+04 x 3e+04 mm", 1000);
  const std::size_t at = step.find("GLOBAL_UNIT_ASSIGNED_CONTEXT");
  const std::size_t open = step.find("((", at);
  const std::size_t close = step.find("))", open);
  std::string none = step;
  none.replace(open, close + 2 - open, "(())");
  expectBox(put("b.step", none), "no length unit");
}

TEST_F(BadInput, Shells) {
  const std::string step = box();
  const Statement shell = statementOf(step, "CLOSED_SHELL");
  const std::vector<std::string> faces = references(shell.text);
  ASSERT_EQ(faces.size(), 6U);
  auto fewer = faces;
  fewer.pop_back();
  expectSheet(put("missing.step", withStatement(step, shell, shellOver(fewer))), "4 free edges");
  auto twice = faces;
  twice.push_back(faces[2]);
  expectBox(put("twice.step", withStatement(step, shell, shellOver(twice))), "twice");
  auto dangling = faces;
  dangling[3] = "#99999";
  expectSheet(put("dangling.step", withStatement(step, shell, shellOver(dangling))), "#99999");
  expectBox(put("open.step", withStatement(step, shell, replaced(shell.text, "CLOSED", "OPEN"))),
            "claims to be open");
  const Statement face = statementOf(step, "ADVANCED_FACE");
  const bool forward = face.text.find(".T.") != std::string::npos;
  const auto flipped = readModel(
      put("flipped.step",
          withStatement(step, face,
                        replaced(face.text, forward ? ".T." : ".F.", forward ? ".F." : ".T."))));
  ASSERT_TRUE(flipped) << flipped.error().message;
  ASSERT_EQ(flipped->bodies[0].kind, BodyKind::Solid);
  EXPECT_NEAR(volumeOf(flipped->bodies[0].shape), 6000, 1e-6);
}

TEST_F(BadInput, PointFarOff) {
  const std::string step = box();
  const std::string point = references(statementOf(step, "VERTEX_POINT").text).front();
  const std::size_t at = step.find(point + " = CARTESIAN_POINT");
  Statement old;
  old.begin = step.find("CARTESIAN_POINT", at);
  old.text = step.substr(old.begin, step.find(';', at) - old.begin);
  const auto model =
      readModel(put("a.step", withStatement(step, old, "CARTESIAN_POINT('',(3.,4.,500.))")));
  // Either refused, or mended and said so.
  if (model) {
    EXPECT_FALSE(model->warnings.empty());
  } else {
    EXPECT_NE(model.error().message.find("miss each other"), std::string::npos)
        << model.error().message;
  }
}

}  // namespace
}  // namespace phront::cad
