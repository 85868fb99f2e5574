// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>

#include <silt/fluid/grid.hpp>
#include <silt/fluid/properties.hpp>

namespace silt::inline SILT_TARGET {

/// Options of a FlowSolver.
struct FlowOptions {
  MomentumModel model = MomentumModel::A;
  double tolerance = 1e-6;    // [-] of the pressure's residual
  int most_iterations = 200;  // [-] of the pressure solver
};

/// What a step did.
struct FlowStep {
  double courant = 0;  // [-] the largest sum over directions of |u| dt / h of any cell
  int iterations = 0;  // of the pressure solver
  double removed = 0;  // [-] of the continuity equation's right side: what no flow could balance
  /// [-] of a cell's volume, root of the mean square: what the pressure's tolerance has left of
  /// this step's continuity equation.
  double unbalanced = 0;
};

/// How the particles of a coming step answer to it, in cells, for a flow whose particles are light
/// or stiffly coupled; see FlowSolver. At the step's end a particle of volume V has the velocity
///
///   v' = v0 + a u' - b (grad p' - div tau')                                                   (1)
///
/// and bears of pressure and viscous stress the part V - q alone; q is left to the fluid.
struct ParticleResponse {
  explicit ParticleResponse(const Grid& g)
      : borne(g), with_fluid(g), with_pressure(g), flux{CellField(g), CellField(g), CellField(g)} {}

  bool bears = false;       // whether the step knows
  CellField borne;          // [-] sum w q over the cell's volume (model A)
  bool moves = false;       // whether continuity knows (1): then, as sums over the cell's volume,
  CellField with_fluid;     // [-] w V a
  CellField with_pressure;  // [m3 s/kg] w V b
  std::array<CellField, 3> flux;  // [m/s] w V (v0 + b div tau)

  template <class Visit>
  void for_each(const Visit& visit) {
    if (bears) visit(borne);
    if (moves)
      for (CellField* f : {&with_fluid, &with_pressure, &flux[0], &flux[1], &flux[2]}) visit(*f);
  }
};

}  // namespace silt
