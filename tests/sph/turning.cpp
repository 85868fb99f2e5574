// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <numbers>

#include <silt/sph.hpp>

#include "near.hpp"

namespace sph_turning_test {

using namespace silt;

namespace {

constexpr Vec3d low{0, -1, 0}, high{0, 1, 0};

}  // namespace

TEST_CASE("SPH: a viscous liquid between cylinders has their torque, and as much at both") {
  // Couette: the inner one turns, 4 pi mu omega R1^2 R2^2/(R2^2 - R1^2) on each. Measured 1.05 and
  // 1.04 of it at 12 particles across: rows that slide past each other exchange some momentum by
  // pressure. Catches the stress mu grad v in place of its symmetric part: 0.66 at the inner one.
  const double R1 = 0.05, R2 = 0.1, dx = (R2 - R1) / 12, w = 2, nu = 1e-3, rho = 1000;
  Sph oil{Liquid{.density = rho, .sound_speed = 3},
          {.spacing = dx,
           .region = {{-R2 - 5 * dx, 0, -R2 - 5 * dx}, {R2 + 5 * dx, 0, R2 + 5 * dx}},
           .dimensions = 2},
          LaminarViscosity{.kinematic = nu, .alpha = 0}};
  oil.add_wall(Cylinder{low, high, R1, Side::Outside},
               {.motion = rotation({0, 0, 0}, {0, 1, 0}, w)});
  oil.add_wall(Cylinder{low, high, R2, Side::Inside});
  oil.fill([](const Vec3d&) { return true; },
           [](const Vec3d&) {
             return Vec3d{0, 0, 0};
           },
           [](const Vec3d&) { return 50.0; });
  const double tau = (R2 - R1) * (R2 - R1) / nu;
  oil.run(1.25 * tau);
  double inner = 0, outer = 0;
  for (int k = 0; k < 20; ++k) {
    oil.run(tau / 80);
    inner -= oil.wall_load(0).second.y / 20, outer += oil.wall_load(1).second.y / 20;
  }
  const double torque =
      4 * std::numbers::pi * rho * nu * w * R1 * R1 * R2 * R2 / (R2 * R2 - R1 * R1);
  CHECK(inner == near(torque).epsilon(0.08));
  CHECK(outer == near(torque).epsilon(0.08));
  CHECK(inner == near(outer).epsilon(0.03));
}

TEST_CASE("SPH: a viscous liquid in a drum ends in turning with it, without a torque") {
  // Half full, no gravity: its surface is free. Measured 0.99 of the drum's rate and a torque of
  // 0.05 of 2 pi R^2 mu omega. With mu grad v the surface has the traction mu omega: 1.13 times the
  // drum's rate, and half of that torque for ever.
  const double R = 0.1, dx = R / 10, w = 10, nu = 2e-3, rho = 900;
  Sph oil{Liquid{.density = rho, .sound_speed = 15},
          {.spacing = dx,
           .region = {{-R - 5 * dx, 0, -R - 5 * dx}, {R + 5 * dx, 0, R + 5 * dx}},
           .dimensions = 2},
          LaminarViscosity{.kinematic = nu, .alpha = 0}};
  oil.add_wall(Cylinder{low, high, R, Side::Inside}, {.motion = rotation({0, 0, 0}, {0, 1, 0}, w)});
  oil.fill([&](const Vec3d& x) { return norm(x) < R - 0.5 * dx && norm(x) > 0.5 * R; },
           [](const Vec3d&) {
             return Vec3d{0, 0, 0};
           },
           [](const Vec3d&) { return 1000.0; });
  oil.run(8 * R * R / (nu * 5.783));  // eight times the slowest decay of a full disc
  double spin = 0, inertia = 0, torque = 0;
  oil.for_each([&](std::uint32_t, const Vec3d& x, const Vec3d& v, double, double) {
    spin += x.z * v.x - x.x * v.z, inertia += dot(x, x);
  });
  for (int k = 0; k < 10; ++k) oil.run(0.01), torque += 0.1 * oil.wall_load(0).second.y;
  CHECK(spin / inertia == near(w).epsilon(0.02));
  CHECK(std::abs(torque) < 0.1 * 2 * std::numbers::pi * R * R * rho * nu * w);
  CHECK(oil.left() == 0);
}

}  // namespace sph_turning_test
