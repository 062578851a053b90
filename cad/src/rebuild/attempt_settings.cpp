// The settings are ordered by passes gained per second on real parts. No setting is best
// everywhere: each moves some tangency to the right side and another to the wrong one, so several
// are tried and each is judged.
#include "rebuild/exact_offset.h"

#include <fmt/format.h>

namespace phront::cad {

std::vector<AttemptSetting> attemptSettings() {
  std::vector<AttemptSetting> settings;
  settings.push_back({.name = "plain",
                      .smoothTolerance = 0.01,
                      .dropDeadPatches = true,
                      .thinPairs = true,
                      .repairSeconds = 20,
                      .timeLimit = 35});
  settings.push_back({.name = "fine",
                      .fuzzy = 1e-5,
                      .smoothTolerance = 1e-3,
                      .sewTolerance = 1e-5,
                      .dropDeadPatches = true,
                      .thinPairs = true,
                      .repairSeconds = 12,
                      .timeLimit = 25});
  for (const double reach : {0.9995, 0.9989}) {
    AttemptSetting touching = settings.front();
    touching.name = fmt::format("at {:g} d, where parts touch", reach);
    touching.reach = reach;
    settings.push_back(touching);
  }
  settings.push_back({.name = "cut by phi",
                      .smoothTolerance = 0.01,
                      .dropDeadPatches = true,
                      .thinPairs = true,
                      .repairSeconds = 20,
                      .alwaysRepair = true,
                      .timeLimit = 30});
  settings.push_back({.name = "unified",
                      .fuzzy = 1e-6,
                      .smoothTolerance = 1e-3,
                      .sewTolerance = 1e-5,
                      .unifyInput = true,
                      .dropDeadPatches = true,
                      .thinPairs = true,
                      .timeLimit = 25});
  settings.push_back(
      {.name = "all pairs", .smoothTolerance = 0.01, .dropDeadPatches = true, .timeLimit = 25});
  return settings;
}

}  // namespace phront::cad
