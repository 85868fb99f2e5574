// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>

#include <silt/core/lanes.hpp>
#include <silt/core/upper3.hpp>

namespace silt::inline SILT_TARGET::detail {

/// A Contacts type whose contacts are summed up to the stress of a box: F_a d_b, the force on the
/// first particle times the vector from the second centre [J].
template <class ContactsType>
struct WithVirial : ContactsType {
  static constexpr bool sums_virial = true;
};
template <class ContactsType>
inline constexpr bool sums_virial = requires {
  requires ContactsType::sums_virial;
};
struct NoVirial {};
template <class ContactsType>
using VirialOf = std::conditional_t<sums_virial<ContactsType>, Upper3, NoVirial>;

/// The sums of a block, lane by lane.
template <class Real>
class VirialLanes {
  using Scalar = ScalarOf<Real>;

 public:
  /// NaN (a partner that has left, or padding) is skipped.
  SILT_INLINE void add(const Vec3<Real>& force, const Vec3<Real>& distance) {
    const Real work = dot(force, distance);
    const Vec3<Real> none{Real(0), Real(0), Real(0)};
    const Vec3<Real> f = select(work == work, force, none),
                     d = select(work == work, distance, none);
    sums_[0] += f.x * d.x, sums_[1] += f.y * d.y, sums_[2] += f.z * d.z;
    sums_[3] += f.x * d.y, sums_[4] += f.x * d.z, sums_[5] += f.y * d.z;
  }
  Upper3 sum() const {
    std::array<double, 6> all{};
    for (std::size_t c = 0; c < 6; ++c) {
      alignas(Real) Scalar lanes[sizeof(Real) / sizeof(Scalar)];
      silt::store(lanes, sums_[c]);
      for (const Scalar one : lanes) all[c] += static_cast<double>(one);
    }
    return Upper3::of(all);
  }

 private:
  Real sums_[6] = {Real(0), Real(0), Real(0), Real(0), Real(0), Real(0)};
};

}  // namespace silt::detail
