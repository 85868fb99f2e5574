// silt - BSD-3-Clause, see LICENSE
#pragma once

// A run of the mill with balls only: surface, torque, energy, impacts.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

#include "ball_mill/measure.hpp"
#include "ball_mill/scene.hpp"
#include "support/example.hpp"
#include "support/impact_spectrum.hpp"

namespace ball_mill {

/// Rows of grey values; white where a pixel is covered in all frames.
inline void write_grey(const std::string& path, const silt::Picture& picture) {
  silt::AtomicFile file(path);
  file.write(silt::text("P5\n", picture.columns, " ", picture.rows, "\n255\n"));
  std::string bytes;
  for (std::size_t row = picture.rows; row-- > 0;)
    for (std::size_t column = 0; column < picture.columns; ++column)
      bytes.push_back(static_cast<char>(
          static_cast<unsigned char>(std::lround(255 * picture.at(column, row)))));
  file.write(bytes);
  file.commit();
}

/// Points of the surface, and whether each is used by the fitted line.
inline void write_surface(const std::string& path, const silt::ReposeLine& surface) {
  silt::CsvTable table(path, {"x [m]", "height [m]", "in the line", "line [m]"});
  for (std::size_t k = 0; k < surface.x.size(); ++k)
    table.add_row({surface.x[k], surface.z[k], surface.in_line[k] ? 1.0 : 0.0,
                   surface.line.at(surface.x[k])});
}

/// Results of a run, over the filmed turns.
struct DryRun {
  silt::ReposeLine surface;
  double seconds = 0;          // [s] simulated
  double work = 0, lever = 0;  // [J] of torque and angle; of the weight's mean moment
  double booked = 0;           // [J] held more than before, and dissipated, by the ledger
  double residual = 0;         // [J] of the ledger
  double in_contacts = 0;      // [J] lost in contacts that ended
  double largest_power = 0;    // [W] of means over a hundredth of the film
  double contact_overlap = 0;  // [-] mean over contacts, over the mean diameter
  double step = 0;             // [s]
  std::size_t balls = 0, outside = 0, impacts = 0;
  double mass = 0;  // [kg]
};

/// Reads the drum's torque, and the moment of the weight about its axis.
template <class Sim>
class TorqueWatch {
 public:
  TorqueWatch(Sim& sim, const Scene& s, const std::string& path)
      : s_(s),
        load_(sim, "drum"),
        start_(sim.time()),
        lost_(sim.energy().dissipated()),
        table_(path, {"time [s]", "turns", "torque [N m]", "power [W]", "dissipated [W]",
                      "moment of the weight [N m]", "kinetic energy [J]"}) {}
  void read(const Sim& sim, DryRun& run) {
    const auto mean = load_.read(sim);
    if (mean.duration == 0) return;
    double moment = 0;  // [N m] that the drum must bear
    for (std::size_t k = 0; k < sim.rows(); ++k)
      moment -= sim.mass(k) * gravity * sim.position(k).x;
    const double power = -mean.torque.y * s_.rate(), lost = sim.energy().dissipated();
    run.work += power * mean.duration, run.lever += moment * s_.rate() * mean.duration;
    run.largest_power = std::max(run.largest_power, power);
    table_.add_row({sim.time() - start_, (sim.time() - start_) / s_.turn(), -mean.torque.y, power,
                    (lost - lost_) / mean.duration, moment, sim.kinetic_energy()});
    lost_ = lost;
  }

 private:
  const Scene& s_;
  silt::MeanLoad load_;
  double start_, lost_;
  silt::CsvTable table_;
};

template <class Sim>
DryRun run_dry(const Scene& s, Sim sim, const std::string& out) {
  DryRun run;
  run.balls = sim.size();
  std::printf("%zu balls in the %s mm drum, %.2f turns a minute\n", run.balls, s.name.c_str(),
              turns_a_minute(s.drum()));
  std::fflush(stdout);
  sim.set_motion("drum", turning(sim.time(), s.rate()));
  sim.run(s.before * s.turn());
  auto view = film(s);
  example::ImpactSpectrum impacts(-11);
  TorqueWatch<Sim> watch(sim, s, out + "/torque.csv");
  const auto books = sim.energy();
  run.seconds = s.turns * s.turn();
  const double frame = run.seconds / static_cast<double>(s.frames);
  sim.run(
      run.seconds, silt::at(silt::every(frame), [&](const auto& at) { add_frame(view, at); }),
      silt::at(silt::every(0.5 * frame), [&](const auto& at) { watch.read(at, run); }),
      silt::on_contact_end([&](const silt::ContactEvent& c) { impacts.add(c), ++run.impacts; }));
  watch.read(sim, run);
  const auto now = sim.energy();
  run.booked = now.held() - books.held() + now.dissipated() - books.dissipated();
  run.residual = now.residual() - books.residual();
  run.in_contacts = impacts.lost();
  run.step = sim.step_length(), run.mass = sim.total_mass();
  double overlaps = 0, contacts = 0;
  sim.for_each_contact([&](const silt::ContactSeen& c) { overlaps += c.overlap, ++contacts; });
  run.contact_overlap = overlaps / contacts / mean_diameter(bond_classes(s.drum().least));
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const Vec3d x = sim.position(k);
    run.outside += std::hypot(x.x, x.z) > s.radius() || x.y < 0 || x.y > s.length;
  }
  impacts.write(out + "/impacts.csv", static_cast<double>(run.balls), run.seconds);
  const auto heat = view.share();
  run.surface = silt::repose_line(heat);
  write_grey(out + "/heat.pgm", heat);
  write_surface(out + "/surface.csv", run.surface);
  silt::write_particles(out + "/end.vtp", sim);
  silt::write_walls(out + "/drum.vtp", sim);
  return run;
}

}  // namespace ball_mill
