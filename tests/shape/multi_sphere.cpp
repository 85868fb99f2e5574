// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <string>

#include <silt/shape/multi_sphere.hpp>

namespace multi_sphere_test {

namespace {

using silt::Ball;
using silt::Vec3d;
constexpr double pi = std::numbers::pi;

double relative(double value, double exact) { return std::abs(value / exact - 1); }

}  // namespace

TEST_CASE("A single ball has the mass properties of a sphere, wherever it is") {
  const Ball ball{{3, -2, 5}, 0.5};
  const auto m = silt::mass_properties(silt::moments_of_union({&ball, 1}));
  const double volume = 4.0 / 3 * pi * 0.125;
  CHECK(relative(m.volume, volume) < 2e-5);
  CHECK(norm(m.centroid - ball.centre) < 1e-6);
  for (const double i : {m.inertia.x, m.inertia.y, m.inertia.z})
    CHECK(relative(i, 0.4 * volume * 0.25) < 3e-5);
}

// PHYSICS: the union of two equal spheres less than two radii apart is two spheres less a lens,
// pi (4 R + s)(2 R - s)^2/12; naive sums are 46, 18.5 and 4.5 % too large at s/R = 0.5, 1, 1.5.
TEST_CASE("Two spheres that overlap are counted once") {
  const double naive_excess[] = {0.46, 0.185, 0.045};
  int k = 0;
  for (const double s : {0.5, 1.0, 1.5}) {
    const Ball balls[] = {{{1, 1, 1 - s / 2}, 1}, {{1, 1, 1 + s / 2}, 1}};
    const auto m = silt::mass_properties(silt::moments_of_union(balls));
    const double exact = 8.0 / 3 * pi - pi * (4 + s) * (2 - s) * (2 - s) / 12;
    CHECK(relative(m.volume, exact) < 3e-5);
    CHECK(std::abs(8.0 / 3 * pi / m.volume - 1 - naive_excess[k]) < 0.006);
    CHECK(norm(m.centroid - Vec3d{1, 1, 1}) < 1e-6);
    // About the axis: two caps to the plane between them, each a solid of revolution with
    // I = pi/2 int (1 - z^2)^2 dz from -s/2 to 1.
    const auto primitive = [](double z) { return z - 2 * z * z * z / 3 + z * z * z * z * z / 5; };
    const double axial = pi * (primitive(1) - primitive(-s / 2));
    CHECK(relative(m.inertia.z, axial) < 1e-4);
    CHECK(relative(m.inertia.x, m.inertia.y) < 1e-4);
    CHECK(m.inertia.x > m.inertia.z);
    ++k;
  }
}

// Catches axes turned by 45 degrees by a rounding of 1e-16, which would lay the particles of a
// liquid askew in a cube; and products that are none, dropped.
TEST_CASE("Of equal moments the axes stay those of the form, to rounding") {
  silt::Moments m{.volume = 1, .second = {.xx = 1, .yy = 1 + 3e-16, .zz = 2, .xy = 1e-16}};
  CHECK(silt::mass_properties(m).axes == silt::Quaternion{});
  m.second.xy = 1e-10;
  CHECK(std::abs(silt::mass_properties(m).axes.z) > 0.38);  // 45 degrees
}

TEST_CASE("Balls apart add up, with the parallel-axis rule, in their own principal frame") {
  // Three spheres of unequal size that do not overlap, on a line that is no axis.
  const Vec3d along = silt::normalised(Vec3d{1, 2, -0.5});
  const Ball balls[] = {{0.0 * along, 1}, {2.5 * along, 0.8}, {4.6 * along, 0.6}};
  double volume = 0, at = 0, inertia = 0;
  for (const Ball& b : balls) {
    const double v = 4.0 / 3 * pi * b.radius * b.radius * b.radius;
    volume += v, at += v * dot(b.centre, along);
  }
  at /= volume;
  double axial = 0;
  for (const Ball& b : balls) {
    const double v = 4.0 / 3 * pi * b.radius * b.radius * b.radius, x = dot(b.centre, along) - at;
    axial += 0.4 * v * b.radius * b.radius;
    inertia += 0.4 * v * b.radius * b.radius + v * x * x;
  }
  const auto m = silt::mass_properties(silt::moments_of_union(balls));
  CHECK(relative(m.volume, volume) < 1e-4);
  CHECK(norm(m.centroid - at * along) < 1e-4);
  // One of the principal axes is the line.
  const Vec3d in_frame = rotate(conjugate(m.axes), along);
  const double moments[] = {m.inertia.x, m.inertia.y, m.inertia.z},
               parts[] = {in_frame.x, in_frame.y, in_frame.z};
  int along_the_line = 0;
  for (int k = 0; k < 3; ++k) {
    const bool is_line = std::abs(std::abs(parts[k]) - 1) < 1e-6;
    along_the_line += is_line;
    CHECK(relative(moments[k], is_line ? axial : inertia) < 2e-4);
  }
  CHECK(along_the_line == 1);
}

TEST_CASE("Principal axes of a known tensor") {
  const auto q = silt::rotation_about(silt::normalised(Vec3d{1, -2, 0.3}), 0.7);
  const Vec3d x = rotate(q, {1, 0, 0}), y = rotate(q, {0, 1, 0}), z = rotate(q, {0, 0, 1});
  silt::Symmetric3 t = 3.0 * silt::outer(x);
  t += 5.0 * silt::outer(y), t += 11.0 * silt::outer(z);
  const auto p = silt::principal(t);
  // Whatever the order of the axes, they rebuild the tensor.
  silt::Symmetric3 again = p.values.x * silt::outer(rotate(p.axes, {1, 0, 0}));
  again += p.values.y * silt::outer(rotate(p.axes, {0, 1, 0}));
  again += p.values.z * silt::outer(rotate(p.axes, {0, 0, 1}));
  CHECK(std::abs(again.xx - t.xx) + std::abs(again.yy - t.yy) + std::abs(again.zz - t.zz) +
            std::abs(again.xy - t.xy) + std::abs(again.yz - t.yz) + std::abs(again.zx - t.zx) <
        1e-13);
  double product = p.values.x * p.values.y * p.values.z;
  CHECK(std::abs(product - 165) < 1e-11);
  // Multiples of one are left as they are.
  CHECK(silt::principal({2, 2, 2, 0, 0, 0}).axes == silt::Quaternion{});
}

TEST_CASE("A mass that no body has is refused") {
  // Axes {1, 0, 1, 0}, not of length 1, gave a hundred times the energy of rotation.
  const auto refused = [](const silt::MassProperties& mass, const char* words) {
    const silt::MultiSphere form{.balls = {{{0, 0, 0}, 1e-3}, {{1e-3, 0, 0}, 1e-3}}, .mass = mass};
    CHECK_THROWS_WITH_AS(form.check(), doctest::Contains(words), silt::InputError);
  };
  const silt::MassProperties good{6e-9, {0.5e-3, 0, 0}, {2e-15, 3e-15, 3e-15}, {}};
  silt::MultiSphere{.balls = {{{0, 0, 0}, 1e-3}}, .mass = good}.check();
  auto bad = good;
  bad.axes = {1, 0, 1, 0}, refused(bad, "are a quaternion of length 1.41");
  bad.axes = {NAN, 0, 0, 0}, refused(bad, "are a quaternion of length nan");
  bad = good, bad.inertia = {1e-15, 1e-15, 1e-14};
  refused(bad, "one is larger than the sum of the others");
  bad = good, bad.volume = INFINITY, refused(bad, "the volume inf [m3]");
  bad = good, bad.inertia.y = NAN, refused(bad, "the principal moments (2e-15, nan, 3e-15)");
  bad = good, bad.centroid = {1, 0, 0}, refused(bad, "lies far outside of the balls");
  bad = good, bad.centroid.z = NAN, refused(bad, "must be finite");
}

TEST_CASE("A multi-sphere is read from a file, and what is wrong with one is said") {
  const std::string path = "multi_sphere_test.txt";
  const auto write = [&](const char* content) { std::ofstream(path) << content; };
  write("# a rod\n-1 0 0 1\n\n1 0 0 1.5  # the thick end\n");
  const auto rod = silt::read_multi_sphere(path, 1e-3);
  REQUIRE(rod.balls.size() == 2);
  CHECK(rod.balls[1].centre == Vec3d{1e-3, 0, 0});
  CHECK(rod.balls[1].radius == doctest::Approx(1.5e-3).epsilon(1e-15));
  write("\xEF\xBB\xBF-1 0 0 1\r\n1 0 0 1.5");  // as some editors save it
  CHECK(silt::read_multi_sphere(path).balls.size() == 2);
  const auto refused = [&](const char* content, const char* words) {
    write(content);
    try {
      (void)silt::read_multi_sphere(path);
      FAIL("accepted: ", content);
    } catch (const silt::Error& e) {
      CHECK_MESSAGE(std::string(e.what()).find(words) != std::string::npos, e.what());
      CHECK(std::string(e.what()).find(path) != std::string::npos);
    }
  };
  refused("1 2 3\n", "line 1: '1 2 3' is not four numbers x y z r");
  refused("0 0 0 1\n1 2 x 3\n", "line 2");
  std::string long_line(1 << 20, 'a');
  long_line.push_back('\n');  // by +, g++ 12 warns of what is not there
  refused(long_line.c_str(), "aaa'... (1048576 bytes) is not four");
  refused("0 0 0 \x1b[1m\n", "'0 0 0 \\x1b[1m' is not four numbers");
  refused("0 0 0 1 1\n", "line 1");
  refused("# nothing\n", "has no balls");
  refused("0 0 0 -1\n", "the radius of ball 0");
  std::remove(path.c_str());
  CHECK_THROWS_AS((void)silt::read_multi_sphere(path), silt::FileError);
}

}  // namespace multi_sphere_test
