// silt - BSD-3-Clause, see LICENSE
// Lacey's index and the relative standard deviation: closed forms, and random mixtures.
#include <cmath>
#include <vector>

#include "engine/support.hpp"
#include "near.hpp"

#include <silt/contact/linear_spring.hpp>
#include <silt/core/random.hpp>
#include <silt/measure/mixing.hpp>

namespace mixing_test {

using namespace engine_test;
using silt::Mixing;
using silt::MixingSamples;

namespace {

/// n^3 particles on a grid of spacing 1 m, from 0.5 m on, by their indices.
template <class IsFirst>
Mixing of_grid(int n, const silt::MixingOptions& options, const IsFirst& is_first) {
  MixingSamples samples(options);
  for (int x = 0; x < n; ++x)
    for (int y = 0; y < n; ++y)
      for (int z = 0; z < n; ++z) samples.add({x + 0.5, y + 0.5, z + 0.5}, is_first(x, y, z));
  return samples.mixing();
}

}  // namespace

// Catches samples that lie elsewhere than at `corner`, and shares of another kind.
TEST_CASE("mixing: of halves side by side Lacey's index is 0, and RSD is that of the unmixed") {
  const auto left = [](int x, int, int) { return x < 3; };  // 3/8 of the particles
  // Samples of two that end where the kinds do, on both sides of the origin.
  const Mixing m = of_grid(8, {.side = 2, .corner = {1, 0, 0}}, left);
  CHECK(m.particles == 512);
  CHECK(m.samples == 5 * 4 * 4);
  CHECK(m.share == near(3.0 / 8));
  CHECK(std::abs(m.lacey) < 1e-14);
  CHECK(m.variance == near(m.share * (1 - m.share)));
  CHECK(m.relative_deviation == near(std::sqrt((1 - m.share) / m.share)));
  // Moved by half a sample, those in the middle have both: 4 of 16 there, 2 of 4 columns each.
  const Mixing cut = of_grid(8, {.side = 2}, left);
  const double p = 3.0 / 8,
               v = (0.25 * (1 - p) * (1 - p) + 0.25 * (0.5 - p) * (0.5 - p) + 0.5 * p * p);
  CHECK(cut.samples == 64);
  CHECK(cut.variance == near(v));
  CHECK(cut.lacey == near((p * (1 - p) - v) / (p * (1 - p) * (1 - 63.0 / 511))));
}

// Catches the two kinds taken for one in samples that are as large as the pattern.
TEST_CASE("mixing: a checkerboard is unmixed in small samples, and above random in larger ones") {
  const auto board = [](int x, int y, int z) { return (x / 2 + y / 2 + z / 2) % 2 == 0; };
  CHECK(std::abs(of_grid(8, {.side = 2}, board).lacey) < 1e-14);
  const Mixing m = of_grid(8, {.side = 4}, board);  // each sample has as many of both
  CHECK(m.variance == 0);
  CHECK(m.relative_deviation == 0);
  CHECK(m.lacey == near(1 / (1 - 7.0 / 511)));  // 8 samples of 512 particles
}

// Catches Lacey's p(1 - p)/n for few samples, weights that are left out, and a wrong scatter.
TEST_CASE("mixing: over random mixtures the index is 1 in the mean, with its scatter") {
  constexpr int tries = 2000;
  silt::Random random(5);
  std::vector<Vec3d> places;
  for (int k = 0; k < 600; ++k)  // denser below: samples of unequal numbers
    places.push_back(
        {3 * random.uniform(), 3 * random.uniform(), 3 * random.uniform() * random.uniform()});
  std::vector<bool> kinds(places.size());
  for (std::size_t k = 0; k < 200; ++k) kinds[k] = true;
  double sum = 0, squares = 0, deviations = 0, scatter = 0;
  for (int t = 0; t < tries; ++t) {
    for (std::size_t k = kinds.size() - 1; k > 0; --k) {
      const std::size_t other = random.index(k + 1);
      const bool kind = kinds[k];
      kinds[k] = kinds[other], kinds[other] = kind;
    }
    MixingSamples samples({.side = 1});
    for (std::size_t k = 0; k < kinds.size(); ++k) samples.add(places[k], kinds[k]);
    const Mixing m = samples.mixing();
    sum += m.lacey, squares += m.lacey * m.lacey;
    deviations += m.relative_deviation * m.relative_deviation;
    scatter = m.lacey_scatter;
    REQUIRE(m.share == near(1.0 / 3));
  }
  const double mean = sum / tries, deviation = std::sqrt(squares / tries - mean * mean);
  CHECK(std::abs(mean - 1) < 4 * deviation / std::sqrt(tries));
  // As chi squared of 26 samples, some of them small.
  CHECK(deviation == near(scatter).epsilon(0.1));
  const double p = 1.0 / 3;
  CHECK(deviations / tries == near((1 - p) / p * 26 / 599).epsilon(0.03));
}

TEST_CASE("mixing: of a simulation, without small samples; what tells nothing is refused") {
  silt::Particles<silt::Sphere> grains;
  for (int k = 0; k < 21; ++k)
    grains.add({.position = {0.1 * (k % 5) + 0.05, 0.05, 0.1 * (k / 5) + 0.05},
                .radius = 0.01,
                .density = 2500,
                .material = k % 5 < 2 ? 0u : 1u});
  silt::Contacts<silt::LinearSpring, silt::SeveralMaterials> contacts{
      {{.stiffness = 100}, {.stiffness = 200}}};
  const silt::Simulation sim{std::move(grains), contacts};
  const auto first = [&](std::size_t k) { return sim.material(k) == 0; };
  const Mixing all = silt::mixing(sim, {.side = 0.2}, first);
  CHECK(all.particles == 21);
  CHECK(all.samples == 7);
  // The last particle, alone in its sample, is left out with it.
  const Mixing most = silt::mixing(sim, {.side = 0.2, .least = 2}, first);
  CHECK(most.particles == 20);
  CHECK(most.samples == 6);
  CHECK(most.share == near(0.4));
  CHECK(std::abs(most.lacey) < 1e-14);
  const auto refused = [&](const silt::MixingOptions& options, auto is_first,
                           std::initializer_list<std::string> words) {
    const std::string said =
        refusal<silt::InputError>([&] { silt::mixing(sim, options, is_first); });
    return has_words(said, words);
  };
  CHECK(refused({}, first, {"MixingOptions.side = 0 [m]"}));
  CHECK(refused({.side = 1, .corner = {NAN, 0, 0}}, first, {"MixingOptions.corner"}));
  CHECK(refused({.side = 1}, first, {"21 particles in 1 sample of 1 m", "MixingOptions.side"}));
  CHECK(refused({.side = 0.01}, first, {"21 particles in 21 samples"}));
  CHECK(refused({.side = 0.2}, [](std::size_t) { return false; },
                {"all 21 particles are of the second kind"}));
}

}  // namespace mixing_test
