// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <silt/boundary/domain.hpp>
#include <silt/boundary/wall.hpp>
#include <silt/contact/hertz_mindlin.hpp>

#include "study/shape_models.hpp"

namespace studies::shape {

/// Common settings of all scenes except impacts.
inline constexpr silt::HertzMindlin::Material stone{
    .youngs_modulus = 5e6, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.5};
inline constexpr double density = 2500;  // [kg/m3]

struct Grain {
  Vec3d position;                     // [m] of the centre of mass
  silt::Quaternion orientation = {};  // turns the frame of the form to space
  Vec3d velocity{0, 0, 0};            // [m/s]
};

/// Initial positions of grains.
struct World {
  silt::PeriodicBox period;
  silt::HertzMindlin::Material material = stone;
  Vec3d gravity{0, 0, -9.81};  // [m/s2]
};

/// A simulation of grains of one model, hidden behind an interface: scenes are written once.
class Crowd {
 public:
  virtual ~Crowd() = default;
  virtual void add_wall(silt::Surfaces surfaces, silt::Motion motion = {}) = 0;
  virtual void remove_wall(std::size_t k) = 0;
  virtual void add(const std::vector<Grain>& grains) = 0;
  virtual void run(double duration) = 0;  // [s]

  virtual std::size_t size() const = 0;
  virtual Grain grain(std::size_t k) const = 0;             // in the order they were added
  virtual Vec3d angular_velocity(std::size_t k) const = 0;  // [rad/s]
  virtual Vec3d angular_momentum(std::size_t k) const = 0;  // [kg m2/s] about its centre
  virtual double mass() const = 0;                          // [kg] of one
  virtual double kinetic_energy() const = 0;                // [J]
  virtual double time() const = 0;                          // [s]
  virtual double step_length() const = 0;                   // [s]
  virtual double peak_overlap() const = 0;                  // [-] of the guard's radius
  virtual Vec3d force_on_wall(std::size_t k) const = 0;     // [N]
  /// Mean number of grains in contact with a grain; several touching parts of a pair count once.
  virtual double partners() const = 0;
  virtual void write(const std::string& path) const = 0;  // surfaces, for pictures
};

std::unique_ptr<Crowd> make_crowd(const Model& model, const World& world,
                                  const std::vector<Grain>& grains);

/// [m] between grains at the start: more than the largest diameter of any shape.
inline constexpr double pitch = 3.3 * radius;

/// Up to `count` grains on a lattice of cells[0] by cells[1] by cells[2] sites from `corner` on,
/// layer by layer, in random orientations, falling at random speeds.
std::vector<Grain> lattice(const Vec3d& corner, const std::array<int, 3>& cells, std::size_t count,
                           std::uint64_t seed);

/// A bed at rest.
struct Bed {
  double solid_fraction;  // [-] away from floor and surface
  double partners;        // [-] that a grain touches
  double height;          // [m]
  double cost;            // [-] s of processor time over s that a grain lives
  double step;            // [s]
  double unrest;          // [m/s] root mean square of speeds at the end
  double overlap;         // [-] the largest ever, as the guard counts it
};
Bed settled_bed(const Model& model, std::size_t count, std::uint64_t seed);

/// The remainder of a column next to a wall after the opposite wall was removed.
struct Heap {
  double angle;      // [degrees] of the wedge on the wall that has its centre of mass there
  double reach = 0;  // [m] of the farthest grain from the wall
  double cost;       // as of a bed
  double unrest;     // [m/s]
};
Heap heap_of(const Model& model, std::size_t count, std::uint64_t seed,
             const std::string& picture = "");

/// A rotating drum, measured for `turns` after a third of a turn.
struct Drum {
  double angle;  // [degrees] of the middle of the surface, in the mean over time
  double cost;
  std::size_t grains;
};
Drum drum_of(const Model& model, std::size_t count, std::uint64_t seed, double turns,
             const std::string& picture = "");

}  // namespace studies::shape
