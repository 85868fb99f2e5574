// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>

#include <silt/contact/contacts.hpp>
#include <silt/core/lanes.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Kinematics of a contact, the input of the law; the same for pairs and walls.
template <class Real>
struct Kinematics {
  Vec3<Real> normal;    // [-] from partner to i
  Vec3<Real> change;    // [-] of the normal during the last step
  Real overlap;         // [m]
  Real arm;             // [-] lever arm over radius, the same for both partners
  Real R_eff;           // [m]
  Real m_eff;           // [kg]
  Real inverse_m_eff;   // [1/kg]
  Vec3<Real> velocity;  // [m/s] of centre i relative to the partner
  Vec3<Real> spin;      // [m/s] sum of radius times angular velocity
  Real twist;           // [rad/s] mean angular velocity of the contact about its normal
};

/// Further input of a rolling model.
template <class Real>
struct RollingKinematics {
  Vec3<Real> angular_velocity;  // [rad/s] w_i - w_j
  Real inertia_eff;             // [kg m2]
};

/// Radii [m] of the partners; 0 for a wall.
template <class Real>
struct Radii {
  Real i, j;
};
template <class ContactsType>
inline constexpr bool needs_radii =
    law_needs_radii<typename ContactsType::Law> || of_own_rotation<typename ContactsType::Rolling>;

/// Force on i, torque over radius (same sign on both partners), couple on i (opposite on j).
template <class Real>
struct PairLoad {
  Vec3<Real> force;   // [N]
  Vec3<Real> twirl;   // [N]
  Vec3<Real> couple;  // [N m]
};

/// The kinematics of N contacts, component by component; written one by one or in packs, read in
/// packs.
template <class ContactsType, std::size_t N, class Scalar>
struct alignas(64) KinematicsBlock {
  static constexpr std::size_t size = N;
  static constexpr bool Rotates = ContactsType::rotates, Rolls = ContactsType::has_rolling,
                        HasRadii = needs_radii<ContactsType>;
  static constexpr std::size_t rotating = Rotates ? N : 16, rolling = Rolls ? N : 16,
                               sized = HasRadii ? N : 16;
  Scalar normal[3][N], change[3][N], overlap[N], R_eff[N], m_eff[N], inverse_m_eff[N],
      velocity[3][N];
  Scalar arm[rotating], spin[3][rotating], twist[rotating];
  Scalar angular_velocity[3][rolling], inertia_eff[rolling], radius_i[sized], radius_j[sized];

