// silt - BSD-3-Clause, see LICENSE
// refused: use an equivalence with the unit of the strength
#include <silt/breakage/equivalence.hpp>
#include <silt/breakage/selection.hpp>
#include <silt/breakage/strength.hpp>

inline double run() {
  const silt::VogelPeukertStrength energies{.f_mat = 0.944, .least = 0.0933};
#if defined(SILT_MENDED)
  return silt::selection(energies, silt::EnergyEquivalence{}, silt::Impact{});
#else
  return silt::selection(energies, silt::HertzEquivalence{}, silt::Impact{});
#endif
}
