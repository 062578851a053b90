// The stages between exact patches and the written file, one by one.
#include <gtest/gtest.h>
#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRep_Builder.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <TopoDS_Compound.hxx>
#include <gp.hxx>
#include <gp_Ax2.hxx>
#include <gp_Circ.hxx>
#include <gp_Pln.hxx>
#include <gp_Trsf.hxx>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>

#include "exchange/measures.h"
#include "judge/check_body.h"
#include "judge/read_back.h"
#include "rebuild/assembly_bytes.h"
#include "rebuild/cells.h"
#include "rebuild/contact_cells.h"
#include "rebuild/edge_uses.h"
#include "rebuild/exact_offset.h"
#include "rebuild/facet_gaps.h"
#include "rebuild/fill_gaps.h"
#include "rebuild/front_cuts.h"
#include "rebuild/front_stage.h"
#include "rebuild/fuse.h"
#include "rebuild/living_cells.h"
#include "rebuild/near_bodies.h"
#include "rebuild/open_patches.h"
#include "rebuild/plane_features.h"
#include "rebuild/repair.h"
#include "rebuild/reunite.h"
#include "rebuild/select.h"
#include "rebuild/straight_edges.h"
#include "solids.h"

namespace phront::cad {
namespace {

TrueDistance distanceOf(const TopoDS_Shape& shape, double deflection) {
  TessellateOptions options;
  options.deflection = deflection;
  auto mesh = tessellate(test::solidBody(shape), options);
  EXPECT_TRUE(mesh) << (mesh ? "" : mesh.error().message);
  auto phi = TrueDistance::build(shape, std::move(*mesh));
  EXPECT_TRUE(phi) << (phi ? "" : phi.error().message);
  return std::move(*phi);
}

std::vector<TopoDS_Face> facesOf(const TopoDS_Shape& shape) {
  std::vector<TopoDS_Face> faces;
  for (TopExp_Explorer f(shape, TopAbs_FACE); f.More(); f.Next())
    faces.push_back(TopoDS::Face(f.Current()));
  return faces;
}

TopoDS_Face square(const gp_Pnt& middle, const gp_Dir& normal, double half) {
  return BRepBuilderAPI_MakeFace(gp_Pln(middle, normal), -half, half, -half, half).Face();
}

TopoDS_Shape movedBox(double side, double x) {
  gp_Trsf shift;
  shift.SetTranslation(gp_Vec(x, 0, 0));
  return test::transformed(test::box(side, side, side), shift);
}

TEST(LivingCells, OnlyPatchesThatMeetOnTheLevelMayCross) {
  const TrueDistance phi = distanceOf(test::lShape(), 0.01);
  // Offsets by 0.1 of the two faces of the knee, which cross; of the top; and two that cross off
  // the level, where phi is 0.5.
  const std::vector<TopoDS_Face> patches = {square(gp_Pnt(1.6, 1.1, 0.5), gp_Dir(0, 1, 0), 0.55),
                                            square(gp_Pnt(1.1, 1.6, 0.5), gp_Dir(1, 0, 0), 0.55),
                                            square(gp_Pnt(0.5, 0.5, 1.1), gp_Dir(0, 0, 1), 0.45),
                                            square(gp_Pnt(1.6, 1.5, 0.5), gp_Dir(0, 1, 0), 0.1),
                                            square(gp_Pnt(1.6, 1.5, 0.5), gp_Dir(1, 0, 0), 0.1)};
  const LivingCells cells(patches, 0.1, 0.001, phi);
  EXPECT_TRUE(cells.mayCross(0, 1));
  EXPECT_FALSE(cells.mayCross(0, 2));
  EXPECT_FALSE(cells.mayCross(3, 4));
}

// Two halves of a plane on the level: they meet along the edge they share, and do not cross there.
TEST(LivingCells, NeighboursMeetAlongTheirEdgeButDoNotCross) {
  const TopoDS_Shape box = test::box(4, 4, 4);
  const TrueDistance phi = distanceOf(box, 0.01);
  const TopoDS_Face whole = square(gp_Pnt(2, 2, 4.5), gp::DZ(), 1);
  const TopoDS_Edge middle =
      BRepBuilderAPI_MakeEdge(gp_Pnt(2, 0.5, 4.5), gp_Pnt(2, 3.5, 4.5)).Edge();
  const auto halves = splitFaces({whole}, 0, {}, {middle});
  ASSERT_TRUE(halves);
  ASSERT_EQ(halves->size(), 2U);
  const LivingCells cells(*halves, 0.5, 1e-4, phi);
  EXPECT_TRUE(cells.mayMeet(0, 1));
  EXPECT_FALSE(cells.mayCross(0, 1));
}

TEST(OpenPatches, AreThoseWithPiecesAtAnEdgeThatOneLivePieceUses) {
  const std::vector<TopoDS_Face> patches = facesOf(test::box(1, 2, 3));
  std::vector<JudgedFace> pieces;
  for (const TopoDS_Face& face : patches) {
    pieces.emplace_back();
    pieces.back().face = face;
    pieces.back().live = true;
  }
  const std::vector<bool> closed = openPatches(patches, pieces);
  EXPECT_EQ(std::count(closed.begin(), closed.end(), true), 0);
  pieces.front().live = false;  // its edges are those of four others; it may lack a cut itself
  const std::vector<bool> open = openPatches(patches, pieces);
  EXPECT_TRUE(open.front());
  EXPECT_EQ(std::count(open.begin(), open.end(), true), 5);
}

// The box of a half circle holds its middle, its cells do not.
TEST(ContactCells, OnlyCellsThatMeetTouch) {
  const gp_Circ circle(gp_Ax2(gp_Pnt(0, 0, 0), gp::DZ()), 10);
  const TopoDS_Edge arc = BRepBuilderAPI_MakeEdge(circle, 0, std::numbers::pi);
  const TopoDS_Edge across = BRepBuilderAPI_MakeEdge(gp_Pnt(0, 9, -1), gp_Pnt(0, 11, 1));
  const TopoDS_Edge inside = BRepBuilderAPI_MakeEdge(gp_Pnt(-1, 2, 0), gp_Pnt(1, 2, 0));
  ContactCells cells(1e-7);
  EXPECT_TRUE(cells.mayTouch(0, arc, 1, square(gp_Pnt(0, 10, 0), gp::DX(), 1)));
  EXPECT_FALSE(cells.mayTouch(0, arc, 2, square(gp_Pnt(0, 2, 0), gp::DX(), 1)));
  EXPECT_TRUE(cells.mayTouch(0, arc, 3, across));
  EXPECT_FALSE(cells.mayTouch(0, arc, 4, inside));
}

TopoDS_Shape exactOffset(const TopoDS_Shape& shape, double distance, const TrueDistance& phi) {
  const Result<AttemptResult> made =
      tryExactOffset(shape, true, distance, phi, attemptSettings().front());
  EXPECT_TRUE(made) << (made ? "" : made.error().message);
  return made ? made->shape : TopoDS_Shape();
}

// A hole narrower than the distance, over the ridge of a roof: the pipes round its two rims turn
// back into themselves, and cross along edges that they share.
TEST(TryExactOffset, HoleOverARidgeClosesAtTheSecondLook) {
  BRepBuilderAPI_MakePolygon roof(gp_Pnt(0, 0, 0), gp_Pnt(20, 0, 0), gp_Pnt(20, 0, 3.425),
                                  gp_Pnt(9.25, 0, 4.5));
  roof.Add(gp_Pnt(0, 0, 4.5));
  roof.Close();
  const TopoDS_Shape block =
      BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(roof.Wire()).Face(), gp_Vec(0, 32, 0)).Shape();
  const TopoDS_Shape drill =
      BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(8, 16, -5), gp::DZ()), 1.6, 20).Shape();
  const TopoDS_Shape part =
      TopExp_Explorer(BRepAlgoAPI_Cut(block, drill).Shape(), TopAbs_SOLID).Current();
  constexpr double kDistance = 1.679;
  const TrueDistance phi = distanceOf(part, 1e-3 * kDistance);
  const TopoDS_Shape offset = exactOffset(part, kDistance, phi);
  ASSERT_FALSE(offset.IsNull());
  EXPECT_TRUE(BRepCheck_Analyzer(offset).IsValid());
  EXPECT_EQ(countOpenEdges(offset), 0);
  for (const TopoDS_Face& face : facesOf(offset)) {
    for (const FaceSample& sample : interiorSamples(face)) {
      const Vec3 p(sample.point.X(), sample.point.Y(), sample.point.Z());
      EXPECT_NEAR(phi.signedDistance(p), kDistance, 1e-3 * kDistance);
    }
  }
}

