// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/names.hpp>
#include <silt/module/heat/surroundings.hpp>

namespace silt::inline SILT_TARGET {

/// Module: heat (HeatConduction, FrictionHeat or Heat) and radiation between neighbouring
/// particles.
///
///   silt::MutualRadiation{silt::HeatConduction{...}, {.emissivity = 0.9, .gap = 1.4e-3}}
///
///   Q_ij = sigma (T_j^4 - T_i^4)/(s_i + 1/(A_i F_ij) + s_j)                              (1)
///   A_i F_ij = pi R_i^2 R_j^2/r^2,   s = (1 - e)/(e A),   A = 4 pi R^2                    (2)
///
/// for all pairs with a surface distance below `gap`: the network of two grey diffuse surfaces. The
/// view factor is that of spheres far apart, F_ij = R_j^2/(4 r^2); at contact it is 17 % too small.
/// Shadowing by other particles is not computed. Instead `gap` must end where shadowing would
/// begin: where the view factors of a particle sum to 1. In a packing of solid fraction f with Z
/// contacts the sum up to the distance r is about Z/16 + 3/4 f (r/R - 2); a random packing (f =
/// 0.6, Z = 6) needs a gap of 1.4 R. Radiation to surroundings beyond the neighbours is neglected;
/// in dilute systems add the part Radiation.
///
/// Source: network of grey surfaces: textbooks of heat transfer, recalled. Neighbours are
///         sufficient: quasi Monte Carlo ray tracing of pebble beds, abstract read (hplpb.com.cn,
///         article 8879f42a): view factors within two diameters sum to 0.98.
/// Valid:  opaque particles, a transparent gas.
/// Units:  SI. Shapes: all; bodies as their bounding sphere.
/// Errors: InputError naming field, value and unit; materials without an emissivity.
/// Tests:  tests/physics/radiation.cpp.
template <class Base>
struct MutualRadiation : Base {
  struct Surfaces {
    double emissivity = 0.9;    // [-] in (0, 1], of material 0
    double gap = 0;             // [m] > 0 between surfaces, range of the radiation
    DynArray<double> others{};  // [-] emissivities of the contacts' material 1, 2, ...
  } surfaces;

  static_assert(
      !requires { &Base::pair_flux; },
      "MutualRadiation of a module that already acts between neighbours: give it the "
      "module inside, as GasConduction{MutualRadiation{...}, ...}");
  MutualRadiation(Base base, Surfaces of) : Base(std::move(base)), surfaces(std::move(of)) {}

  double gap_reach() const { return surfaces.gap; }
  double pair_flux(const Apart& d, const Seen& a, const HeatFields& of_a, const Seen& b,
                   const HeatFields& of_b) const {  // [W]
    return exchange(d, a, b) * (fourth(of_b.temperature) - fourth(of_a.temperature));
  }
  double pair_slope(const Apart& d, const Seen& a, const HeatFields& of_a, const Seen& b,
                    const HeatFields& of_b) const {  // [W/K]
    const double T = std::max(of_a.temperature, of_b.temperature);
    return 4 * exchange(d, a, b) * T * T * T;
  }
  /// [W/K4]
  double exchange(const Apart& d, const Seen& a, const Seen& b) const {
    const double seen = std::numbers::pi * a.radius * a.radius * b.radius * b.radius /
                        (d.distance * d.distance);  // [m2]
    return Radiation::sigma / (of_surface(a) + 1 / seen + of_surface(b));
  }
  template <class Sim>
  void check(const Sim& sim) const {
    Base::check(sim);
    require_positive("MutualRadiation.gap", surfaces.gap, "m");
    check_emissivity("MutualRadiation.emissivity", surfaces.emissivity);
    for (std::size_t k = 0; k < surfaces.others.size(); ++k)
      check_emissivity(
          text("MutualRadiation.others[", k, "]", detail::after_entry(sim.contacts(), k + 1)),
          surfaces.others[k]);
    detail::check_entries("MutualRadiation.others", surfaces.others.size(), 1, sim.contacts());
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (!(sim.material(k) <= surfaces.others.size()))
        throw InputError(text(
            "MutualRadiation: particle ", sim.id(k), " is of ", sim.material_name(sim.material(k)),
            ", which has no emissivity in `others`; add it there (the first entry "
            "is of material 1)"));
  }

 private:
  static double fourth(double T) { return T * T * T * T; }
  static void check_emissivity(const std::string& name, double e) {
    require(e > 0 && e <= 1, name, " = ", e, " [-] must be in (0, 1]");
  }
  /// [1/m2] resistance of a grey surface.
  double of_surface(const Seen& p) const {
    const double e = p.material == 0 ? surfaces.emissivity : surfaces.others.at(p.material - 1);
    return (1 - e) / (e * 4 * std::numbers::pi * p.radius * p.radius);
  }
};

/// Part of Heat: radiation to an infinite plane of one temperature, large compared with the
/// particles. Half of the radiation of a sphere reaches the plane, at any distance.
///
///   Q = sigma e 2 pi R^2 (T_wall^4 - T^4)
///
/// The plane is black, or so large that it appears black. Particles farther than `gap` are taken as
/// hidden by others.
/// Tests:  tests/physics/radiation.cpp.
/// Source: Stefan and Boltzmann's law; view factor 1/2 of a sphere and an infinite plane.
/// Valid:  planes large compared with the particles; particles within `gap` that are not hidden.
/// Units:  SI.
/// Errors: InputError naming field, value, unit and allowed range.
struct PlaneRadiation {
  Vec3d point{0, 0, 0};         // [m]
  Vec3d normal{0, 0, 1};        // [-] any length, towards the particles
  double temperature = 293.15;  // [K]
  double emissivity = 0.9;      // [-] in [0, 1], of the particles
  double gap = 0;               // [m] > 0, between the surfaces

  double watts(const Seen& p, double T, double, double) const {
    return factor(p) * (std::pow(temperature, 4) - std::pow(T, 4));
  }
  double slope(const Seen& p, double T) const { return 4 * factor(p) * T * T * T; }  // [W/K]
  void check() const {
    require_in("PlaneRadiation.emissivity", emissivity, "-", 0, 1);
    require_not_negative("PlaneRadiation.temperature", temperature, "K");
    require_positive("PlaneRadiation.gap", gap, "m");
    require(is_finite(point) && is_finite(normal) && norm(normal) > 0, "PlaneRadiation: its point ",
            point, " [m] and normal ", normal, " must be finite, and the normal not 0");
  }

 private:
  double factor(const Seen& p) const {
    const double d = dot(p.position - point, normal) / norm(normal);
    if (!(d > 0 && d < p.radius + gap)) return 0;
    return Radiation::sigma * emissivity * 2 * std::numbers::pi * p.radius * p.radius;
  }
};

}  // namespace silt
