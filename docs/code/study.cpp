// silt - BSD-3-Clause, see LICENSE
//
// Two user-defined studies (docs/studies.md): against a closed form, and against the same scene
// computed with a much finer step.

#include <silt/silt.hpp>
#include <silt/study/study.hpp>

namespace {

// Two beads collide head-on; the time step is a fraction of their contact time.
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

bool against_a_closed_form() {
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

  // Fails if the restitution does not converge to the law's with finer steps, or is far off in
  // coarse ones: 0.02 at ten steps.
  const auto& rows = study.results().rows;
  const auto error = [&](std::size_t k) { return rows[k].errors.at(0).value; };
  for (const auto& row : rows)
    if (row.failed() || std::abs(row.errors.at(0).value) > 0.02) return false;
  return std::abs(error(5)) < 0.001;
}

bool against_a_finer_one() {
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

  // Fails if the bed depends on the step (its height, by more than 0.5 %), or has not come down:
  // 150 beads of 1 mm occupy 4.4 mm of the box without voids, and lie below twice that.
  const double mean = 1e3 * mean_height([] {
                        auto sim = box_of_beads(2e-5);
                        sim.run(0.1);
                        return sim;
                      }());
  for (const auto& row : study.results().rows)
    if (row.failed() || row.errors.at(0).value > 0.005) return false;
  return mean > 3.5 && mean < 5.5;
}

}  // namespace

int main() {
  const bool impacts = against_a_closed_form(), beds = against_a_finer_one();
  if (!impacts) std::puts("wrong: e must be right to 0.02 at any step and to 0.001 at the finest");
  if (!beds) std::puts("wrong: the bed's height must be 3.5 to 5.5 mm, and to 0.5 % at any step");
  return impacts && beds ? 0 : 1;
}
