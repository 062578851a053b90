// Strips of a known width.
#include <gtest/gtest.h>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Wire.hxx>
#include <gp_Pln.hxx>
#include <gp_Pnt.hxx>

#include "surfaces/slivers.h"

namespace phront::cad {
namespace {

TopoDS_Wire rectangle(double x, double y, double width, double height) {
  return BRepBuilderAPI_MakePolygon(gp_Pnt(x, y, 0), gp_Pnt(x + width, y, 0),
                                    gp_Pnt(x + width, y + height, 0), gp_Pnt(x, y + height, 0),
                                    true)
      .Wire();
}

TEST(Slivers, MeanWidthOfAStripIsItsWidth) {
  const TopoDS_Face strip = BRepBuilderAPI_MakeFace(gp_Pln(), rectangle(0, 0, 100, 0.2)).Face();
  EXPECT_NEAR(meanWidth(strip), 0.2, 1e-3);
}

TEST(Slivers, NarrowHolesGoAndOthersStay) {
  BRepBuilderAPI_MakeFace plate(gp_Pln(), rectangle(0, 0, 100, 100));
  plate.Add(TopoDS::Wire(rectangle(10, 10, 50, 0.1).Reversed()));
  plate.Add(TopoDS::Wire(rectangle(10, 50, 20, 20).Reversed()));
  const TopoDS_Face mended = withoutSlits(plate.Face(), 0.2);
  EXPECT_EQ(mended.NbChildren(), 2);
  const double area = 100 * 100 - 20 * 20;
  EXPECT_NEAR(meanWidth(mended), 2 * area / (400 + 80), 1e-9);
  EXPECT_EQ(withoutSlits(plate.Face(), 0.05).NbChildren(), 3);
}

}  // namespace
}  // namespace phront::cad
