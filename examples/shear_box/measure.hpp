// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is measured in a test: loads of the walls and the rise of the lid over the way of the lower
// half, the thickness of the sheared band, the books of momentum and energy.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <variant>
#include <vector>

#include <silt/eigen.hpp>

#include "shear_box/scene.hpp"

namespace shear_box {

/// Means over an interval of the displacement of the lower half.
struct Point {
  double way = 0, rise = 0;     // [m] of the lower half; of the lid, at the end
  double below = 0, above = 0;  // [N] shear force, of the lower half; of ring and lid
  double normal = 0, lid = 0;   // [N] that the lower half bears; of the lid
  double ratio() const { return below / normal; }
};

struct Test {
  std::string name;       // of the sample
  double stress = 0;      // [Pa] on the lid
  double void_ratio = 0;  // [-] before the shear
  double contacts = 0;    // [-] a grain, before the shear
  double overlap = 0;     // [-] mean of grains that touch, of the mean diameter
  std::vector<Point> curve;
  std::size_t residual_from = 0;  // points
  // Over the residual interval:
  double work = 0, lid_work = 0;     // [J] of the shear force, and of the lid, on the grains
  double dissipated = 0, held = 0;   // [J] by the ledger; held: more than before
  double momentum = 0, impulse = 0;  // [N s] what grains gained, what shear forces differ by
  double shear_impulse = 0;          // [N s] of the lower half
  double mass = 0;                   // [kg] of the grains
  double band = 0;                   // [m] thickness of what is sheared
  std::size_t lost = 0, grains = 0;

  std::string title() const { return name + ", " + silt::text(stress / 1000) + " kPa"; }
  std::string file() const { return name + "_" + silt::text(stress / 1000) + "kPa"; }
  template <class Of>
  double mean(std::size_t from, std::size_t to, const Of& of) const {
    double sum = 0;
    for (std::size_t k = from; k < to; ++k) sum += of(curve[k]);
    return sum / static_cast<double>(to - from);
  }
  template <class Of>
  double residual(const Of& of) const {
    return mean(residual_from, curve.size(), of);
  }
  static constexpr std::size_t half_window = 3;
  /// The centre of the seven consecutive points with the largest mean ratio.
  std::size_t peak_at() const {
    std::size_t best = half_window;
    const auto of = [](const Point& p) { return p.ratio(); };
    for (std::size_t k = half_window; k + half_window < curve.size(); ++k)
      if (mean(k - half_window, k + half_window + 1, of) >
          mean(best - half_window, best + half_window + 1, of))
        best = k;
    return best;
  }
  template <class Of>
  double at_peak(const Of& of) const {
    return mean(peak_at() - half_window, peak_at() + half_window + 1, of);
  }
  /// Rise of the lid over displacement [-], the slope around a point: the tangent of the dilatancy
  /// angle.
  double dilatancy(std::size_t from, std::size_t to) const {
    std::vector<double> x, y;
    for (std::size_t k = from; k < to; ++k) x.push_back(curve[k].way), y.push_back(curve[k].rise);
    return silt::fit_straight_line(x, y).slope;
  }
  double dilatancy_at_peak() const {
    return dilatancy(peak_at() - half_window, peak_at() + half_window + 1);
  }
};

/// Sums over the grains of a box.
template <class Sim>
double solid_volume(const Sim& sim) {
  double sum = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) sum += silt::Sphere::volume(sim.radius(k));
  return sum;
}
/// Height [m] between floor and lid.
template <class Sim>
double height(const Sim& sim) {
  const auto& plane = std::get<silt::Plane>(sim.wall("lid").surfaces.front());
  return plane.point.z + sim.wall("lid").pose.translation.z -
         std::get<silt::Plane>(sim.wall("floor").surfaces.front()).point.z;
}
/// Mean overlap of touching grains [m]. Between runs.
template <class Sim>
double mean_overlap(const Sim& sim) {
  double sum = 0, count = 0;
  sim.for_each_contact([&](const silt::ContactSeen& c) {
    if (c.wall == silt::no_wall) sum += c.overlap, ++count;
  });
  return sum / count;
}

