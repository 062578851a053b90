#include "surfaces/piece_trim.h"

#include <BOPTools_AlgoTools3D.hxx>
#include <BRepTools.hxx>
#include <BRepTopAdaptor_FClass2d.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <IntTools_Context.hxx>
#include <Precision.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>

#include "surfaces/parameter_plane.h"
#include "tessellate/face_surface.h"

namespace phront::cad {
namespace {

constexpr double kCutShare = 0.4;     // nearer than |d| by this: cut off
constexpr double kMissedShare = 0.8;  // nearer by this: should have been cut off
constexpr double kClearShare = 0.1;   // nearer by less: certainly on the front
constexpr std::size_t kLeastClear = 6;
constexpr double kChordShare = 0.2;  // of the cut lines from the true ones
constexpr double kGridPitch = 2;     // |d| between samples inside
constexpr int kLeastGrid = 16;
constexpr int kMostGrid = 64;
constexpr double kBorderPitch = 0.5;  // |d| between samples on loops
constexpr int kLeastOnEdge = 8;
constexpr int kMostOnEdge = 200;
constexpr double kLongestStep = 1;  // |d|, of lines
constexpr int kInwardDoublings = 16;
constexpr double kMargin = 0.01;  // of the domain: how far lines run beyond it
constexpr double kMeshSlack = 4;  // times the measured deflection: error of triangle distances
constexpr int kLooks = 20;        // per direction, into a part that was cut out
constexpr int kMostRounds = 4;
constexpr int kLeastCells = 96;  // per direction, where lines cannot be followed
constexpr int kMostCells = 384;
constexpr int kMeasured = 14;  // per direction, of each trimmed surface

Vec2 vec2(const gp_Pnt2d& p) { return {p.X(), p.Y()}; }

/// One piece of the offset of a face, its clearance and where that is negative.
class PieceTrimmer {
 public:
  PieceTrimmer(const TopoDS_Face& face, const OffsetPiece& piece, const TrimRequest& request,
               const TrueDistance& phi)
      : face_(TopoDS::Face(face.Oriented(TopAbs_FORWARD))),
        inFace_(face_, Precision::PConfusion()),
        piece_(piece),
        solid_(request.solid),
        distance_(request.distance),
        tolerance_(request.tolerance),
        phi_(phi),
        plane_(scaleOf(piece)) {
    for (const FaceFeature& f : phi.tessellation().features.faces)
      meshSlack_ = std::max(meshSlack_, kMeshSlack * f.deflection);
    low_ = plane_.toPlane({piece.box.u.low, piece.box.v.low});
    high_ = plane_.toPlane({piece.box.u.high, piece.box.v.high});
  }

  /// Faces on the piece's surface, FORWARD. `cutAtBox`: the face reaches beyond the piece.
  Result<std::vector<TopoDS_Face>> trimmed(bool cutAtBox, bool& whole) {
    sampleInside(kLeastGrid);
    sampleLoops();
    if (valid_ == 0) sampleInside(kMostGrid);  // before it is said to be gone
    std::vector<TopoDS_Face> faces;
    if (valid_ == 0) return faces;
    const Result<TopoDS_Face> domain = plane_.domainOf(face_);
    if (!domain) return tl::unexpected(domain.error());
    std::vector<TopoDS_Face> kept;
    std::vector<Contour> lines;
    int cells = 0;  // none while lines are followed
    for (int round = 0; cells < kMostCells; ++round) {
      const std::size_t before = lines.size();
      if (cells == 0) traceContours(clearance_, seeds_, lineOptions(), lines);
      // Where nothing is gained by following lines, the measure is at odds with itself or they are
      // too many: cells do, and smaller ones where those see too little.
      if (cells > 0 || (round > 0 && lines.size() == before) || round + 1 == kMostRounds) {
        cells = std::max(kLeastCells, 2 * cells);
        lines = gridContours(clearance_, lineOptions(), cells);
      }
      std::vector<TopoDS_Edge> edges = ParameterPlane::edgesAlong(lines, chord());
      if (cutAtBox) addBox(edges);
      const Result<std::vector<TopoDS_Face>> parts = ParameterPlane::split(*domain, edges);
      if (!parts) return tl::unexpected(parts.error());
      kept.clear();
      seeds_.clear();
      for (const TopoDS_Face& part : *parts)
        if (alive(part)) kept.push_back(part);
      if (seeds_.empty()) break;
    }
    whole = lines.empty() && !cutAtBox;
    for (const TopoDS_Face& part : kept) {
      const Result<TopoDS_Face> face = plane_.onSurface(part, piece_.surface, chord());
      if (!face) return tl::unexpected(face.error());
      faces.push_back(*face);
    }
    return faces;
  }

