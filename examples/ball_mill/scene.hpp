// silt - BSD-3-Clause, see LICENSE
#pragma once

// The mill's scene: a drum with eight lifters (drum.hpp), balls by Bond's distribution
// (charge.hpp), and how it is filled.
//
//   ball_mill::Scene s;
//   auto sim = ball_mill::filled_mill(s, threads);
//   sim.set_motion("drum", ball_mill::turning(sim.time(), s.rate()));
//   sim.run(s.turn(), silt::vtk_series("out", silt::every(0.05)));

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <silt/silt.hpp>

#include "ball_mill/charge.hpp"
#include "ball_mill/drum.hpp"

namespace ball_mill {

using silt::Vec3d;
using Law = silt::HertzMindlin;

struct Scene {
  std::string name = "500";  // of the case
  double length = 0.1;       // [m] along the axis, which the paper does not give
  bool periodic = false;     // along the axis, without end walls
  double restitution = 0.3;  // [-] this and the friction: where --scan comes nearest; those of the
  double friction = 0.2;     // [-] paper, 0.39 and 0.496, belong to its own law
  double modulus = 1e8;      // [Pa] as in the paper; of steel 2.1e11
  double before = 1, turns = 2;  // [-] turns of the drum before it is filmed, and while it is
  std::size_t frames = 100;      // [-]
  std::size_t seed = 1;          // of the places and the order in which balls are put in
  static constexpr double poisson_ratio = 0.29;
  static constexpr double pixel = 1e-3;  // [m]

  const Mill& drum() const { return mill(name); }
  double radius() const { return drum().radius; }                                 // [m]
  double rate() const { return turns_a_minute(drum()) * std::numbers::pi / 30; }  // [rad/s]
  double turn() const { return 60 / turns_a_minute(drum()); }                     // [s]
  Law::Material steel() const {
    return {.youngs_modulus = modulus,
            .poisson_ratio = poisson_ratio,
            .restitution = restitution,
            .friction = friction};
  }
};

/// Seen along y the drum rotates clockwise: the bed is high on the left, as in the paper.
inline silt::Motion turning(double now, double rate) {
  return silt::from(now, silt::rotation({0, 0, 0}, {0, 1, 0}, rate));
}

/// Diameters [m] of all balls, in the order of insertion.
inline std::vector<double> ball_sizes(const Scene& s, silt::Random& random) {
  std::vector<double> out;
  const auto classes = bond_classes(s.drum().least);
  const auto counts = ball_counts(s.drum(), s.length);
  for (std::size_t k = 0; k < classes.size(); ++k)
    out.insert(out.end(), counts[k], classes[k].diameter);
  for (std::size_t k = out.size() - 1; k > 0; --k) std::swap(out[k], out[random.index(k + 1)]);
  return out;
}

/// The domain, periodic along the axis; it replaces end walls.
inline silt::PeriodicBox period(const Scene& s) {
  const double R = s.radius();
  return {{{-R, 0, -R}, {R, s.length, R}}, {false, true, false}};
}

/// The drum with these balls; further policies of the simulation follow.
template <class... Policies>
auto make_mill(const Scene& s, silt::Particles<silt::Sphere> balls, int threads,
               const Policies&... policies) {
  const double R = s.radius(), L = s.length;
  silt::Simulation sim{std::move(balls), silt::Contacts<Law>{s.steel()}, policies...};
  sim.threads = threads;
  sim.gravity = {0, 0, -gravity};
  sim.guard.domain = silt::Box{{-R, -L, -R}, {R, 2 * L, R}};
  sim.add_wall(drum_surfaces(R, L, !s.periodic), s.steel(), {.name = "drum"});
  return sim;
}

/// Balls of the next sizes at free lattice sites in the free upper part of the drum; those placed
/// are removed from the end of `sizes`.
template <class IsFree>
silt::Particles<silt::Sphere> batch(const Scene& s, std::vector<double>& sizes,
                                    silt::Random& random, const IsFree& is_free) {
  silt::Particles<silt::Sphere> out;
  const double pitch = 1.03 * make_up, reach = s.radius() - lifter_size - 0.52 * make_up;
  const int layers = std::max(1, static_cast<int>(s.length / pitch));
  const int across = static_cast<int>(2 * reach / pitch) + 1;
  for (int z = 0; z * pitch < reach; ++z)
    for (int x = 0; x < across; ++x)
      for (int y = 0; y < layers && !sizes.empty(); ++y) {
        const double slack = 0.5 * (make_up - sizes.back());
        const auto jitter = [&] { return random.uniform(-1, 1) * slack; };
        const Vec3d at{(x - 0.5 * (across - 1)) * pitch + jitter(),
                       (y + 0.5) * s.length / layers + jitter(),
                       0.1 * reach + z * pitch + jitter()};
        if (std::hypot(at.x, at.z) > reach || !is_free(at, 0.5 * sizes.back())) continue;
        out.add({.position = at,
                 .radius = 0.5 * sizes.back(),
                 .density = steel_density,
                 .velocity = {0.1 * random.uniform(-1, 1), 0, -0.5}});
        sizes.pop_back();
      }
  return out;
}

/// The drum, filled and at rest, with the case's number of balls.
template <class... Policies>
auto filled_mill(const Scene& s, int threads, const Policies&... policies) {
  silt::Random random(s.seed);
  auto sizes = ball_sizes(s, random);
  auto sim = make_mill(s, batch(s, sizes, random, [](const Vec3d&, double) { return true; }),
                       threads, policies...);
  const double fall = 1.2 * std::sqrt(2 * s.radius() / gravity);  // [s]
  const auto is_free = [&](const Vec3d& x, double radius) {
    for (std::size_t k = 0; k < sim.rows(); ++k) {
      Vec3d way = sim.position(k) - x;
      if (s.periodic) way.y -= s.length * std::round(way.y / s.length);
      if (norm(way) < 1.001 * (sim.radius(k) + radius)) return false;
    }
    return true;
  };
  while (!sizes.empty()) {
    sim.run(fall);
    const std::size_t before = sizes.size();
    auto more = batch(s, sizes, random, is_free);
    silt::require(sizes.size() < before,
                  "ball_mill: the balls do not fit into the drum; take a longer one");
    sim.add(more);
  }
  sim.run(2 * fall);
  return sim;
}

}  // namespace ball_mill
