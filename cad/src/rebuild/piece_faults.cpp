#include "rebuild/piece_faults.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepTools.hxx>
#include <GCPnts_AbscissaPoint.hxx>
#include <Geom2d_Curve.hxx>
#include <Precision.hxx>
#include <TopExp.hxx>
#include <algorithm>
#include <cmath>
#include <map>

#include "exchange/measures.h"
#include "judge/widest_gap.h"
#include "rebuild/edge_uses.h"
#include "rebuild/fuse.h"
#include "rebuild/select.h"

namespace phront::cad {
namespace {

constexpr double kOffLevel = 0.03;      // of |d|: pieces and edges further off are at fault
constexpr double kOpenOffLevel = 0.01;  // the same of edges at which facets will begin
constexpr double kPitch = 1;            // |d|, between samples of pieces
constexpr double kMeshSlack = 4;        // times the deflection: error of triangle distances
constexpr double kLargeArea = 30;       // d^2: pieces are cut around their faults
constexpr double kFrame = 1;            // |d|, so far away from them
constexpr int kEdgeSamples = 5;
constexpr int kRounds = 6;

Vec3 toVec(const gp_Pnt& p) { return {p.X(), p.Y(), p.Z()}; }

class PieceSorter {
 public:
  PieceSorter(std::vector<TopoDS_Face> pieces, double distance, const TrueDistance& phi)
      : pieces_(std::move(pieces)), distance_(distance), phi_(phi) {}

  std::optional<SortedPieces> run() {
    if (!removeFaulty()) return std::nullopt;
    return SortedPieces{std::move(pieces_), std::move(removed_)};
  }

 private:
  [[nodiscard]] double size() const { return std::abs(distance_); }
  [[nodiscard]] double offLevel(const gp_Pnt& p) const {
    return std::abs(phi_.signedDistance(toVec(p)) - distance_);
  }

  /// Parameters of points of a piece that are off the level.
  [[nodiscard]] std::vector<gp_Pnt2d> offLevel(const TopoDS_Face& piece) const {
    const BRepAdaptor_Surface surface(piece, Standard_False);
    const double sure = kOffLevel * size() - kMeshSlack * phi_.tessellation().measuredDeflection;
    std::vector<gp_Pnt2d> off;
    for (const gp_Pnt2d& uv : gridInside(piece, kPitch * size())) {
      const gp_Pnt p = surface.Value(uv.X(), uv.Y());
      // Mostly the triangles tell already.
      if (std::abs(phi_.surface().foot(toVec(p)).distance - size()) > sure &&
          offLevel(p) > kOffLevel * size())
        off.push_back(uv);
    }
    return off;
  }
  [[nodiscard]] bool leavesLevel(const TopoDS_Edge& edge, double limit) const {
    const BRepAdaptor_Curve curve(edge);
    for (int i = 0; i <= kEdgeSamples; ++i) {
      const double t = curve.FirstParameter() +
                       (curve.LastParameter() - curve.FirstParameter()) * i / kEdgeSamples;
      if (offLevel(curve.Value(t)) > limit * size()) return true;
    }
    return false;
  }

  /// Faults and the pieces that have them go, until there are none. Large pieces are cut around
  /// their faults first, so that they need not go as a whole.
  bool removeFaulty() {
    for (int round = 0; round < kRounds; ++round) {
      std::map<std::size_t, std::vector<gp_Pnt2d>> faults = faultsOf(round == 0);
      std::vector<TopoDS_Shape> cutters;
      for (const auto& [f, points] : faults) {
        if (areaOf(pieces_[f]) >= kLargeArea * size() * size())
          addFrames(pieces_[f], points, cutters);
      }
      if (!cutters.empty()) {
        const auto never = [](std::size_t, std::size_t) { return false; };
        Result<std::vector<TopoDS_Face>> cut = splitFaces(pieces_, 0, never, cutters);
        if (!cut) return false;
        pieces_ = std::move(*cut);
        // Where a frame ends inside a piece nothing is cut.
        for (TopoDS_Face& piece : pieces_) BRepTools::RemoveInternals(piece, Standard_True);
        faults = faultsOf(round == 0);
      }
      if (faults.empty()) return true;
      std::vector<TopoDS_Face> kept;
      for (std::size_t f = 0; f < pieces_.size(); ++f)
        (faults.contains(f) ? removed_ : kept).push_back(pieces_[f]);
      pieces_ = std::move(kept);
    }
    return true;
  }

