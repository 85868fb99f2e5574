// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <optional>

#include <silt/boundary/domain.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/symmetric3.hpp>
#include <silt/core/upper3.hpp>

namespace silt::inline SILT_TARGET {

/// Prescribes one component of the deformation of a DeformingBox: a rate, or a stress kept by a
/// servo.
struct BoxDrive {
  double rate = 0;                 // [1/s] strain rate; x, y, z: > 0 is extension
  std::optional<double> stress{};  // [Pa] x, y, z: compression > 0; xy, xz, yz: sign of the rate
  double most_rate = 0;            // [1/s] > 0, limit of the servo's rate in both directions
};

/// Deformation of a DeformingBox: along its axes, and by simple shear. xy: the velocity along x
/// grows with y, and so on. Components that are not given do not change.
///   silt::Deformation{.z = {.rate = -0.1}, .xy = {.rate = 5}}
struct Deformation {
  BoxDrive x{}, y{}, z{}, xy{}, xz{}, yz{};

  std::array<BoxDrive, 6> all() const { return {x, y, z, xy, xz, yz}; }
};

/// Stress [Pa] of the particles in a box: pressures on its faces, and shear stresses with the sign
/// of the shear rate that they resist.
struct BoxStress {
  double x = 0, y = 0, z = 0, xy = 0, xz = 0, yz = 0;
  double pressure() const { return (x + y + z) / 3; }
};

/// Box that is periodic in all directions and deforms by compression or extension of each axis and
/// by simple shear (Lees and Edwards). Each component has a rate, or a servo that keeps a stress.
///
///   silt::DeformingBox cell{{{0, 0, 0}, {0.02, 0.02, 0.02}}};
///   sim.deform({.x = {.stress = 1e5, .most_rate = 1}, .z = {.rate = -0.01}});
///
/// The velocity gradient L [1/s] is upper triangular. A change of it changes particle velocities by
///   v += (L_new - L_old) (x - c) + dt L^2 (x - c),   c: the centre of the box              (1)
/// This makes the flow homogeneous: no place in the box is special (SLLOD equations). An image
/// displaced by H n, with H the edges of the box, has an additional velocity L H n. Positions,
/// contacts and wrapping use these velocities in a form that is exact for finite steps.
///
/// Servo: the rate e of a component with the target p follows, with the mass m of all N particles,
///   M de/dt = V (P - p) - M g (e - b),   25 db/dt = g (e - b),                             (2)
///   M = m l^2/12, l = 2 (V/N)^(1/3), at most the edge: the box is as heavy as two layers,
///   g = 2 sqrt((3 V P_c/largest overlap + sum k a^2/5)/M): near-critical damping, with the part
///       P_c of the pressure that is not of bonds, and the stiffness k and length a of each bond,
/// limited to [-most_rate, most_rate]. The servo is passive: the only work it supplies is that of
/// p.
/// Source: A. W. Lees, S. F. Edwards, J. Phys. C 5 (1972) 1921; P. J. Daivis, B. D. Todd, J. Chem.
///         Phys. 124 (2006) 194103 (SLLOD for all homogeneous flows); the servo is silt's own.
/// Valid:  spheres and bodies without walls, inlets, outlets, gravity and fluid; edges of at least
///         three diameters. A body's centre of mass moves with the flow; only contacts turn it.
/// Units:  SI.
/// Errors: InputError for an impossible box or deformation.
/// Tests:  tests/engine/deforming_box.cpp, tests/engine/deforming_box_bodies.cpp,
///         tests/physics/deforming_box.cpp.
class DeformingBox {
 public:
  static constexpr bool is_domain = true;
  static constexpr bool periodic = true;
  static constexpr bool deforms = true;
  static constexpr const char* policy_name = "DeformingBox";

  explicit DeformingBox(const Box& box) : first_(box) {
    const auto e = box.extent();
    require(is_finite(e) && e.x > 0 && e.y > 0 && e.z > 0, "DeformingBox: its lengths ", e,
            " [m] must be finite and greater than 0");
    centre_ = box.centre();
    edges_ = {e.x, e.y, e.z, 0, 0, 0};
    inverse_ = {1 / e.x, 1 / e.y, 1 / e.z};
  }
  /// A template, which makes {{...}, {...}} unambiguously a Box.
  template <std::same_as<Deformation> How>
  DeformingBox(const Box& box, const How& how) : DeformingBox(box) {
    deform(how);
  }

