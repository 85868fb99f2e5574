// silt - BSD-3-Clause, see LICENSE
//
// Limits of softening. A study of pneumatic conveying in bends lets a particle hit a flat wall of
// its own material and plots the overlap over the shear modulus; soft particles pass through the
// wall. Here the same against the closed form: the overlap on a plane, penetration on a plate of
// triangles, as a plane is the face of a half-space without another side.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include <silt/boundary/triangle_mesh.hpp>
#include <silt/contact/impact.hpp>
#include <silt/files/csv_table.hpp>

#include "study/studies.hpp"
#include "study/two_flats.hpp"

namespace stiffness_study {

namespace {

namespace flats = studies::two_flats;

constexpr double restitution = 0.4;
constexpr double speeds[] = {1, 4, 7};                                                // [m/s]
constexpr double moduli[] = {1e3, 5e3, 1e4, 5e4, 1e5, 5e5, 1e6, 5e6, 1e7, 1e8, 1e9};  // [Pa] G

/// 5e3 as "5e3".
std::string short_name(double G) {
  const double power = std::floor(std::log10(G) + 1e-9);
  return silt::text(std::round(G / std::pow(10, power)), 'e', power);
}

/// Overlap over diameter [%].
double closed_form(double shear_modulus, double speed) {
  const double zeta = silt::damping_ratio(restitution, silt::DampingEnd::ZeroOverlap);
  return 100 / (2 * flats::radius) *
         silt::hertz_max_overlap(
             {flats::modulus(shear_modulus), flats::radius, flats::mass(), speed, zeta});
}

constexpr double steps_a_contact = 2000;

/// The same measured on a plane.
double measured(double shear_modulus, double speed) {
  auto sim = flats::make(shear_modulus, restitution, speed);
  const double contact = flats::contact_time(shear_modulus, speed);
  sim.time_step = contact / steps_a_contact;
  sim.guard.max_overlap = 10;  // what is deeper than that the study wants to see, too
  sim.run(flats::free_path / 2 / speed + contact);
  return 100 * sim.peak_overlap() / 2;
}

/// True if the sphere passes through a two-sided plate of triangles: with the guard's limits lifted
/// its centre emerges behind it.
bool passes(double shear_modulus, double speed) {
  silt::Particles<silt::Sphere> one;
  one.add({.position = {0, 0, 1.1 * flats::radius},
           .radius = flats::radius,
           .density = flats::density,
           .velocity = {0, 0, -speed}});
  const auto material = flats::material(shear_modulus, restitution);
  silt::Simulation sim{std::move(one), silt::Contacts<flats::Law>{material}};
  const double a = 20 * flats::radius, contact = flats::contact_time(shear_modulus, speed);
  sim.add_wall(silt::TriangleMesh({{silt::Vec3d{-a, -a, 0}, {a, -a, 0}, {a, a, 0}},
                                   {silt::Vec3d{-a, -a, 0}, {a, a, 0}, {-a, a, 0}}}),
               material);
  sim.threads = 1;
  sim.time_step = contact / steps_a_contact;
  sim.guard.max_overlap = 10, sim.guard.through_meshes = true;
  sim.run(0.1 * flats::radius / speed + 3 * contact);
  return sim.position(0).z < 0;
}

/// 20 ms of the same sphere between its walls, at silt's own time step.
silt::Study study() {
  silt::Study study(
      "Overlap in % of the diameter over the shear modulus: impacts on a wall, e = 0.4");
  for (const double G : moduli)
    study.variant("G = " + short_name(G), [=](silt::StudyRun& run) {
      auto sim = flats::make(G, restitution, 7);
      sim.guard.max_overlap = sim.guard.max_travel = 10;
      run.time([&] { sim.run(0.02); });
      for (const double v : speeds)
        run.error(
            silt::text("overlap at ", v, " m/s"), [=] { return measured(G, v); }, "%");
      run.note("dt", 1e6 * sim.step_length(), "us");
    });
  study.accept("overlap at 1 m/s", 2);
  return study;
}

struct Comparison {
  double off = 0;              // [-] largest relative difference of measured and closed form
  int sides_wrong = 0;         // [-] that pass though they should not, or the other way
  double softest[3]{0, 0, 0};  // [Pa] that rebounds, of each speed
};

Comparison compare(const std::string& table_path) {
  silt::CsvTable table(
      table_path,
      {"G [Pa]", "1 m/s [%]", "4 m/s [%]", "7 m/s [%]", "1 m/s; silt [%]", "4 m/s; silt [%]",
       "7 m/s; silt [%]", "passes at 1 m/s [-]", "passes at 4 m/s [-]", "passes at 7 m/s [-]"});
  Comparison out;
  for (auto G = std::rbegin(moduli); G != std::rend(moduli); ++G) {
    std::vector<double> row(10, *G);
    for (std::size_t k = 0; k < 3; ++k) {
      const double wanted = closed_form(*G, speeds[k]), found = measured(*G, speeds[k]);
      const bool through = passes(*G, speeds[k]);
      row[1 + k] = wanted, row[4 + k] = found, row[7 + k] = through;
      out.off = std::max(out.off, std::abs(found / wanted - 1));
      out.sides_wrong += through != (wanted > 50);
      if (!through) out.softest[k] = *G;
    }
    table.add_row(row);
  }
  return out;
}

/// silt's message with its own overlap limit.
std::string guard_sentence() {
  auto sim = flats::make(1e5, restitution, 7);
  try {
    sim.run(0.02);
  } catch (const silt::SimulationError& e) {
    return e.what();
  }
  return "";
}

void run(const studies::Setting& setting, example::Summary& summary) {
  silt::Study cost = study();
  studies::run_and_report(cost, setting, "cost");
  studies::add_recommendation(summary, "2_percent_at_1_m_s", cost);

  const std::string path = setting.out + "/overlap.csv";
  const auto found = compare(path);
  if (example::draw(
          {"curves",        path,
           "--x",           "G",
           "--y",           "1 m/s,4 m/s,7 m/s",
           "--marks",       "1 m/s; silt,4 m/s; silt,7 m/s; silt",
           "--marks-label", "simulated",
           "--y-label",     "overlap over diameter [%]",
           "--log",         "xy",
           "--reference",   "passes through:0,50",
           "--title",       "Largest overlap of an impact on a wall: closed form and silt",
           "--out",         setting.out + "/overlap.png"}))
    std::printf("Look at %s/overlap.png.\n", setting.out.c_str());
  summary.result("largest_relative_difference_to_closed_form", found.off);
  // Published: penetration below 1e4, 5e4 and 1e5 Pa, on this grid of moduli. By the closed form
  // 5e3 Pa rebounds at 1 m/s (30 % of the diameter), and silt agrees with it.
  const double published[] = {1e4, 5e4, 1e5};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::string at = silt::text("_at_", speeds[k], "_m_s");
    summary.result("softest_that_rebounds_pa" + at, found.softest[k]);
    summary.result("published_softest_that_rebounds_pa" + at, published[k]);
    if (k > 0)
      summary.check_at_most("softest_off_published_pa" + at,
                            std::abs(found.softest[k] - published[k]), 0);
  }
  const std::string sentence = guard_sentence();
  summary.result("guard_at_1e5_pa_and_7_m_s", sentence);
  summary.check_at_least("guard_stops_1e5_pa", sentence.empty() ? 0 : 1, 1);
  // The dashpot's force starts at some instant within a step: an error of up to one step of it, 2
  // pi zeta/n (tests/physics/impact.cpp).
  const double zeta = silt::damping_ratio(restitution, silt::DampingEnd::ZeroOverlap);
  summary.check_at_most("off_closed_form", found.off, 2 * M_PI * zeta / steps_a_contact);
  summary.check_at_most("passing_unlike_closed_form", found.sides_wrong, 0);
  summary.check_at_most("overlap_percent_at_1_m_s_G_5e6", measured(5e6, 1), 2);
  summary.check_at_most("off_25_percent_at_1_m_s_G_1e4", std::abs(measured(1e4, 1) - 25), 2.5);
}

const studies::Registered here{
    "stiffness", "overlap over the shear modulus, and what passes through a wall", run};

}  // namespace

}  // namespace stiffness_study