  /// Largest | |phi| - |d| | of samples of a trimmed face.
  [[nodiscard]] double deviation(const TopoDS_Face& face) const {
    const BRepTopAdaptor_FClass2d inside(face, Precision::PConfusion());
    double u0 = 0;
    double u1 = 0;
    double v0 = 0;
    double v1 = 0;
    BRepTools::UVBounds(face, u0, u1, v0, v1);
    double most = 0;
    for (int i = 0; i < kMeasured; ++i) {
      for (int j = 0; j < kMeasured; ++j) {
        const double u = u0 + (u1 - u0) * (i + 0.5) / kMeasured;
        const double v = v0 + (v1 - v0) * (j + 0.5) / kMeasured;
        if (inside.Perform(gp_Pnt2d(u, v)) != TopAbs_IN) continue;
        most = std::max(most, std::abs(level(plane_.toPlane({u, v})) - std::abs(distance_)));
      }
    }
    return most;
  }

 private:
  static ParameterPlane scaleOf(const OffsetPiece& piece) {
    // Typical lengths, that the plane resembles the surface.
    double u = 0;
    double v = 0;
    constexpr int kSamples = 5;
    for (int i = 0; i < kSamples; ++i) {
      for (int j = 0; j < kSamples; ++j) {
        const auto at = [&](const Interval& t, int k) {
          return t.low + (t.high - t.low) * (k + 0.5) / kSamples;
        };
        gp_Pnt p;
        gp_Vec du;
        gp_Vec dv;
        piece.surface->D1(at(piece.box.u, i), at(piece.box.v, j), p, du, dv);
        u = std::max(u, du.Magnitude());
        v = std::max(v, dv.Magnitude());
      }
    }
    return {u > 0 ? u : 1, v > 0 ? v : 1};
  }

  [[nodiscard]] double chord() const { return kChordShare * tolerance_; }

  [[nodiscard]] Vec3 pointAt(const Vec2& x) const {
    const Vec2 uv = plane_.fromPlane(x);
    return toVec3(piece_.surface->Value(uv[0], uv[1]).XYZ());
  }

  /// Distance from the shape on the side where the offset belongs.
  [[nodiscard]] double level(const Vec2& x) const {
    const TrueDistance::Foot foot = phi_.foot(pointAt(x));
    return solid_ ? std::copysign(1, distance_) * foot.sign * foot.distance : foot.distance;
  }

  [[nodiscard]] Clearance clearance(const Vec2& x) const {
    const Vec2 uv = plane_.fromPlane(x);
    gp_Pnt p;
    gp_Vec du;
    gp_Vec dv;
    piece_.surface->D1(uv[0], uv[1], p, du, dv);
    const Vec3 q = toVec3(p.XYZ());
    const TrueDistance::Foot foot = phi_.foot(q);
    const double side = solid_ ? std::copysign(1, distance_) * foot.sign : 1;
    const Vec3 up = side * (q - foot.point).normalized();
    return {side * foot.distance - std::abs(distance_) + kCutShare * tolerance_,
            {up.dot(toVec3(du.XYZ())) / plane_.scale()[0],
             up.dot(toVec3(dv.XYZ())) / plane_.scale()[1]}};
  }
  [[nodiscard]] bool valid(const Vec2& x) const {
    const double least = std::abs(distance_) - kCutShare * tolerance_;
    // Mostly the triangles tell already.
    if (phi_.surface().foot(pointAt(x)).distance + meshSlack_ < least) return false;
    return level(x) >= least;
  }
  [[nodiscard]] bool inFace(const Vec2& x) {
    const Vec2 uv = plane_.fromPlane(x);
    const TopAbs_State state = inFace_.Perform(gp_Pnt2d(uv[0], uv[1]));
    return state == TopAbs_IN || state == TopAbs_ON;
  }
  [[nodiscard]] bool inBox(const Vec2& x) const {
    return (x.array() >= low_.array()).all() && (x.array() <= high_.array()).all();
  }

  [[nodiscard]] int cellsFor(double length, int least) const {
    return static_cast<int>(
        std::clamp(length / (kGridPitch * std::abs(distance_)), double(least), double(kMostGrid)));
  }