  /// Deforms as `how` says, from the next step on.
  void deform(const Deformation& how) {
    static constexpr const char* names[6] = {"x", "y", "z", "xy", "xz", "yz"};
    const auto all = how.all();
    for (std::size_t k = 0; k < 6; ++k) {
      const BoxDrive& d = all[k];
      require(std::isfinite(d.rate), "Deformation.", names[k], ".rate = ", d.rate,
              " [1/s] must be finite");
      if (!d.stress) continue;
      require(std::isfinite(*d.stress), "Deformation.", names[k], ".stress = ", *d.stress,
              " [Pa] must be finite");
      require(d.rate == 0, "Deformation.", names[k],
              " has both a rate and a stress; set only one, the other follows from it");
      require(std::isfinite(d.most_rate) && d.most_rate > 0, "Deformation.", names[k],
              ".most_rate = ", d.most_rate,
              " [1/s] must be finite and greater than 0 with a prescribed stress");
    }
    drives_ = how;
  }

  // --- readings -----------------------------------------------------------------------------

  /// The box without its shear: a cuboid whose images fill space, each row of them shifted.
  Box box() const {
    const Vec3d half = 0.5 * Vec3d{edges_.xx, edges_.yy, edges_.zz};
    return {centre_ - half, centre_ + half};
  }
  const Box& first_box() const { return first_; }
  bool repeats(int) const { return true; }
  double length(int d) const { return d == 0 ? edges_.xx : d == 1 ? edges_.yy : edges_.zz; }  // [m]
  double volume() const { return edges_.determinant(); }  // [m3]
  const Upper3& edges() const { return edges_; }          // [m] as columns
  const Vec3d& centre() const { return centre_; }
  const Deformation& deformation() const { return drives_; }
  /// Stress of the particles in the last step, from contacts and from velocities relative to the
  /// flow and to the mean of all.
  const BoxStress& stress() const { return stress_; }
  /// Velocity gradient of the box [1/s].
  const Upper3& gradient() const { return rate_; }
  /// Strain since the start [-]: logarithms of the length ratios, integrals of the shear rates.
  const Upper3& strain() const { return strain_; }
  /// Work of the box on the particles since the start [J].
  double work() const { return work_; }
  /// Velocity [m/s] at p of the imposed flow. Particles move with it and with their own
  /// fluctuation.
  Vec3d flow_at(const Vec3d& p) const { return seen_ * (p - centre_); }

  // --- for searches and contacts --------------------------------------------------------------

  /// Shortest image of a distance vector.
  template <class Real>
  Vec3<Real> shortest(Vec3<Real> d) const {
    const Real z = turns(d.z, inverse_[2]);
    d.z -= z * Real(edges_.zz), d.y -= z * Real(edges_.yz), d.x -= z * Real(edges_.xz);
    const Real y = turns(d.y, inverse_[1]);
    d.y -= y * Real(edges_.yy), d.x -= y * Real(edges_.xy);
    d.x -= turns(d.x, inverse_[0]) * Real(edges_.xx);
    return d;
  }
  /// Additional velocity [m/s] of an image at the distance `shift` [m] from its particle.
  template <class Real>
  Vec3<Real> carried(const Vec3<Real>& shift) const {
    return step_gradient_ * shift;
  }
  /// Image of a point inside box().
  Vec3d wrapped(Vec3d p) const {
    const Vec3d low = box().min;
    const double z = std::floor((p.z - low.z) * inverse_[2]);
    p.z -= z * edges_.zz, p.y -= z * edges_.yz, p.x -= z * edges_.xz;
    const double y = std::floor((p.y - low.y) * inverse_[1]);
    p.y -= y * edges_.yy, p.x -= y * edges_.xy;
    p.x -= std::floor((p.x - low.x) * inverse_[0]) * edges_.xx;
    return p;
  }
  /// Rate at which lengths may shrink [1/s]: minus the smallest principal value of the strain rate.
  double squeeze_rate() const {
    const auto v =
        principal({rate_.xx, rate_.yy, rate_.zz, rate_.xy / 2, rate_.yz / 2, rate_.xz / 2}).values;
    return std::max(0.0, -std::min({v.x, v.y, v.z}));
  }
  /// Upper bound of the velocity [m/s] that the box imposes on a particle.
  double fastest() const {
    double most = 0;
    const auto all = drives_.all();
    const double arm[6] = {edges_.xx, edges_.yy, edges_.zz, edges_.yy, edges_.zz, edges_.zz};
    for (std::size_t k = 0; k < 6; ++k)
      most += 0.5 * arm[k] * (all[k].stress ? all[k].most_rate : std::abs(all[k].rate));
    return most;
  }

  // --- for the engine -------------------------------------------------------------------------

