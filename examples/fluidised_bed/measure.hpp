// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is measured of the bed: pressure drop, what floor and walls bear, heights and voidages,
// while the gas is stepped up and down and while the bed bubbles.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "fluidised_bed/scene.hpp"

namespace fluidised {

constexpr int per_diameter = 10;  // bins of a Profile

/// Volume fraction of grains in bins, by the heights of their centres [-].
using Profile = std::vector<double>;

/// Over a time.
struct Means {
  double pressure_drop = 0, floor = 0, walls = 0;  // [Pa] over the area: what they bear
  double momentum = 0;                             // [Pa] that grains gain
  double height = 0;                               // [m]
  double speed = 0;                                // [m/s] of the grains
  double time = 0;                                 // [s] of which these are means
  Profile centres{};                               // at the end

  double borne() const { return pressure_drop + floor + walls; }
  /// Force balance error: supporting force minus weight and momentum gain of the bed, over the
  /// weight [-].
  double unbalanced(double weight) const { return (borne() - momentum) / weight - 1; }
  /// Extends the means by the time of `next`, which follows.
  void go_on(const Means& next) {
    const double both = time + next.time;
    const auto join = [&](double& mean, double other) {
      mean = (mean * time + other * next.time) / both;
    };
    join(pressure_drop, next.pressure_drop), join(floor, next.floor), join(walls, next.walls);
    join(momentum, next.momentum), join(height, next.height), join(speed, next.speed);
    time = both, centres = next.centres;
  }
};

/// The bed in its gas.
template <class Sim>
class Bed {
 public:
  Bed(const Scene& s, Sim& sim) : s_(s), sim_(sim) {}

  /// Brings the gas to the superficial velocity U [m/s] in 10 ms, then waits for the rest of `span`
  /// [s].
  template <class... Observers>
  void blow(double U, double span, Observers&&... observers) {
    constexpr double ramp = 0.01;  // [s]
    const double from = std::exchange(U_, U), since = sim_.time();
    sim_.fluid().flow().set_side(
        2, 0, silt::Inflow{.velocity_in_time = [=](const Vec3d&, double t) {
          return Vec3d{0, 0, std::lerp(from, U, std::clamp((t - since) / ramp, 0.0, 1.0))};
        }});
    sim_.run(std::max(span, ramp), observers...);
  }
  template <class... Observers>
  Means measure(double span, Observers&&... observers) {
    Means sum;
    double n = 0;
    const double before = momentum(), start = sim_.time();
    const auto given = impulses();
    sim_.run(span,
             silt::at(silt::every(2e-4),
                      [&](const auto&) {
                        sum.pressure_drop += pressure_drop();
                        sum.height += height(), sum.speed += sim_.mean_speed();
                        n += 1;
                      }),
             observers...);
    sum.time = sim_.time() - start, sum.centres = centres();
    sum.pressure_drop /= n, sum.height /= n, sum.speed /= n;
    const double per_area = 1 / (sum.time * s_.area());
    const auto now = impulses();
    sum.floor = -(now[0] - given[0]) * per_area;
    sum.walls = -(now[1] + now[2] - given[1] - given[2]) * per_area;
    sum.momentum = (momentum() - before) * per_area;
    return sum;
  }

  /// Of the gas between the floor and its outlet [Pa]. Between the floor and the first cells'
  /// centres the gradient is that of the drag there.
  double pressure_drop() {
    auto& flow = sim_.fluid().flow();
    const bool bears = flow.responds() && flow.response().bears;
    double sum = 0;
    for (int j = 0; j < s_.deep; ++j)
      for (int i = 0; i < s_.across; ++i) {
        const double push =
            flow.drag()(i, j, 0) * flow.velocity(2)(i, j, 0) - flow.drag_velocity(2)(i, j, 0);
        const double share = flow.voidage()(i, j, 0) + (bears ? flow.response().borne(i, j, 0) : 0);
        sum += flow.pressure()(i, j, 0) + 0.5 * s_.cell * push / share;
      }
    return sum / (s_.across * s_.deep);
  }
  /// Height of the bed's surface above the floor [m]: where cell layers contain half of the mean
  /// solid fraction (mean from the floor to twice the height of the centre of mass).
  double height() const {
    double twice = 0;  // [m]
    for (std::size_t k = 0; k < sim_.rows(); ++k) twice += 2 * sim_.position(k).z;
    twice /= static_cast<double>(sim_.rows());
    const double half = 0.5 * (1 - voidage(twice));
    double above = 0;
    for (int k = s_.high - 1; k >= 0; --k) {
      const double here = 1 - voidage_of_layer(k);
      if (here >= half) return s_.cell * (k + 0.5 + (here - half) / (here - above));
      above = here;
    }
    return twice;  // no layer holds as much
  }
  Profile centres() const {
    const double h = s_.diameter / per_diameter, grain = s_.volume() / (s_.area() * h);
    Profile all;
    for (std::size_t k = 0; k < sim_.rows(); ++k) {
      const double z = std::max(sim_.position(k).z / h - 0.5, 0.0);
      const auto low = static_cast<std::size_t>(z);
      if (low + 1 >= all.size()) all.resize(low + 2);
      const double upper = z - static_cast<double>(low);
      all[low] += (1 - upper) * grain, all[low + 1] += upper * grain;
    }
    return all;
  }
  double top() const {  // [m] of the highest grain's centre
    double most = 0;
    for (std::size_t k = 0; k < sim_.rows(); ++k) most = std::max(most, sim_.position(k).z);
    return most;
  }
  double voidage(double height) const {
    return 1 - static_cast<double>(s_.particles) * s_.volume() / (s_.area() * height);
  }
  double voidage_of_layer(int k) const {
    const auto& eps = sim_.fluid().flow().voidage();
    double sum = 0;
    for (int j = 0; j < s_.deep; ++j)
      for (int i = 0; i < s_.across; ++i) sum += eps(i, j, k);
    return sum / (s_.across * s_.deep);
  }