TEST(AssemblyBytes, ComeBackAsTheyWere) {
  Assembly assembly;
  assembly.shape = test::box(1, 2, 3);
  assembly.openEdges = 1;
  assembly.fittedFaces = 2;
  assembly.facetedFaces = 3;
  assembly.way = "sewn pieces, repaired";
  const Result<Assembly> back = assemblyOfBytes(bytesOfAssembly(assembly));
  ASSERT_TRUE(back);
  EXPECT_NEAR(volumeOf(back->shape), 6, 1e-9);
  EXPECT_EQ(back->openEdges, 1);
  EXPECT_EQ(back->fittedFaces, 2);
  EXPECT_EQ(back->facetedFaces, 3);
  EXPECT_EQ(back->way, assembly.way);
  assembly.shape.Nullify();
  const Result<Assembly> nothing = assemblyOfBytes(bytesOfAssembly(assembly));
  ASSERT_TRUE(nothing);
  EXPECT_TRUE(nothing->shape.IsNull());
  EXPECT_FALSE(assemblyOfBytes("1 2 3"));
  EXPECT_FALSE(assemblyOfBytes("one two\nway\n"));
}

TEST(ReuniteFaces, MakesDividedOnesWhole) {
  const TopoDS_Shape cylinder = test::cylinder(5, 10);
  const TrueDistance phi = distanceOf(cylinder, 0.02);
  const TopoDS_Shape divided = exactOffset(cylinder, 1, phi);
  const TopoDS_Shape whole = reuniteFaces(divided, phi, 20);
  ASSERT_FALSE(whole.IsNull());
  EXPECT_GT(facesOf(divided).size(), 5U);
  EXPECT_EQ(facesOf(whole).size(), 5U);  // mantle, two caps, two rims
  EXPECT_TRUE(BRepCheck_Analyzer(whole).IsValid());
  EXPECT_NEAR(volumeOf(whole), volumeOf(divided), 1e-6 * volumeOf(divided));
}

