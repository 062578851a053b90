// The settings are ordered by passes gained per second on real parts. No setting is best
// everywhere: each moves some tangency to the right side and another to the wrong one, so several
// are tried and each is judged.
#include "rebuild/exact_offset.h"

namespace phront::cad {

std::vector<AttemptSetting> attemptSettings() {
  std::vector<AttemptSetting> settings;
  settings.push_back({.name = "quick",
                      .smoothTolerance = 0.01,
                      .dropDeadPatches = true,
                      .setAside = true,
                      .timeLimit = 10});
  settings.push_back(
      {.name = "plain", .smoothTolerance = 0.01, .dropDeadPatches = true, .timeLimit = 15});
  settings.push_back({.name = "fine",
                      .fuzzy = 1e-5,
                      .smoothTolerance = 1e-3,
                      .sewTolerance = 1e-5,
                      .dropDeadPatches = true,
                      .timeLimit = 15});
  settings.push_back({.name = "canonical",
                      .fuzzy = 1e-6,
                      .smoothTolerance = 1e-3,
                      .sewTolerance = 1e-5,
                      .canonical = true,
                      .unifyInput = true,
                      .dropDeadPatches = true,
                      .timeLimit = 20});
  return settings;
}

}  // namespace phront::cad
