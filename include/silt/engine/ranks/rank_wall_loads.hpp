// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include <silt/boundary/wall_drive.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The loads of walls on several ranks: by owned particles, and by those of all ranks.
struct RankWallLoads {
  struct Impulses {
    Vec3d impulse{0, 0, 0}, angular{0, 0, 0};  // [N s], [N m s]
  };
  DynArray<Impulses> own, shared;  // per wall: by owned particles; by all, when last shared

  void resize(std::size_t walls) { own.resize(walls), shared.resize(walls); }
  /// Sums the loads of walls by owned particles over all ranks. Unless `all` is set, only forces
  /// and torques of driven walls, which are needed in each step. `of_servos`: stiffness and damping
  /// at walls [N/m], [N s/m]; sum(numbers) replaces each by its sum over all ranks.
  template <class Walls, class Sum>
  void share(Walls& walls, bool all, std::span<std::array<double, 2>> of_servos, const Sum& sum) {
    resize(walls.size());
    const auto for_each_number = [&](const auto& number) {
      for (std::size_t w = 0; w < walls.size(); ++w) {
        auto& wall = walls[w];
        if (!all && !wall.is_driven()) continue;
        const auto vector = [&](Vec3d& v) { number(v.x), number(v.y), number(v.z); };
        vector(wall.force), vector(wall.torque);
        if (is_servo(wall.drive)) number(of_servos[w][0]), number(of_servos[w][1]);
        if (!all) continue;
        vector(wall.impulse), vector(wall.angular_impulse), number(wall.belt_power);
      }
    };
    for (std::size_t w = 0; all && w < walls.size(); ++w) {
      own[w].impulse += walls[w].impulse - shared[w].impulse;
      own[w].angular += walls[w].angular_impulse - shared[w].angular;
      walls[w].impulse = own[w].impulse, walls[w].angular_impulse = own[w].angular;
    }
    DynArray<double> numbers;
    for_each_number([&](double x) { numbers.push_back(x); });
    if (numbers.empty()) return;
    sum(std::span<double>(numbers));
    const double* next = numbers.data();
    for_each_number([&](double& x) { x = *next++; });
    for (std::size_t w = 0; all && w < walls.size(); ++w)
      shared[w] = {walls[w].impulse, walls[w].angular_impulse};
  }
  /// Must be called after the reference point of the loads of wall w has moved; `back` [m]: vector
  /// to the previous one.
  void move_reference(std::size_t w, const Vec3d& back) {
    if (w >= own.size()) return;
    own[w].angular += cross(back, own[w].impulse);
    shared[w].angular += cross(back, shared[w].impulse);
  }
};

}  // namespace silt::detail
