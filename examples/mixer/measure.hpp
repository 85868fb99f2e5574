// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is measured of a run: torque, angle and work of the blades, and Lacey's index of mixing of
// the colours and of the layers.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "mixer/lacey.hpp"
#include "mixer/scene.hpp"

namespace mixer {

/// Kinds of grains by id, and the positions of the samples: at the start no sample contains both.
struct Kinds {
  std::vector<bool> right, upper;
  Vec3d corner;  // [m]
  double side;   // [m] of a sample

  template <class Sim>
  Kinds(const Sim& sim, const Scene& s) : right(sim.size()), upper(sim.size()), side(s.sample()) {
    std::vector<double> heights;
    for (std::size_t k = 0; k < sim.rows(); ++k) heights.push_back(sim.position(k).z);
    std::nth_element(heights.begin(), heights.begin() + heights.size() / 2, heights.end());
    corner = {0, 0, heights[heights.size() / 2]};
    for (std::size_t k = 0; k < sim.rows(); ++k) {
      right[sim.id(k)] = sim.position(k).x >= 0;
      upper[sim.id(k)] = sim.position(k).z >= corner.z;
    }
  }
  template <class Sim>
  Lacey mixed(const Sim& sim, const std::vector<bool>& kind) const {
    Lacey lacey(side, corner);
    for (std::size_t k = 0; k < sim.rows(); ++k) lacey.add(sim.position(k), kind[sim.id(k)]);
    return lacey;
  }
};

/// Means over a stage of a run.
struct Stage {
  std::string name;
  double seconds = 0, turns = 0;
  double torque = 0, swing = 0;  // [N m] mean, and standard deviation of means over 5 ms
  double work = 0;               // [J] of the blade on the grains, of torque and angle
  double booked = 0;             // [J] held more than before, and dissipated, by the ledger
  double given = 0;              // [J] by walls, by the ledger
  double index = 0, layers = 0;  // [-] at the end
  double rate() const { return turns / seconds; }  // [1/s]
};

struct Run {
  std::string name;
  double target = 0, more = 0;  // [N m] of the servo, at first and at the end; 0: fixed speed
  std::vector<Stage> stages;
  double start = 0, start_layers = 0;  // [-] index of mixing
  std::array<double, 2> random{};      // its mean over random mixtures, standard error
  double samples = 0, grains_a_sample = 0;
  double overlap = 0;                          // [-] mean, of the mean diameter
  double lost = 0, mass_before = 0, mass = 0;  // grains, [kg]
};

/// Observes a run: torque, angle and work every 5 ms, and the mixing index.
template <class Sim>
class Watch {
 public:
  static constexpr double interval = 5e-3;  // [s]
  Watch(Sim& sim, const Scene& s, const Kinds& kinds, const std::string& out)
      : sim_(sim),
        s_(s),
        kinds_(kinds),
        load_(sim, "blade"),
        angle_(angle()),
        start_(sim.time()),
        table_(out, {"time [s]", "turns", "colours", "layers"}) {
    add_row();
  }
  /// Continues for `seconds`.
  template <class... Observers>
  Stage stage(const std::string& name, double seconds, Observers&&... observers) {
    Stage stage{name};
    const auto books = sim_.energy();
    const int pieces = std::max(1, static_cast<int>(std::lround(seconds / (0.05 * s_.turn()))));
    for (int k = 0; k < pieces; ++k) {
      sim_.run(seconds / pieces, silt::at(silt::every(interval), [&](const auto&) { read(stage); }),
               observers...);
      add_row();
    }
    read(stage);
    const auto now = sim_.energy();
    stage.torque /= stage.seconds;
    stage.swing =
        std::sqrt(std::max(stage.swing / stage.seconds - stage.torque * stage.torque, 0.0));
    stage.booked = now.held() - books.held() + now.dissipated() - books.dissipated();
    stage.given = now.walls - books.walls;
    stage.index = index_, stage.layers = layers_;
    std::printf("  %-28s torque %.4f N m +- %.1f %%, %.1f rpm, mixed %.3f, layers %.3f\n",
                name.c_str(), stage.torque, 100 * stage.swing / stage.torque, 60 * stage.rate(),
                stage.index, stage.layers);
    std::fflush(stdout);
    return stage;
  }

 private:
  /// Adds the changes since the last reading; of the torque also sums over time.
  void read(Stage& stage) {
    const auto mean = load_.read(sim_);
    if (mean.duration == 0) return;
    const double turned = std::remainder(angle() - angle_, 2 * std::numbers::pi);
    angle_ += turned, turns_ += turned / (2 * std::numbers::pi);
    stage.seconds += mean.duration, stage.turns += turned / (2 * std::numbers::pi);
    stage.torque -= mean.torque.z * mean.duration;
    stage.swing += mean.torque.z * mean.torque.z * mean.duration;
    stage.work -= mean.torque.z * turned;
  }
  double angle() const {  // [rad] less whole turns
    const Vec3d x = sim_.wall("blade").pose.rotate({1, 0, 0});
    return std::atan2(x.y, x.x);
  }
  void add_row() {
    index_ = kinds_.mixed(sim_, kinds_.right).index();
    layers_ = kinds_.mixed(sim_, kinds_.upper).index();
    table_.add_row({sim_.time() - start_, turns_, index_, layers_});
  }

  Sim& sim_;
  const Scene& s_;
  const Kinds& kinds_;
  silt::MeanLoad load_;
  double angle_, turns_ = 0, start_;
  double index_ = 0, layers_ = 0;
  silt::CsvTable table_;
};

/// Results of a run.
template <class Sim>
void look_back(const Sim& sim, const Scene& s, const Kinds& kinds, Run& run) {
  run.mass = sim.total_mass();
  std::vector<Vec3d> places;
  std::vector<bool> kind;
  double overlaps = 0, contacts = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const Vec3d at = sim.position(k);
    places.push_back(at), kind.push_back(kinds.right[sim.id(k)]);
    run.lost += std::hypot(at.x, at.y) > s.radius || at.z < 0 || at.z > s.height();
  }
  sim.for_each_contact([&](const silt::ContactSeen& c) { overlaps += c.overlap, ++contacts; });
  run.overlap = overlaps / contacts / (2 * s.grain);
  run.random = index_of_random(places, kind, kinds.side, kinds.corner, 100);
  const auto end = kinds.mixed(sim, kinds.right);
  run.samples = end.samples(), run.grains_a_sample = end.grains_a_sample();
}

}  // namespace mixer
