// A box three edges of which end short of a corner.
#include "rebuild/wide_vertices.h"

#include <gtest/gtest.h>
#include <BRepCheck_Analyzer.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Vertex.hxx>

#include <algorithm>

#include "exchange/measures.h"
#include "judge/widest_gap.h"
#include "rebuild/cells.h"
#include "solids.h"

namespace phront::cad {
namespace {

constexpr double kSide = 10;

/// The edges at the corner of all largest coordinates end `gap` before it.
TopoDS_Shape boxWithGap(double gap) {
  const TopoDS_Shape box = test::box(kSide, kSide, kSide);
  const gp_Pnt corner(kSide, kSide, kSide);
  const BRep_Builder builder;
  for (const TopoDS_Shape& e : partsOf(box, TopAbs_EDGE)) {
    const TopoDS_Edge edge = TopoDS::Edge(e.Oriented(TopAbs_FORWARD));
    double first = 0;
    double last = 0;
    const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, first, last);
    if (curve->Value(last).Distance(corner) < 1e-9) builder.Range(edge, first, last - gap);
  }
  for (const TopoDS_Shape& v : partsOf(box, TopAbs_VERTEX)) {
    const TopoDS_Vertex vertex = TopoDS::Vertex(v);
    if (BRep_Tool::Pnt(vertex).Distance(corner) < 1e-9) builder.UpdateVertex(vertex, 1.1 * gap);
  }
  return box;
}

double widestTolerance(const TopoDS_Shape& shape) {
  double widest = 0;
  for (const TopoDS_Shape& v : partsOf(shape, TopAbs_VERTEX))
    widest = std::max<double>(widest, BRep_Tool::Tolerance(TopoDS::Vertex(v)));
  return widest;
}

TEST(WideVertices, EdgesAreDrawnOutToOnePointOnTheFaces) {
  constexpr double kGap = 0.1;
  const TopoDS_Shape box = boxWithGap(kGap);
  ASSERT_TRUE(BRepCheck_Analyzer(box).IsValid());
  ASSERT_NEAR(widestGap(box).width, kGap, 1e-6);
  const TopoDS_Shape narrow = withNarrowVertices(box, 0.01);
  EXPECT_TRUE(BRepCheck_Analyzer(narrow).IsValid());
  EXPECT_EQ(countOpenEdges(narrow), 0);
  EXPECT_LT(widestTolerance(narrow), 1e-6);
  EXPECT_LT(widestGap(narrow).width, 1e-6);
  EXPECT_NEAR(volumeOf(narrow), kSide * kSide * kSide, 1e-6);
}

TEST(WideVertices, OthersStayAsTheyAre) {
  const TopoDS_Shape box = boxWithGap(0.1);
  EXPECT_TRUE(withNarrowVertices(box, 0.2).IsSame(box));
  // Edges that end far from where they are said to meet are not made up.
  const TopoDS_Shape open = boxWithGap(0.5 * kSide);
  EXPECT_TRUE(withNarrowVertices(open, 0.01).IsSame(open));
}

}  // namespace
}  // namespace phront::cad
