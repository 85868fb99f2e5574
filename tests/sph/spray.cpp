// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <silt/silt.hpp>
#include <silt/sph.hpp>

#include "near.hpp"

namespace sph_spray_test {

using namespace silt;

namespace {

// The slurry of the wet mill (examples/ball_mill).
constexpr double g = 9.81, s = 7.5e-3, rho = 1400;

template <class... Policies>
auto slurry(double side, double height, const Policies&... policies) {
  Sph out{Liquid{.density = rho, .sound_speed = 13},
          {.spacing = s,
           .region = {{0, 0, 0}, {side, side, height}},
           .smoothing = 0.8,
           .periodic = {true, true, false},
           .gravity = {0, 0, -g}},
          LaminarViscosity{.kinematic = 8.1e-6, .alpha = 0.1},
          policies...};
  out.least_density = 0.1, out.most_density = 1.5;
  return out;
}

template <class Water>
Vec3d centre(const Water& water) {
  Vec3d sum{0, 0, 0};
  double n = 0;
  water.for_each(
      [&](std::uint32_t, const Vec3d& x, const Vec3d&, double, double) { sum += x, ++n; });
  return (1 / n) * sum;
}

/// How far [m] the centre of n^3 particles that are thrown is off its parabola after 0.3 s.
double off_parabola(int n) {
  const double side = 40 * s, at = (20 + 0.5 * (n % 2)) * s, high = at + 40 * s;
  auto water = slurry(side, 80 * s, VerletTime{}, RestoredVolume{}, Mixed{});
  const Vec3d v{0.3, 0, 0.5};
  water.fill(
      [=](const Vec3d& x) {
        const double half = 0.5 * n * s;
        return std::abs(x.x - at) < half && std::abs(x.y - at) < half &&
               std::abs(x.z - high) < half;
      },
      [=](const Vec3d&) { return v; }, [](const Vec3d&) { return 0.0; });
  const Vec3d from = centre(water);
  const double t = 0.3;
  water.run(t);
  return norm(centre(water) - (from + t * v + Vec3d{0, 0, -0.5 * g * t * t}));
}

struct Rain {
  double height;    // [-] of the liquid's centre over that of as much liquid at rest
  double pressure;  // [-] its mean, over that at rest
};
/// Over a floor, or a pool of `pool` rows, one of four sites of 24 rows has a drop, 1.6 spacings
/// apart on average, which fly about at up to 0.3 m/s along each axis. As they are after 1 s.
template <class... Policies>
Rain rained(int pool, const Policies&... policies) {
  constexpr int across = 12, rows = 24;
  auto water = slurry(across * s, 160 * s, policies...);
  water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
  Random random(5);
  std::vector<bool> drops(across * across * 160);
  for (std::size_t k = 0; k < drops.size(); ++k) drops[k] = random.uniform(0, 1) < 0.25;
  water.fill(
      [&](const Vec3d& x) {
        const auto at = [](double a) { return static_cast<int>(a / s); };
        const int i = at(x.x), j = at(x.y), k = at(x.z);
        return k < pool || (k > pool && k <= pool + rows &&
                            drops[static_cast<std::size_t>((k * across + j) * across + i)]);
      },
      [&](const Vec3d& x) {
        const auto any = [&] { return random.uniform(-0.3, 0.3); };
        return x.z < pool * s ? Vec3d{0, 0, 0} : Vec3d{any(), any(), any()};
      },
      [=](const Vec3d& x) { return std::max(0.0, rho * g * (pool * s - x.z)); });
  const double depth = static_cast<double>(water.size()) * s / (across * across);
  water.run(1.0, Team{2});
  double pressure = 0;
  water.for_each(
      [&](std::uint32_t, const Vec3d&, const Vec3d&, double, double p) { pressure += p; });
  return {centre(water).z / (0.5 * depth),
          pressure / static_cast<double>(water.size()) / (0.5 * rho * g * depth)};
}

/// Speed at which a lone particle leaves a floor, over that at which it was thrown, at c/5.
template <class Scheme>
double rebound(const Scheme& scheme, double courant, double angle) {
  const double side = 40 * s, v = 2.6;
  Sph water{Liquid{.density = rho, .sound_speed = 13},
            {.spacing = s,
             .region = {{0, 0, 0}, {side, side, side}},
             .smoothing = 0.8,
             .periodic = {true, true, false},
             .courant = courant},
            LaminarViscosity{.kinematic = 8.1e-6, .alpha = 0.1},
            scheme};
  water.least_density = 0.1, water.most_density = 1.5;
  water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
  const Vec3d at{5.5 * s, 5.5 * s, 6.5 * s};
  REQUIRE(water.fill([&](const Vec3d& x) { return norm(x - at) < 0.1 * s; },
                     [&](const Vec3d&) {
                       return v * Vec3d{std::sin(angle), 0, -std::cos(angle)};
                     },
                     [](const Vec3d&) { return 0.0; }) == 1);
  water.run(13 * s / (v * std::cos(angle)));
  double leaves = 0;
  water.for_each([&](std::uint32_t, const Vec3d& x, const Vec3d& u, double, double) {
    if (x.z > 5 * s) leaves = norm(u) / v;
  });
  return leaves;
}

}  // namespace

// Catches densities that fall less in the first half of a step than in all of it: at a Courant
// number of 1 the particle left with 1.17 of its speed, and with more from every wall after.
TEST_CASE("SPH: a lone particle leaves a floor slower than it came, as fast with every step") {
  for (const double angle : {0.0, 1.0}) {
    CAPTURE(angle);
    const double converged = rebound(LeapfrogTime{}, 0.05, angle);
    MESSAGE("at ", angle, " rad: ", converged);
    CHECK(converged > 0.85);
    CHECK(converged < 0.98);
    // Second order in the step. Seen: 0.003 and 0.020 with LeapfrogTime, 0.002 with SymplecticTime.
    CHECK(near_relative(rebound(LeapfrogTime{}, 0.4, angle), converged, 0.01));
    CHECK(near_relative(rebound(LeapfrogTime{}, 1.0, angle), converged, 0.03));
    CHECK(near_relative(rebound(SymplecticTime{}, 0.3, angle), converged, 0.01));
  }
}

TEST_CASE("SPH: a particle and a drop of 64 that are thrown follow their parabola") {
  // 1e-9 m of 0.3: floats are summed from both ends of a pair, and momentum is kept to 1e-7.
  CHECK(off_parabola(1) < 1e-12);
  CHECK(off_parabola(4) < 1e-9);
}

TEST_CASE("SPH: drops that rain on a floor or into a pool come together to a liquid at rest") {
  // 8 % (4 %): the last drops sink in slowly; kernels at the surface lack neighbours.
  const auto on_floor = rained(0, VerletTime{}, RestoredVolume{}, Mixed{});
  MESSAGE("floor: centre ", on_floor.height, ", pressure ", on_floor.pressure);
  CHECK(on_floor.height == near(1).epsilon(0.08));
  const auto in_pool = rained(6, VerletTime{}, RestoredVolume{}, Mixed{});
  MESSAGE("pool: centre ", in_pool.height, ", pressure ", in_pool.pressure);
  CHECK(in_pool.height == near(1).epsilon(0.04));
}

TEST_CASE("SPH: without RestoredVolume rain comes down, and takes up to half as much room again") {
  const auto verlet = rained(0, VerletTime{}, DriftingVolume{});
  MESSAGE("VerletTime: centre ", verlet.height, ", pressure ", verlet.pressure);
  CHECK(verlet.height < 1.6);
  const auto symplectic = rained(0, SymplecticTime{}, DriftingVolume{}, Mixed{});
  MESSAGE("SymplecticTime: centre ", symplectic.height, ", pressure ", symplectic.pressure);
  CHECK(symplectic.height < 1.6);
}

/// Scattered particles that rain on a floor in a periodic slice: what the books leave unexplained,
/// over the energy at the start [-].
template <class Time, class Volume = DriftingVolume>
double unexplained(const std::string& name, Time time, double courant = 0.2,
                   const Volume& volume = {}) {
  constexpr int across = 10;
  Sph water{Liquid{.density = 1000, .sound_speed = 20},
            {.spacing = 0.01,
             .region = {{0, 0, 0}, {across * 0.01, 0, 1}},
             .dimensions = 2,
             .periodic = {true, false, false},
             .gravity = {0, 0, -g},
             .courant = courant},
            ArtificialViscosity{.alpha = 0.1},
            time,
            volume,
            EnergyLedger{}};
  water.least_density = 0.1;
  water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
  Random random(2);
  water.fill([&](const Vec3d& x) { return x.z < 0.5 && random.uniform(0, 1) < 0.3; },
             [&](const Vec3d&) {
               return Vec3d{random.uniform(-0.3, 0.3), 0, random.uniform(-0.3, 0.3)};
             },
             [](const Vec3d&) { return 0.0; });
  const double start = water.energy().held();
  water.run(0.5);
  const auto books = water.energy();
  MESSAGE(name, ": tension ", books.tension, ", residual ", books.residual(), " of ", start);
  CHECK(books.tension > 0.001 * start);
  CHECK((std::abs(books.restored) > 0.001 * start) == Volume::restores);
  return std::abs(books.residual()) / start;
}

// Catches a loss that is booked for the length of a leap of VerletTime, two steps, once a step, and
// one that is the energy of the tension removed at the end of a step, instead of what the particle
// held and pressure did on it: 1.07, 0.35 and 0.28 % here, 5.3 and 2.7 % with VerletTime.
TEST_CASE("SPH: the pressure that spray gives up is in the books of energy") {
  // Second order in the step, as the rest of the books: 1e-4 and 1.2e-5 at a third of the
  // step, 1.4e-4 with SymplecticTime. VerletTime sums works by trapezia over steps in which
  // densities that are held jump: 0.22 and 0.12 %, first order.
  const double usual = unexplained("leapfrog", LeapfrogTime{}, 0);
  CHECK(usual < 5e-4);
  CHECK(unexplained("leapfrog, a third of the step", LeapfrogTime{}) < 0.25 * usual);
  CHECK(unexplained("symplectic", SymplecticTime{}) < 5e-4);
  const RestoredVolume restored{};  // 1.1e-3 and 1.2e-5
  CHECK(unexplained("restored", LeapfrogTime{}, 0, restored) < 3e-3);
  CHECK(unexplained("restored, a third", LeapfrogTime{}, 0.2, restored) < 1e-4);
  const double coarse = unexplained("Verlet", VerletTime{}),
               fine = unexplained("Verlet, half the step", VerletTime{}, 0.1);
  CHECK(coarse < 0.005);
  CHECK(fine < 0.7 * coarse);
}

// Catches the same: 1.5 and 0.74 % for a drop that spreads on a plane.
TEST_CASE("SPH: books of a drop that hits a plane close in second order") {
  const auto residual = [](double courant) {
    Sph water{Liquid{.density = 1000, .sound_speed = 20},
              {.spacing = 0.01,
               .region = {{-0.5, 0, -0.1}, {0.5, 0, 0.5}},
               .dimensions = 2,
               .courant = courant},
              ArtificialViscosity{.alpha = 0.1},
              DriftingVolume{},
              EnergyLedger{}};
    water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
    water.fill([](const Vec3d& x) { return std::hypot(x.x, x.z - 0.06) < 0.055; },
               [](const Vec3d&) {
                 return Vec3d{0, 0, -1};
               });
    const double start = water.energy().held();
    water.run(0.1);
    CHECK(water.energy().tension > 0.005 * start);  // 0.6 %
    return std::abs(water.energy().residual()) / start;
  };
  const double usual = residual(0.6);
  CHECK(usual < 2e-3);  // 1.0e-3
  CHECK(residual(0.3) < 0.35 * usual);
}

}  // namespace sph_spray_test
