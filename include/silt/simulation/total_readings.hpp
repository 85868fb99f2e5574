// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <silt/boundary/deforming_box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/vec3.hpp>
#include <silt/module/heat/temperature.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Sums and means over all particles that are present and not fixed, at time(); member functions of
/// Simulation, for use between runs and in observers. Each costs O(rows). Means over no particles
/// throw InputError. With several ranks the particles of all ranks are included, and all functions
/// but those of one particle are collective (RankAccess). Tests: tests/engine/total_readings.cpp.
template <class Sim>
class TotalReadings {
 public:
  /// [J] of translation and rotation; in a DeformingBox relative to its flow, as in the ledger.
  double kinetic_energy() const {
    return sum_of([this](std::size_t k) { return kinetic_energy(k); });
  }
  /// [J] its rotational part.
  double rotational_energy() const {
    return sum_of([this](std::size_t k) { return rotational_energy(k); });
  }
  /// [J] of one particle; 0 for a fixed one.
  double kinetic_energy(std::size_t k) const {
    return translational_energy(k) + rotational_energy(k);
  }
  double translational_energy(std::size_t k) const {
    if (!counts(k)) return 0;
    Vec3d v = sim().velocity(k);
    if constexpr (deforms<typename Sim::Domain>) v -= sim().domain().flow_at(sim().position(k));
    return 0.5 * sim().mass(k) * dot(v, v);
  }
  double rotational_energy([[maybe_unused]] std::size_t k) const {
    if constexpr (Sim::rotates)
      if (counts(k)) return sim().engine().owner(k).rotational_energy(sim().angular_velocity(k));
    return 0;
  }
  double total_mass() const {  // [kg]
    return sum_of([this](std::size_t k) { return sim().mass(k); });
  }
  /// [m] from the present positions; of little meaning for material that extends across a periodic
  /// side.
  Vec3d centre_of_mass() const {
    Vec3d sum{0, 0, 0};
    for_each([&](std::size_t k) { sum += sim().mass(k) * sim().position(k); });
    return (1 / mass_for("centre_of_mass")) * sim().sum_over_ranks(sum);
  }
  /// [m/s] velocity of the centre of mass.
  Vec3d mean_velocity() const {
    Vec3d sum{0, 0, 0};
    for_each([&](std::size_t k) { sum += sim().mass(k) * sim().velocity(k); });
    return (1 / mass_for("mean_velocity")) * sim().sum_over_ranks(sum);
  }
  /// [m/s] of centres, number average.
  double mean_speed() const {
    const double n = sum_of([](std::size_t) { return 1.0; });
    need(n > 0, "mean_speed");
    return sum_of([this](std::size_t k) { return norm(sim().velocity(k)); }) / n;
  }
  double largest_speed() const {  // [m/s] of centres; 0 without particles
    double most = 0;
    for_each([&](std::size_t k) { most = std::max(most, norm(sim().velocity(k))); });
    return sim().largest_over_ranks(most);
  }
  /// [K] weighted by heat capacities: the temperature of the particles if they equilibrated.
  template <class S = Sim>
  double mean_temperature() const {
    const auto& module = sim().template module<typename S::Modules::template having<HeatFields>>();
    double heat = 0, capacity = 0;
    for_each([&](std::size_t k) {
      const double C = module.capacity(sim().engine().seen(k, sim().time()));
      heat += C * sim().template field<Temperature>(k), capacity += C;
    });
    heat = sim().sum_over_ranks(heat), capacity = sim().sum_over_ranks(capacity);
    need(capacity > 0, "mean_temperature");
    return heat / capacity;
  }

 private:
  const Sim& sim() const { return static_cast<const Sim&>(*this); }
  bool counts(std::size_t k) const { return sim().is_present(k) && std::isfinite(sim().mass(k)); }
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t k = 0; k < sim().rows(); ++k)
      if (counts(k)) visit(k);
  }
  template <class Value>
  double sum_of(const Value& value) const {
    double sum = 0;
    for_each([&](std::size_t k) { sum += value(k); });
    return sim().sum_over_ranks(sum);
  }
  double mass_for(const char* function) const {
    const double mass = total_mass();
    need(mass > 0, function);
    return mass;
  }
  static void need(bool some, const char* function) {
    require(some, "Simulation::", function,
            ": there is no particle, or all are fixed; ask once there are others");
  }
};

}  // namespace silt::detail