  /// Bonds in a step: sum F_a d_b [J]; sum of stiffness times length^2 [J].
  struct BondLoads {
    Upper3 virial;
    double stiffness = 0;
  };
  /// Contributions of the particles in a step: sum F_a d_b over contacts [J], overlap over the
  /// smaller radius [-].
  struct Loads {
    Upper3 virial;
    double largest_overlap;
    BondLoads bonds{};
  };
  /// Change of the velocities by (1) [1/s], to multiply with the distance from the centre.
  struct Kick {
    Upper3 all;       // before the forces act
    Upper3 too_much;  // part to remove from velocities recorded at this instant
  };
  /// Chooses the rates of the next step, after the forces of this step.
  Kick choose_rates(const Loads& loads, double dt, bool first) {
    book(loads.virial + loads.bonds.virial, dt);
    Upper3 jump{}, next{};
    const auto all = drives_.all();
    const auto old = rate_.values(), stress = pressures();
    std::array<double, 6> rate, leap{};
    for (std::size_t k = 0; k < 6; ++k) {
      rate[k] = all[k].stress ? servo(k, all[k], stress[k], stiffness_of(loads), dt) : all[k].rate;
      if (!all[k].stress) leap[k] = rate[k] - old[k], bias_[k] = rate[k];
    }
    next = Upper3::of(rate), jump = Upper3::of(leap);
    const Kick kick{next - step_gradient_, (first ? 1 : 0.5) * (next - step_gradient_ - jump)};
    rate_ = next, seen_ = next - kick.too_much;
    return kick;
  }
  /// Deforms the box over one step; returns the transformation of all distances.
  Upper3 advance(double dt) {
    const Upper3 step = Upper3::identity() + dt * rate_;
    require(step.xx > 0.5 && step.yy > 0.5 && step.zz > 0.5,
            "DeformingBox: the box halves in one step; lower its rates or the time step");
    edges_ = step * edges_;
    step_gradient_ = seen_ = rate_ * step.inverse();
    strain_ = strain_ + Upper3{std::log(step.xx), std::log(step.yy), std::log(step.zz),
                               dt * rate_.xy,     dt * rate_.xz,     dt * rate_.yz};
    straighten();
    inverse_ = {1 / edges_.xx, 1 / edges_.yy, 1 / edges_.zz};
    has_moved_ = true;
    return step;
  }
  /// Kinetic part, relative to the flow: sum m c_a c_b [J] of the last step; momentum [kg m/s],
  /// mass [kg] and number of all. The motion of the sample as a whole is no stress.
  void set_kinetic(const Upper3& sum, const Vec3d& momentum, double mass, double count) {
    kinetic_ = sum, mass_ = mass, count_ = count;
    bulk_ = mass > 0 ? (1 / mass) * upper_outer(momentum, momentum) : Upper3{};
  }

  // --- for checkpoints ----------------------------------------------------------------------

  static constexpr std::size_t state_size = 11 * 6 + 4 + 6 * 4;
  DynArray<double> state() const {
    DynArray<double> s{work_, mass_, count_, has_moved_ ? 1.0 : 0.0};
    const Upper3 stress{stress_.x, stress_.y, stress_.z, stress_.xy, stress_.xz, stress_.yz};
    for (const Upper3& m :
         {edges_, rate_, step_gradient_, seen_, strain_, virial_, kinetic_, bulk_, stress})
      for (const double v : m.values()) s.push_back(v);
    for (const double v : bias_) s.push_back(v);
    for (const double v : {centre_.x, centre_.y, centre_.z, 0.0, 0.0, 0.0}) s.push_back(v);
    for (const BoxDrive& d : drives_.all())
      for (const double v : {d.rate, d.stress ? 1.0 : 0.0, d.stress.value_or(0), d.most_rate})
        s.push_back(v);
    return s;
  }
  /// InputError if the numbers are not a valid state of a box.
  void restore(const DynArray<double>& s) {
    require(s.size() == state_size, "DeformingBox: a state of ", s.size(), " numbers, not ",
            state_size);
    for (const double v : s) require(std::isfinite(v), "DeformingBox: a state with ", v);
    std::size_t at = 4;
    const auto six = [&] {
      std::array<double, 6> v;
      for (double& x : v) x = s[at++];
      return v;
    };
    work_ = s[0], mass_ = s[1], count_ = s[2], has_moved_ = s[3] != 0;
    Upper3 stress;
    for (Upper3* m :
         {&edges_, &rate_, &step_gradient_, &seen_, &strain_, &virial_, &kinetic_, &bulk_, &stress})
      *m = Upper3::of(six());
    require(edges_.xx > 0 && edges_.yy > 0 && edges_.zz > 0,
            "DeformingBox: the state has an edge of length <= 0");
    stress_ = {stress.xx, stress.yy, stress.zz, stress.xy, stress.xz, stress.yz};
    bias_ = six();
    const auto c = six();
    centre_ = {c[0], c[1], c[2]};
    std::array<BoxDrive, 6> all;
    for (BoxDrive& d : all) {
      d.rate = s[at], d.most_rate = s[at + 3];
      if (s[at + 1] != 0) d.stress = s[at + 2];
      at += 4;
    }
    deform({all[0], all[1], all[2], all[3], all[4], all[5]});
    inverse_ = {1 / edges_.xx, 1 / edges_.yy, 1 / edges_.zz};
  }