  void sampleInside(int least) {
    const int nu = cellsFor(high_[0] - low_[0], least);
    const int nv = cellsFor(high_[1] - low_[1], least);
    struct Node {
      Vec2 at;
      bool inside = false, valid = false;
    };
    std::vector<Node> nodes;
    for (int j = 0; j < nv; ++j) {
      for (int i = 0; i < nu; ++i) {
        const Vec2 share((i + 0.5) / nu, (j + 0.5) / nv);
        Node node{low_ + share.cwiseProduct(high_ - low_)};
        node.inside = inFace(node.at);
        node.valid = valid(node.at);
        if (node.inside && node.valid) ++valid_;
        nodes.push_back(node);
      }
    }
    const auto look = [&](const Node& a, const Node& b) {
      if (a.valid == b.valid || (!a.inside && !b.inside)) return;
      seeds_.push_back(a.valid ? ContourSeed{b.at, a.at} : ContourSeed{a.at, b.at});
    };
    for (int j = 0; j < nv; ++j) {
      for (int i = 0; i < nu; ++i) {
        const Node& here = nodes[static_cast<std::size_t>(i + j * nu)];
        if (i > 0) look(nodes[static_cast<std::size_t>(i - 1 + j * nu)], here);
        if (j > 0) look(nodes[static_cast<std::size_t>(i + (j - 1) * nu)], here);
      }
    }
  }

  /// Fronts of neighbours cut a face off along its edges first.
  void sampleLoops() {
    for (TopExp_Explorer it(face_, TopAbs_EDGE); it.More(); it.Next()) {
      const TopoDS_Edge& edge = TopoDS::Edge(it.Current());
      double first = 0;
      double last = 0;
      const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(edge, face_, first, last);
      if (curve.IsNull()) continue;
      const auto at = [&](double share) {
        return plane_.toPlane(vec2(curve->Value(first + share * (last - first))));
      };
      double length = 0;
      for (int i = 0; i < kLeastOnEdge; ++i)
        length += (at(double(i + 1) / kLeastOnEdge) - at(double(i) / kLeastOnEdge)).norm();
      const int count = static_cast<int>(std::clamp(length / (kBorderPitch * std::abs(distance_)),
                                                    double(kLeastOnEdge), double(kMostOnEdge)));
      struct Sample {
        Vec2 at = Vec2::Zero();
        bool here = false, valid = false;
      };
      std::vector<Sample> samples;
      for (int i = 0; i <= count; ++i) {
        Sample sample{at(double(i) / count)};
        sample.here = inBox(sample.at);
        sample.valid = sample.here && valid(sample.at);
        samples.push_back(sample);
      }
      const double forward = edge.Orientation() == TopAbs_REVERSED ? -1 : 1;
      for (std::size_t i = 0; i < samples.size(); ++i) {
        const Sample& sample = samples[i];
        if (!sample.here) continue;
        if (i > 0 && samples[i - 1].here && sample.valid != samples[i - 1].valid)
          seeds_.push_back(sample.valid ? ContourSeed{samples[i - 1].at, sample.at}
                                        : ContourSeed{sample.at, samples[i - 1].at});
        if (sample.valid) continue;
        const std::size_t last = std::min(i + 1, samples.size() - 1);
        const Vec2 along = forward * (samples[last].at - samples[i > 0 ? i - 1 : 0].at);
        if (along.norm() > 0) seedInwards(sample.at, Vec2(-along[1], along[0]).normalized());
      }
    }
  }

  /// From an invalid point of a loop to the first valid one inside.
  void seedInwards(const Vec2& x, const Vec2& inward) {
    Vec2 last = x;
    double step = chord();
    const double reach = (high_ - low_).norm();
    for (int k = 0; k < kInwardDoublings && step < reach; ++k, step *= 2) {
      const Vec2 next = x + step * inward;
      // Near a curved loop the classifier, which goes by polygons, may err.
      if (!inFace(next)) continue;
      if (valid(next)) {
        ++valid_;
        seeds_.push_back({last, next});
        return;
      }
      last = next;
    }
  }

  [[nodiscard]] ContourOptions lineOptions() const {
    ContourOptions options;
    const Vec2 margin = kMargin * (high_ - low_);
    options.low = low_ - margin;
    options.high = high_ + margin;
    options.chord = chord();
    options.longestStep = kLongestStep * std::abs(distance_);
    return options;
  }

