// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <type_traits>

#include <silt/contact/contacts.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/lanes.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The coefficients of every pair of materials, as the kernels use them.
template <class ContactsType>
struct CoefficientTable {
  std::size_t materials = 1;
  DynArray<typename ContactsType::LawCoefficients> law;          // materials x materials
  DynArray<typename ContactsType::RollingCoefficients> rolling;  // materials x materials
};

/// Pairs of materials without a pair value, which no touching particles have
/// (NameAccess::check_pairs), get the value of like materials.
template <class ContactsType, class Contacts>
CoefficientTable<ContactsType> coefficient_table(const Contacts& contacts) {
  const std::size_t n = contacts.materials();
  const std::size_t of_particles = ContactsType::several_materials ? n : 1;
  CoefficientTable<ContactsType> table{n, {}, {}};
  for (std::size_t a = 0; a < of_particles; ++a)
    for (std::size_t b = 0; b < n; ++b) {
      table.law.push_back(contacts.coefficients(a, contacts.has_pair(a, b) ? b : a));
      table.rolling.push_back(contacts.rolling_coefficients(a, b));
    }
  return table;
}

/// The largest gap [m] at which the law acts, between spheres of up to `largest_radius` [m] and
/// with walls.
template <class ContactsType>
double largest_range([[maybe_unused]] const CoefficientTable<ContactsType>& table,
                     [[maybe_unused]] double largest_radius) {
  double most = 0;
  if constexpr (ActsAtDistance<typename ContactsType::Law>)
    for (const auto& p : table.law)
      most = std::max(most, ContactsType::Law::range(p, largest_radius));
  return most;
}

/// The coefficients of each lane's pair of materials. It keeps those of the last pack, because
/// usually all lanes of all packs have the same.
template <template <class> class Aggregate, class Real>
class CoefficientLanes {
 public:
  explicit CoefficientLanes(const DynArray<Aggregate<double>>& table)
      : table_(table), lanes_(broadcast<Aggregate, Real>(table[0])) {}

  /// `kinds`: index in the coefficient table for each lane.
  SILT_INLINE void choose(const std::uint16_t* kinds) {
    unsigned other = 0;
    for (std::size_t lane = 0; lane < width; ++lane) other |= kinds[lane] ^ uniform_;
    if (other != 0) gather(kinds);
  }
  const Aggregate<Real>& operator()() const { return lanes_; }

 private:
  using Scalar = ScalarOf<Real>;
  static constexpr std::size_t width = sizeof(Real) / sizeof(Scalar);
  static constexpr unsigned none = 1u << 16;

  void gather(const std::uint16_t* kinds) {
    constexpr std::size_t n = sizeof(Aggregate<double>) / sizeof(double);
    alignas(Real) Scalar lanes[n][width];
    uniform_ = kinds[0];
    for (std::size_t lane = 0; lane < width; ++lane) {
      const auto values = std::bit_cast<std::array<double, n>>(table_[kinds[lane]]);
      for (std::size_t k = 0; k < n; ++k) lanes[k][lane] = static_cast<Scalar>(values[k]);
      if (kinds[lane] != kinds[0]) uniform_ = none;
    }
    std::array<Real, n> reals;
    for (std::size_t k = 0; k < n; ++k) reals[k] = load<Real>(lanes[k]);
    lanes_ = std::bit_cast<Aggregate<Real>>(reals);
  }

  const DynArray<Aggregate<double>>& table_;
  Aggregate<Real> lanes_;
  unsigned uniform_ = 0;  // index common to all lanes, if there is one
};

/// Coefficients of the law and the rolling model for successive packs of contacts.
template <class ContactsType, class Real>
class ContactCoefficients {
  struct NoRollingLanes {
    explicit NoRollingLanes(const DynArray<typename ContactsType::RollingCoefficients>&) {}
    typename ContactsType::Rolling::template Coefficients<Real> operator()() const { return {}; }
    void choose(const std::uint16_t*) {}
  };
  template <class Rolling, bool Rolls>
  struct RollingLanes {
    using type = NoRollingLanes;
  };
  template <class Rolling>
  struct RollingLanes<Rolling, true> {
    using type = CoefficientLanes<Rolling::template Coefficients, Real>;
  };

 public:
  CoefficientLanes<ContactsType::Law::template Coefficients, Real> law;
  typename RollingLanes<typename ContactsType::Rolling, ContactsType::has_rolling>::type rolling;

  explicit ContactCoefficients(const CoefficientTable<ContactsType>& table)
      : law(table.law), rolling(table.rolling) {}
  SILT_INLINE void choose(const std::uint16_t* kinds) { law.choose(kinds), rolling.choose(kinds); }
};

}  // namespace silt::detail