// Each may have a name and a colour of its own.
TEST(ReuniteFaces, KeepsApartWhatWasTwoOnThePart) {
  const TopoDS_Shape box =
      TopExp_Explorer(BRepAlgoAPI_Fuse(movedBox(4, 0), movedBox(4, 4)).Shape(), TopAbs_SOLID)
          .Current();
  ASSERT_EQ(facesOf(box).size(), 10U);
  const TrueDistance phi = distanceOf(box, 0.02);
  const TopoDS_Shape shrunk = exactOffset(box, -1, phi);
  ASSERT_EQ(facesOf(shrunk).size(), 10U);
  EXPECT_TRUE(reuniteFaces(shrunk, phi, 20).IsNull());
}

TEST(SplitFaces, LinesThatEndInsideBoundNothing) {
  const TopoDS_Face whole = square(gp::Origin(), gp::DZ(), 1);
  const std::array<gp_Pnt, 3> corners{gp_Pnt(0, 0, 0), gp_Pnt(0.4, -0.3, 0), gp_Pnt(0.4, 0.3, 0)};
  // A triangle inside, a line to it from the border, and one that ends in the open.
  std::vector<TopoDS_Shape> cuts{
      BRepBuilderAPI_MakeEdge(gp_Pnt(-1, 0, 0), corners[0]).Edge(),
      BRepBuilderAPI_MakeEdge(gp_Pnt(0, 1, 0), gp_Pnt(0, 0.5, 0)).Edge()};
  for (std::size_t i = 0; i < 3; ++i)
    cuts.push_back(BRepBuilderAPI_MakeEdge(corners[i], corners[(i + 1) % 3]).Edge());
  const auto split = splitFaces({whole}, 0, {}, cuts);
  ASSERT_TRUE(split) << split.error().message;
  ASSERT_EQ(split->size(), 2U);
  double area = 0;
  for (const TopoDS_Face& piece : *split) {
    area += areaOf(piece);
    EXPECT_TRUE(BRepCheck_Analyzer(piece).IsValid());
    std::map<const void*, int> uses;
    for (TopExp_Explorer edge(piece, TopAbs_EDGE); edge.More(); edge.Next())
      EXPECT_EQ(++uses[edge.Current().TShape().get()], 1);
  }
  EXPECT_NEAR(area, 4, 1e-9);
}

