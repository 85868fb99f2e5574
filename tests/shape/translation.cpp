// silt - BSD-3-Clause, see LICENSE
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include <silt/shape/compound.hpp>
#include <silt/shape/dilated_moments.hpp>
#include <silt/shape/multi_sphere.hpp>

#include <doctest/doctest.h>

// Mass properties do not depend on where the frame is, and scale with the size.
namespace translation_test {

namespace {

using namespace silt;

struct Errors {
  double volume, centroid, inertia;  // [-], of the size, [-]
};
/// Of a body `scale` times as large as `as`, moved by `by`; principal moments in ascending order.
Errors between(const MassProperties& as, const MassProperties& moved, const Vec3d& by, double scale,
               double size) {
  const auto sorted = [](Vec3d v) {
    std::array a{v.x, v.y, v.z};
    std::sort(a.begin(), a.end());
    return a;
  };
  const auto I = sorted(as.inertia), J = sorted(moved.inertia);
  Errors e{std::abs(moved.volume / (as.volume * std::pow(scale, 3)) - 1),
           norm(moved.centroid - by - scale * as.centroid) / (scale * size), 0};
  for (std::size_t k = 0; k < 3; ++k)
    e.inertia = std::max(e.inertia, std::abs(J[k] / (I[k] * std::pow(scale, 5)) - 1));
  return e;
}

/// Numbers of few digits, so that places far away are exact: sizes of 1, multiples of 2^-12.
double few_digits(std::mt19937& random) {
  return std::uniform_int_distribution<>(-4096, 4096)(random) / 4096.0;
}

}  // namespace

TEST_CASE("Multi-spheres: mass properties are those of the body wherever and however large it is") {
  std::mt19937 random(7);
  for (int body = 0; body < 40; ++body) {
    CAPTURE(body);
    std::vector<Ball> balls;
    const int n = 1 + body % 6;
    for (int k = 0; k < n;
         ++k)  // every other body is of balls that overlap; the others, mostly not
      balls.push_back({{few_digits(random), few_digits(random), few_digits(random)},
                       (body % 2 ? 0.5 : 0.0625) * (1 + std::abs(few_digits(random)))});
    const MassProperties here = MultiSphere{balls}.mass_properties();
    for (const int power : {-30, -20, -10, 0, 10, 20, 30})
      for (const double away : {0.0, 1.0, 1e3, 1e6, 1e9}) {
        const double scale = std::ldexp(1.0, power);
        const Vec3d by = scale * Vec3d{away * (body % 3 != 1), away * (body % 3 != 2), -away};
        std::vector<Ball> there;
        for (const Ball& b : balls) there.push_back({by + scale * b.centre, scale * b.radius});
        const auto e = between(here, MultiSphere{there}.mass_properties(), by, scale, 1);
        CAPTURE(power);
        CAPTURE(away);
        // Sums of some thousand numbers; the centroid is rounded where it is.
        CHECK(e.volume < 1e-13);
        CHECK(e.centroid < 1e-13 + 4e-16 * away);
        CHECK(e.inertia < 1e-12);
      }
  }
}

TEST_CASE("Multi-spheres: one far ball has I = 2/5 m r^2, long chains have their closed forms") {
  for (const Ball& b :
       {Ball{{0, 0, 1e4}, 1e-2}, Ball{{0, 0, 1e3}, 1e-3}, Ball{{-1e9, 2e8, 0}, 1}}) {
    const auto m = MultiSphere{{b}}.mass_properties();
    const double I = 0.4 * 4 / 3 * std::numbers::pi * std::pow(b.radius, 5);
    for (const double i : {m.inertia.x, m.inertia.y, m.inertia.z})
      CHECK(i == doctest::Approx(I).epsilon(1e-14));
    CHECK(m.centroid == b.centre);
  }
  // A necklace of balls that overlap, along an axis and aslant: balls less lenses.
  for (const Vec3d& way : {Vec3d{1, 0, 0}, Vec3d{0, 0, 1}, normalised(Vec3d{1, 2, 2})}) {
    std::vector<Ball> balls;
    for (int k = 0; k < 100; ++k) balls.push_back({(1.5 * k) * way, 1});
    const auto m = MultiSphere{balls}.mass_properties();
    const double pi = std::numbers::pi, s = 1.5;
    const double lens = pi * (4 + s) * (2 - s) * (2 - s) / 12;
    CHECK(m.volume == doctest::Approx(100 * 4.0 / 3 * pi - 99 * lens).epsilon(1e-9));
    // About the line: pi/2 int (1 - z^2)^2 dz over 98 balls cut at +-s/2 and two cut once.
    const auto primitive = [](double z) { return z - 2 * z * z * z / 3 + std::pow(z, 5) / 5; };
    const double axial = pi / 2 * (198 * primitive(s / 2) + 2 * primitive(1));
    CHECK(std::min({m.inertia.x, m.inertia.y, m.inertia.z}) ==
          doctest::Approx(axial).epsilon(1e-7));
  }
}

TEST_CASE("Multi-spheres: what has no mass properties in doubles is refused, with the line") {
  const std::string path = "translation_test.txt";
  const auto refused = [&](const char* content, std::initializer_list<const char*> words) {
    std::ofstream(path) << content;
    std::string said = "nothing";
    try {
      (void)read_multi_sphere(path).mass_properties();
    } catch (const InputError& e) {
      said = e.what();
    }
    for (const char* w : words)
      CHECK_MESSAGE(said.find(w) != std::string::npos, w, " is not in: ", said);
  };
  refused("0 0 0 1\n\n1e15 0 0 1\n", {path.c_str(), "line 3", "ball 1", "1e+15", "closer to the body"});
  refused("0 0 0 5e-324\n", {"line 1", "ball 0", "check its unit"});
  refused("0 0 0 1e60\n", {"line 1", "check its unit"});
  refused("0 0 0 -1\n", {"line 1", "radius of ball 0"});
  refused("0 0 0 1\n1e7 0 0 1\n", {"lost in rounding", "closer together"});
  std::remove(path.c_str());
}

TEST_CASE("Polyhedra, dilated ones and compounds: the same wherever the frame is") {
  std::mt19937 random(11);
  const auto rounding = [](double away) { return 4e-16 * away; };
  for (int body = 0; body < 6; ++body) {
    std::vector<Vec3d> points;
    for (int k = 0; k < 12; ++k)
      points.push_back({few_digits(random), few_digits(random), few_digits(random)});
    const double dilation = body % 2 ? 0.25 : 0;
    const auto here = Polyhedron::from_points(points, dilation);
    const Compound<Polyhedron> pair{
        .parts = {{here, {0, 0, 0}}, {here, {1, 0.5, 0}}}, .mass = {}, .grid = 20};
    const auto mass = here.mass_properties(), of_pair = pair.mass_properties();
    for (const double away : {1.0, 1e3, 1e6, 1e9}) {
      CAPTURE(away);
      const Vec3d by{away, -away, away};
      auto far = points;
      for (auto& p : far) p += by;
      const auto there = Polyhedron::from_points(far, dilation);
      const auto e = between(mass, there.mass_properties(), by, 1, 1);
      CHECK(there.volume() == doctest::Approx(here.volume()).epsilon(1e-9));
      CHECK(e.volume < 1e-12);
      CHECK(e.centroid < 1e-12 + rounding(away));
      // The core's centroid, about which moments are taken, is rounded where it is.
      CHECK(e.inertia < 1e-12 + 10 * rounding(away));
      // A compound in a far place, and one whose parts are far in their own frames.
      const Compound<Polyhedron> moved{
          .parts = {{here, by}, {here, by + Vec3d{1, 0.5, 0}}}, .mass = {}, .grid = 20};
      const Compound<Polyhedron> inner{
          .parts = {{there, {0, 0, 0}}, {there, {1, 0.5, 0}}}, .mass = {}, .grid = 20};
      for (const auto* c : {&moved, &inner}) {
        const auto f = between(of_pair, c->mass_properties(), by, 1, 1);
        // Points of the grid of 20 change sides by rounding of the planes: 1 in 1e3.
        const double grid = away < 1e6 ? 1e-9 : 2e-3;
        CHECK(f.volume < grid);
        CHECK(f.centroid < grid);
        CHECK(f.inertia < grid);
      }
    }
  }
}

}  // namespace translation_test
