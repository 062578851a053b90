// The solid that a sheet becomes: its two sides by the offset engine, walls on its free edges.
#pragma once

#include "shell/shell_body.h"

namespace phront::cad {

/// As shellBody, for a sheet, which has no openings but its free edges. Fails with NotSupported
/// where faces do not agree which of their sides is out.
[[nodiscard]] Result<BodyShell> thickenBody(const Body& sheet, const ShellBodyRequest& request,
                                            const Progress& progress);

}  // namespace phront::cad