 private:
  template <class Real>
  static Real turns(const Real& d, double inverse) {
    const Real big(6755399441055744.0);  // rounds to the nearest integer, in any lane width
    return (d * Real(inverse) + big) - big;
  }
  /// Replaces the edges by the nearest images of rows and layers, which allows unlimited shear.
  void straighten() {
    const double z = std::nearbyint(edges_.yz / edges_.yy);
    edges_.yz -= z * edges_.yy, edges_.xz -= z * edges_.xy;
    edges_.xy -= std::nearbyint(edges_.xy / edges_.xx) * edges_.xx;
    edges_.xz -= std::nearbyint(edges_.xz / edges_.xx) * edges_.xx;
  }
  /// Adds the work of the last step, and updates the stress.
  void book(const Upper3& virial, double dt) {
    if (has_moved_)
      work_ -= dt * (0.5 * (inner(virial_, rate_) + inner(virial, step_gradient_)) +
                     inner(kinetic_, rate_));
    virial_ = virial;
    const Upper3 p = (1 / volume()) * (virial_ + kinetic_ - bulk_);
    stress_ = {p.xx, p.yy, p.zz, -p.xy, -p.xz, -p.yz};
  }
  std::array<double, 6> pressures() const {
    return {stress_.x, stress_.y, stress_.z, -stress_.xy, -stress_.xz, -stress_.yz};
  }
  /// [J] stiffness in (2), of the volume.
  double stiffness_of(const Loads& l) const {
    const Upper3& b = l.bonds.virial;
    const double pressed = 3 * stress_.pressure() * volume() - (b.xx + b.yy + b.zz);
    return (l.largest_overlap > 0 ? std::max(pressed, 0.0) / l.largest_overlap : 0) +
           l.bonds.stiffness / 5;
  }
  /// Equation (2).
  double servo(std::size_t k, const BoxDrive& drive, double pressure, double stiffness, double dt) {
    const double old = rate_.values()[k];
    if (!(mass_ > 0)) return old;
    const double edge = k == 0 ? edges_.xx : k == 1 || k == 3 ? edges_.yy : edges_.zz;
    const double l = std::min(edge, 2 * std::cbrt(volume() / count_));
    const double inertia = mass_ * l * l / 12;  // [kg m2]
    const double target = k < 3 ? *drive.stress : -*drive.stress;
    const double damping = 2 * std::sqrt(stiffness / inertia);  // [1/s]
    const double pushed = old + dt * volume() * (pressure - target) / inertia;
    const double rate = (pushed + dt * damping * bias_[k]) / (1 + dt * damping);
    constexpr double slow = 25;  // inertia behind the damper, over that of the box
    const double share = dt * damping / slow;
    bias_[k] = (bias_[k] + share * rate) / (1 + share);
    bias_[k] = std::clamp(bias_[k], -drive.most_rate, drive.most_rate);
    return std::clamp(rate, -drive.most_rate, drive.most_rate);
  }

  Box first_;
  Deformation drives_;
  Vec3d centre_{0, 0, 0};
  Upper3 edges_;                        // [m]
  std::array<double, 3> inverse_{};     // [1/m]
  Upper3 rate_, step_gradient_, seen_;  // [1/s] of the step; for its end points; for velocities now
  Upper3 strain_;
  Upper3 virial_, kinetic_, bulk_;  // [J]
  BoxStress stress_;
  std::array<double, 6> bias_{};            // [1/s]
  double work_ = 0, mass_ = 0, count_ = 0;  // [J], [kg], [-]
  bool has_moved_ = false;
};

namespace detail {
/// Whether a domain changes its shape.
template <class Domain>
inline constexpr bool deforms = requires {
  requires Domain::deforms;
};
}  // namespace detail

}  // namespace silt
