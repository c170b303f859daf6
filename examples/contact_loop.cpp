// A cube falls onto another one, and in each frame is pushed out of it along the deepest contact.
#include <sdm/sdm.h>

#include <cstdio>

sdm::Mesh cube() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}},
          {{0, 2, 3},
           {0, 3, 1},
           {4, 5, 7},
           {4, 7, 6},
           {0, 1, 5},
           {0, 5, 4},
           {2, 6, 7},
           {2, 7, 3},
           {0, 4, 6},
           {0, 6, 2},
           {1, 3, 7},
           {1, 7, 5}},
          {}};
}

int main() {
  sdm::Mesh falling = cube();
  for (sdm::Vec3& p : falling.positions) {
    p[0] += 0.3;
    p[2] += 1.2;
  }
  sdm::ProximityQuery query(falling, cube());
  double speed = 0;
  for (int frame = 0; frame < 40; ++frame) {
    speed -= 0.01;
    for (sdm::Vec3& p : falling.positions) p[2] += speed;
    query.refit(falling.positions, {});  // the other cube does not move
    if (query.colliding() && !query.contacts().empty()) {
      const sdm::Contact& deepest = query.contacts().front();
      for (sdm::Vec3& p : falling.positions)
        for (int k = 0; k < 3; ++k) p[k] += deepest.depth * deepest.normal[k];
      speed = 0;
    }
    if (frame % 10 == 9)
      std::printf("frame %2d: height %.3f, separation %.3f\n", frame, falling.positions[0][2],
                  query.separation().value);
  }
}
