// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is measured behind the bend: where particles pass cross-sections of the pipe, and how fast.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "bend/scene.hpp"

namespace bend {

/// Particles crossing the sections behind the bend, and their axial velocities.
class Measured {
 public:
  static constexpr int bins = 10;
  static constexpr double slice = 0.25;  // [D] half thickness of a cross-section
  struct Passing {
    double across, z, speed;  // [D] from the inner wall; [D]; [m/s] along the pipe
  };

  explicit Measured(const Scene& s) : scene_(s), along_(static_cast<std::size_t>(last() * 2)) {}
  int last() const { return static_cast<int>(scene_.outlet / scene_.D + 1e-9); }  // [D]

  template <class Sim>
  void add(const Sim& sim) {
    for (std::size_t k = 0; k < sim.rows(); ++k) {
      if (!sim.is_present(k)) continue;
      const Vec3d x = sim.position(k), v = sim.velocity(k);
      const double y = (x.y - scene_.bend) / scene_.D;
      if (y < -slice || x.x < scene_.bend - scene_.D) continue;
      const auto at = static_cast<std::size_t>(std::lround(y));
      if (std::abs(y - static_cast<double>(at)) <= slice) {
        if (sections_.size() <= at) sections_.resize(at + 1);
        sections_[at].push_back({(x.x - scene_.bend) / scene_.D + 0.5, x.z / scene_.D, v.y});
      }
      const auto piece = static_cast<std::size_t>(std::max(0.0, 2 * y));
      if (piece < along_.size()) along_[piece].sum += v.y, along_[piece].count += 1;
    }
  }
  const std::vector<Passing>& section(int at) const {
    static const std::vector<Passing> none;
    const auto k = static_cast<std::size_t>(at);
    return k < sections_.size() ? sections_[k] : none;
  }
  /// Fraction of the particles in each tenth of the diameter.
  std::array<double, bins> histogram(int at) const {
    std::array<double, bins> share{};
    for (const auto& p : section(at)) share[bin(p)] += 1 / static_cast<double>(section(at).size());
    return share;
  }
  /// [m/s] mean in each tenth; NaN where there are fewer than 10 particles.
  std::array<double, bins> speeds(int at) const {
    std::array<double, bins> sum{}, count{};
    for (const auto& p : section(at)) sum[bin(p)] += p.speed, count[bin(p)] += 1;
    for (std::size_t k = 0; k < bins; ++k)
      sum[k] = count[k] < 10 ? std::numeric_limits<double>::quiet_NaN() : sum[k] / count[k];
    return sum;
  }
  double mean_across(int at) const {
    return mean(at, [](const Passing& p) { return p.across; });
  }
  double mean_z(int at) const {
    return mean(at, [](const Passing& p) { return p.z; });
  }
  /// [D] rms distance from their mean position.
  double spread(int at) const {
    const double x = mean_across(at), z = mean_z(at);
    return std::sqrt(mean(at, [&](const Passing& p) {
      return (p.across - x) * (p.across - x) + (p.z - z) * (p.z - z);
    }));
  }
  double place(std::size_t piece) const { return 0.5 * (static_cast<double>(piece) + 0.5); }  // [D]
  std::size_t pieces() const { return along_.size(); }
  double speed(std::size_t piece) const {
    return along_[piece].sum / std::max(1.0, along_[piece].count);
  }
  /// [D] distance behind the bend at which particles are slowest.
  double slowest() const {
    std::size_t best = 0;
    for (std::size_t k = 0; k < along_.size(); ++k)
      if (speed(k) < speed(best) && along_[k].count > 0) best = k;
    return place(best);
  }

 private:
  static std::size_t bin(const Passing& p) {
    return static_cast<std::size_t>(std::clamp(p.across * bins, 0.0, bins - 1.0));
  }
  template <class Of>
  double mean(int at, const Of& of) const {
    double sum = 0;
    for (const auto& p : section(at)) sum += of(p);
    return sum / static_cast<double>(std::max<std::size_t>(1, section(at).size()));
  }
  struct Sum {
    double sum = 0, count = 0;
  };
  const Scene& scene_;
  std::vector<std::vector<Passing>> sections_;  // by D behind the bend
  std::vector<Sum> along_;                      // of half a D each
};

/// What one model of the gas gave.
struct Run {
  Measured measured;
  double flow_error = 0;                    // [-] of the gas, out over in
  double clipped = 0;                       // [m3] of solids
  double y_plus = 0, drop = 0;              // [-]; [Pa] of the gas, mean
  double placed = 0, left = 0, inside = 0;  // particles
  double fluid_steps = 0, seconds = 0;      // [-], [s] of wall time
};

/// Half the sum of absolute differences of two histograms: 0 identical, 1 without a common
/// particle.
inline double difference(const Measured& a, const Measured& b, int at) {
  double sum = 0;
  const auto p = a.histogram(at), q = b.histogram(at);
  for (std::size_t k = 0; k < p.size(); ++k) sum += 0.5 * std::abs(p[k] - q[k]);
  return sum;
}

}  // namespace bend
