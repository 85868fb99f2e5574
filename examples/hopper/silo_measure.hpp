// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is measured of the silo: what rings of the mantle and rows of the cone's facets bear, and
// Janssen's law with the bulk density and the stress ratios that were measured.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "hopper/silo_scene.hpp"

namespace silo {

/// Mean loads on rings of the cylinder wall, from the cone up, and the weight of the grains beside
/// each.
class Rings {
 public:
  explicit Rings(const Scene& s)
      : s_(s), normal_(s.rings()), shear_(s.rings()), weight_(s.rings()) {}

  template <class Sim>
  void add(const Sim& sim) {
    const auto parts = silt::ring_loads(sim, "mantle", normal_.size());
    for (std::size_t k = 0; k < parts.size(); ++k)
      normal_[k] += parts[k].pressure(), shear_[k] -= parts[k].force.z / parts[k].area;
    for (std::size_t k = 0; k < sim.rows(); ++k) {
      if (!sim.is_present(k) || sim.position(k).z < s_.cone()) continue;
      const auto ring = static_cast<std::size_t>((sim.position(k).z - s_.cone()) / s_.ring());
      weight_[std::min(ring, weight_.size() - 1)] += g * sim.mass(k);
    }
    ++samples_;
  }
  double pressure(std::size_t k) const { return normal_[k] / samples_; }  // [Pa]
  double shear(std::size_t k) const { return shear_[k] / samples_; }      // [Pa] that holds grains
  /// [kg/m3] bulk density between the cone and one diameter below the surface.
  double density() const {
    double weight = 0;
    const std::size_t n = filled() - Scene::per_diameter;
    for (std::size_t k = 0; k < n; ++k) weight += weight_[k] / samples_;
    return weight / (g * s_.area() * s_.ring() * static_cast<double>(n));
  }
  /// [m] depth of the middle of ring k below the surface, the latter computed from the grains above
  /// and this bulk density.
  double depth(std::size_t k) const {
    double weight = 0.5 * weight_[k];
    for (std::size_t j = k + 1; j < weight_.size(); ++j) weight += weight_[j];
    return weight / samples_ / (g * s_.area() * density());
  }
  /// [Pa] vertical stress at the middle of ring k: the weight above minus the shear on the rings.
  double vertical(std::size_t k) const {
    double sum = 0.5 * carried(k);
    for (std::size_t j = k + 1; j < weight_.size(); ++j) sum += carried(j);
    return sum / s_.area();
  }
  std::size_t filled() const {  // [rings] with half a bed or more beside them
    std::size_t n = 0;
    const double bed = 0.5 * 0.6 * Scene::density * g * s_.area() * s_.ring();
    while (n < weight_.size() && weight_[n] / samples_ > bed) ++n;
    return n;
  }

 private:
  double carried(std::size_t k) const {  // [N] weight beside a ring less what it holds
    return weight_[k] / samples_ - shear(k) * std::numbers::pi * s_.diameter() * s_.ring();
  }
  const Scene& s_;
  std::vector<double> normal_, shear_, weight_;
  double samples_ = 0;
};

/// Janssen's law: the forces on a slice of the bed are its weight, the stresses above and below,
/// and wall shear, m times the pressure on the wall; that pressure is K times the vertical stress.
/// m and K are constants. H. A. Janssen, Z. VDI 39 (1895) 1045.
struct Janssen {
  double rho, D, m, K;               // [kg/m3], [m], [-], [-]
  double pressure(double z) const {  // [Pa] on the wall at depth z
    return rho * g * D / (4 * m) * (1 - std::exp(-4 * m * K * z / D));
  }
  /// Rms deviation of the pressures of the same rings from this law [-].
  double off(const Rings& rings) const {
    double sum = 0, n = 0;
    for (std::size_t k = Scene::per_diameter / 2; k + Scene::per_diameter < rings.filled(); ++k)
      sum += std::pow(rings.pressure(k) / pressure(rings.depth(k)) - 1, 2), n += 1;
    return std::sqrt(sum / n);
  }
  /// m and K from rings: sums of stresses from half a diameter above the cone to one below the
  /// surface.
  static Janssen of(const Rings& rings, const Scene& s) {
    double normal = 0, shear = 0, vertical = 0;
    for (std::size_t k = Scene::per_diameter / 2; k + Scene::per_diameter < rings.filled(); ++k)
      normal += rings.pressure(k), shear += rings.shear(k), vertical += rings.vertical(k);
    return {rings.density(), s.diameter(), shear / normal, normal / vertical};
  }
};

/// Mean pressures [Pa] on rows of the cone's facets, from the outlet up.
class Rows {
 public:
  explicit Rows(const Scene& s) : normal_(s.rows()), area_(s.rows()) {}

  template <class Sim>
  void add(const Sim& sim) {
    const auto loads = silt::facet_loads(sim, "cone");
    const std::size_t of_row = loads.size() / normal_.size();
    sum_ = {0, 0, 0};
    for (std::size_t t = 0; t < loads.size(); ++t) {
      normal_[t / of_row] += loads[t].normal, area_[t / of_row] += loads[t].area;
      sum_ += loads[t].force;
    }
  }
  double pressure(std::size_t row) const { return normal_[row] / area_[row]; }
  Vec3d sum() const { return sum_; }  // [N] of the last sample

 private:
  std::vector<double> normal_, area_;
  Vec3d sum_{};
};

}  // namespace silo
