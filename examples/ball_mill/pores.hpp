// silt - BSD-3-Clause, see LICENSE
#pragma once

// Filling of the pores between the balls with slurry, as a map in a view along the axis.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "ball_mill/scene.hpp"

namespace ball_mill {

/// Sums over frames, in square cells of the view: slurry, and pore volume.
class PoreFill {
 public:
  struct Share {
    double bed = 0,
           pool = 0;    // [-] slurry over room, where balls are dense and where there are none
    double in_bed = 0;  // [-] of the slurry, where balls are dense
  };
  PoreFill(const Scene& s, double spacing)
      : radius_(s.radius()),
        length_(s.length),
        spacing_(spacing),
        across_(static_cast<std::size_t>(std::ceil(2 * radius_ / cell))),
        slurry_(across_ * across_, 0),
        room_(across_ * across_, 0) {}
  template <class Sim>
  void add_frame(const Sim& sim) {
    ++frames_;
    sim.fluid().for_each([&](std::uint32_t, const Vec3d& x, const Vec3d&, double, double) {
      slurry_[at(x.x, x.z)] += spacing_ * spacing_ * spacing_;
    });
    const double step = cell / 2;
    const int deep = static_cast<int>(std::ceil(length_ / step));
    const double volume = step * step * length_ / deep;
    for (std::size_t i = 0; i < 2 * across_; ++i)
      for (std::size_t k = 0; k < 2 * across_; ++k) {
        const double x = -radius_ + (static_cast<double>(i) + 0.5) * step,
                     z = -radius_ + (static_cast<double>(k) + 0.5) * step;
        if (std::hypot(x, z) > radius_) continue;
        std::vector<char> taken(static_cast<std::size_t>(deep), 0);
        for (std::size_t b = 0; b < sim.rows(); ++b) {
          const Vec3d& c = sim.position(b);
          const double r = sim.radius(b), dx = x - c.x, dz = z - c.z,
                       left = r * r - dx * dx - dz * dz;
          if (left <= 0) continue;
          for (int j = 0; j < deep; ++j) {
            const double y = (j + 0.5) * length_ / deep - c.y;
            if (y * y < left) taken[static_cast<std::size_t>(j)] = 1;
          }
        }
        for (const char is : taken)
          if (is == 0) room_[at(x, z)] += volume;
      }
  }
  /// All cells at least two cells below the surface(x) [m] and within the drum.
  template <class Surface>
  Share below(const Surface& surface) const {
    double bed = 0, bed_room = 0, pool = 0, pool_room = 0, all = 0, dense = 0;
    for (std::size_t i = 0; i < across_; ++i)
      for (std::size_t k = 0; k < across_; ++k) {
        const double x = -radius_ + (static_cast<double>(i) + 0.5) * cell,
                     z = -radius_ + (static_cast<double>(k) + 0.5) * cell;
        const std::size_t c = i * across_ + k;
        all += slurry_[c];
        const double free = room_[c] / (static_cast<double>(frames_) * cell * cell * length_);
        if (free < 0.6) dense += slurry_[c];
        if (std::hypot(x, z) > radius_ - 2 * cell || z > surface(x) - 2 * cell) continue;
        if (free < 0.6)
          bed += slurry_[c], bed_room += room_[c];
        else if (free > 0.9)
          pool += slurry_[c], pool_room += room_[c];
      }
    return {bed_room > 0 ? bed / bed_room : 0, pool_room > 0 ? pool / pool_room : 0,
            all > 0 ? dense / all : 0};
  }
  /// visit(x, z, fraction of the space that is pore, fraction of the space that is slurry).
  template <class Visit>
  void for_each(const Visit& visit) const {
    const double whole = static_cast<double>(frames_) * cell * cell * length_;
    for (std::size_t i = 0; i < across_; ++i)
      for (std::size_t k = 0; k < across_; ++k)
        visit(-radius_ + (static_cast<double>(i) + 0.5) * cell,
              -radius_ + (static_cast<double>(k) + 0.5) * cell, room_[i * across_ + k] / whole,
              slurry_[i * across_ + k] / whole);
  }

 private:
  static constexpr double cell = 15e-3;  // [m]
  std::size_t at(double x, double z) const {
    const auto place = [this](double a) {
      const auto k = static_cast<std::ptrdiff_t>(std::floor((a + radius_) / cell));
      return static_cast<std::size_t>(
          std::clamp<std::ptrdiff_t>(k, 0, static_cast<std::ptrdiff_t>(across_) - 1));
    };
    return place(x) * across_ + place(z);
  }
  double radius_, length_, spacing_;
  std::size_t across_, frames_ = 0;
  std::vector<double> slurry_, room_;  // [m3] summed over frames
};

}  // namespace ball_mill
