#include "surfaces/loop_polygons.h"

#include <BRepAdaptor_Curve.hxx>
#include <GCPnts_TangentialDeflection.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <limits>

namespace phront::cad {
namespace {

constexpr std::size_t kMostRows = 2000;  // ranges of y
constexpr double kMostTurn = 0.2;        // rad between sides
constexpr int kLeastPoints = 4;          // of each span of a curve

}  // namespace

LoopPolygons::LoopPolygons(const TopoDS_Face& face, double chord) {
  std::vector<Side> sides;
  double top = -std::numeric_limits<double>::infinity();
  bottom_ = std::numeric_limits<double>::infinity();
  for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
    const TopAbs_Orientation way = it.Current().Orientation();
    if (way != TopAbs_FORWARD && way != TopAbs_REVERSED) continue;  // not of a loop
    const BRepAdaptor_Curve curve(TopoDS::Edge(it.Current()));
    TColStd_Array1OfReal spans(1, curve.NbIntervals(GeomAbs_CN) + 1);
    curve.Intervals(spans, GeomAbs_CN);
    for (int k = 1; k < spans.Length(); ++k) {
      const GCPnts_TangentialDeflection points(curve, spans(k), spans(k + 1), kMostTurn, chord,
                                               kLeastPoints);
      for (int i = 1; i < points.NbPoints(); ++i) {
        const gp_Pnt a = points.Value(i);
        const gp_Pnt b = points.Value(i + 1);
        Side side{{a.X(), a.Y()}, {b.X(), b.Y()}};
        if (side.low[1] > side.high[1]) std::swap(side.low, side.high);
        bottom_ = std::min(bottom_, side.low[1]);
        top = std::max(top, side.high[1]);
        sides.push_back(side);
      }
    }
  }
  if (sides.empty() || !(top > bottom_)) return;
  const std::size_t rows = std::min(sides.size(), kMostRows);
  rowHeight_ = (top - bottom_) / static_cast<double>(rows);
  rows_.resize(rows);
  for (const Side& side : sides) {
    for (std::size_t k = rowOf(side.low[1]); k <= rowOf(side.high[1]); ++k)
      rows_[k].push_back(side);
  }
}

std::size_t LoopPolygons::rowOf(double y) const {
  const double row = (y - bottom_) / rowHeight_;
  return static_cast<std::size_t>(std::clamp(row, 0.0, static_cast<double>(rows_.size() - 1)));
}

bool LoopPolygons::contains(const Eigen::Vector2d& x) const {
  if (rows_.empty()) return false;
  bool inside = false;
  for (const Side& s : rows_[rowOf(x[1])]) {
    if (!(s.low[1] <= x[1] && x[1] < s.high[1])) continue;
    const Eigen::Vector2d along = s.high - s.low;
    const double crossing = s.low[0] + along[0] * (x[1] - s.low[1]) / along[1];
    if (crossing > x[0]) inside = !inside;
  }
  return inside;
}

}  // namespace phront::cad
