// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is measured: where the bed's surface is, the way of the body, and the books of momentum,
// spin and energy.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <silt/eigen.hpp>

#include "crater/scene.hpp"

namespace crater {

/// Height of the bed's surface: the solid volume above a height, packed as below it.
class Surface {
 public:
  template <class Sim>
  Surface(const Scene& s, const Sim& sim) : scene_(s) {
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (sim.is_present(k)) grains_.push_back({sim.position(k), sim.radius(k)});
    const double radius = 0.8 * s.pot(), area = std::numbers::pi * radius * radius;  // [m], [m2]
    const auto inside = [&](const Vec3d& p) { return std::hypot(p.x, p.y) < radius; };
    const double low = 0.2 * s.bed(), high = 0.7 * s.bed();
    const double over = solid_over(low, inside);
    fraction_ = (over - solid_over(high, inside)) / (area * (high - low));
    level_ = low + over / (fraction_ * area);
  }
  double level() const { return level_; }        // [m]
  double fraction() const { return fraction_; }  // [-] of solid
  /// Slope [degrees] towards +x of the middle of the surface, from strips across x.
  double slope() const {
    const double width = 2 * scene_.grain, half = 0.3 * scene_.pot(), low = 0.2 * scene_.bed();
    std::vector<double> middles, heights;  // [m]
    for (double at = -0.7 * scene_.pot(); at < 0.7 * scene_.pot(); at += width) {
      const double over = solid_over(low, [&](const Vec3d& p) {
        return std::abs(p.y) < half && p.x >= at && p.x < at + width;
      });
      middles.push_back(at + width / 2), heights.push_back(over / (fraction_ * 2 * half * width));
    }
    return std::atan(silt::fit_straight_line(middles, heights).slope) * 180 / std::numbers::pi;
  }

 private:
  struct Grain {
    Vec3d at;
    double radius;
  };
  /// [m3] above a height, of grains whose centres are inside.
  template <class Inside>
  double solid_over(double height, const Inside& inside) const {
    double sum = 0;
    for (const Grain& p : grains_) {
      const double t = std::clamp(0.5 + 0.5 * (p.at.z - height) / p.radius, 0.0, 1.0);
      if (t > 0 && inside(p.at)) sum += silt::Sphere::volume(p.radius) * t * t * (3 - 2 * t);
    }
    return sum;
  }

  const Scene& scene_;
  std::vector<Grain> grains_;
  double level_ = 0, fraction_ = 0;
};

/// Position, velocity and angular velocity of each grain, by its id.
struct State {
  std::map<std::uint64_t, std::array<Vec3d, 3>> grains;
  template <class Sim>
  explicit State(const Sim& sim) {
    for (std::size_t k = 0; k < sim.rows(); ++k)
      grains[sim.id(k)] = {sim.position(k), sim.velocity(k), sim.angular_velocity(k)};
  }
  /// Number of grains that are not exactly equal to these.
  std::size_t differ(const State& from) const {
    std::size_t count = grains.size() > from.grains.size() ? 0 : from.grains.size() - grains.size();
    for (const auto& [id, state] : grains) {
      const auto other = from.grains.find(id);
      count += other == from.grains.end() || state != other->second;
    }
    return count;
  }
};

/// Results of settling: the checkpoint, and what was measured in the bed.
struct Bed {
  std::string file;
  State state;
  double level, fraction, step, slope;                          // [m], [-] of solid, [s], [degrees]
  double density() const { return fraction * Scene::density; }  // [kg/m3] of the bed
};

/// State of the body at a time, and its balances.
struct Sample {
  double time, depth, speed;  // [s] since it met the bed's level, [m], [m/s] downwards
  double force;               // [N] upwards, mean since the last sample
};

struct Outcome {
  Drop drop{};
  double depth = 0, total = 0;    // [m] at rest; [m] height of fall with it
  double stopped = 0, most = 0;   // [s] until a hundredth of the speed is left; [g] the largest
  double momentum = 0, spin = 0;  // [-] errors of the books, over those of the impact
  double lost = 0, booked = 0;    // [J] by the body; by grains: dissipated and stored
  double friction = 0;            // [J] of it
  double bears = 0;               // [-] at rest: force of the grains over its weight
  double overlap = 0;             // [-] of the radius, the largest
  std::size_t changed = 0;        // grains that are not as in the checkpoint
  double mass = 0;                // [kg] of the body
  std::vector<Sample> samples;
};

/// Observes a drop: samples, and the balances of momentum, angular momentum and energy.
class Watch {
 public:
  template <class Sim>
  Watch(const Scene& s, const Bed& bed, Outcome& out, const Sim& sim)
      : s_(s), bed_(bed), out_(out), load_(sim, "body") {
    body_ = std::get<silt::FreeBody>(sim.wall("body").drive);
    speed_ = out.drop.speed();
    impact_ = sim.time() - depth(sim) / speed_;
  }
  double mass() const { return body_.mass; }
  template <class Sim>
  double depth(const Sim& sim) const {  // [m] of the ball's lowest point below the bed's level
    return bed_.level - sim.wall("body").state.centre.z + s_.body() / 2;
  }
  /// File for a picture of the ball in motion; it is taken when the ball has lost half its speed.
  void take_picture(const std::string& folder) { folder_ = folder; }

