// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET {

/// Weakly compressible liquid: P = B ((rho/rho_0)^gamma - 1), B = c^2 rho_0/gamma. Its density
/// varies by about (v/c)^2: c should be at least ten times the largest velocity.
struct Liquid {
  double density = 0;      // [kg/m3] rho_0, where the pressure is 0
  double sound_speed = 0;  // [m/s] c
  double exponent = 7;     // [-] gamma

  void check() const {
    require_positive("Liquid.density", density, "kg/m3");
    require_positive("Liquid.sound_speed", sound_speed, "m/s");
    require(exponent >= 1 && exponent <= 10, "Liquid.exponent = ", exponent,
            " must be in [1, 10]; liquids have 7");
  }
  double stiffness() const { return sound_speed * sound_speed * density / exponent; }  // [Pa] B
  double pressure(double rho) const {
    const double s = rho / density;
    if (exponent == 7) {
      const double s2 = s * s, s3 = s2 * s;
      return stiffness() * (s3 * s3 * s - 1);
    }
    return stiffness() * (std::pow(s, exponent) - 1);
  }
  /// [J/kg] elastic energy: integral of P/rho^2 from rho_0 on.
  double elastic_energy(double rho) const {
    // P/rho^2 d rho = B/rho_0 (s^(gamma - 2) - s^-2) d s; powers minus 1, to avoid cancellation.
    const double l = std::log1p((rho - density) / density), n = exponent - 1;
    const double rise = n > 0 ? std::expm1(n * l) / n : l;
    return stiffness() / density * (rise + std::expm1(-l));
  }
  double density_at(double pressure) const {
    return density * std::pow(1 + pressure / stiffness(), 1 / exponent);
  }
};

/// Condition of a liquid at walls: no-slip, or free slip.
enum class Slip { None, Free };

/// Resolution and region.
struct SphSetup {
  /// [-] Courant numbers of LeapfrogTime: the default, and the largest (docs/sph_method.md).
  static constexpr double usual_courant = 0.6, most_courant = 1;
  double spacing = 0;              // [m] initial distance of particles
  Box region;                      // [m] what leaves it is removed and counted; in 2D min.y = max.y
  double smoothing = 0;            // [-] h = smoothing sqrt(D) spacing; 0: 0.9 in 3D, 1.2 in 2D
  int dimensions = 3;              // 2: in x and z; a slice one spacing thick
  std::array<bool, 3> periodic{};  // the region repeats
  Vec3d gravity{0, 0, 0};          // [m/s2]
  double courant = 0;              // [-] of the time step; 0: 0.6; with SymplecticTime 0.3, or
                                   // without diffusion 0.2; with VerletTime 0.2
  std::optional<Slip> slip = {};   // left out: None with a viscosity of the liquid
  double scatter =
      0;  // [-] of the spacing: largest random displacement of new particles from the lattice

  /// `smoothing`, or its default, at which a lattice of particles has no stiffness.
  double smoothing_used() const { return smoothing > 0 ? smoothing : dimensions == 2 ? 1.2 : 0.9; }
  double h() const {
    return smoothing_used() * std::sqrt(static_cast<double>(dimensions)) * spacing;
  }
  double volume() const {
    return dimensions == 2 ? spacing * spacing : spacing * spacing * spacing;
  }  // [m3], or [m2] in 2D
  /// Whether a velocity or an acceleration lies in the plane of a liquid in 2D.
  bool lies_in_plane(const Vec3d& v) const {
    return dimensions == 3 || std::abs(v.y) <= 1e-9 * norm(v);  // rounding of rotated vectors
  }
  void check_gravity(const Vec3d& of) const {
    require(is_finite(of), "SphSetup.gravity = ", of, " [m/s2] must be finite");
    require(lies_in_plane(of), "Sph: gravity = ", of,
            " [m/s2] has a part along y, but in 2D the liquid lies in x and z; turn the scene so "
            "that gravity has no y, or use three dimensions");
  }
  void check() const {
    require_positive("SphSetup.spacing", spacing, "m");
    const Vec3d e = region.extent();
    require(is_finite(region.min) && is_finite(region.max) && e.x > 0 && e.y >= 0 && e.z > 0,
            "SphSetup.region from ", region.min, " to ", region.max,
            " [m] must be finite, its max above its min");
    require(dimensions == 2 || dimensions == 3, "SphSetup.dimensions = ", dimensions,
            " must be 2 or 3");
    require(dimensions == 3 || e.y == 0, "SphSetup.region from ", region.min, " to ", region.max,
            " m: in 2D the liquid lies in a plane; give both corners the y of that plane, on which "
            "bodies must lie too");
    require(smoothing == 0 || (smoothing >= 0.7 && smoothing <= 2),
            "SphSetup.smoothing = ", smoothing, " must be in [0.7, 2]; 0.9 is usual, in 2D 1.2");
    require(courant >= 0 && courant <= most_courant, "SphSetup.courant = ", courant,
            " must be in (0, ", most_courant, "]; 0.6 is usual");
    require(scatter >= 0 && scatter <= 0.3, "SphSetup.scatter = ", scatter,
            " must be in [0, 0.3] of the spacing; 0.2 breaks a lattice up");
    check_gravity(gravity);
    const double length[3] = {e.x, e.y, e.z};
    for (std::size_t d = 0; d < 3; ++d) {
      if (!periodic[d]) continue;
      require(!(dimensions == 2 && d == 1), "SphSetup: in 2D the region cannot be periodic in y");
      const double across = length[d] / spacing;
      require(std::abs(across - std::round(across)) < 1e-6 * across,
              "SphSetup: the region is periodic in ", "xyz"[d], " after ", length[d],
              " m, which is ", across, " spacings; it must be a whole number of them");
      require(length[d] > 4 * h(), "SphSetup: the region is periodic in ", "xyz"[d], " after ",
              length[d], " m, less than two supports of the kernel, ", 4 * h(),
              " m; use a smaller spacing or a longer region");
    }
  }
};

}  // namespace silt
