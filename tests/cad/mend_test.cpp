// Exact pieces of known offsets are spoilt, and mended again.
#include <gtest/gtest.h>

#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <cmath>
#include <memory>

#include "exchange/measures.h"
#include "judge/check_body.h"
#include "rebuild/cells.h"
#include "rebuild/exact_offset.h"
#include "rebuild/file_faults.h"
#include "rebuild/mend_stage.h"
#include "solids.h"
#include "tessellate/body_distance.h"

namespace phront::cad {
namespace {

struct Part {
  Body body;
  OffsetOptions options;
  std::shared_ptr<const TrueDistance> phi;
  std::optional<BodyCheck> check;
  std::vector<TopoDS_Face> pieces;
  double volume = 0;  ///< of the exact offset
};

Part offsetOf(const TopoDS_Shape& shape, double distance) {
  Part part;
  part.body = test::solidBody(shape);
  part.options.distance = distance;
  part.options.tolerance = 0.01 * std::abs(distance);
  part.options.threads = 1;
  Result<TrueDistance> phi = distanceOf(part.body, distance, 60);
  EXPECT_TRUE(phi) << phi.error().message;
  part.phi = std::make_shared<const TrueDistance>(std::move(*phi));
  Result<BodyCheck> check = BodyCheck::make(part.body, part.body, part.phi, distance, 60);
  EXPECT_TRUE(check) << check.error().message;
  part.check = std::move(*check);
  const auto exact = tryExactOffset(shape, true, distance, *part.phi, attemptSettings().front());
  EXPECT_TRUE(exact && exact->fault.empty());
  for (TopExp_Explorer it(exact->pieces, TopAbs_FACE); it.More(); it.Next())
    part.pieces.push_back(TopoDS::Face(it.Current()));
  part.volume = volumeOf(exact->shape);
  return part;
}

std::optional<JudgedAttempt> mend(const Part& part, const std::vector<TopoDS_Face>& pieces,
                                  std::vector<std::string>& log) {
  const BRep_Builder builder;
  TopoDS_Compound all;
  builder.MakeCompound(all);
  for (const TopoDS_Face& piece : pieces) builder.Add(all, piece);
  return mendPieces({{"plain", 1, all}}, "part", part.options, *part.phi, *part.check, Deadline(60),
                    {}, log);
}

TEST(MendPieces, PiecesThatAreGoneComeBackAsFacets) {
  const Part part = offsetOf(test::lShape(), 0.2);
  ASSERT_GT(part.pieces.size(), 12U);
  for (const std::size_t gone : {0, 5, 9}) {
    std::vector<TopoDS_Face> pieces = part.pieces;
    const auto first = pieces.begin() + static_cast<std::ptrdiff_t>(gone);
    pieces.erase(first, first + 3);
    std::vector<std::string> log;
    const auto mended = mend(part, pieces, log);
    ASSERT_EQ(log.size(), 1U);
    ASSERT_TRUE(mended) << log.front();
    EXPECT_TRUE(mended->file.check.pass());
    EXPECT_EQ(mended->setting, "plain");
    ASSERT_EQ(mended->bodies.size(), 1U);
    EXPECT_EQ(mended->bodies.front().name, "part");
    EXPECT_NEAR(mended->file.check.volume, part.volume, 0.005 * part.volume);
    EXPECT_GE(mended->file.check.faces - mended->facetedFaces,
              static_cast<int>(part.pieces.size()) - 3);
  }
}

TEST(MendPieces, NothingToMendIsNoResult) {
  const Part part = offsetOf(test::box(3, 2, 1), -0.2);
  std::vector<std::string> log;
  EXPECT_FALSE(mend(part, part.pieces, log));
  ASSERT_EQ(log.size(), 1U);
  EXPECT_NE(log.front().find("no hole"), std::string::npos) << log.front();
}

TEST(FaultsInFile, NamesTheFaceWhoseEdgesDoNotMeet) {
  std::vector<TopoDS_Face> faces;
  for (int i = 0; i < 3; ++i) {
    gp_Trsf away;
    away.SetTranslation(gp_Vec(10 * i, 0, 0));
    const TopoDS_Shape box = test::transformed(test::box(1, 1, 1), away);
    faces.push_back(TopoDS::Face(TopExp_Explorer(box, TopAbs_FACE).Current()));
  }
  const MeshSize size{0.01, 0.3};
  EXPECT_TRUE(faultsInFile(faces, 0.05, size).empty());
  const TopoDS_Vertex corner = TopoDS::Vertex(TopExp_Explorer(faces[1], TopAbs_VERTEX).Current());
  gp_Pnt off = BRep_Tool::Pnt(corner);
  off.Translate(gp_Vec(0.1, 0, 0));  // as the tolerance allows
  BRep_Builder().UpdateVertex(corner, off, 0.2);
  const std::vector<Vec3> faults = faultsInFile(faces, 0.05, size);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_NEAR(faults.front()[0], 10.5, 0.75);
}

}  // namespace
}  // namespace phront::cad
