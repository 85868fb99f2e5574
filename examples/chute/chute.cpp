// silt - BSD-3-Clause, see LICENSE
//
// Wear of a transfer chute: ore falls onto a steep steel plate, slides down, passes a bend and
// leaves. A batch is fed and leaves entirely: the whole batch has passed each place. Wear by
// sliding (Archard) and by impacts (Finnie) is compared with values from contacts and impacts
// recorded by other means, with the friction work, and with a sliding block.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <silt/silt.hpp>

#include "chute/scene.hpp"
#include "support/example.hpp"

namespace {

using chute::Scene, chute::Worn;
using silt::Vec3d;
using Law = silt::HertzMindlin;
using Sliding = silt::Wear<silt::Archard>;
using Cutting = silt::Wear<silt::Finnie>;
/// A user-defined law: the friction work on each facet, in J instead of m3.
struct FrictionWork {
  double volume(const silt::WallRub& c) const { return c.tangential_force * c.slip * c.duration; }
};
using Rubbing = silt::Wear<FrictionWork>;

auto make_simulation(const Scene& s) {
  const Law::Material ore{
      .youngs_modulus = 3e7, .poisson_ratio = 0.3, .restitution = 0.3, .friction = 0.5};
  const Law::Material steel{
      .youngs_modulus = 6e7, .poisson_ratio = 0.3, .restitution = 0.3, .friction = s.friction};
  // Grains of ore are not round: rolling resistance above friction makes them slide.
  silt::Contacts<Law, silt::RollingEpsd, silt::SeveralMaterials> contacts{
      {ore, steel}, {.rolling_friction = 0.5}};
  contacts.set_pair(ore, steel, {.restitution = 0.3, .friction = s.friction});
  silt::Simulation sim{silt::Particles<silt::Sphere>{},
                       contacts,
                       silt::ContactEvents{},
                       Sliding{s.archard},
                       Cutting{s.finnie},
                       Rubbing{}};
  sim.gravity = {0, 0, -s.g};
  sim.add_wall(s.mesh(), steel, {.name = "chute"});
  const double end = s.at(s.length(), 0, 0).z;
  sim.add_outlet({{-2, -2, end - 0.5}, {4, 2, end - 0.15}});
  sim.add_inlet(s.inlet(), {.radius = silt::uniform(s.r_min, s.r_max),
                            .density = s.density,
                            .velocity = {0, 0, -s.feed},
                            .total = static_cast<std::uint64_t>(s.batch / s.mean_mass()),
                            .mass_rate = s.rate});
  return sim;
}

template <class M, class Sim>
Worn worn_by(const Sim& sim, const Scene& s) {
  Worn worn(s);
  const silt::TriangleMesh mesh = s.mesh();
  const auto volumes = silt::worn_volumes<M>(sim, "chute");
  for (std::size_t t = 0; t < volumes.size(); ++t) {
    const auto& [p, q, r] = mesh.triangles()[t];
    const auto& x = mesh.vertices();
    worn.add(s, 1.0 / 3 * (x[p] + x[q] + x[r]), mesh.normals()[t], volumes[t]);
  }
  return worn;
}

/// Wear computed without the modules: from contacts sampled at intervals, and from impacts.
struct Seen {
  static constexpr double sample = 0.5e-3;  // [s]
  Worn sliding, impacts;
  std::array<double, 18> angles{};  // [m3] cut by impacts at 0 to 5 degrees, 5 to 10, ...

