// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is left of a run: curves beside measured ones, summary.json with its checks.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include <silt/files/csv_table.hpp>

#include "dam_break/measure.hpp"
#include "support/example.hpp"

namespace dam_break {

inline void write_curve(const std::string& folder, const Curve& c) {
  silt::CsvTable table(folder + "/" + c.file, {"T [-]", "value [-]"});
  for (std::size_t k = 0; k < c.T.size(); ++k) table.add_row({c.T[k], c.value[k]});
}

inline void compare_front(example::Summary& summary, const Curve& front, const Curve& measured,
                          const std::string& name, double tolerance) {
  const double late = lateness(front, measured);
  const double after = distance(front, measured, late).share;
  summary.result("front_off_" + name, distance(front, measured, 0).share);
  summary.result("late_" + name + "_T", late);
  summary.check_at_most("front_off_" + name + "_after_shift_in_time", after, tolerance);
  std::printf("Front of %s: %.1f %% rms off; measured %.2f later (in T), without that %.1f %%.\n",
              measured.name.c_str(), 100 * distance(front, measured, 0).share, late, 100 * after);
}

/// Fronts and height beside those that were measured; leaves the tables of these.
inline void compare_curves(example::Summary& summary, const Scene& s, const Record& record,
                           const std::string& out) {
  const Curve front = record.curve(&Look::front), height = record.curve(&Look::height);
  const Curve mm = martin_moyce_front(), ko = koshizuka_oka_front(),
              measured = martin_moyce_height();
  for (const Curve& c : {mm, ko, measured}) write_curve(out, c);
  // Where both experiments have values at one T, their fronts differ by up to 9 %: the second is
  // slower from T = 2.3 on.
  compare_front(summary, front, mm, "martin_moyce", s.sticking ? 0.12 : 0.03);
  compare_front(summary, front, ko, "koshizuka_oka", 0.08);
  // In the simulation a thin wedge runs ahead; in the experiment friction holds it back
  // (docs/sph.md).
  const Curve deep = record.curve(&Look::deep);
  const double off_mm = distance(deep, mm, 0).share, off_ko = distance(deep, ko, 0).share;
  summary.result("deep_front_off_martin_moyce", off_mm);
  summary.result("deep_front_off_koshizuka_oka", off_ko);
  summary.result("deep_front_late_martin_moyce_T", lateness(deep, mm));
  std::printf("Front of liquid %.1f a deep, as it is: %.1f %% and %.1f %% rms off.\n", Scene::deep,
              100 * off_mm, 100 * off_ko);
  const double off = distance(height, measured, 0).plain;
  std::printf("Height: %.1f %% of 2 a rms off.\n", 100 * off);
  summary.result("height_off_martin_moyce_over_2_a", off);
  // Half a spacing is a quarter of s/a; 1 % was observed with fine spacings. A no-slip wall slows
  // the liquid.
  if (!s.sticking)
    summary.check_at_most("height_off_martin_moyce", off, 0.01 + 0.25 * s.across() / Scene::a);
}

/// Speeds, energies and densities.
template <class Water>
void report_run(example::Summary& summary, const Scene& s, const Water& water,
                const Record& record) {
  const Curve front = record.curve(&Look::front);
  double fastest = 0, grown = 0;
  for (std::size_t k = 1; k < record.T.size(); ++k) {
    if (k >= 10)
      fastest = std::max(fastest,
                         (front.value[k] - front.value[k - 10]) / (record.T[k] - record.T[k - 10]));
    grown = std::max(grown, record.looks[k].energy() - record.looks[k - 1].energy());
  }
  // Ritter's front of a wide dam without friction: 2 sqrt(g 2 a).
  summary.check_at_most("front_speed_over_ritters", fastest / 2, 1);
  const Look& end = record.looks.back();
  summary.result("energy_at_the_end", end.energy());
  // The boundary layer at no-slip walls dissipates much of the energy.
  if (s.sticking) {
    summary.result("energy_over_that_at_the_start", end.energy() / record.looks.front().energy());
  } else {
    // Observed: 1.3 % for a/20, 0.5 % for a/80 in 2D, 4.6 % for a/10 in 3D.
    summary.check_within("energy_over_that_at_the_start",
                         end.energy() / record.looks.front().energy(), 1,
                         0.003 + 0.8 * s.across() / Scene::a * std::max(1.0, s.alpha / 0.02),
                         "artificial viscosity, in proportion to alpha h");
    // Observed: 2e-7 at most; 2.4e-3 where liquid that separates from a wall loses density.
    summary.check_at_most("energy_that_came_from_nothing", grown, 1e-3);
  }
  // Observed: 0.004 to 0.011; 0.59 with the pressure of a column at rest, which sends out sound.
  summary.check_at_most("rms_change_of_pressure_to_T_0_1", record.jolt, 0.05);
  summary.check_at_most("largest_change_of_density", record.most(&Look::density), 0.05);
  summary.check_at_most("largest_speed_over_sound", record.most(&Look::speed), 0.15);
  summary.check_at_most("particles_that_left", static_cast<double>(water.left()), 0);
  summary.result("deepest_behind_a_wall_over_spacing", record.most(&Look::behind));
  summary.result("front_at_T_3", front.at(3));
  summary.result("height_at_T_3", record.curve(&Look::height).at(3));
  summary.result("steps", static_cast<double>(water.steps()));
  summary.result("wall_particles", static_cast<double>(water.wall_particles()));
  summary.result("bytes_a_particle",
                 static_cast<double>(water.bytes()) / static_cast<double>(water.size()));
  summary.input("spacing_over_width", s.across() / Scene::a);
}

}  // namespace dam_break
