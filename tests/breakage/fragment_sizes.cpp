// silt - BSD-3-Clause, see LICENSE
// Fragments of an event: exact mass, the mean distribution against the breakage function, limits.
//   a stock that is emptied too early (coarse fragments too often), sizes at the classes' middles,
//   a rest that is forgotten or counted twice, dust spread as if `most` had not cut
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include <doctest/doctest.h>

#include <silt/breakage/fragment_sizes.hpp>
#include <silt/breakage/sizes.hpp>
#include <silt/breakage/t10_sizes.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace breakage_fragment_sizes_test {

using silt::Broken, silt::FragmentLimits, silt::LoadUnit;
constexpr double d = 2e-3, density = 2500, per_volume = density * std::numbers::pi / 6;
constexpr std::size_t all = 1'000'000;

Broken parent_with(double load) { return {d, per_volume * d * d * d, 1, load, 20}; }

struct Found {
  double deviation = 0;  // [-] largest of the mean share below x from B(x), over x
  double sigma = 0;      // [-] its standard deviation there
};

/// The mean of many events against `function`; each is checked by itself.
template <class Function>
Found found(const Function& function, double load, double least) {
  const int events = least < 0.08 ? 2000 : 20000;  // of some hundred fragments each, or some ten
  const int points = 100;
  const auto parent = parent_with(load);
  silt::Random random(7);
  std::vector<double> sum(points + 1), squares(points + 1), coarser(points + 1);
  bool whole = true, ordered = true;
  for (int event = 0; event < events; ++event) {
    const auto sizes = silt::fragment_sizes(function, parent, density, {least * d, all}, random);
    const double mass = std::accumulate(sizes.masses.begin(), sizes.masses.end(), sizes.dust);
    whole =
        whole && std::abs(mass / parent.mass - 1) < 1e-14 * (10.0 + double(sizes.masses.size()));
    std::fill(coarser.begin(), coarser.end(), 0.0);
    double before = parent.mass;
    for (const double m : sizes.masses) {
      const double x = std::cbrt(m / per_volume) / d;
      ordered = ordered && m <= before && x > least * (1 - 1e-14);
      before = m;
      const double at = std::clamp((x - least) / (1 - least) * points, 0.0, double(points));
      coarser[static_cast<std::size_t>(at)] += m / parent.mass;
    }
    for (int k = points - 1; k >= 0; --k) coarser[k] += coarser[k + 1];
    for (int k = 0; k <= points; ++k) {
      sum[k] += coarser[k] / events;
      squares[k] += coarser[k] * coarser[k] / events;
    }
  }
  CHECK(whole);
  CHECK(ordered);
  Found worst;
  for (int k = 0; k <= points; ++k) {
    const double x = (least + (1 - least) * k / points) * d;
    const double deviation = 1 - sum[k] - function.finer(x, parent);
    if (std::abs(deviation) <= std::abs(worst.deviation)) continue;
    worst = {deviation, std::sqrt(std::max(squares[k] - sum[k] * sum[k], 0.0) / events)};
  }
  return worst;
}

TEST_CASE("fragment_sizes: the mean of 20 000 events is the breakage function, to 4 sigma") {
  // Fragments that fit at all times: no bias. 4 sigma, and the classes' 0.1 %.
  const auto unbiased = [](const auto& function) {
    for (const double least : {0.05, 0.1, 0.3}) {
      const auto worst = found(function, 20, least);
      CHECK_MESSAGE(std::abs(worst.deviation) < 4 * worst.sigma + 1e-3, worst.deviation,
                    " of sigma ", worst.sigma, " at dust_below/d ", least);
      CHECK(std::abs(worst.deviation) < (least < 0.08 ? 0.025 : 0.009));
    }
  };
  for (const double q : {0.5, 1.0, 1.5}) {
    unbiased(silt::GaudinSchuhmann{q, 0.9});
    unbiased(silt::GaudinSchuhmann{q, 0.5});
  }
  unbiased(silt::GaudinSchuhmann{1.5, 0.9, 0.1});
  unbiased(silt::GaudinSchuhmann{3, 0.8});
  unbiased(silt::T10Sizes{0.677, 0.029, LoadUnit::Energy});
}

