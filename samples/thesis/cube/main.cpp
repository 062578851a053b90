// Distance to a cube, inside and out, by fast sweeping (table 4.3 of the thesis).
#include "common/distance_table.h"
#include "common/report.h"
#include "common/shapes.h"

int main(int argc, char** argv) {
  thesis::distanceTable(
      "cube of side 0.3 in a cube of side 0.5 (table 4.3)", thesis::cube(0.3, 1),
      {{25, "-", ".0224"}, {50, "-", ".0150"}, {100, "-", ".0095"}, {200, "-", ".0057"}},
      thesis::outputFolder(argc, argv) / "cube_errors.csv");
}
