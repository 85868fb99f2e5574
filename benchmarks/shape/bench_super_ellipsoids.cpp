// silt - BSD-3-Clause, see LICENSE
//
// Contact geometry of pairs of superellipsoids, time per pair: BM_<what>/<kernel>/<s>/<motion>
//   touch      1 % overlap, last normal known; every call moves the bodies by motion sizes and rad
//   near_miss  1 % gap, last normal known, proved apart by it
//   cold       1 % overlap, no last normal (one pair at a time)
// Kernels: two, equal, any exponents, sphere; in all lanes of the instruction set, and in one.

#include <bit>
#include <cmath>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include <silt/silt.hpp>

namespace {

using silt::Exponents;
using silt::Vec3d;

constexpr std::size_t count = 256;  // pairs, all of one form
constexpr int moves = 4;            // places that are stepped through, there and back

template <Exponents E>
using Form = silt::SuperForm<double, E>;
template <Exponents E>
using Pair = silt::PosedPair<Form<E>, Form<E>>;

struct Source {
  std::mt19937_64 engine{1};
  double normal() { return std::normal_distribution<double>()(engine); }
  Vec3d direction() { return silt::normalised({normal(), normal(), normal()}); }
  silt::Quaternion turn() { return silt::rotation_about(direction(), 3 * normal()); }
};

/// A pair that overlaps by `depth` of the touching distance, at `moves` times.
template <Exponents E>
std::vector<Pair<E>> moving_pair(Source& from, double s, double aspect, double depth,
                                 double motion) {
  const auto form = std::bit_cast<Form<E>>(form_of(silt::SuperEllipsoid{
      1, std::sqrt(aspect), aspect, s, E == Exponents::Any ? 0.7 * s + 0.6 : s}));
  auto q = from.turn();
  const Vec3d ray = from.direction();
  Pair<E> pair{form, form, silt::body_axes(q), silt::body_axes(from.turn()), ray};
  const auto out = silt::find_ray_normal(pair, false);
  const auto D = silt::depth_along(pair, out.direction);
  pair.between = ray * ((1 - depth) * (D.i.height + D.j.height) / dot(out.direction, ray));
  const auto spin = silt::rotation_about(from.direction(), motion);
  const Vec3d step = from.direction() * motion;
  std::vector<Pair<E>> states;
  for (int k = 0; k < moves; ++k) {
    states.push_back(pair);
    q = spin * q, pair.turn_i = silt::body_axes(q), pair.between += step;
  }
  return states;
}

template <class Arch, Exponents E>
struct Blocks {
  static constexpr std::size_t W = silt::Lanes<Arch>::width;
  using Real = typename silt::Lanes<Arch>::Real;
  using Lane = silt::SuperForm<Real, E>;
  struct Place {
    silt::BodyAxes<Real> turn_i, turn_j;
    silt::Vec3<Real> between;
  };
  struct alignas(64) Block {
    Place at[moves];
    silt::NormalMemory<Real> memory;
  };
  std::vector<Block> blocks{count / W};
  silt::PosedPair<Lane, Lane> pair;

  Blocks(double s, double aspect, double depth, double motion) {
    Source from;
    for (std::size_t k = 0; k < count; ++k) {
      const auto states = moving_pair<E>(from, s, aspect, depth, motion);
      auto& block = blocks[k / W];
      silt::NormalMemory<double> memory;
      (void)touch(states[0], memory);
      silt::set_lane(block.memory, memory, k % W);
      for (int n = 0; n < moves; ++n) {
        silt::set_lane(block.at[n].turn_i, states[n].turn_i, k % W);
        silt::set_lane(block.at[n].turn_j, states[n].turn_j, k % W);
        silt::set_lane(block.at[n].between, states[n].between, k % W);
      }
      pair.i = pair.j = silt::in_all_lanes<Lane>(states[0].i);
    }
  }
  const auto& pair_at(const Place& place) {
    pair.turn_i = place.turn_i, pair.turn_j = place.turn_j, pair.between = place.between;
    return pair;
  }
};

template <class Arch, Exponents E>
void touching(benchmark::State& state, double s, double aspect, double motion) {
  Blocks<Arch, E> b(s, aspect, 0.01, motion);
  int n = 0, way = 1;
  for (auto _ : state) {
    for (auto& block : b.blocks) {
      const auto contact = touch(b.pair_at(block.at[n]), block.memory);
      benchmark::DoNotOptimize(contact);
    }
    if (n + way < 0 || n + way >= moves) way = -way;
    n += way;
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(count));
}

template <class Arch, Exponents E>
void near_miss(benchmark::State& state, double s, double aspect) {
  Blocks<Arch, E> b(s, aspect, -0.01, 0);
  for (auto _ : state)
    for (const auto& block : b.blocks) {
      const auto yes = silt::apart(b.pair_at(block.at[0]), block.memory);
      benchmark::DoNotOptimize(yes);
    }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(count));
}

template <Exponents E>
void cold(benchmark::State& state, double s, double aspect) {
  Source from;
  std::vector<Pair<E>> pairs;
  for (std::size_t k = 0; k < count; ++k)
    pairs.push_back(moving_pair<E>(from, s, aspect, 0.01, 0)[0]);
  for (auto _ : state)
    for (const auto& pair : pairs) {
      silt::NormalMemory<double> none;
      benchmark::DoNotOptimize(touch(pair, none));
    }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(count));
}

template <class Arch, Exponents E>
void add(const std::string& kernel, double s, double aspect) {
  const std::string name = kernel + (silt::Lanes<Arch>::width == 1 ? "_one_lane" : "") + "/" +
                           std::to_string(static_cast<int>(s));
  for (const double motion : {1e-6, 1e-5, 1e-4}) {
    const int digits = static_cast<int>(std::lround(-std::log10(motion)));
    benchmark::RegisterBenchmark(
        ("BM_touch/" + name + "/1e-" + std::to_string(digits)).c_str(),
        [=](benchmark::State& state) { touching<Arch, E>(state, s, aspect, motion); });
  }
  benchmark::RegisterBenchmark(("BM_near_miss/" + name).c_str(), [=](benchmark::State& state) {
    near_miss<Arch, E>(state, s, aspect);
  });
}

template <class Arch>
void add_all() {
  add<Arch, Exponents::Two>("sphere", 2, 1);
  add<Arch, Exponents::Two>("two", 2, 2);
  for (const double s : {4.0, 8.0, 20.0}) {
    add<Arch, Exponents::Equal>("equal", s, 2);
    add<Arch, Exponents::Any>("any", s, 2);
  }
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  add_all<silt::DefaultArch>();
  add_all<silt::OneLane>();
  for (const double s : {2.0, 8.0, 40.0})
    benchmark::RegisterBenchmark(
        ("BM_cold/any/" + std::to_string(static_cast<int>(s))).c_str(),
        [=](benchmark::State& state) { cold<Exponents::Any>(state, s, 2); });
  benchmark::RunSpecifiedBenchmarks();
}
