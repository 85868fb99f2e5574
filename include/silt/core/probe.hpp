// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>
#include <cstddef>
#include <type_traits>

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Type that stands for a pack of lanes while a law is checked: it has the functions of
/// core/lanes.hpp and computes nothing. Simulation and CoupledFlow instantiate every law once with
/// it (engine/contact/ask_on_lanes.hpp, coupling/drag/concept.hpp). Code that works only for a
/// single double is thereby refused with a clear message on every instruction set. Without it
/// AVX-512 would accept `if (f < 0)`: its masks are integers, and one lane would decide for all.
/// Tests:   tests/core/probe.cpp, tests/compile/refused/.
class ProbeMask {
  template <class T>
  static constexpr bool is_refused = std::is_void_v<T>;

 public:
  ProbeMask() = default;
  ProbeMask(bool) {}

  template <class T>
  requires std::same_as<T, bool>
  operator T() const {
    static_assert(is_refused<T>,
                  "a comparison of Real is one truth value a lane, not a bool: in place of if, "
                  "while, ?:, std::min and std::max write silt::select(condition, a, b), "
                  "silt::min and silt::max");
    return {};
  }

  // Operators of masks and bool; with a bool on the left neither packs nor the probe have them.
  friend ProbeMask operator!(ProbeMask) { return {}; }
  friend ProbeMask operator==(ProbeMask, ProbeMask) { return {}; }
  friend ProbeMask operator!=(ProbeMask, ProbeMask) { return {}; }
  ProbeMask operator&(ProbeMask) const { return {}; }
  ProbeMask operator|(ProbeMask) const { return {}; }
  ProbeMask operator^(ProbeMask) const { return {}; }
  ProbeMask operator&&(ProbeMask) const { return {}; }
  ProbeMask operator||(ProbeMask) const { return {}; }
  ProbeMask& operator&=(ProbeMask) { return *this; }
  ProbeMask& operator|=(ProbeMask) { return *this; }
  ProbeMask& operator^=(ProbeMask) { return *this; }
  template <std::same_as<ProbeMask> M>
  friend M operator~(M mask) {
    static_assert(is_refused<M>, "write ! in place of ~: of a bool, ~ is true whatever it is");
    return mask;
  }

  friend bool any(ProbeMask) { return false; }
  friend bool all(ProbeMask) { return false; }
  friend bool none(ProbeMask) { return false; }
};

class ProbeLane {
  template <class T>
  static constexpr bool is_refused = std::is_void_v<T>;
  template <class A, class B>
  static constexpr bool has_one = (std::same_as<A, ProbeLane> &&
                                   (std::same_as<B, ProbeLane> || std::is_arithmetic_v<B>)) ||
                                  (std::is_arithmetic_v<A> && std::same_as<B, ProbeLane>);

 public:
  using value_type = double;
  static constexpr std::size_t size = 1;

  ProbeLane() = default;
  template <class T>
  requires std::is_arithmetic_v<T> ProbeLane(T x) : value_(static_cast<double>(x)) {}

  /// Converts implicitly only to double, which makes overloads such as std::sqrt unambiguous.
  template <class T>
  requires std::same_as<T, double>
  operator T() const { return refuse<T>(); }
  template <class T>
  requires(std::is_arithmetic_v<T> && !std::same_as<T, double>) explicit operator T() const {
    return refuse<T>();
  }

