// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/simulation.hpp>

namespace engine_test {

using silt::Box;
using silt::HertzMindlin;
using silt::Sphere;
using silt::Vec3d;

/// Soft enough for long steps: contacts of 1 mm spheres at 1 m/s last about 2e-4 s.
inline constexpr HertzMindlin::Material rubber{
    .youngs_modulus = 1e6, .poisson_ratio = 0.3, .restitution = 0.7, .friction = 0.5};

/// An observer that counts the searches it sees.
struct Searches {
  std::int64_t last = -1;
  std::size_t count = 0;
  template <class Sim>
  void operator()(const Sim& sim) {
    const auto at = sim.engine().lists.upkeep.searched_at;
    count += at != last, last = at;
  }
};

/// Everything about one particle that a run may change.
struct ParticleBits {
  silt::ParticleId id;
  std::array<double, 9> values;  // position [m], velocity [m/s], angular velocity [rad/s]
  bool operator==(const ParticleBits&) const = default;
};

/// The state of all particles that are present, in the order of their ids.
template <class Sim>
std::vector<ParticleBits> bits(const Sim& sim) {
  std::vector<ParticleBits> all;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    if (!sim.is_present(k)) continue;
    const Vec3d x = sim.position(k), v = sim.velocity(k);
    Vec3d w{0, 0, 0};
    if constexpr (Sim::rotates) w = sim.angular_velocity(k);
    all.push_back({sim.id(k), {x.x, x.y, x.z, v.x, v.y, v.z, w.x, w.y, w.z}});
  }
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  return all;
}

/// The error of type E that `action` throws, with an empty sentence if it throws none.
template <class E, class Action>
std::string refusal(Action&& action) {
  try {
    action();
  } catch (const E& error) {
    return error.what();
  }
  return {};
}

/// Whether a sentence holds all of `words`; says which one is missing.
inline bool has_words(const std::string& sentence, std::initializer_list<std::string> words) {
  for (const auto& word : words)
    if (sentence.find(word) == std::string::npos) {
      MESSAGE("'" << word << "' is missing in: '" << sentence << "'");
      return false;
    }
  return true;
}

}  // namespace engine_test
