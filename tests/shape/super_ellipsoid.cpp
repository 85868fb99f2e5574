// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <silt/shape/surface_mesh.hpp>

#include "random_pairs.hpp"

namespace super_ellipsoid_test {

namespace {

using silt::SuperEllipsoid;
using silt::Vec3d;

double relative(double x, double reference) { return std::abs(x / reference - 1); }

/// Sums over points that fill the octants of a box evenly (a Halton sequence).
template <class Inside>
silt::Moments sampled(const Vec3d& low, const Vec3d& high, const Inside& inside, int n) {
  const auto halton = [](int k, int base) {
    double x = 0, part = 1;
    for (; k > 0; k /= base) part /= base, x += part * (k % base);
    return x;
  };
  silt::Moments sum;
  const Vec3d d = high - low;
  const double each = d.x * d.y * d.z / n;
  for (int k = 1; k <= n; ++k) {
    const Vec3d x{low.x + d.x * halton(k, 2), low.y + d.y * halton(k, 3),
                  low.z + d.z * halton(k, 5)};
    if (!inside(x)) continue;
    sum.volume += each, sum.first += x * each, sum.second += each * outer(x);
  }
  return sum;
}

}  // namespace

TEST_CASE("super_ellipsoid: volume, inertia and bounding radius have the known values") {
  const SuperEllipsoid box{1, 1.5, 0.7, 8, 4};
  CHECK(relative(box.volume(), 7.477739) < 1e-7);  // the digits that are given
  CHECK(relative(box.inertia().x, 6.028370) < 1e-7);
  CHECK(relative(box.inertia().y, 3.314275) < 2e-7);
  CHECK(relative(box.inertia().z, 7.056648) < 1e-7);
  CHECK(relative(SuperEllipsoid{1, 1.5, 0.7, 5, 3}.bounding_radius(), 1.554650) < 5e-7);
}

TEST_CASE("super_ellipsoid: an ellipsoid has the ellipsoid's volume, inertia, height, curvature") {
  const SuperEllipsoid e{1, 1.5, 0.7};
  const double V = 4.0 / 3.0 * std::numbers::pi * 1 * 1.5 * 0.7;
  CHECK(relative(e.volume(), V) < 1e-14);
  CHECK(relative(e.inertia().x, V / 5 * (1.5 * 1.5 + 0.7 * 0.7)) < 1e-14);
  CHECK(relative(e.inertia().z, V / 5 * (1.5 * 1.5 + 1)) < 1e-14);
  CHECK(e.bounding_radius() == 1.5);
  CHECK(relative(e.mean_curvature({0, 0, 0.7}), 0.5 * 0.7 * (1 + 1 / 2.25)) < 1e-14);
  const Vec3d n = silt::normalised({1, -2, 3});
  CHECK(relative(e.height(n), std::sqrt(n.x * n.x + 2.25 * n.y * n.y + 0.49 * n.z * n.z)) < 1e-14);
}

TEST_CASE("super_ellipsoid: surface area of sphere, spheroid, flat cylinder and box") {
  CHECK(relative(SuperEllipsoid{1, 1, 1}.surface_area(), 4 * std::numbers::pi) < 1e-9);
  CHECK(relative(SuperEllipsoid{1, 1, 1}.sphericity(), 1) < 1e-9);
  const double e = std::sqrt(1 - 0.25);  // oblate, a = 1, c = 1/2
  const double oblate = 2 * std::numbers::pi * (1 + (1 - e * e) / e * std::atanh(e));
  CHECK(relative(SuperEllipsoid{1, 1, 0.5}.surface_area(), oblate) < 1e-8);
  const double e30 = std::sqrt(1 - 1 / 900.0);
  const double prolate = 2 * std::numbers::pi * (1 + 30 / e30 * std::asin(e30));
  CHECK(relative(SuperEllipsoid{1, 1, 30}.surface_area(), prolate) < 1e-6);
  // Area = d(volume)/d(offset), and the volume of a body offset by r is V + S r + ...; so the area
  // of a box of exponent 40 lies between that of the box and of the box without its edges.
  const double area = SuperEllipsoid{1, 2, 3, 40, 40}.surface_area();
  CHECK(area < 88);
  CHECK(area > 88 * 0.96);
}

TEST_CASE("super_ellipsoid: gradient and Hessian are the derivatives of f") {
  pairs::Source from(3);
  for (int k = 0; k < 200; ++k) {
    const auto form = from.shape(12, 3);
    const Vec3d x = form.surface_point(from.direction());
    CAPTURE(form.s1);
    CAPTURE(form.s2);
    CHECK(std::abs(form.value(x)) < 1e-13);
    // Central differences err by h^2/6 f''' ~ 1e-10 s^3/6 and by rounding, 1e-16 / h.
    const double h = 1e-5, tolerance = 1e-10 * std::pow(std::max(form.s1, form.s2), 3) + 1e-9;
    const Vec3d g = form.gradient(x), d{h, 0, 0};
    CHECK(std::abs((form.value(x + d) - form.value(x - d)) / (2 * h) - g.x) < tolerance);
    const Vec3d gx = (form.gradient(x + d) - form.gradient(x - d)) * (1 / (2 * h));
    const auto H = form.hessian(x);
    const double steep = tolerance * std::max(form.s1, form.s2);
    if (std::min(std::abs(x.x), std::abs(x.y)) < 1e-2) continue;  // |x|^(s-2) has a kink at 0
    CHECK(std::abs(gx.x - H.xx) < steep);
    CHECK(std::abs(gx.y - H.xy) < steep);
    CHECK(std::abs(gx.z - H.zx) < steep);
  }
}

TEST_CASE(
    "super_ellipsoid: the support point lies on the surface, has the normal, is the farthest") {
  pairs::Source from(4);
  for (int k = 0; k < 300; ++k) {
    const auto form = from.shape(40, 30);
    const Vec3d n = from.direction(), p = form.support(n);
    CHECK(std::abs(form.value(p)) < 1e-12);
    CHECK(norm(silt::normalised(form.gradient(p)) - n) < 1e-11);
    CHECK(relative(dot(n, p), form.height(n)) < 1e-13);
    const Vec3d q = form.surface_point(from.direction());
    CHECK(dot(n, q) <= form.height(n) * (1 + 1e-13));
    CHECK(norm(q) <= form.bounding_radius() * (1 + 1e-13));
  }
  const Vec3d middle = SuperEllipsoid{1, 2, 3, 8, 4}.support({0, 0, 1});
  CHECK(middle == Vec3d{0, 0, 3});
}

TEST_CASE("super_ellipsoid: the bounding radius is reached, also for exponents just above 2") {
  pairs::Source from(5);
  for (const double s : {2.0, 2.0 + 1e-9, 2.001, 2.5, 8.0, 40.0}) {
    const SuperEllipsoid form{1, 1.5, 0.7, s, s};
    double most = 0;
    for (int k = 0; k < 40000; ++k)
      most = std::max(most, norm(form.surface_point(from.direction())));
    CHECK(form.bounding_radius() >= most * (1 - 1e-14));
    CHECK(form.bounding_radius() < most * 1.004);  // directions are some 0.6 degrees apart
  }
}

TEST_CASE("super_ellipsoid: refuses with field, value, unit and range") {
  CHECK_THROWS_WITH_AS((SuperEllipsoid{1, -1, 1}.check()),
                       "SuperEllipsoid.b = -1 [m] must be finite and greater than 0",
                       silt::InputError);
  CHECK_THROWS_WITH_AS((SuperEllipsoid{1, 1, 1, 1.5, 2}.check()),
                       "SuperEllipsoid.s1 = 1.5 [-] must be in [2, 40]", silt::InputError);
  CHECK_THROWS_WITH_AS((SuperEllipsoid{1, 1, 1, 2, 41}.check()),
                       "SuperEllipsoid.s2 = 41 [-] must be in [2, 40]", silt::InputError);
  CHECK_THROWS_WITH_AS(
      (SuperEllipsoid{1, 1, 31}.check()),
      "SuperEllipsoid: largest over smallest semi-axis = 31 [-] must not be greater than 30",
      silt::InputError);
  CHECK_THROWS_AS((SuperEllipsoid{1, 1, 1, 4, 4, 0}.check()), silt::InputError);
  CHECK_THROWS_AS((SuperEllipsoid{1, 1, NAN}.check()), silt::InputError);
  CHECK_NOTHROW((SuperEllipsoid{1, 30, 1, 40, 40}.check()));
  CHECK_THROWS_AS((silt::PolySuperEllipsoid{{1, 1, 1}, {1, 0, 1}}.check()), silt::InputError);
  CHECK_THROWS_AS((silt::PolySuperEllipsoid{{31, 1, 1}, {1, 1, 1}}.check()), silt::InputError);
}

TEST_CASE("poly_super_ellipsoid: moments agree with sampling to 0.2 %, mass with a symmetric one") {
  const silt::PolySuperEllipsoid poly{{1, 1.5, 0.7}, {0.6, 1.1, 1.2}, 3, 5};
  const auto inside = [&](const Vec3d& x) { return poly.value(x) < 0; };
  const auto sum = sampled(-poly.minus, poly.plus, inside, 200000);
  const auto m = poly.moments();
  const double size = 1.5;  // [m] moments over V size, V size^2; Halton's error at n ~ 1e-4..1e-3
  CHECK(relative(m.volume, sum.volume) < 2e-3);
  CHECK(norm(m.first - sum.first) < 2e-3 * m.volume * size);
  for (const double difference :
       {m.second.xx - sum.second.xx, m.second.yy - sum.second.yy, m.second.zz - sum.second.zz,
        m.second.xy - sum.second.xy, m.second.yz - sum.second.yz, m.second.zx - sum.second.zx})
    CHECK(std::abs(difference) < 2e-3 * m.volume * size * size);

  const SuperEllipsoid even{1, 1.5, 0.7, 8, 4};
  const silt::PolySuperEllipsoid same{{1, 1.5, 0.7}, {1, 1.5, 0.7}, 8, 4};
  const auto mass = same.mass_properties();
  CHECK(relative(mass.volume, even.volume()) < 1e-13);
  CHECK(norm(mass.centroid) == 0);
  CHECK(norm(mass.inertia - even.inertia()) < 1e-12);
}

TEST_CASE("poly_super_ellipsoid: octant moments have the known values") {
  // The octant (1, 1.5, 0.7; 3, 5), from a body whose other octants are the same.
  const silt::PolySuperEllipsoid body{{1, 1.5, 0.7}, {1, 1.5, 0.7}, 3, 5};
  const auto m = body.moments();
  CHECK(relative(m.volume / 8, 0.804245) < 1e-6);
  CHECK(relative(m.second.xx / 8, 0.217857) < 3e-6);
  CHECK(relative(m.second.zz / 8, 0.097770) < 1e-5);
  // The first moments and products, from one whose octants towards -x (-x and -y) vanish.
  const double thin = 1e-9;
  const silt::PolySuperEllipsoid half{{1, 1.5, 0.7}, {thin, 1.5, thin}, 3, 5};
  CHECK(relative(half.moments().first.x / 2, 0.358999) < 3e-6);
  CHECK(relative(half.moments().first.z / 2, 0.239001) < 3e-6);
  const silt::PolySuperEllipsoid quarter{{1, 1.5, 0.7}, {thin, thin, 0.7}, 3, 5};
  CHECK(relative(quarter.moments().second.xy / 2, 0.235183) < 3e-6);
}

TEST_CASE("poly_super_ellipsoid: support point on the surface with its normal, in every octant") {
  pairs::Source from(6);
  const silt::PolySuperEllipsoid poly{{1, 1.5, 0.7}, {0.6, 1.1, 1.2}, 3, 5};
  for (int k = 0; k < 300; ++k) {
    const Vec3d n = from.direction(), p = poly.support(n);
    CHECK(std::abs(poly.value(p)) < 1e-12);
    CHECK(norm(silt::normalised(poly.gradient(p)) - n) < 1e-12);
    CHECK(norm(p) <= poly.bounding_radius());
  }
}

TEST_CASE("The mesh that shows a super-ellipsoid is closed and has its volume") {
  for (const double s : {2.0, 4.0, 20.0}) {
    const silt::SuperEllipsoid shape{.a = 1, .b = 2, .c = 0.5, .s1 = s, .s2 = s};
    const auto [points, triangles] = silt::surface_of(shape, 16);
    CHECK(points.size() == 6 * 16 * 16 + 2);
    double volume = 0;
    for (const auto& t : triangles)
      volume += dot(points[t[0]], cross(points[t[1]], points[t[2]])) / 6;
    for (const auto& p : points) CHECK(std::abs(shape.value(p)) < 1e-9);
    // Chords cut off (1/cells)^2 or so of a round body; a box has none.
    CHECK(volume < shape.volume());
    CHECK(volume > (1 - 2.0 / (16 * 16)) * shape.volume());
  }
}

}  // namespace super_ellipsoid_test
