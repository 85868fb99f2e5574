// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <string>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/fluid/properties.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Sentences for properties that no fluid has, mostly a wrong unit. Limits (recalled): kinematic
/// viscosities are above 2e-8 m2/s (liquid helium; water 1e-6, mercury 1e-7), gases have less than
/// 2e-4 Pa s and liquids more than 20 kg/m3, hydrogen at 0.1 bar and 20 C has 0.008 kg/m3
/// (computed, ideal gas), heat capacities are above 50 J/(kg K) (mercury 140).
[[gnu::cold]] inline DynArray<std::string> odd_fluid(const FluidProperties& of) {
  DynArray<std::string> out;
  if (of.viscosity > 0 && of.viscosity < 2e-8 * of.density)
    out.push_back(text("FluidProperties.viscosity = ", of.viscosity, " Pa s with density = ",
                       of.density, " kg/m3 is a kinematic viscosity of ", of.viscosity / of.density,
                       " m2/s, which no fluid has; give the dynamic viscosity, that of water is "
                       "1e-3 Pa s"));
  if (of.density < 20 && of.viscosity > 2e-4)
    out.push_back(text("FluidProperties.density = ", of.density,
                       " kg/m3 with viscosity = ", of.viscosity,
                       " Pa s is neither a gas nor a liquid; give the density in "
                       "kg/m3 (water 998) and the viscosity in Pa s (air 1.8e-5)"));
  else if (of.density < 5e-3)
    out.push_back(text("FluidProperties.density = ", of.density,
                       " kg/m3 is less than that of hydrogen at a tenth of a bar; air has 1.2: a "
                       "density in g/cm3 is a thousandth of that in kg/m3"));
  return out;
}
/// The same of a gas that moves at `fastest` [m/s], near the speed of sound in air and beyond, and
/// of cells that are `wide` [m] for particles of at most `diameter` [m].
[[gnu::cold]] inline void odd_flow(const FluidProperties& of, double fastest, double wide,
                                   double diameter, DynArray<std::string>& out) {
  constexpr double sound = 340, most = 300;  // [m/s] in air at 20 C (recalled); [-] cells
  if (of.density < 20 && fastest > sound)
    out.push_back(sentence("the gas moves at more than ", sound,
                           " m/s, beyond the speed of sound in air; the flow is computed as one "
                           "that cannot be compressed: check the velocities of the sides, in m/s"));
  if (diameter > 0 && wide > most * diameter)
    out.push_back(sentence("the cells of the flow are ", wide, " m wide, ", wide / diameter,
                           " times the diameter of the largest particle: check the Grid, in m"));
}
template <class Heat>
[[gnu::cold]] void odd_heat(const Heat& of, DynArray<std::string>& out) {
  if (of.heat_capacity < 50)
    out.push_back(text("FluidHeat.heat_capacity = ", of.heat_capacity,
                       " J/(kg K) is less than any fluid has; air has 1005"));
  if (of.start_temperature < 100)
    out.push_back(text("FluidHeat.start_temperature = ", of.start_temperature,
                       " K may be degrees Celsius; give temperatures in K: ", of.start_temperature,
                       " C is ", of.start_temperature + 273.15, " K"));
}

}  // namespace silt::detail
