// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/quaternion.hpp>
#include <silt/core/vec3.hpp>
#include <silt/coupling/particles_in_fluid.hpp>
#include <silt/sph/body_form.hpp>
#include <silt/sph/setup.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Particles of bodies in the liquid, each with its mirror image across the surface. Forces on them
/// act on the body. Spheres have shells below their surface, the first at half a spacing, then one
/// spacing apart, to the depth of the kernel's support; other bodies have a lattice (LiquidForm).
class BodyPoints {
 public:
  struct Body {
    Vec3d centre{0, 0, 0}, velocity{0, 0, 0}, spin{0, 0, 0};  // [m], [m/s], [rad/s]
    double radius = 0;                                        // [m] of the sphere of equal volume
    Quaternion axes{};                                        // principal axes to space
    std::uint32_t form = sphere;
    double reach = 0;  // [m] from the centre
    Vec3d force{0, 0, 0}, torque{0, 0, 0};

    bool is(const Body& b) const { return radius == b.radius && form == b.form; }
  };
  static constexpr std::uint32_t sphere = ~std::uint32_t{0};
  DynArray<Body> bodies;

  std::size_t size() const { return points_.size(); }
  bool empty() const { return points_.empty(); }
  std::size_t body_of(std::size_t k) const { return points_[k].body; }
  /// First point of each body, and the end of the last.
  const DynArray<std::size_t>& begin() const { return begin_; }
  /// [-] share of a particle's volume and mass.
  double share(std::size_t k) const { return points_[k].share; }
  /// [m] from the centre, in the body's frame.
  const Vec3d& own_place(std::size_t k) const { return points_[k].at; }
  const Vec3d& own_ghost(std::size_t k) const { return points_[k].ghost; }
  Vec3d place(std::size_t k) const { return in_space(points_[k].body, points_[k].at); }
  Vec3d ghost(std::size_t k) const { return in_space(points_[k].body, points_[k].ghost); }
  /// Calls visit(place, share) for places below the points of a body, in its frame, that are within
  /// the support of their kernels: what a body that has points to the support's depth lacks inside.
  template <class Visit>
  void for_each_under(std::size_t body, const SphSetup& setup, const Visit& visit) const {
    const Body& b = bodies[body];
    if (b.form == sphere)
      return for_each_shell(b.radius, setup, [&](double r) {
        if (!(r > b.radius - 2 * setup.h()))
          for_each_in_shell(r, setup, [&](const Vec3d& at) { visit(at, 1.0); });
      });
    if (b.form >= forms_.size() || !forms_[b.form])
      return;  // a state whose forms are not known yet
    const BodySites& laid = laid_for(b, setup);
    for (const Vec3d& at : laid.under) visit(at, laid.share);
  }
  /// A direction of the body's frame, transformed to space.
  Vec3d turned(std::size_t k, const Vec3d& own) const {
    const Body& b = bodies[points_[k].body];
    return b.form == sphere ? own : rotate(b.axes, own);
  }
  /// Changes when the points change; > 0.
  std::uint64_t version() const { return version_; }
  /// [m/s] of the body's surface, halfway between a point and its mirror image.
  Vec3d velocity(std::size_t k) const {
    const Point& p = points_[k];
    const Body& b = bodies[p.body];
    return b.velocity + cross(b.spin, 0.5 * rotate(b.axes, p.at + p.ghost));
  }
  /// [m/s] of the point itself.
  Vec3d own_velocity(std::size_t k) const {
    const Body& b = bodies[points_[k].body];
    return b.velocity + cross(b.spin, place(k) - b.centre);
  }
  void move(double dt) {
    for (Body& b : bodies) {
      b.centre += dt * b.velocity;
      const double rate = norm(b.spin);
      if (b.form != sphere && rate > 0)
        b.axes = rotation_about((1 / rate) * b.spin, rate * dt) * b.axes;
    }
  }
  /// Calls visit(k) for points that include the one with the largest displacement: all points of a
  /// body; the first of a sphere, which is not rotated.
  template <class Visit>
  void for_those_that_go_farthest(const Visit& visit) const {
    for (std::size_t b = 0; b < bodies.size(); ++b)
      for (std::size_t k = begin_[b]; k < begin_[b + 1] && tells_way(k); ++k) visit(k);
  }
  bool tells_way(std::size_t k) const {
    return bodies[points_[k].body].form != sphere || k == 0 ||
           points_[k - 1].body != points_[k].body;
  }
  /// [m/s] upper bound for a point.
  double fastest(std::size_t k) const {
    const Point& p = points_[k];
    const Body& b = bodies[p.body];
    const double arm = b.form == sphere ? 0 : std::max(norm(p.at), norm(p.ghost));
    return norm(b.velocity) + norm(b.spin) * arm;
  }
  /// Whether a point at `x` from the centre of a body is inside it.
  bool holds(const Body& b, const Vec3d& x) const {
    if (b.form == sphere) return dot(x, x) < b.radius * b.radius;
    const LiquidForm& form = *forms_[b.form];
    return form.contains((form.radius() / b.radius) * rotate(conjugate(b.axes), x));
  }

