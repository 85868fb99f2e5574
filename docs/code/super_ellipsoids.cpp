// silt - BSD-3-Clause, see LICENSE
// The program of docs/super_ellipsoids.md.

#include <cstdio>

#include <silt/shape/narrow/super_ellipsoids.hpp>
#include <silt/shape/super_ellipsoid.hpp>
#include <silt/silt.hpp>

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
  return contact.touches && contact.solved ? 0 : 1;
}
