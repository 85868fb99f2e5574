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

/// State of one particle, as passed to a module.
struct Seen {
  ParticleId id;
  Vec3d position;          // [m] of the centre of mass
  Vec3d velocity;          // [m/s]
  Vec3d angular_velocity;  // [rad/s]; 0 for spheres that do not rotate
  Quaternion orientation;  // of bodies: rotates the frame of the form to space
  double radius;           // [m] of bodies: bounding sphere
  double mass;             // [kg] infinite: fixed
  std::size_t material;    // [-] index in the table of the contacts
  double time;             // [s]
};

/// Action of a module on a particle, at its centre of mass.
struct Push {
  Vec3d force{0, 0, 0};   // [N]
  Vec3d torque{0, 0, 0};  // [N m]; only for particles that rotate
};

/// State of a contact, as passed to flux(). Real is double or a pack of lanes.
template <class Real>
struct Touching {
  Vec3<Real> normal;  // [-] from the second partner to the first
  Vec3<Real> force;   // [N] on the first
  Real normal_force;  // [N] normal component; negative: attraction
  Real overlap;       // [m] > 0
  Real R_eff;         // [m]
  Real m_eff;         // [kg]
  Real softness;      // [-] E* of the contact over that of the solids: below 1 in contacts of
                      // Softened, else 1
  Real growth;        // [m/s] of the overlap over the last step, from 0 for a new contact; < 0: it
                      // shrinks. 0 unless the module has `needs_growth = true`
  bool at_wall;       // the second partner is a wall
};

/// Two neighbouring particles, as passed to pair functions.
struct Apart {
  Vec3d from_other;  // [m] from the centre of the second to that of the first; shortest periodic
                     // image
  double distance;   // [m] its length
};

/// Contact of a particle with a mesh wall in one step, as passed to worn().
struct WallRub {
  double normal_force;      // [N] > 0: the particle presses
  double tangential_force;  // [N] >= 0
  double slip;              // [m/s] of the particle's surface along the wall, at the contact
  double approach;          // [m/s] towards the wall; negative: away
  double mass;              // [kg] of the particle
  double duration;          // [s] time that this counts for
  bool begins;              // the contact is new in this step
};

/// Quantity given by a wall to the particles of a module with a flux, such as heat.
struct WallGiven {
  double rate = 0;  // [.../s] at present
  double sum = 0;   // since the start
};

