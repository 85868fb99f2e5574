// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>

#include <silt/sph.hpp>

#include "near.hpp"

namespace sph_collision_test {

using namespace silt;

namespace {

/// Share of the kinetic energy that an incompressible block keeps as it hits its mirror image, or a
/// wall, with the velocity U along its length L: width 2H, free surfaces on the other three sides.
/// The blow is a potential phi with u' = u - grad phi, phi = 0 at the surfaces and
/// d phi/dx = U where it hits:
///
///   phi = sum_n c_n sinh(k_n (L - x))/(k_n cosh(k_n L)) cos(k_n y),  k_n = (n + 1/2) pi/H,
///   U   = sum_n c_n cos(k_n y),  c_n = 2 U (-1)^n/(k_n H)
///   loss/(rho U^2 L H) = sum_n 2 tanh(k_n L)/(k_n^3 H^2 L)                              (1)
///
/// Source: own derivation; the loss is rho/2 of the integral of phi d phi/dx over the face.
double kept(double L, double H) {
  double loss = 0;
  for (int n = 0; n < 1000; ++n) {
    const double k = (n + 0.5) * std::numbers::pi / H;
    loss += 2 * std::tanh(k * L) / (k * k * k * H * H * L);
  }
  return 1 - loss;
}

constexpr double U = 1, L = 1, H = 0.5;  // [m/s], [m], [m]

/// Two blocks in 2D that meet at x = 0, or one that hits a wall there.
template <class... Policies>
auto blocks(double spacing, bool wall, const Policies&... policies) {
  Sph water{Liquid{.density = 1000, .sound_speed = 20 * U},
            {.spacing = spacing, .region = {{-2.5, 0, -2.5}, {2.5, 0, 2.5}}, .dimensions = 2},
            policies...};
  if (wall) water.add_wall(Plane{{0, 0, 0}, {-1, 0, 0}}, {.name = "wall"});
  water.fill(
      [=](const Vec3d& x) { return std::abs(x.x) < L && std::abs(x.z) < H && (!wall || x.x < 0); },
      [](const Vec3d& x) {
        return Vec3d{x.x < 0 ? U : -U, 0, 0};
      });
  return water;
}

/// Mean share of the kinetic energy from 0.3 to 0.5 s; until then sound takes up to a tenth.
template <class Water>
double share_left(Water& water) {
  const double start = water.kinetic_energy();
  double sum = 0;
  water.run(0.29);
  for (int k = 0; k < 21; ++k) water.run(0.01), sum += water.kinetic_energy() / start / 21;
  return sum;
}

}  // namespace

// Catches: energy of the compression that returns to the flow (0.85 in the first oscillations), or
// losses by viscosity and by particles that are torn apart.
TEST_CASE("sph: two blocks that collide keep the energy of incompressible blocks") {
  CHECK(kept(L, H) == near(0.729585).epsilon(1e-5));
  CHECK(kept(1e-3, H) < 2e-3);  // a thin layer stops
  auto water = blocks(0.025, false);
  CHECK(share_left(water) == near(kept(L, H)).epsilon(0.015));
  CHECK(norm(water.momentum()) < 1e-12 * water.mass() * U);
  // Each particle has a mirror image across both planes of symmetry.
  std::map<std::pair<long, long>, int> sum;
  water.for_each([&](std::uint32_t, const Vec3d& x, const Vec3d&, double, double) {
    const auto place = [](double y) { return std::lround(std::abs(y) * 1e7); };
    sum[{place(x.x), place(x.z)}] += (x.x < 0 ? -1 : 1) + (x.z < 0 ? -2 : 2);
  });
  std::size_t off = 0;
  for (const auto& [place, number] : sum) off += number != 0;
  CHECK(off < water.size() / 100);  // rounding to 1e-7 m separates some
}

// Walls only push: a block keeps more, as they do not hold the sound that returns from its
// surfaces (docs/sph_method.md, A block that hits a wall). Catches: a wall that throws it back,
// and that takes up energy.
TEST_CASE("sph: a block that hits a wall keeps up to 8 % more, and loses no momentum along it") {
  auto water = blocks(0.025, true);
  const double share = share_left(water);
  CHECK(share > kept(L, H));
  CHECK(share < 1.08 * kept(L, H));
  CHECK(water.momentum().x > 0);
  CHECK(std::abs(water.momentum().z) < 1e-12 * water.mass() * U);
}

}  // namespace sph_collision_test
