// silt - BSD-3-Clause, see LICENSE
//
// Hopper discharge at the scale of D. Markauskas, A. Kaceniauskas, A. Maknickas, Information
// Technology and Control 40 (2011) 287: 100 000 or 300 000 spheres settle in a square hopper, the
// orifice of 40 x 40 mm opens, and they flow into an identical box below. What the paper does not
// give (density, Poisson ratio, sizes of the boxes) is stated here. With --silo a round silo above
// a cone instead, and its wall pressure (silo.cpp).

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include <silt/silt.hpp>

#include "hopper/scene.hpp"
#include "hopper/silo.hpp"
#include "support/example.hpp"

namespace {

using namespace hopper;

/// Boxes and floor as lines for the pictures.
void write_outlines(const Scene& s, const std::string& path) {
  auto triangles = box_triangles(s);
  for (const auto& t : floor_triangles(s)) triangles.push_back(t);
  const silt::TriangleMesh mesh(triangles);
  silt::write_vtp_triangles(path, mesh.vertices(), mesh.triangles());
}

/// Cells in the vertical plane through the middle of the hopper, from its orifice to above the
/// filling.
silt::CoarseGrid middle_layer(const Scene& s) {
  const double cell = 2.5e-3, half = cell / 2, low = s.orifice_height() - 0.01,
               high = s.funnel_top() + 1.1 * s.bulk_height();  // [m]
  return {{{0, s.width / 2 - half, low}, {s.width, s.width / 2 + half, high}},
          {static_cast<int>(s.width / cell), 1, static_cast<int>((high - low) / cell)}};
}

/// Quantities recorded every few milliseconds.
template <class Sim>
struct Watch {
  double below = 0;  // [kg]
  std::size_t count_below = 0;

  Watch(const Sim& sim, double height) {
    for (std::size_t k = 0; k < sim.rows(); ++k) {
      if (sim.position(k).z < height) below += sim.mass(k), ++count_below;
    }
  }
};

/// Solid fraction of the bed between two heights, away from the walls.
template <class Sim>
double solid_fraction(const Sim& sim, const silt::Box& inside) {
  double solid = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (inside.contains(sim.position(k))) solid += silt::Sphere::volume(sim.radius(k));
  return solid / inside.volume();
}

struct Discharge {
  std::vector<double> time, mass;  // [s] since opening, [kg] below the orifice