TEST(AssembleSolids, LeavesOutPiecesNarrowerThanTheirEdgesAreKnown) {
  const TopoDS_Shape part = test::box(10, 10, 10);
  const TrueDistance phi = distanceOf(part, 0.01);
  const double d = -1;
  const auto exact = tryExactOffset(part, true, d, phi, attemptSettings().front());
  ASSERT_TRUE(exact) << exact.error().message;
  // A strip on top of it, 0.01 wide.
  const std::vector<TopoDS_Shape> cuts{
      BRepBuilderAPI_MakeEdge(gp_Pnt(5, 1, 9), gp_Pnt(5, 9, 9)).Edge(),
      BRepBuilderAPI_MakeEdge(gp_Pnt(5.01, 1, 9), gp_Pnt(5.01, 9, 9)).Edge()};
  for (const double tolerance : {1e-7, 0.02}) {
    const auto split = splitFaces(facesOf(exact->shape), 0, {}, cuts);
    ASSERT_TRUE(split) << split.error().message;
    ASSERT_EQ(split->size(), 8U);
    for (const TopoDS_Face& piece : *split) {
      for (TopExp_Explorer edge(piece, TopAbs_EDGE); edge.More(); edge.Next()) {
        const BRepAdaptor_Curve curve(TopoDS::Edge(edge.Current()));
        const gp_Pnt middle = curve.Value((curve.FirstParameter() + curve.LastParameter()) / 2);
        if (middle.Distance(gp_Pnt(5.005, 5, 9)) < 0.01)
          BRep_Builder().UpdateEdge(TopoDS::Edge(edge.Current()), tolerance);
      }
    }
    const Assembly made = assembleSolids(judgeFaces(*split, true, d, 1e-5, phi),
                                         {.distance = d, .diagonal = 17.3, .sewTolerance = 0}, phi);
    EXPECT_EQ(made.openEdges, 0);
    EXPECT_EQ(facesOf(made.shape).size(), tolerance > 0.01 ? 7U : 8U);
    EXPECT_TRUE(BRepCheck_Analyzer(made.shape).IsValid());
    EXPECT_NEAR(volumeOf(made.shape), 512, 512 * 0.02);
  }
}

TEST(FillGaps, ClosesWhereAPieceIsMissing) {
  const double d = 0.5;
  const TopoDS_Shape shape = test::box(4, 3, 2);
  const TrueDistance phi = distanceOf(shape, 0.005);
  const auto exact = tryExactOffset(shape, true, d, phi, attemptSettings().front());
  ASSERT_TRUE(exact) << exact.error().message;
  GProp_GProps whole;
  BRepGProp::SurfaceProperties(exact->shape, whole);
  const std::vector<TopoDS_Face> all = facesOf(exact->shape);
  EXPECT_EQ(all.size(), 26U);
  for (std::size_t gone = 0; gone < all.size(); ++gone) {
    std::vector<TopoDS_Face> faces = all;
    faces.erase(faces.begin() + static_cast<std::ptrdiff_t>(gone));
    const FilledGaps filled = fillGaps(faces, {d, 0.01 * d}, phi);
    ASSERT_EQ(filled.patches.size(), 1U) << "without face " << gone;
    EXPECT_EQ(filled.unfilled, 0);
    GProp_GProps lost;
    GProp_GProps patch;
    BRepGProp::SurfaceProperties(all[gone], lost);
    BRepGProp::SurfaceProperties(filled.patches.front(), patch);
    EXPECT_NEAR(std::abs(patch.Mass()), std::abs(lost.Mass()), 0.01 * std::abs(lost.Mass()));
  }
}