/// Shear band thickness [m]: the distance in which the mean displacement falls from 9 to 1 tenth of
/// that of the lower half, over 0.8, its value for a linear profile.
template <class Sim>
double sheared_band(const Sim& sim, const Scene& s, const std::vector<Vec3d>& before, double way) {
  const double layer = 0.5 * s.diameter;
  std::vector<double> sum(static_cast<std::size_t>(4 * s.height), 0.0), count = sum;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const Vec3d& from = before[sim.id(k)];
    const auto at = static_cast<std::size_t>(std::max(from.z + s.split(), 0.0) / layer);
    if (at < sum.size()) sum[at] += (sim.position(k).x - from.x) / way, ++count[at];
  }
  std::vector<double> z, u;  // [m], [-]
  for (std::size_t k = 0; k < sum.size(); ++k)
    if (count[k] > 10)
      z.push_back((static_cast<double>(k) + 0.5) * layer), u.push_back(sum[k] / count[k]);
  const auto falls_below = [&](double level) {
    for (std::size_t k = 1; k < u.size(); ++k)
      if (u[k] < level)
        return z[k - 1] +
               (z[k] - z[k - 1]) * std::clamp((u[k - 1] - level) / (u[k - 1] - u[k]), 0.0, 1.0);
    return z.back();
  };
  return (falls_below(0.1) - falls_below(0.9)) / 0.8;
}

/// Records the loads of all walls as means over the intervals of a shear test.
template <class Sim>
class Shear {
 public:
  Shear(Sim& sim, Test& test) : sim_(sim), test_(test), start_(height(sim)) {
    for (const char* name : {"lower half", "floor", "upper half", "lid"})
      loads_.emplace_back(sim, name);
  }
  double way() const { return sim_.wall("floor").pose.translation.x; }
  void piece(double duration) {
    sim_.run(duration);
    std::array<Vec3d, 4> f;
    for (std::size_t k = 0; k < 4; ++k) f[k] = loads_[k].read(sim_).force;
    test_.curve.push_back({way(), height(sim_) - start_, -f[0].x - f[1].x, f[2].x + f[3].x,
                           -f[0].z - f[1].z, f[3].z});
  }

 private:
  Sim& sim_;
  Test& test_;
  std::vector<silt::MeanLoad> loads_;
  double start_;  // [m]
};

template <class Sim>
Vec3d momentum(const Sim& sim) {
  return sim.total_mass() * sim.mean_velocity();
}
/// [N s] impulse of the grains on walls along the motion, since the start; of the lower half only.
template <class Sim>
std::array<double, 2> impulses(const Sim& sim) {
  const double below = sim.wall("lower half").impulse.x + sim.wall("floor").impulse.x;
  return {below + sim.wall("upper half").impulse.x + sim.wall("lid").impulse.x, below};
}

/// The residual interval, with its balances.
template <class Sim>
void shear_on(Sim& sim, Shear<Sim>& shear, const Scene& s, Test& t, std::size_t pieces,
              double duration) {
  std::vector<Vec3d> before(sim.rows());
  for (std::size_t k = 0; k < sim.rows(); ++k) before[sim.id(k)] = sim.position(k);
  const auto books = sim.energy();
  const auto sums = impulses(sim);
  const double p = momentum(sim).x, way = shear.way(), lid = height(sim);
  const double lid_speed = sim.wall("lid").state.rate_now;
  t.residual_from = t.curve.size();
  for (std::size_t k = 0; k < pieces; ++k) shear.piece(duration);
  const auto now = sim.energy();
  const auto last = impulses(sim);
  t.momentum = momentum(sim).x - p, t.impulse = -(last[0] - sums[0]);
  t.shear_impulse = -(last[1] - sums[1]);
  t.work = t.shear_impulse * s.speed();  // the lower half has one speed by now
  // A free lid transfers to the grains the energy lost by its weight and motion.
  const double lid_now = sim.wall("lid").state.rate_now;
  t.lid_work = -t.stress * s.area() * (height(sim) - lid) -
               0.5 * s.lid_mass() * (lid_now * lid_now - lid_speed * lid_speed);
  t.dissipated = now.dissipated() - books.dissipated(), t.held = now.held() - books.held();
  t.mass = sim.total_mass();
  t.band = sheared_band(sim, s, before, shear.way() - way);
  const double end =
      s.L() + s.travel * s.diameter;  // all that the halves and their flanges enclose
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const Vec3d at = sim.position(k);
    t.lost += at.x < 0 || at.x > end || at.y < 0 || at.y > s.W() || at.z < -s.split();
  }
}

}  // namespace shear_box
