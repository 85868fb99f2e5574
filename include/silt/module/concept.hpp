// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>

#include <silt/core/lanes.hpp>
#include <silt/core/position_row.hpp>
#include <silt/core/quaternion.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET {

/// What a module sees of one particle.
struct Seen {
  ParticleId id;
  Vec3d position;          // [m] of the centre of mass
  Vec3d velocity;          // [m/s]
  Vec3d angular_velocity;  // [rad/s]; of spheres that do not rotate 0
  Quaternion orientation;  // of bodies: turns the frame in which the form was given to space
  double radius;           // [m] of bodies that of the bounding sphere
  double mass;             // [kg] infinite: fixed
  std::size_t material;    // [-] in the table of the contacts
  double time;             // [s]
};

/// What a module does to a particle: at its centre of mass.
struct Push {
  Vec3d force{0, 0, 0};   // [N]
  Vec3d torque{0, 0, 0};  // [N m]; needs particles that rotate
};

/// What a module sees of a contact, for its flux: Real is double or a pack of lanes.
template <class Real>
struct Touching {
  Vec3<Real> normal;  // [-] from the second partner to the first
  Vec3<Real> force;   // [N] on the first
  Real normal_force;  // [N] of it along the normal; negative where the partners attract
  Real overlap;       // [m] > 0, of partners that touch
  Real R_eff;         // [m]
  Real m_eff;         // [kg]
  Real softness;      // [-] modulus E* of the contact over that of the solids: below 1 in contacts
                      // that Softened makes softer, else 1
  Real growth;        // [m/s] of the overlap over the last step, from 0 on where it began in it;
                      // negative: it shrinks. 0 unless the module says `needs_growth = true`
  bool at_wall;       // the second partner is a wall
};

/// Two particles that are near each other, as a module sees them that acts between them.
struct Apart {
  Vec3d from_other;  // [m] from the centre of the second to that of the first; of periodic images
                     // the shortest
  double distance;   // [m] its length
};

/// A contact of a particle with a mesh wall in one step, as a module sees it that wears walls.
struct WallRub {
  double normal_force;      // [N] > 0: the particle presses
  double tangential_force;  // [N] >= 0
  double slip;      // [m/s] of the particle's surface along that of the wall, at the contact
  double approach;  // [m/s] towards the wall; negative: away from it
  double mass;      // [kg] of the particle
  double duration;  // [s] that this counts for
  bool begins;      // there was no contact here in the step before
};

/// What a wall gives to the particles of a module with a flux: heat, say.
struct WallGiven {
  double rate = 0;  // [.../s] at present
  double sum = 0;   // since the start
};