  template <class S>
  void take_form(std::size_t form, const S& shape) {
    forms_.resize(std::max(forms_.size(), form + 1));
    if constexpr (requires { shape.shape.index(); })  // a Mix
      std::visit([&](const auto& one) { take_form(form, one); }, shape.shape);
    else if constexpr (std::is_same_v<S, Sphere>)
      forms_[form].reset();
    else
      forms_[form].emplace(shape);
    erase_if(laid_, [form](const auto& laid) { return laid.first.first == form; });
  }
  /// Sets the present bodies, in this order; true if they are others than before.
  bool set(const CoupledParticles& of, std::span<const std::size_t> which, const SphSetup& setup) {
    const AveragedParticles& shape = of.shape;
    const std::size_t n = which.size();
    bool other = n != bodies.size();
    bodies.resize(n);
    for (std::size_t b = 0; b < n; ++b) {
      const std::size_t p = which[b];
      Body now{shape.position[p], of.velocity[p]};
      now.radius = now.reach = shape.radius[p];
      if (!of.angular_velocity.empty()) now.spin = of.angular_velocity[p];
      if (!shape.form.empty()) {
        const std::uint32_t f = shape.form[p];
        require(f < forms_.size(), "Sph: form ", f, " of a body is unknown; give take_form() each");
        if (forms_[f])
          now.form = f, now.axes = shape.orientation[p],
          now.reach = forms_[f]->reach() * now.radius / forms_[f]->radius();
      }
      other = other || !bodies[b].is(now);
      bodies[b] = now;
    }
    if (other) make(setup);
    return other;
  }

  /// For a state: eight numbers per point, sixteen per body.
  DynArray<double> points() const {
    DynArray<double> all;
    for (const Point& p : points_)
      all.insert(all.end(), {p.at.x, p.at.y, p.at.z, p.ghost.x, p.ghost.y, p.ghost.z, p.share,
                             static_cast<double>(p.body)});
    return all;
  }
  DynArray<double> kinds() const {
    DynArray<double> all;
    for (const Body& b : bodies) {
      all.insert(all.end(), {b.radius, static_cast<double>(b.form), b.reach});
      for (const Vec3d& x : {b.centre, b.velocity, b.spin}) all.insert(all.end(), {x.x, x.y, x.z});
      all.insert(all.end(), {b.axes.w, b.axes.x, b.axes.y, b.axes.z});
    }
    return all;
  }
  void restore(std::span<const double> kinds, std::span<const double> points) {
    const std::size_t n = kinds.size() / 16, of = points.size() / 8;
    require(kinds.size() == 16 * n && points.size() == 8 * of, "Sph: a state of bodies has ",
            kinds.size(), " and ", points.size(), " numbers");
    const auto whole = [](double a) { return a == std::floor(a) && a >= 0 && a < 4.3e9; };
    bodies.assign(n, {}), points_.clear(), ++version_;
    for (std::size_t b = 0; b < n; ++b) {
      const double* const a = kinds.data() + 16 * b;
      require(whole(a[1]), "Sph: body ", b, " of a state has form ", a[1]);
      bodies[b].radius = a[0], bodies[b].form = static_cast<std::uint32_t>(a[1]);
      bodies[b].reach = a[2], bodies[b].centre = {a[3], a[4], a[5]};
      bodies[b].velocity = {a[6], a[7], a[8]}, bodies[b].spin = {a[9], a[10], a[11]};
      bodies[b].axes = {a[12], a[13], a[14], a[15]};
    }
    for (std::size_t k = 0; k < of; ++k) {
      const double* const p = points.data() + 8 * k;
      require(whole(p[7]) && p[7] < static_cast<double>(n), "Sph: point ", k,
              " of a state is of body ", p[7], " of ", n);
      points_.push_back(
          {{p[0], p[1], p[2]}, {p[3], p[4], p[5]}, p[6], static_cast<std::uint32_t>(p[7])});
    }
    find_begin();
  }