TEST(FacetGaps, GiveUpPiecesAtFaultAndKeepTheOthers) {
  const double d = 0.5;
  const TrueDistance phi = distanceOf(test::box(4, 3, 2), 0.005);
  const auto exact = tryExactOffset(test::box(4, 3, 2), true, d, phi, attemptSettings().front());
  ASSERT_TRUE(exact) << exact.error().message;
  const auto front = isoSurface(phi.surface(), {.level = d, .spacing = 0.25 * d});
  ASSERT_TRUE(front) << front.error().message;
  const FacetGapOptions options{d, 0.01 * d, planesOf(phi.tessellation().features)};
  EXPECT_FALSE(facetGaps(facesOf(exact->shape), options, *front, phi)) << "there is no gap";
  const std::vector<TopoDS_Face> all = facesOf(exact->shape);
  for (std::size_t at = 0; at < all.size(); at += 6) {
    std::vector<TopoDS_Face> faces = all;
    // One that is gone, and next to it one that leaves the level.
    const auto next = (at + 1) % all.size();
    gp_Trsf shift;
    shift.SetTranslation(gp_Vec(0.1, 0.1, 0.1));
    faces[next] = TopoDS::Face(faces[next].Moved(TopLoc_Location(shift)));
    faces.erase(faces.begin() + static_cast<std::ptrdiff_t>(at));
    const auto closed = facetGaps(faces, options, *front, phi);
    ASSERT_TRUE(closed) << "without face " << at << ": " << closed.error().message;
    EXPECT_EQ(closed->faces.size() - static_cast<std::size_t>(closed->facets), all.size() - 2);
    EXPECT_LE(closed->curvedFacets, closed->facets);
    std::map<const void*, int> uses;
    double area = 0;
    for (const TopoDS_Face& face : closed->faces) {
      EXPECT_TRUE(BRepCheck_Analyzer(face).IsValid());
      GProp_GProps of;
      BRepGProp::SurfaceProperties(face, of);
      area += std::abs(of.Mass());
      for (TopExp_Explorer e(face, TopAbs_EDGE); e.More(); e.Next())
        if (!BRep_Tool::Degenerated(TopoDS::Edge(e.Current()))) ++uses[e.Current().TShape().get()];
    }
    for (const auto& [edge, count] : uses) EXPECT_EQ(count, 2);
    GProp_GProps whole;
    BRepGProp::SurfaceProperties(exact->shape, whole);
    EXPECT_NEAR(area, whole.Mass(), 0.02 * whole.Mass());
  }
}

TEST(StraightenOpenEdges, LinesStandForArcsWithinTheChord) {
  // Half a cylinder and a cap of it: the arc between them is used twice, the others once.
  const TopoDS_Shape cylinder = test::cylinder(5, 10);
  std::vector<TopoDS_Face> faces = facesOf(cylinder);
  ASSERT_EQ(faces.size(), 3U);
  faces.pop_back();
  const std::vector<TopoDS_Face> before = faces;
  const double chord = 0.02;
  EXPECT_TRUE(straightenOpenEdges(faces, {chord, 100, 0.1}).empty());
  const EdgeUses uses(faces);
  int lines = 0;
  for (std::size_t e = 0; e < uses.faces.size(); ++e) {
    if (uses.faces[e].size() != 1) continue;
    ++lines;
    EXPECT_EQ(BRepAdaptor_Curve(uses.edge(e)).GetType(), GeomAbs_Line);
    EXPECT_LE(BRep_Tool::Tolerance(uses.edge(e)), 1.2 * chord);
  }
  // A chord of a circle of radius r is off by c where it spans sqrt(8 r c).
  EXPECT_GE(lines, static_cast<int>(2 * std::numbers::pi * 5 / std::sqrt(8 * 5 * chord)));
  for (std::size_t f = 0; f < faces.size(); ++f) {
    EXPECT_TRUE(BRepCheck_Analyzer(faces[f]).IsValid());
    EXPECT_NEAR(areaOf(faces[f]), areaOf(before[f]), 0.01 * areaOf(before[f]));
  }
}

TEST(FrontCuts, FollowACrossingThatWasMissed) {
  const double d = 0.1;
  const TrueDistance phi = distanceOf(test::lShape(), 0.01);
  // Offsets of the two faces of the knee, which cross at (1.1, 1.1), not cut there.
  const std::vector<TopoDS_Face> knee = {square(gp_Pnt(1.5, 1.1, 0.5), gp_Dir(0, 1, 0), 0.45),
                                         square(gp_Pnt(1.1, 1.5, 0.5), gp_Dir(1, 0, 0), 0.45)};
  const std::vector<JudgedFace> pieces = judgeFaces(knee, true, d, 1e-5, phi);
  const std::vector<TopoDS_Shape> cuts = frontCuts(pieces, true, d, 1e-5, phi);
  ASSERT_EQ(cuts.size(), 2U);
  for (const TopoDS_Shape& cut : cuts) {
    for (const double share : {0.3, 0.5, 0.7}) {
      const BRepAdaptor_Curve curve(TopoDS::Edge(cut));
      const gp_Pnt p = curve.Value(curve.FirstParameter() +
                                   share * (curve.LastParameter() - curve.FirstParameter()));
      EXPECT_NEAR(p.X(), 1.1, 1e-6);
      EXPECT_NEAR(p.Y(), 1.1, 1e-6);
    }
  }
  const auto never = [](std::size_t, std::size_t) { return false; };
  const auto split = splitFaces(knee, 0, never, cuts);
  ASSERT_TRUE(split) << split.error().message;
  EXPECT_EQ(split->size(), 4U);
}

