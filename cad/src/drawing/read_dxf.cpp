// DXF by dxflib, which calls back for each entity. Curves of blocks are kept apart and placed where
// the block is inserted. Splines are evaluated by OpenCASCADE.
#include <dxflib/dl_creationadapter.h>
#include <dxflib/dl_dxf.h>
#include <fmt/format.h>

#include <GCPnts_QuasiUniformDeflection.hxx>
#include <GeomAdaptor_Curve.hxx>
#include <Geom_BSplineCurve.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <sstream>

#include "drawing/readers.h"

namespace phront::cad {
namespace {

constexpr double kAutomaticTolerance = 1e-5;  // of the drawing's diagonal
constexpr int kDeepest = 16;                  // blocks in blocks
constexpr std::size_t kMostChains = 2'000'000;
constexpr double kDegree = std::numbers::pi / 180;

/// Flattened when the tolerance is known: the size of the drawing is not before its end.
using Curve = std::function<Chain(double tolerance)>;

struct Insert {
  std::string block;
  Eigen::Affine2d place = Eigen::Affine2d::Identity();
};

struct Block {
  Vec2 base = Vec2::Zero();
  std::vector<Curve> curves;
  std::vector<Insert> inserts;
};

double millimetres(int unit) {
  switch (unit) {
    case 1:
      return 25.4;
    case 2:
      return 304.8;
    case 5:
      return 10;
    case 6:
      return 1000;
    case 8:
      return 25.4e-6;
    case 9:
      return 25.4e-3;
    case 10:
      return 914.4;
    case 13:
      return 1e-3;
    case 14:
      return 100;
    default:
      return 1;
  }
}

class DxfReader : public DL_CreationAdapter {
 public:
  void setVariableInt(const std::string& name, int value, int /*code*/) override {
    if (name == "$INSUNITS") {
      unitKnown_ = value != 0;
      unit_ = millimetres(value);
    }
  }

  void addBlock(const DL_BlockData& data) override {
    block_ = data.name;
    blocks_[block_].base = Vec2(data.bpx, data.bpy);
  }
  void endBlock() override { block_.clear(); }

  void addLine(const DL_LineData& l) override {
    flush();
    if (paper()) return;
    add({{{l.x1, l.y1}, {l.x2, l.y2}}, false});
  }
  void addArc(const DL_ArcData& a) override {
    flush();
    if (paper()) return;
    double to = a.angle2;
    if (to <= a.angle1) to += 360;
    addEllipse(Vec2(a.cx, a.cy), Vec2(a.radius, 0), Vec2(0, a.radius), a.angle1 * kDegree,
               to * kDegree);
  }
  void addCircle(const DL_CircleData& c) override {
    flush();
    if (paper()) return;
    addEllipse(Vec2(c.cx, c.cy), Vec2(c.radius, 0), Vec2(0, c.radius), 0, 2 * std::numbers::pi);
  }
  void addEllipse(const DL_EllipseData& e) override {
    flush();
    if (paper()) return;
    const Vec2 major(e.mx, e.my);
    double to = e.angle2;
    if (to <= e.angle1) to += 2 * std::numbers::pi;
    addEllipse(Vec2(e.cx, e.cy), major, e.ratio * Vec2(-major.y(), major.x()), e.angle1, to);
  }

  void addPolyline(const DL_PolylineData& p) override {
    flush();
    polyline_.emplace();
    polyline_->closed = (p.flags & 1) != 0;
    polyline_->skip = paper();
    polyline_->mirror = mirrored();
  }
  void addVertex(const DL_VertexData& v) override {
    if (polyline_) polyline_->vertices.push_back({Vec2(v.x, v.y), v.bulge});
  }

  void addSpline(const DL_SplineData& s) override {
    flush();
    spline_.emplace();
    spline_->degree = static_cast<int>(s.degree);
    spline_->closed = (s.flags & 1) != 0;
    spline_->skip = paper();
  }
  void addControlPoint(const DL_ControlPointData& p) override {
    if (spline_) spline_->poles.push_back({gp_Pnt(p.x, p.y, 0), p.w > 0 ? p.w : 1});
  }
  void addKnot(const DL_KnotData& k) override {
    if (spline_) spline_->knots.push_back(k.k);
  }
  void addFitPoint(const DL_FitPointData& p) override {
    if (spline_) spline_->fit.emplace_back(p.x, p.y);
  }

