// silt - BSD-3-Clause, see LICENSE
// Tables of sizes over time: classes, sums, quantiles, intervals that double, restored states.
//   a size in the class beside, classes read as linear in x, sums that lose digits, mass that is
//   lost as intervals merge
#include <cmath>
#include <limits>

#include <doctest/doctest.h>

#include <silt/breakage/size_table.hpp>
#include <silt/breakage/t10_sizes.hpp>
#include <silt/core/random.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace breakage_size_table_test {

using silt::SizeTable;
constexpr double um = 1e-6;

TEST_CASE(
    "SizeTable: a size that is an edge begins its class, the one below ends the class before") {
  CHECK(SizeTable::edge(0) == 0);
  CHECK(SizeTable::edge(7) == 7e-6);
  CHECK(SizeTable::edge(10) == 1e-5);
  CHECK(SizeTable::edge(11) == near(10 * std::sqrt(2) * um).epsilon(1e-15));
  CHECK(SizeTable::edge(12) == 2e-5);
  CHECK(SizeTable::edge(50) == near(10 * um * std::pow(2, 20)).epsilon(1e-15));
  for (std::size_t k = 1; k < 120; ++k) {
    CHECK(SizeTable::class_of(SizeTable::edge(k)) == k);
    CHECK(SizeTable::class_of(std::nextafter(SizeTable::edge(k), 0)) == k - 1);
  }
  CHECK(SizeTable::class_of(1e-12) == 0);
}

TEST_CASE("SizeTable: sums of 10 million additions, to 1e-12; of grains beside a whole kilogram") {
  SizeTable table(1e-3);
  long double fed = 0, count = 0, grains = 0;
  silt::Random random(3);
  table.add(5.5 * um, 1, 1, 0);  // plain sums would lose all that follows in this class
  for (int k = 0; k < 10'000'000; ++k) {
    const double u = random.uniform(), d = 0.3 * um + 40 * um * u, mass = d * d * d * 1e3;
    const bool small = k % 2 == 0;
    table.add(small ? 5.5 * um : d, small ? 1e-16 * u : mass, 1 + u, 1e-6 * k);
    (small ? grains : fed) += small ? 1e-16 * u : mass;
    count += 1 + u;
  }
  const double mass = static_cast<double>(1 + (fed + grains));
  CHECK(table.mass() == near(mass).epsilon(1e-15));
  CHECK(table.number() == near(static_cast<double>(count + 1)).epsilon(1e-12));
  double in_time = 0;
  for (std::size_t k = 0; k < table.classes(); ++k)
    for (std::size_t bin = 0; bin < table.bins(); ++bin) in_time += table.mass(k, bin);
  CHECK(in_time == near(mass).epsilon(1e-14));
  // 10 s in 64 intervals of 1 ms that double.
  CHECK(table.bin_width() == near(0.256).epsilon(1e-14));
  CHECK(table.bins() == 40);
}

TEST_CASE("SizeTable: finer() is exact at edges and within 2 % inside a class") {
  const silt::T10Sizes t10{.limit = 0.677, .rate = 0.029, .unit = silt::LoadUnit::Energy};
  const silt::Broken parent{.diameter = 5e-3, .mass = 1, .strength = 1, .load = 20, .speed = 10};
  const auto worst = [](const auto& finer) {
    SizeTable table;
    double below = 0, most = 0;
    const int parts = 20000;
    for (int k = 0; k < parts; ++k) {
      const double a = 5e-3 * std::exp(-6.0 * (parts - k) / parts), b = a * std::exp(6.0 / parts);
      table.add(std::sqrt(a * b), finer(b) - below, 1, 0), below = finer(b);
    }
    for (std::size_t k = 20; SizeTable::edge(k) < 5e-3; ++k)
      CHECK(table.finer(SizeTable::edge(k)) == near(finer(SizeTable::edge(k))).epsilon(5e-4));
    for (double x = 1e-4; x < 4.9e-3; x *= 1.01) {
      CHECK(table.finer(x) > 0.99 * finer(x));  // at the kink at d/1.2
      most = std::max(most, table.finer(x) / finer(x) - 1);
    }
    return most;
  };
  // The kink at d/10. Linear in x it would be 1 % there, and nothing for a share that goes as x.
  const double kink = worst([&](double x) { return t10.finer(x, parent); });
  CHECK(kink > 0.018);
  CHECK(kink < 0.022);
  // (1 + (sqrt(2) - 1)/2)/2^(1/4) = 1.0150 in the middle of a class.
  CHECK(worst([](double x) { return x / 5e-3; }) == near(0.0150).epsilon(0.03));
}

TEST_CASE("SizeTable: intervals double and keep what came when") {
  SizeTable table(1);
  for (int second = 0; second < 100; ++second) table.add(5.5 * um, second + 1, 1, second + 0.5);
  CHECK(table.bin_width() == 2);
  CHECK(table.bins() == 50);
  for (std::size_t bin = 0; bin < 50; ++bin)
    CHECK(table.mass(5, bin) == 4.0 * static_cast<double>(bin) + 3);
  table.add(5.5 * um, 7, 1, 1000);
  CHECK(table.bin_width() == 16);
  CHECK(table.bins() == 63);
  CHECK(table.mass(5, 0) == 136);  // 1 + ... + 16
  CHECK(table.mass(5, 62) == 7);
  CHECK(table.mass(5) == 5057);
}