TEST_CASE("fragment_sizes: fragments as large as the parent, the header's bias to 4 sigma") {
  // What does not fit beside a large fragment is made finer.
  const auto biased = [](const auto& function, double load, double bias) {
    for (const double least : {0.1, 0.3}) {
      const auto worst = found(function, load, least);
      CHECK_MESSAGE(std::abs(worst.deviation) < bias + 4 * worst.sigma, worst.deviation,
                    " of sigma ", worst.sigma, " at dust_below/d ", least);
    }
  };
  biased(silt::RosinRammler{0.3, 1}, 2, 0.0016);
  biased(silt::RosinRammler{0.7, 1.5}, 2, 0.003);
  biased(silt::GaudinSchuhmann{1, 1}, 2, 0.003);
  biased(silt::VogelPeukertSizes{0.005, 0.6, 4e-5}, 2, 0.003);
  biased(silt::GaudinSchuhmann{1.5, 1}, 2, 0.008);
  biased(silt::T10Sizes{0.677, 0.029, LoadUnit::Energy}, 2, 0.008);
  biased(silt::Austin{0.5, 4, 0.8}, 2, 0.008);
  biased(silt::Austin{0.3, 5, 0.6}, 2, 0.008);
  biased(silt::GaudinSchuhmann{2.5, 1}, 2, 0.017);
  biased(silt::Austin{0, 4, 1}, 2, 0.0265);
}

TEST_CASE("fragment_sizes: at `most` fragments the largest are kept, all others are dust") {
  const silt::GaudinSchuhmann function{0.8, 0.9};
  const auto parent = parent_with(2);
  for (const std::size_t most : {1, 2, 5, 12}) {
    silt::Random random(3), same(3);
    double cut = 0, top = 0;
    for (int event = 0; event < 300; ++event) {
      // The draws are the same as far as they go.
      const silt::Random::State before = random.state();
      silt::Random again(before);
      const auto whole = silt::fragment_sizes(function, parent, density, {0.1 * d, all}, random);
      const auto some = silt::fragment_sizes(function, parent, density, {0.1 * d, most}, again);
      const std::size_t count = std::min(most, whole.masses.size());
      REQUIRE(some.masses.size() == count);
      CHECK(std::equal(some.masses.begin(), some.masses.end(), whole.masses.begin()));
      const double kept = std::accumulate(some.masses.begin(), some.masses.end(), 0.0);
      CHECK(some.dust == near(parent.mass - kept).epsilon(1e-12));
      CHECK(whole.dust_largest == 0.1 * d);
      CHECK(some.dust_largest >= 0.1 * d);
      cut += whole.masses.size() > most;
      // Up to where it has drawn: above the next fragment, and at most some draw's width below.
      if (whole.masses.size() > most) {
        const double next = std::cbrt(whole.masses[most] / per_volume);
        top += some.dust_largest >= next * (1 - 1e-12);
        CHECK(some.dust_largest <= std::cbrt(some.masses.back() / per_volume) * (1 + 1e-12));
      }
    }
    CHECK(cut > 250);
    CHECK(top == cut);
  }
}

TEST_CASE("fragment_sizes: limits that leave one fragment, none, or dust alone") {
  silt::Random random(1);
  const auto parent = parent_with(2);
  const silt::GaudinSchuhmann half{1, 0.5};
  for (const double least : {0.5 * d, 0.7 * d, 3 * d}) {
    const auto sizes = silt::fragment_sizes(half, parent, density, {least, all}, random);
    CHECK(sizes.masses.empty());
    CHECK(sizes.dust == parent.mass);
    CHECK(sizes.dust_largest == least);
  }
  // Just below the largest: hardly ever a fragment, none heavier than half a diameter cubed.
  std::size_t fragments = 0;
  for (int event = 0; event < 1000; ++event) {
    const auto sizes = silt::fragment_sizes(half, parent, density, {0.499 * d, all}, random);
    fragments += sizes.masses.size();
    for (const double m : sizes.masses) CHECK(m <= parent.mass / 8 * (1 + 1e-12));
  }
  // dB/m = 0.002 x 8 for each event
  CHECK(std::abs(static_cast<double>(fragments) - 16) < 3 * 4 + 1);
  // The same numbers give the same fragments.
  silt::Random a(5), b(5);
  const auto one = silt::fragment_sizes(half, parent, density, {0.05 * d, all}, a),
             two = silt::fragment_sizes(half, parent, density, {0.05 * d, all}, b);
  CHECK(one.masses == two.masses);
  CHECK(a.state() == b.state());
}

