// silt - BSD-3-Clause, see LICENSE
//
// Cost of a search, build and query together: ns per sphere (items are spheres); `build` [ns per
// sphere] alone, for searches with a separate build; bytes per sphere besides the pairs; the number
// of pairs found, and a sum over them by which search.py checks that all searches have found the
// same ones. Single thread.
//   bench_search [--benchmark_filter=...]      Google Benchmark's options
//   bench_search points SCENE N FILE           writes a scene as a LAMMPS data file, its spheres in
//                                              the order in which HashedGrid has them

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <new>
#include <numeric>
#include <string>
#include <type_traits>

#include <malloc.h>

#include <benchmark/benchmark.h>

#include <silt/contact/linear_spring.hpp>
#include <silt/simulation.hpp>

#include "points.hpp"
#include "searches.hpp"

namespace {
std::size_t heap = 0;  // bytes in use
void* counted(void* p) {
  if (p == nullptr) throw std::bad_alloc();
  heap += malloc_usable_size(p);
  return p;
}
void release(void* p) {
  heap -= malloc_usable_size(p);
  std::free(p);
}
}  // namespace

void* operator new(std::size_t n) { return counted(std::malloc(n)); }
void* operator new(std::size_t n, std::align_val_t a) {
  const auto align = static_cast<std::size_t>(a);
  return counted(std::aligned_alloc(align, (n + align - 1) / align * align));
}
void operator delete(void* p) noexcept { release(p); }
void operator delete(void* p, std::size_t) noexcept { release(p); }
void operator delete(void* p, std::align_val_t) noexcept { release(p); }
void operator delete(void* p, std::size_t, std::align_val_t) noexcept { release(p); }

namespace {

using bench::Rows;
constexpr double reach = 0.1;  // [m] of the mean diameter, 1 m

struct Scene {
  std::string name;
  std::function<Rows(std::size_t, silt::Random&)> make;
};
const std::vector<Scene>& scenes() {
  using Random = silt::Random;
  static const std::vector<Scene> all{
      {"dense bed", bench::dense_bed},
      // Cells are 1.2 m wide: one in a thousand contains a sphere.
      {"cloud", [](std::size_t n, Random& r) { return bench::cloud(n, 1728, r); }},
      {"jets", bench::jets}};
  return all;
}
const std::vector<Scene>& sizes() {
  using Random = silt::Random;
  static const std::vector<Scene> all = [] {
    std::vector<Scene> made;
    for (const int ratio : {1, 2, 5, 10, 30, 100})
      for (const bool two : {true, false}) {
        // From 1:30 on a bed of a few coarse spheres would contain millions of fines.
        if (two && (ratio == 1 || ratio > 10)) continue;
        made.push_back({silt::text(two ? "two sizes 1:" : "fragments 1:", ratio),
                        [=](std::size_t n, Random& r) {
                          return two ? bench::two_sizes(n, ratio, r)
                                     : bench::fragments(n, ratio, r);
                        }});
      }
    return made;
  }();
  return all;
}

/// The last scene made; several searches use it in turn.
const Rows& rows_of(const Scene& scene, std::size_t n) {
  static std::string last;
  static Rows rows;
  if (const auto name = silt::text(scene.name, n); name != last) {
    silt::Random random(1);
    rows = scene.make(n, random), last = name;
  }
  return rows;
}

/// Minimum time of some calls [s].
template <class Work>
double least_time(const Work& work) {
  using Clock = std::chrono::steady_clock;
  double least = INFINITY;
  for (int k = 0; k < 5; ++k) {
    const auto start = Clock::now();
    work();
    least = std::min(least, std::chrono::duration<double>(Clock::now() - start).count());
  }
  return least;
}

/// A checksum of the pairs that does not depend on their order, with spheres numbered by `ids`.
double sum_of(const std::vector<silt::IndexPair>& pairs, const std::vector<std::uint32_t>& ids) {
  std::uint64_t sum = 0;
  for (const auto& [a, b] : pairs) {
    const auto [i, j] = std::minmax(ids[a], ids[b]);
    std::uint64_t h = (static_cast<std::uint64_t>(i) << 32 | j) + 0x9e3779b97f4a7c15u;
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
    sum += h ^ (h >> 31);
  }
  return static_cast<double>(sum >> 11);  // as many bits as a double has
}

template <class Search>
void search(benchmark::State& state, Search finder, Rows rows) {
  const double largest = bench::largest_radius(rows);
  const silt::Team team;
  constexpr silt::OpenDomain domain;
  std::vector<std::uint32_t> ids(rows.size());
  std::iota(ids.begin(), ids.end(), 0u);
  if constexpr (requires { []<class S>(bench::Ordered<S>&) {}(finder); }) {
    finder.order({rows, largest}, reach, domain, team, ids);
    Rows ordered;
    for (const auto k : ids) ordered.push_back(rows[k]);
    rows.swap(ordered);
  }
  std::vector<silt::IndexPair> pairs;
  const std::size_t before = heap;
  finder.find({rows, largest}, reach, domain, team, pairs);
  const std::size_t held = heap - before - pairs.capacity() * sizeof(pairs[0]);
  state.counters["bytes"] = static_cast<double>(held) / static_cast<double>(rows.size());
  for (auto _ : state) finder.find({rows, largest}, reach, domain, team, pairs);
  if constexpr (requires { finder.build(silt::SphereSet{rows, largest}, reach, domain, team); })
    state.counters["build"] = 1e9 / static_cast<double>(rows.size()) * least_time([&] {
                                finder.build({rows, largest}, reach, domain, team);
                              });
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(rows.size()));
  if constexpr (!std::is_same_v<Search, bench::InPieces>)
    state.counters["sum"] = sum_of(pairs, ids);
  state.counters["pairs"] = static_cast<double>(pairs.size()) / static_cast<double>(rows.size());
  if constexpr (requires { finder.report(); }) state.SetLabel(finder.report());
}

