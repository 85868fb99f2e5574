// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include <silt/sph/sph.hpp>

#include "near.hpp"

namespace sph_taylor_green_test {

using namespace silt;

namespace {

/// Taylor-Green vortices in a box that repeats, u = U (cos kx sin kz, -sin kx cos kz) exp(-2 nu k^2
/// t), k = 2 pi/L, at Re = U L/nu = 100: kinetic energy and the flow's share in the velocities over
/// the exact ones at t = 0.4 L/U.
struct Decayed {
  double energy, mode;
};
template <class Shift>
Decayed vortices(int n, const Shift& shifting, double scatter, double smoothing = 1.2) {
  const double L = 1, U = 1, nu = 0.01, k = 2 * std::numbers::pi, end = 0.4;
  Sph liquid{Liquid{.density = 1000, .sound_speed = 10 * U},
             {.spacing = L / n,
              .region = {{0, 0, 0}, {L, 0, L}},
              .smoothing = smoothing,
              .dimensions = 2,
              .periodic = {true, false, true},
              .scatter = scatter},
             LaminarViscosity{.kinematic = nu, .alpha = 0},
             shifting};
  const auto flow = [=](const Vec3d& x) {
    return Vec3d{U * std::cos(k * x.x) * std::sin(k * x.z), 0,
                 -U * std::sin(k * x.x) * std::cos(k * x.z)};
  };
  // Above all suction, which is -1/2 rho U^2.
  liquid.fill([](const Vec3d&) { return true; }, flow,
              [=](const Vec3d& x) {
                return 1000 * U * U *
                       (0.6 - 0.25 * (std::cos(2 * k * x.x) + std::cos(2 * k * x.z)));
              });
  const double start = liquid.kinetic_energy();
  liquid.run(end);
  double in = 0, all = 0;
  liquid.for_each([&](std::uint32_t, const Vec3d& x, const Vec3d& v, double, double) {
    in += dot(v, flow(x)), all += dot(flow(x), flow(x));
  });
  const double decay = std::exp(-2 * nu * k * k * end);
  return {liquid.kinetic_energy() / (start * decay * decay), in / (all * decay)};
}

}  // namespace

// What stretches a lattice raises the sums of its kernels, without moving the gradient by which
// particles shift: pressure builds up, until rows buckle. Half of the energy goes that way.
TEST_CASE("SPH: Taylor-Green vortices decay as they must, from scattered particles") {
  // 5.2, 2.6 and 1.5 % too little; what is lost at first is the disorder of the start. (A viscosity
  // with r.grad W/(r^2 + (0.1 h)^2) is 2 % too small, which made up for most of it: 0.3 % at 80.)
  const Decayed coarse = vortices(20, ShiftingByFastest{}, 0.2),
                middle = vortices(40, ShiftingByFastest{}, 0.2),
                fine = vortices(80, ShiftingByFastest{}, 0.2);
  CHECK(std::abs(middle.energy - 1) < 0.6 * std::abs(coarse.energy - 1));
  CHECK(std::abs(fine.energy - 1) < 0.65 * std::abs(middle.energy - 1));
  CHECK(std::abs(coarse.energy - 1) < 0.06);
  CHECK(std::abs(middle.energy - 1) < 0.03);
  CHECK(std::abs(fine.energy - 1) < 0.018);
  CHECK(std::abs(fine.mode - 1) < 0.009);
  // A wider kernel.
  const Decayed wide = vortices(40, ShiftingByFastest{}, 0.2, 1.4);
  CHECK(std::abs(wide.energy - 1) < 0.015);
}

TEST_CASE("SPH: Taylor-Green vortices from a lattice, and with shifting by the local speed") {
  // From a lattice half of the energy is lost: the sentence of docs/sph_method.md. By the local
  // speed 6 %.
  const double lattice = vortices(40, Shifting{}, 0).energy,
               fastest = vortices(40, ShiftingByFastest{}, 0).energy,
               local = vortices(40, Shifting{}, 0.2).energy;
  CHECK(lattice < 0.7);
  CHECK(fastest < 0.85);
  CHECK(local == near(0.936).epsilon(0.015));
}

}  // namespace sph_taylor_green_test
