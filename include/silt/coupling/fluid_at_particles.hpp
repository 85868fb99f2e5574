// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <silt/core/vec3.hpp>
#include <silt/fluid/properties.hpp>

namespace silt::inline SILT_TARGET {

/// Numbers of particles, one each; of vectors by direction.
using ParticleColumn = std::vector<double>;
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

/// What a ParticleExchange must know of the fluid as a whole.
struct ExchangeSettings {
  FluidProperties fluid;
  MomentumModel model = MomentumModel::A;
  Vec3d gravity{0, 0, 0};      // [m/s2]
  double least_voidage = 0.3;  // [-] below which drag is that of this voidage
};

/// The fluid at the particles' places.
struct FluidAtParticles {
  ParticleColumn voidage;           // [-] 0: there is no fluid
  ParticleColumns velocity;         // [m/s]
  ParticleColumns slope, stress;    // [Pa/m] grad p, [N/m3] div tau: of model A
  ParticleColumns curl;             // [1/s] of the velocity; where a force needs it
  ParticleColumns stretch, strain;  // [1/s] xx, yy, zz and yz, zx, xy; likewise
  ParticleColumns convection;       // [m/s2] u grad u; with an added mass
};

/// What particles give the fluid in its step, to be spread over its cells: see StepResponse.
struct GivenToFluid {
  ParticleColumn coefficient;                // [kg/s] c
  ParticleColumns offset;                    // [N] o
  ParticleColumn borne;                      // [m3] q, with ParticleExchange::bears()
  ParticleColumn with_fluid, with_pressure;  // V a, V b, with ParticleExchange::moves()
  ParticleColumns flux;                      // V (v0 + b div tau), likewise
};

/// What ParticleExchange::take() has found.
struct Exchanged {
  Vec3d on_particles{0, 0, 0};  // [N] forces that the fluid has back, summed
  double magnitudes = 0;        // [N] of these forces, summed
  Vec3d owed{0, 0, 0};          // [N s] that particles had taken beyond what the fluid gave
};

/// What a particle feels until the next fluid step, where drag follows its velocity.
struct FollowStart {
  Vec3d velocity{0, 0, 0};  // [m/s] of the fluid
  Vec3d drag{0, 0, 0};      // [N] that the fluid has given
  Vec3d push{0, 0, 0};  // [N] all else, but for pressure and stress if those are read from cells
  double voidage = 0;   // [-] 0: no fluid
};

}  // namespace silt