  template <class Real>
  SILT_INLINE void put(std::size_t k, const Kinematics<Real>& in) {
    put(k, in.normal, normal), put(k, in.change, change), put(k, in.velocity, velocity);
    silt::store(overlap + k, in.overlap), silt::store(R_eff + k, in.R_eff),
        silt::store(m_eff + k, in.m_eff);
    silt::store(inverse_m_eff + k, in.inverse_m_eff);
    if constexpr (Rotates)
      put(k, in.spin, spin), silt::store(arm + k, in.arm), silt::store(twist + k, in.twist);
  }
  template <class Real>
  SILT_INLINE void put(std::size_t k, const RollingKinematics<Real>& in) {
    if constexpr (Rolls)
      put(k, in.angular_velocity, angular_velocity), silt::store(inertia_eff + k, in.inertia_eff);
  }
  template <class Real>
  SILT_INLINE void put(std::size_t k, const Radii<Real>& in) {
    if constexpr (HasRadii) silt::store(radius_i + k, in.i), silt::store(radius_j + k, in.j);
  }
  template <class Real>
  SILT_INLINE Radii<Real> get_radii(std::size_t k) const {
    if constexpr (HasRadii)
      return {load<Real>(radius_i + k), load<Real>(radius_j + k)};
    else
      return {Real(0), Real(0)};
  }
  template <class Real>
  SILT_INLINE Kinematics<Real> get(std::size_t k) const {
    Kinematics<Real> out;
    out.normal = get3<Real>(k, normal), out.change = get3<Real>(k, change);
    out.velocity = get3<Real>(k, velocity);
    out.overlap = load<Real>(overlap + k), out.R_eff = load<Real>(R_eff + k);
    out.m_eff = load<Real>(m_eff + k), out.inverse_m_eff = load<Real>(inverse_m_eff + k);
    if constexpr (Rotates) {
      out.spin = get3<Real>(k, spin);
      out.arm = load<Real>(arm + k), out.twist = load<Real>(twist + k);
    }
    return out;
  }
  /// Data of a pair in the pair pipeline before square roots and divisions.
  template <class Real>
  SILT_INLINE void put_gathered(std::size_t k, const Kinematics<Real>& in) {
    put(k, in.normal, normal), put(k, in.velocity, velocity);
    silt::store(change[0] + k, in.change.x), silt::store(overlap + k, in.overlap);
    silt::store(R_eff + k, in.R_eff), silt::store(m_eff + k, in.m_eff);
    silt::store(inverse_m_eff + k, in.inverse_m_eff);
    if constexpr (Rotates) put(k, in.spin, spin);
  }
  template <class Real>
  SILT_INLINE Kinematics<Real> get_gathered(std::size_t k) const {
    Kinematics<Real> out;
    out.normal = get3<Real>(k, normal), out.velocity = get3<Real>(k, velocity);
    out.change.x = load<Real>(change[0] + k), out.overlap = load<Real>(overlap + k);
    out.R_eff = load<Real>(R_eff + k), out.m_eff = load<Real>(m_eff + k);
    out.inverse_m_eff = load<Real>(inverse_m_eff + k);
    if constexpr (Rotates) out.spin = get3<Real>(k, spin);
    return out;
  }
  /// Members added or replaced after them.
  template <class Real>
  SILT_INLINE void put_completed(std::size_t k, const Kinematics<Real>& in) {
    put(k, in.normal, normal), put(k, in.change, change);
    silt::store(overlap + k, in.overlap), silt::store(R_eff + k, in.R_eff);
    silt::store(m_eff + k, in.m_eff);
    if constexpr (Rotates) silt::store(arm + k, in.arm), silt::store(twist + k, in.twist);
  }
  /// Loads overwrite the kinematics from which they were computed.
  template <class Real>
  SILT_INLINE void put_load(std::size_t k, const PairLoad<Real>& in) {
    put(k, in.force, velocity);
    if constexpr (Rotates) put(k, in.twirl, spin);
    if constexpr (Rolls) put(k, in.couple, angular_velocity);
  }
  template <class Real>
  SILT_INLINE PairLoad<Real> get_load(std::size_t k) const {
    PairLoad<Real> out;
    out.force = get3<Real>(k, velocity);
    if constexpr (Rotates) out.twirl = get3<Real>(k, spin);
    if constexpr (Rolls) out.couple = get3<Real>(k, angular_velocity);
    return out;
  }
  template <class Real>
  SILT_INLINE RollingKinematics<Real> get_rolling(std::size_t k) const {
    RollingKinematics<Real> out{};
    if constexpr (Rolls)
      out.angular_velocity = get3<Real>(k, angular_velocity),
      out.inertia_eff = load<Real>(inertia_eff + k);
    return out;
  }

 private:
  template <class Real, std::size_t M>
  static SILT_INLINE void put(std::size_t k, const Vec3<Real>& v, Scalar (&out)[3][M]) {
    silt::store(out[0] + k, v.x), silt::store(out[1] + k, v.y), silt::store(out[2] + k, v.z);
  }
  template <class Real, std::size_t M>
  static SILT_INLINE Vec3<Real> get3(std::size_t k, const Scalar (&in)[3][M]) {
    return load3<Real>(in[0] + k, in[1] + k, in[2] + k);
  }
};

}  // namespace silt::detail
