#include "phront/cad/tessellate.h"

#include <gtest/gtest.h>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepGProp.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <Poly_Triangulation.hxx>
#include <gp.hxx>

#include <map>
#include <numbers>

#include "solids.h"

namespace phront::cad {
namespace {

constexpr double kPi = std::numbers::pi;

Tessellation tessellated(const TopoDS_Shape& shape, double deflection,
                         BodyKind kind = BodyKind::Solid) {
  Body body = test::solidBody(shape);
  body.kind = kind;
  auto result = tessellate(body, {.deflection = deflection});
  EXPECT_TRUE(result) << (result ? "" : result.error().message);
  return result ? std::move(*result) : Tessellation{};
}

std::map<EdgeType, int> edgeTypes(const Tessellation& t) {
  std::map<EdgeType, int> count;
  for (const EdgeFeature& e : t.features.edges) ++count[e.type];
  return count;
}

void expectSound(const Tessellation& t) {
  const std::size_t n = t.mesh.triangles.size();
  ASSERT_GT(n, 0u);
  EXPECT_EQ(t.mesh.faceOf.size(), n);
  EXPECT_EQ(t.mesh.edgeOf.size(), 3 * n);
  EXPECT_EQ(t.mesh.vertexOf.size(), t.mesh.points.size());
  EXPECT_EQ(t.uv.size(), n);
  EXPECT_EQ(t.untessellatedFaces, 0);
  EXPECT_EQ(t.filledHoles, 0);
  const MeshDiagnostics d = diagnose(t.mesh);
  EXPECT_TRUE(d.closedManifold()) << "free " << d.freeEdges << " non-manifold "
                                  << d.nonManifoldEdges << " misoriented " << d.misorientedEdges
                                  << " points " << d.nonManifoldPoints;
  // Every face has triangles, and every edge label lies on a face of that edge.
  for (const FaceFeature& f : t.features.faces) EXPECT_GT(f.area, 0);
  for (std::size_t s = 0; s < t.mesh.edgeOf.size(); ++s) {
    if (t.mesh.edgeOf[s] == kNone) continue;
    const auto& faces = t.features.edges[static_cast<std::size_t>(t.mesh.edgeOf[s])].faces;
    EXPECT_NE(std::find(faces.begin(), faces.end(), t.mesh.faceOf[s / 3]), faces.end());
  }
}

struct Case {
  const char* name;
  TopoDS_Shape shape;
  double volume;
  double area;
};

TEST(Tessellate, SolidsCloseAndKeepTheirVolume) {
  const double deflection = 0.005;
  const std::vector<Case> cases = {
      {"box", test::box(1, 2, 3), 6, 22},
      {"cylinder", test::cylinder(1, 3), 3 * kPi, 8 * kPi},
      {"sphere", test::sphere(2), 32 * kPi / 3, 16 * kPi},
      {"cone", test::cone(1, 2), 2 * kPi / 3, kPi + kPi * std::sqrt(5.0)},
      {"torus", test::torus(3, 1), 6 * kPi * kPi, 12 * kPi * kPi},
      {"lShape", test::lShape(), 3, 14},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    const Tessellation t = tessellated(c.shape, deflection);
    expectSound(t);
    // OpenCASCADE treats the deflection as a target: twice is its usual worst.
    EXPECT_LE(t.measuredDeflection, 2 * deflection);
    EXPECT_NEAR(signedVolume(t.mesh), c.volume, c.area * t.measuredDeflection + 1e-9);
  }
}

TEST(Tessellate, FreeformAndFilletedSolidsClose) {
  for (const TopoDS_Shape& shape : {test::filletedBox(4, 0.5), test::loft()}) {
    const Tessellation t = tessellated(shape, 0.005);
    expectSound(t);
    GProp_GProps properties;
    BRepGProp::VolumeProperties(shape, properties);
    EXPECT_NEAR(signedVolume(t.mesh), properties.Mass(),
                area(t.mesh) * t.measuredDeflection + 1e-6);
  }
}

TEST(Tessellate, EdgesAreTypedByTheirDihedral) {
  const auto boxTypes = edgeTypes(tessellated(test::box(1, 2, 3), 0.01));
  EXPECT_EQ(boxTypes, (std::map<EdgeType, int>{{EdgeType::Convex, 12}}));
  const auto lTypes = edgeTypes(tessellated(test::lShape(), 0.01));
  EXPECT_EQ(lTypes, (std::map<EdgeType, int>{{EdgeType::Convex, 17}, {EdgeType::Concave, 1}}));
  const auto filletTypes = edgeTypes(tessellated(test::filletedBox(4, 0.5), 0.01));
  ASSERT_EQ(filletTypes.size(), 1u);
  EXPECT_EQ(filletTypes.begin()->first, EdgeType::Smooth);
  // Two rims and a seam.
  const auto cylinderTypes = edgeTypes(tessellated(test::cylinder(1, 3), 0.01));
  EXPECT_EQ(cylinderTypes, (std::map<EdgeType, int>{{EdgeType::Convex, 2}, {EdgeType::Smooth, 1}}));
}

TEST(Tessellate, DihedralOfABoxIsARightAngle) {
  const Tessellation t = tessellated(test::box(1, 2, 3), 0.01);
  double length = 0;
  for (const EdgeFeature& e : t.features.edges) {
    EXPECT_NEAR(e.maxDihedral, kPi / 2, 1e-12);  // round-off of atan2
    EXPECT_EQ(e.faces.size(), 2u);
    length += e.length;
  }
  EXPECT_NEAR(length, 24, 1e-12);
}

TEST(Tessellate, LabelsFollowSharpFeaturesOnly) {
  const Tessellation b = tessellated(test::box(1, 2, 3), 0.01);
  EXPECT_EQ(std::count_if(b.mesh.vertexOf.begin(), b.mesh.vertexOf.end(),
                          [](Index v) { return v != kNone; }),
            8);
  EXPECT_EQ(
      std::count_if(b.mesh.edgeOf.begin(), b.mesh.edgeOf.end(), [](Index e) { return e != kNone; }),
      24);  // 12 edges, one side on either face: the box has no point inside an edge
  const Tessellation s = tessellated(test::sphere(1), 0.01);
  for (const Index v : s.mesh.vertexOf) EXPECT_EQ(v, kNone);  // poles are smooth
  for (const Index e : s.mesh.edgeOf) EXPECT_EQ(e, kNone);
  EXPECT_GT(s.edgeSides.size(), 0u);  // the seam is known all the same
  const Tessellation c = tessellated(test::cone(1, 2), 0.01);
  bool apex = false;
  for (std::size_t i = 0; i < c.mesh.points.size(); ++i) {
    apex |= c.mesh.vertexOf[i] != kNone && (c.mesh.points[i] - Vec3(0, 0, 2)).norm() < 1e-12;
  }
  EXPECT_TRUE(apex);
}

TEST(Tessellate, PlanesPointOutward) {
  const Tessellation t = tessellated(test::lShape(), 0.01);
  const Vec3 inside(0.5, 0.5, 0.5);
  int outward = 0;
  for (const FaceFeature& f : t.features.faces) {
    ASSERT_TRUE(f.plane);
    outward += f.plane->normal.dot(inside) < f.plane->offset;
  }
  EXPECT_EQ(outward, 8);
}

TEST(Tessellate, MirroredSolidsPointOutward) {
  gp_Trsf mirror;
  mirror.SetMirror(gp_Ax2(gp_Pnt(5, 0, 0), gp_Dir(1, 0.3, 0.2)));
  const Tessellation t = tessellated(test::transformed(test::cone(1, 2), mirror), 0.005);
  expectSound(t);
  EXPECT_NEAR(signedVolume(t.mesh), 2 * kPi / 3, 0.05);
  // The same as a location instead of new geometry.
  const TopoDS_Shape moved = test::lShape().Moved(TopLoc_Location(mirror), Standard_False);
  const Tessellation m = tessellated(moved, 0.005);
  EXPECT_NEAR(signedVolume(m.mesh), 3, 1e-9);
}

TEST(Tessellate, UvBelongsToThePoints) {
  const Tessellation t = tessellated(test::cylinder(1, 3), 0.01);
  int checked = 0;
  for (std::size_t i = 0; i < t.mesh.triangles.size(); ++i) {
    if (t.features.faces[static_cast<std::size_t>(t.mesh.faceOf[i])].type !=
        SurfaceType::Cylinder) {
      continue;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& p = t.mesh.points[static_cast<std::size_t>(t.mesh.triangles[i][k])];
      const Eigen::Vector2d& uv = t.uv[i][k];
      EXPECT_NEAR((p - Vec3(std::cos(uv.x()), std::sin(uv.x()), uv.y())).norm(), 0, 1e-9);
      // No triangle reaches across the seam in (u,v).
      EXPECT_LT(std::abs(uv.x() - t.uv[i][(k + 1) % 3].x()), kPi);
      ++checked;
    }
  }
  EXPECT_GT(checked, 30);
}

TEST(Tessellate, SheetKeepsItsFreeBorder) {
  BRepBuilderAPI_MakeFace face(gp_Pln(), 0, 2, 0, 1);
  const Tessellation t = tessellated(face.Shape(), 0.01, BodyKind::Sheet);
  EXPECT_EQ(t.mesh.triangles.size(), 2u);
  EXPECT_EQ(diagnose(t.mesh).freeEdges, 4);
  EXPECT_EQ(edgeTypes(t), (std::map<EdgeType, int>{{EdgeType::Free, 4}}));
}

TEST(Tessellate, MissingFaceOfASolidIsFilled) {
  // Five faces of a box that call themselves a solid: the hole gets a patch, and it is counted.
  const TopoDS_Shape block = test::box(1, 2, 3);
  BRep_Builder builder;
  TopoDS_Shell shell;
  builder.MakeShell(shell);
  TopExp_Explorer faces(block, TopAbs_FACE);
  for (faces.Next(); faces.More(); faces.Next()) builder.Add(shell, faces.Current());
  const Tessellation t = tessellated(shell, 0.01);
  EXPECT_EQ(t.filledHoles, 1);
  EXPECT_TRUE(diagnose(t.mesh).closedManifold());
  EXPECT_NEAR(signedVolume(t.mesh), 6, 1e-12);
}

TEST(Tessellate, LeavesTheShapeAlone) {
  const TopoDS_Shape block = test::sphere(1);
  tessellated(block, 0.01);
  TopLoc_Location location;
  const TopoDS_Face face = TopoDS::Face(TopExp_Explorer(block, TopAbs_FACE).Current());
  EXPECT_TRUE(BRep_Tool::Triangulation(face, location).IsNull());
}

TEST(Tessellate, SameInputSameBits) {
  const Tessellation a = tessellated(test::filletedBox(4, 0.5), 0.01);
  const Tessellation b = tessellated(test::filletedBox(4, 0.5), 0.01);
  EXPECT_EQ(a.mesh.points, b.mesh.points);
  EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
  EXPECT_EQ(a.mesh.edgeOf, b.mesh.edgeOf);
}

TEST(Tessellate, RefusesNonsense) {
  const Body body = test::solidBody(test::box(1, 1, 1));
  for (const double deflection : {0.0, -1.0, std::nan("")}) {
    const auto result = tessellate(body, {.deflection = deflection});
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::InvalidArgument);
  }
  EXPECT_FALSE(tessellate(Body{}, {.deflection = 0.1}));
}

// The polygons of the ring's two borders cross at this deflection.
TEST(Tessellate, RingNarrowerThanTheDeflectionLeavesNoHole) {
  constexpr double kOuter = 73;
  constexpr double kInner = kOuter - 0.0107;
  const TopoDS_Shape lower = test::cylinder(kOuter, 5);
  gp_Trsf up;
  up.SetRotation(gp::OZ(), 0.03);  // vertices and chords are not opposite to one another
  up.SetTranslationPart(gp_Vec(0, 0, 5));
  const TopoDS_Shape upper = test::transformed(test::cylinder(kInner, 5), up);
  const TopoDS_Shape both =
      TopExp_Explorer(BRepAlgoAPI_Fuse(lower, upper).Shape(), TopAbs_SOLID).Current();
  const Tessellation t = tessellated(both, 0.1);
  EXPECT_EQ(t.filledHoles, 0);
  EXPECT_LT(t.measuredDeflection, 0.2);
  double area = 0;
  for (const FaceFeature& face : t.features.faces) area += face.area;
  const double exact = 2 * kPi * kOuter * kOuter + 2 * kPi * (kOuter + kInner) * 5;
  EXPECT_NEAR(area, exact, 1e-3 * exact);
}

}  // namespace
}  // namespace phront::cad
