// Distance to a sphere, inside and out, by fast sweeping (table 4.2 of the thesis).
#include "common/distance_table.h"
#include "common/report.h"
#include "common/shapes.h"

int main(int argc, char** argv) {
  thesis::distanceTable(
      "sphere of radius 0.15 in a cube of side 0.5 (table 4.2)", thesis::sphere(0.15, 5),
      {{10, ".0100", ".040"}, {20, ".0057", ".026"}, {40, ".0030", ".016"}, {80, ".0015", ".0097"}},
      thesis::outputFolder(argc, argv) / "sphere_errors.csv");
}
