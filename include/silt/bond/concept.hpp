// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>

#include <silt/bond/strain.hpp>
#include <silt/core/position_row.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET {

/// The two spheres that a bond is made between.
struct BondedPair {
  double radius_i, radius_j;  // [m]
  double length;              // [m] of their centres apart
  double m_eff;               // [kg] 1/(1/mi + 1/mj); a fixed one is infinite
  double inertia_eff;         // [kg m2] the same of moments of inertia
  double share;  // [-] in (0, 1), random and the same in every run: for scattered strengths
};

/// What a model of bonds says of one bond, or one a lane: on i.
template <class Real>
struct BondAnswer {
  Vec3<Real> force, couple;            // [N], [N m] of springs: derivatives of an energy
  Vec3<Real> rate_force, rate_couple;  // [N], [N m] of dashpots
};

/// A model of bonds, ParallelBond for instance:
///
///   template <class Real> struct Numbers { ... };                        Reals that a bond keeps
///   Numbers<double> numbers(const BondedPair&) const;                    when it is made
///   template <class Real>
///   BondAnswer<Real> answer(const BondStrain<Real>&, const Numbers<Real>&) const;
///   template <class Real>                                                [-] it breaks above 1
///   Real load(const BondAnswer<Real>&, const Vec3<Real>& normal, const Numbers<Real>&) const;
///   double energy(const BondStrain<double>&, const Numbers<double>&) const;  [J] in the springs
///   BondStiffness stiffest(const Numbers<double>&) const;
///
/// Numbers are kept in single precision; all are 0 in lanes without a bond. If the model has a
/// function holds() like load(), which says by less work which lanes hold for sure, load() is asked
/// where it does not.
template <class M>
concept BondModel = requires(const M& model, const BondedPair& pair, const BondStrain<double>& s,
                             const Vec3d& n, const typename M::template Numbers<double>& p) {
  { model.numbers(pair) } -> std::same_as<typename M::template Numbers<double>>;
  { model.answer(s, p) } -> std::same_as<BondAnswer<double>>;
  { model.load(model.answer(s, p), n, p) } -> std::convertible_to<double>;
  { model.energy(s, p) } -> std::convertible_to<double>;
  model.stiffest(p);
};

/// The largest of a bond's stiffnesses and dashpots, for the time step.
struct BondStiffness {
  double shift;              // [N/m]
  double turn;               // [N m]
  double shift_damping = 0;  // [N s/m]
  double turn_damping = 0;   // [N m s]
};

/// The policy: bonds between spheres, and of spheres to walls, by a model.
///
///   silt::Simulation sim{std::move(grains), contacts, silt::Bonds{silt::ParallelBond{...}}};
///   silt::bond_near(sim, 0.01 * radius);
///
/// `seed` decides which bonds are the strong ones where strengths are scattered.
///
/// Source: as its model.
/// Valid:  spheres, not in a DeformingBox, with an integrator of kicks and drifts.
/// Units:  SI.
/// Errors: InputError of its model; with other shapes and policies it does not compile.
/// Tests:  tests/bond/build.cpp, tests/bond/checkpoint.cpp.
template <BondModel M>
struct Bonds {
  static constexpr bool is_bonds = true;
  using Model = M;
  M model;
  std::uint64_t seed = 1;
};
template <class M>
Bonds(M) -> Bonds<M>;
template <class M, class Seed>
Bonds(M, Seed) -> Bonds<M>;

/// What becomes of the contact of a particle with the wall that it is bonded to.
enum class WallContact {
  Acts,     // beside the bond
  Excluded  // as between bonded particles, with all of the wall, as long as the bond holds
};

/// A bond as it is now, or as it was when it broke. Of a bond to a wall, `b` is no_particle and
/// `wall` its number; else `wall` is the largest number there is.
struct BondSeen {
  ParticleId a = no_particle, b = no_particle;
  std::size_t wall = static_cast<std::size_t>(-1);
  std::uint64_t number = 0;  // [-] bonds that were made before it
  Vec3d from, to;            // [m] centre of b, or the place on the wall; centre of a
  Vec3d normal;              // [-] unit, from b to a
  Vec3d force, couple;       // [N], [N m] of its springs on a; on b the opposite
  double load = 0;           // [-] of its strength: it breaks above 1
  double energy = 0;         // [J] in its springs
};
/// A bond that has just broken; `energy` is lost.
struct BondBreak : BondSeen {
  double time = 0;  // [s]
};

}  // namespace silt
