// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/contact/concept.hpp>
#include <silt/contact/formulas.hpp>

namespace silt::inline SILT_TARGET {

/// What a tangential spring remembers: its force, or the slip since first touch.
enum class TangentialMemory { Force, Displacement };

/// A dashpot coefficient c [N s/m] for the leapfrog scheme, where the damping force sees the
/// velocity of half a step ago: v(t - dt/2) = v - a dt/2 acts like a mass smaller by c dt/2.
/// c (sqrt(1 + q^2) - q) with q = c dt/(4 m) keeps the damping ratio c^2/(k m), and with it the
/// restitution, to second order in dt; 1 - q + q^2/2 equals it to third order in q.
template <class Real>
inline Real leapfrog_damping(const Real& c, const Real& inverse_mass, const Real& time_step) {
  const Real q = min(c * (Real(0.25) * time_step * inverse_mass), Real(1));
  return c * (Real(1) - q * (Real(1) - Real(0.5) * q));
}

/// Elastic force less damping along the normal, cut at zero if the contact ends at zero force.
template <DampingEnd End, class Real>
SILT_INLINE Real normal_force(const Real& elastic, const Real& damping, const Contact<Real>& c) {
  const Real force =
      elastic - leapfrog_damping(damping, c.inverse_m_eff, c.lag) * c.normal_velocity;
  if constexpr (End == DampingEnd::ZeroForce)
    return max(force, Real(0));
  else
    return force;
}

/// Tangential spring and dashpot in parallel, in series with a Coulomb slider: |F_t| <= mu F_n.
/// While it slides the stored spring is set back so that spring + dashpot equals the limit.
template <class Real>
struct SpringSlider {
  Real stiffness;  // [N/m] S_t
  Real damping;    // [N s/m] c_t
  Real friction;   // [-] mu

  /// History = spring force on i [N]. `unloading` <= 1 scales it where the stiffness fell.
  SILT_INLINE Vec3<Real> from_force(const Contact<Real>& c, const Real& Fn, const Real& unloading,
                                    Vec3<Real>& spring) const {
    const Vec3<Real> v = c.tangential_velocity;
    const Vec3<Real> trial = c.transported(spring) * unloading - (stiffness * c.time_step) * v;
    const Vec3<Real> dashpot = tangential_damping(c) * v;
    const Vec3<Real> total = trial - dashpot;
    const Real sticking = share_within_limit(total, Fn);
    spring = sticking * trial + (Real(1) - sticking) * dashpot;
    return sticking * total;
  }

  /// History = slip [m] of i relative to j.
  SILT_INLINE Vec3<Real> from_displacement(const Contact<Real>& c, const Real& Fn,
                                           Vec3<Real>& slip) const {
    const Vec3<Real> v = c.tangential_velocity;
    const Vec3<Real> trial = c.transported(slip) + c.time_step * v;
    const Vec3<Real> dashpot = tangential_damping(c) * v;
    const Vec3<Real> total = stiffness * trial + dashpot;
    const Real compliance = Real(1) / max(stiffness, smallest<Real>());
    const Real sticking = share_within_limit(total, Fn);
    slip = sticking * trial - ((Real(1) - sticking) * compliance) * dashpot;
    return -sticking * total;
  }

 private:
  /// Slip moves the mass m*/slip_mobility, 2/7 of m* of solid spheres.
  SILT_INLINE Real tangential_damping(const Contact<Real>& c) const {
    return leapfrog_damping(damping, c.inverse_m_eff, c.slip_mobility * c.lag);
  }
  SILT_INLINE Real share_within_limit(const Vec3<Real>& total, const Real& Fn) const {
    // 1/size as size (1/size^2): division and square root need not wait for each other.
    const Real size2 = max(dot(total, total), smallest<Real>());
    return min(friction * max(Fn, Real(0)) * (sqrt(size2) * (Real(1) / size2)), Real(1));
  }
};

/// The tangential force [N] on i of a spring whose stiffness goes as the square root of the overlap
/// (Mindlin). `memory`: its force [N] or the slip [m].
template <TangentialMemory Memory, class Real>
SILT_INLINE Vec3<Real> mindlin_force(const SpringSlider<Real>& slider, const Contact<Real>& c,
                                     const Real& Fn, Vec3<Real>& memory) {
  if constexpr (Memory == TangentialMemory::Force) {
    // S_t now over S_t at the last step, if the contact is unloading.
    const Real last = c.overlap + c.time_step * c.normal_velocity;
    const Real unloading = min(sqrt(c.overlap / max(last, c.overlap)), Real(1));
    return slider.from_force(c, Fn, unloading, memory);
  } else {
    return slider.from_displacement(c, Fn, memory);
  }
}

/// What the springs of a Mindlin contact store; `elastic` [N] and `energy` [J] of the normal one.
template <TangentialMemory Memory, class Real>
SILT_INLINE Stored<Real> mindlin_stored(const Real& elastic, const Real& energy,
                                        const Real& stiffness, const Vec3<Real>& memory) {
  if constexpr (Memory == TangentialMemory::Force)
    return {elastic, energy, memory,
            dot(memory, memory) / max(Real(2) * stiffness, smallest<Real>())};
  else
    return {elastic, energy, -stiffness * memory, Real(0.5) * stiffness * dot(memory, memory)};
}

}  // namespace silt