/// A module acts on particles, or knows more of them, beside contacts and a fluid. It is a struct
/// that is given to a Simulation like any policy, any number of them, and has what it needs of:
///
///   struct Fields { double seconds = 0; };               // a number or vector per particle
///   static constexpr std::array names{"seconds"};        // of them, in files
///   Fields start(const Seen&) const;                     // of a particle that comes; left out:
///                                                        // as Fields says
///   Vec3d force(const Seen&) const;                      // [N], or a Push with a torque;
///   Vec3d force(const Seen&, const Fields&) const;       // may use the fields
///   double rate(const Seen&[, const Fields&]) const;     // [1/s] of the fastest swing or decay
///                                                        // that the force makes: sqrt(k/m), c/m
///   void update(const Seen&, Fields&, double dt) const;  // once a step of dt [s]
///
/// `force` is asked in each step at the particle's place then, and again until the velocity of that
/// time, which the force changes, fits to it: twice if it does not depend on the velocity, up to
/// seven times if it does. `static constexpr bool needs_velocity = false` asks once. `update` comes
/// after each step, when particles have moved: positions are those of the step's end, velocities
/// those of its middle (Leapfrog). Both are called by several threads at once, in no order: they
/// see one particle and change its own Fields alone. Fields are plain doubles and Vec3d; they are
/// kept in double, saved in checkpoints, sorted with the particles, and written to VTK and CSV.
///
/// A number may flow between particles in contact, as heat or charge do. Then a module has:
///
///   static constexpr auto exchanged = &Fields::temperature;    // both ends' enter the flux
///   template <class Real>
///   Real flux(const Touching<Real>& c, const Real& a, const Real& b) const;  // [.../s] into the
///                                                              // first end; the second loses it
///   double at_wall(std::size_t wall, double time) const;       // what a wall has; left out:
///                                                              // nothing flows at walls
///   void update(const Seen&, Fields&, double received, double dt) const;  // in place of update:
///                                                              // received [.../s] of all contacts
///
/// flux() is compiled for double and for packs of lanes, like a contact law. It is asked once a
/// step for each contact, with the fields at the step's beginning, and summed in double. Beside it
/// a module may have:
///
///   template <class Real> struct Coefficients { Real ...; };    // what belongs to two materials
///   Coefficients<double> coefficients(const auto& contacts, std::size_t a, std::size_t b) const;
///                                        // of the first and the second end, a wall's too; then
///   flux(c, const Coefficients<Real>& p, a, b)                  // replaces flux(c, a, b)
///   at_wall() may return a std::optional<double>; without a value: nothing flows at this wall
///   std::optional<double> given_by_wall(std::size_t wall, double time) const;  // [.../s] that the
///                                        // wall gives in all, in proportion to flux() from 1 to 0
///                                        // of each of its contacts; none: what at_wall says
///   double at_contact(const Seen&, const Fields&) const;        // what a particle has for
///                                        // flux(), in place of `exchanged`
///   static constexpr bool needs_growth = true;                  // Touching::growth is filled in
///   double rate(const Seen&, const Fields&, double slope) const;  // [1/s], slope: the sum of
///                                        // flux() from 1 to 0 over the contacts of the particle,
///                                        // looked at now and then; rate(const Seen&) before that
///   std::size_t flux_every = 10;                                // [steps] at most, from one call
///   of
///                                        // flux() to the next; the flux is held between them
///   Real share_of_loss(const Coefficients<Real>& p) const;      // [-] see below
///   void check(const auto& simulation) const;                   // throws before a run
///
/// flux() is asked less often than in each step where every module with a flux has flux_every (and
/// none has share_of_loss): as seldom as the least of them says, while the fastest rate times the
/// time between two calls is at most 0.01. With `update` once a step this is Euler's rule of a
/// longer step, and what one end gets the other loses as before.
///
/// Particles may act on each other at a distance, touching or not, within a reach between their
/// centres, or between their surfaces (of bodies: of their bounding spheres). Then a module has:
///
///   double reach() const;                                       // [m] > 0 between centres; or
///   double gap_reach() const;                                   // [m] > 0 between surfaces
///   Vec3d pair_force(const Apart& d, const Seen& a, const Fields& of_a, const Seen& b,
///                    const Fields& of_b) const;                 // [N] on a; b gets the opposite;
///                                                               // or (d, a, b) without fields
///   Vec3d pair_force_on_both(d, a, of_a, b, of_b) const;        // [N] beside it, on a and on b
///                                                               // alike: a third body takes part
///   bool pushes_both() const;                                   // whether that is asked
///   double pair_stiffness(d, a, of_a, b, of_b) const;           // [N/m] how fast it changes with
///                                                               // their places, for the time
///                                                               // step; or (d, a, b)
///   double pair_flux(d, a, of_a, b, of_b) const;                // [.../s] into a, out of b
///   double pair_slope(d, a, of_a, b, of_b) const;               // [.../s] its change with what b
///                                                               // has; added to the `slope` of
///                                                               // rate
///
/// and is asked once a step for each pair within the reach, in no order, by several threads. Forces
/// act at the centres of mass: one that is not along d turns no particle, and keeps no angular
/// momentum. Velocities are those of half a step before. What pair_flux() gives is `received` by
/// update(), together with what flows through contacts; where those fluxes are held for several
/// steps, so is this one. The pairs come from lists of the module's own:
/// engine/lists/near_list.hpp.
///
/// A module that wears mesh walls has
///
///   double worn(const WallRub& rub, std::size_t wall) const;    // [m3] that this step takes off
///
/// asked for each contact with a triangle mesh, and summed for each facet (docs/wear.md).
///
/// With share_of_loss() what friction and damping take from a contact [W] is received by its ends,
/// this share by the first and the rest by the second, if that is a particle. It needs an
/// EnergyLedger.
namespace detail {

struct NoFields {};
template <class M>
struct FieldsOfModule {
  using type = NoFields;
};
template <class M>
requires requires { typename M::Fields; }
struct FieldsOfModule<M> {
  using type = typename M::Fields;
};

}  // namespace detail

