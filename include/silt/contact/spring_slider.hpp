// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <type_traits>

#include <silt/contact/concept.hpp>
#include <silt/contact/formulas.hpp>

namespace silt::inline SILT_TARGET {

/// What a tangential spring stores: its force, or the slip since first touch.
enum class TangentialMemory { Force, Displacement };

/// Dashpot coefficient c [N s/m] corrected for leapfrog, where the damping force uses the velocity
/// of half a step ago. v(t - dt/2) = v - a dt/2 acts like a mass reduced by c dt/2. c (sqrt(1 +
/// q^2) - q) with q = c dt/(4 m) keeps the damping ratio c^2/(k m), and thus the restitution, to
/// second order in dt. 1 - q + q^2/2 equals the factor to third order in q.
template <class Real>
inline Real leapfrog_damping(const Real& c, const Real& inverse_mass, const Real& time_step) {
  const Real q = min(c * (Real(0.25) * time_step * inverse_mass), Real(1));
  return c * (Real(1) - q * (Real(1) - Real(0.5) * q));
}

/// Elastic force minus damping along the normal; cut at zero if the contact ends at zero force.
template <DampingEnd End, class Real>
SILT_INLINE Real normal_force(const Real& elastic, const Real& damping, const Contact<Real>& c) {
  const Real force =
      elastic - leapfrog_damping(damping, c.inverse_m_eff, c.lag) * c.normal_velocity;
  if constexpr (End == DampingEnd::ZeroForce)
    return max(force, Real(0));
  else
    return force;
}

/// Tangential spring and dashpot in parallel, both in series with a Coulomb slider: |F_t| <= mu
/// F_n. T is the spring's force on i, v the slip velocity, u the velocity of the spring:
///
///   sticking:  u = v,  F_t = T - c_t u,  dT = - S_t u dt                                      (1)
///   sliding:   F_t = mu F_n in the direction of (1); u from F_t = T - c_t u                 (2)
///
/// In one step dT = share (F_t - T), share = S_t dt/(S_t dt + c_t), holds for both. During sliding
/// the spring relaxes to the limit within c_t/S_t, and the dashpot damps the spring's own motion.
/// The dashpot loses c_t u^2 >= 0, the slider F_t (v - u) <= 0, and the spring stores the rest.
/// (Luding, Granular Matter 10 (2008) 235, and LAMMPS set T = F_t + c_t v during sliding instead.
/// This loads the spring by the dashpot, with energy that was never supplied, and the spring later
/// pushes along the slip.)
template <class Real>
struct SpringSlider {
  Real stiffness;  // [N/m] S_t
  Real damping;    // [N s/m] c_t
  Real friction;   // [-] mu

  /// History = spring force on i [N]. `unloading` <= 1 scales it where the stiffness decreased.
  SILT_INLINE Vec3<Real> from_force(const Contact<Real>& c, const Real& Fn, const Real& unloading,
                                    Vec3<Real>& spring) const {
    const Vec3<Real> carried = c.transported(spring) * unloading;
    const Real of_spring = stiffness * c.time_step, both = of_spring + tangential_damping(c);
    const Vec3<Real> trial = carried - both * c.tangential_velocity;
    const Limited at = limited(trial, Fn, both);
    spring = (Real(1) - at.relaxed * of_spring) * carried -
             (at.share * of_spring) * c.tangential_velocity;
    return at.share * trial;
  }

  /// History = elongation of the spring [m], i relative to j.
  SILT_INLINE Vec3<Real> from_displacement(const Contact<Real>& c, const Real& Fn,
                                           Vec3<Real>& slip) const {
    const Vec3<Real> carried = c.transported(slip);
    const Real of_spring = stiffness * c.time_step, both = of_spring + tangential_damping(c);
    const Vec3<Real> trial = (-stiffness) * carried - both * c.tangential_velocity;
    const Limited at = limited(trial, Fn, both);
    slip = (Real(1) - at.relaxed * of_spring) * carried +
           (at.share * c.time_step) * c.tangential_velocity;
    return at.share * trial;
  }

  /// Effective dashpot [N s/m]. Slip moves the mass m*/slip_mobility, 2/7 m* for solid spheres.
  SILT_INLINE Real tangential_damping(const Contact<Real>& c) const {
    return leapfrog_damping(damping, c.inverse_m_eff, c.slip_mobility * c.lag);
  }

