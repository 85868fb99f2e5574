// silt - BSD-3-Clause, see LICENSE
#include <bit>
#include <concepts>
#include <type_traits>

#include <silt/contact/jkr.hpp>
#include <silt/core/functions.hpp>
#include <silt/core/powers.hpp>

#include <doctest/doctest.h>

// What the probe must not take is in tests/compile/refused/; here is what it must.
namespace probe_test {

namespace {

using silt::detail::ProbeLane, silt::detail::ProbeMask;

/// All that a law may write.
template <class Real>
Real everything(const Real& x, bool flag) {
  Real y = 2 * x + 1.5f - x / 3.0 + Real(4) * -x;
  y += 1, y -= x, y *= 2.0, y /= x;
  const auto both = x > 0 && y <= x, either = x >= 1.0 || !(x != y), mixed = (x < 1) == (y < 1);
  auto mask = both & either;
  mask = mask | mixed;
  y = silt::select(mask, y, 0.0);
  y = silt::min(silt::max(y, 1e-3), 1e9) + silt::sqrt(silt::abs(y));
  y = silt::multiply_add(x, y, y) + silt::cube_root(y) + silt::hyperbolic_tangent(x);
  y += silt::power(y, 1.5) + silt::exponential(-x) + silt::natural_log(y) + silt::arc_tangent(x);
  y += silt::cosine(x) + silt::rough_exp2(silt::rough_log2(y)) + silt::one_minus_exponential(x);
  const silt::Vec3<Real> v = flag ? silt::Vec3<Real>{x, y, Real(0)} : silt::Vec3<Real>{y, x, y};
  const silt::Vec3<Real> w = silt::select(x < y, v, 2.0 * v);
  while (silt::any(y > 1e30)) y = 0.5 * y;  // of all lanes together: a bool
  return dot(v, w) + silt::smallest<Real>();
}

}  // namespace

TEST_CASE("probe: takes what a law may write, as a double and a pack do") {
  CHECK(everything(0.5, true) > 0);
  using Pack = silt::Lanes<silt::DefaultArch>::Real;
  alignas(64) double of_pack[silt::Lanes<silt::DefaultArch>::width];
  silt::store(of_pack, everything(Pack(0.5), true));
  CHECK(of_pack[0] == doctest::Approx(everything(0.5, true)).epsilon(1e-14));
  static_assert(std::same_as<decltype(everything(ProbeLane(), true)), ProbeLane>);
  everything(ProbeLane(1), true);
  static_assert(std::same_as<silt::Mask<ProbeLane>, ProbeMask>);
  static_assert(std::same_as<silt::ScalarOf<ProbeLane>, double>);
}

constexpr double three = 3;

TEST_CASE("probe: is stored as a double, so that histories of it are arrays of Reals") {
  static_assert(sizeof(ProbeLane) == sizeof(double) && std::is_trivially_copyable_v<ProbeLane>);
  static_assert(sizeof(silt::Jkr::History<ProbeLane>) == sizeof(silt::Jkr::History<double>));
  CHECK(std::bit_cast<double>(ProbeLane::load_aligned(&three)) == 3);
}

}  // namespace probe_test
