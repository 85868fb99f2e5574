// silt - BSD-3-Clause, see LICENSE
//
// Contacts of random and near-degenerate pairs of superellipsoids, to check that none is missed:
//   million_contacts [PAIRS] [SEED]
// Each pair is solved without a stored normal, then moved and solved in lanes with the stored one.
// A second method decides whether it touches: the convex problem along the centre line.

#include <cstdio>
#include <cstdlib>
#include <vector>

#include "shape/random_pairs.hpp"

namespace {

using Arch = silt::DefaultArch;
using Real = silt::Lanes<Arch>::Real;
constexpr std::size_t W = silt::Lanes<Arch>::width;
using LaneForm = silt::SuperForm<Real>;
using LanePair = silt::PosedPair<LaneForm, LaneForm>;

struct Count {
  long pairs = 0, touching = 0, unsolved = 0, wrong = 0, other_minimum = 0, evaluations = 0;
  double residual = 0;

  void add(const pairs::Pair& pair, bool touches, bool solved, double left) {
    const double size = std::min(pair.i.size, pair.j.size);
    ++pairs, touching += touches, unsolved += !solved;
    residual = std::max(residual, left / size);
    const auto ray = silt::find_ray_normal(pair, false);
    const auto D = silt::depth_along(pair, ray.direction);
    const double along = D.F / dot(ray.direction, pair.between) * norm(pair.between);
    // Within rounding of the touching distance both results are right.
    if (std::abs(along) > 1e-9 * size) wrong += touches != (along > 0);
    if (!ray.solved) ++unsolved;
  }
  void print(const char* what) const {
    std::printf("%-34s %9ld %9ld %9ld %7ld %12ld %10.1e", what, pairs, touching, unsolved, wrong,
                other_minimum, residual);
    if (evaluations > 0)
      std::printf(" %8.1f", double(evaluations) / double(pairs));  // not in lanes
    std::printf("\n");
  }
};

struct Kind {
  const char* name;
  double s, aspect;
  bool aligned;
};

void run(const Kind& kind, long n, pairs::Source& from, Count& cold_sum, Count& warm_sum) {
  Count cold, warm;
  std::vector<pairs::Posed> block;
  LanePair lanes;
  silt::NormalMemory<Real> memory;
  for (long k = 0; k < n; ++k) {
    const double sign = from.uniform(0, 1) < 0.3 ? -1 : 1;
    const double depth = sign * from.log_uniform(1e-6, 0.1);
    auto p = kind.aligned
                 ? pairs::aligned(from, kind.s, kind.aspect, from.log_uniform(1e-6, 1e-2), depth)
                 : pairs::general(from, kind.s, kind.aspect, depth);
    const auto first = silt::find_common_normal(p.pair, {0, 0, 0});
    cold.add(p.pair, first.depth > 0, first.solved, first.depth > 0 ? first.residual : 0);
    cold.evaluations += first.evaluations;
    silt::NormalMemory<double> kept;
    (void)silt::touch(p.pair, kept);
    pairs::move(from, p, from.log_uniform(1e-7, 1e-3));
    const std::size_t lane = block.size();
    silt::set_lane(lanes, p.pair, lane), silt::set_lane(memory, kept, lane);
    block.push_back(p);
    if (block.size() < W) continue;
    const auto found = silt::touch(lanes, memory);
    const Real touches = silt::select(found.touches, Real(1), Real(0));
    const Real solved = silt::select(found.solved, Real(1), Real(0));
    for (std::size_t l = 0; l < W; ++l) {
      const bool hit = silt::one_lane<double>(touches, l) > 0;
      const double overlap = silt::one_lane<double>(found.overlap, l);
      warm.add(block[l].pair, hit, silt::one_lane<double>(solved, l) > 0,
               silt::one_lane<double>(found.residual, l));
      if (!hit) continue;
      const auto anew = silt::find_common_normal(block[l].pair, {0, 0, 0});
      const double size = std::min(block[l].pair.i.size, block[l].pair.j.size);
      warm.other_minimum += std::abs(anew.depth - overlap) > 1e-8 * size;
    }
    block.clear();
  }
  cold.print(kind.name);
  for (auto [part, sum] : {std::pair{&cold, &cold_sum}, std::pair{&warm, &warm_sum}}) {
    sum->pairs += part->pairs, sum->touching += part->touching, sum->unsolved += part->unsolved;
    sum->wrong += part->wrong, sum->other_minimum += part->other_minimum;
    sum->evaluations += part->evaluations, sum->residual = std::max(sum->residual, part->residual);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const long n = argc > 1 ? std::atol(argv[1]) : 1000000;
  pairs::Source from(argc > 2 ? static_cast<unsigned>(std::atol(argv[2])) : 1);
  const Kind kinds[]{{"general, s <= 8, aspect <= 3", 8, 3, false},
                     {"general, s <= 16, aspect <= 10", 16, 10, false},
                     {"general, s <= 40, aspect <= 30", 40, 30, false},
                     {"aligned, s <= 8, aspect <= 3", 8, 3, true},
                     {"aligned, s <= 40, aspect <= 30", 40, 30, true}};
  std::printf("%-34s %9s %9s %9s %7s %12s %10s %8s\n", "", "pairs", "touching", "unsolved", "wrong",
              "other least", "residual", "evals");
  Count cold, warm;
  for (const auto& kind : kinds) run(kind, n / std::ssize(kinds), from, cold, warm);
  cold.print("all, without a last normal");
  warm.print("all, moved, in lanes");
  return cold.unsolved + cold.wrong + warm.unsolved + warm.wrong == 0 ? 0 : 1;
}
