// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is measured while the flow is steady: what comes and what leaves, how long it takes, loads
// of the belts, and where the plate hangs.

#include <cmath>
#include <cstddef>
#include <vector>

#include "conveyor/scene.hpp"

namespace conveyor {

/// Sums over the grains: all of them, and those that have just left the lower belt.
struct Held {
  double mass = 0, left = 0;     // [kg]
  double age = 0, momentum = 0;  // [kg s], [kg m/s] along the belt, of those that have left

  template <class Sim>
  explicit Held(const Sim& sim) {
    for (std::size_t k = 0; k < sim.rows(); ++k) {
      if (!sim.is_present(k)) continue;
      const double m = sim.mass(k);
      mass += m;
      if (sim.position(k).y < Scene::end) continue;
      left += m, age += m * sim.template field<Age>(k).age, momentum += m * sim.velocity(k).y;
    }
  }
};

/// Means of a steady flow.
struct Steady {
  double in = 0, off = 0;                  // [kg/s] fed, and carried off or spilled
  double leaves_with = 0, age = 0;         // [m/s], [s] of what leaves the lower belt
  double hangs = 0;                        // [degrees] of the plate
  double turned_by = 0, weight_turns = 0;  // [N m] the plate about its hinge, by grains and weight
  double upper = 0, lower = 0;             // [N] of the belts on the grains, along their motion
  double push = 0,
         upper_push =
             0;  // [N] of all walls along the lower belt; of the upper belt and its skirts along it

  double power(const Scene& s) const { return upper * s.upper + lower * s.lower; }  // [W]
};

/// Means over the time of steady flow.
template <class Sim>
class SteadyFlow {
 public:
  SteadyFlow(const Scene& s, Sim& sim) : s_(s), sim_(sim) {}

  /// From now on masses and loads count.
  void begin() {
    fed_ = sim_.inlet(0).mass, gone_ = gone();
    for (std::size_t w = 0; w < sim_.walls(); ++w) loads_.emplace_back(sim_, w);
  }
  /// To be called at equal times.
  void look() {
    if (sim_.time() < s_.steady()) return;
    const double angle = sim_.wall("plate").state.way;
    const Held held(sim_);
    degrees_ += angle * 180 / M_PI, lever_ += std::sin(angle), ++samples_;
    age_ += held.age, momentum_ += held.momentum, weight_ += held.left;
  }
  /// The means, `span` [s] after the begin.
  Steady read(double span) {
    Steady m;
    m.in = (sim_.inlet(0).mass - fed_) / span, m.off = (gone() - gone_) / span;
    m.leaves_with = momentum_ / weight_, m.age = age_ / weight_;
    const auto samples = static_cast<double>(samples_);
    m.hangs = degrees_ / samples;
    m.weight_turns = s_.plate_mass * g * Scene::plate / 2 * lever_ / samples;
    std::vector<silt::MeanLoad::Load> on;
    for (auto& load : loads_) on.push_back(load.read(sim_));
    const auto of = [&](const char* wall) { return on[sim_.wall_number(wall)]; };
    m.turned_by = -of("plate").torque.y;
    m.upper = -of("upper belt").force.x, m.lower = -of("lower belt").force.y;
    for (const auto& load : on) m.push -= load.force.y;
    for (const char* wall : {"upper belt", "upper skirt, right", "upper skirt, left", "upper back"})
      m.upper_push -= of(wall).force.x;
    return m;
  }

 private:
  double gone() const { return sim_.outlet(0).mass + sim_.outlet(1).mass; }  // [kg]

  const Scene& s_;
  Sim& sim_;
  double fed_ = 0, gone_ = 0;  // [kg] before
  std::vector<silt::MeanLoad> loads_;
  double degrees_ = 0, lever_ = 0;              // sums of the angle and its sine
  double age_ = 0, momentum_ = 0, weight_ = 0;  // sums of Held's
  std::size_t samples_ = 0;
};

}  // namespace conveyor
