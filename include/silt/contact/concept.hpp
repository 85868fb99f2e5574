// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>

#include <silt/core/lanes.hpp>

namespace silt::inline SILT_TARGET {

/// Input of a contact law: one pair (`Real` = double) or one pair per lane (`Real` = batch).
///
/// Velocities are those of particle i relative to j at the contact point. They are taken at the
/// half step between the last and the present positions and decomposed in the contact frame of that
/// instant. Their time integral is then the exact relative displacement; Vyas et al., Comput. Phys.
/// Commun. 310 (2025) 109524, show the errors that other choices cause. The engine uses the results
/// only where overlap > 0 and discards force and history of the other lanes. A law with a range
/// also gets gaps, as overlaps down to -range.
template <class Real>
struct Contact {
  Vec3<Real> normal;               // [-] unit, from j to i
  Real overlap;                    // [m] > 0 touching; < 0 a gap, only for laws with a range
  Real normal_velocity;            // [m/s] > 0 separating
  Vec3<Real> tangential_velocity;  // [m/s] in the tangent plane
  Real R_eff;                      // [m] 1/(1/Ri + 1/Rj); Rj infinite at a wall
  Real m_eff;                      // [kg] 1/(1/mi + 1/mj); mj infinite at a wall
  Real inverse_m_eff;              // [1/kg]
  Real radius_i, radius_j;         // [m], 0 for a wall; only for laws with `needs_radii`
  Vec3<Real> turn;                 // [rad] rotation of the contact frame during the last step
  Real time_step;                  // [s]
  Real lag;                        // [s] twice the age of the velocities: time_step, or 0 (Gear)
  /// [-] m_eff over the mass that resists slip, 1 + m r^2/I: 7/2 for solid spheres
  Real slip_mobility = Real(3.5f);

  /// Rotates a vector of the last step's tangent plane with the contact into the present one. The
  /// length is kept.
  Vec3<Real> transported(const Vec3<Real>& v) const {
    // A rotation to second order: the length errs by turn^4/8 a step.
    const Vec3<Real> r = v + cross(turn, v + Real(0.5) * cross(turn, v));
    return r - dot(r, normal) * normal;
  }
};

/// Result of a frictional law: the force on i, split into normal and tangential parts.
template <class Real>
struct Traction {
  Real normal;            // [N] > 0 pushes i away from j
  Vec3<Real> tangential;  // [N]
};

/// What a contact stores, for the energy ledger: the elastic part of its force and its energy.
template <class Real>
struct Stored {
  Real force;         // [N] of the normal spring
  Real normal;        // [J] in it
  Vec3<Real> spring;  // [N] of the tangential spring
  Real tangential;    // [J] in it
  /// [N s/m] of the dashpot that supplies the rest of the tangential force; 0: none
  Real damping = Real(0);
  /// [J] gained by the tangential spring in the last step without work. Only for laws that keep the
  /// elongation while the stiffness changes.
  Real stiffening = Real(0);
};

/// Input of a rolling model: one pair or one pair per lane.
template <class Real>
struct RollingContact {
  Vec3<Real> normal;            // [-] from j to i
  Vec3<Real> angular_velocity;  // [rad/s] of i relative to j, tangential part
  Real twist;                   // [rad/s] normal part, > 0 about the normal
  Vec3<Real> spin_velocity;     // [m/s] Ri wi + Rj wj; Ri wi at a wall
  Real overlap;                 // [m]
  Real normal_force;            // [N] >= 0
  Real normal_stiffness;        // [N/m] dF_n/d(overlap)
  Real R_eff;                   // [m]
  Real inertia_eff;             // [kg m2] 1/(1/(Ii + mi Ri^2) + 1/(Ij + mj Rj^2))
  Vec3<Real> turn;              // [rad]
  Real time_step;               // [s]
  /// [-] I/(I + m r^2): the inertia of twisting, 1/(1/Ii + 1/Ij), over inertia_eff
  Real share_of_rolling = Real(static_cast<ScalarOf<Real>>(2.0 / 7.0));
  // For springs that store a couple: it is reduced as the stiffness falls.
  Real unloading = Real(1);  // [-] <= 1 normal_stiffness over its value one step ago
  Real shrinking = Real(1);  // [-] <= 1 overlap over its value one step ago

