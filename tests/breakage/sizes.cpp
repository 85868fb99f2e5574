// silt - BSD-3-Clause, see LICENSE
// Breakage functions: values by hand, ends, monotony; what would create mass is refused.
//   exponents of fine and coarse exchanged, a truncation that loses mass, forces taken for energies
#include <cmath>
#include <limits>

#include <doctest/doctest.h>

#include <silt/breakage/sizes.hpp>
#include <silt/breakage/t10_sizes.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace breakage_sizes_test {

using silt::Broken, silt::LoadUnit;
constexpr double nan = std::numeric_limits<double>::quiet_NaN(), d = 2e-3;
constexpr Broken parent{.diameter = d, .mass = 1e-5, .strength = 10, .load = 20, .speed = 30};
const silt::T10Sizes t10{.limit = 0.677, .rate = 0.029, .unit = LoadUnit::Energy};

TEST_CASE("breakage functions: shares by hand, to 1e-14") {
  CHECK(silt::GaudinSchuhmann{1.5, 0.8}.finer(0.4 * d, parent) ==
        near(std::pow(0.5, 1.5)).epsilon(1e-14));
  // Twice the load, half the largest fragment.
  const silt::GaudinSchuhmann refined{1, 0.8, 1};
  CHECK(refined.largest(parent) == near(0.4 * d).epsilon(1e-14));
  CHECK(refined.finer(0.2 * d, parent) == near(0.5).epsilon(1e-14));
  CHECK(silt::RosinRammler{0.5, 2}.finer(0.5 * d, parent) ==
        near((1 - std::exp(-1)) / (1 - std::exp(-4))).epsilon(1e-14));
  CHECK(silt::Austin{.share = 0.4, .coarse_exponent = 4, .fine_exponent = 1}.finer(
            0.5 * d, parent) == near(0.4 * 0.5 + 0.6 / 16).epsilon(1e-14));
  // q = 0.01 x 30 + 0.5; x = x0 halves the power law.
  const silt::VogelPeukertSizes vogel{.per_speed = 0.01, .exponent = 0.5, .finest = 0.01 * d};
  CHECK(vogel.finer(0.01 * d, parent) == near(std::pow(0.01, 0.8) / 2).epsilon(1e-14));
  CHECK(vogel.finer(0.2 * d, parent) == near(std::pow(0.2, 0.8)).epsilon(1e-14));
}

TEST_CASE("breakage functions: from 0 to 1 without a fall, over sizes, loads and speeds") {
  const auto probe = [](const auto& function) {
    function.check();
    for (const double load : {10.0, 30.0, 200.0, 2000.0})
      silt::check_sizes(function, {d, 1e-5, 10, load, load});
  };
  for (const double q : {0.3, 0.8, 1.5, 4.0}) {
    probe(silt::GaudinSchuhmann{q, 0.9, 0.5});
    probe(silt::RosinRammler{0.3, q});
    probe(silt::Austin{0.5, 5, q});
    probe(silt::VogelPeukertSizes{0.003, q, 3e-5});
  }
  probe(t10);
}

TEST_CASE("T10Sizes: t10 by hand, t_n at d/n, powers between, forces by F^(5/3)") {
  const double t = 0.677 * (1 - std::exp(-0.029 * 2));
  CHECK(t10.t10(parent) == near(t).epsilon(1e-13));
  CHECK(t10.finer(d / 10, parent) == near(t).epsilon(1e-13));
  for (const auto& [n, alpha, beta] : t10.shares)
    CHECK(t10.finer(d / n, parent) ==
          near(silt::detail::incomplete_beta(t, alpha, beta)).epsilon(1e-12));
  const double t2 = t10.finer(d / 2, parent), t4 = t10.finer(d / 4, parent);
  CHECK(t10.finer(d / std::sqrt(8.0), parent) == near(std::sqrt(t2 * t4)).epsilon(1e-12));
  const double t75 = t10.finer(d / 75, parent), t50 = t10.finer(d / 50, parent);
  CHECK(t10.finer(d / 112.5, parent) == near(t75 * t75 / t50).epsilon(1e-12));
  auto forces = t10;
  forces.unit = LoadUnit::Force;
  CHECK(forces.t10(parent) ==
        near(0.677 * (1 - std::exp(-0.029 * std::pow(2, 5.0 / 3)))).epsilon(1e-13));
}