 private:
  struct Limited {
    Real share;    // [-] of the trial force that friction sustains
    Real relaxed;  // [m/N] (1 - share)/(S_t dt + c_t)
  };
  /// Whether to test first if any lane slides. Square roots and divisions take as long for two or
  /// four doubles as for eight (Zen 5), and narrow packs spend a third of the law's time on them.
  /// In wider packs a lane slides too often for the test to pay.
  static constexpr bool looks_first =
      sizeof(Real) <= 4 * sizeof(double) && std::is_same_v<ScalarOf<Real>, double>;

  /// One division for both, by |trial|^2 (S_t dt + c_t). sqrt(size^2)/size^2 is 1/size, hence
  /// square root and division can run in parallel. Where the product is nearly zero, the trial
  /// force is within the limit or both are zero.
  SILT_INLINE Limited limited(const Vec3<Real>& trial, const Real& Fn, const Real& both) const {
    const Real limit = friction * max(Fn, Real(0)), square = dot(trial, trial);
    // The threshold exceeds the rounding of `borne`: if no lane slides, the share is exactly 1.
    if constexpr (looks_first)
      if (!silt::any(square * Real(1 + 1e-14) > limit * limit)) return {Real(1), Real(0)};
    const Real size2 = max(square, smallest<Real>());
    const Real inverse = Real(1) / max(size2 * both, smallest<Real>());
    const Real borne = limit * sqrt(size2) * (both * inverse);
    const Real share = min(borne, Real(1));
    return {share, (Real(1) - share) * (size2 * inverse)};
  }
};

/// [-] <= 1 Overlap over its value one step ago, if the contact is unloading.
template <class Real>
SILT_INLINE Real shrinking(const Contact<Real>& c) {
  const Real now = max(c.overlap, smallest<Real>());
  return now / max(c.overlap + c.time_step * c.normal_velocity, now);
}
/// The same ratio for a stiffness proportional to the square root of the overlap.
template <class Real>
SILT_INLINE Real hertz_unloading(const Contact<Real>& c) {
  return sqrt(shrinking(c));
}

/// Tangential force [N] on i of a spring with a stiffness proportional to the square root of the
/// overlap (Mindlin). `memory`: its force [N] or the slip [m].
template <TangentialMemory Memory, class Real>
SILT_INLINE Vec3<Real> mindlin_force(const SpringSlider<Real>& slider, const Contact<Real>& c,
                                     const Real& Fn, Vec3<Real>& memory) {
  if constexpr (Memory == TangentialMemory::Force) {
    return slider.from_force(c, Fn, hertz_unloading(c), memory);
  } else {
    return slider.from_displacement(c, Fn, memory);
  }
}

/// What the springs of a contact store, after force(); `elastic` [N] and `energy` [J] are those of
/// the normal spring.
template <TangentialMemory Memory, class Real>
SILT_INLINE Stored<Real> stored_in(const SpringSlider<Real>& slider, const Contact<Real>& c,
                                   const Real& elastic, const Real& energy,
                                   const Vec3<Real>& memory) {
  const Real square = Real(0.5) * dot(memory, memory), k = slider.stiffness;
  if constexpr (Memory == TangentialMemory::Force)
    return {elastic, energy, memory, square / max(k, smallest<Real>()),
            slider.tangential_damping(c)};
  else
    return {elastic, energy, (-k) * memory, k * square, slider.tangential_damping(c)};
}

/// The same for a tangential stiffness proportional to the square root of the overlap.
template <TangentialMemory Memory, class Real>
SILT_INLINE Stored<Real> mindlin_stored(const SpringSlider<Real>& slider, const Contact<Real>& c,
                                        const Real& elastic, const Real& energy,
                                        const Vec3<Real>& memory) {
  Stored<Real> s = stored_in<Memory>(slider, c, elastic, energy, memory);
  if constexpr (Memory == TangentialMemory::Displacement) {
    const Real last = max(c.overlap + c.time_step * c.normal_velocity, Real(0));
    s.stiffening = s.tangential * (Real(1) - sqrt(last / max(c.overlap, smallest<Real>())));
  }
  return s;
}

}  // namespace silt
