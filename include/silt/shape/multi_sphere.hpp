// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include <silt/core/dyn_array.hpp>
#include <silt/files/atomic_file.hpp>
#include <silt/shape/union_of_balls.hpp>

namespace silt::inline SILT_TARGET {

/// Rigid body of spheres, which may overlap. Overlaps are counted once in its mass and inertia.
///
///   silt::Particles<silt::MultiSphere> stones;
///   const auto rod = stones.add_form({.balls = {{{-1e-3, 0, 0}, 1e-3}, {{1e-3, 0, 0}, 1e-3}}});
///   stones.add({.form = rod, .position = {0, 0, 0.1}, .density = 2500});
///
/// Contacts are those of its spheres, each with its own history. Where several spheres of a body
/// touch the same other body, they share stiffness and damping. The body then does not become
/// stiffer when it is described by more spheres (engine/contact/shared_contacts.hpp).
///
/// Units:  m, in any frame; the engine moves it to the principal frame.
/// Errors: InputError for no balls, radii that are not positive, positions that are not finite or
///         more than 4e10 radii from the origin, balls so far apart (some 1e5 radii) that the
///         moment about their line is lost in rounding.
/// Tests:  tests/shape/multi_sphere.cpp, tests/shape/translation.cpp, tests/engine/bodies.cpp.
/// Source: volume and inertia of the union: shape/union_of_balls.hpp; the shared stiffness
///         is silt's own.
/// Valid:  spheres that touch or overlap. For the difference to contacts of a smooth surface see
///         docs/shapes.md.
struct MultiSphere {
  static constexpr bool is_body = true;

  DynArray<Ball> balls;
  /// Mass and inertia from another source, such as the mesh that the spheres represent, in the
  /// frame of the balls; left out: those of the union.
  std::optional<MassProperties> mass = {};

  bool operator==(const MultiSphere&) const = default;

  void check() const {
    require(!balls.empty(), "MultiSphere has no balls; give at least one");
    for (std::size_t k = 0; k < balls.size(); ++k) check(balls[k], k);
    if (mass) check_mass("MultiSphere", *mass), check_centroid();
  }
  /// Checks ball k.
  static void check(const Ball& ball, std::size_t k) {
    require(is_finite(ball.centre), "MultiSphere: the centre of ball ", k, ", ", ball.centre,
            " [m], must be finite");
    require_positive(text("MultiSphere: the radius of ball ", k), ball.radius, "m");
    // The inertia is proportional to the fifth power; a double ranges from 1e-308 to 1e308.
    require(ball.radius >= least_radius && ball.radius <= 1 / least_radius,
            "MultiSphere: the radius of ball ", k, ", ", ball.radius, " [m], must be in [",
            least_radius, ", ", 1 / least_radius, "]; check its unit");
    const Vec3d& c = ball.centre;
    const double far = std::max({std::abs(c.x), std::abs(c.y), std::abs(c.z)});
    require(far <= most_radii_away * ball.radius, "MultiSphere: ball ", k, " of radius ",
            ball.radius, " m is at ", c, " m, where positions are rounded by ", 1.1e-16 * far,
            " m; move the origin of its frame closer to the body, or omit such a small ball");
  }
  /// Its centre of mass lies among the balls, or less than their extent beside them.
  void check_centroid() const {
    Vec3d low = balls[0].centre, high = low;
    double radius = 0;
    for (const Ball& b : balls) {
      low = {std::min(low.x, b.centre.x), std::min(low.y, b.centre.y), std::min(low.z, b.centre.z)};
      high = {std::max(high.x, b.centre.x), std::max(high.y, b.centre.y),
              std::max(high.z, b.centre.z)};
      radius = std::max(radius, b.radius);
    }
    const double extent = norm(high - low) + 2 * radius;
    require(norm(mass->centroid - 0.5 * (low + high)) < extent, "MultiSphere: the centroid of its ",
            "mass, ", mass->centroid, " [m], lies far outside of the balls, which are ", extent,
            " m across; give it in their frame");
  }
  static constexpr double least_radius = 1e-50;    // [m]
  static constexpr double most_radii_away = 4e10;  // [-] rounding is 1e-5 of the radius there

  MassProperties mass_properties() const {
    return mass ? *mass : silt::mass_properties(moments_of_union(balls));
  }
  DynArray<Ball> parts() const { return balls; }
  /// Description of the form for comparison (checkpoints): visit(name, number).
  template <class Visit>
  void describe(const Visit& visit) const {
    DynArray<Vec3d> centres, radii;
    for (const Ball& b : balls) centres.push_back(b.centre), radii.push_back({b.radius, 0, 0});
    visit("balls", static_cast<double>(balls.size()));
    visit("centres", std::span<const Vec3d>(centres));
    visit("radii", std::span<const Vec3d>(radii));
  }
};

static_assert(BodyShape<MultiSphere>);

/// Reads a multi-sphere from a text file: one line `x y z r` per ball, in units of `scale` [m].
/// Empty lines and text after # are skipped.
/// Errors: FileError if the file cannot be read or a line is not four numbers, with its line
///         number; InputError as MultiSphere::check.
inline MultiSphere read_multi_sphere(const std::string& path, double scale = 1) {
  require_positive("read_multi_sphere: scale", scale, "m");
  const std::string content = detail::read_text(path);
  std::string_view rest = content;
  MultiSphere form;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    double values[4] = {};
    std::size_t found = 0;
    bool good = true;
    constexpr std::string_view blank = " \t\r\v\f";
    std::string_view words = line.substr(0, line.find('#'));
    for (std::size_t at; good && (at = words.find_first_not_of(blank)) != words.npos; ++found) {
      words.remove_prefix(at);
      const auto word = words.substr(0, words.find_first_of(blank));
      words.remove_prefix(word.size());
      const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(),
                                                 values[std::min<std::size_t>(found, 3)]);
      good = error == std::errc{} && stop == word.data() + word.size();
    }
    if (good && found == 0) continue;
    if (!good || found != 4)
      throw FileError(text("multi-sphere file '", path, "', line ", number, ": ", in_quotes(line),
                           " is not four numbers x y z r"));
    form.balls.push_back(
        {{values[0] * scale, values[1] * scale, values[2] * scale}, values[3] * scale});
    try {
      MultiSphere::check(form.balls.back(), form.balls.size() - 1);
    } catch (const InputError& e) {
      throw InputError(text("multi-sphere file '", path, "', line ", number, ": ", e.what()));
    }
  }
  try {
    form.check();
  } catch (const InputError& e) {
    throw InputError(text("multi-sphere file '", path, "': ", e.what()));
  }
  return form;
}

}  // namespace silt