 private:
  /// [N s] upward impulse on floor and walls, including short impacts.
  std::array<double, floor_and_walls> impulses() const {
    std::array<double, floor_and_walls> given{};
    for (std::size_t w = 0; w < given.size(); ++w) given[w] = sim_.wall(w).impulse.z;
    return given;
  }
  double momentum() const {  // [kg m/s] upwards
    return sim_.total_mass() * sim_.mean_velocity().z;
  }

  const Scene& s_;
  Sim& sim_;
  double U_ = 0;  // [m/s]
};

/// The gas stepped up and down: means at each of its velocities.
struct Curve {
  std::vector<double> velocities;      // [m/s]
  std::vector<Means> rising, falling;  // one of each velocity
  Means plateau;                       // where all is borne
  double unbalanced = 0;               // [-] the largest, of all means
  std::size_t packed = 0;              // velocities at which the bed rests as the gas falls

  /// The largest share of the weight [-] that the gas bears before the dense bed breaks up, and the
  /// least ratio [-] of its pressure drop to that of the loose bed.
  std::array<double, 2> overshoot(const Scene& s) const {
    double most = 0, above = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < velocities.size() && rising[k].speed < s.at_rest; ++k) {
      const double share = rising[k].pressure_drop / s.weight();
      if (share < most) break;  // it has broken up
      most = share;
      if (falling[k].speed < s.at_rest)
        above = std::min(above, rising[k].pressure_drop / falling[k].pressure_drop);
    }
    return {most, above};
  }
};

/// Velocities [m/s] up to 1.3 times the `guess` of minimum fluidisation, close to each other near
/// it.
inline std::vector<double> velocities_through(double guess, double step) {
  std::vector<double> velocities{step};
  while (velocities.back() < 1.3 * guess) {
    const double last = velocities.back();
    const bool near = last > 0.8 * guess && last < 1.15 * guess;
    velocities.push_back(last + (near ? 0.25 : 1) * step);
  }
  return velocities;
}

/// Steps the gas up and down through the velocity at which the bed should be fluidised [m/s].
template <class Sim>
Curve step_gas(const Scene& s, Bed<Sim>& bed, double guess) {
  Curve c;
  c.velocities = velocities_through(guess, s.step);
  c.falling.resize(c.velocities.size());
  const auto measure = [&](double U) {
    bed.blow(U, s.relaxing);
    Means m = bed.measure(s.averaging);
    const bool fluidised = m.speed > s.at_rest, on_plateau = fluidised && U > 1.1 * guess;
    if (fluidised) m.go_on(bed.measure(on_plateau ? s.plateau : s.moving));
    if (on_plateau) c.plateau.go_on(m);
    c.unbalanced = std::max(c.unbalanced, std::abs(m.unbalanced(s.weight())));
    std::printf("  %.3f m/s: %.1f Pa, height %.2f mm%s\n", U, m.pressure_drop, 1e3 * m.height,
                m.speed < s.at_rest ? ", at rest" : "");
    return m;
  };
  for (const double U : c.velocities) c.rising.push_back(measure(U));
  c.falling.back() = c.rising.back();
  for (std::size_t k = c.velocities.size() - 1; k-- > 0;) c.falling[k] = measure(c.velocities[k]);
  while (c.packed < c.velocities.size() && c.falling[c.packed].speed < s.at_rest) ++c.packed;
  silt::require(c.packed >= 2, "only ", c.packed,
                " velocities leave the bed at rest; take a smaller --step");
  return c;
}

/// The bubbling bed, over its last three quarters.
struct Bubbling {
  Means means;
  double highest = 0;     // [m] centre of a grain
  double bears_more = 0;  // [Pa] mean pressure less the weight above, in the lowest layer of cells
};

}  // namespace fluidised