  void addInsert(const DL_InsertData& i) override {
    flush();
    if (paper()) return;
    const int columns = std::clamp(i.cols, 1, 1000);
    const int rows = std::clamp(i.rows, 1, 1000);
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < columns; ++c) {
        Insert insert;
        insert.block = i.name;
        if (mirrored()) insert.place.scale(Vec2(-1, 1));
        insert.place.translate(Vec2(i.ipx, i.ipy))
            .rotate(i.angle * kDegree)
            .translate(Vec2(c * i.colSp, r * i.rowSp))
            .scale(Vec2(i.sx == 0 ? 1 : i.sx, i.sy == 0 ? 1 : i.sy));
        blocks_[block_].inserts.push_back(insert);
      }
    }
  }
  void addText(const DL_TextData& /*text*/) override { left_.insert("TEXT"); }
  void addMText(const DL_MTextData& /*text*/) override { left_.insert("MTEXT"); }
  void addHatch(const DL_HatchData& /*hatch*/) override { left_.insert("HATCH"); }
  void endSequence() override { flush(); }

  Result<RawDrawing> result(double tolerance) {
    flush();
    RawDrawing raw;
    raw.unitInMm = unit_;
    if (!unitKnown_) {
      raw.warnings.emplace_back("the DXF names no unit ($INSUNITS): its lengths are taken for mm");
    }
    for (const std::string& name : left_) {
      raw.warnings.push_back(fmt::format("{} entities are left out: only curves count", name));
    }
    if (!(tolerance > 0)) tolerance = kAutomaticTolerance * sizeInMm();
    if (Result<void> placed =
            place("", Eigen::Affine2d(Eigen::Scaling(unit_, unit_)), tolerance, 0, raw.chains);
        !placed) {
      return tl::unexpected(placed.error());
    }
    return raw;
  }

 private:
  struct Vertex {
    Vec2 point;
    double bulge;
  };
  struct Polyline {
    std::vector<Vertex> vertices;
    bool closed = false;
    bool skip = false;
    bool mirror = false;
  };
  struct Spline {
    int degree = 3;
    bool closed = false;
    bool skip = false;
    std::vector<std::pair<gp_Pnt, double>> poles;
    std::vector<double> knots;
    std::vector<Vec2> fit;
  };

  [[nodiscard]] bool paper() const { return attributes.isInPaperSpace(); }
  /// Drawn in a plane seen from behind: x runs the other way.
  [[nodiscard]] bool mirrored() const {
    return extrusion != nullptr && extrusion->getDirection()[2] < 0;
  }

  void add(Chain chain) {
    blocks_[block_].curves.emplace_back([chain = std::move(chain)](double) { return chain; });
  }

  void addEllipse(Vec2 centre, Vec2 x, Vec2 y, double from, double to) {
    if (mirrored()) {
      for (Vec2* v : {&centre, &x, &y}) v->x() = -v->x();
    }
    if (!(x.norm() > 0) || !(y.norm() > 0)) return;
    blocks_[block_].curves.emplace_back([=](double tolerance) {
      Chain chain;
      chain.points = ellipseArc(centre, x, y, from, to, tolerance);
      return chain;
    });
  }

  void flush() {
    if (polyline_) {
      Polyline line = std::move(*polyline_);
      polyline_.reset();
      if (!line.skip && line.vertices.size() > 1) {
        blocks_[block_].curves.emplace_back(
            [line = std::move(line)](double tolerance) { return flattened(line, tolerance); });
      }
    }
    if (spline_) {
      Spline spline = std::move(*spline_);
      spline_.reset();
      if (!spline.skip) addFlushed(std::move(spline));
    }
  }

  void addFlushed(Spline spline) {
    const std::size_t order = static_cast<std::size_t>(std::max(spline.degree, 1)) + 1;
    if (spline.poles.size() >= order && spline.knots.size() == spline.poles.size() + order) {
      blocks_[block_].curves.emplace_back(
          [spline = std::move(spline)](double tolerance) { return flattened(spline, tolerance); });
    } else if (spline.fit.size() > 1) {
      left_.insert("SPLINE (fit points only)");
    }
  }

  /// A bulge is the tangent of a quarter of the arc's angle, positive counter-clockwise.
  static Chain flattened(const Polyline& line, double tolerance) {
    Chain chain;
    chain.closed = line.closed;
    const std::size_t count = line.vertices.size();
    for (std::size_t i = 0; i < count; ++i) {
      const Vertex& v = line.vertices[i];
      chain.points.push_back(v.point);
      const bool last = i + 1 == count;
      if (v.bulge == 0 || (last && !line.closed)) continue;
      const Vec2 to = line.vertices[(i + 1) % count].point;
      const Vec2 chord = to - v.point;
      const double angle = 4 * std::atan(v.bulge);
      const Vec2 left(-chord.y(), chord.x());
      const Vec2 centre = 0.5 * (v.point + to) + left * (0.5 / std::tan(0.5 * angle));
      const Vec2 x = v.point - centre;
      const std::vector<Vec2> arc = ellipseArc(centre, x, Vec2(-x.y(), x.x()), 0, angle, tolerance);
      chain.points.insert(chain.points.end(), arc.begin() + 1, arc.end() - 1);
    }
    if (line.mirror) {
      for (Vec2& p : chain.points) p.x() = -p.x();
    }
    return chain;
  }

