// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <concepts>
#include <functional>
#include <numbers>
#include <tuple>
#include <type_traits>
#include <utility>

#include <silt/coupling/heat_exchange.hpp>
#include <silt/module/heat/conduction.hpp>

namespace silt::inline SILT_TARGET {

/// HeatConduction with the heat of friction and damping.
///
///   silt::Simulation sim{..., silt::FrictionHeat{silt::HeatConduction{...}},
///   silt::EnergyLedger{}};
///
/// The energy dissipated in contacts, as counted by the ledger, heats both ends. It is divided in
/// proportion to the effusivities sqrt(k rho c), with equal densities if one of the two is not
/// given. The part into a wall is lost. The elastic energy of tangential springs counts as heat
/// while it is stored, and is taken back. FrictionHeat may be placed around or inside Heat and
/// MutualRadiation: the order does not matter.
/// Tests:  tests/physics/heat.cpp (heat gained is energy lost, 1e-9), heat_modules.cpp (around Heat).
///
/// Source: none: the ledger's dissipation.
/// Valid:  with an EnergyLedger.
/// Units:  SI.
/// Errors: does not compile without an EnergyLedger.
template <class Base = HeatConduction>
struct FrictionHeat : Base {
  explicit FrictionHeat(Base base = {}) : Base(std::move(base)) {}
  template <class P>
  double share_of_loss(const P& p) const {
    return p.share;
  }
};

/// Nusselt number of a single sphere in a flow: Nu = 2 + 0.6 Re^(1/2) Pr^(1/3).
/// Source: W.E. Ranz, W.R. Marshall, Chem. Eng. Prog. 48 (1952) 141, 173, not read; the formula as
///         in a heat transfer model derived from OpenFOAM's (read).
/// Valid:  a single sphere, Re < 200 (drops); used up to some 1e4.
/// Units:  [-].
/// Errors: none.
/// Tests:  tests/physics/heat_modules.cpp, tests/coupling/heat.cpp.
struct RanzMarshall {
  static double nusselt(double Re, double Pr, double /*voidage*/) {
    return 2 + 0.6 * std::sqrt(Re) * std::cbrt(Pr);
  }
};

/// Nusselt number of spheres in a bed of void fraction e:
///   Nu = (7 - 10 e + 5 e^2)(1 + 0.7 Re^0.2 Pr^(1/3)) + (1.33 - 2.4 e + 1.2 e^2) Re^0.7 Pr^(1/3)
/// with Re of the superficial velocity, e |u - v|.
/// Source: D.J. Gunn, Int. J. Heat Mass Transfer 21 (1978) 467, not read; the formula as in
///         OpenFOAM's Gunn.C and a tutorial of MFIX (usr1.f) (both read), with Re as in MFIX.
///         OpenFOAM uses Re of u - v.
/// Valid:  0.35 < e <= 1, Re < 1e5.
/// Units:  [-].
/// Errors: none.
/// Tests:  tests/physics/heat_modules.cpp, tests/coupling/heat.cpp.
struct Gunn {
  static double nusselt(double Re, double Pr, double e) {
    const double third = std::cbrt(Pr);
    return (7 - 10 * e + 5 * e * e) * (1 + 0.7 * std::pow(Re, 0.2) * third) +
           (1.33 - 2.4 * e + 1.2 * e * e) * std::pow(Re, 0.7) * third;
  }
};

/// Part of Heat: one-way heat exchange with a gas of given temperature and velocity, which the
/// particles do not change.
///
///   h = Nu k_gas/d,  Q = h pi d^2 (T_gas - T)
///
/// A step uses the exact exponential for constant gas properties; small particles need no shorter
/// step. The surface of bodies is that of their bounding sphere.
/// Tests: tests/physics/heat_modules.cpp (a grain in hot gas, Nu = 2 at rest).
/// Source: as its Nusselt number.
/// Valid:  as its Nusselt number; for a gas that the particles do not change.
/// Units:  SI.
/// Errors: InputError naming field, value, unit and allowed range.
template <class Nusselt = RanzMarshall>
struct Convection {
  double temperature = 293.15;  // [K]
  Vec3d velocity{0, 0, 0};      // [m/s]
  double conductivity = 0.026;  // [W/(m K)]
  double viscosity = 1.8e-5;    // [Pa s]
  double density = 1.2;         // [kg/m3]
  double heat_capacity = 1005;  // [J/(kg K)]
  double voidage = 1;           // [-] in (0, 1]
  // Replace `temperature` and `velocity` if given: functions of position and time.
  std::function<double(const Vec3d&, double)> temperature_at{};
  std::function<Vec3d(const Vec3d&, double)> velocity_at{};

