#include "heal/free_angle.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace phront::cad {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

double inTurn(double angle) {
  const double a = std::fmod(angle, kTurn);
  return a < 0 ? a + kTurn : a;
}

}  // namespace

FreeAngle widestFreeAngle(std::vector<double> angles) {
  if (angles.empty()) return {0, kTurn};
  for (double& a : angles) a = inTurn(a);
  std::sort(angles.begin(), angles.end());
  double before = angles.back() - kTurn;
  FreeAngle widest;
  for (const double a : angles) {
    if (a - before > widest.width) widest = {inTurn((a + before) / 2), a - before};
    before = a;
  }
  return widest;
}

}  // namespace phront::cad
