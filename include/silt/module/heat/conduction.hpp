// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <optional>
#include <string>

#include <silt/core/dyn_array.hpp>
#include <silt/core/functions.hpp>
#include <silt/core/lanes.hpp>
#include <silt/core/names.hpp>
#include <silt/module/heat/temperature.hpp>
#include <silt/module/wall_values.hpp>

namespace silt::inline SILT_TARGET {

/// Radius of the circle through which heat flows, by Hertz: a = sqrt(R* d), for two spheres or a
/// sphere and a plane. For other shapes R* is the effective radius of the contact, and the circle
/// is that of equivalent spheres; the larger area of flat faces is neglected.
struct HertzCircle {
  template <class Real>
  static SILT_INLINE Real radius(const Touching<Real>& c) {  // [m]
    return sqrt(max(c.R_eff * c.overlap, Real(0)));
  }
};

/// Module: heat conduction through contacts, and the temperature of particles.
///
///   silt::Simulation sim{grains, silt::Contacts<silt::HertzMindlin>{glass},
///                        silt::HeatConduction{.conductivity = 1.1, .heat_capacity = 840}};
///   sim.field<silt::Temperature>(k) = 350;                                              // [K]
///
///   H = 2 k a,  k = 2/(1/k_i + 1/k_j)                                                        (1)
///   a = sqrt(R* d) (E*/E*_real)^(1/3)                                                        (2)
///   m c dT/dt = sum of H (T_j - T_i)                                                         (3)
///
/// (1) is the steady flow between two half spaces in contact through a circle of radius a, small
/// compared with the radii. Each particle has one temperature (small Biot number H/(k R)). The last
/// factor of (2) corrects for contacts that are softer than their solids: at equal force F = 4/3 E*
/// a^3/R* the real circle is smaller by this factor. With Softened the factor is known; otherwise
/// give the real `youngs_modulus`. Without it soft contacts conduct too much: 4.6 times at a
/// modulus 100 times smaller. (3) is integrated by Euler's method, which is stable for steps up to
/// 2 over the fastest decay; that is at most twice the sum of H over m c, by Gershgorin. The
/// automatic time step is at most 1 over an estimate of this bound. A run with a longer step than
/// guard.max_rate (1.25) over the bound itself is stopped.
///
/// `walls`: held_at(), heated_by() or insulated(), for wall 0, 1, ... in order, or by name:
/// {{"drum", held_at(400)}}; all other walls are insulated. Simulation::set_wall_heat() changes a
/// wall at any time. `others`: for material 1, 2, ... of the contacts; `conductivity` and the
/// members after it belong to material 0. Materials of walls are numbered after those of particles
/// (sim.wall(k).material).
///
/// Source: G.K. Batchelor, R.W. O'Brien, Proc. R. Soc. Lond. A 355 (1977) 313 (1), recalled; (2)
///         from Hertz' formulas.
/// Valid:  a < 0.2 R, and no heat flow through fluid in the gap around the contact.
/// Units:  SI. Shapes: all; for a see HertzCircle.
/// Errors: InputError naming field, value and unit; missing materials and walls.
/// Tests:  tests/engine/wall_heat.cpp, tests/physics/heat.cpp.
template <class Circle = HertzCircle>
struct HeatConductionBy {
  double conductivity = 0;             // [W/(m K)] > 0
  double heat_capacity = 0;            // [J/(kg K)] > 0
  double youngs_modulus = 0;           // [Pa] of the real solid; 0: as in the contacts
  double poisson_ratio = 0.3;          // [-] of the real solid
  double start_temperature = 293.15;   // [K] > 0 of new particles
  DynArray<ThermalMaterial> others{};  // for material 1, 2, ... of the contacts
  WallValues<WallHeat> walls{};        // of wall 0, 1, ..., or by name
  std::size_t flux_every = 10;         // [steps] largest interval between computations of the
                                       // flux
  double density = 0;                  // [kg/m3] for FrictionHeat; 0: as its partner's

