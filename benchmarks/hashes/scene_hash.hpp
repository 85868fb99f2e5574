// silt - BSD-3-Clause, see LICENSE
#pragma once

// The state of a scene as one number: detects unintended changes of results.

#include <bit>
#include <chrono>
#include <cstdint>
#include <cstdio>

#include <silt/silt.hpp>

namespace hashes {

/// FNV-1a over the bits of numbers.
class Hash {
 public:
  void add(std::uint64_t bits) {
    for (int byte = 0; byte < 8; ++byte, bits >>= 8)
      value_ = (value_ ^ (bits & 255)) * 1099511628211u;
  }
  void add(double x) { add(std::bit_cast<std::uint64_t>(x)); }
  void add(const silt::Vec3d& v) { add(v.x), add(v.y), add(v.z); }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 14695981039346656037u;
};

/// All readable state of a simulation, in the order of ids; contact history and fluid state affect
/// the velocities of later steps.
template <class Sim>
std::uint64_t hash_of(const Sim& sim) {
  std::vector<std::pair<std::uint64_t, std::size_t>> by_id;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k)) by_id.push_back({sim.id(k), k});
  std::sort(by_id.begin(), by_id.end());
  Hash hash;
  for (const auto& one : by_id) {
    const std::size_t k = one.second;
    hash.add(one.first), hash.add(sim.position(k)), hash.add(sim.velocity(k)),
        hash.add(sim.radius(k));
    if constexpr (requires { sim.angular_velocity(k); }) hash.add(sim.angular_velocity(k));
    if constexpr (requires { sim.orientation(k); }) {
      const silt::Quaternion q = sim.orientation(k);
      hash.add(q.w), hash.add(silt::Vec3d{q.x, q.y, q.z});
    }
  }
  for (std::size_t w = 0; w < sim.walls(); ++w)
    hash.add(sim.wall(w).force), hash.add(sim.wall(w).torque);
  hash.add(std::uint64_t{sim.touching_pairs()}), hash.add(sim.peak_overlap());
  if constexpr (Sim::has_ledger) {
    const auto e = sim.energy();
    hash.add(e.kinetic()), hash.add(e.elastic()), hash.add(e.dissipated());
  }
  return hash.value();
}

/// Whether scenes are timed instead.
inline bool timing = false;

/// Prints the time of a step in the second half of a scene on one thread.
template <class Sim>
void print_time(const char* name, double duration, Sim sim) {
  sim.threads = 1;
  sim.run(duration / 2);
  const auto first = sim.step();
  const auto start = std::chrono::steady_clock::now();
  sim.run(duration / 2);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  std::printf("%-28s %12.4g\n", name, took.count() / static_cast<double>(sim.step() - first));
}

/// Runs a scene, on two threads and from a checkpoint in its middle, and prints its hash; or times
/// it.
template <class Make>
void print(const char* name, double duration, const Make& make) {
  if (timing) return print_time(name, duration, make());
  auto sim = make();
  sim.threads = 1;
  sim.run(duration / 2);
  silt::save_checkpoint(sim, "hashes.silt");
  sim.run(duration / 2);
  auto again = make();
  again.threads = 2;
  silt::load_checkpoint(again, "hashes.silt");
  again.run(duration / 2);
  const auto hash = hash_of(sim), after = hash_of(again);
  std::printf("%-28s %016llx %6lld steps%s\n", name, static_cast<unsigned long long>(hash),
              static_cast<long long>(sim.step()),
              hash == after ? "" : "  NOT the same from a checkpoint on two threads");
  std::fflush(stdout);
}

void spheres();
void laws();
void bodies();
void fluids();

}  // namespace hashes