 private:
  struct Point {
    Vec3d at, ghost;  // [m] from the centre, in the body's frame
    double share;     // [-]
    std::uint32_t body;
  };
  Vec3d in_space(std::uint32_t body, const Vec3d& own) const {
    const Body& b = bodies[body];
    return b.centre + (b.form == sphere ? own : rotate(b.axes, own));
  }
  void make(const SphSetup& setup) {
    points_.clear(), ++version_;
    const double s = setup.spacing;
    for (std::uint32_t b = 0; b < bodies.size(); ++b) {
      const Body& body = bodies[b];
      const double R = body.radius;
      if (body.form == sphere) {
        require(R >= 1.5 * s, "Sph: a sphere of radius ", R, " m is too small for a spacing of ", s,
                " m; it must be at least 1.5 spacings: use a spacing of at most ", R / 1.5, " m");
        for_each_shell(R, setup, [&](double r) {
          if (r > R - 2 * setup.h())
            for_each_in_shell(r, setup, [&](const Vec3d& at) {
              points_.push_back({at, (2 * R - r) / r * at, 1, b});
            });
        });
        continue;
      }
      const BodySites& laid = laid_for(body, setup);
      for (const BodySite& site : laid.sites)
        points_.push_back({site.at, site.ghost, laid.share, b});
    }
    find_begin();
  }
  void find_begin() {
    begin_.assign(bodies.size() + 1, 0);
    for (const Point& p : points_) ++begin_[p.body + 1];
    for (std::size_t b = 0; b < bodies.size(); ++b) begin_[b + 1] += begin_[b];
  }
  const BodySites& laid_for(const Body& body, const SphSetup& setup) const {
    const auto [laid, is_new] = laid_.try_emplace(std::pair{body.form, body.radius});
    const LiquidForm& form = *forms_[body.form];
    if (is_new) laid->second = form.lay(setup, body.radius / form.radius());
    return laid->second;
  }
  /// Radii [m] of a sphere's shells, to the depth of two supports of the kernel.
  template <class Visit>
  static void for_each_shell(double R, const SphSetup& setup, const Visit& visit) {
    const double s = setup.spacing;
    for (double r = R - 0.5 * s; r > 0.25 * s && r > R - 4 * setup.h(); r -= s) visit(r);
  }
  template <class Visit>
  static void for_each_in_shell(double r, const SphSetup& setup, const Visit& visit) {
    const double s = setup.spacing, pi = std::numbers::pi;
    if (setup.dimensions == 2) {  // a cylinder's ring
      const int n = std::max(3, static_cast<int>(std::lround(2 * pi * r / s)));
      for (int k = 0; k < n; ++k) {
        const double angle = 2 * pi * (k + 0.5) / n;
        visit(Vec3d{r * std::cos(angle), 0, r * std::sin(angle)});
      }
      return;
    }
    // Along a spiral of golden angles each point has the same area.
    const int n = std::max(4, static_cast<int>(std::lround(4 * pi * r * r / (s * s))));
    const double golden = pi * (3 - std::sqrt(5.0));
    for (int k = 0; k < n; ++k) {
      const double z = 1 - (2 * k + 1.0) / n, across = std::sqrt(1 - z * z), angle = golden * k;
      visit(Vec3d{r * across * std::cos(angle), r * across * std::sin(angle), r * z});
    }
  }

  DynArray<std::optional<LiquidForm>> forms_;                           // of bodies; none: a sphere
  mutable std::map<std::pair<std::uint32_t, double>, BodySites> laid_;  // by form and radius
  DynArray<Point> points_;                                              // body by body
  DynArray<std::size_t> begin_{0};
  std::uint64_t version_ = 1;
};

}  // namespace silt::detail
