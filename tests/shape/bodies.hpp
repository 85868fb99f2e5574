// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <doctest/doctest.h>

#include <random>
#include <string>

#include <silt/shape/dilated_moments.hpp>

namespace shape_test {

using silt::Polyhedron;
using silt::Quaternion;
using silt::RigidPose;
using silt::Vec3d;
using Soup = std::vector<std::array<Vec3d, 3>>;

inline constexpr double pi = std::numbers::pi;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double uniform(double low = 0, double high = 1) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  double normal() { return normal_(engine_); }
  // Draws in braces or one by one: compilers call arguments and operands in orders of their own.
  Vec3d direction() { return normalised(Vec3d{normal(), normal(), normal()}); }
  Vec3d in_cube(double half) {
    const double x = uniform(-half, half), y = uniform(-half, half), z = uniform(-half, half);
    return {x, y, z};
  }
  Quaternion turn() {
    const Vec3d axis = direction();
    return rotation_about(axis, uniform(0, 2 * pi));
  }
  /// The hull of n points at distances 0.3 to 0.5, about its centroid.
  Polyhedron hull(int n) {
    std::vector<Vec3d> points;
    for (int k = 0; k < n; ++k) {
      const double far = uniform(0.3, 0.5);
      points.push_back(far * direction());
    }
    return principal_shape(Polyhedron::from_points(points)).parts[0];
  }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

inline std::vector<Vec3d> box_corners(const Vec3d& low, const Vec3d& high) {
  std::vector<Vec3d> out;
  for (int c = 0; c < 8; ++c)
    out.push_back({c & 1 ? high.x : low.x, c & 2 ? high.y : low.y, c & 4 ? high.z : low.z});
  return out;
}
inline Polyhedron box(const Vec3d& extent) {
  return Polyhedron::from_points(box_corners(-0.5 * extent, 0.5 * extent));
}

/// Whether two numbers agree to a part of the second.
inline bool agree(double value, double exact, double part) {
  return std::abs(value - exact) <= part * std::abs(exact);
}

/// The inertia in the frame the body was given in.
inline silt::Symmetric3 inertia_of(const silt::MassProperties& m) {
  const auto axes = rotation_matrix(m.axes);
  silt::Symmetric3 out = m.inertia.x * outer(axes.x);
  out += m.inertia.y * outer(axes.y), out += m.inertia.z * outer(axes.z);
  return out;
}

/// Calls `action`, which must throw silt::InputError with a sentence that contains `words`.
template <class Action>
void refuses(Action&& action, const std::string& words) {
  std::string sentence = "(nothing thrown)";
  try {
    action();
  } catch (const silt::InputError& error) {
    sentence = error.what();
  }
  CHECK_MESSAGE(sentence.find(words) != std::string::npos, sentence);
}

}  // namespace shape_test