  /// [W/K]
  double conductance(const Seen& p) const {
    const Vec3d u = velocity_at ? velocity_at(p.position, p.time) : velocity;
    const double d = 2 * p.radius;
    const double Re = voidage * density * norm(u - p.velocity) * d / viscosity;
    const double Pr = viscosity * heat_capacity / conductivity;
    return Nusselt::nusselt(Re, Pr, voidage) * conductivity * std::numbers::pi * d;
  }
  /// [W] mean over a step of `dt` [s].
  double watts(const Seen& p, double T, double capacity, double dt) const {
    const double T_gas = temperature_at ? temperature_at(p.position, p.time) : temperature;
    return -std::expm1(-conductance(p) * dt / capacity) * (T_gas - T) * capacity / dt;
  }
  double slope(const Seen&, double) const { return 0; }  // exact for any step
  void check() const {
    require_not_negative("Convection.temperature", temperature, "K");
    require_positive("Convection.conductivity", conductivity, "W/(m K)");
    require_positive("Convection.viscosity", viscosity, "Pa s");
    require_positive("Convection.density", density, "kg/m3");
    require_positive("Convection.heat_capacity", heat_capacity, "J/(kg K)");
    require(voidage > 0 && voidage <= 1, "Convection.voidage = ", voidage,
            " [-] must be in (0, 1]");
  }
};

/// Part of Heat: radiation of grey particles to large surroundings of one temperature,
///   Q = sigma emissivity 4 pi R^2 (T_surroundings^4 - T^4).
/// Radiation between particles is not included; in a bed use an effective temperature of the
/// surroundings.
/// Tests: tests/physics/heat_modules.cpp (cooling to 0 K: 1/T^3 grows linearly).
/// Source: Stefan and Boltzmann's law.
/// Valid:  grey particles without mutual radiation, small compared with their surroundings.
/// Units:  SI.
/// Errors: InputError naming field, value, unit and allowed range.
struct Radiation {
  double emissivity = 0.9;                         // [-] in [0, 1]
  double temperature = 293.15;                     // [K] of the surroundings
  static constexpr double sigma = 5.670374419e-8;  // [W/(m2 K4)]

  double watts(const Seen& p, double T, double, double) const {
    return factor(p) * (std::pow(temperature, 4) - std::pow(T, 4));
  }
  double slope(const Seen& p, double T) const { return 4 * factor(p) * T * T * T; }  // [W/K]
  void check() const {
    require_in("Radiation.emissivity", emissivity, "-", 0, 1);
    require_not_negative("Radiation.temperature", temperature, "K");
  }

 private:
  double factor(const Seen& p) const {
    return sigma * emissivity * 4 * std::numbers::pi * p.radius * p.radius;
  }
};

/// Exchanges heat with a fluid: a part of Heat, or a module that also has capacity(seen) [J/K] and
/// whose `exchanged` field is the temperature.
template <class P>
concept HeatedByFluid = requires(const P& part, const Seen& p, const HeatedFluid& f) {
  { part.conductance(p, f) } -> std::convertible_to<double>;
};

/// Module: conduction (HeatConduction, FrictionHeat or MutualRadiation) and heat exchange with the
/// surroundings.
///
///   silt::Heat{silt::HeatConduction{.conductivity = 1.1, .heat_capacity = 840},
///              silt::Convection<silt::Gunn>{.temperature = 500, .voidage = 0.4},
///              silt::Radiation{}}
///
/// With the fluid of a CoupledFlow: FluidConvection (fluid_convection.hpp).
/// A user-defined part is a struct with watts(seen, T, capacity, dt) [W], slope(seen, T) [W/K]
/// (minus the derivative of watts by T, for the bound on the step), and check(). With
/// conductance(seen, HeatedFluid) [W/K] it exchanges heat with the fluid (ParticleHeat).
/// Source: as its parts.
/// Valid:  as its parts.
/// Units:  SI.
/// Errors: InputError of its parts.
/// Tests:  tests/physics/heat_modules.cpp, tests/coupling/heat_simulation.cpp.
template <class Base, class... Parts>
struct Heat : Base {
  std::tuple<Parts...> parts;

  explicit Heat(Base base, Parts... all) : Base(std::move(base)), parts(std::move(all)...) {}
  void update(const Seen& p, HeatFields& f, double received, double dt) const {
    const double C = this->capacity(p);
    std::apply(
        [&](const auto&... part) { received += (0.0 + ... + part.watts(p, f.temperature, C, dt)); },
        parts);
    Base::update(p, f, received, dt);
  }
  double rate(const Seen& p, const typename Base::template Coefficients<double>& c) const {
    return Base::rate(p, c) + slope(p, this->start_temperature) / this->capacity(p);
  }
  double rate(const Seen& p, const HeatFields& f, double H) const {
    return Base::rate(p, f, H) + slope(p, f.temperature) / this->capacity(p);
  }
  /// [W/K] with the fluid.
  double conductance(const Seen& p, const HeatedFluid& f) const
      requires(HeatedByFluid<Base> || ... || HeatedByFluid<Parts>) {
    double sum = 0;
    if constexpr (HeatedByFluid<Base>) sum += Base::conductance(p, f);
    const auto add = [&](const auto& part) {
      if constexpr (HeatedByFluid<std::decay_t<decltype(part)>>) sum += part.conductance(p, f);
    };
    std::apply([&](const auto&... part) { (add(part), ...); }, parts);
    return sum;
  }
  template <class Sim>
  void check(const Sim& sim) const {
    Base::check(sim);
    std::apply([](const auto&... part) { (part.check(), ...); }, parts);
  }

 private:
  double slope(const Seen& p, double T) const {
    return std::apply([&](const auto&... part) { return (0.0 + ... + part.slope(p, T)); }, parts);
  }
};

}  // namespace silt
