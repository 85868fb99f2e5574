// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/module/concept.hpp>

namespace silt::inline SILT_TARGET {

/// Fields of modules of charge.
struct ChargeFields {
  double charge = 0;  // [C]
};

/// Charge of particles [C], for any module that has it: sim.field<silt::ElectricCharge>(k).
struct ElectricCharge {
  using Of = ChargeFields;
  static constexpr auto member = &ChargeFields::charge;
};

/// Infinite plane, conducting, grounded and at rest, for image charges.
struct ConductingPlane {
  Vec3d point{0, 0, 0};   // [m]
  Vec3d normal{0, 0, 1};  // [-] any length, either side
};

/// Module: charges in an electric field, Coulomb force between particles, image charges in planes.
///
///   silt::Simulation sim{grains, contacts, silt::Charge{.cutoff = 2e-3}};
///   sim.field<silt::ElectricCharge>(k) = 1e-13;                                           // [C]
///
///   F = q E                                                                              (1)
///   F_ij = q_i q_j/(4 pi eps0 eps_r) (1/r^2 - 1/r_c^2) n,   r < r_c;   0 beyond          (2)
///   F = -q^2/(16 pi eps0 eps_r d^2) n                                                    (3)
///
/// (2) is Coulomb's law, shifted to zero at the cut-off; its energy is q_i q_j/(4 pi eps0 eps_r)
/// (1/r + r/r_c^2 - 2/r_c). Interactions beyond the cut-off are neglected. This suits particles
/// with charges of both signs that screen each other, or few particles; for the choice of the
/// cut-off see docs/charge.md.
///
/// In (3), applied to each grounded plane separately, d is the distance of the centre from the
/// plane and n points from the plane to the centre, on either side. The images of other particles
/// act by (2) with -q_j at the mirrored position of j, for pairs on the same side within the
/// cut-off of each other and of the image. Neglected are images of images between two planes. Pairs
/// on different sides of a plane interact as if it were absent. Particles are points or spheres
/// with a uniform charge; bodies have it at their centre of mass. Charges and fields do not
/// polarise particles.
///
/// Source: (2) shifted force: S.D. Stoddard, J. Ford, Phys. Rev. A 8 (1973) 1504, recalled; (3):
///         textbooks of electrostatics, recalled.
/// Valid:  charges at rest or slow compared with light, no magnetic field.
/// Units:  SI. Shapes: all, at the centre of mass.
/// Errors: InputError for a cut-off or permittivity that is not positive, values that are not
///         finite, a plane without a normal, a box shorter than twice the cut-off.
/// Tests:  tests/physics/charge.cpp.
struct Charge {
  double cutoff = 0;        // [m] > 0, between centres
  Vec3d field{0, 0, 0};     // [V/m]
  double permittivity = 1;  // [-] relative, of the medium
  double start_charge = 0;  // [C] of new particles
  DynArray<ConductingPlane> planes{};

  static constexpr double eps0 = 8.8541878128e-12;  // [F/m] CODATA 2018
  using Fields = ChargeFields;
  static constexpr std::array names{"charge [C]"};
  static constexpr bool needs_velocity = false;

  Fields start(const Seen&) const { return {start_charge}; }
  void divide(Fields& f, double share) const { f.charge *= share; }
  /// Coulomb's factor [N m2/C2].
  double factor() const { return 1 / (4 * std::numbers::pi * eps0 * permittivity); }

