#include "move/extended_faces.h"

#include <fmt/format.h>

#include <BRepAdaptor_Surface.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepLProp_SLProps.hxx>
#include <BRepLib.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom_OffsetSurface.hxx>
#include <Precision.hxx>
#include <TopExp.hxx>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "move/reaching_face.h"
#include "patches/patch_tools.h"

namespace phront::cad {
namespace {

constexpr int kEdgeSamples = 24;
constexpr double kBeyond = 1.5;  // of the way to where surfaces meet

class FaceExtender {
 public:
  FaceExtender(const EdgeTable& table, const GroupMove& move, double tolerance)
      : table_(table),
        move_(move),
        moved_(move.faces.begin(), move.faces.end()),
        tolerance_(tolerance) {}

  Result<std::vector<ExtendedFace>> run() {
    if (Result<void> found = collectBeyond(); !found) return tl::unexpected(found.error());
    if (Result<void> made = makeFaces(); !made) return tl::unexpected(made.error());
    return std::move(extended_);
  }

 private:
  /// Where the moved faces and their neighbours must reach, by face.
  Result<void> collectBeyond() {
    for (const EdgeInfo& edge : table_.edges) {
      const bool first = moved_.count(edge.face1) > 0;
      const bool second = moved_.count(edge.face2) > 0;
      if (first == second || edge.face2 < 0) continue;
      const int face = first ? edge.face1 : edge.face2;
      const int neighbour = first ? edge.face2 : edge.face1;
      for (const EdgeSample& s : edge.samples) {
        const double sine = s.n1.Crossed(s.n2).Magnitude();
        if (sine < kSmoothNeighbours) {
          if (Result<void> met = meetSmooth(face, neighbour, s.point, first ? s.n1 : s.n2); !met)
            return met;
          continue;
        }
        const double length = kBeyond * std::abs(move_.distance) / sine;
        const gp_Vec& up = first ? s.n1 : s.n2;
        const gp_Vec& aside = first ? s.n2 : s.n1;
        const double away = s.angle > 0 ? 1 : -1;
        beyond_[face].push_back(
            s.point.Translated(move_.distance * up + length * along(up, s.tangent, away * aside)));
        // Elsewhere the neighbour is there already.
        if (away * move_.distance < 0) continue;
        const gp_Vec across = length * along(aside, s.tangent, away * up);
        beyond_[neighbour].push_back(s.point.Translated(across));
        // Neighbours that lean may have to be wider there.
        const bool atStart = &s == &edge.samples.front();
        if ((atStart || &s == &edge.samples.back()) && !goesOnSmoothly(neighbour, edge, atStart))
          beyond_[neighbour].push_back(
              s.point.Translated(across + (atStart ? -length : length) * s.tangent));
      }
    }
    return {};
  }

  /// A plane may move to the side that a smooth neighbour bends to, and cut it.
  Result<void> meetSmooth(int face, int neighbour, const gp_Pnt& point, const gp_Vec& normal) {
    const TopoDS_Face& plane = table_.faces[static_cast<std::size_t>(face)];
    double bend = 0;
    for (const gp_Pnt& p : outlineOf(table_.faces[static_cast<std::size_t>(neighbour)])) {
      const double height = gp_Vec(point, p).Dot(normal);
      if (std::abs(height) > std::abs(bend)) bend = height;
      beyond_[face].push_back(p.Translated((move_.distance - height) * normal));
    }
    if (BRepAdaptor_Surface(plane).GetType() == GeomAbs_Plane && std::abs(bend) > tolerance_ &&
        bend * move_.distance > 0)
      return {};
    return cannotMove(move_,
                      fmt::format("face F{} goes on smoothly into F{}; give both the same distance",
                                  move_.numberOf(face), move_.numberOf(neighbour)));
  }

  /// Whether the face has a smooth edge at an end of this one.
  [[nodiscard]] bool goesOnSmoothly(int face, const EdgeInfo& at, bool atStart) const {
    const TopoDS_Vertex vertex =
        atStart ? TopExp::FirstVertex(at.edge) : TopExp::LastVertex(at.edge);
    return std::any_of(table_.edges.begin(), table_.edges.end(), [&](const EdgeInfo& other) {
      return other.smooth && (other.face1 == face || other.face2 == face) &&
             (TopExp::FirstVertex(other.edge).IsSame(vertex) ||
              TopExp::LastVertex(other.edge).IsSame(vertex));
    });
  }