  template <class Sim>
  void operator()(const Sim& sim) {
    compare_loads(sim);
    if (!first_) first_ = sim.energy();
    const auto mean = load_.read(sim);
    if (mean.duration == 0) return;
    const double speed = -sim.wall("body").state.velocity_now.z, time = sim.time() - impact_;
    out_.samples.push_back({time, depth(sim), speed, mean.force.z});
    out_.most = std::max(out_.most, mean.force.z / (mass() * g) - 1);
    if (out_.stopped == 0 && speed < 0.01 * speed_) out_.stopped = time;
    if (!folder_.empty() && time > 0 && speed < 0.5 * speed_) {
      silt::write_particles(folder_ + "/early.vtp", sim);
      silt::write_walls(folder_ + "/early_walls.vtp", sim);
      folder_.clear();
    }
  }
  /// Energy lost by the body since the first sample, and its distribution in the ledger.
  template <class Sim>
  void close_books(const Sim& sim) {
    const silt::EnergyBalance end = sim.energy();
    out_.lost = first_->free_walls - end.free_walls;
    out_.booked = end.held() - first_->held() + end.dissipated() - first_->dissipated();
    out_.friction = end.friction - first_->friction;
  }

 private:
  /// Momentum, and angular momentum about the vertical through the reference, minus the impulses of
  /// loads and weight: both must stay constant. Velocities are those of the half step, to which all
  /// loads so far have contributed.
  template <class Sim>
  void compare_loads(const Sim& sim) {
    const auto& wall = sim.wall("body");
    const auto& state = wall.state;
    const Vec3d given = wall.impulse + sim.time() * mass() * sim.gravity;
    const Vec3d momentum = mass() * state.velocity - given;
    const double spin = mass() * cross(state.centre - wall.reference, state.velocity).z +
                        rotate(state.turn, state.momentum).z - wall.angular_impulse.z;
    if (!first_) momentum_ = momentum, spin_ = spin;
    const double impact = mass() * speed_;  // [N s]
    out_.momentum = std::max(out_.momentum, norm(momentum - momentum_) / impact);
    out_.spin = std::max(out_.spin, std::abs(spin - spin_) / (impact * s_.body()));
  }

  const Scene& s_;
  const Bed& bed_;
  Outcome& out_;
  silt::MeanLoad load_;
  silt::FreeBody body_{};
  std::string folder_;
  double speed_ = 0, impact_ = 0;  // [m/s], [s]
  std::optional<silt::EnergyBalance> first_;
  Vec3d momentum_{};
  double spin_ = 0;
};

}  // namespace crater
