// silt - BSD-3-Clause, see LICENSE
//
// Two studies of one's own (docs/studies.md): against a closed form, and against the same scene
// computed much finer.

#include <silt/silt.hpp>
#include <silt/study/study.hpp>

namespace {

// Two beads meet head on; the time step is a part of their contact time.
auto impact(double steps_a_contact) {
  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 5e7, .poisson_ratio = 0.25, .restitution = 0.8};
  silt::Particles<silt::Sphere> beads;
  for (const double side : {-1.0, 1.0})
    beads.add({.position = {side * 1.1e-3, 0, 0},
               .radius = 1e-3,
               .density = 2500,
               .velocity = {-side * 0.5, 0, 0}});
  silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{glass}};
  sim.time_step = 1.3e-4 / steps_a_contact;
  return sim;
}

// 150 beads that fall into a box.
auto box_of_beads(double step) {
  const silt::HertzMindlin::Material rubber{
      .youngs_modulus = 1e6, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.4};
  silt::Particles<silt::Sphere> beads;
  beads.fill({.min = {0, 0, 0}, .max = {0.012, 0.012, 0.1}},
             {.radius = silt::uniform(0.9e-3, 1.1e-3), .density = 2500, .count = 150});
  silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{rubber}};
  sim.gravity = {0, 0, -9.81};
  sim.time_step = step;
  sim.add_wall(silt::box({0, 0, 0}, {0.012, 0.012, 0.1}), rubber);
  return sim;
}

template <class Sim>
double mean_height(const Sim& sim) {
  double sum = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) sum += sim.position(k).z;
  return sum / static_cast<double>(sim.rows());
}

void against_a_closed_form() {
  silt::Study study{"Restitution of 0.8 over the time step"};
  for (const double steps : {10, 15, 20, 40, 80, 160})
    study.variant(silt::text("t_c/", steps), [=](silt::StudyRun& run) {
      auto sim = impact(steps);
      run.time([&] { sim.run(1e-3); });
      run.error("error of e", norm(sim.velocity(1) - sim.velocity(0)) / 1.0 - 0.8);
    });
  study.accept("error of e", 0.001);
  study.run();
  study.report("study/restitution");
}

void against_a_finer_one() {
  silt::Study study{"A bed of beads over the time step"};
  const auto with = [](double step) {
    return [=](silt::StudyRun& run) {
      auto sim = box_of_beads(step);
      run.time([&] { sim.run(0.1); });
      run.value("height", 1e3 * mean_height(sim), "mm");
    };
  };
  study.reference("2 us", with(2e-6));
  for (const double us : {5, 10, 20, 30, 40}) study.variant(silt::text(us, " us"), with(1e-6 * us));
  study.accept("error of height", 0.001);
  study.run({.repeats = 3});
  study.report("study/bed");
}

}  // namespace

int main() {
  against_a_closed_form();
  against_a_finer_one();
}