/// Module: forces, fields and fluxes of particles in addition to contacts and a fluid. A module is
/// a struct that is passed to a Simulation like any policy, in any number. All members are
/// optional:
///
///   struct Fields { double seconds = 0; };               // numbers or vectors per particle
///   static constexpr std::array names{"seconds"};        // their names in files
///   Fields start(const Seen&) const;                     // of a new particle; default: Fields{}
///   void divide(Fields&, double share) const;            // of a fragment: its share of the volume
///                                                        // of what broke, whose fields it has
///   Vec3d force(const Seen&) const;                      // [N], or a Push with a torque;
///   Vec3d force(const Seen&, const Fields&) const;       // may use the fields
///   double rate(const Seen&[, const Fields&]) const;     // [1/s] of the fastest oscillation or
///                                                        // decay due to the force: sqrt(k/m), c/m
///   void update(const Seen&, Fields&, double dt) const;  // once per step of dt [s]
///   bool allows(const Fields&) const;                    // after an update: false ends the run
///   static constexpr const char* allowed;                // with these words, what to change
///
/// `force` is called in each step with the present position. As the force changes the velocity, the
/// call is repeated until the velocity of that time is consistent: twice if the force does not
/// depend on the velocity, up to seven times if it does. `static constexpr bool needs_velocity =
/// false` reduces this to one call. `update` is called after each step, when particles have moved:
/// positions are those of the end of the step, velocities those of its middle (Leapfrog). Both are
/// called by several threads, in any order, and may change only the Fields of their particle.
/// A fragment of a particle that breaks has its fields, as is right for a temperature; a module
/// whose fields are of the whole particle, as a charge, has divide(). Fields are double and Vec3d.
/// They are stored in double precision, saved in checkpoints, sorted with the particles, and
/// written to VTK and CSV.
///
/// A quantity such as heat or charge may flow between particles in contact. The module then has:
///
///   static constexpr auto exchanged = &Fields::temperature;    // the value that flux() gets
///   template <class Real>
///   Real flux(const Touching<Real>& c, const Real& a, const Real& b) const;  // [.../s] into the
///                                                              // first end; the second loses it
///   double at_wall(std::size_t wall, double time) const;       // value of a wall; default: no
///                                                              // flux at walls
///   void update(const Seen&, Fields&, double received, double dt) const;  // replaces update();
///                                                              // received [.../s]: all contacts
///
/// flux() is compiled for double and for packs of lanes, like a contact law. It is called once per
/// step for each contact, with the fields at the start of the step, and summed in double precision.
/// Further members of such a module:
///
///   template <class Real> struct Coefficients { Real ...; };    // for a pair of materials
///   Coefficients<double> coefficients(const auto& contacts, std::size_t a, std::size_t b) const;
///                                        // for the materials of both ends, walls included; then
///   flux(c, const Coefficients<Real>& p, a, b)                  // replaces flux(c, a, b)
///   at_wall() may return a std::optional<double>; without a value: no flux at this wall
///   std::optional<double> given_by_wall(std::size_t wall, double time) const;  // [.../s] in all
///                                        // from the wall, divided in proportion to flux() from 1
///                                        to 0
///                                        // of its contacts; without a value: at_wall()
///   double at_contact(const Seen&, const Fields&) const;        // value of a particle for flux(),
///                                        // in place of `exchanged`
///   static constexpr bool needs_growth = true;                  // sets Touching::growth
///   double rate(const Seen&, const Fields&, double slope) const;  // [1/s], slope: sum of flux()
///                                        // from 1 to 0 over the contacts of the particle, updated
///                                        // at intervals; before that rate(const Seen&)
///   double rate(const Seen&, const Coefficients<double>&) const;
///                                        // in place of rate(const Seen&): the largest over the
///                                        // materials that the particle may touch
///   std::size_t flux_every = 10;                                // [steps] largest interval
///                                        // between calls of flux(), constant in between
///   Real share_of_loss(const Coefficients<Real>& p) const;      // [-] see below
///   void check(const auto& simulation) const;                   // throws before a run
///
/// flux() is called at intervals of several steps if every module with a flux has flux_every and
/// none has share_of_loss. The interval is the smallest flux_every, and is limited by: fastest rate
/// times interval <= 0.01. With `update` in each step this is Euler's method with a longer step,
/// and the exchange remains conservative.
///
/// Particles may interact at a distance, with a reach between their centres or between their
/// surfaces (for bodies: bounding spheres). The module then has:
///
///   double reach() const;                                       // [m] > 0 between centres; or
///   double gap_reach() const;                                   // [m] > 0 between surfaces
///   Vec3d pair_force(const Apart& d, const Seen& a, const Fields& of_a, const Seen& b,
///                    const Fields& of_b) const;                 // [N] on a; -force on b;
///                                                               // or (d, a, b) without fields
///   Vec3d pair_force_on_both(d, a, of_a, b, of_b) const;        // [N] in addition, on a and on b
///                                                               // alike: from a third body
///   bool pushes_both() const;                                   // whether it is called
///   double pair_stiffness(d, a, of_a, b, of_b) const;           // [N/m] change of the force with
///                                                               // position, for the time step;
///                                                               // or (d, a, b)
///   double pair_flux(d, a, of_a, b, of_b) const;                // [.../s] into a, out of b
///   double pair_slope(d, a, of_a, b, of_b) const;               // [.../s] its change with the
///                                                               // value of b; added to the
///                                                               // `slope` of rate()
///
/// These functions are called once per step for each pair within the reach, in any order, by
/// several threads. Forces act at the centres of mass: a force that is not along d does not rotate
/// particles, and does not conserve angular momentum. Velocities are those of half a step before.
/// The sum of pair_flux() is part of `received` in update(), together with the flux through
/// contacts; where contact fluxes are constant over several steps, so is pair_flux(). The pairs
/// come from the module's own lists: engine/lists/near_list.hpp.
///
/// A module that computes wear of mesh walls has
///
///   double worn(const WallRub& rub, std::size_t wall) const;    // [m3] volume worn in this step
///
/// It is called for each contact with a triangle mesh, and summed for each facet (docs/wear.md).
///
/// With share_of_loss() the power lost by friction and damping in a contact [W] is given to its
/// ends: this share to the first, the rest to the second if it is a particle. It needs an
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

/// The fields of a module; an empty struct for a module without fields.
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
concept DividesFields = has_fields<M> && requires(const M& m, FieldsOf<M>& f, double share) {
  m.divide(f, share);
};
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
/// For a module without Coefficients.
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
/// Estimates how fast contacts of a pair of materials make a particle follow.
template <class M>
concept SaysRateOfPair = HasCoefficients<M> &&
    requires(const M& m, const Seen& p,
             const typename CoefficientsOf<M>::template type<double>& c) {
  { m.rate(p, c) } -> std::convertible_to<double>;
};
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
/// Interacts between particles at a distance.
template <class M>
concept ActsInPairs = PushesPairs<M> || FlowsInPairs<M>;
/// Gets the sum of its fluxes in update().
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

/// The result of a module's force, for all its forms.
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

/// A quantity of particles that several modules may have. Of: the Fields of these modules; member:
/// its member in them. Example: silt::Temperature.
template <class Q>
concept FieldQuantity = requires(typename Q::Of& fields) {
  fields.*Q::member;
};

/// A policy of the module axis: it has fields, forces, or wear, and its functions have the right
/// arguments.
template <class M>
concept Module = std::is_copy_constructible_v<M> &&
    (detail::Pushes<M> || detail::has_fields<M> || detail::WearsWalls<M> ||
     detail::ActsInPairs<M>)&&(std::is_trivially_copyable_v<FieldsOf<M>>&&
                                   std::is_default_constructible_v<FieldsOf<M>>);

}  // namespace silt