/// A cloud of `n` spheres, 4 cubic diameters each, that move by `travel` diameters per step in a
/// periodic box, and collide.
template <class Search>
void drive(benchmark::State& state, double travel) {
  constexpr std::size_t n = 20000;
  silt::Random random(1);
  const double side = std::cbrt(4.0 * n), dt = 1e-3, v = travel / dt;
  silt::Particles<silt::Sphere> spheres;
  for (const auto& p : bench::cloud(n, 4, random)) {
    spheres.add({.position = p.centre(), .radius = 0.5 * p.r, .density = 1});  // few overlap
    spheres[spheres.size() - 1].velocity = {v * random.uniform(-1, 1), v * random.uniform(-1, 1),
                                            v * random.uniform(-1, 1)};
  }
  const double mass = 0.5 * std::numbers::pi / 6 / 8, contact = 40 * dt;
  silt::Simulation sim{
      std::move(spheres),
      silt::Contacts<silt::LinearSpring>{{mass * std::pow(std::numbers::pi / contact, 2), 1.0}},
      Search{}, silt::PeriodicBox{{{0, 0, 0}, {side, side, side}}, {true, true, true}}};
  sim.time_step = dt, sim.threads = 1;
  sim.guard.max_overlap = sim.guard.max_time_step = 1e9;
  sim.guard.max_travel = sim.guard.max_rate = 1e9;
  sim.run(20 * dt);
  state.counters["touching"] = static_cast<double>(sim.touching_pairs());
  for (auto _ : state) sim.run(10 * dt);
  state.SetItemsProcessed(state.iterations() * 10 * static_cast<std::int64_t>(n));
}

template <class Search>
void add(const Scene& scene, std::size_t n, const std::string& name, Search finder) {
  benchmark::RegisterBenchmark(
      silt::text("search/", scene.name, '/', name, '/', n).c_str(),
      [=](benchmark::State& state) { search(state, finder, rows_of(scene, n)); })
      ->Unit(benchmark::kMillisecond);
}

void add_all() {
  for (const Scene& scene : scenes())
    for (const std::size_t n : {1000, 10000, 100000, 1000000})
      bench::for_each_search([&]<class Search>(const char* name, double most) {
        if (static_cast<double>(n) <= most) add(scene, n, name, Search());
      });
  for (const Scene& scene : sizes()) {
    bench::for_each_search([&]<class Search>(const char* name, double most) {
      if (most >= 1e6) add(scene, 50000, name, Search());
    });
    for (const double inverse : {1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0})
      add(scene, 50000, silt::text("sub-grid 1/", inverse),
          silt::HashedGrid(silt::sub_grid(1 / inverse)));
  }
  for (const double travel : {0.0001, 0.001, 0.01, 0.05}) {
    const auto add_drive = [&]<class Search>(const char* name) {
      benchmark::RegisterBenchmark(silt::text("drive/", travel, '/', name).c_str(),
                                   [=](benchmark::State& state) { drive<Search>(state, travel); })
          ->Unit(benchmark::kMillisecond);
    };
    add_drive.template operator()<silt::Nbs>("Nbs");
    add_drive.template operator()<silt::CellGrid>("CellGrid");
    add_drive.template operator()<silt::HashedGrid>("HashedGrid");
    add_drive.template operator()<silt::AutoSearch>("AutoSearch");
    add_drive.template operator()<silt::VerletList<silt::Nbs>>("VerletList<Nbs>");
    add_drive.template operator()<silt::VerletList<silt::CellGrid>>("VerletList<CellGrid>");
    add_drive.template operator()<silt::VerletList<silt::HashedGrid>>("VerletList<HashedGrid>");
    add_drive.template operator()<silt::VerletList<silt::AutoSearch>>("VerletList<AutoSearch>");
  }
}

/// Writes a scene for LAMMPS and LIGGGHTS.
int write_points(const std::string& name, std::size_t n, const std::string& path) {
  for (const auto* all : {&scenes(), &sizes()})
    for (const Scene& scene : *all) {
      if (scene.name != name) continue;
      const Rows& rows = rows_of(scene, n);
      std::vector<std::uint32_t> order;
      silt::HashedGrid{}.order({rows, bench::largest_radius(rows)}, reach, silt::OpenDomain{},
                               silt::Team(1), order);
      silt::Box box;
      for (const auto& p : rows) box.include(p.centre());
      box = box.grown(1);
      std::FILE* const file = std::fopen(path.c_str(), "w");
      if (file == nullptr) break;
      std::fprintf(
          file,
          "\n\n%zu atoms\n1 atom types\n%g %g xlo xhi\n%g %g ylo yhi\n%g %g zlo zhi\n\nAtoms\n\n",
          rows.size(), box.min.x, box.max.x, box.min.y, box.max.y, box.min.z, box.max.z);
      for (std::size_t k = 0; k < rows.size(); ++k) {
        const auto& p = rows[order[k]];
        std::fprintf(file, "%zu 1 %.17g 2500 %.17g %.17g %.17g\n", k + 1, 2 * p.r, p.x, p.y, p.z);
      }
      return std::fclose(file) == 0 ? 0 : 2;
    }
  std::fprintf(stderr, "bench_search: there is no scene '%s', or '%s' cannot be written\n",
               name.c_str(), path.c_str());
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 5 && std::string(argv[1]) == "points")
    return write_points(argv[2], std::strtoull(argv[3], nullptr, 10), argv[4]);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  add_all();
  benchmark::RunSpecifiedBenchmarks();
}