  void addBox(std::vector<TopoDS_Edge>& edges) const {
    const Vec2 margin = kMargin * (high_ - low_);
    const ParameterBox& b = piece_.box;
    const Vec2 extra = plane_.fromPlane(margin);
    for (const double u : {b.u.low, b.u.high})
      edges.push_back(plane_.edgeBetween({u, b.v.low - extra[1]}, {u, b.v.high + extra[1]}));
    for (const double v : {b.v.low, b.v.high})
      edges.push_back(plane_.edgeBetween({b.u.low - extra[0], v}, {b.u.high + extra[0], v}));
  }

  /// Whether most points inside a part of the domain are valid, and in this piece. Those that
  /// clearly are otherwise give seeds for more lines.
  [[nodiscard]] bool alive(const TopoDS_Face& part) {
    std::vector<Vec2> clear;   // certainly valid
    std::vector<Vec2> missed;  // certainly not
    int good = 0;
    int bad = 0;
    const auto look = [&](const Vec2& x) {
      const double lack = std::abs(distance_) - level(x);
      (inBox(x) && lack <= kCutShare * tolerance_ ? good : bad) += 1;
      if (inBox(x) && lack <= kClearShare * tolerance_) clear.push_back(x);
      if (inBox(x) && lack > kMissedShare * tolerance_) missed.push_back(x);
    };
    const Handle(IntTools_Context) context = new IntTools_Context;
    gp_Pnt p;
    gp_Pnt2d uv;
    if (BOPTools_AlgoTools3D::PointInFace(part, p, uv, context) == 0) look({p.X(), p.Y()});
    double u0 = 0;
    double u1 = 0;
    double v0 = 0;
    double v1 = 0;
    BRepTools::UVBounds(part, u0, u1, v0, v1);
    const BRepTopAdaptor_FClass2d inside(part, Precision::PConfusion());
    const int nu = cellsFor(u1 - u0, kLooks);
    const int nv = cellsFor(v1 - v0, kLooks);
    for (int i = 0; i < nu; ++i) {
      for (int j = 0; j < nv; ++j) {
        const Vec2 x(u0 + (u1 - u0) * (i + 0.5) / nu, v0 + (v1 - v0) * (j + 0.5) / nv);
        if (inside.Perform(gp_Pnt2d(x[0], x[1])) == TopAbs_IN) look(x);
      }
    }
    const bool kept = good > bad;
    // Few valid points of a part that goes lie beside its border.
    if (kept || clear.size() >= kLeastClear) seedBetween(clear, missed);
    return kept;
  }

  void seedBetween(const std::vector<Vec2>& with, const std::vector<Vec2>& without) {
    const bool fewerWith = with.size() < without.size();
    const std::vector<Vec2>& few = fewerWith ? with : without;
    const std::vector<Vec2>& many = fewerWith ? without : with;
    for (const Vec2& x : few) {
      const auto nearest =
          std::min_element(many.begin(), many.end(), [&](const Vec2& a, const Vec2& b) {
            return (a - x).squaredNorm() < (b - x).squaredNorm();
          });
      seeds_.push_back(fewerWith ? ContourSeed{*nearest, x} : ContourSeed{x, *nearest});
    }
  }

  TopoDS_Face face_;
  BRepTopAdaptor_FClass2d inFace_;
  const OffsetPiece& piece_;
  bool solid_;
  double distance_;
  double tolerance_;
  const TrueDistance& phi_;
  ParameterPlane plane_;
  ClearanceAt clearance_ = [this](const Vec2& x) { return clearance(x); };
  Vec2 low_, high_;
  double meshSlack_ = 0;
  std::vector<ContourSeed> seeds_;
  int valid_ = 0;
};

}  // namespace

Result<TrimmedPiece> trimPiece(const TopoDS_Face& face, const OffsetPiece& piece, bool cutAtBox,
                               const TrimRequest& request, const TrueDistance& phi) {
  PieceTrimmer trimmer(face, piece, request, phi);
  TrimmedPiece result;
  Result<std::vector<TopoDS_Face>> faces = trimmer.trimmed(cutAtBox, result.whole);
  if (!faces) return tl::unexpected(faces.error());
  result.faces = std::move(*faces);
  for (const TopoDS_Face& trimmed : result.faces)
    result.deviation = std::max(result.deviation, trimmer.deviation(trimmed));
  return result;
}

}  // namespace phront::cad