  template <class Sim>
  void read_contacts(const Sim& now, const Scene& s) {
    now.for_each_contact([&](const silt::ContactSeen& c) {
      if (c.wall == silt::no_wall) return;
      const std::size_t k = c.place_a;
      const Vec3d v = now.velocity(k) + cross(now.angular_velocity(k), c.point - now.position(k));
      const double way = norm(v - dot(v, c.normal) * c.normal) * sample;
      sliding.add(s, c.point, c.normal, s.archard_factor() * c.normal_force * way);
    });
  }
  void note(const silt::ContactEvent& c, double mass, const Scene& s) {
    const double angle = std::atan2(c.normal_speed, c.tangential_speed);
    const double V =
        chute::cut(s.finnie, mass, std::hypot(c.normal_speed, c.tangential_speed), angle);
    impacts.add(s, c.point, c.normal, V);
    angles[static_cast<std::size_t>(std::min(angle / Scene::radians(5), 17.0))] += V;
  }
};

/// Feeds the batch until all of it has left; returns the outflow [kg/s] in the steady part.
template <class Sim>
double run(Sim& sim, const Scene& s, const std::string& out, Seen& seen) {
  auto contacts =
      silt::at(silt::every(Seen::sample), [&](const auto& now) { seen.read_contacts(now, s); });
  const auto impacts = silt::on_contact_begin([&](const silt::ContactEvent& c) {
    if (c.wall != silt::no_wall && c.normal_speed > 0) seen.note(c, sim.mass(sim.find(c.a)), s);
  });
  auto table =
      silt::table(out + "/worn.csv",
                  {"time [s]", "in the scene [-]", "left [kg]", "sliding [mm3]", "impacts [mm3]"},
                  silt::every(0.01), [](const auto& now) {
                    return std::array<double, 5>{now.time(), static_cast<double>(now.size()),
                                                 now.outlet(0).mass,
                                                 1e9 * silt::worn_volume<Sliding>(now, "chute"),
                                                 1e9 * silt::worn_volume<Cutting>(now, "chute")};
                  });
  auto series = silt::vtk_series(out + "/vtk", silt::every(0.05));
  const auto go_on = [&](double time) {
    sim.run(time, table, contacts, impacts, series, silt::progress());
  };
  const double feeding = s.batch / s.rate, filled = std::min(0.5 * feeding, 0.8);  // [s]
  go_on(filled);
  const double before = sim.outlet(0).mass;
  go_on(feeding - filled);
  const double flow = (sim.outlet(0).mass - before) / (sim.time() - filled);
  silt::write_particles(out + "/flow.vtp", sim);
  while (sim.size() > 0 && sim.time() < feeding + 5) go_on(0.1);
  silt::write_wear<Sliding>(out + "/sliding.vtp", sim, "chute");
  silt::write_wear<Cutting>(out + "/impacts.vtp", sim, "chute");
  return flow;
}

/// Depths in mm after 100 000 t, and the angles at which impacts cause wear.
void write_tables(const Scene& s, const std::string& out, const Worn& slid, const Worn& cuts,
                  const Seen& seen, double fed) {
  silt::CsvTable profile(out + "/profile.csv", {"place [m]", "sliding", "sliding by contacts",
                                                "block", "impacts", "impacts by events"});
  const double depth = 1e11 / fed / (s.cell() * s.width);
  const auto block = chute::block(s);
  for (std::size_t k = 0; k < block.size(); ++k)
    profile.add_row({s.middle(k), depth * slid.floor[k], depth * seen.sliding.floor[k],
                     1e11 * block[k], depth * cuts.floor[k], depth * seen.impacts.floor[k]});
  silt::CsvTable by_angle(out + "/angles.csv", {"angle [degrees]", "share of wear [%]"});
  for (std::size_t k = 0; k < seen.angles.size(); ++k)
    by_angle.add_row({5 * static_cast<double>(k) + 2.5, 100 * seen.angles[k] / seen.impacts.all});
}

void check_wear(example::Summary& summary, const Scene& s, const Worn& slid, const Worn& cuts,
                const Seen& seen, double work, double fed) {
  summary.check_within("sliding_over_that_of_contacts", slid.all / seen.sliding.all, 1, 0.02,
                       "contacts are read every half millisecond; impacts do not last as long");
  summary.check_within("sliding_over_work_of_friction",
                       slid.all / (s.archard_factor() * work / s.friction), 1, 1e-3,
                       "grains slide all the way; loading the tangential springs takes some 1e-5");
  summary.check_within("impacts_over_those_of_events", cuts.all / seen.impacts.all, 1, 1e-9,
                       "rounding: the same impacts");
  double elsewhere = 0;
  for (std::size_t k = 0; k < cuts.floor.size(); ++k)
    elsewhere += std::abs(cuts.floor[k] - seen.impacts.floor[k]);
  summary.check_at_most("impacts_at_another_place", elsewhere / cuts.all, 5e-3);
  const auto block = chute::block(s);
  const double bend = s.upper + s.bend();
  const auto over_block = [&](const char* name, double from, double to) {
    double worn = 0, expected = 0;
    for (std::size_t k = 0; k < block.size(); ++k)
      if (s.middle(k) > from && s.middle(k) < to)
        worn += slid.floor[k], expected += block[k] * s.cell() * s.width * fed;
    summary.check_within(name, worn / expected, 1, 0.1,
                         "grains next to the floor are slower than the mean, and bounce");
  };
  over_block("plate_over_block", s.landing() + 0.15, s.upper);
  over_block("bend_over_block", s.upper, bend);
  over_block("outflow_over_block", bend, s.length());
}

int simulate(const Scene& s, const example::Options& options) {
  const example::Stopwatch whole;
  auto sim = make_simulation(s);
  sim.threads = options.threads;
  silt::make_folder(options.out);
  Seen seen{Worn(s), Worn(s)};
  const double flow = run(sim, s, options.out, seen);
  const Worn slid = worn_by<Sliding>(sim, s), cuts = worn_by<Cutting>(sim, s);
  const double fed = sim.outlet(0).mass, grains = static_cast<double>(sim.inlet(0).placed);
  write_tables(s, options.out, slid, cuts, seen, fed);

  example::Summary summary;
  summary.input("rate_kg_s", s.rate);
  summary.input("batch_kg", s.batch);
  summary.input("width_m", s.width);
  summary.input("slope_of_plate_degrees", s.steep);
  summary.input("slope_of_outflow_degrees", s.flat);
  summary.input("friction_on_steel", s.friction);
  summary.input("facet_m", s.facet);
  summary.input("archard_k_over_h_1_pa", s.archard_factor());
  summary.result("sliding_mm3_per_t", 1e12 * slid.all / fed);
  summary.result("impacts_mm3_per_t", 1e12 * cuts.all / fed);
  summary.result("grains", grains);
  summary.result("flow_kg_s", flow);
  summary.result("largest_overlap_over_radius", sim.peak_overlap());
  summary.result("time_step_s", sim.step_length());
  summary.result("steps", static_cast<double>(sim.step()));
  summary.result("wall_time_s", whole.seconds());
  summary.check_at_most("grains_lost", grains - static_cast<double>(sim.outlet(0).count), 0);
  summary.check_within("mass_over_grains_times_mean", fed / (grains * s.mean_mass()), 1,
                       1.05 / std::sqrt(grains), "three standard errors of the sizes drawn");
  summary.check_within("flow_out_over_rate", flow / s.rate, 1, 0.05,
                       "sizes drawn, and what is in the chute, vary");
  check_wear(summary, s, slid, cuts, seen, silt::worn_volume<Rubbing>(sim, "chute"), fed);
  summary.write(options.out + "/summary.json");
  const bool drawn = example::run_script(SILT_CHUTE_SCRIPT, {options.out, silt::text(1e11 / fed)});
  std::printf("\n%.3g kg have slid down: %.3g mm3/t worn by sliding, %.3g mm3/t by impacts.\n", fed,
              1e12 * slid.all / fed, 1e12 * cuts.all / fed);
  summary.print_checks();
  std::printf("Look at: %s%s/vtk, %s/sliding.vtp (ParaView), %s/profile.csv, %s/summary.json\n",
              drawn ? (options.out + "/wear.png, " + options.out + "/profile.png, ").c_str() : "",
              options.out.c_str(), options.out.c_str(), options.out.c_str(), options.out.c_str());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  example::Command command("Wear of a transfer chute by sliding and impacts");
  Scene scene;
  command.leave_out("--restart");
  command.add("--batch", scene.batch, 0.5, 1000, "Mass of the batch [kg]");
  command.add("--rate", scene.rate, 0.1, 5, "Feed rate [kg/s]");
  command.add("--friction", scene.friction, 0.1, 0.45, "Friction of ore on steel [-]");
  command.add("--steep", scene.steep, 45, 65, "Slope of the plate [degrees]");
  command.add("--facet", scene.facet, 2e-3, 0.02, "Size of the mesh's facets [m]");
  return command.run(argc, argv, [&] {
    if (command.options.quick) {
      if (!command.given("--batch")) scene.batch = 2;
      if (!command.given("--rate")) scene.rate = 1.2;
      scene.width = 0.07;
    }
    return simulate(scene, command.options);
  });
}
