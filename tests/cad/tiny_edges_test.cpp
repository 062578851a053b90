// A box of which a small triangle is cut off one face, at a corner.
#include "rebuild/tiny_edges.h"

#include <gtest/gtest.h>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Vertex.hxx>

#include "exchange/measures.h"
#include "rebuild/cells.h"
#include "rebuild/fuse.h"
#include "solids.h"

namespace phront::cad {
namespace {

constexpr double kCut = 0.05;

/// The vertex at the corner has a tolerance of `tolerance`.
TopoDS_Shape boxWithTriangle(double tolerance) {
  std::vector<TopoDS_Face> faces;
  for (const TopoDS_Shape& face : partsOf(test::box(10, 10, 10), TopAbs_FACE))
    faces.push_back(TopoDS::Face(face));
  const TopoDS_Edge cut = BRepBuilderAPI_MakeEdge(gp_Pnt(kCut, 0, 10), gp_Pnt(0, kCut, 10)).Edge();
  const auto pieces = splitFaces(faces, 0, {}, {cut});
  EXPECT_TRUE(pieces);
  const std::vector<TopoDS_Shape> cells =
      cellsOf(std::vector<TopoDS_Shape>(pieces->begin(), pieces->end()));
  EXPECT_EQ(cells.size(), 1U);
  for (const TopoDS_Shape& vertex : partsOf(cells.front(), TopAbs_VERTEX))
    if (BRep_Tool::Pnt(TopoDS::Vertex(vertex)).Distance(gp_Pnt(0, 0, 10)) < 1e-6)
      BRep_Builder().UpdateVertex(TopoDS::Vertex(vertex), tolerance);
  return cells.front();
}

TEST(TinyEdges, AreCollapsedWithTheFaceBetweenThem) {
  const TopoDS_Shape solid = boxWithTriangle(2 * kCut);
  ASSERT_EQ(partsOf(solid, TopAbs_FACE).size(), 7U);
  const TopoDS_Shape rest = withoutTinyEdges(solid);
  EXPECT_EQ(partsOf(rest, TopAbs_SOLID).size(), 1U);
  EXPECT_EQ(partsOf(rest, TopAbs_FACE).size(), 6U);
  EXPECT_EQ(partsOf(rest, TopAbs_EDGE).size(), 12U);
  EXPECT_EQ(partsOf(rest, TopAbs_VERTEX).size(), 8U);
  EXPECT_TRUE(BRepCheck_Analyzer(rest).IsValid());
  EXPECT_EQ(countOpenEdges(rest), 0);
  EXPECT_NEAR(volumeOf(rest), 1000, 2 * kCut * 100);  // a face within its tolerance
}

TEST(TinyEdges, EdgesBeyondTheToleranceOfTheirEndsStay) {
  const TopoDS_Shape solid = boxWithTriangle(0.5 * kCut);
  EXPECT_TRUE(withoutTinyEdges(solid).IsSame(solid));
  const TopoDS_Shape plain = test::box(1, 2, 3);
  EXPECT_TRUE(withoutTinyEdges(plain).IsSame(plain));
}

}  // namespace
}  // namespace phront::cad
