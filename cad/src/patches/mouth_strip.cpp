#include "patches/mouth_strip.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace phront::cad {
namespace {

constexpr int kSamples = 64;
constexpr double kClear = 1e-4;  // of |d|: nearer to a rim than |d| by more is on no offset

double nearestOf(const MouthStrips& strips, const gp_Pnt& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const MouthStrip& strip : strips) least = std::min(least, strip.nearest(p).first);
  return least;
}

}  // namespace

MouthStrip::MouthStrip(const MouthEdge& edge) : edge_(edge), sections_(edge.frame) {
  for (int i = 0; i <= kSamples; ++i)
    rim_.push_back(sections_.section(parameter(static_cast<double>(i) / kSamples)).centre);
}

bool MouthStrip::prepare(const MouthStrips& others) {
  if (!sections_.possible()) return false;
  const double radius = frame().radius;
  for (const bool image2 : {true, false}) {
    keepsImage2_ = image2;
    const double kept = nearestOf(others, onSection(0.5, 0));
    const double cut = nearestOf(others, onSection(0.5, 1));
    if (!(kept > radius && cut < (1 - kClear) * radius)) continue;
    surface_ = sections_.make();
    return !surface_.IsNull();
  }
  return false;
}

double MouthStrip::length() const {
  double sum = 0;
  for (std::size_t i = 1; i < rim_.size(); ++i) sum += rim_[i].Distance(rim_[i - 1]);
  return sum;
}

double MouthStrip::parameter(double f) const {
  return forward() ? std::lerp(sections_.first(), sections_.last(), f)
                   : std::lerp(sections_.last(), sections_.first(), f);
}

gp_Pnt MouthStrip::value(double f, double u) const { return surface_->Value(u, parameter(f)); }

void MouthStrip::derivatives(double f, double u, gp_Pnt& point, gp_Vec& alongF,
                             gp_Vec& acrossU) const {
  surface_->D1(u, parameter(f), point, acrossU, alongF);
  alongF *= (forward() ? 1 : -1) * (sections_.last() - sections_.first());
}

gp_Pnt MouthStrip::onSection(double f, double share) const {
  const SweptSurface::Section s = sections_.section(parameter(f));
  gp_Vec side(s.a, s.b);
  side.Normalize();
  const double angle = (keepsImage2_ ? 0.5 - share : share - 0.5) * s.angle;
  return s.centre.Translated((s.middle * std::cos(angle) + side * std::sin(angle)) *
                             frame().radius);
}

double MouthStrip::across(double f, const gp_Pnt& p) const {
  return sections_.across(p, parameter(f));
}

std::pair<double, double> MouthStrip::nearest(const gp_Pnt& p) const {
  std::pair<double, double> best{std::numeric_limits<double>::infinity(), 0};
  for (int i = 0; i <= kSamples; ++i) {
    const double distance = p.Distance(rim_[static_cast<std::size_t>(i)]);
    if (distance < best.first) best = {distance, static_cast<double>(i) / kSamples};
  }
  return best;
}

}  // namespace phront::cad
