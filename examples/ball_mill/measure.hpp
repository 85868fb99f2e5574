// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is measured as in the recordings: the mill is filmed along its axis, and a line through the
// surface of the balls gives their angle of repose.

#include <array>
#include <cstddef>

#include <silt/measure/side_view.hpp>

#include "ball_mill/scene.hpp"

namespace ball_mill {

/// The view along the axis, of the whole drum.
inline silt::SideView film(const Scene& s) {
  const double R = s.radius();
  return silt::SideView(-R, R, -R, R, Scene::pixel);
}
template <class Sim>
void add_frame(silt::SideView& view, const Sim& sim) {
  view.next_frame();
  for (std::size_t k = 0; k < sim.rows(); ++k)
    view.add_disc(sim.position(k).x, sim.position(k).z, sim.radius(k));
}

/// Rotates the filled drum, and films it after the first turns.
template <class Sim, class... Observers>
silt::SideView turn_and_film(const Scene& s, Sim& sim, Observers&&... observers) {
  sim.set_motion("drum", turning(sim.time(), s.rate()));
  sim.run(s.before * s.turn());
  auto view = film(s);
  const double duration = s.turns * s.turn();
  sim.run(duration,
          silt::at(silt::every(duration / static_cast<double>(s.frames)),
                   [&](const auto& at) { add_frame(view, at); }),
          observers...);
  return view;
}

/// Angle of repose [degrees] of a case with these pair values: the output that a calibration
/// compares.
inline double mill_angle(const Scene& s, int threads) {
  const auto angle = [&](auto sim) {
    return silt::repose_line(turn_and_film(s, sim).share()).angle;
  };
  return s.periodic ? angle(filled_mill(s, threads, period(s))) : angle(filled_mill(s, threads));
}

/// The angles [degrees] of the three dry drums. `like` sets everything that is not varied.
inline std::array<double, 3> mill_targets(double restitution, double friction, Scene like = {},
                                          int threads = 1) {
  std::array<double, 3> out{};
  like.restitution = restitution, like.friction = friction;
  for (std::size_t k = 0; k < mills.size(); ++k)
    like.name = mills[k].name, out[k] = mill_angle(like, threads);
  return out;
}
/// [degrees^2] sum of squared deviations from the recordings of balls only.
inline double squared_error(const std::array<double, 3>& angles) {
  double sum = 0;
  for (std::size_t k = 0; k < mills.size(); ++k)
    sum += (angles[k] - mills[k].angle) * (angles[k] - mills[k].angle);
  return sum;
}

}  // namespace ball_mill