TEST(RepairPieces, CutsWhatWasLeftUncut) {
  const double d = 0.1;
  const double diagonal = std::sqrt(9.0);
  const TopoDS_Shape knee = test::lShape();
  const TrueDistance phi = distanceOf(knee, 0.002);
  const auto exact = tryExactOffset(knee, true, d, phi, attemptSettings().front());
  ASSERT_TRUE(exact) << exact.error().message;
  std::vector<TopoDS_Face> faces;
  int uncut = 0;
  for (const TopoDS_Face& face : facesOf(exact->shape)) {
    const BRepAdaptor_Surface surface(face, Standard_False);
    Bnd_Box box;
    BRepBndLib::AddOptimal(face, box, Standard_False, Standard_False);
    double low[3];
    double high[3];
    box.Get(low[0], low[1], low[2], high[0], high[1], high[2]);
    // The two at the knee run on beyond the line where they cross.
    const int across = high[0] - low[0] < 1e-3 ? 0 : 1;
    const bool atKnee = surface.GetType() == GeomAbs_Plane && high[2] - low[2] > 0.5 &&
                        std::abs(low[0] - 1.1) < 1e-3 && std::abs(low[1] - 1.1) < 1e-3;
    if (!atKnee) {
      faces.push_back(face);
      continue;
    }
    ++uncut;
    const gp_Pnt corner(across == 0 ? 1.1 : 0.8, across == 0 ? 0.8 : 1.1, low[2]);
    const gp_Ax3 frame(corner, gp_Dir(across == 0 ? 1 : 0, across == 0 ? 0 : 1, 0),
                       gp_Dir(across == 0 ? 0 : 1, across == 0 ? 1 : 0, 0));
    const double length = high[1 - across] - 0.8;
    const double height = high[2] - low[2];
    const bool up = frame.YDirection().Z() > 0;
    faces.push_back(
        BRepBuilderAPI_MakeFace(gp_Pln(frame), 0, length, up ? 0 : -height, up ? height : 0)
            .Face());
  }
  ASSERT_EQ(uncut, 2);
  const auto judge = [&](const std::vector<TopoDS_Face>& pieces) {
    return judgeFaces(pieces, true, d, 1e-5, phi);
  };
  const RepairRequest request{{d, diagonal, 0}, 0, 1e-5, judge};
  const auto repaired = repairPieces(judge(faces), request, phi, {60, 2000});
  ASSERT_TRUE(repaired) << repaired.error().message;
  GProp_GProps is;
  GProp_GProps should;
  BRepGProp::VolumeProperties(repaired->shape, is);
  BRepGProp::VolumeProperties(exact->shape, should);
  EXPECT_NEAR(is.Mass(), should.Mass(), 1e-4 * should.Mass());
}

// Roundings of tiny distances are divided as the deflection asks, not finer: along an edge of many
// thousand |d| triangles as long as they are wide would be too many.
TEST(MeshSize, TinyDistancesStayCoarse) {
  const MeshSize common = usualMeshSize({1000, 5, true});
  EXPECT_NEAR(common.deflection, 0.1, 1e-12);
  const MeshSize tiny = usualMeshSize({1000, 0.01, true});
  EXPECT_GT(tiny.deflection, 0.01);
  EXPECT_GT(tiny.angle, 3 * common.angle);
  EXPECT_LT(tiny.angle, 2);
}