TEST_CASE("dust: its shares follow the breakage function below its largest size; a table has all") {
  const silt::GaudinSchuhmann function{0.7, 0.9};
  const auto parent = parent_with(2);
  const silt::FragmentSizes dust{{}, 3e-6, 0.1 * d};
  const std::vector<double> edges{1e-5, 5e-5, 1e-4, 5e-4};
  const auto shares = silt::dust_shares(function, parent, dust, edges);
  REQUIRE(shares.size() == 3);
  CHECK(shares[0] == near(std::pow(0.25, 0.7)).epsilon(1e-13));  // all below 50 um of 200 um
  CHECK(shares[1] == near(std::pow(0.5, 0.7) - std::pow(0.25, 0.7)).epsilon(1e-13));
  CHECK(shares[2] == near(1 - std::pow(0.5, 0.7)).epsilon(1e-13));
  silt::SizeTable table;
  silt::add_dust(table, function, parent, dust, density, 0.5);
  CHECK(table.mass() == near(3e-6).epsilon(1e-14));
  for (const std::size_t k : {1, 5, 10, 14})
    CHECK(table.finer(silt::SizeTable::edge(k)) ==
          near(std::pow(silt::SizeTable::edge(k) / (0.1 * d), 0.7)).epsilon(1e-12));
  CHECK(table.mass(5) / table.number(5) ==
        near(per_volume * std::pow(30e-12, 1.5)).epsilon(1e-12));  // sqrt(5 x 6) um
  // Dust that ends at an edge, and dust of a parent whose fragments are all larger.
  for (const double top : {1e-5, 2e-5, 0.9e-6}) {
    silt::SizeTable one;
    silt::add_dust(one, function, parent, {{}, 1e-9, top}, density, 0);
    CHECK(one.mass() == near(1e-9).epsilon(1e-14));
    CHECK(one.classes() <= silt::SizeTable::class_of(top) + 1);
  }
  struct Two {  // nothing below half the parent
    double finer(double x, const Broken& b) const { return x >= 0.5 * b.diameter ? 1 : 0; }
    double largest(const Broken& b) const { return b.diameter; }
    void check() const {}
  };
  CHECK(silt::dust_shares(Two{}, parent, dust, edges).back() == 1);
}

TEST_CASE("fragment_sizes: refusals name field, value and unit") {
  using silt_test::has, silt_test::refusal;
  silt::Random random(1);
  const silt::GaudinSchuhmann function{0.8, 0.9};
  const auto says = [&](Broken parent, double rho, FragmentLimits limits, const char* words) {
    has(refusal([&] { silt::fragment_sizes(function, parent, rho, limits, random); }), words);
  };
  const auto parent = parent_with(2);
  says(parent, density, {0, 12}, "FragmentLimits.dust_below = 0 [m]");
  says(parent, density, {1e-4, 0}, "FragmentLimits.most = 0 [-] must be at least 1");
  says(parent, 0, {1e-4, 12}, "fragment_sizes: density = 0 [kg/m3]");
  auto light = parent;
  light.mass = 0;
  says(light, density, {1e-4, 12}, "fragment_sizes: the parent's mass = 0 [kg]");
  const auto shares = [&](const std::vector<double>& edges) {
    has(refusal([&] {
          silt::dust_shares(function, parent, {{}, 1, 1e-4}, edges);
        }),
        "edges must be two or more, and ascend");
  };
  shares({1e-5}), shares({1e-5, 1e-5}), shares({2e-5, 1e-5});
}

}  // namespace breakage_fragment_sizes_test