TEST_CASE("SizeTable: shares and quantiles by hand, inverse of each other to 1e-12") {
  SizeTable table;
  table.add(0.5 * um, 1, 1, 0), table.add(3.5 * um, 2, 1, 0), table.add(25 * um, 1, 1, 0);
  CHECK(table.finer(0.5 * um) == near(0.125).epsilon(1e-14));
  CHECK(table.finer(1 * um) == near(0.25).epsilon(1e-14));
  CHECK(table.finer(2 * um) == near(0.25).epsilon(1e-14));
  CHECK(table.finer(std::sqrt(12.0) * um) == near(0.5).epsilon(1e-14));
  CHECK(table.finer(std::sqrt(500.0) * um) == near(0.875).epsilon(1e-14));  // of 20 to 25 um
  CHECK(table.finer(1) == 1);
  CHECK(table.finer(0) == 0);
  CHECK(table.quantile(0.5) == near(std::sqrt(12.0) * um).epsilon(1e-12));
  CHECK(table.quantile(0.1) == near(0.4 * um).epsilon(1e-12));
  CHECK(table.quantile(0.25) == near(1 * um).epsilon(1e-12));
  CHECK(table.quantile(0) == 0);
  CHECK(table.quantile(1) == near(25 * um).epsilon(1e-12));
  for (const double share : {0.01, 0.2, 0.3, 0.6, 0.74, 0.76, 0.99})
    CHECK(table.finer(table.quantile(share)) == near(share).epsilon(1e-12));
  SizeTable coarse;
  coarse.add(25 * um, 1, 1, 0);
  CHECK(coarse.quantile(0) == near(20 * um).epsilon(1e-12));
  CHECK(SizeTable{}.finer(1) == 0);
}

TEST_CASE("SizeTable: merged, it has what both were given; a restored state goes on bit for bit") {
  SizeTable whole(0.5), first(0.5), second(0.5);
  silt::Random random(9);
  for (int k = 0; k < 4000; ++k) {
    const double d = 100 * um * random.uniform() * random.uniform() + 1e-9, mass = random.uniform();
    const double time = (k % 2 == 0 ? 300 : 40) * random.uniform();
    whole.add(d, mass, 2, time), (k % 2 == 0 ? first : second).add(d, mass, 2, time);
  }
  CHECK(first.bin_width() != second.bin_width());
  for (const bool swapped : {false, true}) {
    SizeTable both = swapped ? second : first;
    both.merge(swapped ? first : second);
    CHECK(both.mass() == near(whole.mass()).epsilon(1e-14));
    CHECK(both.number() == whole.number());
    REQUIRE(both.classes() == whole.classes());
    REQUIRE(both.bins() == whole.bins());
    CHECK(both.bin_width() == whole.bin_width());
    for (std::size_t k = 0; k < whole.classes(); ++k)
      for (std::size_t bin = 0; bin < whole.bins(); ++bin)
        CHECK(std::abs(both.mass(k, bin) - whole.mass(k, bin)) < 1e-12);
  }
  SizeTable again;
  again.restore(whole.state());
  CHECK(again.state() == whole.state());
  again.add(3 * um, 0.1, 1, 777), whole.add(3 * um, 0.1, 1, 777);
  CHECK(again.state() == whole.state());
  again.restore(SizeTable(0.25).state());
  CHECK(again.mass() == 0);
}

TEST_CASE("SizeTable: refusals; a state that is none leaves the table as it was") {
  using silt_test::has, silt_test::refusal;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  SizeTable table;
  const auto adding = [&](double d, double mass, double number, double time) {
    return refusal([&] { table.add(d, mass, number, time); });
  };
  has(adding(0, 1, 1, 0), "SizeTable: diameter = 0 [m]");
  has(adding(nan, 1, 1, 0), "SizeTable: diameter = nan [m]");
  has(adding(um, -1, 1, 0), "SizeTable: mass = -1 [kg]");
  has(adding(um, 1, nan, 0), "SizeTable: number = nan [-]");
  has(adding(um, 1, 1, -2), "SizeTable: time = -2 [s]");
  has(refusal([] { SizeTable none(0); }), "SizeTable: bin_width = 0 [s]");
  has(refusal([&] { table.quantile(0.5); }), "quantile(0.5) of a table without mass");
  has(refusal([&] { table.quantile(1.5); }), "SizeTable: share = 1.5 [-] must be in [0, 1]");
  table.add(2.5 * um, 1, 1, 0);
  has(refusal([&] { table.mass(9); }), "SizeTable: class 9: there are 3");
  has(refusal([&] { table.mass(0, 1); }), "SizeTable: interval 1 of time: there are 1");
  has(refusal([&] { table.merge(SizeTable(3e-3)); }), "bins of 0.003 [s] into one of 0.001 [s]");
  const auto good = table.state();
  const auto restoring = [&](std::vector<double> state) {
    has(refusal([&] { table.restore(state); }), "are not a state of a SizeTable");
    CHECK(table.state() == good);
  };
  restoring({});
  for (std::size_t k = 0; k < good.size(); ++k)
    for (const double wrong : {nan, -1.0}) {
      auto state = good;
      state[k] = wrong;
      const bool rest = k > 3 && k % 2 == 1;  // what rounding took may be negative
      if (wrong < 0 && rest && state[k - 1] >= 1) continue;
      restoring(state);
    }
  auto state = good;
  state.push_back(0), restoring(state);
  state = good, state[1] = 65, restoring(state);
  state = good, state[1] = 0.5, restoring(state);
  state = good, state[2] = 1e300, restoring(state);
}

}  // namespace breakage_size_table_test