  static Chain flattened(const Spline& spline, double tolerance) {
    TColgp_Array1OfPnt poles(1, static_cast<int>(spline.poles.size()));
    TColStd_Array1OfReal weights(1, poles.Upper());
    for (int i = 1; i <= poles.Upper(); ++i) {
      poles(i) = spline.poles[static_cast<std::size_t>(i - 1)].first;
      weights(i) = spline.poles[static_cast<std::size_t>(i - 1)].second;
    }
    std::vector<std::pair<double, int>> knots;
    for (const double k : spline.knots) {
      if (!knots.empty() && k - knots.back().first < 1e-12) {
        ++knots.back().second;
      } else {
        knots.emplace_back(k, 1);
      }
    }
    TColStd_Array1OfReal values(1, static_cast<int>(knots.size()));
    TColStd_Array1OfInteger multiplicities(1, values.Upper());
    for (int i = 1; i <= values.Upper(); ++i) {
      values(i) = knots[static_cast<std::size_t>(i - 1)].first;
      const bool end = i == 1 || i == values.Upper();
      multiplicities(i) =
          std::min(knots[static_cast<std::size_t>(i - 1)].second, spline.degree + (end ? 1 : 0));
    }
    const Handle(Geom_BSplineCurve) curve =
        new Geom_BSplineCurve(poles, weights, values, multiplicities, spline.degree);
    const GCPnts_QuasiUniformDeflection points(GeomAdaptor_Curve(curve), tolerance);
    Chain chain;
    for (int i = 1; points.IsDone() && i <= points.NbPoints(); ++i) {
      chain.points.emplace_back(points.Value(i).X(), points.Value(i).Y());
    }
    return chain;
  }

  /// Roughly: of all curves of all blocks, where they are drawn.
  [[nodiscard]] double sizeInMm() const {
    Eigen::AlignedBox2d box;
    for (const auto& [name, block] : blocks_) {
      for (const Curve& curve : block.curves) {
        for (const Vec2& p : curve(1e300).points) box.extend(p);
      }
    }
    return box.isEmpty() ? 1 : std::max(unit_ * box.diagonal().norm(), 1e-9);
  }

  Result<void> place(const std::string& name, const Eigen::Affine2d& at, double tolerance,
                     int depth, std::vector<Chain>& chains) const {
    const auto found = blocks_.find(name);
    if (found == blocks_.end()) return {};
    if (depth > kDeepest) {
      return fail(ErrorCode::UnreadableInput,
                  "Blocks of the DXF are nested too deeply, or in "
                  "themselves.");
    }
    const Block& block = found->second;
    const double scale = std::max(at.linear().norm(), 1e-300);
    for (const Curve& curve : block.curves) {
      Chain chain = curve(tolerance / scale);
      for (Vec2& p : chain.points) p = at * p;
      chains.push_back(std::move(chain));
      if (chains.size() > kMostChains) {
        return fail(ErrorCode::ResourceLimit,
                    fmt::format("The DXF draws more than {} curves.", kMostChains));
      }
    }
    for (const Insert& insert : block.inserts) {
      const auto inner = blocks_.find(insert.block);
      if (inner == blocks_.end()) continue;
      Eigen::Affine2d there = at * insert.place;
      there.translate(-inner->second.base);
      if (Result<void> placed = place(insert.block, there, tolerance, depth + 1, chains); !placed)
        return placed;
    }
    return {};
  }

  std::map<std::string, Block> blocks_;  // "": the model
  std::string block_;
  std::optional<Polyline> polyline_;
  std::optional<Spline> spline_;
  std::set<std::string> left_;
  double unit_ = 1;
  bool unitKnown_ = false;
};

}  // namespace

Result<RawDrawing> readDxf(const std::string& text, double tolerance) {
  DxfReader reader;
  DL_Dxf dxf;
  std::istringstream stream(text);
  if (!dxf.in(stream, &reader)) {
    return fail(ErrorCode::UnreadableInput, "The file is no DXF that can be read.");
  }
  return reader.result(tolerance);
}

}  // namespace phront::cad