  /// A couple against `rotation` [rad/s] of the size `limit` [N m]. Rotations so slow that the
  /// couple would reverse them within a few steps are damped over 8 steps instead.
  Vec3<Real> against(const Vec3<Real>& rotation, const Real& limit) const {
    const Real size = sqrt(max(dot(rotation, rotation), smallest<Real>()));
    return -min(limit / size, inertia_eff / (Real(8) * time_step)) * rotation;
  }
};

/// Additional input of a rolling model that uses each partner's own rotation.
template <class Real>
struct OwnRotations {
  Vec3<Real> of_i, of_j;    // [rad/s]
  Real radius_i, radius_j;  // [m]; 0 of a wall
};
/// Result of such a model: couples [N m], not necessarily opposite.
template <class Real>
struct OwnCouples {
  Vec3<Real> on_i, on_j;
};

namespace detail {

template <class L>
concept HasHistory = requires {
  typename L::template History<double>;
};
template <class L>
concept HasPairValues = requires {
  typename L::Pair;
};

struct NoHistory {};
template <class L, class Real>
struct HistoryOf {
  using type = NoHistory;
};
template <HasHistory L, class Real>
struct HistoryOf<L, Real> {
  using type = typename L::template History<Real>;
};

/// Number of Reals in a law's history; a history is a plain aggregate of Reals.
template <class L>
constexpr std::size_t history_size() {
  if constexpr (HasHistory<L>)
    return sizeof(typename L::template History<double>) / sizeof(double);
  else
    return 0;
}

/// A law's history in double precision; number(n) returns its n-th Real.
template <class L, class Number>
typename HistoryOf<L, double>::type history_of(const Number& number) {
  typename HistoryOf<L, double>::type h;
  if constexpr (HasHistory<L>) {
    std::array<double, history_size<L>()> values;
    for (std::size_t n = 0; n < values.size(); ++n) values[n] = static_cast<double>(number(n));
    h = std::bit_cast<decltype(h)>(values);
  }
  return h;
}

/// Calls the law, with its history if it has one.
template <class L, class Real, class C, class P, class H>
requires HasHistory<L> SILT_INLINE auto law_force(const C& contact, const P& coefficients,
                                                  H& history)
    -> decltype(L::force(contact, coefficients, history)) {
  return L::force(contact, coefficients, history);
}
template <class L, class Real, class C, class P, class H>
requires(!HasHistory<L>) SILT_INLINE auto law_force(const C& contact, const P& coefficients, H&)
    -> decltype(L::force(contact, coefficients)) {
  return L::force(contact, coefficients);
}

/// What the law stores, with its history if it has one.
template <class L, class Real, class H>
SILT_INLINE Stored<Real> stored_by(const Contact<Real>& contact,
                                   const typename L::template Coefficients<Real>& coefficients,
                                   const H& history) {
  if constexpr (HasHistory<L>)
    return L::stored(contact, coefficients, history);
  else
    return L::stored(contact, coefficients);
}
template <class L>
concept SaysWhatItStores = requires(const Contact<double>& c,
                                    const typename L::template Coefficients<double>& p,
                                    const typename HistoryOf<L, double>::type& h) {
  {stored_by<L, double>(c, p, h)};
  requires requires { L::stored(c, p, h); } || requires {
    L::stored(c, p);
  };
};

template <class L>
using ForceOf =
    decltype(law_force<L, double>(std::declval<const Contact<double>&>(),
                                  std::declval<const typename L::template Coefficients<double>&>(),
                                  std::declval<typename HistoryOf<L, double>::type&>()));

/// Converts an aggregate of doubles, given lane by lane, to the same aggregate of Reals.
template <template <class> class Aggregate, class Real>
SILT_INLINE Aggregate<Real> broadcast(const Aggregate<double>& a) {
  constexpr std::size_t n = sizeof(Aggregate<double>) / sizeof(double);
  const auto values = std::bit_cast<std::array<double, n>>(a);
  std::array<Real, n> reals;
  for (std::size_t k = 0; k < n; ++k) reals[k] = Real(static_cast<ScalarOf<Real>>(values[k]));
  return std::bit_cast<Aggregate<Real>>(reals);
}

}  // namespace detail

/// Contact law: pure functions of one pair. Required:
///   struct Material                       what the user sets; equality comparable
///   template <class Real> struct Coefficients    what the kernel needs for a pair, only Reals;
///                                                static constexpr std::array names: for messages
///   static Coefficients<double> mix(const Material&, const Material& [, const Pair&])
///   static force(Contact<Real>, Coefficients<Real> [, History<Real>&])
///     Uses + - * / and the functions of core/lanes.hpp: select() instead of `if` on data. An `if`
///     is refused at compile time (core/probe.hpp), except with KernelsFor<OneLane>. Returns Real
///     (a central force; particles do not rotate) or Traction<Real>. Declare it SILT_INLINE: in a
///     large translation unit compilers stop inlining, and a step takes 1.45 times as long.
/// Optional members, detected by name:
///   template <class Real> struct History  Reals kept while the contact lasts, zero at first touch
///   struct Pair                           values of a pair of materials (restitution, ...)
///     with `static Pair like(const Material&)` for two bodies of the same material
///   static void check(const Material&), check(const Pair&)      throw InputError
///   static double contact_time(Coefficients<double>, R_eff, m_eff, speed)    [s], for time steps
///   static Real stiffness(Contact<Real>, Coefficients<Real>)    [N/m], for rolling resistance
///   static Real unloading(Contact<Real>, Coefficients<Real>)    [-] <= 1, stiffness over its
///     value one step ago, where a closed form is cheaper than two calls of stiffness()
///   static Real range(Coefficients<Real>, Real R_eff)    [m], for laws that act at a distance:
///     force and history exist while the gap is smaller; must not decrease with R_eff
///   static constexpr bool needs_radii = true    sets Contact::radius_i and radius_j; contact_time
///     is then called with R_i, R_j (0: wall), m_eff, speed
///   static Coefficients<Real> scaled(Coefficients<Real>, Real factor)    for a body `factor`
///     times as stiff. With `static double compliance(const Material&)` [1/Pa] or [m/N] of one
///     partner and `static double impact_force(Coefficients<double>, R_eff, m_eff, speed)` [N],
///     for Softened
///   static Stored<Real> stored(Contact<Real>, Coefficients<Real> [, History<Real>])    for the
///     EnergyLedger: springs and their energy after force(). Without Stored::damping the whole
///     tangential loss is counted as friction
///   static Real attraction(Contact<Real>, Coefficients<Real>, History<Real>)    [N] >= 0, the
///     attractive part of the normal force, for ContactSeen::cohesion; called with double, without
///     velocities
///   static Real pressing(Contact<Real>, Coefficients<Real>, Real normal)    [N] >= 0, the force
///     that presses the bodies together, adhesion included, for rolling resistance; default
///     max(normal, 0)
template <class L>
concept ContactLaw = std::equality_comparable<typename L::Material> && requires {
  typename L::template Coefficients<double>;
} &&(std::same_as<detail::ForceOf<L>, double> ||
     std::same_as<detail::ForceOf<L>, Traction<double>>);

/// Rolling model: adds a couple M on i and -M on j, in lanes like a contact law. Required:
///   static constexpr bool is_rolling_model = true
///   struct Pair                                  what the user sets for a pair of materials
///   template <class Real> struct Coefficients    what the kernel needs, only Reals
///   static Coefficients<double> mix(const Pair&)
///   static Vec3<Real> torque(RollingContact<Real>, Coefficients<Real> [, History<Real>&])    [N m]
///
/// Optional: `template <class Real> struct History`, as of a law; `static void check(const Pair&)`,
/// which throws InputError. With `static constexpr bool of_own_rotation = true` the call is
/// `torque(RollingContact<Real>, OwnRotations<Real>, Coefficients<Real>)`, which returns
/// OwnCouples<Real>. A model with a spring gives `static Real stored(RollingContact<Real>,
/// Coefficients<Real>, History<Real>)` [J] for the EnergyLedger.
template <class M>
concept RollingModel = requires {
  typename M::Pair;
}
&&requires(const RollingContact<double>& c, const typename M::template Coefficients<double>& p,
           typename detail::HistoryOf<M, double>::type& h) {
  { M::mix(typename M::Pair{}) } -> std::same_as<typename M::template Coefficients<double>>;
  M::is_rolling_model;
};

namespace detail {

/// Calls a rolling model's check(), if it has one.
template <class M>
void check_rolling(const typename M::Pair& pair) {
  if constexpr (requires { M::check(pair); }) M::check(pair);
}

template <class L>
inline constexpr bool law_needs_radii = requires {
  requires L::needs_radii;
};
/// A law with a safeguard, which detects its action from the history before and after a step.
template <class L>
concept has_safeguard = requires(const typename HistoryOf<L, double>::type& h) {
  { L::safeguarded(h, h) } -> std::same_as<bool>;
};
template <class M>
inline constexpr bool of_own_rotation = requires {
  requires M::of_own_rotation;
};

/// True if the law compiles for a pack of lanes of type Real as it does for one double.
/// (engine/contact/ask_on_lanes.hpp checks that the results are right in lanes.)
template <class L, class Real>
concept WorksOnLanes = requires(const Contact<Real>& c,
                                const typename L::template Coefficients<Real>& p,
                                typename HistoryOf<L, Real>::type& h) {
  law_force<L, Real>(c, p, h);
};

}  // namespace detail

/// A law that acts before bodies touch and after they separate, up to a gap `range`.
template <class L>
concept ActsAtDistance = requires(const typename L::template Coefficients<double>& p) {
  { L::range(p, 1.0) } -> std::same_as<double>;
};

/// True if the law's force has a tangential part, so that particles need to rotate.
template <class L>
inline constexpr bool is_frictional = std::same_as<detail::ForceOf<L>, Traction<double>>;

}  // namespace silt
