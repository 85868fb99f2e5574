// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <silt/sph/sph.hpp>

#include "near.hpp"

namespace sph_elliptic_drop_test {

using namespace silt;

namespace {

/// A round patch of radius 1 m, without gravity, that starts with the strain u = A0 (x, -z) and
/// stays an ellipse: a' = A a, b' = -A b, A' = A^2 (b^2 - a^2)/(a^2 + b^2), by Euler's equations
/// with pressure 0 at the edge. Its kinetic energy A^2 (a^2 + b^2) stays.
/// Source: J. J. Monaghan, J. Comput. Phys. 110 (1994) 399 (recalled); derived again.
struct Exact {
  double a = 1, b = 1, A = 1;
  void go(double time) {  // Runge-Kutta, fourth order
    const auto slope = [](const Exact& e) {
      const double a2 = e.a * e.a, b2 = e.b * e.b;
      return Exact{e.A * e.a, -e.A * e.b, e.A * e.A * (b2 - a2) / (a2 + b2)};
    };
    const auto after = [](const Exact& e, const Exact& s, double t) {
      return Exact{e.a + t * s.a, e.b + t * s.b, e.A + t * s.A};
    };
    const int n = 1000;
    const double dt = time / n;
    for (int k = 0; k < n; ++k) {
      const Exact one = slope(*this), two = slope(after(*this, one, dt / 2)),
                  three = slope(after(*this, two, dt / 2)), four = slope(after(*this, three, dt));
      a += dt / 6 * (one.a + 2 * two.a + 2 * three.a + four.a);
      b += dt / 6 * (one.b + 2 * two.b + 2 * three.b + four.b);
      A += dt / 6 * (one.A + 2 * two.A + 2 * three.A + four.A);
    }
  }
};

/// The strain's axes are 20 degrees off those of the lattice: nothing is kept by symmetry.
const Vec3d along{std::cos(std::numbers::pi / 9), 0, std::sin(std::numbers::pi / 9)};
const Vec3d across{-along.z, 0, along.x};

template <class... Policies>
auto drop(int n, const Policies&... policies) {
  Sph water{Liquid{.density = 1000, .sound_speed = 20},
            {.spacing = 1.0 / n, .region = {{-4, 0, -4}, {4, 0, 4}}, .dimensions = 2},
            policies...};
  water.fill([](const Vec3d& x) { return dot(x, x) < 1; },
             [](const Vec3d& x) { return dot(along, x) * along - dot(across, x) * across; },
             [](const Vec3d& x) { return 500 * (1 - dot(x, x)); });
  return water;
}

struct Seen {
  double a = 0, b = 0;               // [m] by the second moments: <x^2> = a^2/4
  double tip = 0, side = 0;          // [m] where the last particle ends
  double rate = 0, energy = 0;       // [1/s] A, [J/m]
  double pressure = 0;               // [Pa] in the middle
  double momentum = 0, turning = 0;  // over the sums of their parts
};
template <class Water>
Seen look(const Water& water) {
  Seen s;
  double parts = 0, near_middle = 0, strain = 0, n = 0, m = water.particle_mass();
  water.for_each([&](std::uint32_t, const Vec3d& x, const Vec3d& v, double, double p) {
    const double u = dot(along, x), w = dot(across, x);
    s.a += u * u, s.b += w * w, n += 1;
    s.tip = std::max(s.tip, std::abs(u)), s.side = std::max(s.side, std::abs(w));
    strain += u * dot(along, v) - w * dot(across, v);
    s.turning += m * (x.z * v.x - x.x * v.z), parts += m * norm(x) * norm(v);
    if (std::abs(u) < 0.2 && std::abs(w) < 0.2) s.pressure += p, near_middle += 1;
  });
  s.rate = strain / (s.a + s.b);
  s.a = 2 * std::sqrt(s.a / n), s.b = 2 * std::sqrt(s.b / n);
  s.tip += 0.5 * water.setup().spacing, s.side += 0.5 * water.setup().spacing;
  s.energy = water.kinetic_energy();
  s.momentum = norm(water.momentum()) / std::sqrt(2 * m * n * s.energy);
  s.turning = std::abs(s.turning) / parts;
  s.pressure /= near_middle;
  return s;
}

}  // namespace

TEST_CASE("SPH: a drop is drawn out into an ellipse: axes within 1.5 %, energy, both momenta") {
  // 20 particles a radius, to 9 times as long as wide, 13 particles thick then. 1.5 %: 1.1 % seen
  // in an axis, 1.5 % in A, which go with the energy: 2.3 % and 3.7 % of it are lost to artificial
  // viscosity (0.3 % and 0.8 % without any). Without pressure the axes would be 1.8 and 0.2 at
  // t = 0.8, at one and the same A 2.23 and 0.45.
  auto water = drop(20);
  const double before = water.kinetic_energy(), largest[] = {0.03, 0.045};
  for (int k = 0; k < 2; ++k) {
    const double t = k == 0 ? 0.8 : 1.5;
    water.run(t - water.time());
    Exact exact;
    exact.go(t);
    const Seen seen = look(water);
    CHECK(seen.a == near(exact.a).epsilon(0.015));
    CHECK(seen.b == near(exact.b).epsilon(0.015));
    CHECK(seen.rate == near(exact.A).epsilon(0.02));
    CHECK(seen.energy < before);
    CHECK(seen.energy > (1 - largest[k]) * before);
    // Nothing flies off: the last particle ends within a spacing of the ellipse.
    CHECK(std::abs(seen.tip - exact.a) < 1.5 * 0.05);
    CHECK(std::abs(seen.side - exact.b) < 0.05);
    CHECK(seen.momentum < 1e-14);
    // Shifting moves mass, not momentum: its moment is kept to 5e-5 of the sum of its parts.
    CHECK(seen.turning < 2e-4);
  }
  CHECK(water.left() == 0);
}

TEST_CASE("SPH: a drop without viscosity, diffusion and shifting keeps energy and moment") {
  // 0.8 % of the energy.
  auto water = drop(20, Inviscid{}, NoDiffusion{}, NoShifting{});
  const double before = water.kinetic_energy();
  water.run(1.5);
  Exact exact;
  exact.go(1.5);
  const Seen seen = look(water);
  CHECK(seen.a == near(exact.a).epsilon(0.01));
  CHECK(seen.b == near(exact.b).epsilon(0.015));
  CHECK(seen.energy == near(before).epsilon(0.015));
  CHECK(seen.momentum < 1e-14);
  CHECK(seen.turning < 1e-13);
}

}  // namespace sph_elliptic_drop_test
