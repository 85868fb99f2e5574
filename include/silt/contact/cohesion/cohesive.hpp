// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <type_traits>

#include <silt/contact/concept.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Cohesion model: adds an attraction to the force of a contact law. Required:
///   struct Pair                            what the user sets of two materials, like or unlike
///   template <class Real> struct Coefficients     what the kernel needs: Reals only
///   static Coefficients<double> mix(const Pair&)
///   static Real attraction(Contact<Real>, Coefficients<Real>)    [N] >= 0, a pure function
///   static void check(const Pair&)         throws InputError
/// Optional:
///   static Real range(Coefficients<Real>, Real R_eff)    [m] beyond touch, see ContactLaw
///   static constexpr bool forms_at_touch = true          forms at touch, ends at its range
///   static Vec3<Real> resistance(Contact<Real>, Coefficients<Real>)    [N] further tangential
///     force; of a law with friction
///   static double relaxation(Coefficients<double>, double R_eff, double m_eff)    [s], for the
///     time step: in which forces that depend on the velocity stop the mass; with it, attraction()
///     may be negative
///   static double passing_time(Coefficients<double>, double speed)    [s], for the time step: in
///     which the attraction changes from zero to its full value
/// As in a contact law, attraction() and range() run on packs of lanes: use select(), not `if`.
template <class M>
concept CohesionModel = std::equality_comparable<typename M::Pair> &&
    requires(const Contact<double>& c, const typename M::template Coefficients<double>& p) {
  { M::mix(typename M::Pair{}) } -> std::same_as<typename M::template Coefficients<double>>;
  { M::attraction(c, p) } -> std::same_as<double>;
};

namespace detail {

template <class Body>
struct PairOf {
  struct type {};  // the body has no pair values
};
template <HasPairValues Body>
struct PairOf<Body> {
  using type = typename Body::Pair;
};

}  // namespace detail

/// Contact law with an attraction added to the normal force.
///
///   silt::Contacts<silt::Cohesive<silt::HertzMindlin, silt::VanDerWaals>> contacts{
///       {.body = glass, .cohesion = {.hamaker = 6.5e-20, .closest = 1e-9, .cutoff = 1e-6}}};
///
///   F_n = body's F_n - attraction. Friction of the body uses the body's own F_n, without the
///   attraction: this is the force that presses the surfaces together, load plus attraction.
///
/// Body may itself be a Cohesive. Unlike materials need set_pair.
///
/// Source: B. V. Derjaguin et al., J. Colloid Interface Sci. 53 (1975) 314 (attraction and contact
///         force are added).
/// Valid:  as the body's law and the cohesion model.
/// Units:  SI. Shapes: Real = double or batch, lane = pair. History: the body's, and 1 Real [-] for
///         a model that forms at touch.
/// Errors: InputError of the body's law and of the cohesion model.
/// Tests:  tests/contact/cohesion.cpp, tests/physics/cohesion.cpp.
template <class Body, class Cohesion>
struct Cohesive {
  static_assert(ContactLaw<Body>,
                "Cohesive<Body, Cohesion>: Body is not a ContactLaw; its contract is "
                "in silt/contact/concept.hpp");
  static_assert(CohesionModel<Cohesion>,
                "Cohesive<Body, Cohesion>: Cohesion is not a CohesionModel; its contract is in "
                "silt/contact/cohesion/cohesive.hpp");

  struct Material {
    typename Body::Material body;
    typename Cohesion::Pair cohesion;  // between like bodies
    bool operator==(const Material&) const = default;
  };
  struct Pair {
    typename detail::PairOf<Body>::type body;
    typename Cohesion::Pair cohesion;
  };
  template <class Real>
  struct Coefficients {
    typename Body::template Coefficients<Real> body;
    typename Cohesion::template Coefficients<Real> cohesion;
  };

