// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET {

/// Policy for an energy balance of a Simulation (EnergyBalance, simulation/energy_ledger.hpp), or
/// of an Sph (LiquidBalance, sph/ledger.hpp), read by `energy()`. No cost without it.
///
///   silt::Simulation sim{beads, silt::Contacts<silt::HertzMindlin>{glass}, silt::EnergyLedger{}};
///   sim.run(1.0);
///   const silt::EnergyBalance e = sim.energy();
///
/// All laws of silt provide their stored energy (silt/contact/concept.hpp: stored()); a
/// user-defined law must do so too.
/// Tests:  tests/study/energy_ledger.cpp, tests/sph/ledger.cpp.
/// Source: none: a sum of works and stored energies.
/// Valid:  laws, bonds and modules that provide their stored energy.
/// Units:  [J].
/// Errors: does not compile with a law that does not provide its stored energy.
struct EnergyLedger {
  static constexpr bool is_ledger = true;
};

}  // namespace silt