/// The fields of a module; of one without any an empty struct.
template <class M>
using FieldsOf = typename detail::FieldsOfModule<M>::type;

namespace detail {

template <class M>
inline constexpr bool has_fields = !std::is_empty_v<FieldsOf<M>>;

template <class M>
concept AsksForForce = requires(const M& m, const Seen& p) {
  m.force(p);
};
template <class M>
concept AsksForForceWithFields = requires(const M& m, const Seen& p, const FieldsOf<M>& f) {
  m.force(p, f);
};
template <class M>
concept Pushes = AsksForForce<M> || AsksForForceWithFields<M>;
template <class M>
concept Updates = requires(const M& m, const Seen& p, FieldsOf<M>& f, double dt) {
  m.update(p, f, dt);
};
template <class M>
concept UpdatesByFlux = requires(const M& m, const Seen& p, FieldsOf<M>& f, double dt) {
  m.update(p, f, dt, dt);
};
template <class M>
concept Exchanges = has_fields<M> && requires(FieldsOf<M>& f) {
  { f.*M::exchanged } -> std::same_as<double&>;
};
template <class M>
concept HasCoefficients = Exchanges<M> && requires {
  typename M::template Coefficients<double>;
};
/// Of a module without Coefficients.
template <class Real>
struct NoCoefficients {};
template <class M>
struct CoefficientsOf {
  template <class Real>
  using type = NoCoefficients<Real>;
};
template <HasCoefficients M>
struct CoefficientsOf<M> {
  template <class Real>
  using type = typename M::template Coefficients<Real>;
};
template <class M, class Real>
SILT_INLINE auto flux_of(const M& m, const Touching<Real>& c,
                         const typename CoefficientsOf<M>::template type<Real>& p, const Real& a,
                         const Real& b) {
  if constexpr (HasCoefficients<M>)
    return m.flux(c, p, a, b);
  else
    return m.flux(c, a, b);
}
template <class M, class Real>
concept FluxOnLanes = requires(const M& m, const Touching<Real>& c, const Real& a) {
  { m.flux(c, a, a) } -> std::convertible_to<Real>;
}
|| (HasCoefficients<M> &&
    requires(const M& m, const Touching<Real>& c,
             const typename CoefficientsOf<M>::template type<Real>& p, const Real& a) {
      { m.flux(c, p, a, a) } -> std::convertible_to<Real>;
    });
template <class M>
concept TakesLoss = HasCoefficients<M> &&
    requires(const M& m, const typename CoefficientsOf<M>::template type<double>& p) {
  { m.share_of_loss(p) } -> std::convertible_to<double>;
};
template <class M>
concept HasWallEnds = requires(const M& m) {
  { m.at_wall(std::size_t{}, double{}) } -> std::convertible_to<std::optional<double>>;
};
template <class M>
inline constexpr bool flows_at_walls = Exchanges<M>&& HasWallEnds<M>;
template <class M>
concept HasContactValue = Exchanges<M> &&
    requires(const M& m, const Seen& p, const FieldsOf<M>& f) {
  { m.at_contact(p, f) } -> std::convertible_to<double>;
};
template <class M>
concept NeedsGrowth = Exchanges<M> && requires {
  requires M::needs_growth;
};
template <class M>
concept SaysReach = requires(const M& m) {
  { m.reach() } -> std::convertible_to<double>;
};
template <class M>
concept SaysGapReach = requires(const M& m) {
  { m.gap_reach() } -> std::convertible_to<double>;
};
template <class M>
concept PushesPairsWithoutFields = requires(const M& m, const Apart& d, const Seen& p) {
  { m.pair_force(d, p, p) } -> std::convertible_to<Vec3d>;
};
template <class M>
concept PushesPairs = PushesPairsWithoutFields<M> ||
    requires(const M& m, const Apart& d, const Seen& p, const FieldsOf<M>& f) {
  { m.pair_force(d, p, f, p, f) } -> std::convertible_to<Vec3d>;
};
template <class M>
concept PushesBoth = PushesPairs<M> &&
    requires(const M& m, const Apart& d, const Seen& p, const FieldsOf<M>& f) {
  { m.pair_force_on_both(d, p, f, p, f) } -> std::convertible_to<Vec3d>;
  { m.pushes_both() } -> std::convertible_to<bool>;
};
template <class M>
concept FlowsInPairs = has_fields<M> &&
    requires(const M& m, const Apart& d, const Seen& p, const FieldsOf<M>& f) {
  { m.pair_flux(d, p, f, p, f) } -> std::convertible_to<double>;
};
template <class M>
concept SaysPairStiffnessWithoutFields = requires(const M& m, const Apart& d, const Seen& p) {
  { m.pair_stiffness(d, p, p) } -> std::convertible_to<double>;
};
template <class M>
concept SaysPairStiffness = SaysPairStiffnessWithoutFields<M> ||
    requires(const M& m, const Apart& d, const Seen& p, const FieldsOf<M>& f) {
  { m.pair_stiffness(d, p, f, p, f) } -> std::convertible_to<double>;
};
template <class M>
concept SaysPairSlope = requires(const M& m, const Apart& d, const Seen& p, const FieldsOf<M>& f) {
  { m.pair_slope(d, p, f, p, f) } -> std::convertible_to<double>;
};
/// Acts between particles at a distance.
template <class M>
concept ActsInPairs = PushesPairs<M> || FlowsInPairs<M>;
/// Is told what it received.
template <class M>
concept Receives = Exchanges<M> || FlowsInPairs<M>;
template <class M>
concept SaysFluxSteps = Exchanges<M> && requires(const M& m) {
  { m.flux_every } -> std::convertible_to<std::size_t>;
};
template <class M>
concept WearsWalls = requires(const M& m, const WallRub& rub) {
  { m.worn(rub, std::size_t{}) } -> std::convertible_to<double>;
};
template <class M>
concept HasGivingWalls = HasWallEnds<M> && requires(const M& m) {
  { m.given_by_wall(std::size_t{}, double{}) } -> std::convertible_to<std::optional<double>>;
};
template <class M>
concept SaysItsFluxRate = Receives<M> && requires(const M& m, const Seen& p, const FieldsOf<M>& f) {
  { m.rate(p, f, double{}) } -> std::convertible_to<double>;
};
template <class M>
concept SaysItsRate = requires(const M& m, const Seen& p) {
  { m.rate(p) } -> std::convertible_to<double>;
}
|| requires(const M& m, const Seen& p, const FieldsOf<M>& f) {
  { m.rate(p, f) } -> std::convertible_to<double>;
};

/// The answer of a module's force, whichever of the forms it has.
template <class M>
SILT_INLINE auto answer_of(const M& m, const Seen& p, const FieldsOf<M>& f) {
  if constexpr (AsksForForceWithFields<M>)
    return m.force(p, f);
  else
    return m.force(p);
}
template <class M>
inline constexpr bool turns_particles = [] {
  if constexpr (Pushes<M>)
    return std::is_same_v<decltype(answer_of(std::declval<const M&>(), std::declval<const Seen&>(),
                                             std::declval<const FieldsOf<M>&>())),
                          Push>;
  else
    return false;
}();
template <class M>
SILT_INLINE Push push_of(const M& m, const Seen& p, const FieldsOf<M>& f) {
  if constexpr (turns_particles<M>)
    return answer_of(m, p, f);
  else
    return {answer_of(m, p, f), {0, 0, 0}};
}
template <class M>
inline constexpr bool needs_velocity = [] {
  if constexpr (requires { M::needs_velocity; })
    return bool{M::needs_velocity};
  else
    return true;
}();

}  // namespace detail

/// A quantity of particles that more than one module may have: Of: the Fields that these have;
/// member: where it is in them. As silt::Temperature.
template <class Q>
concept FieldQuantity = requires(typename Q::Of& fields) {
  fields.*Q::member;
};

/// A policy of the module axis: it has fields, pushes, or wears walls, and its functions take what
/// they are called with.
template <class M>
concept Module = std::is_copy_constructible_v<M> &&
    (detail::Pushes<M> || detail::has_fields<M> || detail::WearsWalls<M> ||
     detail::ActsInPairs<M>)&&(std::is_trivially_copyable_v<FieldsOf<M>>&&
                                   std::is_default_constructible_v<FieldsOf<M>>);

}  // namespace silt
