// Every public header of cad but shape_occt.h; the test compiles it without OpenCASCADE's headers.
#include <phront/cad/check.h>
#include <phront/cad/exchange.h>
#include <phront/cad/offset_shape.h>
#include <phront/cad/shape.h>
#include <phront/cad/tessellate.h>

#include <cstdio>

int main() {
  const auto missing = phront::cad::readModel("no_such_part.step");
  const bool refused = !missing && missing.error().code == phront::ErrorCode::UnreadableInput;
  std::printf("cad %s\n", refused ? "refused" : "accepted");
}