  friend ProbeLane operator-(ProbeLane a) { return a; }
  friend ProbeLane operator+(ProbeLane a) { return a; }
  template <class A, class B>
  requires(has_one<A, B>) friend ProbeLane operator+(const A&, const B&) { return {}; }
  template <class A, class B>
  requires(has_one<A, B>) friend ProbeLane operator-(const A&, const B&) { return {}; }
  template <class A, class B>
  requires(has_one<A, B>) friend ProbeLane operator*(const A&, const B&) { return {}; }
  template <std::same_as<ProbeMask> M>
  friend ProbeLane operator*(M mask, const ProbeLane&) {
    return ProbeLane(bool(mask));
  }
  template <std::same_as<ProbeMask> M>
  friend ProbeLane operator*(const ProbeLane&, M mask) {
    return ProbeLane(bool(mask));
  }
  template <class A, class B>
  requires(has_one<A, B>) friend ProbeLane operator/(const A&, const B&) { return {}; }
  template <class A, class B>
  requires(has_one<A, B>) friend ProbeMask operator<(const A&, const B&) { return {}; }
  template <class A, class B>
  requires(has_one<A, B>) friend ProbeMask operator>(const A&, const B&) { return {}; }
  template <class A, class B>
  requires(has_one<A, B>) friend ProbeMask operator<=(const A&, const B&) { return {}; }
  template <class A, class B>
  requires(has_one<A, B>) friend ProbeMask operator>=(const A&, const B&) { return {}; }
  template <class A, class B>
  requires(has_one<A, B>) friend ProbeMask operator==(const A&, const B&) { return {}; }
  template <class A, class B>
  requires(has_one<A, B>) friend ProbeMask operator!=(const A&, const B&) { return {}; }
  ProbeLane& operator+=(ProbeLane) { return *this; }
  ProbeLane& operator-=(ProbeLane) { return *this; }
  ProbeLane& operator*=(ProbeLane) { return *this; }
  ProbeLane& operator/=(ProbeLane) { return *this; }

  // Functions that core/lanes.hpp takes from xsimd, found by argument-dependent lookup.
  friend ProbeLane select(ProbeMask, ProbeLane a, ProbeLane) { return a; }
  friend ProbeLane min(ProbeLane a, ProbeLane) { return a; }
  friend ProbeLane max(ProbeLane a, ProbeLane) { return a; }
  friend ProbeLane fmin(ProbeLane a, ProbeLane) { return a; }
  friend ProbeLane fmax(ProbeLane a, ProbeLane) { return a; }
  friend ProbeLane pow(ProbeLane a, ProbeLane) { return a; }
  friend ProbeLane hypot(ProbeLane a, ProbeLane) { return a; }
  friend ProbeLane atan2(ProbeLane a, ProbeLane) { return a; }
  friend ProbeLane fma(ProbeLane a, ProbeLane, ProbeLane) { return a; }
  friend ProbeLane sqrt(ProbeLane a) { return a; }
  friend ProbeLane cbrt(ProbeLane a) { return a; }
  friend ProbeLane abs(ProbeLane a) { return a; }
  friend ProbeLane fabs(ProbeLane a) { return a; }
  friend ProbeLane exp(ProbeLane a) { return a; }
  friend ProbeLane exp2(ProbeLane a) { return a; }
  friend ProbeLane expm1(ProbeLane a) { return a; }
  friend ProbeLane log(ProbeLane a) { return a; }
  friend ProbeLane log2(ProbeLane a) { return a; }
  friend ProbeLane log10(ProbeLane a) { return a; }
  friend ProbeLane log1p(ProbeLane a) { return a; }
  friend ProbeLane sin(ProbeLane a) { return a; }
  friend ProbeLane cos(ProbeLane a) { return a; }
  friend ProbeLane tan(ProbeLane a) { return a; }
  friend ProbeLane asin(ProbeLane a) { return a; }
  friend ProbeLane acos(ProbeLane a) { return a; }
  friend ProbeLane atan(ProbeLane a) { return a; }
  friend ProbeLane tanh(ProbeLane a) { return a; }
  friend ProbeLane floor(ProbeLane a) { return a; }
  friend ProbeLane ceil(ProbeLane a) { return a; }
  static ProbeLane load_aligned(const double* p) { return ProbeLane(*p); }
  static ProbeLane load_unaligned(const double* p) { return ProbeLane(*p); }
  void store_aligned(double* p) const { *p = value_; }
  void store_unaligned(double* p) const { *p = value_; }
  double get(std::size_t) const { return value_; }

 private:
  template <class T>
  static T refuse() {
    static_assert(is_refused<T>,
                  "Real is a pack of lanes, not a double: keep results in Real, and in place of "
                  "std:: functions write silt::sqrt, silt::abs, silt::min, silt::max, "
                  "silt::select and those of silt/core/functions.hpp and silt/core/powers.hpp "
                  "(also found without silt::, as sqrt(x))");
    return {};
  }
  double value_;
};

}  // namespace silt::inline SILT_TARGET::detail
