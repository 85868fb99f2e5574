// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>

#include <silt/bond/strain.hpp>
#include <silt/core/position_row.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET {

/// The two spheres of a new bond.
struct BondedPair {
  double radius_i, radius_j;  // [m]
  double length;              // [m] distance of the centres
  double m_eff;               // [kg] 1/(1/mi + 1/mj); infinite mass if fixed
  double inertia_eff;         // [kg m2] the same for moments of inertia
  double share;               // [-] in (0, 1), random and reproducible: for scattered strengths
};

/// Result of a bond model for one bond, or for one bond per lane: on i.
template <class Real>
struct BondAnswer {
  Vec3<Real> force, couple;            // [N], [N m] of springs: derivatives of an energy
  Vec3<Real> rate_force, rate_couple;  // [N], [N m] of dashpots
};

/// Model of bonds, such as ParallelBond. Required:
///
///   template <class Real> struct Numbers { ... };                        Reals stored for a bond
///   Numbers<double> numbers(const BondedPair&) const;                    when it is made
///   template <class Real>
///   BondAnswer<Real> answer(const BondStrain<Real>&, const Numbers<Real>&) const;
///   template <class Real>                                                [-] breaks above 1
///   Real load(const BondAnswer<Real>&, const Vec3<Real>& normal, const Numbers<Real>&) const;
///   double energy(const BondStrain<double>&, const Numbers<double>&) const;  [J] in the springs
///   BondStiffness stiffest(const Numbers<double>&) const;
///
/// Real is double or a pack, one bond per lane: use select(), min(), max() of core/lanes.hpp, not
/// `if` or std::max, on values; what works only for one double is refused at compile time. Numbers
/// are stored in single precision and are 0 in lanes without a bond. Optional: a function holds(),
/// like load(), which finds with less work the lanes that certainly hold; load() is then called
/// only for the others. `bool has_dashpots() const`, if it returns false: velocities are not read,
/// rates of strains are not computed, and the rate_force and rate_couple of an answer count as 0.
///
/// Optional, for bonds to walls: `static constexpr double share_at_wall`, the share of the length,
/// from the particle, where the bond is sheared and bent; default 1, at the wall.
template <class M>
concept BondModel = requires(const M& model, const BondedPair& pair, const BondStrain<double>& s,
                             const Vec3d& n, const typename M::template Numbers<double>& p) {
  { model.numbers(pair) } -> std::same_as<typename M::template Numbers<double>>;
  { model.answer(s, p) } -> std::same_as<BondAnswer<double>>;
  { model.load(model.answer(s, p), n, p) } -> std::convertible_to<double>;
  { model.energy(s, p) } -> std::convertible_to<double>;
  model.stiffest(p);
};

namespace detail {
template <BondModel M>
constexpr double bent_at_wall() {
  if constexpr (requires { double(M::share_at_wall); })
    return M::share_at_wall;
  else
    return 1;
}
}  // namespace detail

/// Largest stiffnesses and dashpots of a bond, for the time step.
struct BondStiffness {
  double shift;              // [N/m]
  double turn;               // [N m]
  double shift_damping = 0;  // [N s/m]
  double turn_damping = 0;   // [N m s]
};

/// Policy: bonds between spheres, and of spheres to walls, by a model.
///
///   silt::Simulation sim{std::move(grains), contacts, silt::Bonds{silt::ParallelBond{...}}};
///   silt::bond_near(sim, 0.01 * radius);
///
/// `seed` determines the random strengths of bonds.
///
/// Source: as its model.
/// Valid:  spheres, with an integrator of kicks and drifts.
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

/// Contact of a particle with the wall to which it is bonded.
enum class WallContact {
  Acts,     // beside the bond
  Excluded  // no contact with the whole wall while the bond exists
};

/// A bond in its present state, or in its state when it broke. For a bond to a wall, `b` is
/// no_particle and `wall` its number; otherwise `wall` is the largest integer.
struct BondSeen {
  ParticleId a = no_particle, b = no_particle;
  std::size_t wall = static_cast<std::size_t>(-1);
  std::uint64_t number = 0;  // [-] number of earlier bonds
  Vec3d from, to;            // [m] centre of b, or the point on the wall; centre of a
  Vec3d normal;              // [-] unit, from b to a
  Vec3d force, couple;       // [N], [N m] of its springs on a, without its dashpots; opposite on b
  double load = 0;           // [-] over its strength: breaks above 1
  double energy = 0;         // [J] in its springs
};
/// A bond that has just broken; `energy` is lost.
struct BondBreak : BondSeen {
  double time = 0;  // [s]
};

}  // namespace silt