TEST_CASE("incomplete beta function: closed forms and symmetry, to 1e-13") {
  using silt::detail::incomplete_beta;
  for (const double x : {1e-6, 0.01, 0.3, 0.5, 0.8, 0.999}) {
    CHECK(incomplete_beta(x, 1, 1) == near(x).epsilon(1e-13));
    CHECK(incomplete_beta(x, 1, 3.5) == near(-std::expm1(3.5 * std::log1p(-x))).epsilon(1e-13));
    CHECK(incomplete_beta(x, 2.5, 1) == near(std::pow(x, 2.5)).epsilon(1e-13));
    CHECK(incomplete_beta(x, 2, 3) == near(x * x * (6 - 8 * x + 3 * x * x)).epsilon(1e-13));
    CHECK(incomplete_beta(x, 0.5, 0.5) ==
          near(2 / std::acos(-1.0) * std::asin(std::sqrt(x))).epsilon(1e-13));
    for (const double b : {0.3, 8.0, 40.0})
      CHECK(incomplete_beta(x, 1.7, b) + incomplete_beta(1 - x, b, 1.7) == near(1).epsilon(1e-13));
  }
  CHECK(incomplete_beta(0, 2, 3) == 0);
  CHECK(incomplete_beta(1, 2, 3) == 1);
}

/// A breakage function as wrong as a test wants it.
template <class F>
struct Own {
  F share;  // of x/d
  double most = 1;
  double finer(double x, const Broken& b) const { return share(x / b.diameter); }
  double largest(const Broken& b) const { return most * b.diameter; }
  void check() const {}
};

TEST_CASE("check_sizes: refuses what creates or loses mass") {
  const auto says = [](auto share, double most, const char* words) {
    const Own<decltype(share)> own{share, most};
    silt_test::has(silt_test::refusal([&] { silt::check_sizes(own, parent); }), words);
  };
  const auto capped = [](double x) { return std::min(x, 1.0); };
  says(capped, 1, "nothing was refused");
  says(capped, 1.1, "largest() = 0.0022 [m] must be greater than 0 and no more than the parent's");
  says(capped, 0, "largest() = 0 [m]");
  says(capped, 0.8, "must be 1 from largest() = 0.0016 [m] on: otherwise mass is lost");
  says([](double x) { return std::min(1.0, 0.1 + x); }, 1, "finer(0) = 0.1 [-] must be 0");
  says([](double x) { return 1.1 * std::min(x, 1.0); }, 1, "must be in [0, 1]");
  says([](double x) { return x >= 1 ? 1 : 4 * x * (1 - x); }, 1, "finer() must not decrease");
  says([](double x) { return x > 0 ? nan : 0.0; }, 1, "= nan [-] of a parent of 0.002 [m]");
}

TEST_CASE("breakage functions: refusals name field, value and unit") {
  using silt_test::has, silt_test::refusal;
  const auto says = [](const auto& law, const char* words) {
    has(refusal([&] { law.check(); }), words);
  };
  says(silt::GaudinSchuhmann{0, 0.8}, "GaudinSchuhmann.exponent = 0 [-]");
  says(silt::GaudinSchuhmann{1, 1.1}, "GaudinSchuhmann.coarsest = 1.1 [-] must be in (0, 1]");
  says(silt::GaudinSchuhmann{1, 0.8, -1}, "GaudinSchuhmann.refining = -1 [-]");
  says(silt::RosinRammler{0, 1}, "RosinRammler.characteristic = 0 [-]");
  says(silt::RosinRammler{0.5, -1}, "RosinRammler.exponent = -1 [-]");
  says(silt::Austin{1.5, 4, 1}, "Austin.share = 1.5 [-] must be in [0, 1]");
  says(silt::Austin{0.5, 4, 0}, "Austin.fine_exponent = 0 [-]");
  says(silt::Austin{0.5, 1, 2}, "Austin.coarse_exponent = 1 [-] must be finite and not below");
  says(silt::VogelPeukertSizes{-1, 1, 1}, "VogelPeukertSizes.per_speed = -1 [s/m]");
  says(silt::VogelPeukertSizes{0, 0, 1}, "VogelPeukertSizes.exponent = 0 [-]");
  says(silt::VogelPeukertSizes{0, 1, 0}, "VogelPeukertSizes.finest = 0 [m]");
  auto own = t10;
  own.limit = 1.2;
  says(own, "T10Sizes.limit = 1.2 [-] must be in (0, 1]");
  own = t10, own.rate = 0;
  says(own, "T10Sizes.rate = 0 [-]");
  own = t10, own.shares[2].n = 1.4;
  says(own, "T10Sizes.shares[2].n = 1.4 [-] must be greater than 1.5 and less than 10");
  own = t10, own.shares[4].n = 9;
  says(own, "T10Sizes.shares[4].n = 9 [-] must be greater than 10");
  own = t10, own.shares[0].alpha = 0;
  says(own, "T10Sizes.shares[0].alpha = 0 [-] must be in (0, 40]");
  own = t10, own.shares[6].beta = 41;
  says(own, "T10Sizes.shares[6].beta = 41 [-] must be in (0, 40]");
  // Fits that cross: more mass below d/4 than below d/2.
  own = t10, std::swap(own.shares[2].beta, own.shares[3].beta);
  has(refusal([&] { silt::check_sizes(own, parent); }), "finer() must not decrease");
}

}  // namespace breakage_sizes_test
