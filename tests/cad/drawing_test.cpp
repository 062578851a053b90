#include "phront/cad/drawing.h"

#include <gtest/gtest.h>

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <gp.hxx>
#include <gp_Ax2.hxx>
#include <gp_Circ.hxx>
#include <numbers>

namespace phront::cad {
namespace {

namespace fs = std::filesystem;
constexpr double kPi = std::numbers::pi;

class DrawingTest : public ::testing::Test {
 protected:
  DrawingTest() {
    folder_ = fs::temp_directory_path() /
              ("phront_drawing_" +
               std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::create_directories(folder_);
  }
  ~DrawingTest() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  [[nodiscard]] Result<Drawing> svg(const std::string& body,
                                    const std::string& attributes = "") const {
    return readDrawing(write("a.svg", "<svg xmlns=\"http://www.w3.org/2000/svg\" " + attributes +
                                          ">" + body + "</svg>"),
                       {.tolerance = 1e-4});
  }
  [[nodiscard]] Result<Drawing> dxf(const std::string& entities, const std::string& before = "",
                                    const std::string& header = "9\n$INSUNITS\n70\n4\n") const {
    return readDrawing(
        write("a.dxf", "0\nSECTION\n2\nHEADER\n" + header + "0\nENDSEC\n" + before +
                           "0\nSECTION\n2\nENTITIES\n" + entities + "0\nENDSEC\n0\nEOF\n"),
        {.tolerance = 1e-4});
  }
  fs::path folder_;
};

double areaOf(const Result<Drawing>& drawing) {
  EXPECT_TRUE(drawing) << drawing.error().message;
  return drawing ? signedArea(drawing->curves) : 0;
}

const char* const kMillimetres = "width=\"100mm\" height=\"50mm\" viewBox=\"0 0 100 50\"";

TEST_F(DrawingTest, ShapesOfSvg) {
  EXPECT_NEAR(areaOf(svg("<rect x='1' y='2' width='4' height='3'/>", kMillimetres)), 12, 1e-9);
  EXPECT_NEAR(areaOf(svg("<rect width='4' height='3' rx='1'/>", kMillimetres)), 12 - 4 + kPi, 1e-3);
  EXPECT_NEAR(areaOf(svg("<circle cx='5' cy='5' r='2'/>", kMillimetres)), 4 * kPi, 2e-3);
  EXPECT_NEAR(areaOf(svg("<ellipse cx='5' cy='5' rx='3' ry='1'/>", kMillimetres)), 3 * kPi, 2e-3);
  EXPECT_NEAR(areaOf(svg("<polygon points='0,0 4,0 0,3'/>", kMillimetres)), 6, 1e-9);
  const auto open =
      svg("<polyline points='0,0 4,0 4,3'/><line x1='9' x2='9' y2='5'/>", kMillimetres);
  ASSERT_TRUE(open);
  EXPECT_EQ(open->open, 2U);
  EXPECT_NEAR(length(open->curves), 12, 1e-9);
}

TEST_F(DrawingTest, PathsOfSvg) {
  // A square by every straight command; a disc by two arcs; one by four quarter arcs in cubics.
  EXPECT_NEAR(areaOf(svg("<path d='M0 0L2 0h2v4H0Z'/>", kMillimetres)), 16, 1e-9);
  EXPECT_NEAR(areaOf(svg("<path d='m1,1 2,0 0,2 -2,0z'/>", kMillimetres)), 4, 1e-9);
  EXPECT_NEAR(areaOf(svg("<path d='M-2 0A2 2 0 0 1 2 0A2 2 0 0 1-2 0Z'/>", kMillimetres)), 4 * kPi,
              2e-3);
  EXPECT_NEAR(areaOf(svg("<path d='M-2 0a2 2 0 112 2 2 2 0 01-2-2'/>", kMillimetres)), 4 * kPi,
              2e-3);
  const std::string k = "1.1045695";  // 2 * 0.5522847
  EXPECT_NEAR(areaOf(svg("<path d='M2 0C2 " + k + " " + k + " 2 0 2S-2 " + k + " -2 0S-" + k +
                             " -2 0 -2S2 -" + k + " 2 0Z'/>",
                         kMillimetres)),
              4 * kPi, 1e-2);
  // A parabola and its chord: 2/3 of the box.
  EXPECT_NEAR(areaOf(svg("<path d='M0 0Q2 4 4 0Z'/>", kMillimetres)), 2.0 / 3 * 4 * 2, 1e-3);
  EXPECT_NEAR(areaOf(svg("<path d='M0 0Q1 2 2 0T4 0L4 -9L0 -9Z'/>", kMillimetres)), 36, 1e-3);
}

TEST_F(DrawingTest, UnitsAndTransformsOfSvg) {
  const std::string square = "<rect width='1' height='1'/>";
  EXPECT_NEAR(areaOf(svg(square)), std::pow(25.4 / 96, 2), 1e-9);
  EXPECT_NEAR(areaOf(svg(square, "width=\"2in\" viewBox=\"0 0 2 2\"")), 25.4 * 25.4, 1e-6);
  EXPECT_NEAR(areaOf(svg("<g transform='scale(2)'><g transform='rotate(30) translate(5,5)'>" +
                             square + "</g></g>",
                         kMillimetres)),
              4, 1e-9);
  EXPECT_NEAR(
      areaOf(svg("<g transform='matrix(3,0,0,1,7,7) skewX(20)'>" + square + "</g>", kMillimetres)),
      3, 1e-9);
  // y points up.
  const auto low = svg("<rect y='10' width='1' height='1'/>", kMillimetres);
  ASSERT_TRUE(low);
  for (const Vec2& p : low->curves.points) EXPECT_LE(p.y(), -10 + 1e-12);
}

TEST_F(DrawingTest, HoleOfSvgAndWhatIsNotDrawn) {
  const auto ring =
      svg("<circle r='3'/><circle r='2'/><circle r='1'/>"
          "<g style='display:none'><rect width='9' height='9'/></g>"
          "<defs><rect width='9' height='9'/></defs><text>words</text>",
          kMillimetres);
  EXPECT_NEAR(areaOf(ring), (9 - 4 + 1) * kPi, 5e-3);
  ASSERT_TRUE(ring);
  EXPECT_EQ(ring->loops, 3U);
  ASSERT_EQ(ring->warnings.size(), 1U);
  EXPECT_NE(ring->warnings[0].find("text"), std::string::npos);
}

// The same corners in another order are another curve.
TEST_F(DrawingTest, OnlyTheSameCurveCountsOnce) {
  const auto two =
      svg("<polyline points='0,0 4,0 4,3 0,3'/><polyline points='0,0 4,3 4,0 0,3'/>"
          "<polyline points='0,3 4,3 4,0 0,0'/>",
          kMillimetres);
  ASSERT_TRUE(two);
  EXPECT_EQ(two->warnings.size(), 1U);
  EXPECT_NEAR(length(two->curves), 11 + 5 + 3 + 5, 1e-9);
}

const char* const kLine = "0\nLINE\n8\n0\n";

std::string line(double x1, double y1, double x2, double y2) {
  return kLine + std::string("10\n") + std::to_string(x1) + "\n20\n" + std::to_string(y1) +
         "\n11\n" + std::to_string(x2) + "\n21\n" + std::to_string(y2) + "\n";
}

// Four lines in any order and direction are one loop; one drawn twice counts once.
TEST_F(DrawingTest, LinesOfDxfAreJoined) {
  const auto square = dxf(line(0, 0, 3, 0) + line(0, 2, 0, 0) + line(3, 0, 3, 2) +
                          line(0, 2, 3, 2) + line(3, 2, 3, 0));
  EXPECT_NEAR(areaOf(square), 6, 1e-9);
  ASSERT_TRUE(square);
  EXPECT_EQ(square->loops, 1U);
  EXPECT_EQ(square->open, 0U);
  EXPECT_EQ(square->warnings.size(), 1U);
}

TEST_F(DrawingTest, CurvesOfDxf) {
  EXPECT_NEAR(areaOf(dxf("0\nCIRCLE\n8\n0\n10\n1\n20\n1\n40\n2\n")), 4 * kPi, 2e-3);
  EXPECT_NEAR(
      areaOf(dxf("0\nARC\n8\n0\n10\n0\n20\n0\n40\n2\n50\n0\n51\n180\n" + line(-2, 0, 2, 0))),
      2 * kPi, 2e-3);
  EXPECT_NEAR(areaOf(dxf("0\nELLIPSE\n8\n0\n10\n0\n20\n0\n11\n3\n21\n0\n40\n0.5\n41\n0\n42\n"
                         "6.283185307179586\n")),
              3 * 1.5 * kPi, 2e-3);
  // Two bulges of 1 are two half circles.
  EXPECT_NEAR(areaOf(dxf("0\nLWPOLYLINE\n8\n0\n90\n2\n70\n1\n10\n-2\n20\n0\n42\n1\n10\n2\n20\n0\n"
                         "42\n1\n")),
              4 * kPi, 2e-3);
  // A clamped cubic with four poles is a Bezier: that of the parabola above, and its chord.
  EXPECT_NEAR(
      areaOf(
          dxf("0\nSPLINE\n8\n0\n70\n8\n71\n3\n72\n8\n73\n4\n40\n0\n40\n0\n40\n0\n40\n0\n40\n1\n40"
              "\n1\n40\n1\n40\n1\n10\n0\n20\n0\n10\n1.3333333333\n20\n2.6666666667\n10\n"
              "2.6666666667\n20\n2.6666666667\n10\n4\n20\n0\n" +
              line(0, 0, 4, 0))),
      16.0 / 3, 1e-3);
}

TEST_F(DrawingTest, UnitsAndBlocksOfDxf) {
  const std::string circle = "0\nCIRCLE\n8\n0\n10\n0\n20\n0\n40\n1\n";
  const auto inches = dxf(circle, "", "9\n$INSUNITS\n70\n1\n");
  EXPECT_NEAR(areaOf(inches), kPi * 25.4 * 25.4, 1e-2);
  const auto none = dxf(circle, "", "");
  ASSERT_TRUE(none);
  EXPECT_EQ(none->warnings.size(), 1U);
  const std::string block =
      "0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n8\n0\n2\nB\n70\n0\n10\n0\n20\n0\n30\n0\n"
      "3\nB\n" +
      circle + "0\nENDBLK\n8\n0\n0\nENDSEC\n";
  const auto placed =
      dxf("0\nINSERT\n8\n0\n2\nB\n10\n5\n20\n0\n41\n2\n42\n2\n"
          "0\nINSERT\n8\n0\n2\nB\n10\n-5\n20\n0\n",
          block);
  EXPECT_NEAR(areaOf(placed), 5 * kPi, 5e-3);
  ASSERT_TRUE(placed);
  EXPECT_EQ(placed->loops, 2U);
}

/// A square of side 4 with a round hole of radius 1, as loose edges around `place`'s origin.
TopoDS_Compound squareWithHole(const gp_Ax2& place) {
  const auto at = [&](double x, double y) {
    return place.Location().Translated(gp_Vec(place.XDirection()) * x +
                                       gp_Vec(place.YDirection()) * y);
  };
  BRep_Builder builder;
  TopoDS_Compound compound;
  builder.MakeCompound(compound);
  const std::array<gp_Pnt, 4> corners{at(-2, -2), at(2, -2), at(2, 2), at(-2, 2)};
  for (std::size_t k = 0; k < 4; ++k) {
    builder.Add(compound, BRepBuilderAPI_MakeEdge(corners[k], corners[(k + 1) % 4]).Edge());
  }
  builder.Add(compound, BRepBuilderAPI_MakeEdge(gp_Circ(place, 1)).Edge());
  return compound;
}

TEST_F(DrawingTest, PlanarWiresOfCadFiles) {
  const std::string file = (folder_ / "wires.brep").string();
  // On the plane z = 7; on the front plane; on a slanted one.
  for (const gp_Ax2& place : {gp_Ax2(gp_Pnt(10, 20, 7), gp::DZ(), gp::DX()),
                              gp_Ax2(gp_Pnt(10, 5, 20), gp_Dir(0, -1, 0), gp::DX()),
                              gp_Ax2(gp_Pnt(1, 2, 3), gp_Dir(1, 2, 2))}) {
    ASSERT_TRUE(BRepTools::Write(squareWithHole(place), file.c_str()));
    const auto drawing = readDrawing(file, {.tolerance = 1e-4});
    ASSERT_TRUE(drawing) << drawing.error().message;
    EXPECT_EQ(drawing->loops, 2U);
    EXPECT_EQ(drawing->open, 0U);
    EXPECT_NEAR(signedArea(drawing->curves), 16 - kPi, 2e-3);
    Eigen::AlignedBox2d box;
    for (const Vec2& p : drawing->curves.points) box.extend(p);
    if (place.Direction().IsParallel(gp_Dir(1, 2, 2), 1e-9)) continue;
    EXPECT_NEAR((box.center() - Vec2(10, 20)).norm(), 0, 1e-6);
  }
}

TEST_F(DrawingTest, WiresThatMakeNoDrawing) {
  const std::string file = (folder_ / "wires.brep").string();
  BRep_Builder builder;
  TopoDS_Compound twisted = squareWithHole(gp_Ax2());
  builder.Add(twisted, BRepBuilderAPI_MakeEdge(gp_Pnt(0, 0, 0), gp_Pnt(1, 1, 3)).Edge());
  ASSERT_TRUE(BRepTools::Write(twisted, file.c_str()));
  const auto off = readDrawing(file);
  ASSERT_FALSE(off);
  EXPECT_EQ(off.error().code, ErrorCode::UnreadableInput);
  EXPECT_NE(off.error().message.find("one plane"), std::string::npos) << off.error().message;

  ASSERT_TRUE(BRepTools::Write(BRepPrimAPI_MakeBox(1, 2, 3).Shape(), file.c_str()));
  const auto solid = readDrawing(file);
  ASSERT_FALSE(solid);
  EXPECT_NE(solid.error().message.find("faces"), std::string::npos) << solid.error().message;
}

TEST_F(DrawingTest, WrittenAndReadBack) {
  const auto ring = svg("<circle r='3'/><rect x='-1' y='-1' width='2' height='2'/>", kMillimetres);
  ASSERT_TRUE(ring);
  for (const char* name : {"b.svg", "b.dxf"}) {
    ASSERT_TRUE(writeDrawing(ring->curves, folder_ / name));
    const auto back = readDrawing(folder_ / name, {.tolerance = 1e-4});
    EXPECT_NEAR(areaOf(back), signedArea(ring->curves), 1e-7);
    ASSERT_TRUE(back);
    EXPECT_EQ(back->loops, 2U);
    EXPECT_TRUE(back->warnings.empty());
  }
  EXPECT_FALSE(writeDrawing(ring->curves, folder_ / "b.png"));
}

TEST_F(DrawingTest, BadFilesEndInOneSentence) {
  const auto codeOf = [&](const std::string& name, const std::string& text) {
    const auto drawing = readDrawing(write(name, text));
    EXPECT_FALSE(drawing);
    if (drawing) return ErrorCode::Failed;
    EXPECT_FALSE(drawing.error().message.empty());
    return drawing.error().code;
  };
  EXPECT_EQ(codeOf("a.svg", ""), ErrorCode::UnreadableInput);
  EXPECT_EQ(codeOf("a.svg", "<svg><path d='M0 0L1 1'"), ErrorCode::UnreadableInput);
  EXPECT_EQ(codeOf("a.svg", "<html/>"), ErrorCode::UnreadableInput);
  EXPECT_EQ(codeOf("a.svg", "<svg/>"), ErrorCode::UnreadableInput);
  EXPECT_EQ(codeOf("a.svg", "<svg width='0' viewBox='0 0 1 1'><circle r='1'/></svg>"),
            ErrorCode::UnreadableInput);
  EXPECT_EQ(codeOf("a.dxf", "no drawing"), ErrorCode::UnreadableInput);
  EXPECT_EQ(codeOf("a.dxf", std::string(1000, '\0')), ErrorCode::UnreadableInput);
  const std::string loop =
      "0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n8\n0\n2\nB\n10\n0\n20\n0\n0\nINSERT\n8\n0\n2"
      "\nB\n10\n1\n20\n0\n0\nENDBLK\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n0\nINSERT"
      "\n8\n0\n2\nB\n10\n0\n20\n0\n0\nENDSEC\n0\nEOF\n";
  EXPECT_EQ(codeOf("a.dxf", loop), ErrorCode::UnreadableInput);
  EXPECT_FALSE(readDrawing(folder_ / "missing.svg"));
  EXPECT_FALSE(readDrawing(folder_));
}

}  // namespace
}  // namespace phront::cad
