// From loaded shapes to bodies: solids with positive volume and connected sheets. Call in a guarded
// child.
#pragma once

#include "exchange/load_shapes.h"
#include "phront/cad/exchange.h"
#include "phront/cad/shape.h"
#include "phront/status.h"

namespace phront::cad {

/// Failures are ends of sentences, as in load_shapes.h.
[[nodiscard]] Result<Model> makeBodies(Loaded loaded, const ReadOptions& options);

}  // namespace phront::cad
