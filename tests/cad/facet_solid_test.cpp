#include "rebuild/facet_solid.h"

#include <gtest/gtest.h>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <Interface_Static.hxx>
#include <STEPControl_Reader.hxx>
#include <STEPControl_Writer.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Shape.hxx>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <numbers>
#include <sstream>

namespace phront::cad {
namespace {

double volumeOf(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties);
  return properties.Mass();
}

int count(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind) {
  TopTools_IndexedMapOfShape map;
  TopExp::MapShapes(shape, kind, map);
  return map.Extent();
}

/// Every edge is used twice in its shell, and OpenCASCADE says so too.
bool closed(const TopoDS_Shape& shape) {
  bool any = false;
  for (TopExp_Explorer e(shape, TopAbs_SHELL); e.More(); e.Next()) {
    any = true;
    if (!BRep_Tool::IsClosed(e.Current())) return false;
  }
  return any;
}

/// Adds an axis-aligned box; `outward` false makes it a cavity.
void addBox(FacetedSurface& facets, const Vec3& low, const Vec3& high, bool outward = true) {
  const auto first = static_cast<Index>(facets.points.size());
  for (int i = 0; i < 8; ++i) {
    facets.points.emplace_back(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(),
                               i & 4 ? high.z() : low.z());
  }
  const std::array<std::array<Index, 4>, 6> sides{
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  for (std::size_t s = 0; s < 6; ++s) {
    FacetPolygon polygon;
    std::vector<Index> loop;
    for (const Index i : sides[s]) loop.push_back(first + i);
    if (!outward) std::reverse(loop.begin(), loop.end());
    const Vec3 a = facets.points[loop[0]];
    const Vec3 b = facets.points[loop[1]];
    const Vec3 c = facets.points[loop[2]];
    polygon.plane.normal = (b - a).cross(c - a).normalized();
    polygon.plane.offset = polygon.plane.normal.dot(a);
    polygon.loops = {loop};
    facets.polygons.push_back(polygon);
  }
}

/// Square plate with a square hole through it: two faces with a hole, eight sides.
FacetedSurface plateWithHole(double scale) {
  FacetedSurface f;
  const double ring[2][4][2] = {{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {{1, 1}, {3, 1}, {3, 3}, {1, 3}}};
  for (const double z : {0.0, 1.0}) {
    for (const auto& loop : ring) {
      for (const auto& p : loop) f.points.push_back(scale * Vec3(p[0], p[1], z));
    }
  }
  // Points: 0-3 outer bottom, 4-7 inner bottom, 8-11 outer top, 12-15 inner top.
  f.polygons.push_back({{}, {-Vec3::UnitZ(), 0}, {{3, 2, 1, 0}, {4, 5, 6, 7}}});
  f.polygons.push_back({{}, {Vec3::UnitZ(), scale}, {{8, 9, 10, 11}, {15, 14, 13, 12}}});
  for (Index k = 0; k < 4; ++k) {
    const Index n = (k + 1) % 4;
    for (const bool inner : {false, true}) {
      std::vector<Index> loop = inner ? std::vector<Index>{4 + n, 4 + k, 12 + k, 12 + n}
                                      : std::vector<Index>{k, n, 8 + n, 8 + k};
      const Vec3 a = f.points[loop[0]];
      const Vec3 normal = (f.points[loop[1]] - a).cross(f.points[loop[2]] - a).normalized();
      f.polygons.push_back({{}, {normal, normal.dot(a)}, {loop}});
    }
  }
  return f;
}

/// Sphere of triangles between `rings` circles of latitude.
FacetedSurface sphere(double radius, Index rings, Index around) {
  FacetedSurface f;
  f.points.emplace_back(0, 0, radius);
  for (Index i = 1; i < rings; ++i) {
    const double theta = std::numbers::pi * i / rings;
    for (Index j = 0; j < around; ++j) {
      const double phi = 2 * std::numbers::pi * j / around;
      f.points.push_back(radius * Vec3(std::sin(theta) * std::cos(phi),
                                       std::sin(theta) * std::sin(phi), std::cos(theta)));
    }
  }
  f.points.emplace_back(0, 0, -radius);
  const auto last = static_cast<Index>(f.points.size() - 1);
  const auto at = [&](Index i, Index j) {
    return i == 0 ? 0 : i == rings ? last : 1 + (i - 1) * around + j % around;
  };
  const auto add = [&](Index a, Index b, Index c) {
    if (a == b || b == c || c == a) return;
    const Vec3 normal = (f.points[b] - f.points[a]).cross(f.points[c] - f.points[a]).normalized();
    f.polygons.push_back({{}, {normal, normal.dot(f.points[a])}, {{a, b, c}}});
  };
  for (Index i = 0; i < rings; ++i) {
    for (Index j = 0; j < around; ++j) {
      add(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      add(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  return f;
}

/// Writes a STEP file and reads it back.
TopoDS_Shape throughStep(const TopoDS_Shape& shape, const std::string& name) {
  const auto path = std::filesystem::temp_directory_path() / ("phront_facet_" + name + ".step");
  STEPControl_Writer writer;
  Interface_Static::SetIVal("write.surfacecurve.mode", 0);
  EXPECT_EQ(writer.Transfer(shape, STEPControl_AsIs), IFSelect_RetDone);
  EXPECT_EQ(writer.Write(path.c_str()), IFSelect_RetDone);
  STEPControl_Reader reader;
  EXPECT_EQ(reader.ReadFile(path.c_str()), IFSelect_RetDone);
  reader.TransferRoots();
  std::filesystem::remove(path);
  return reader.OneShape();
}

TopoDS_Shape throughBrep(const TopoDS_Shape& shape) {
  std::stringstream stream;
  BRepTools::Write(shape, stream);
  TopoDS_Shape back;
  BRepTools::Read(back, stream, BRep_Builder());
  return back;
}

void expectGood(const TopoDS_Shape& shape, int faces, double volume) {
  ASSERT_FALSE(shape.IsNull());
  EXPECT_TRUE(BRepCheck_Analyzer(shape).IsValid());
  EXPECT_TRUE(closed(shape));
  EXPECT_EQ(count(shape, TopAbs_FACE), faces);
  EXPECT_NEAR(volumeOf(shape), volume, 1e-9 * volume);  // STEP keeps 15 digits
}

TEST(FacetSolid, PlateWithHoleSurvivesFilesAtAnySize) {
  for (const double size : {5.0, 2000.0}) {  // mm
    const double scale = size / 4;
    const auto solid = solidOfFacets(plateWithHole(scale));
    ASSERT_TRUE(solid) << solid.error().message;
    EXPECT_EQ(solid->ShapeType(), TopAbs_SOLID);
    EXPECT_EQ(count(*solid, TopAbs_EDGE), 24);
    EXPECT_EQ(count(*solid, TopAbs_VERTEX), 16);
    const double volume = 12 * scale * scale * scale;
    expectGood(*solid, 10, volume);
    expectGood(throughStep(*solid, "plate"), 10, volume);
    expectGood(throughBrep(*solid), 10, volume);
  }
}

TEST(FacetSolid, CavityLowersTheVolume) {
  FacetedSurface facets;
  addBox(facets, Vec3(1, 1, 1), Vec3(2, 2, 2), false);
  addBox(facets, Vec3(0, 0, 0), Vec3(4, 4, 4));
  const auto solid = solidOfFacets(facets);
  ASSERT_TRUE(solid) << solid.error().message;
  EXPECT_EQ(count(*solid, TopAbs_SHELL), 2);
  expectGood(*solid, 12, 63);
  expectGood(throughStep(*solid, "cavity"), 12, 63);
}

TEST(FacetSolid, IslandsAreSolidsOfTheirOwn) {
  FacetedSurface facets;
  addBox(facets, Vec3(0, 0, 0), Vec3(8, 8, 8));
  addBox(facets, Vec3(1, 1, 1), Vec3(7, 7, 7), false);
  addBox(facets, Vec3(2, 2, 2), Vec3(6, 6, 6));  // floats in the cavity
  addBox(facets, Vec3(3, 3, 3), Vec3(5, 5, 5), false);
  const auto solids = solidOfFacets(facets);
  ASSERT_TRUE(solids) << solids.error().message;
  EXPECT_EQ(solids->ShapeType(), TopAbs_COMPOUND);
  EXPECT_EQ(count(*solids, TopAbs_SOLID), 2);
  expectGood(*solids, 24, 512 - 216 + 64 - 8);
}

TEST(FacetSolid, TwentyThousandFacesInSeconds) {
  const FacetedSurface facets = sphere(10, 101, 100);
  ASSERT_EQ(facets.polygons.size(), 20'000u);
  const std::clock_t start = std::clock();  // CPU time: tests share their machine
  const auto solid = solidOfFacets(facets);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  ASSERT_TRUE(solid) << solid.error().message;
  EXPECT_LT(seconds, 3.0);
  EXPECT_TRUE(closed(*solid));
  EXPECT_EQ(count(*solid, TopAbs_FACE), 20'000);
  const double ball = 4 * std::numbers::pi / 3 * 1000;
  EXPECT_NEAR(volumeOf(*solid), ball, 0.002 * ball);  // chords of 1/100 of the circle
}

TEST(FacetSolid, ToleranceCoversNonPlanarity) {
  FacetedSurface facets = plateWithHole(10);
  facets.points[5] += Vec3(0, 0, 1e-5);
  const auto solid = solidOfFacets(facets);
  ASSERT_TRUE(solid) << solid.error().message;
  EXPECT_TRUE(BRepCheck_Analyzer(*solid).IsValid());
  double largest = 0;
  for (TopExp_Explorer e(*solid, TopAbs_VERTEX); e.More(); e.Next()) {
    largest = std::max(largest, BRep_Tool::Tolerance(TopoDS::Vertex(e.Current())));
  }
  EXPECT_GE(largest, 1e-5);
  EXPECT_LE(largest, 2e-5);
}

TEST(FacetSolid, RefusesWhatDoesNotClose) {
  FacetedSurface open;
  addBox(open, Vec3(0, 0, 0), Vec3(1, 1, 1));
  open.polygons.pop_back();
  EXPECT_EQ(solidOfFacets(open).error().code, ErrorCode::Failed);
  FacetedSurface inside;
  addBox(inside, Vec3(0, 0, 0), Vec3(1, 1, 1), false);
  EXPECT_EQ(solidOfFacets(inside).error().code, ErrorCode::Failed);
  EXPECT_EQ(solidOfFacets({}).error().code, ErrorCode::Failed);
}

TEST(FacetSolid, AnOpenSurfaceIsASheet) {
  FacetedSurface open;
  addBox(open, Vec3(0, 0, 0), Vec3(1, 1, 1));
  open.polygons.pop_back();
  const Result<TopoDS_Shape> sheet = sheetOfFacets(open);
  ASSERT_TRUE(sheet) << sheet.error().message;
  EXPECT_EQ(sheet->ShapeType(), TopAbs_SHELL);
  EXPECT_FALSE(BRep_Tool::IsClosed(*sheet));
  EXPECT_TRUE(BRepCheck_Analyzer(*sheet).IsValid());
  addBox(open, Vec3(3, 0, 0), Vec3(4, 1, 1));
  open.polygons.pop_back();
  const Result<TopoDS_Shape> two = sheetOfFacets(open);
  ASSERT_TRUE(two) << two.error().message;
  EXPECT_EQ(two->NbChildren(), 2);
  EXPECT_EQ(sheetOfFacets({}).error().code, ErrorCode::Failed);
}

TEST(FacetSolid, FacesOfAShellFollowOneAnotherTheLargestFirst) {
  FacetedSurface facets = sphere(3, 12, 24);
  std::ranges::rotate(facets.polygons, facets.polygons.begin() + 100);
  std::ranges::reverse(facets.polygons.begin() + 50, facets.polygons.begin() + 300);
  const Result<TopoDS_Shape> solid = solidOfFacets(facets);
  ASSERT_TRUE(solid) << solid.error().message;
  TopTools_IndexedMapOfShape edges;
  double first = 0;
  double largest = 0;
  for (TopExp_Explorer face(*solid, TopAbs_FACE); face.More(); face.Next()) {
    GProp_GProps properties;
    BRepGProp::SurfaceProperties(face.Current(), properties);
    if (edges.IsEmpty()) first = properties.Mass();
    largest = std::max(largest, properties.Mass());
    bool follows = edges.IsEmpty();
    for (TopExp_Explorer edge(face.Current(), TopAbs_EDGE); edge.More(); edge.Next()) {
      follows = follows || edges.Contains(edge.Current());
    }
    EXPECT_TRUE(follows);
    TopExp::MapShapes(face.Current(), TopAbs_EDGE, edges);
  }
  EXPECT_NEAR(first, largest, 1e-12);
}

TEST(FacetSolid, CrumbsThinnerThanFacetsDeviateGo) {
  FacetedSurface facets;
  addBox(facets, {0, 0, 0}, {1, 1, 1});
  addBox(facets, {2, 0, 0}, {2.001, 1, 1}, false);  // beside it: no cavity
  EXPECT_FALSE(solidOfFacets(facets).has_value());
  facets.maxDeviation = 0.01;
  const Result<TopoDS_Shape> solid = solidOfFacets(facets);
  ASSERT_TRUE(solid) << solid.error().message;
  EXPECT_EQ(count(*solid, TopAbs_SOLID), 1);
  EXPECT_NEAR(volumeOf(*solid), 1, 1e-12);
  // A thick one is a mistake, whatever the facets deviate.
  FacetedSurface wrong;
  addBox(wrong, {0, 0, 0}, {1, 1, 1});
  addBox(wrong, {2, 0, 0}, {2.5, 1, 1}, false);
  wrong.maxDeviation = 0.01;
  EXPECT_FALSE(solidOfFacets(wrong).has_value());
}

}  // namespace
}  // namespace phront::cad
