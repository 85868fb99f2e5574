// silt - BSD-3-Clause, see LICENSE
// The program of docs/super_ellipsoids.md.

#include <cstdio>

#include <silt/shape/narrow/super_ellipsoids.hpp>
#include <silt/shape/super_ellipsoid.hpp>
#include <silt/silt.hpp>

/// Tablets fall into a box; returns true if the result is right.
bool fill_box() {
  silt::Particles<silt::SuperEllipsoid> pills;
  const auto tablet = pills.add_form({.a = 4e-3, .b = 4e-3, .c = 2e-3, .s1 = 6, .s2 = 2});  // [m]
  const auto capsule = pills.add_form({.a = 2e-3, .b = 2e-3, .c = 5e-3, .s1 = 3, .s2 = 2});
  for (const auto form : {tablet, capsule})
    pills.fill(
        {.min = {0, 0, 0}, .max = {0.06, 0.06, 0.1}},
        {.radius = silt::uniform(3.5e-3, 4.5e-3), .density = 1200, .count = 40, .form = form});
  const silt::HertzMindlin::Material coated{
      .youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.3};
  silt::Simulation sim{std::move(pills), silt::Contacts<silt::HertzMindlin>{coated}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::box({0, 0, 0}, {0.06, 0.06, 0.2}), coated);
  sim.run(0.3);
  std::printf("%zu pills, %zu contacts, the deepest ever %.1f %% of the thinnest half\n",
              sim.size(), sim.touching_pairs(), 100 * sim.peak_overlap());
  return sim.size() == 80;
}

int main() {
  const silt::SuperEllipsoid tablet{.a = 4e-3, .b = 4e-3, .c = 2e-3, .s1 = 6, .s2 = 2};  // [m]
  tablet.check();
  const silt::MassProperties mass = tablet.mass_properties();  // of density 1
  std::printf("volume %.4g m3, surface %.4g m2, sphericity %.3f\n", mass.volume,
              tablet.surface_area(), tablet.sphericity());

  const auto form = form_of(tablet);
  const auto upright = silt::body_axes(silt::Quaternion{});
  const auto tilted = silt::body_axes(silt::rotation_about({1, 0, 0}, 0.3));
  silt::PosedPair pair{form, form, upright, tilted, silt::Vec3d{3e-3, 0, 4.6e-3}};
  silt::NormalMemory<double> memory;  // kept from step to step
  const auto contact = touch(pair, memory);
  if (contact.touches)
    std::printf("overlap %.3g m, normal (%.3f, %.3f, %.3f), R* %.3g m\n", contact.overlap,
                contact.normal.x, contact.normal.y, contact.normal.z, contact.R_eff);
  return contact.touches && contact.solved && fill_box() ? 0 : 1;
}
