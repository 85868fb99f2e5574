// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cstddef>

#include <silt/core/dyn_array.hpp>
#include <silt/core/vec3.hpp>
#include <silt/fluid/properties.hpp>

namespace silt::inline SILT_TARGET {

/// One number per particle; vectors: one column per direction.
using ParticleColumn = DynArray<double>;
/// Vectors of particles, a column for each direction.
using ParticleColumns = std::array<ParticleColumn, 3>;
/// The vector of particle p.
inline Vec3d vector_of(const ParticleColumns& of, std::size_t p) {
  return {of[0][p], of[1][p], of[2][p]};
}
/// Makes all three columns n long.
inline void resize(ParticleColumns& columns, std::size_t n) {
  for (ParticleColumn& c : columns) c.resize(n);
}

/// Settings of a ParticleExchange for the whole fluid.
struct ExchangeSettings {
  FluidProperties fluid;
  MomentumModel model = MomentumModel::A;
  Vec3d gravity{0, 0, 0};      // [m/s2]
  double least_voidage = 0.3;  // [-] lower limit of the void fraction in drag laws
};

/// The fluid at the positions of the particles.
struct FluidAtParticles {
  ParticleColumn voidage;           // [-] 0: no fluid
  ParticleColumns velocity;         // [m/s]
  ParticleColumns slope, stress;    // [Pa/m] grad p, [N/m3] div tau: of model A
  ParticleColumns curl;             // [1/s] of the velocity; if a force needs it
  ParticleColumns stretch, strain;  // [1/s] xx, yy, zz and yz, zx, xy; likewise
  ParticleColumns convection;       // [m/s2] u grad u; with an added mass
  ParticleColumn mean_diameter;     // [m] Sauter mean of the particles around; likewise
};

/// Contributions of particles to the fluid in its step, to be distributed over its cells: see
/// StepResponse.
struct GivenToFluid {
  ParticleColumn coefficient;                // [kg/s] c
  ParticleColumns offset;                    // [N] o
  ParticleColumn borne;                      // [m3] q, with ParticleExchange::bears()
  ParticleColumn with_fluid, with_pressure;  // V a, V b, with ParticleExchange::moves()
  ParticleColumns flux;                      // V (v0 + b div tau), likewise
};

/// Results of ParticleExchange::take().
struct Exchanged {
  Vec3d on_particles{0, 0, 0};  // [N] forces with a reaction on the fluid, summed
  double magnitudes = 0;        // [N] of these forces, summed
  Vec3d owed{0, 0, 0};          // [N s] momentum that particles took beyond what the fluid gave
};

/// Data of a particle until the next fluid step, if drag follows its velocity.
struct FollowStart {
  Vec3d velocity{0, 0, 0};  // [m/s] of the fluid
  Vec3d drag{0, 0, 0};      // [N] given by the fluid
  Vec3d push{0, 0, 0};  // [N] all other forces, without pressure and stress if these are read from
                        // cells
  double voidage = 0;   // [-] 0: no fluid
};

}  // namespace silt
