// What hollowing and thickening share: the offset of a side.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "phront/progress.h"
#include "shell/shell_body.h"

namespace phront::cad {

struct SideRequest {
  double distance = 0;  ///< mm, signed
  double seconds = 0;
  std::string what;  ///< "the cavity"
};

/// The offset of `body`; what was tried and how long it took goes to `made`. Nothing when none
/// passes: made.report then says why. Fails as offsetBody.
[[nodiscard]] Result<std::optional<std::vector<Body>>> offsetSide(const Body& body,
                                                                  const SideRequest& side,
                                                                  const ShellBodyRequest& request,
                                                                  const Progress& progress,
                                                                  BodyShell& made);

}  // namespace phront::cad