  /// Slope between 20 and 70 per cent of `total` [kg/s].
  double rate(double total) const {
    double n = 0, t = 0, m = 0, tt = 0, tm = 0;
    for (std::size_t k = 0; k < time.size(); ++k) {
      if (mass[k] < 0.2 * total || mass[k] > 0.7 * total) continue;
      n += 1, t += time[k], m += mass[k], tt += time[k] * time[k], tm += time[k] * mass[k];
    }
    return n > 1 ? (n * tm - t * m) / (n * tt - t * t) : 0;
  }
  /// Time at which a fraction of `total` has passed [s].
  double time_of(double share, double total) const {
    for (std::size_t k = 0; k < time.size(); ++k)
      if (mass[k] >= share * total) return time[k];
    return std::nan("");
  }
};

template <class Precision>
int simulate(Scene scene, const example::Options& options) {
  const std::string precision = std::is_same_v<Precision, silt::Mixed> ? "mixed" : "double";
  const example::Stopwatch whole;
  auto sim = make_simulation(scene, Precision{});
  sim.threads = options.threads;
  const double opening = scene.settling_time();
  if (!options.restart.empty()) silt::load_checkpoint(sim, options.restart);
  silt::make_folder(options.out);
  const std::string checkpoint = options.out + "/checkpoint.silt";

  example::Summary summary;
  summary.input("particles", static_cast<double>(scene.particles));
  summary.input("density_kg_m3", scene.density);
  summary.input("diameter_min_m", 2 * scene.r_min);
  summary.input("diameter_max_m", 2 * scene.r_max);
  summary.input("youngs_modulus_pa", scene.material().youngs_modulus);
  summary.input("poisson_ratio", scene.material().poisson_ratio);
  summary.input("restitution", scene.material().restitution);
  summary.input("friction", scene.material().friction);
  summary.input("box_width_m", scene.width);
  summary.input("orifice_m", scene.orifice);
  summary.input("floor", std::string(scene.flat ? "flat" : "funnel, 45 degrees"));
  summary.input("time_step_s", scene.time_step);
  summary.input("settling_time_s", opening);
  summary.input("sort", scene.sort);
  summary.input("precision", precision);
  summary.input("threads", static_cast<double>(options.threads));
  summary.input("seed", 1.0);
  summary.input("restart", options.restart);
  std::printf(
      "%zu spheres of 1.95-2.35 mm, %zu + %zu bytes a particle and contact, dt = %g s, %s "
      "precision\n",
      sim.size(), sim.bytes_per_particle, sim.bytes_per_contact, scene.time_step,
      precision.c_str());
  silt::write_stl(options.out + "/floor.stl", floor_triangles(scene));
  write_outlines(scene, options.out + "/outlines.vtp");

  // Six layers, as in the paper's figure: the lattice is filled from below, so ids increase with
  // height.
  const auto layers = [n = scene.particles,
                       values = std::make_shared<std::vector<std::uint32_t>>()](
                          const auto& at, silt::VtkFields& fields, const auto& places) {
    values->clear();
    for (const auto k : places)
      values->push_back(static_cast<std::uint32_t>(6 * std::size_t{at.id(k)} / n));
    fields.add("layer", *values);
  };
  auto save = silt::checkpoints(checkpoint, silt::every(0.1));

  // At rest first ...
  double fraction = 0, rest = 0;
  bool has_chains = false;
  const double total = sim.total_mass();  // [kg]
  if (sim.time() < opening) {
    std::printf("filling\n");
    sim.run(opening - sim.time(), save, silt::progress());
  }
  const double bed_top = scene.funnel_top() + 0.55 * scene.bulk_height();
  fraction = solid_fraction(sim, {{0.015, 0.015, scene.funnel_top() + 0.005},
                                  {scene.width - 0.015, scene.width - 0.015, bed_top}});
  rest = sim.kinetic_energy() / (total * 9.81 * 2 * scene.r_max);
  if (sim.time() < opening + 0.5 * scene.time_step && sim.has_contacts()) {
    // Contact forces: force chains, and the sum of wall contacts against the wall forces. These
    // equal the weight except for residual bouncing of the bed, 3 % with --quick.
    has_chains = true;
    silt::write_contacts(options.out + "/contacts_at_rest.vtp", sim);
    const auto z = silt::coordination(sim);
    silt::Vec3d on_walls{0, 0, 0}, by_contacts{0, 0, 0};
    for (std::size_t w = 0; w < sim.walls(); ++w) on_walls += sim.wall(w).force;
    sim.for_each_contact([&](const silt::ContactSeen& c) {
      if (c.wall != silt::no_wall) by_contacts -= c.force;
    });
    summary.result("coordination_number_at_rest", z.mean);
    summary.result("coordination_number_without_rattlers", z.without_rattlers);
    summary.check_at_most("contacts_against_wall_forces_over_weight",
                          silt::norm(on_walls - by_contacts) / (9.81 * total), 1e-4);
    // No check: the bed is not quite at rest when the orifice opens (3 % with --quick).
    summary.result("weight_on_walls_off_by", std::abs(-on_walls.z / (9.81 * total) - 1));
  }
  if (sim.time() < opening + 0.5 * scene.time_step) sim.remove_wall(lid);

  // ... and then opened.
  std::printf("discharging\n");
  Discharge curve;
  example::Stopwatch clock;
  std::int64_t last_step = sim.step();
  double last_seconds = 0, peak_contacts = 0;
  const auto watch = [&](const auto& s) {
    const Watch w(s, scene.orifice_height());
    const auto contacts = static_cast<double>(s.touching_pairs());
    peak_contacts = std::max(peak_contacts, contacts);
    const double seconds = clock.seconds();
    const double steps = static_cast<double>(s.step() - last_step);
    const double per_step = steps > 0 ? (seconds - last_seconds) / steps : 0;
    last_step = s.step(), last_seconds = seconds;
    curve.time.push_back(s.time() - opening), curve.mass.push_back(w.below);
    const double time = std::round(1e9 * (s.time() - opening)) / 1e9;  // without digits of rounding
    return std::array<double, 6>{
        time,          w.below, static_cast<double>(w.count_below), contacts, s.kinetic_energy(),
        1e3 * per_step};
  };
  auto table = silt::table(options.out + "/discharge.csv",
                           {"time [s]", "mass below [kg]", "particles below [-]", "contacts [-]",
                            "kinetic energy [J]", "time per step [ms]"},
                           silt::every(0.005), watch);
  // The flow field in the middle layer: means from the start of discharge until half of the mass
  // has passed.
  auto flow = silt::coarse_grained(middle_layer(scene), silt::GaussianKernel{.width = 1.5e-3},
                                   silt::every(0.01));
  std::vector<std::string> pictures, titles;
  const auto& moments = scene.moments;
  auto series = silt::vtk_series(options.out + "/vtk", silt::every(0.02), layers);
  const double end = scene.particles >= 200000 ? 6.0 : 3.0;
  for (int k = 0; sim.time() < opening + end; ++k) {
    const double next = k < 4 ? opening + moments[k] : sim.time() + 0.1;
    if (next <= sim.time()) continue;  // before the restart
    if (k >= 1 && k < 3)
      sim.run(next - sim.time(), table, series, save, flow, silt::progress());
    else
      sim.run(next - sim.time(), table, series, save, silt::progress());
    if (k < 4) {
      pictures.push_back(silt::text(options.out, "/snapshot_", moments[k], "s.vtp"));
      titles.push_back(silt::text(moments[k], " s after opening"));
      silt::write_particles(pictures.back(), sim, layers);
    }
    if (k < 3 || curve.mass.size() <= 20) continue;
    const double lately = curve.mass.back() - curve.mass[curve.mass.size() - 20];
    if (curve.mass.back() > 0.99999 * total || lately < 1e-4 * total) break;
  }
  if (pictures.empty()) {
    pictures.push_back(options.out + "/snapshot_end.vtp");
    titles.push_back(
        silt::text(std::round(1e3 * (sim.time() - opening)) / 1e3, " s after opening"));
    silt::write_particles(pictures.back(), sim, layers);
  }

  // Results.
  const double d = scene.r_min + scene.r_max;
  const double theory = beverloo(scene.orifice, d, fraction * scene.density);
  const double out = Watch(sim, scene.orifice_height()).below;
  const double rate = curve.rate(out);
  summary.result("solid_fraction_settled", fraction);
  if (options.restart.empty()) {
    summary.result("discharge_rate_kg_s", rate);
    summary.result("discharge_rate_over_beverloo", rate / theory);
    summary.result("time_of_half_s", curve.time_of(0.5, total));
    summary.result("time_of_99_percent_s", curve.time_of(0.99, total));
  }
  summary.result("beverloo_rate_kg_s", theory);
  summary.result("discharged_share", out / total);
  summary.result("largest_overlap_over_radius", sim.peak_overlap());
  summary.result("kinetic_energy_at_rest_over_weight_times_diameter", rest);
  summary.result("most_contacts", peak_contacts);
  summary.result("steps", static_cast<double>(sim.step()));
  summary.result("wall_time_s", whole.seconds());
  // The hardest impact is the fall from the top of the room into the funnel, bounded by Hertz
  // without losses: softer springs than the material's give larger overlaps, up to the guard's
  // limit. If the guard's limit is lower (small grains, high rooms), the value is reported without
  // a check.
  const double fastest = std::sqrt(2 * 9.81 * scene.room());
  const auto grain = scene.material();
  const double deepest =
      silt::hertz_max_overlap({silt::effective_modulus(grain.youngs_modulus, grain.poisson_ratio,
                                                       grain.youngs_modulus, grain.poisson_ratio),
                               scene.r_max, scene.density * silt::Sphere::volume(scene.r_max),
                               fastest}) /
      scene.r_max;
  summary.result("overlap_of_the_fall_over_radius", deepest);
  if (deepest < sim.guard.max_overlap)
    summary.check_at_most("largest_overlap_over_radius", sim.peak_overlap(), deepest);
  if (const auto limit = sim.time_step_limit(3.0))
    summary.result("time_step_over_limit", sim.step_length() / *limit);
  if (options.restart.empty()) {
    summary.check_at_most("at_rest_before_opening", rest, 1e-3);
    summary.check_at_least("discharge_rate_over_beverloo", rate / theory, 0.85);
    summary.check_at_most("discharge_rate_over_beverloo", rate / theory, 1.15);
  }
  if (!scene.flat) summary.check_at_least("discharged_share", out / total, 0.99);
  summary.write(options.out + "/summary.json");

  std::vector<std::string> arguments{"draw"};
  arguments.insert(arguments.end(), pictures.begin(), pictures.end());
  for (const char* a : {"--colour", "layer", "--view", "front", "--cut"}) arguments.push_back(a);
  arguments.push_back(silt::text("y=", scene.width / 2));
  arguments.insert(arguments.end(), {"--walls", options.out + "/outlines.vtp", "--title"});
  arguments.insert(arguments.end(), titles.begin(), titles.end());
  arguments.insert(arguments.end(), {"--out", options.out + "/snapshots.png"});
  const std::string layer = options.out + "/flow.csv",
                    chains = options.out + "/contacts_at_rest.vtp";
  const bool has_flow = flow.fields().samples() > 0;
  if (has_flow) flow.fields().write_csv(layer);
  const bool drawn =
      example::draw(arguments) &&
      (!has_flow || example::draw({"cells", layer, "--value", "speed", "--least",
                                   "solid fraction=0.2", "--title", "Mean speed, middle layer",
                                   "--out", options.out + "/flow.png"})) &&
      (!has_chains ||
       example::draw({"draw", chains, "--slab",
                      silt::text("y=", scene.width / 2 - 3e-3, ",", scene.width / 2 + 3e-3),
                      "--walls", options.out + "/outlines.vtp", "--title", "Before opening",
                      "--out", options.out + "/chains.png"})) &&
      example::draw({"curves", options.out + "/discharge.csv", "--x", "time", "--y", "mass below",
                     "--reference", silt::text("Beverloo:", theory, ",", 0), "--title", "Discharge",
                     "--out", options.out + "/discharge.png"}) &&
      example::draw({"curves", options.out + "/discharge.csv", "--x", "time", "--y",
                     "contacts,time per step", "--title", "Contacts and time per step", "--out",
                     options.out + "/contacts.png"});

  std::printf(
      "\nDischarge %.3f kg/s, Beverloo %.3f kg/s (ratio %.3f); %.1f %% of %.3f kg left the "
      "hopper in %.2f s.\nLargest overlap %.2f %% of the radius; %zu of %zu particles; %.0f s.\n",
      rate, theory, rate / theory, 100 * out / total, total,
      curve.time.empty() ? 0 : curve.time.back(), 100 * sim.peak_overlap(), sim.size(),
      scene.particles, whole.seconds());
  summary.print_checks();
  std::printf(
      "Look at: %s/%s\n         %s/vtk/particles.pvd (ParaView), %s/discharge.csv, "
      "%s/summary.json\n",
      options.out.c_str(),
      drawn ? "snapshots.png, flow.png, chains.png, discharge.png, contacts.png" : "",
      options.out.c_str(), options.out.c_str(), options.out.c_str());
  if (!drawn) std::printf("(no pictures: they need Python 3 with numpy and matplotlib)\n");
  return summary.all_hold() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  example::Command command("Hopper discharge of 100 000 or 300 000 spheres into a box below");
  Scene scene;
  bool unsorted = false, mixed = false, round = false;
  double wall_friction = 0.3;
  command.add("--particles", scene.particles, 1000, 10000000, "Number of spheres");
  command.add("--density", scene.density, 1, 20000, "Density of the grains [kg/m3]");
  command.add_flag("--flat", scene.flat, "A flat floor around the orifice instead of a funnel");
  command.add_flag("--mixed", mixed, "Compute pairs of particles in float (silt::Mixed)");
  command.add_flag("--no-sort", unsorted, "Never sort the particles in memory");
  command.add_flag("--silo", round, "Run a round silo over a cone instead: pressure on its walls");
  command.add("--wall-friction", wall_friction, 0.05, 0.5,
              "With --silo: friction of grains on the wall [-]");
  return command.run(argc, argv, [&] {
    for (const char* other :
         {"--restart", "--particles", "--density", "--flat", "--mixed", "--no-sort"})
      silt::require(!round || !command.given(other), "--silo is a scene of its own; leave ", other,
                    " out");
    if (round) return silo::load_walls(wall_friction, command.options);
    scene.sort = !unsorted;
    if (command.options.quick) {
      if (!command.given("--particles")) scene.particles = 10000;
      scene.width = 0.05;
      scene.orifice = 0.025;
      const double moments[4] = {0.1, 0.25, 0.35, 0.65};
      std::copy(moments, moments + 4, scene.moments);
    }
    return mixed ? simulate<silt::Mixed>(scene, command.options)
                 : simulate<silt::Double>(scene, command.options);
  });
}
