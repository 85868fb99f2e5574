// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is measured of the wet mill: the surface of the slurry, torques, speeds and densities, and
// slurry in the air.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "ball_mill/pores.hpp"
#include "ball_mill/slurry.hpp"

namespace ball_mill {

/// Highest slurry at each position along x, in the middle of the drum, frame by frame.
class Heights {
 public:
  Heights(const Scene& s, const Slurry& slurry)
      : radius_(s.radius()),
        middle_(0.5 * s.length),
        width_(slurry.spacing),
        of_(static_cast<std::size_t>(std::ceil(2 * radius_ / width_))) {}
  template <class Water>
  void add_frame(const Water& water) {
    constexpr double none = -std::numeric_limits<double>::infinity();
    std::vector<double> highest(of_.size(), none);
    water.for_each([&](std::uint32_t, const Vec3d& x, const Vec3d&, double, double) {
      const auto k = static_cast<std::ptrdiff_t>(std::floor((x.x + radius_) / width_));
      if (std::abs(x.y - middle_) > 0.75 * width_ || k < 0 ||
          k >= static_cast<std::ptrdiff_t>(of_.size()))
        return;
      auto& high = highest[static_cast<std::size_t>(k)];
      high = std::max(high, x.z + 0.5 * width_);
    });
    for (std::size_t k = 0; k < of_.size(); ++k)
      if (highest[k] > none) of_[k].push_back(highest[k]);
  }
  /// At each position the heights from the median to the third quartile, as in the paper: this
  /// excludes drops in the air and gaps left by balls.
  void clean(std::vector<double>& x, std::vector<double>& z) const {
    for (std::size_t k = 0; k < of_.size(); ++k) {
      auto all = of_[k];
      std::sort(all.begin(), all.end());
      for (std::size_t n = all.size() / 2; 4 * n < 3 * all.size(); ++n)
        x.push_back(-radius_ + (static_cast<double>(k) + 0.5) * width_), z.push_back(all[n]);
    }
  }

 private:
  double radius_, middle_, width_;
  std::vector<std::vector<double>> of_;
};

/// What is read as the drum turns.
struct WetRun {
  double by_balls = 0, by_slurry = 0, lever = 0;  // [N m] means of the drum's torque, of the weight
  double samples = 0;
  double fastest = 0, off = 0;  // [m/s] of 99.9 %; [-] share whose density is off by 5 %
  double inside_balls = 0;      // [-] largest share of the slurry
};

/// Speeds, densities, and the slurry inside balls.
template <class Sim>
void look(Sim& sim, WetRun& run) {
  std::vector<double> speeds;
  std::size_t inside = 0, off = 0;
  const double rest = sim.fluid().liquid().density;
  sim.fluid().for_each([&](std::uint32_t, const Vec3d& x, const Vec3d& v, double rho, double) {
    speeds.push_back(norm(v));
    off += std::abs(rho / rest - 1) > 0.05;
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (norm(x - sim.position(k)) < sim.radius(k)) {
        ++inside;
        break;
      }
  });
  const double n = static_cast<double>(speeds.size());
  const auto most = static_cast<std::ptrdiff_t>(0.999 * n);
  std::nth_element(speeds.begin(), speeds.begin() + most, speeds.end());
  run.fastest = std::max(run.fastest, speeds[static_cast<std::size_t>(most)]);
  run.off = std::max(run.off, static_cast<double>(off) / n);
  run.inside_balls = std::max(run.inside_balls, static_cast<double>(inside) / n);
}

/// Fraction of the slurry particles that fly alone: 1.5 spacings and more from drum and balls, with
/// fewer than three others within 1.3 spacings; and of those among them that hang: their fall
/// deviates from free fall by more than half of gravity over 2 ms. Both over all particles.
struct Airborne {
  double share = 0, hangs = 0;  // [-]
};
template <class Sim>
Airborne airborne(Sim& sim, const Scene& s, double spacing) {
  constexpr double seconds = 2e-3;
  const auto count = sim.fluid().size() + sim.fluid().left() + sim.fluid().displaced();
  std::vector<Vec3d> before(count), places;
  sim.fluid().for_each([&](std::uint32_t number, const Vec3d&, const Vec3d& v, double, double) {
    before[number] = v;
  });
  sim.run(seconds);
  sim.fluid().for_each(
      [&](std::uint32_t, const Vec3d& x, const Vec3d&, double, double) { places.push_back(x); });
  const auto is_alone = [&](const Vec3d& x) {
    double gap = std::min({s.radius() - std::hypot(x.x, x.z), x.y, s.length - x.y});
    for (std::size_t k = 0; k < sim.rows(); ++k)
      gap = std::min(gap, norm(x - sim.position(k)) - sim.radius(k));
    return gap > 1.5 * spacing && std::count_if(places.begin(), places.end(), [&](const Vec3d& y) {
                                    return norm(x - y) < 1.3 * spacing;
                                  }) <= 3;  // with itself
  };
  Airborne out;
  sim.fluid().for_each([&](std::uint32_t number, const Vec3d& x, const Vec3d& v, double, double) {
    if (!is_alone(x)) return;
    const Vec3d a = (1 / seconds) * (v - before[number]);
    out.share += 1, out.hangs += norm(a - Vec3d{0, 0, -gravity}) > 0.5 * gravity;
  });
  const double n = static_cast<double>(places.size());
  return {out.share / n, out.hangs / n};
}

/// [N m] the drum's mean torque with balls only, over the same time.
template <class Sim>
double dry_torque(Sim& sim, const Scene& s, double seconds) {
  sim.set_motion("drum", turning(sim.time(), s.rate()));
  sim.run(seconds / 3);
  silt::MeanLoad load(sim, "drum");
  sim.run(seconds * 2 / 3);
  return -load.read(sim).torque.y;
}

/// Turns the drum for `seconds`; leaves a table of the torques.
template <class Sim>
WetRun turn(Sim& sim, const Scene& s, double seconds, Heights& heights, PoreFill& pores,
            const std::string& out) {
  sim.set_motion("drum", turning(sim.time(), s.rate()));
  silt::CsvTable table(out + "/torque.csv",
                       {"time [s]", "torque by balls [N m]", "torque by slurry [N m]",
                        "moment of the weight [N m]", "kinetic energy of balls [J]"});
  WetRun run;
  silt::MeanLoad load(sim, "drum");
  constexpr int parts = 60;
  for (int k = 1; k <= parts; ++k) {
    sim.run(seconds / parts);
    const auto mean = load.read(sim);
    const double by_slurry = -sim.fluid().wall_load(0).second.y;
    double lever = 0;  // [N m]
    for (std::size_t b = 0; b < sim.rows(); ++b) lever -= sim.mass(b) * gravity * sim.position(b).x;
    sim.fluid().for_each([&](std::uint32_t, const Vec3d& x, const Vec3d&, double, double) {
      lever -= sim.fluid().particle_mass() * gravity * x.x;
    });
    table.add_row({sim.time(), -mean.torque.y, by_slurry, lever, sim.kinetic_energy()});
    look(sim, run);
    std::printf("\r%3d %%", 100 * k / parts), std::fflush(stdout);
    if (3 * k <= parts) continue;  // the first third is not measured
    heights.add_frame(sim.fluid()), pores.add_frame(sim);
    run.by_balls -= mean.torque.y, run.by_slurry += by_slurry, run.lever += lever, ++run.samples;
  }
  std::printf("\r");
  for (double* sum : {&run.by_balls, &run.by_slurry, &run.lever}) *sum /= run.samples;
  return run;
}

}  // namespace ball_mill
