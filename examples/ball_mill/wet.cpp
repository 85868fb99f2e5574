// silt - BSD-3-Clause, see LICENSE
//
// The mill with slurry: where the slurry stands and how fast it is, torque and power beside those
// of balls alone.

#include "ball_mill/wet.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "ball_mill/wet_measure.hpp"

namespace ball_mill {
namespace {

/// A parabola through the highest slurry; leaves its points and the curve.
silt::PolynomialFit<2> fit_surface(const Heights& heights, const std::string& out) {
  std::vector<double> x, z;
  heights.clean(x, z);
  const auto fit = silt::fit_polynomial<2>(x, z);
  silt::CsvTable points(out + "/highest.csv", {"x [m]", "height [m]"});
  for (std::size_t k = 0; k < x.size(); ++k) points.add_row({x[k], z[k]});
  silt::CsvTable curve(out + "/surface.csv",
                       {"x [m]", "height [m]", "95 % of the curve [m]", "95 % of the points [m]"});
  const auto [least, most] = std::minmax_element(x.begin(), x.end());
  for (int k = 0; k <= 100; ++k) {
    const double at = *least + (*most - *least) * k / 100;
    curve.add_row({at, fit.at(at), fit.band_of_curve(at), fit.band_of_points(at)});
  }
  return fit;
}

/// How full of slurry each place is.
void write_pores(const std::string& path, const PoreFill& pores) {
  silt::CsvTable cells(path, {"x [m]", "z [m]", "free of balls [-]", "slurry [-]"});
  pores.for_each([&](double x, double z, double room, double wet) {
    cells.add_row({x, z, room, wet});
  });
}

/// What a wet run gave.
struct WetResults {
  WetRun run{};
  Airborne air{};
  silt::PolynomialFit<2> fit{};  // of the surface
  PoreFill::Share filled{};
  double particles = 0;  // of slurry
  double dry_power = 0;  // [W] of balls alone
  double cost = 0;       // [s] of wall time
};

/// Turns the wet mill, and the dry one beside it; leaves tables and the state at the end.
template <class Dry, class Wet>
WetResults measure(const Scene& s, const Slurry& slurry, double seconds, Dry& dry, Wet& sim,
                   const std::string& out) {
  WetResults m;
  m.particles = static_cast<double>(sim.fluid().size());
  Heights heights(s, slurry);
  const example::Stopwatch watch;
  PoreFill pores(s, slurry.spacing);
  m.run = turn(sim, s, seconds, heights, pores, out);
  m.cost = watch.seconds();
  m.air = airborne(sim, s, slurry.spacing);
  m.dry_power = dry_torque(dry, s, seconds) * s.rate();
  m.fit = fit_surface(heights, out);
  m.filled = pores.below([&](double x) { return m.fit.at(x); });
  write_pores(out + "/pores.csv", pores);
  sim.fluid().write(out + "/slurry.vtp");
  silt::write_particles(out + "/end.vtp", sim);
  silt::write_walls(out + "/drum.vtp", sim);
  return m;
}

void add_inputs(example::Summary& summary, const Scene& s, const Slurry& slurry, double seconds,
                int threads) {
  summary.input("case", s.name), summary.input("length_m", s.length);
  summary.input("spacing_m", slurry.spacing), summary.input("sound_speed_m_s", slurry.sound);
  summary.input("slurry_density_kg_m3", slurry.density);
  summary.input("slurry_viscosity_pa_s", slurry.viscosity);
  summary.input("artificial_viscosity", slurry.alpha);
  summary.input("smoothing", slurry.smoothing);
  summary.input("restitution", s.restitution), summary.input("friction", s.friction);
  summary.input("seconds", seconds), summary.input("threads", threads * 1.0);
}

template <class Sim>
void add_results(example::Summary& summary, const Scene& s, const Sim& sim, const WetResults& m,
                 double seconds) {
  summary.result("slurry_particles", m.particles);
  summary.result("wall_particles", static_cast<double>(sim.fluid().wall_particles()));
  summary.result("torque_by_balls_n_m", m.run.by_balls);
  summary.result("torque_by_slurry_n_m", m.run.by_slurry);
  summary.result("power_w", (m.run.by_balls + m.run.by_slurry) * s.rate());
  summary.result("power_of_balls_alone_w", m.dry_power);
  summary.result("torque_over_moment_of_the_weight",
                 (m.run.by_balls + m.run.by_slurry) / m.run.lever);
  const auto b = m.fit.coefficients();
  summary.result("surface_height_in_the_middle_m", b[0]), summary.result("surface_slope", b[1]);
  summary.result("surface_curvature_1_m", 2 * b[2]);
  summary.result("surface_band_of_points_m", m.fit.band_of_points(0));
  summary.result("surface_band_of_curve_m", m.fit.band_of_curve(0));
  summary.result("slurry_over_room_between_balls_below_the_surface", m.filled.bed);
  summary.result("slurry_over_room_in_the_pool", m.filled.pool);
  summary.result("share_of_the_slurry_where_balls_are_dense", m.filled.in_bed);
  summary.result("share_of_the_slurry_in_the_air", m.air.share);
  const double steps = static_cast<double>(sim.fluid().steps());
  summary.result("slurry_steps", steps);
  summary.result("seconds_a_simulated_one", m.cost / seconds);
  summary.result("ms_a_slurry_step", 1e3 * m.cost / steps);
}

template <class Sim>
void check_run(example::Summary& summary, const Scene& s, const Slurry& slurry, const Sim& sim,
               const WetResults& m, double seconds) {
  summary.check_within("slurry_over_volume_of_the_drum",
                       m.particles * std::pow(slurry.spacing, 3) /
                           (std::numbers::pi * s.radius() * s.radius() * s.length),
                       slurry.share, slurry.spacing / (std::numbers::pi * s.radius()),
                       "half a layer of the lattice");
  summary.check_at_most("share_that_left_or_was_displaced",
                        1 - static_cast<double>(sim.fluid().size()) / m.particles, 0.01);
  // Observed: 0.006, drops at impact. 0.056 in a drum half as long, when spray still kept its
  // pressure (docs/ball_mill.md).
  summary.check_at_most("share_that_hangs_in_the_air", m.air.hangs, 0.01);
  summary.check_at_most("share_inside_balls", m.run.inside_balls, 0.1);
  summary.check_at_most("share_whose_density_is_off_by_5_percent", m.run.off, 0.02);
  summary.check_at_most("speed_of_999_in_1000_over_sound", m.run.fastest / slurry.sound, 0.15);
  if (seconds >= 1)
    summary.check_within("torque_over_moment_of_the_weight",
                         (m.run.by_balls + m.run.by_slurry) / m.run.lever, 1, 0.1,
                         "the slurry's torque is read at instants");
}

}  // namespace

int run_wet(const Scene& s, const Slurry& slurry, double seconds, const example::Options& options) {
  const example::Stopwatch watch;
  silt::make_folder(options.out);
  auto dry = filled_mill(s, options.threads);
  auto sim = wet_mill(s, slurry, dry, options.threads);
  std::printf("%zu balls and %zu particles of slurry in the %s mm drum\n", sim.size(),
              sim.fluid().size(), s.name.c_str());
  std::fflush(stdout);
  const WetResults m = measure(s, slurry, seconds, dry, sim, options.out);

  example::Summary summary;
  add_inputs(summary, s, slurry, seconds, options.threads);
  add_results(summary, s, sim, m, seconds);
  check_run(summary, s, slurry, sim, m, seconds);
  summary.result("wall_time_s", watch.seconds());
  summary.write(options.out + "/summary.json");
  const bool drawn = example::run_script(
      SILT_BALL_MILL_SCRIPT,
      {"wet", options.out, silt::text(s.radius()), silt::text(slurry.spacing), s.name});
  std::printf("Power %.1f W, of that by the slurry %.1f W; of balls alone %.1f W.\n",
              (m.run.by_balls + m.run.by_slurry) * s.rate(), m.run.by_slurry * s.rate(),
              m.dry_power);
  const auto b = m.fit.coefficients();
  std::printf(
      "Slurry surface: z = %.4f %+.3f x %+.2f x^2 [m]; 95 %% of the points within %.4f m.\n", b[0],
      b[1], b[2], m.fit.band_of_points(0));
  summary.print_checks();
  std::printf("Look at: %s%s/slurry.vtp, surface.csv, torque.csv, summary.json; %.0f s\n",
              drawn ? (options.out + "/wet.png, ").c_str() : "", options.out.c_str(),
              watch.seconds());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace ball_mill
