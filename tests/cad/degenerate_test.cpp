// Distances at which something vanishes exactly: gaps close, teeth and walls go, fillets and holes
// collapse to lines. The distance is swept through each event; every result must pass the judge,
// and volumes must grow with the distance.
#include <gtest/gtest.h>

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <cmath>
#include <functional>
#include <map>
#include <ostream>
#include <string>

#include "phront/cad/offset_shape.h"
#include "solids.h"

namespace phront::cad {
namespace {

struct Event {
  const char* name;
  std::function<TopoDS_Shape()> shape;
  double distance;  ///< of the event
};

void PrintTo(const Event& event, std::ostream* out) { *out << event.name; }

TopoDS_Shape boxAt(double x, double y, double z, double dx, double dy, double dz) {
  return BRepPrimAPI_MakeBox(gp_Pnt(x, y, z), dx, dy, dz).Solid();
}

TopoDS_Shape solidIn(const TopoDS_Shape& shape) {
  return TopExp_Explorer(shape, TopAbs_SOLID).Current();
}

TopoDS_Shape without(const TopoDS_Shape& shape, const TopoDS_Shape& tool) {
  return solidIn(BRepAlgoAPI_Cut(shape, tool).Shape());
}

TopoDS_Shape with(const TopoDS_Shape& shape, const TopoDS_Shape& more) {
  return solidIn(BRepAlgoAPI_Fuse(shape, more).Shape());
}

/// Slot of width 2.
TopoDS_Shape slotted() { return without(test::box(10, 6, 4), boxAt(4, -1, 1, 2, 8, 4)); }

/// Three teeth of thickness 2 on a thick base.
TopoDS_Shape comb() {
  TopoDS_Shape shape = test::box(20, 6, 6);
  for (const double x : {1.0, 9.0, 17.0}) shape = with(shape, boxAt(x, 0, 5, 2, 6, 5));
  return shape;
}

/// Thick block with a wall of thickness 2 along its side.
TopoDS_Shape walled() { return with(test::box(8, 8, 8), boxAt(7, 0, 0, 8, 2, 8)); }

TopoDS_Shape filleted() { return test::filletedBox(10, 1); }

/// Step whose inner edge is rounded with radius 1.
TopoDS_Shape steppedWithFillet() {
  const TopoDS_Shape step = without(test::box(10, 6, 8), boxAt(5, -1, 4, 6, 8, 5));
  BRepFilletAPI_MakeFillet fillet(step);
  TopTools_IndexedMapOfShape edges;
  TopExp::MapShapes(step, TopAbs_EDGE, edges);
  for (int i = 1; i <= edges.Extent(); ++i) {
    const TopoDS_Edge edge = TopoDS::Edge(edges(i));
    const gp_Pnt a = BRep_Tool::Pnt(TopExp::FirstVertex(edge));
    const gp_Pnt b = BRep_Tool::Pnt(TopExp::LastVertex(edge));
    const auto inner = [](const gp_Pnt& p) {
      return std::abs(p.X() - 5) < 1e-9 && std::abs(p.Z() - 4) < 1e-9;
    };
    if (inner(a) && inner(b)) fillet.Add(1, edge);
  }
  return solidIn(fillet.Shape());
}

/// Plate with a hole of radius 1 and one of radius 2.
TopoDS_Shape drilled() {
  const TopoDS_Shape plate = test::box(16, 10, 4);
  const TopoDS_Shape small =
      BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(4, 5, -1), gp_Dir(0, 0, 1)), 1, 6).Solid();
  const TopoDS_Shape large =
      BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(11, 5, -1), gp_Dir(0, 0, 1)), 2, 6).Solid();
  return without(without(plate, small), large);
}

std::string linesOf(const std::vector<std::string>& attempts) {
  std::string lines;
  for (const std::string& attempt : attempts) lines += attempt + "\n";
  return lines;
}

class Degenerate : public ::testing::TestWithParam<Event> {};

TEST_P(Degenerate, EveryDistancePasses) {
  Model model;
  model.bodies.push_back(test::solidBody(GetParam().shape()));
  std::map<double, double> volumes;  // by the distance that was made
  for (const double factor : {0.98, 0.9995, 1.0, 1.0005, 1.02}) {
    OffsetOptions options;
    options.distance = factor * GetParam().distance;
    const auto offset = offsetModel(model, options);
    ASSERT_TRUE(offset) << factor << ": " << offset.error().message;
    const BodyReport& body = offset->report.bodies.front();
    for (const std::string& reason : offset->report.check.reasons)
      ADD_FAILURE() << factor << ": " << reason << "\n" << linesOf(body.attempts);
    EXPECT_EQ(body.kind, OffsetKind::Exact) << factor << ": " << body.setting;
    EXPECT_EQ(body.reach < 1, !offset->report.warnings.empty());
    const bool atEvent = std::abs(factor - 1) < 0.01;
    EXPECT_TRUE(atEvent || body.reach == 1) << factor;
    EXPECT_LT(offset->report.check.accuracyP99, 1.2e-3 * std::abs(options.distance));
    volumes[body.reach * options.distance] = offset->report.check.volume;
  }
  double last = 0;
  for (const auto& [distance, volume] : volumes) {
    EXPECT_GT(volume, last) << distance;
    last = volume;
  }
}

INSTANTIATE_TEST_SUITE_P(Events, Degenerate,
                         testing::Values(Event{"GapCloses", slotted, 1},
                                         Event{"TeethVanish", comb, -1},
                                         Event{"WallVanishes", walled, -1},
                                         Event{"ConvexFilletsCollapse", filleted, -1},
                                         Event{"ConcaveFilletCollapses", steppedWithFillet, 1},
                                         Event{"HoleCloses", drilled, 1}),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace phront::cad