  /// Pieces that are not valid or cannot be tessellated; those with points that are off the level,
  /// that lie on edges which are used too often or, open, leave the level, or on open edges that
  /// end where an odd number of them does.
  [[nodiscard]] std::map<std::size_t, std::vector<gp_Pnt2d>> faultsOf(bool inside) const {
    std::map<std::size_t, std::vector<gp_Pnt2d>> faults;
    for (std::size_t f = 0; inside && f < pieces_.size(); ++f) {
      std::vector<gp_Pnt2d> off = offLevel(pieces_[f]);
      for (const FaceGap& gap : gapsOf(pieces_[f], kOffLevel * size())) off.push_back(gap.onFace);
      if (!off.empty()) faults[f] = std::move(off);
    }
    for (std::size_t f = 0; f < pieces_.size(); ++f)
      if (!BRepCheck_Analyzer(pieces_[f]).IsValid() || !tessellates(pieces_[f], size()))
        faults.try_emplace(f);
    const EdgeUses uses(pieces_);
    std::map<const void*, int> openAt;
    for (std::size_t e = 0; e < uses.faces.size(); ++e) {
      if (uses.faces[e].size() != 1) continue;
      ++openAt[TopExp::FirstVertex(uses.edge(e)).TShape().get()];
      ++openAt[TopExp::LastVertex(uses.edge(e)).TShape().get()];
    }
    const auto odd = [&](const TopoDS_Vertex& v) {
      const auto it = openAt.find(v.TShape().get());
      return it != openAt.end() && it->second % 2 != 0;
    };
    for (std::size_t e = 0; e < uses.faces.size(); ++e) {
      const std::vector<std::size_t>& users = uses.faces[e];
      const TopoDS_Edge& edge = uses.edge(e);
      const bool open = users.size() == 1;
      const bool spur = users.size() == 2 && users[0] == users[1] &&
                        !BRep_Tool::IsClosed(edge, pieces_[users[0]]);
      const bool bad = users.size() > 2 || spur || (open && leavesLevel(edge, kOpenOffLevel)) ||
                       (inside && leavesLevel(edge, kOffLevel));
      const bool oddFirst = open && odd(TopExp::FirstVertex(edge));
      const bool oddLast = open && odd(TopExp::LastVertex(edge));
      if (!bad && !oddFirst && !oddLast) continue;
      for (const std::size_t f : users) {
        double first = 0;
        double last = 0;
        const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(edge, pieces_[f], first, last);
        std::vector<gp_Pnt2d>& points = faults[f];
        if (curve.IsNull()) continue;
        if (oddFirst) points.push_back(curve->Value(first));
        if (oddLast) points.push_back(curve->Value(last));
        if (!bad) continue;
        // Near enough to each other that their frames meet.
        const double length = GCPnts_AbscissaPoint::Length(BRepAdaptor_Curve(edge));
        const int count = kEdgeSamples + static_cast<int>(length / (kFrame * size()));
        for (int i = 0; i <= count; ++i)
          points.push_back(curve->Value(first + (last - first) * i / count));
      }
    }
    return faults;
  }

  /// Rectangles of parameter lines around the points, |d| away from them.
  void addFrames(const TopoDS_Face& piece, const std::vector<gp_Pnt2d>& points,
                 std::vector<TopoDS_Shape>& cutters) const {
    const Handle(Geom_Surface) surface = BRep_Tool::Surface(piece);
    double u0 = 0;
    double u1 = 0;
    double v0 = 0;
    double v1 = 0;
    BRepTools::UVBounds(piece, u0, u1, v0, v1);
    std::vector<Eigen::AlignedBox2d> frames;
    for (const gp_Pnt2d& uv : points) {
      gp_Pnt p;
      gp_Vec du;
      gp_Vec dv;
      surface->D1(uv.X(), uv.Y(), p, du, dv);
      const Eigen::Vector2d at(uv.X(), uv.Y());
      const Eigen::Vector2d reach(size() / std::max(du.Magnitude(), Precision::Confusion()),
                                  size() / std::max(dv.Magnitude(), Precision::Confusion()));
      Eigen::AlignedBox2d frame(at - kFrame * reach, at + kFrame * reach);
      // Those that meet become one.
      for (bool merged = true; merged;) {
        merged = false;
        for (std::size_t k = 0; k < frames.size(); ++k) {
          if (!frames[k].intersects(frame)) continue;
          frame.extend(frames[k]);
          frames.erase(frames.begin() + static_cast<std::ptrdiff_t>(k));
          merged = true;
          break;
        }
      }
      frames.push_back(frame);
    }
    const Eigen::AlignedBox2d all(Eigen::Vector2d(u0, v0), Eigen::Vector2d(u1, v1));
    for (const Eigen::AlignedBox2d& frame : frames) {
      const Eigen::AlignedBox2d part = frame.intersection(all);
      const auto add = [&](const Handle(Geom_Curve) & curve, double from, double to) {
        if (!(to > from)) return;
        BRepBuilderAPI_MakeEdge edge(curve, from, to);
        if (edge.IsDone()) cutters.push_back(edge.Edge());
      };
      for (const double u : {frame.min()[0], frame.max()[0]})
        if (u > u0 && u < u1) add(surface->UIso(u), part.min()[1], part.max()[1]);
      for (const double v : {frame.min()[1], frame.max()[1]})
        if (v > v0 && v < v1) add(surface->VIso(v), part.min()[0], part.max()[0]);
    }
  }

  std::vector<TopoDS_Face> pieces_, removed_;
  double distance_;
  const TrueDistance& phi_;
};

}  // namespace

std::optional<SortedPieces> removeFaultyPieces(std::vector<TopoDS_Face> pieces, double distance,
                                               const TrueDistance& phi) {
  return PieceSorter(std::move(pieces), distance, phi).run();
}

}  // namespace phront::cad
