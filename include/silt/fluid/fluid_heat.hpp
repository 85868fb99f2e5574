// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include <silt/core/error.hpp>
#include <silt/core/vec3.hpp>
#include <silt/fluid/grid.hpp>

namespace silt::inline SILT_TARGET {

/// The temperature of a FlowSolver's fluid; set_heat() gives the flow one.
///
///   rho c (d(m T)/dt + div(F T)) = div(m k grad T) + Q                                         (1)
///   Q = s + sum of b (T_p - T)                                                                 (2)
///
/// with the fluid's share of space m and its fluxes F as in the momentum equations, so that a
/// uniform temperature stays one to rounding, whatever the voidage does, and heat is kept to
/// rounding. s are sources, the sum is that of particles (CoupledFlow). In turbulent flow k is
/// k + c mu_t/turbulent_prandtl. Dissipation, work of pressure and changes of density are left out.
///
/// Buoyancy (Boussinesq): with `expansion` and `gravity` the fluid is pushed by
/// -m rho expansion (T - reference_temperature) gravity; its density stays what it is.
///
/// Numerics: upwind with minmod slopes: no cell leaves the range of its neighbours; then
/// conduction,
///   explicit, with the harmonic mean of m on faces; then walls and particles, implicit: steady
///   states do not depend on the step, and no exchange is too stiff. Second order in space on
///   smooth fields, in time first where something conducts or exchanges. A step is made in as many
///   equal parts as keep out-flow and conduction below what a cell holds: more than most_parts are
///   refused, else heat limits no step.
/// Units:  SI.
/// Valid:  differences of temperature that leave density and viscosity nearly constant.
/// Tests:  tests/fluid/heat.cpp.
struct FluidHeat {
  static constexpr int most_parts = 200;  // [-] of a step

  double heat_capacity = 0;                                        // [J/(kg K)] must be given
  double conductivity = std::numeric_limits<double>::quiet_NaN();  // [W/(m K)] must be given
  double start_temperature = 293.15;      // [K] at first; of inflows that are not given another
  double turbulent_prandtl = 0.85;        // [-]
  double expansion = 0;                   // [1/K] of the volume; 0: no buoyancy
  double reference_temperature = 293.15;  // [K] at which there is no buoyancy
  Vec3d gravity{0, 0, 0};                 // [m/s2] for buoyancy alone

  void check() const {
    require(std::isfinite(heat_capacity) && heat_capacity > 0,
            "FluidHeat.heat_capacity = ", heat_capacity,
            " J/(kg K) must be given and positive: air has 1005, water 4182");
    require(!std::isnan(conductivity),
            "FluidHeat.conductivity [W/(m K)] must be given: air has 0.026, water 0.6");
    require_not_negative("FluidHeat.conductivity", conductivity, "W/(m K)");
    require_not_negative("FluidHeat.start_temperature", start_temperature, "K");
    require_positive("FluidHeat.turbulent_prandtl", turbulent_prandtl, "-");
    require(std::isfinite(expansion), "FluidHeat.expansion = ", expansion, " 1/K must be finite");
    require(expansion == 0 || (is_finite(gravity) && norm(gravity) > 0),
            "FluidHeat.expansion is given, but FluidHeat.gravity = ", gravity,
            " m/s2 gives no buoyancy; give the gravity too");
    require(expansion == 0 || std::isfinite(reference_temperature),
            "FluidHeat.reference_temperature = ", reference_temperature, " K must be finite");
  }
};

/// What a side of a flow's box is for heat. All left out: a wall is insulated, an inflow has
/// FluidHeat::start_temperature, what flows back in at an outflow that of the cells beside it.
/// Functions are asked once a step, for its end.
struct SideHeat {
  using OfPlaceAndTime = std::function<double(const Vec3d& place, double time)>;

  std::optional<double> temperature{};  // [K] of a wall, or of what flows in
  std::optional<double> flux{};         // [W/m2] into the fluid, through a wall
  OfPlaceAndTime temperature_at{};      // [K] of m, s: in place of `temperature`
  OfPlaceAndTime flux_at{};             // [W/m2] of m, s: in place of `flux`

  bool has_temperature() const { return temperature || temperature_at; }
  bool has_flux() const { return flux || flux_at; }
};

/// Where a flow's heat is, and what it got since its first step with heat [J]: what is stored grows
/// by the sum of the others, to rounding.
struct FluidHeatBook {
  double stored = 0;         // above 0 K
  double through_sides = 0;  // with what flows in and out, and through walls
  double from_particles = 0;
  double from_sources = 0;
  /// By which the heat changed between steps: temperature() was set, or the flow has counted anew
  /// how much fluid is in its cells, as after a start with a jump, or where the voidage jumps.
  double counted_anew = 0;

  double received() const { return through_sides + from_particles + from_sources + counted_anew; }
};

namespace fluid_detail {

/// The heat of a flow, in cells.
struct FlowHeat {
  FlowHeat(const Grid& grid, const FluidHeat& given_heat)
      : of(given_heat),
        temperature(grid, given_heat.start_temperature),
        source(grid),
        exchange(grid),
        given(grid),
        link(grid),
        pull(grid),
        seen(grid, given_heat.start_temperature) {
    book.stored = -1;
    if (of.expansion != 0) push.assign(3, CellField(grid));
  }

  FluidHeat of;
  CellField temperature;        // [K]
  CellField source;             // [W/m3] s
  CellField exchange, given;    // [W/(m3 K)], [W/m3] sums of b, b T_p
  CellField link, pull;         // the same of walls at sides
  CellField seen;               // [K] what particles saw in the last step
  std::vector<CellField> push;  // [N/m3] force() with buoyancy; empty without
  std::array<std::array<SideHeat, 2>, 3> sides;
  FluidHeatBook book;  // stored: at the end of the last step; -1: none
  double gained = 0;   // [J] from particles, in the last step

  SideHeat& side(int d, int end) {
    return sides[static_cast<std::size_t>(d)][static_cast<std::size_t>(end)];
  }
  const SideHeat& side(int d, int end) const {
    return sides[static_cast<std::size_t>(d)][static_cast<std::size_t>(end)];
  }
};

}  // namespace fluid_detail

}  // namespace silt
