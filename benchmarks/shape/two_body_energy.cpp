// silt - BSD-3-Clause, see LICENSE
//
// Free elastic collisions of two superellipsoids: errors of energy, momentum and angular momentum,
// by step length, for three choices of overlap and normal:
//   common   least depth over all normals, R_eff of the first touch (the default)
//   local    the same with R_eff of the place
//   midway   the direction of the midway point (equal exponents), R_eff of the first touch
//   two_body_energy [COLLISIONS]

#include <array>
#include <cstdio>
#include <cstdlib>

#include "shape/two_bodies.hpp"

int main(int argc, char** argv) {
  const int n = argc > 1 ? std::atoi(argv[1]) : 100;
  std::printf("%d collisions each; change of energy over energy, mean of sizes | largest\n", n);
  std::printf("%-5s %-7s", "s", "steps");
  for (const char* name : {"common", "local", "midway"}) std::printf("  %20s", name);
  std::printf("  %20s\n", "momentum, spin");
  for (const double s : {2.0, 4.0, 8.0, 20.0})
    for (const int steps : {50, 200, 800}) {
      std::array<double, 3> mean{}, most{};
      double momentum = 0;
      for (int k = 0; k < n; ++k)
        for (int how = 0; how < 3; ++how) {
          const auto end = two_bodies::collide(s, static_cast<two_bodies::Overlap>(how), steps,
                                               static_cast<unsigned>(k));
          const double error = std::abs(end.energy);
          mean[how] += error / n, most[how] = std::max(most[how], error);
          momentum = std::max({momentum, end.momentum, end.angular_momentum});
        }
      std::printf("%-5g %-7d", s, steps);
      for (int how = 0; how < 3; ++how) std::printf("  %9.1e |%9.1e", mean[how], most[how]);
      std::printf("  %20.1e\n", momentum);
    }
}
