// silt - BSD-3-Clause, see LICENSE
#pragma once

// The wet mill's scene: slurry (SPH) in the pores between the balls and around them.
//
//   auto dry = ball_mill::filled_mill(s, threads);
//   auto sim = ball_mill::wet_mill(s, ball_mill::Slurry{}, dry, threads);

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include <silt/measure/polynomial_fit.hpp>
#include <silt/sph.hpp>

#include "ball_mill/scene.hpp"

namespace ball_mill {

struct Slurry {
  double spacing = 5e-3;                       // [m] of the particles, as in the paper
  double density = 1400, viscosity = 0.01134;  // [kg/m3], [Pa s]
  double share = 0.2;      // [-] of the drum's volume: what balls leave of the half that is filled
  double sound = 18;       // [m/s] seven times what 999 of 1000 particles stay below
  double alpha = 0.1;      // [-] artificial viscosity, for stability
  double smoothing = 0.8;  // [-] h over sqrt(3) spacings
  double courant = 1;      // [-] of the time step
  double kinematic() const { return viscosity / density; }  // [m2/s]
};

/// Distance [m] of a point from the lifters; one lifter is at half a pitch from the x axis.
inline double from_lifters(const Scene& s, const Vec3d& x) {
  const double pitch = 2 * std::numbers::pi / lifter_count;
  const double turn = std::remainder(std::atan2(x.z, x.x) - 0.5 * pitch, pitch);
  const double r = std::hypot(x.x, x.z), h = lifter_size;
  const double below = s.radius() - h - r * std::cos(turn);
  const double beside = std::abs(r * std::sin(turn)) - 0.5 * h;
  return below > 0 && beside > 0 ? std::hypot(below, beside) : std::max(below, beside);
}

/// Lattice sites in the free space of the drum, outside the balls: the lowest ones, as many as the
/// slurry volume needs. inside(x) for Sph::fill.
class SlurryPlaces {
 public:
  template <class Sim>
  SlurryPlaces(const Scene& s, const Slurry& slurry, const Sim& dry) : s_(s), slurry_(slurry) {
    for (std::size_t k = 0; k < dry.rows(); ++k) balls_.push_back({dry.position(k), dry.radius(k)});
    const double a = slurry.spacing, R = s.radius();
    std::vector<double> heights;
    for (double z = -R + 0.5 * a; z < R; z += a)
      for (double x = -R + 0.5 * a; x < R; x += a)
        for (double y = 0.5 * a; y < s.length; y += a)
          if (is_free({x, y, z})) heights.push_back(z);
    const double steps = slurry.share * std::numbers::pi * R * R * s.length / (a * a * a);
    const auto count = static_cast<std::size_t>(std::lround(steps));
    silt::require(count > 0 && count <= heights.size(), "ball_mill: a slurry of ", count,
                  " particles does not fit into the drum");
    // The layer up to which there are about as many.
    std::nth_element(heights.begin(), heights.begin() + static_cast<std::ptrdiff_t>(count) - 1,
                     heights.end());
    const double last = heights[count - 1];
    const auto up_to = [&](double z) {
      return std::count_if(heights.begin(), heights.end(), [&](double h) { return h < z; });
    };
    const auto with = static_cast<double>(up_to(last + 0.25 * a)),
               without = static_cast<double>(up_to(last - 0.25 * a));
    level_ = last + (with - steps < steps - without ? 0.25 : -0.75) * a;
  }
  bool operator()(const Vec3d& x) const { return x.z < level_ && is_free(x); }
  double level() const { return level_; }  // [m]

 private:
  struct Ball {
    Vec3d centre;
    double radius;
  };
  bool is_free(const Vec3d& x) const {
    const double half = 0.499 * slurry_.spacing;
    if (std::hypot(x.x, x.z) > s_.radius() - half || x.y > s_.length - half || x.y < half ||
        from_lifters(s_, x) < half)
      return false;
    for (const Ball& b : balls_)
      if (norm(x - b.centre) < b.radius) return false;
    return true;
  }
  Scene s_;
  Slurry slurry_;
  std::vector<Ball> balls_;
  double level_ = 0;
};

inline auto make_slurry(const Scene& s, const Slurry& slurry) {
  const double R = s.radius();
  return silt::Sph{silt::Liquid{.density = slurry.density, .sound_speed = slurry.sound},
                   {.spacing = slurry.spacing,
                    .region = {{-R, 0, -R}, {R, s.length, R}},
                    .smoothing = slurry.smoothing,
                    .gravity = {0, 0, -gravity},
                    .courant = slurry.courant},
                   silt::LaminarViscosity{.kinematic = slurry.kinematic(), .alpha = slurry.alpha},
                   silt::MirroredWalls{},
                   silt::RestoredVolume{},
                   silt::Mixed{}};
}

/// The settled balls, with slurry between and over them.
template <class Dry>
auto wet_mill(const Scene& s, const Slurry& slurry, const Dry& dry, int threads) {
  auto water = make_slurry(s, slurry);
  // A particle that leaves all others loses, by the continuity equation, their contribution to the
  // kernel sum, up to 0.8 of its density, and regains it on return. Approaching balls squeeze the
  // slurry between them; a particle that they throw at half the speed of sound hits the end of the
  // drum with 1.6 times its density (once in 6 s).
  water.least_density = 0.1, water.most_density = 2;
  water.fill(SlurryPlaces(s, slurry, dry));
  silt::Particles<silt::Sphere> balls;
  for (std::size_t k = 0; k < dry.rows(); ++k)
    balls.add({.position = dry.position(k), .radius = dry.radius(k), .density = steel_density});
  auto sim = make_mill(s, std::move(balls), threads, std::move(water));
  // A step of the slurry is a whole number of the balls' steps, as many as its fastest pairs allow:
  // with short steps of the balls it comes closer to the limit (Sph::steps_wanted).
  const auto& setup = sim.fluid().setup();
  sim.time_step = std::min(dry.step_length(), setup.courant * setup.h() / (6 * slurry.sound));
  return sim;
}

}  // namespace ball_mill
