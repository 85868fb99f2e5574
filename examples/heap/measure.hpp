// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is measured of the heap: its slope, run-out and solid fraction.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <silt/eigen.hpp>

#include "heap/scene.hpp"

namespace heap {

/// The heap at rest, seen across the channel.
class Heap {
 public:
  template <class Sim>
  Heap(const Scene& s, const Sim& sim) : scene_(s) {
    for (std::size_t k = 0; k < sim.rows(); ++k) {
      if (!std::isfinite(sim.mass(k))) continue;  // glued
      const Vec3d v = sim.velocity(k);
      centres_.push_back(sim.position(k));
      energy_ += 0.5 * sim.mass(k) * dot(v, v) / (sim.mass(k) * 9.81 * s.diameter());
    }
    energy_ /= static_cast<double>(centres_.size());
    const double d = s.diameter(), high = 0.4 * s.length;
    fraction_ = solid(d, s.length / 2, d, high) / ((s.length / 2 - d) * s.width * (high - d));
  }

  std::size_t grains() const { return centres_.size(); }
  double kinetic_energy() const { return energy_; }    // [-] mean, over weight times diameter
  double solid_fraction() const { return fraction_; }  // [-] of the middle of the column's foot

  double place(int k) const { return (k + 0.5) * cell(); }  // [m]
  int columns() const { return static_cast<int>(scene_.channel / cell()); }
  /// Height [m] of column k if its solid were packed as in the heap's toe.
  double height(int k) const {
    return solid(k * cell(), (k + 1) * cell(), -1, 1) / (cell() * scene_.width * fraction_);
  }

  /// [m] at which the heap is lower than half a grain.
  double front() const {
    for (int k = 1; k < columns(); ++k) {
      const double here = height(k), before = height(k - 1), least = scene_.grain;
      if (here < least) return place(k) - (least - here) / std::max(before - here, 1e-300) * cell();
    }
    return scene_.channel;
  }
  /// Slope [degrees] of the straight line through the heights between the last column higher than
  /// four fifths of the crest and the first lower than a fifth. This excludes the round crest and
  /// the thin toe.
  double angle() const {
    double crest = 0;
    for (int k = 0; k < columns(); ++k) crest = std::max(crest, height(k));
    int from = columns();
    while (from > 0 && height(from - 1) < 0.8 * crest) --from;
    std::vector<double> places, heights;  // [m]
    for (int k = from; k < columns() && height(k) >= 0.2 * crest; ++k) {
      places.push_back(place(k)), heights.push_back(height(k));
    }
    if (places.size() < 3) return std::nan("");
    return std::atan(-silt::fit_straight_line(places, heights).slope) * 180 / std::numbers::pi;
  }

 private:
  double cell() const { return scene_.grain; }
  /// Volume [m3] of grains, taken as balls, in the slab from x0 to x1 and from z0 to z1; exact
  /// unless both cut the same ball.
  double solid(double x0, double x1, double z0, double z1) const {
    const auto below = [&](double way) {  // share of a ball below a plane
      const double t = std::clamp(0.5 + way / scene_.diameter(), 0.0, 1.0);
      return t * t * (3 - 2 * t);
    };
    double share = 0;
    for (const Vec3d& c : centres_)
      share += (below(x1 - c.x) - below(x0 - c.x)) * (below(z1 - c.z) - below(z0 - c.z));
    return share * Sphere::volume(scene_.grain);
  }

  const Scene& scene_;
  std::vector<Vec3d> centres_;
  double energy_ = 0, fraction_ = 0;
};

/// The collapse of a column.
struct Collapse {
  Heap bed, heap;        // before and after
  double opened, ended;  // [s]
  double bed_height;     // [m]
  double column;         // [m] its length

  double run_out() const { return heap.front() / column - 1; }  // [-] over its length
  double aspect() const { return bed_height / column; }         // [-] of the column
};

}  // namespace heap
