#include <phront/surface_distance.h>

#include <cstdio>

int main() {  // unit cube; its centre is 0.5 inside, (3, 0.5, 0.5) is 2 outside
  phront::TriMesh cube;
  for (int i = 0; i < 8; ++i) cube.points.emplace_back(i & 1, i >> 1 & 1, i >> 2);
  cube.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  const auto surface = phront::SurfaceDistance::build(cube);
  if (!surface) return std::puts(surface.error().message.c_str()), 1;
  std::printf("phi %g %g\n", surface->signedDistance({0.5, 0.5, 0.5}),
              surface->signedDistance({3, 0.5, 0.5}));
}