  double reach() const { return cutoff; }
  /// (2) divided by the distance [N/m]; 0 beyond the cut-off.
  double shifted(double a, double b, double r) const {
    return r < cutoff ? factor() * a * b * (1 / (r * r) - 1 / (cutoff * cutoff)) / r : 0;
  }
  Vec3d pair_force(const Apart& d, const Seen& at, const Fields& a, const Seen& other,
                   const Fields& b) const {
    Vec3d sum = shifted(a.charge, b.charge, d.distance) * d.from_other;
    for (const ConductingPlane& plane : planes)
      if (const Mirrored m(plane, d, at, other); m.same_side)
        sum -= shifted(a.charge, b.charge, m.distance) * m.along;
    return sum;
  }
  /// The part of image forces that acts on both particles alike; the plane bears the reaction.
  Vec3d pair_force_on_both(const Apart& d, const Seen& at, const Fields& a, const Seen& other,
                           const Fields& b) const {
    Vec3d sum{0, 0, 0};
    for (const ConductingPlane& plane : planes)
      if (const Mirrored m(plane, d, at, other); m.same_side)
        sum -= shifted(a.charge, b.charge, m.distance) * m.across;
    return sum;
  }
  bool pushes_both() const { return !planes.empty(); }
  double pair_stiffness(const Apart& d, const Seen& at, const Fields& a, const Seen& other,
                        const Fields& b) const {
    const double k = 2 * factor() * std::abs(a.charge * b.charge);
    double sum = k / (d.distance * d.distance * d.distance);
    for (const ConductingPlane& plane : planes)
      if (const Mirrored m(plane, d, at, other); m.same_side)
        sum += k / (m.distance * m.distance * m.distance);
    return sum;
  }
  Vec3d force(const Seen& p, const Fields& f) const {
    Vec3d sum = f.charge * field;
    for (const ConductingPlane& plane : planes) {
      const Vec3d n = (1 / norm(plane.normal)) * plane.normal;
      const double d = dot(p.position - plane.point, n);
      if (d != 0) sum -= factor() * f.charge * f.charge / (4 * d * std::abs(d)) * n;
    }
    return sum;
  }
  /// Rate [1/s] of the images: sqrt(dF/dd /m).
  double rate(const Seen& p, const Fields& f) const {
    double stiffness = 0;
    for (const ConductingPlane& plane : planes) {
      const double d = std::abs(dot(p.position - plane.point, plane.normal)) / norm(plane.normal);
      if (d > 0) stiffness += factor() * f.charge * f.charge / (2 * d * d * d);
    }
    return std::sqrt(stiffness / p.mass);
  }
  /// Vectors from b's mirrored position to a [m], and from a's to b except for the sign of `along`.
  struct Mirrored {
    Vec3d along, across;
    double distance;
    bool same_side;
    Mirrored(const ConductingPlane& plane, const Apart& d, const Seen& a, const Seen& b) {
      const Vec3d n = (1 / norm(plane.normal)) * plane.normal;
      const double up_a = dot(a.position - plane.point, n), up_b = dot(b.position - plane.point, n);
      along = d.from_other - dot(d.from_other, n) * n, across = (up_a + up_b) * n;
      distance = norm(along + across), same_side = up_a * up_b > 0;
    }
  };
  template <class Sim>
  void check([[maybe_unused]] const Sim& sim) const {
    require_positive("Charge.cutoff", cutoff, "m");
    require_positive("Charge.permittivity", permittivity, "-");
    require(is_finite(field), "Charge.field = ", field, " [V/m] must be finite");
    require(std::isfinite(start_charge), "Charge.start_charge = ", start_charge,
            " [C] must be finite");
    for (std::size_t k = 0; k < planes.size(); ++k)
      require(
          is_finite(planes[k].point) && is_finite(planes[k].normal) && norm(planes[k].normal) > 0,
          "Charge.planes[", k, "]: its point ", planes[k].point, " [m] and normal ",
          planes[k].normal, " must be finite, and the normal not 0");
    if constexpr (Sim::Domain::periodic)
      for (std::size_t k = 0; k < planes.size(); ++k) {
        const Vec3d& n = planes[k].normal;
        const std::array along{n.x, n.y, n.z};
        for (int d = 0; d < 3; ++d)
          require(
              along[static_cast<std::size_t>(d)] == 0 || !sim.domain().repeats(d), "Charge.planes[",
              k, "]: its normal ", n,
              " has a part along a direction in which the box is periodic, where the plane does "
              "not repeat; turn it, or make the box open there");
      }
  }
};

}  // namespace silt
