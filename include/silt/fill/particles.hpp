// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/quaternion.hpp>
#include <silt/fill/packing.hpp>
#include <silt/fill/particle_formats.hpp>
#include <silt/fill/region.hpp>
#include <silt/shape/sphere.hpp>

namespace silt::inline SILT_TARGET {

/// Request for a filling. Give `count` or `solid_volume`, or neither for as many as fit.
struct Fill {
  SizeDistribution radius{};  // [m] of spheres; for bodies: of the bounding sphere, left out: as
                              // the form was made
  double density = 0;         // [kg/m3]
  std::size_t count = as_many_as_fit;  // [-] number of particles
  double solid_volume = 0;             // [m3] of all spheres; 0: not used
  Arrangement arrangement = Arrangement::Lattice;
  double gap = 0;            // [m] smallest distance between surfaces
  std::uint64_t seed = 1;    // same seed, same spheres
  Vec3d velocity{0, 0, 0};   // [m/s] of each
  std::size_t material = 0;  // [-] index in the contacts' table

  std::size_t trials = 10000;  // [-] Arrangement::Random: failed trials before it stops

  // Only for bodies.
  std::size_t form = 0;                        // [-] number of the form
  std::optional<Quaternion> orientation = {};  // of all bodies; left out: random

  FillRequest request() const {
    return {radius, count, solid_volume, arrangement, gap, seed, trials};
  }
};

namespace detail {

/// Checks common to particles of all shapes.
template <class P>
void check_state(const P& p, std::size_t number) {
  require(is_finite(p.position), "particle ", number, ": position = ", p.position,
          " [m] must be finite");
  require(std::isfinite(p.density) && p.density > 0, "particle ", number, ": density = ", p.density,
          " [kg/m3] must be finite and greater than 0");
  require(is_finite(p.velocity), "particle ", number, ": velocity = ", p.velocity,
          " [m/s] must be finite");
  require(is_finite(p.angular_velocity), "particle ", number,
          ": angular_velocity = ", p.angular_velocity, " [rad/s] must be finite");
}
/// Overlaps are some thousandths of a radius. Where doubles are further apart than a
/// ten-thousandth, at 4.5e11 radii from the origin, forces would be arbitrary and slow particles
/// would not move.
inline void check_resolved(const Vec3d& position, double radius, std::size_t number) {
  const double apart = std::numeric_limits<double>::epsilon() *
                       std::max({std::abs(position.x), std::abs(position.y), std::abs(position.z)});
  require(apart <= 1e-4 * radius, "particle ", number, ": position = ", position,
          " [m] is so far from the origin that neighbouring numbers are ", sentence(apart),
          " m apart, too coarse for a radius of ", radius, " m; move the scene to the origin");
}

}  // namespace detail

/// Initial particles of a simulation.
///
///   silt::Particles<silt::Sphere> beads;
///   beads.fill({.min = {0, 0, 0}, .max = {0.1, 0.1, 0.2}},
///              {.radius = silt::uniform(1e-3, 2e-3), .density = 2500, .count = 10000});
///   beads.add({.position = {0, 0, 0.3}, .radius = 5e-3, .density = 7800});
/// Errors: InputError with the particle's number, the value, its unit and the allowed range.
template <class S>
class Particles {
  static_assert(Shape<S>, "Particles<S>: S must be a shape (silt/shape/concept.hpp)");

 public:
  using ShapeType = S;
  struct Particle {
    Vec3d position;                   // [m]
    double radius;                    // [m]
    double density;                   // [kg/m3]
    Vec3d velocity{0, 0, 0};          // [m/s]
    Vec3d angular_velocity{0, 0, 0};  // [rad/s]
    std::size_t material = 0;         // [-] index in the contacts' table
    bool fixed = false;               // keeps its velocity under any load
  };

  Particles& add(const Particle& p) {
    check(p, all_.size());
    all_.push_back(p);
    return *this;
  }
  /// Refuses an invalid initial state. A Simulation checks again, as [] may have changed it.
  static void check(const Particle& p, std::size_t number) {
    detail::check_state(p, number);
    require(std::isfinite(p.radius) && p.radius > 0, "particle ", number, ": radius = ", p.radius,
            " [m] must be finite and greater than 0");
    detail::check_resolved(p.position, p.radius, number);
  }

  /// Fills a region without overlap, including existing particles. If the request cannot be met,
  /// throws InputError and adds none; the message says how many would fit, and why no more.
  template <Region R>
  Particles& fill(const R& region, const Fill& fill) {
    detail::require_radius("Fill", fill.radius);
    detail::require_count("Fill", fill.count);
    require_positive("Fill.density", fill.density, "kg/m3");
    require(fill.form == 0 && !fill.orientation,
            "Fill: spheres have neither form nor orientation; leave both out");
    require(is_finite(fill.velocity), "Fill.velocity = ", fill.velocity, " [m/s] must be finite");
    DynArray<PlacedSphere> already;
    for (const auto& p : all_) already.push_back({p.position, p.radius});
    const auto result = pack(region, fill.request(), already);
    require(result.why_not_more.empty(), result.why_not_more);
    for (const auto& s : result.spheres)
      add({s.position, s.radius, fill.density, fill.velocity, {0, 0, 0}, fill.material});
    return *this;
  }
  Particles& fill(const Box& region, const Fill& f) { return fill<Box>(region, f); }

  /// Adds the particles of a file: a table with a header line, a dump or data file of LAMMPS or
  /// LIGGGHTS, or Yade's text, recognised by its content (fill/particle_formats.hpp).
  ///   grains.read("dump.granular", {.density = 2500, .timestep = 100000});
  Particles& read(const std::string& path, const ParticleFile& how) {
    const ParticleTable table = read_particles(path, how);
    const double density = how.density;
    const std::size_t material = how.material;
    require(!table.density.empty() || density > 0, "particle file '", path,
            "' has no column density; give Particles::read a density [kg/m3] greater than 0");
    const std::size_t before = all_.size();
    try {
      for (std::size_t k = 0; k < table.size(); ++k)
        add({table.position[k], table.radius[k], table.density.empty() ? density : table.density[k],
             table.velocity.empty() ? Vec3d{0, 0, 0} : table.velocity[k],
             table.angular_velocity.empty() ? Vec3d{0, 0, 0} : table.angular_velocity[k],
             table.material.empty() ? material : table.material[k]});
    } catch (const InputError& e) {
      all_.resize(before);
      throw InputError(text("particle file '", path, "': ", e.what()));
    }
    return *this;
  }
  Particles& read(const std::string& path, double density = 0, std::size_t material = 0) {
    return read(path, ParticleFile{.density = density, .material = material});
  }

  std::size_t size() const { return all_.size(); }
  const DynArray<Particle>& all() const { return all_; }
  const Particle& operator[](std::size_t k) const { return all_[k]; }
  Particle& operator[](std::size_t k) { return all_[k]; }
  auto begin() const { return all_.begin(); }
  auto end() const { return all_.end(); }

 private:
  DynArray<Particle> all_;
};

}  // namespace silt
