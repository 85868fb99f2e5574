// silt - BSD-3-Clause, see LICENSE
//
// Narrow phase of polyhedra by volume, by thickness, by margins (GJK): ns per pair, for touching
// pairs, near misses (separated by the stored axis), and pairs without stored data; 1024 pairs of
// random bodies, to defeat branch prediction. The targets are 700 ns per touching pair and 50 ns
// per near miss.

#include <random>

#include <benchmark/benchmark.h>

#include <silt/shape/dilated_moments.hpp>
#include <silt/shape/narrow/margin_contact.hpp>
#include <silt/shape/narrow/thickness_overlap.hpp>

namespace {

using silt::PlacedPolyhedron;
using silt::Polyhedron;
using silt::Vec3d;

constexpr std::size_t pairs = 1024, kinds = 64;

class Random {
 public:
  double normal() { return normal_(engine_); }
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  Vec3d direction() { return normalised(Vec3d{normal(), normal(), normal()}); }
  silt::Quaternion turn() { return rotation_about(direction(), uniform(0, 6.2831853)); }

 private:
  std::mt19937_64 engine_{1};
  std::normal_distribution<double> normal_;
};

/// Cubes of edge 1, hulls of 12 to 20 points on a ball of diameter 1 (20 to 36 faces), or of
/// uniformly distributed points on it: that many triangles.
enum Bodies { cubes = 6, hulls = 36, faces_240 = 240, faces_2000 = 2000 };

std::vector<Polyhedron> shapes(Bodies which, Random& random) {
  std::vector<Polyhedron> out;
  for (std::size_t k = 0; k < (which > hulls ? 1 : kinds); ++k) {
    std::vector<Vec3d> points;
    if (which == cubes)
      for (int c = 0; c < 8; ++c)
        points.push_back({(c & 1) - 0.5, (c >> 1 & 1) - 0.5, (c >> 2) - 0.5});
    else if (which == hulls)
      for (std::size_t p = 0; p < 12 + k % 9; ++p) points.push_back(0.5 * random.direction());
    else
      for (int p = 0, n = which / 2 + 2; p < n; ++p) {
        const double z = 1 - (2 * p + 1.0) / n, phi = 2.399963229728653 * p;
        const double r = std::sqrt(1 - z * z);
        points.push_back(0.5 * Vec3d{r * std::cos(phi), r * std::sin(phi), z});
      }
    out.push_back(principal_shape(Polyhedron::from_points(points)).parts[0]);
  }
  return out;
}

struct Pair {
  PlacedPolyhedron i, j;
  silt::OverlapMemory memory;
};

/// Pairs along a random direction, `gap` apart (< 0: overlap). `face_to_face`: a face of each in
/// one plane, tilted by up to 1e-3.
std::vector<Pair> make_pairs(const std::vector<Polyhedron>& shapes, double gap, bool face_to_face,
                             Random& random) {
  std::vector<Pair> out;
  while (out.size() < pairs) {
    const auto& a = shapes[out.size() % shapes.size()];
    const auto& b = shapes[out.size() * 7 / 3 % shapes.size()];
    const auto turn = random.turn();
    auto towards = random.direction();
    Pair pair{{&a, {{0, 0, 0}, turn}}, {&b, {{0, 0, 0}, random.turn()}}, {}};
    if (face_to_face) {  // cubes: turned about the face's normal, slightly tilted
      towards = rotate(turn, {0, 0, 1});
      const auto tilt = rotation_about(random.direction(), 1e-3 * random.uniform(0, 1));
      pair.j.pose.turn =
          rotation_matrix(tilt * rotation_about(towards, random.uniform(0, 6)) * turn);
    }
    pair.j.pose.position = 3.0 * towards;
    for (int step = 0; step < 20; ++step) {  // to the distance that is wanted
      const auto found = gjk_distance(pair.i, pair.j, Vec3d{0, 0, 0});
      if (found.distance < 1e-9) break;
      pair.j.pose.position -= std::max(found.distance, 1e-10) * towards;
    }
    pair.j.pose.position += gap * towards;
    out.push_back(pair);
  }
  return out;
}

struct Case {
  Bodies bodies;
  bool face_to_face;
  double gap;  // [-] of the bodies' size
  bool remember;
  bool by_thickness = false;
};

void contact(benchmark::State& state, const Case& c) {
  Random random;
  const auto bodies = shapes(c.bodies, random);
  auto all = make_pairs(bodies, c.gap, c.face_to_face, random);
  for (auto& p : all) volume_contact(p.i, p.j, {1}, p.memory);
  std::size_t touching = 0, visits = 0;
  for (auto _ : state)
    for (auto& p : all) {
      if (!c.remember) p.memory = {};
      const auto found = c.by_thickness ? thickness_contact(p.i, p.j, p.memory)
                                        : volume_contact(p.i, p.j, {1}, p.memory);
      benchmark::DoNotOptimize(found);
      touching += found.overlap > 0, ++visits;
    }
  state.SetItemsProcessed(static_cast<std::int64_t>(visits));
  state.counters["touching"] = static_cast<double>(touching) / static_cast<double>(visits);
  state.counters["ns/pair"] =
      benchmark::Counter(static_cast<double>(visits) * 1e-9,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

BENCHMARK_CAPTURE(contact, volume_cubes, Case{cubes, false, -0.01, true});
BENCHMARK_CAPTURE(contact, volume_cubes_face_to_face, Case{cubes, true, -0.01, true});
BENCHMARK_CAPTURE(contact, volume_hulls, Case{hulls, false, -0.01, true});
BENCHMARK_CAPTURE(contact, thickness_cubes, Case{cubes, false, -0.01, true, true});
BENCHMARK_CAPTURE(contact, thickness_cubes_face_to_face, Case{cubes, true, -0.01, true, true});
BENCHMARK_CAPTURE(contact, thickness_hulls, Case{hulls, false, -0.01, true, true});
BENCHMARK_CAPTURE(contact, near_miss_cubes, Case{cubes, false, 0.02, true});
BENCHMARK_CAPTURE(contact, near_miss_hulls, Case{hulls, false, 0.02, true});
BENCHMARK_CAPTURE(contact, cold_cubes, Case{cubes, false, 0.02, false});
BENCHMARK_CAPTURE(contact, cold_hulls, Case{hulls, false, 0.02, false});
BENCHMARK_CAPTURE(contact, thickness_240_faces, Case{faces_240, false, -0.01, true, true});
BENCHMARK_CAPTURE(contact, thickness_2000_faces, Case{faces_2000, false, -0.01, true, true});
BENCHMARK_CAPTURE(contact, near_miss_240_faces, Case{faces_240, false, 0.02, true});
BENCHMARK_CAPTURE(contact, near_miss_2000_faces, Case{faces_2000, false, 0.02, true});
BENCHMARK_CAPTURE(contact, cold_240_faces, Case{faces_240, false, 0.02, false});
BENCHMARK_CAPTURE(contact, cold_2000_faces, Case{faces_2000, false, 0.02, false});

/// Rounded bodies: cores 0.02 apart, margins of 0.015 each; a distance with a stored axis.
void margins(benchmark::State& state, Bodies which) {
  Random random;
  const auto bodies = shapes(which, random);
  const auto all = make_pairs(bodies, 0.02, false, random);
  std::vector<silt::AxisMemory> memory(all.size());
  for (auto _ : state)
    for (std::size_t k = 0; k < all.size(); ++k)
      benchmark::DoNotOptimize(margin_contact(all[k].i, 0.015, all[k].j, 0.015, memory[k]));
  state.counters["ns/pair"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * pairs * 1e-9,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK_CAPTURE(margins, cubes, cubes);
BENCHMARK_CAPTURE(margins, hulls, hulls);
BENCHMARK_CAPTURE(margins, 2000_faces, faces_2000);

void plane(benchmark::State& state, Bodies which) {
  Random random;
  const auto bodies = shapes(which, random);
  std::vector<PlacedPolyhedron> all;
  for (std::size_t k = 0; k < pairs; ++k) {
    PlacedPolyhedron p{&bodies[k % bodies.size()], {{0, 0, 0}, random.turn()}};
    p.pose.position.z = -p.support({0, 0, -1}).z - 0.01;
    all.push_back(p);
  }
  for (auto _ : state)
    for (const auto& p : all)
      benchmark::DoNotOptimize(
          contact_of(volume_overlap(p, Vec3d{0, 0, 0}, Vec3d{0, 0, 1}), {1}, {0, 0, 1}));
  state.counters["ns/pair"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * pairs * 1e-9,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK_CAPTURE(plane, cubes, cubes);
BENCHMARK_CAPTURE(plane, hulls, hulls);
BENCHMARK_CAPTURE(plane, 2000_faces, faces_2000);

}  // namespace

BENCHMARK_MAIN();
