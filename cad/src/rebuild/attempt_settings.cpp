// No setting is best everywhere: each moves some tangency to the right side and another to the
// wrong one, so several are tried and each is judged. The quick ones and those that gain most come
// first.
#include "rebuild/exact_offset.h"

#include <fmt/format.h>

namespace phront::cad {

std::vector<AttemptSetting> attemptSettings() {
  const AttemptSetting plain{.name = "plain",
                             .smoothTolerance = 0.01,
                             .dropDeadPatches = true,
                             .thinPairs = true,
                             .looksAgain = true,
                             .timeLimit = 45};
  const auto at = [&](double reach) {
    AttemptSetting setting = plain;
    setting.name = fmt::format("at {:g} d", reach);
    setting.reach = reach;
    setting.looksAgain = false;
    return setting;
  };
  const AttemptSetting fine{.name = "fine",
                            .fuzzy = 1e-5,
                            .smoothTolerance = 1e-3,
                            .sewTolerance = 1e-5,
                            .dropDeadPatches = true,
                            .thinPairs = true,
                            .looksAgain = true,
                            .timeLimit = 35};
  AttemptSetting atBends = plain;
  atBends.name = "at bends";
  atBends.dividesBends = true;
  AttemptSetting cutByPhi = plain;
  cutByPhi.name = "cut by phi";
  cutByPhi.looksAgain = false;
  cutByPhi.repairSeconds = 20;
  cutByPhi.timeLimit = 30;
  AttemptSetting unified = fine;
  unified.name = "unified";
  unified.fuzzy = 1e-6;
  unified.unifyInput = true;
  unified.looksAgain = false;
  unified.timeLimit = 25;
  AttemptSetting allPairs = plain;
  allPairs.name = "all pairs";
  allPairs.thinPairs = false;
  allPairs.looksAgain = false;
  allPairs.timeLimit = 25;
  return {plain, at(0.9992), fine, atBends, cutByPhi, at(0.9989), unified, allPairs};
}

}  // namespace phront::cad
