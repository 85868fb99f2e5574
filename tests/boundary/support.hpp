// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <silt/boundary/surface_point.hpp>
#include <silt/core/quaternion.hpp>

namespace boundary_test {

using silt::normalised;
using silt::SurfacePoint;
using silt::Vec3d;
using Soup = std::vector<std::array<Vec3d, 3>>;

inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
inline constexpr double pi = std::numbers::pi;

/// Rounded to float. Volatile, as GCC 12.2 at -O2 vectorises adjacent double -> float -> double
/// conversions away (wrongly).
inline double rounded_to_float(double x) {
  volatile float rounded = static_cast<float>(x);
  return static_cast<double>(rounded);
}

/// Calls `action`, which must throw an E whose sentence contains `words`.
template <class E, class Action>
void refuses(Action&& action, const std::string& words) {
  std::string sentence = "(nothing thrown)";
  try {
    action();
  } catch (const E& error) {
    sentence = error.what();
  }
  INFO("sentence: ", sentence);
  CHECK(sentence.find(words) != std::string::npos);
}

inline double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}
inline Vec3d random_point(std::mt19937_64& random, double low, double high) {
  const double x = uniform(random, low, high), y = uniform(random, low, high);
  return {x, y, uniform(random, low, high)};
}

/// All contacts of a surface that needs no candidates.
template <class Surface>
std::vector<SurfacePoint> contacts(const Surface& surface, const Vec3d& centre, double reach) {
  std::vector<SurfacePoint> found(Surface::max_contacts);
  found.resize(static_cast<std::size_t>(surface.contacts(centre, reach, found.data())));
  return found;
}

inline double gap(const Vec3d& a, const Vec3d& b) { return silt::norm(a - b); }

/// The parallelogram corner + s u + t v as two triangles, normal along u x v.
inline void add_quad(Soup& soup, const Vec3d& corner, const Vec3d& u, const Vec3d& v) {
  soup.push_back({corner, corner + u, corner + u + v});
  soup.push_back({corner, corner + u + v, corner + v});
}

/// A closed box, normals outwards.
inline Soup box_soup(const Vec3d& low, const Vec3d& high) {
  const Vec3d x{high.x - low.x, 0, 0}, y{0, high.y - low.y, 0}, z{0, 0, high.z - low.z};
  Soup soup;
  add_quad(soup, low, y, x), add_quad(soup, low, x, z), add_quad(soup, low, z, y);
  add_quad(soup, high, -x, -y), add_quad(soup, high, -z, -x), add_quad(soup, high, -y, -z);
  return soup;
}

/// A ball of radius 1 from an octahedron, each triangle cut into four `levels` times.
inline Soup ball_soup(int levels) {
  Soup soup;
  for (const double x : {1.0, -1.0})
    for (const double y : {1.0, -1.0})
      for (const double z : {1.0, -1.0}) {
        std::array<Vec3d, 3> t{{{x, 0, 0}, {0, y, 0}, {0, 0, z}}};
        if (x * y * z < 0) std::swap(t[0], t[1]);
        soup.push_back(t);
      }
  for (int level = 0; level < levels; ++level) {
    Soup finer;
    for (const auto& [a, b, c] : soup) {
      const Vec3d ab = normalised(a + b), bc = normalised(b + c), ca = normalised(c + a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    soup = finer;
  }
  return soup;
}

}  // namespace boundary_test