  using Fields = HeatFields;
  static constexpr std::array names{"temperature [K]"};
  static constexpr auto exchanged = &HeatFields::temperature;
  /// For a pair of materials.
  template <class Real>
  struct Coefficients {
    Real conductivity;  // [W/(m K)] harmonic mean
    Real narrower;      // [-] last factor of (2), without Softened
    Real share;         // [-] of the first end in heat generated at the contact (FrictionHeat)
  };

  Fields start(const Seen&) const { return {start_temperature}; }
  ThermalMaterial material(std::size_t k) const {
    if (k > 0) return others.at(k - 1);
    return {conductivity, heat_capacity, youngs_modulus, poisson_ratio, density};
  }
  bool knows(std::size_t material) const { return material <= others.size(); }

  template <class ContactsType>
  Coefficients<double> coefficients(const ContactsType& contacts, std::size_t a,
                                    std::size_t b) const {
    if (!knows(a) || !knows(b)) return {0, 1, 0.5};  // refused by check()
    const ThermalMaterial i = material(a), j = material(b);
    // Thermal effusivities.
    const bool known = i.density > 0 && j.density > 0;
    const double of_i = std::sqrt(i.conductivity * i.heat_capacity * (known ? i.density : 1)),
                 of_j = std::sqrt(j.conductivity * j.heat_capacity * (known ? j.density : 1));
    return {2 / (1 / i.conductivity + 1 / j.conductivity), narrower(contacts, a, b),
            of_i / (of_i + of_j)};
  }
  template <class Real>
  SILT_INLINE Real flux(const Touching<Real>& c, const Coefficients<Real>& p, const Real& T_i,
                        const Real& T_j) const {
    Real a = Circle::radius(c) * p.narrower;
    if (any(c.softness < Real(1))) a = a * cube_root(c.softness);
    return Real(2) * p.conductivity * a * (T_j - T_i);  // [W]
  }
  std::optional<double> at_wall(std::size_t wall, double time) const {
    return of_wall(wall, WallHeat::Kind::HeldAt, time);
  }
  std::optional<double> given_by_wall(std::size_t wall, double time) const {
    return of_wall(wall, WallHeat::Kind::HeatedBy, time);
  }
  void update(const Seen& p, Fields& f, double received, double dt) const {
    f.temperature += received * dt / capacity(p);
  }
  bool allows(const Fields& f) const { return f.temperature > 0; }
  static constexpr const char* allowed =
      "temperatures must stay above 0 K: more heat is taken out than there is, perhaps by a wall "
      "with heated_by(), by a source of your own or in steps too long for the conduction; lower "
      "it, or hold the wall at a temperature";
  /// [J/K]
  double capacity(const Seen& p) const { return p.mass * material(p.material).heat_capacity; }
  /// Before contacts are known: twelve, with circles of a quarter of the radius, narrowed as in (2)
  /// where `youngs_modulus` is given.
  double rate(const Seen& p, const Coefficients<double>& c) const {
    return 12 * c.conductivity * c.narrower * p.radius / capacity(p);
  }
  double rate(const Seen& p, const Fields&, double H) const { return 2 * H / capacity(p); }

  template <class Sim>
  void check(const Sim& sim) const {
    require(flux_every > 0, "HeatConduction.flux_every = 0 [steps] must be at least 1");
    for (std::size_t k = 0; k <= others.size(); ++k) check_material(k, sim.contacts());
    detail::check_entries("HeatConduction.others", others.size(), 1, sim.contacts());
    require_positive("HeatConduction.start_temperature", start_temperature, "K");
    walls.resolve(sim, "HeatConduction.walls");
    for (std::size_t k = 0; k < sim.rows(); ++k) check_particle(sim, k);
    for (std::size_t w = 0; w < sim.walls(); ++w)
      if (const WallHeat* const heat = walls.of(w)) check_wall(sim, w, *heat);
    for (std::size_t a = 0; a <= others.size(); ++a) narrower(sim.contacts(), a, a);
  }

