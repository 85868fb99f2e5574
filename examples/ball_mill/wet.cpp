// silt - BSD-3-Clause, see LICENSE

#include "ball_mill/wet.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "ball_mill/pores.hpp"

namespace ball_mill {
namespace {

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

/// The settled balls, with slurry between and over them.
template <class Dry>
auto wet_mill(const Scene& s, const Slurry& slurry, const Dry& dry, int threads) {
  auto water = make_slurry(s, slurry);
  // A particle that leaves all others loses, by the continuity equation, their contribution to the
  // kernel sum, up to 0.8 of its density, and regains it on return. Also, approaching balls squeeze
  // the slurry between them.
  water.least_density = 0.1, water.most_density = 1.5;
  water.fill(SlurryPlaces(s, slurry, dry));
  silt::Particles<silt::Sphere> balls;
  for (std::size_t k = 0; k < dry.rows(); ++k)
    balls.add({.position = dry.position(k), .radius = dry.radius(k), .density = steel_density});
  auto sim = make_mill(s, std::move(balls), threads, std::move(water));
  // A step of the slurry is a whole number of the balls' steps, as many as its fastest pairs allow:
  // with short steps of the balls it comes closer to the limit (Sph::steps_wanted).
  const auto& setup = sim.fluid().setup();
  sim.time_step = std::min(dry.step_length(), setup.courant * setup.h() / (6 * slurry.sound));
  return sim;
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

}  // namespace

int run_wet(const Scene& s, const Slurry& slurry, double seconds, const example::Options& options) {
  const example::Stopwatch watch;
  silt::make_folder(options.out);
  auto dry = filled_mill(s, options.threads);
  auto sim = wet_mill(s, slurry, dry, options.threads);
  const double particles = static_cast<double>(sim.fluid().size());
  std::printf("%zu balls and %.0f particles of slurry in the %s mm drum\n", sim.size(), particles,
              s.name.c_str());
  std::fflush(stdout);
  Heights heights(s, slurry);
  const example::Stopwatch turning_watch;
  PoreFill pores(s, slurry.spacing);
  const WetRun run = turn(sim, s, seconds, heights, pores, options.out);
  const double cost = turning_watch.seconds();
  const Airborne air = airborne(sim, s, slurry.spacing);
  const double dry_power = dry_torque(dry, s, seconds) * s.rate();  // [W]
  const auto fit = fit_surface(heights, options.out);
  const auto filled = pores.below([&](double x) { return fit.at(x); });
  silt::CsvTable cells(options.out + "/pores.csv",
                       {"x [m]", "z [m]", "free of balls [-]", "slurry [-]"});
  pores.for_each([&](double x, double z, double room, double wet) {
    cells.add_row({x, z, room, wet});
  });
  sim.fluid().write(options.out + "/slurry.vtp");
  silt::write_particles(options.out + "/end.vtp", sim);
  silt::write_walls(options.out + "/drum.vtp", sim);

  example::Summary summary;
  summary.input("case", s.name), summary.input("length_m", s.length);
  summary.input("spacing_m", slurry.spacing), summary.input("sound_speed_m_s", slurry.sound);
  summary.input("slurry_density_kg_m3", slurry.density);
  summary.input("slurry_viscosity_pa_s", slurry.viscosity);
  summary.input("artificial_viscosity", slurry.alpha);
  summary.input("smoothing", slurry.smoothing);
  summary.input("restitution", s.restitution), summary.input("friction", s.friction);
  summary.input("seconds", seconds), summary.input("threads", options.threads * 1.0);
  summary.result("slurry_particles", particles);
  summary.result("wall_particles", static_cast<double>(sim.fluid().wall_particles()));
  summary.result("torque_by_balls_n_m", run.by_balls);
  summary.result("torque_by_slurry_n_m", run.by_slurry);
  summary.result("power_w", (run.by_balls + run.by_slurry) * s.rate());
  summary.result("power_of_balls_alone_w", dry_power);
  summary.result("torque_over_moment_of_the_weight", (run.by_balls + run.by_slurry) / run.lever);
  const auto b = fit.coefficients();
  summary.result("surface_height_in_the_middle_m", b[0]), summary.result("surface_slope", b[1]);
  summary.result("surface_curvature_1_m", 2 * b[2]);
  summary.result("surface_band_of_points_m", fit.band_of_points(0));
  summary.result("surface_band_of_curve_m", fit.band_of_curve(0));
  summary.result("slurry_over_room_between_balls_below_the_surface", filled.bed);
  summary.result("slurry_over_room_in_the_pool", filled.pool);
  summary.result("share_of_the_slurry_where_balls_are_dense", filled.in_bed);
  summary.result("share_of_the_slurry_in_the_air", air.share);
  const double steps = static_cast<double>(sim.fluid().steps());
  summary.result("slurry_steps", steps), summary.result("seconds_a_simulated_one", cost / seconds);
  summary.result("ms_a_slurry_step", 1e3 * cost / steps);
  summary.check_within("slurry_over_volume_of_the_drum",
                       particles * std::pow(slurry.spacing, 3) /
                           (std::numbers::pi * s.radius() * s.radius() * s.length),
                       slurry.share, slurry.spacing / (std::numbers::pi * s.radius()),
                       "half a layer of the lattice");
  summary.check_at_most("share_that_left_or_was_displaced",
                        1 - static_cast<double>(sim.fluid().size()) / particles, 0.01);
  // Observed: 0.006, drops at impact. 0.056 in a drum half as long, when spray still kept its
  // pressure (docs/ball_mill.md).
  summary.check_at_most("share_that_hangs_in_the_air", air.hangs, 0.01);
  summary.check_at_most("share_inside_balls", run.inside_balls, 0.1);
  summary.check_at_most("share_whose_density_is_off_by_5_percent", run.off, 0.02);
  summary.check_at_most("speed_of_999_in_1000_over_sound", run.fastest / slurry.sound, 0.15);
  if (seconds >= 1)
    summary.check_within("torque_over_moment_of_the_weight",
                         (run.by_balls + run.by_slurry) / run.lever, 1, 0.1,
                         "the slurry's torque is read at instants");
  summary.result("wall_time_s", watch.seconds());
  summary.write(options.out + "/summary.json");
  const bool drawn = example::run_script(
      SILT_BALL_MILL_SCRIPT,
      {"wet", options.out, silt::text(s.radius()), silt::text(slurry.spacing), s.name});
  std::printf("Power %.1f W, of that by the slurry %.1f W; of balls alone %.1f W.\n",
              (run.by_balls + run.by_slurry) * s.rate(), run.by_slurry * s.rate(), dry_power);
  std::printf(
      "Slurry surface: z = %.4f %+.3f x %+.2f x^2 [m]; 95 %% of the points within %.4f m.\n", b[0],
      b[1], b[2], fit.band_of_points(0));
  summary.print_checks();
  std::printf("Look at: %s%s/slurry.vtp, surface.csv, torque.csv, summary.json; %.0f s\n",
              drawn ? (options.out + "/wet.png, ").c_str() : "", options.out.c_str(),
              watch.seconds());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace ball_mill