 private:
  static constexpr bool forms_at_touch = requires { requires Cohesion::forms_at_touch; };
  static constexpr bool far_body = ActsAtDistance<Body>;
  static constexpr bool far_cohesion =
      requires(const typename Cohesion::template Coefficients<double>& p) {
    Cohesion::range(p, 1.0);
  };
  template <class Real>
  struct Attached {
    Real attached;  // [-] 1: the bridge has formed
  };
  template <class Real>
  struct Always {};

 public:
  template <class Real>
  struct History : detail::HistoryOf<Body, Real>::type,
                   std::conditional_t<forms_at_touch, Attached<Real>, Always<Real>> {};

  static Pair like(const Material& m) {
    if constexpr (detail::HasPairValues<Body>)
      return {Body::like(m.body), m.cohesion};
    else
      return {{}, m.cohesion};
  }
  static Coefficients<double> mix(const Material& a, const Material& b, const Pair& pair) {
    if constexpr (detail::HasPairValues<Body>)
      return {Body::mix(a.body, b.body, pair.body), Cohesion::mix(pair.cohesion)};
    else
      return {Body::mix(a.body, b.body), Cohesion::mix(pair.cohesion)};
  }

  template <class Real>
  static SILT_INLINE auto force(const Contact<Real>& c, const Coefficients<Real>& p,
                                History<Real>& h) {
    static_assert(
        requires { Cohesion::attraction(c, p.cohesion); },
        "the cohesion model compiles for double, but not for a pack of lanes: make attraction() a "
        "template of Real, as silt/contact/cohesion/cohesive.hpp says, or give "
        "KernelsFor<OneLane>");
    if constexpr (forms_at_touch)
      h.attached = select(c.overlap > Real(0), Real(1), select(near(c, p), h.attached, Real(0)));
    const Real pull = attraction(c, p, h);
    if constexpr (is_frictional<Body>) {
      const Traction<Real> f = of_body(c, p, h);
      return Traction<Real>{f.normal - pull, resisted(f.tangential, c, p, h)};
    } else {
      return Real(of_body(c, p, h) - pull);
    }
  }
  /// Attractive part [N] of the normal force, after force(); negative where it resists approach.
  template <class Real>
  static SILT_INLINE Real attraction(const Contact<Real>& c, const Coefficients<Real>& p,
                                     [[maybe_unused]] const History<Real>& h) {
    const Real pull = select(near(c, p), Cohesion::attraction(c, p.cohesion), Real(0));
    if constexpr (forms_at_touch)
      return pull * h.attached;
    else
      return pull;
  }

  template <class Real>
  static SILT_INLINE Real range(const Coefficients<Real>& p,
                                const Real& R_eff) requires(far_body || far_cohesion) {
    if constexpr (!far_cohesion)
      return Body::range(p.body, R_eff);
    else if constexpr (!far_body)
      return Cohesion::range(p.cohesion, R_eff);
    else
      return max(Body::range(p.body, R_eff), Cohesion::range(p.cohesion, R_eff));
  }
  template <class Real>
  static SILT_INLINE Real stiffness(const Contact<Real>& c, const Coefficients<Real>& p) {
    return Body::stiffness(seen_by_body(c), p.body);
  }
  template <class Real>
  static SILT_INLINE Real unloading(const Contact<Real>& c,
                                    const Coefficients<Real>& p) requires requires {
    Body::unloading(c, p.body);
  }
  { return Body::unloading(seen_by_body(c), p.body); }
  template <class Real>
  static SILT_INLINE Real pressing(const Contact<Real>& c, const Coefficients<Real>& p,
                                   const Real& normal) {
    const Real of_body = normal + Cohesion::attraction(c, p.cohesion);
    if constexpr (requires { Body::pressing(c, p.body, of_body); })
      return Body::pressing(c, p.body, of_body);
    else
      return select(c.overlap > Real(0), max(of_body, Real(0)), Real(0));
  }
  /// The body's springs; attractions store no energy.
  template <class Real>
  static SILT_INLINE Stored<Real> stored(
      const Contact<Real>& c, const Coefficients<Real>& p,
      const History<Real>& h) requires detail::SaysWhatItStores<Body> {
    using Kept = typename detail::HistoryOf<Body, Real>::type;
    auto of_body =
        detail::stored_by<Body, Real>(seen_by_body(c), p.body, static_cast<const Kept&>(h));
    // The rest of the tangential force is not that of the body's dashpot.
    if constexpr (requires { Cohesion::resistance(c, p.cohesion); }) of_body.damping = Real(0);
    return of_body;
  }
  static double contact_time(const Coefficients<double>& p, double R_eff, double m_eff,
                             double speed) requires requires {
    Body::contact_time(p.body, R_eff, m_eff, speed);
  }
  {
    const double body = Body::contact_time(p.body, R_eff, m_eff, speed);
    if constexpr (requires { Cohesion::passing_time(p.cohesion, speed); })
      return std::min(body, Cohesion::passing_time(p.cohesion, speed));
    else if constexpr (requires { Cohesion::relaxation(p.cohesion, R_eff, m_eff); })
      return std::min(body, 2.5 * Cohesion::relaxation(p.cohesion, R_eff, m_eff));
    else
      return body;
  }

