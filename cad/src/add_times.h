// Times of stages, summed by name.
#pragma once

#include <algorithm>
#include <vector>

#include "phront/cad/offset_shape.h"

namespace phront::cad {

inline void addTimes(std::vector<StageTime>& sum, const std::vector<StageTime>& times) {
  for (const StageTime& time : times) {
    const auto same = std::find_if(sum.begin(), sum.end(),
                                   [&](const StageTime& s) { return s.stage == time.stage; });
    if (same == sum.end())
      sum.push_back(time);
    else
      same->seconds += time.seconds;
  }
}

}  // namespace phront::cad
