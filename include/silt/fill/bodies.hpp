// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/names.hpp>
#include <silt/fill/particles.hpp>
#include <silt/shape/concept.hpp>
#include <silt/shape/narrow/kinds.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {
/// Parts of a SolidShape; empty for others.
template <class S>
struct SolidsOfForm {};
template <SolidShape S>
struct SolidsOfForm<S> {
  DynArray<SolidPart<typename S::Kinds>> solids;
};
/// Counts the forms created by a program.
inline std::uint64_t next_form() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}
}  // namespace detail

/// A form in the engine: in its principal frame, about its centroid.
template <class S>
struct BodyForm : detail::SolidsOfForm<S> {
  S shape;  // as given by the user
  MassProperties mass;
  DynArray<Ball> parts;  // its spheres, or bounding spheres of its parts
  double radius;         // [m] bounding sphere about the centroid
  /// [m] largest |r x n| along each principal axis, over the surface points r from the centroid and
  /// their normals n: with an angular velocity w no point moves faster along its normal than the
  /// sum of |w_i| lever_i. For solids from 1000 normals: up to 10 % too small.
  Vec3d lever{0, 0, 0};
  /// For a solid shape, for many normals: radius at the contact [m], and mass over the effective
  /// mass at that point [-].
  struct Spot {
    double radius, lightness;
  };
  DynArray<Spot> spots;
  std::string name;  // empty: none

  explicit BodyForm(S given) : shape(std::move(given)) {
    shape.check();
    mass = shape.mass_properties();
    radius = 0;
    if constexpr (SolidShape<S>) {
      this->solids = shape.solids(mass);
      for (const auto& part : this->solids) {
        parts.push_back({part.centre, bound_of(part.solid)});
        find_spots(part, std::max<std::size_t>(300 / this->solids.size(), 30));
      }
    } else {
      for (const Ball& b : shape.parts())
        parts.push_back({rotate(conjugate(mass.axes), b.centre - mass.centroid), b.radius});
      for (const Ball& b : parts) {
        const Vec3d& c = b.centre;  // a ball has normals in all directions
        widen_lever({std::hypot(c.y, c.z), std::hypot(c.z, c.x), std::hypot(c.x, c.y)});
      }
    }
    for (const Ball& b : parts) radius = std::max(radius, norm(b.centre) + b.radius);
  }

  /// The same for all copies of a form and different for other forms, within one run of the
  /// program.
  std::uint64_t made() const { return made_; }
  bool is_copy_of(const BodyForm& b) const { return made_ == b.made_; }
  /// Whether `b` is a copy of this form, or has the same shape: they count as one form.
  bool is(const BodyForm& b) const {
    if (is_copy_of(b)) return true;
    if constexpr (std::equality_comparable<S>)
      return shape == b.shape;
    else
      return false;
  }

  /// Passes the parts of a particle of this form to `lightest`: the mass is the effective one at
  /// the end of the longest lever.
  template <class Lightest>
  void include_lightest(Lightest& lightest, double scale, double of_body) const {
    for (const Spot& s : spots) lightest.include({scale * s.radius, of_body / s.lightness});
    if (!spots.empty()) return;
    double lever2 = 0;
    for (const Ball& b : parts) lever2 = std::max(lever2, dot(b.centre, b.centre));
    const double least = std::min({mass.inertia.x, mass.inertia.y, mass.inertia.z}) / mass.volume;
    for (const Ball& b : parts)
      lightest.include({scale * b.radius, of_body / (1 + lever2 / least)});
  }

