// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET {

/// Policy of a Simulation that keeps books of its energy (EnergyBalance,
/// simulation/energy_ledger.hpp), and of an Sph (LiquidBalance, sph/ledger.hpp), read by
/// `energy()`; without it they cost nothing.
///
///   silt::Simulation sim{beads, silt::Contacts<silt::HertzMindlin>{glass}, silt::EnergyLedger{}};
///   sim.run(1.0);
///   const silt::EnergyBalance e = sim.energy();
///
/// Every law of silt can be asked what it stores (silt/contact/concept.hpp: stored()); one of your
/// own must say so too.
/// Tests: tests/study/energy_ledger.cpp, tests/sph/ledger.cpp.
/// Source: none: a sum of works and of what laws say that they store.
/// Valid:  laws, bonds and modules that say what they store.
/// Units:  [J].
/// Errors: does not compile with a law that does not say what it stores.
struct EnergyLedger {
  static constexpr bool is_ledger = true;
};

}  // namespace silt
