// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <numbers>
#include <vector>

#include <silt/sph.hpp>
#include <silt/sph/surface_slope.hpp>

#include "near.hpp"

namespace sph_waves_test {

using namespace silt;

namespace {

/// h |grad C| and -sum V r.grad W/D at a place y h below the surface of a fine lattice.
template <class Kernel>
std::pair<double, double> below_surface(double y, int dimensions) {
  const int per = dimensions == 2 ? 12 : 6, n = 2 * per + 2, m = dimensions == 2 ? 0 : n;
  const double s = 1.0 / per;
  double slope = 0, full = 0;
  for (int i = -n; i <= n; ++i)
    for (int j = -m; j <= m; ++j)
      for (int k = -2 * n; k < 0; ++k) {
        const Vec3d r{(i + 0.5) * s, dimensions == 2 ? 0 : (j + 0.5) * s, (k + 0.5) * s + y};
        const double f =
            Kernel::slope(norm(r)) * Kernel::normalisation(dimensions, 1) * std::pow(s, dimensions);
        slope += f * r.z, full -= f * dot(r, r) / dimensions;
      }
  return {std::abs(slope), full};
}

}  // namespace

// A table of another dimension, kernel or argument is off by 10 % and more; the lattice's sums by
// 0.5 % of the largest slope.
TEST_CASE_TEMPLATE("SPH: the slope of a flat surface is that of a lattice", Kernel, WendlandC2,
                   CubicSpline) {
  for (const int dimensions : {2, 3}) {
    const detail::SphSurfaceSlope<Kernel> table(dimensions);
    for (const double y : {0.0, 0.2, 0.5, 0.8, 1.1, 1.4, 1.7, 1.95}) {
      const auto [slope, full] = below_surface<Kernel>(y, dimensions);
      CAPTURE(dimensions);
      CAPTURE(y);
      CHECK(std::abs(table(full) - slope) < 0.005);
    }
    CHECK(table(1.2) == 0);
  }
}

// omega^2 = g k tanh(k d). With smoothing = 1.0 the lattice is stiff against shear, and the wave 4
// % too fast; shifting that took the surface for uneven particles lifted the liquid, and put as
// much energy in within a period as the wave has.
TEST_CASE("SPH: a standing wave keeps its period, its height and its energy") {
  const double g = 9.81, L = 1, d = 0.4, k = 2 * std::numbers::pi / L, A = 0.02, alpha = 0.02;
  const double omega = std::sqrt(g * k * std::tanh(k * d)), c = 10 * std::sqrt(g * d);
  Sph water{Liquid{.density = 1000, .sound_speed = c},
            {.spacing = 0.02, .region = {{0, 0, 0}, {L, 0, 0.7}}, .dimensions = 2},
            ArtificialViscosity{.alpha = alpha}};
  water.gravity = {0, 0, -g};
  water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
  water.add_wall(Plane{{0, 0, 0}, {1, 0, 0}});
  water.add_wall(Plane{{L, 0, 0}, {-1, 0, 0}});
  const auto mode = [=](const Vec3d& x) {
    return (1 / std::sinh(k * d)) * Vec3d{-std::cosh(k * x.z) * std::sin(k * x.x), 0,
                                          std::sinh(k * x.z) * std::cos(k * x.x)};
  };
  water.fill([=](const Vec3d& x) { return x.z < d; },
             [=](const Vec3d& x) { return A * omega * mode(x); },
             [=](const Vec3d& x) { return 1000 * g * (d - x.z); });
  const auto share = [&] {  // of the mode in the velocities
    double in = 0, all = 0;
    water.for_each([&](std::uint32_t, const Vec3d& x, const Vec3d& v, double, double) {
      const Vec3d u = mode(x);
      in += dot(v, u), all += dot(u, u);
    });
    return in / (all * A * omega);
  };
  const auto height = [&] {  // of the centre
    double sum = 0;
    water.for_each(
        [&](std::uint32_t, const Vec3d& x, const Vec3d&, double, double) { sum += x.z; });
    return sum / static_cast<double>(water.size());
  };
  const double mass = water.mass(), energy = water.kinetic_energy(), centre = height();
  std::vector<double> zeros;
  double before = share();
  while (zeros.size() < 3 && water.time() < 1.5) {
    water.run(0.01);
    const double now = share();
    if (now * before < 0) zeros.push_back(water.time() - 0.01 * now / (now - before));
    before = now;
  }
  REQUIRE(zeros.size() == 3);
  // 0.3 % too long.
  CHECK(0.5 * (zeros[2] - zeros[0]) == near(std::numbers::pi / omega).epsilon(0.007));
  // After a period and a half, at the next largest speed: 0.91; by the artificial viscosity
  // alpha h c/16, exp(-2 nu k^2 t) = 0.92.
  water.run(1.5 * 2 * std::numbers::pi / omega - water.time());
  const double nu = alpha * water.setup().h() * c / 16;
  CHECK(-share() == near(std::exp(-2 * nu * k * k * water.time())).epsilon(0.03));
  // The liquid's centre is 0.06 mm higher (0.003 of a spacing): 0.2 of the energy of the start.
  CHECK(std::abs(mass * g * (height() - centre)) < 0.3 * energy);
}

// What odd and even steps of VerletTime differ by grows between restarts. With one after 40 steps,
// as DualSPHysics has it, noise came to 4.5 times the wave's speed (rms) within two periods, and
// the wave was 6 % too fast; with SymplecticTime it is at most 0.22, of what moves below the
// surface.
TEST_CASE("SPH: VerletTime keeps a standing wave at its largest Courant number") {
  const double g = 9.81, L = 1, d = 0.5, k = std::numbers::pi / L, A = 0.02, rho = 1000;
  const double omega = std::sqrt(g * k * std::tanh(k * d)), period = 2 * std::numbers::pi / omega;
  Sph water{Liquid{.density = rho, .sound_speed = 10 * std::sqrt(2 * g * d)},
            {.spacing = d / 15,
             .region = {{0, 0, 0}, {L, 0, 0.7}},
             .dimensions = 2,
             .gravity = {0, 0, -g},
             .courant = 0.2},
            VerletTime{}};
  water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
  water.add_wall(Plane{{0, 0, 0}, {1, 0, 0}});
  water.add_wall(Plane{{L, 0, 0}, {-1, 0, 0}});
  const auto mode = [=](const Vec3d& x) {
    return (A * omega / std::sinh(k * d)) * Vec3d{-std::cosh(k * x.z) * std::sin(k * x.x), 0,
                                                  std::sinh(k * x.z) * std::cos(k * x.x)};
  };
  water.fill([=](const Vec3d& x) { return x.z < d; }, mode,
             [=](const Vec3d& x) { return rho * g * (d - x.z); });
  std::vector<double> zeros;
  double before = 1, noise = 0;
  for (int n = 1; n <= 80; ++n) {
    water.run(period / 50);
    double in = 0, all = 0, other = 0;
    water.for_each([&](std::uint32_t, const Vec3d& x, const Vec3d& v, double, double) {
      in += dot(v, mode(x)), all += dot(mode(x), mode(x));
    });
    const double now = in / all;
    water.for_each([&](std::uint32_t, const Vec3d& x, const Vec3d& v, double, double) {
      const Vec3d off = v - now * mode(x);
      other += dot(off, off);
    });
    if (now * before < 0) zeros.push_back(n - now / (now - before));
    before = now, noise = std::max(noise, std::sqrt(other / all));
  }
  CHECK(noise < 0.3);
  REQUIRE(zeros.size() == 3);
  CHECK(zeros[2] - zeros[0] == near(50).epsilon(0.02));  // 1.1 % too short, as with SymplecticTime
}

}  // namespace sph_waves_test