TEST(ExchangeFault, OpenSolidsAreFound) {
  Model good;
  good.bodies.push_back(test::solidBody(test::filletedBox(4, 0.5)));
  EXPECT_EQ(exchangeFault(good, usualMeshSize({1, 0.1, true})), "");

  BRepBuilderAPI_Sewing sewing;
  std::vector<TopoDS_Face> faces = facesOf(test::box(1, 1, 1));
  faces.pop_back();
  for (const TopoDS_Face& face : faces) sewing.Add(face);
  sewing.Perform();
  Model open;
  open.bodies.push_back(test::solidBody(sewing.SewedShape()));
  EXPECT_NE(exchangeFault(open, usualMeshSize({1, 0.1, true})), "");
}

// What was checked is what is written, to the last digit, or it is checked again.
TEST(ReadBack, TheSameShapeHasTheSameFingerprint) {
  const auto back = [](double height) {
    const auto model = readBack({test::solidBody(test::box(1, 2, height))});
    EXPECT_TRUE(model) << model.error().message;
    EXPECT_TRUE(*model);
    return fingerprintOf(model->value());
  };
  EXPECT_EQ(back(3), back(3));
  EXPECT_NE(back(3), back(3 + 1e-12));
}

TEST(BodyCheck, FilesAndMemoryHaveTheSameVerdict) {
  const auto block = [](double side, double radius) {  // about the origin
    gp_Trsf move;
    move.SetTranslation(gp_Vec(-side / 2, -side / 2, -side / 2));
    return test::solidBody(test::filletedBox(side, radius).Moved(move));
  };
  const Body part = block(10, 2);
  OffsetOptions options;
  options.distance = 1;
  options.tolerance = 0.01;
  const auto phi = std::make_shared<const TrueDistance>(distanceOf(occtShape(part.shape), 0.002));
  // Once with the distance that is there, once with its own: what phi measures is another shape.
  for (const Body& healed : {part, block(1, 0.1)}) {
    const Result<BodyCheck> check = BodyCheck::make(part, healed, phi, 1, 30);
    ASSERT_TRUE(check) << check.error().message;
    const std::vector<Body> wrong = {block(12, 2.5)};
    EXPECT_FALSE(check->inMemory(wrong, options, 30).pass());
    EXPECT_FALSE(check->fromFile(wrong, options, 30).check.pass());
    const std::vector<Body> right = {block(12, 3)};
    EXPECT_TRUE(check->inMemory(right, options, 30).pass());
    EXPECT_TRUE(check->fromFile(right, options, 30).check.pass());
  }
}

TEST(MakeFront, EndsInTimeAndSaysWhatItLeftOut) {
  const TrueDistance phi = distanceOf(test::box(100, 100, 0.3), 0.1);
  const auto late = makeFront(phi.surface(), -0.1, 1, {1000, 0}, {});
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().code, ErrorCode::ResourceLimit);
  const Progress cancel([](double, std::string_view) { return false; });
  const auto cancelled = makeFront(phi.surface(), -0.1, 1, {1000, 60}, cancel);
  ASSERT_FALSE(cancelled);
  EXPECT_EQ(cancelled.error().code, ErrorCode::Cancelled);
  // A sheet 0.1 thin on a grid of half a unit: seen, not resolved.
  const auto coarse = makeFront(phi.surface(), -0.1, 1, {1000, 60}, {});
  ASSERT_TRUE(coarse) << coarse.error().message;
  EXPECT_TRUE(coarse->unresolved);
}

TEST(JoinNearBodies, PutsTogetherWhatGrowsTogether) {
  const std::vector<Body> bodies = {test::solidBody(movedBox(2, 0)),
                                    test::solidBody(movedBox(2, 10)),
                                    test::solidBody(movedBox(2, 3))};
  std::vector<std::string> warnings;
  EXPECT_EQ(joinNearBodies(bodies, -5, warnings).size(), 3U);
  EXPECT_EQ(joinNearBodies(bodies, 0.4, warnings).size(), 3U);
  EXPECT_TRUE(warnings.empty());
  const std::vector<Body> two = joinNearBodies(bodies, 0.6, warnings);
  ASSERT_EQ(two.size(), 2U);
  EXPECT_EQ(faceCount(two[0].shape), 12);
  EXPECT_EQ(faceCount(two[1].shape), 6);
  EXPECT_EQ(warnings.size(), 1U);
  EXPECT_EQ(joinNearBodies(bodies, 3, warnings).size(), 1U);
}

}  // namespace
}  // namespace phront::cad