 private:
  template <class Solid>
  static double bound_of(const Solid& solid) {
    return std::visit(
        [](const auto& part) { return KernelOf<std::decay_t<decltype(part)>>::bound(part); },
        solid);
  }
  void widen_lever(const Vec3d& of) {
    lever = {std::max(lever.x, std::abs(of.x)), std::max(lever.y, std::abs(of.y)),
             std::max(lever.z, std::abs(of.z))};
  }
  /// The k-th of `count` normals spread uniformly over the sphere, by the golden angle.
  static Vec3d normal_of(std::size_t k, std::size_t count) {
    const double z = 1 - (2 * static_cast<double>(k) + 1) / static_cast<double>(count);
    const double r = std::sqrt(1 - z * z);
    const double turn = static_cast<double>(k) * std::numbers::pi * (3 - std::sqrt(5.0));
    return {r * std::cos(turn), r * std::sin(turn), z};
  }
  template <class Part>
  void find_spots(const Part& part, std::size_t count) {
    std::visit(
        [&](const auto& solid) {
          using Narrow = KernelOf<std::decay_t<decltype(solid)>>;
          typename Narrow::Store store;
          const auto body =
              Narrow::place(Narrow::row(solid, 1, store), body_axes(part.axes), part.centre);
          constexpr std::size_t many = 1000;  // [-] BodyForm::lever
          for (std::size_t k = 0; k < many; ++k) {
            const Vec3d n = normal_of(k, many);
            widen_lever(cross(body.support(n), n));
          }
          for (std::size_t k = 0; k < count; ++k) {
            const Vec3d n = normal_of(k, count), arm = cross(body.support(n), n);
            const Vec3d& I = mass.inertia;
            spots.push_back({contact_radius_at(body, n),
                             1 + mass.volume * (arm.x * arm.x / I.x + arm.y * arm.y / I.y +
                                                arm.z * arm.z / I.z)});
          }
        },
        part.solid);
  }

  std::uint64_t made_ = detail::next_form();
};

namespace detail {
/// Radius of the bounding sphere of a form as it was made [m]. InputError if it has no size.
template <class S>
double size_as_made(const char* of, const BodyForm<S>& form) {
  if constexpr (requires(const S& shape) { shape.has_size(); })
    require(form.shape.has_size(), of, ".radius is not given: the form of a Sphere",
            after_number(form.name), " has no size of its own; give a radius [m]");
  return form.radius;
}
}  // namespace detail

/// Random orientation, uniformly distributed.
/// Source: K. Shoemake, in Graphics Gems III (1992) 124.
inline Quaternion random_orientation(Random& random) {
  const double u = random.uniform(0, 1), a = random.uniform(0, 2 * std::numbers::pi),
               b = random.uniform(0, 2 * std::numbers::pi);
  const double p = std::sqrt(1 - u), q = std::sqrt(u);
  return {q * std::cos(b), p * std::sin(a), p * std::cos(a), q * std::sin(b)};
}

/// Initial bodies of a simulation: each has one of the forms, with its own size.
///
///   silt::Particles<silt::MultiSphere> stones;
///   const auto pebble = stones.add_form(silt::read_multi_sphere("pebble.txt"));
///   stones.fill({.min = {0, 0, 0}, .max = {0.1, 0.1, 0.2}},
///               {.radius = silt::uniform(4e-3, 6e-3), .density = 2500, .form = pebble});
/// Errors: InputError with the particle's number, the value, its unit and the allowed range.
template <BodyShape S>
class Particles<S> {
 public:
  using ShapeType = S;
  struct Particle {
    std::size_t form = 0;             // [-] number from add_form
    Vec3d position;                   // [m] of the centre of mass
    Quaternion orientation = {};      // rotates the frame of the form to space
    double radius = 0;                // [m] of its bounding sphere; 0: as the form was made
    double density = 0;               // [kg/m3]
    Vec3d velocity{0, 0, 0};          // [m/s]
    Vec3d angular_velocity{0, 0, 0};  // [rad/s] in space
    std::size_t material = 0;         // [-] index in the contacts' table
    bool fixed = false;               // keeps its velocity under any load
  };

