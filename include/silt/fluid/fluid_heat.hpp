// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/vec3.hpp>
#include <silt/fluid/grid.hpp>

namespace silt::inline SILT_TARGET {

/// Temperature of a FlowSolver's fluid, added by set_heat().
///
///   rho c (d(m T)/dt + div(F T)) = div(m k grad T) + Q                                         (1)
///   Q = s + sum of b (T_p - T)                                                                 (2)
///
/// with the fluid's share of space m and its fluxes F as in the momentum equations: a uniform
/// temperature remains uniform to rounding for any void fraction, and heat is conserved to
/// rounding. s are sources; the sum is that of particles (CoupledFlow). In turbulent flow k is k +
/// c mu_t/turbulent_prandtl. Dissipation, pressure work and density changes are neglected.
///
/// Buoyancy (Boussinesq): with `expansion` and `gravity` the force -m rho expansion (T -
/// reference_temperature) gravity acts on the fluid; its density is constant.
///
/// Numerics: upwind with minmod slopes: each cell stays within the range of its neighbours. Then
///           conduction, explicit, with the harmonic mean of m on faces; then walls and particles,
///           implicit: steady states do not depend on the step, and stiff exchange is stable.
///           Second order in space for smooth fields; first order in time with conduction or
///           exchange. A step is divided into equal parts until outflow and conduction are below
///           the content of a cell. More than most_parts are refused; otherwise heat does not limit
///           the step.
/// Units:  SI.
/// Valid:  temperature differences with nearly constant density and viscosity.
/// Tests:  tests/fluid/heat.cpp.
struct FluidHeat {
  static constexpr int most_parts = 200;  // [-] of a step

  double heat_capacity = 0;                                        // [J/(kg K)] must be given
  double conductivity = std::numeric_limits<double>::quiet_NaN();  // [W/(m K)] must be given
  double start_temperature = 293.15;      // [K] initial; also of inflows without a temperature
  double turbulent_prandtl = 0.85;        // [-]
  double expansion = 0;                   // [1/K] of the volume; 0: no buoyancy
  double reference_temperature = 293.15;  // [K] where buoyancy is 0
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

/// Thermal condition of a side of a flow's box. Default: a wall is insulated, an inflow has
/// FluidHeat::start_temperature, and backflow at an outflow has the temperature of the adjacent
/// cells. Functions are called once per step, with the time of its end.
struct SideHeat {
  using OfPlaceAndTime = std::function<double(const Vec3d& place, double time)>;

  std::optional<double> temperature{};  // [K] of a wall, or of inflow
  std::optional<double> flux{};         // [W/m2] into the fluid, through a wall
  OfPlaceAndTime temperature_at{};      // [K] of m, s: in place of `temperature`
  OfPlaceAndTime flux_at{};             // [W/m2] of m, s: in place of `flux`

  bool has_temperature() const { return temperature || temperature_at; }
  bool has_flux() const { return flux || flux_at; }
};

/// Heat balance of a flow since its first step with heat [J]: the stored heat increases by the sum
/// of the others, to rounding.
struct FluidHeatBook {
  double stored = 0;         // above 0 K
  double through_sides = 0;  // with inflow and outflow, and through walls
  double from_particles = 0;
  double from_sources = 0;
  /// Heat changed between steps: temperature() was set, or the flow has recounted the fluid in its
  /// cells, as after a start with a jump, or where the void fraction jumps.
  double counted_anew = 0;

  double received() const { return through_sides + from_particles + from_sources + counted_anew; }
};

namespace fluid_detail {

/// Heat of a flow, in cells.
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
  CellField temperature;      // [K]
  CellField source;           // [W/m3] s
  CellField exchange, given;  // [W/(m3 K)], [W/m3] sums of b, b T_p
  CellField link, pull;       // the same for walls at sides
  CellField seen;             // [K] seen by particles in the last step
  DynArray<CellField> push;   // [N/m3] force() with buoyancy; empty without
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
