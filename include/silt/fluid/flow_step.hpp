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

/// Results of a step.
struct FlowStep {
  double courant = 0;  // [-] largest sum over directions of |u| dt / h of any cell
  int iterations = 0;  // of the pressure solver
  double removed = 0;  // [-] of the continuity equation's right-hand side: part that no flow can
                       // balance
  /// [-] root mean square of the continuity error of this step due to the pressure tolerance, as a
  /// share of a cell's volume.
  double unbalanced = 0;
};

/// Response of particles within a coming step, in cells, for light or stiffly coupled particles;
/// see FlowSolver. At the end of the step a particle of volume V has the velocity
///
///   v' = v0 + a u' - b (grad p' - div tau')                                                   (1)
///
/// and bears only the part V - q of pressure and viscous stress; q is left to the fluid.
struct ParticleResponse {
  explicit ParticleResponse(const Grid& g)
      : borne(g), with_fluid(g), with_pressure(g), flux{CellField(g), CellField(g), CellField(g)} {}

  bool bears = false;       // whether the step uses it
  CellField borne;          // [-] sum w q per volume of the cell (model A)
  bool moves = false;       // whether continuity includes (1): then, as sums per volume of the
                            // cell,
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