  /// Returns the form's number. A `name` is unique, and is used in messages.
  std::size_t add_form(S shape, std::string name = {}) {
    if (!name.empty()) names().check(name, forms_.size());
    detail::check_named("form", name, [&] { forms_.emplace_back(std::move(shape)); });
    forms_.back().name = std::move(name);
    return forms_.size() - 1;
  }
  /// Number of the form with this name.
  std::size_t find_form(std::string_view name) const { return names().number_of(name); }

  Particles& add(Particle p) {
    check(p, all_.size());
    if (p.radius == 0) p.radius = forms_[p.form].radius;
    all_.push_back(p);
    return *this;
  }
  /// As for spheres.
  void check(const Particle& p, std::size_t number) const { check(p, number, forms_); }
  static void check(const Particle& p, std::size_t number, std::span<const BodyForm<S>> forms) {
    require(p.form < forms.size(), "particle ", number, ": form = ", p.form, " must be less than ",
            forms.size(), ", the number of forms; call add_form first");
    detail::check_state(p, number);
    const Quaternion& q = p.orientation;
    const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    require(std::abs(length - 1) < 1e-6, "particle ", number, ": orientation has length ", length,
            " [-], but must be a unit quaternion");
    require(std::isfinite(p.radius) && p.radius >= 0, "particle ", number, ": radius = ", p.radius,
            " [m] must be finite and not negative");
    if constexpr (requires(const S& form) { form.has_size(); })
      require(p.radius > 0 || forms[p.form].shape.has_size(), "particle ", number,
              ": radius = 0 [m] must be greater than 0: the form of a Sphere",
              detail::after_number(forms[p.form].name), " has no size of its own");
    detail::check_resolved(p.position, p.radius > 0 ? p.radius : forms[p.form].radius, number);
  }

  /// Fills a region without overlap of bounding spheres, including those of existing particles.
  /// Without a radius the bodies have the size of their form as it was made. If the request cannot
  /// be met, throws InputError and adds none; the message says how many would fit, and why no more.
  template <Region R>
  Particles& fill(const R& region, const Fill& fill) {
    detail::require_count("Fill", fill.count);
    require_positive("Fill.density", fill.density, "kg/m3");
    require(is_finite(fill.velocity), "Fill.velocity = ", fill.velocity, " [m/s] must be finite");
    require(fill.form < forms_.size(), "Fill.form = ", fill.form, " must be less than ",
            forms_.size(), ", the number of forms; call add_form first");
    const BodyForm<S>& form = forms_[fill.form];
    DynArray<PlacedSphere> already;
    for (const auto& p : all_) already.push_back({p.position, p.radius});
    FillRequest request = fill.request();
    if (!fill.radius.is_given()) request.radius = detail::size_as_made("Fill", form);
    request.solid_volume *=
        4.0 / 3 * std::numbers::pi * form.radius * form.radius * form.radius / form.mass.volume;
    const auto result = pack(region, request, already);
    require(result.why_not_more.empty(), "of bounding spheres: ", result.why_not_more);
    Random random(fill.seed + 0x9e3779b97f4a7c15ull);
    for (const auto& s : result.spheres)
      add({.form = fill.form,
           .position = s.position,
           .orientation = fill.orientation ? *fill.orientation : random_orientation(random),
           .radius = s.radius,
           .density = fill.density,
           .velocity = fill.velocity,
           .material = fill.material});
    return *this;
  }
  Particles& fill(const Box& region, const Fill& f) { return fill<Box>(region, f); }

  const DynArray<BodyForm<S>>& forms() const { return forms_; }
  std::size_t size() const { return all_.size(); }
  const DynArray<Particle>& all() const { return all_; }
  const Particle& operator[](std::size_t k) const { return all_[k]; }
  Particle& operator[](std::size_t k) { return all_[k]; }
  auto begin() const { return all_.begin(); }
  auto end() const { return all_.end(); }

 private:
  auto names() const { return detail::names_in("form", forms_, "add_form(shape, name)"); }

  DynArray<BodyForm<S>> forms_;
  DynArray<Particle> all_;
};

}  // namespace silt