  /// Unit, tangent to the face with this normal and across the edge, towards `side`.
  static gp_Vec along(const gp_Vec& normal, const gp_Vec& tangent, const gp_Vec& side) {
    const gp_Vec across = normal.Crossed(tangent).Normalized();
    return across.Dot(side) > 0 ? across : across.Reversed();
  }

  Result<void> makeFaces() {
    for (const int index : move_.faces) {
      const TopoDS_Face& face = table_.faces[static_cast<std::size_t>(index)];
      if (BRepAdaptor_Surface(face).GetType() > GeomAbs_Torus)
        return cannotMove(move_,
                          "only planes, cylinders, cones, spheres and tori can be moved alone");
      const Handle(Geom_OffsetSurface) offset =
          new Geom_OffsetSurface(BRep_Tool::Surface(face), sideOf(face) * move_.distance);
      const Handle(Geom_Surface) surface = offset->Surface();
      std::vector<gp_Pnt> outline;
      if (!surface.IsNull()) outline = movedOutline(face);
      if (outline.empty()) return cannotMove(move_, "its radius is no larger than that");
      extended_.push_back({reachingFace(surface, face, outline, beyond_[index]), index});
    }
    for (const auto& [index, points] : beyond_) {
      if (moved_.count(index) > 0) continue;
      const TopoDS_Face& face = table_.faces[static_cast<std::size_t>(index)];
      TopoDS_Face reaching = reachingFace(BRep_Tool::Surface(face), face, outlineOf(face), points);
      if (reaching.IsNull()) {  // freeform
        double farthest = 0;
        for (const gp_Pnt& p : points) farthest = std::max(farthest, distanceTo(face, p));
        BRepLib::ExtendFace(face, farthest, true, true, true, true, reaching);
      }
      extended_.push_back({reaching, index});
    }
    for (const ExtendedFace& made : extended_) {
      if (made.face.IsNull())
        return cannotMove(move_,
                          fmt::format("face F{} cannot be extended", move_.numberOf(made.origin)));
    }
    return {};
  }

  /// Empty when the face would move beyond its axis, apex or centre.
  [[nodiscard]] std::vector<gp_Pnt> movedOutline(const TopoDS_Face& face) const {
    const double along = sideOf(face) * move_.distance;
    std::vector<gp_Pnt> points;
    const BRepAdaptor_Surface surface(face);
    BRepLProp_SLProps at(surface, 2, Precision::Confusion());
    for (const TopoDS_Edge& edge : edgesOf(face)) {
      double first = 0;
      double last = 0;
      const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
      if (curve.IsNull()) continue;
      for (int i = 0; i <= kEdgeSamples; ++i) {
        const double share = static_cast<double>(i) / kEdgeSamples;
        const gp_Pnt2d uv = curve->Value(std::lerp(first, last, share));
        at.SetParameters(uv.X(), uv.Y());
        if (!at.IsNormalDefined()) continue;
        points.push_back(at.Value().Translated(along * gp_Vec(at.Normal())));
        if (!at.IsCurvatureDefined()) continue;
        if (1 - along * at.MaxCurvature() <= 0 || 1 - along * at.MinCurvature() <= 0) return {};
      }
    }
    return points;
  }

  /// Of the outward normal against the surface's own.
  static double sideOf(const TopoDS_Face& face) {
    return face.Orientation() == TopAbs_REVERSED ? -1 : 1;
  }

  const EdgeTable& table_;
  const GroupMove& move_;
  std::set<int> moved_;
  double tolerance_;
  std::map<int, std::vector<gp_Pnt>> beyond_;  ///< points to be reached, by face
  std::vector<ExtendedFace> extended_;
};

}  // namespace

Result<std::vector<ExtendedFace>> extendedFaces(const EdgeTable& table, const GroupMove& move,
                                                double tolerance) {
  return FaceExtender(table, move, tolerance).run();
}

double distanceTo(const TopoDS_Shape& shape, const gp_Pnt& point) {
  const BRepExtrema_DistShapeShape distance(BRepBuilderAPI_MakeVertex(point).Vertex(), shape);
  return distance.IsDone() ? distance.Value() : Precision::Infinite();
}

tl::unexpected<Error> cannotMove(const GroupMove& move, const std::string& why) {
  return fail(ErrorCode::NotSupported,
              fmt::format("face F{} cannot be moved by {:g} mm: {}",
                          move.numberOf(move.faces.front()), move.distance, why));
}

}  // namespace phront::cad
