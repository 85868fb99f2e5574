// silt - BSD-3-Clause, see LICENSE
//
// touch_solids() on pairs of different kinds: ns per call for touching pairs that have moved by
// 1e-5 of their size since the last call (warm), for near misses, and for touching pairs without
// stored data (cold); 512 pairs of random bodies, to defeat branch prediction.

#define DOCTEST_CONFIG_DISABLE
#include "shape/solids.hpp"

#include <benchmark/benchmark.h>

namespace {

using namespace solids;

enum class Case { Warm, NearMiss, Cold };

/// Moves j so that the gap [m] from j to i along their normal, or minus the overlap, becomes `gap`.
template <class A, class KindJ>
Vec3d place_for(const A& i, const KindJ& kind, const Quaternion& turn, double gap, Random& random) {
  const Vec3d towards = random.direction();
  Vec3d x = farthest(i, towards) - farthest(kind.at({0, 0, 0}, turn), -towards);
  for (int k = 0; k < 6; ++k) {
    NormalMemory<double> memory;
    const auto j = kind.at(x, turn);
    const auto c = touch_solids(i, j, memory);
    const Vec3d m = c.overlap > 0         ? -c.normal
                    : memory.follows == 0 ? towards
                                          : silt::detail::last_direction_of(i, j, memory);
    x += (gap + c.overlap) * m;
  }
  return x;
}

template <class KindI, class KindJ>
void touch(benchmark::State& state, Case which) {
  constexpr std::size_t n = 512;
  Random random(1);
  std::vector<KindI> kinds_i;
  std::vector<KindJ> kinds_j;
  for (std::size_t k = 0; k < n; ++k) kinds_i.emplace_back(random), kinds_j.emplace_back(random);
  std::vector<decltype(kinds_i[0].at({}, {}))> i;
  std::vector<decltype(kinds_j[0].at({}, {}))> j[2];  // two places, taken in turn
  std::vector<NormalMemory<double>> memory(n);
  for (std::size_t k = 0; k < n; ++k) {
    const auto turn = random.turn();
    i.push_back(kinds_i[k].at({0, 0, 0}, random.turn()));
    const Vec3d x =
        place_for(i[k], kinds_j[k], turn, which == Case::NearMiss ? 0.004 : -0.004, random);
    j[0].push_back(kinds_j[k].at(x, turn));
    j[1].push_back(kinds_j[k].at(x + 1e-5 * random.direction(),
                                 silt::rotation_about(random.direction(), 1e-5) * turn));
    touch_solids(i[k], j[1][k], memory[k]);
  }
  std::size_t step = 0;
  for (auto _ : state) {
    for (std::size_t k = 0; k < n; ++k) {
      if (which == Case::Cold) memory[k] = {};
      benchmark::DoNotOptimize(touch_solids(i[k], j[step % 2][k], memory[k]));
    }
    ++step;
  }
  state.counters["ns/pair"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * n * 1e-9,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

template <class KindI, class KindJ>
void add_pair() {
  const std::string name = "touch_solids/" + KindI::name + "/" + KindJ::name;
  const auto add = [&](const char* what, Case which) {
    benchmark::RegisterBenchmark((name + "/" + what).c_str(), touch<KindI, KindJ>, which);
  };
  add("warm", Case::Warm), add("near", Case::NearMiss), add("cold", Case::Cold);
}

}  // namespace

int main(int argc, char** argv) {
  add_pair<BallKind, BallKind>(), add_pair<SuperKind, BallKind>();
  add_pair<SuperKind, SuperKind>(), add_pair<SuperKind, PolySuperKind>();
  add_pair<BallKind, SharpKind>(), add_pair<SuperKind, SharpKind>();
  add_pair<PolySuperKind, SharpKind>(), add_pair<SuperKind, DilatedKind>();
  add_pair<SharpKind, SharpKind>(), add_pair<SharpKind, DilatedKind>();
  add_pair<DilatedKind, DilatedKind>();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
