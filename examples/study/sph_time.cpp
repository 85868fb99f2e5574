// silt - BSD-3-Clause, see LICENSE
// SPH study: spacing, speed of sound, time integration and Courant number; grain steps per liquid
// step.

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <silt/silt.hpp>

#include "study/sph.hpp"
#include "study/sph_scenes.hpp"

namespace studies::sph {

Variants resolutions(bool quick) {
  Variants all;
  for (const double fine :
       quick ? std::vector<double>{0.5, 0.75, 1} : std::vector<double>{0.75, 1, 1.5, 2, 3})
    all.push_back(
        {silt::text("drop of ", count(20, {.fine = fine}), " a radius"), all_of({.fine = fine})});
  return all;
}

Variants sounds(double fine, bool quick) {
  Variants all;
  for (const double sound : {5, 10, 20, 40})
    if (!quick || sound < 30)
      all.push_back({silt::text("c = ", sound, " v"), all_of({.fine = fine, .sound = sound})});
  for (const double alpha : {0.0, 0.005, 0.02, 0.05, 0.1})
    if (!quick || alpha == 0.1)
      all.push_back(
          {silt::text("c = 10 v, alpha = ", alpha), all_of({.fine = fine, .alpha = alpha})});
  return all;
}

Variants time_steps(double fine, bool quick) {
  Variants all;
  const auto add = [&](const char* name, double courant, auto time, bool in_quick) {
    if (quick && !in_quick) return;
    all.push_back(
        {silt::text(name, ", ", courant), all_of({.fine = fine, .courant = courant}, time)});
  };
  for (const double courant : {0.2, 0.4, 0.6, 0.8, 1.0})
    add("leapfrog", courant, silt::LeapfrogTime{}, courant == 0.2 || courant == 0.6);
  for (const double courant : {0.2, 0.3, 0.6})
    add("symplectic", courant, silt::SymplecticTime{}, courant == 0.3);
  for (const double courant : {0.1, 0.2})
    add("Verlet", courant, silt::VerletTime{}, courant == 0.2);
  return all;
}

silt::Study::Variant box_with_step(double of_liquid, bool quick) {
  return [=](silt::StudyRun& run) {
    const double L = 1, depth = 0.4, raised = 0.02, s = quick ? 0.04 : 0.025;
    const double start = depth + 1.25 * raised, c = 10 * std::sqrt(2 * g * depth);
    silt::Sph water{
        silt::Liquid{.density = rho, .sound_speed = c},
        {.spacing = s, .region = {{0, 0, 0}, {L, 0, 0.7}}, .smoothing = 1.0, .dimensions = 2}};
    water.gravity = {0, 0, -g};
    const double step = of_liquid * water.setup().courant * water.setup().h() / c;
    std::vector<silt::Vec3d> corners;
    for (const double x : {-0.12, 0.12})
      for (const double y : {-0.5, 0.5})
        for (const double z : {-0.1, 0.1}) corners.push_back({x, y, z});
    silt::Particles<silt::Polyhedron> boxes;
    const auto form = boxes.add_form(silt::Polyhedron::from_points(corners));
    boxes.add({.form = form, .position = {L / 2, 0, start}, .density = 500});
    water.fill([=](const silt::Vec3d& x) {
      return x.z < depth && !(std::abs(x.x - L / 2) < 0.12 && x.z > start - 0.1);
    });
    const silt::Contacts<silt::HertzMindlin> contacts{
        {.youngs_modulus = 1e6, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.3}};
    silt::Simulation sim{std::move(boxes), contacts, std::move(water)};
    sim.gravity = {0, 0, -g};
    sim.threads = 1;
    sim.time_step = step;
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, contacts.material(0));
    sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, contacts.material(0));
    sim.add_wall(silt::Plane{{L, 0, 0}, {-1, 0, 0}}, contacts.material(0));
    std::vector<double> z;
    run.time([&] {
      for (int k = 0; k < 20; ++k) sim.run(0.025), z.push_back(sim.position(0).z - depth);
    });
    run.value("heave", z);
    run.note("grains' step", 1e6 * step, "us");
  };
}

}  // namespace studies::sph