  static void check(const Material& m) {
    if constexpr (requires { Body::check(m.body); }) Body::check(m.body);
    Cohesion::check(m.cohesion);
  }
  static void check(const Pair& p) {
    if constexpr (requires { Body::check(p.body); }) Body::check(p.body);
    Cohesion::check(p.cohesion);
  }

 private:
  /// A tangential force with the model's resistance added.
  template <class Real>
  static SILT_INLINE Vec3<Real> resisted(const Vec3<Real>& tangential, const Contact<Real>& c,
                                         const Coefficients<Real>& p,
                                         [[maybe_unused]] const History<Real>& h) {
    if constexpr (requires { Cohesion::resistance(c, p.cohesion); }) {
      Real acts = select(near(c, p), Real(1), Real(0));
      if constexpr (forms_at_touch) acts = acts * h.attached;
      return tangential + acts * Cohesion::resistance(c, p.cohesion);
    } else {
      return tangential;
    }
  }
  /// Lanes in which the attraction acts.
  template <class Real>
  static SILT_INLINE Mask<Real> near(const Contact<Real>& c, const Coefficients<Real>& p) {
    if constexpr (far_cohesion)
      return c.overlap > -Cohesion::range(p.cohesion, c.R_eff);
    else
      return c.overlap > Real(0);
  }
  template <class Real>
  static SILT_INLINE Contact<Real> seen_by_body(const Contact<Real>& c) {
    Contact<Real> touch = c;
    if constexpr (!far_body) touch.overlap = max(c.overlap, Real(0));
    return touch;
  }
  /// Force and history of the body, zero where it does not act.
  template <class Real>
  static SILT_INLINE auto of_body(const Contact<Real>& c, const Coefficients<Real>& p,
                                  History<Real>& h) {
    using Kept = typename detail::HistoryOf<Body, Real>::type;
    constexpr std::size_t H = detail::history_size<Body>();
    auto f = detail::law_force<Body, Real>(seen_by_body(c), p.body, static_cast<Kept&>(h));
    if constexpr (far_cohesion) {  // else the engine masks
      Mask<Real> acts = c.overlap > Real(0);
      if constexpr (far_body) acts = c.overlap > -Body::range(p.body, c.R_eff);
      const Real zero(0);
      if constexpr (H > 0) {
        auto kept = std::bit_cast<std::array<Real, H>>(static_cast<Kept&>(h));
        for (Real& k : kept) k = select(acts, k, zero);
        static_cast<Kept&>(h) = std::bit_cast<Kept>(kept);
      }
      if constexpr (is_frictional<Body>)
        f = {select(acts, f.normal, zero), select(acts, f.tangential, {zero, zero, zero})};
      else
        f = select(acts, f, zero);
    }
    return f;
  }
};

}  // namespace silt