  /// InputError if this wall cannot have this condition.
  template <class Sim>
  void check_wall(const Sim& sim, std::size_t w, const WallHeat& heat) const {
    if (heat.kind() == WallHeat::Kind::Insulated || knows(sim.wall(w).material)) return;
    throw InputError(text("HeatConduction: ", sim.wall_name(w), " is of ",
                          sim.material_name(sim.wall(w).material),
                          ", which has no conductivity in `others`; add it there (the first entry "
                          "is of material 1), or make the wall insulated()"));
  }

 private:
  std::optional<double> of_wall(std::size_t wall, WallHeat::Kind kind, double time) const {
    const WallHeat* const heat = walls.of(wall);
    return heat == nullptr ? std::nullopt : heat->value(kind, time);
  }
  template <class Sim>
  void check_particle(const Sim& sim, std::size_t k) const {
    if (!sim.is_present(k)) return;
    if (!knows(sim.material(k)))
      throw InputError(text("HeatConduction: particle ", sim.id(k), " is of ",
                            sim.material_name(sim.material(k)),
                            ", which has no conductivity in `others`; add it there (the first "
                            "entry is of material 1)"));
    const double T = sim.template field<Temperature>(k);
    if (!(std::isfinite(T) && T > 0))
      throw InputError(text("HeatConduction: the temperature of particle ", sim.id(k), " is ", T,
                            " K; it must be finite and greater than 0 (sim.field<Temperature>(k) "
                            "sets it)"));
  }
  template <class ContactsType>
  void check_material(std::size_t k, const ContactsType& contacts) const {
    const ThermalMaterial m = material(k);
    const std::string of =
        k == 0 ? "HeatConduction"
               : text("HeatConduction.others[", k - 1, "]", detail::after_entry(contacts, k));
    require_positive(of + ".conductivity", m.conductivity, "W/(m K)");
    require_positive(of + ".heat_capacity", m.heat_capacity, "J/(kg K)");
    require_not_negative(of + ".youngs_modulus", m.youngs_modulus, "Pa");
    require_not_negative(of + ".density", m.density, "kg/m3");
    require(m.poisson_ratio > -1 && m.poisson_ratio <= 0.5, of,
            ".poisson_ratio = ", m.poisson_ratio, " [-] must be in (-1, 0.5]");
  }
  template <class Law>
  static double compliance(const typename Law::Material& m) {
    if constexpr (requires { m.solid; })
      return compliance_of(m.solid);
    else
      return compliance_of(m);
  }
  template <class Material>
  static double compliance_of(const Material& m) {
    if constexpr (requires { m.youngs_modulus + m.poisson_ratio; })
      return (1 - m.poisson_ratio * m.poisson_ratio) / m.youngs_modulus;
    else
      return 0;
  }
  /// (E*/E*_real)^(1/3) if a real modulus is given.
  template <class ContactsType>
  double narrower(const ContactsType& contacts, std::size_t a, std::size_t b) const {
    using Law = typename ContactsType::Law;
    double real = 0, used = 0;  // [1/Pa]
    bool given = false;
    for (const std::size_t k : {a, b}) {
      const ThermalMaterial m = material(k);
      const double as_used = compliance<Law>(contacts.material(k));
      if (m.youngs_modulus > 0)
        require(as_used > 0,
                "HeatConduction.youngs_modulus: this contact law has no Young's modulus to "
                "compare with; leave it out");
      given |= m.youngs_modulus > 0;
      used += as_used;
      real += m.youngs_modulus > 0 ? (1 - m.poisson_ratio * m.poisson_ratio) / m.youngs_modulus
                                   : as_used;
    }
    constexpr double softest = 20;  // [-]
    require(
        !given || real < softest * used,
        "HeatConduction.youngs_modulus = ", material(a).youngs_modulus, " and ",
        material(b).youngs_modulus, " [Pa] of materials ", a, " and ", b,
        ": the real solid would be ", real / used,
        " times softer than the contacts; give its modulus in Pa, such as 70e9, or leave it out");
    return given ? std::cbrt(real / used) : 1;
  }
};

/// With Hertz' circle.
using HeatConduction = HeatConductionBy<>;

}  // namespace silt
