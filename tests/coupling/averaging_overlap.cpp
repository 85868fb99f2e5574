// silt - BSD-3-Clause, see LICENSE
#include "coupling/averaging_support.hpp"

namespace averaging_overlap_test {

using namespace averaging_test;
using silt::SphereOverlap;

namespace {

constexpr double pi = std::numbers::pi;

/// Volume of the unit ball between planes, by Gauss' rule along x of areas of a disc in a rectangle
///, with break points where the area has a kink; nodes by a cosine.
class Quadrature {
 public:
  static double box(const Vec3d& low, const Vec3d& high) {
    std::vector<double> ends{std::clamp(low.x, -1.0, 1.0), std::clamp(high.x, -1.0, 1.0)};
    const auto kink = [&](double r2) {
      if (r2 >= 1) return;
      for (const double x : {std::sqrt(1 - r2), -std::sqrt(1 - r2)})
        if (x > ends[0] && x < ends[1]) ends.push_back(x);
    };
    for (const double y : {low.y, high.y}) {
      kink(y * y);
      for (const double z : {low.z, high.z}) kink(y * y + z * z), kink(z * z);
    }
    std::sort(ends.begin(), ends.end());
    double sum = 0;
    const silt::detail::GaussRule<48> rule;
    for (std::size_t s = 0; s + 1 < ends.size(); ++s)
      for (std::size_t n = 0; n < 48; ++n) {
        const double t = pi * rule.at[n], half = 0.5 * (ends[s + 1] - ends[s]);
        const double x = ends[s] + half * (1 - std::cos(t));
        sum += rule.weight[n] * half * pi * std::sin(t) * area(std::sqrt(1 - x * x), low, high);
      }
    return sum;
  }

 private:
  static double segment(double x, double r) {
    const double u = std::min(x, r);
    return 0.5 * (u * std::sqrt(r * r - u * u) + r * r * std::asin(u / r));
  }
  static double quadrant(double x, double y, double r) {  // 0 < .. < x, y
    const double sign = (x < 0) != (y < 0) ? -1 : 1;
    x = std::min(std::abs(x), r), y = std::min(std::abs(y), r);
    if (x * x + y * y <= r * r) return sign * x * y;
    const double from = std::sqrt(r * r - y * y);
    return sign * (y * from + segment(x, r) - segment(from, r));
  }
  static double area(double r, const Vec3d& a, const Vec3d& b) {
    return quadrant(b.y, b.z, r) - quadrant(a.y, b.z, r) - quadrant(b.y, a.z, r) +
           quadrant(a.y, a.z, r);
  }
};

}  // namespace

TEST_CASE("sphere overlap: octants, caps and wedges have their closed volumes") {
  CHECK(near_relative(SphereOverlap::corner(0, 0, 0), pi / 6, 1e-15));
  CHECK(near_relative(SphereOverlap::corner(-1, -1, -1), 4 * pi / 3, 1e-15));
  // Cap of height 0.3 of a ball of radius 0.5.
  CHECK(std::abs(SphereOverlap::corner(0.4, -1, -1) / 8 - 0.113097) < 5e-7);
  CHECK(std::abs(SphereOverlap::corner(-1, 0.4, -1) - SphereOverlap::corner(0.4, -1, -1)) < 1e-15);
  for (const double a : {-0.9, -0.3, 0.0, 0.2, 0.7, 0.999}) {
    const double cap = pi * (1 - a) * (1 - a) * (2 + a) / 3;
    CHECK(std::abs(SphereOverlap::corner(-1, -1, a) - cap) < 1e-14);
    CHECK(std::abs(SphereOverlap::corner(0, -1, a) - cap / 2) < 1e-14);
    CHECK(std::abs(SphereOverlap::corner(0, 0, a) - cap / 4) < 1e-14);
    CHECK(std::abs(SphereOverlap::corner(a, a, -1) - SphereOverlap::corner(a, a, 0) -
                   SphereOverlap::corner(a, a, 0)) < 1e-14);
  }
  CHECK(SphereOverlap::corner(0.6, 0.6, 0.6) == 0);
  CHECK(SphereOverlap::corner(0.8, 0.61, -1) == 0);
  CHECK(SphereOverlap::corner(1, -1, -1) == 0);
}

TEST_CASE("sphere overlap: cells of random grids are those of a quadrature, and add up") {
  silt::Random random(1);
  double worst = 0, sums = 0;
  for (int trial = 0; trial < 60; ++trial) {
    // From cells of three radii down to a third of one: 8 to 1000 cells.
    const double h[3] = {random.uniform(0.3, 3), random.uniform(0.3, 3), random.uniform(0.3, 3)};
    std::vector<double> planes[3];
    std::array<int, 3> cells;
    for (std::size_t d = 0; d < 3; ++d) {
      double at = -1 - h[d] * random.uniform();
      for (planes[d].push_back(at); at < 1;) planes[d].push_back(at += h[d]);
      cells[d] = static_cast<int>(planes[d].size()) - 1;
    }
    SphereOverlap overlap;
    double sum = 0;
    overlap.shares(planes[0].data(), planes[1].data(), planes[2].data(), cells,
                   [&](int i, int j, int k, double v) {
                     const auto x = [&](std::size_t d, int m) {
                       return planes[d][static_cast<std::size_t>(m)];
                     };
                     const double q = Quadrature::box({x(0, i), x(1, j), x(2, k)},
                                                      {x(0, i + 1), x(1, j + 1), x(2, k + 1)});
                     worst = std::max(worst, std::abs(v - q));
                     sum += v;
                   });
    sums = std::max(sums, std::abs(sum - 4 * pi / 3));
  }
  CHECK(worst < 1e-10);  // of the quadrature: kinks of higher order
  CHECK(sums < 1e-13);   // 27 cells and more
}

TEST_CASE("sphere overlap: 27 cells agree with counted random points") {
  silt::Random random(2);
  const double planes[4] = {-1.3, -0.45, 0.4, 1.25};
  double share[27] = {}, counted[27] = {};
  SphereOverlap overlap;
  overlap.shares(planes, planes, planes, {3, 3, 3},
                 [&](int i, int j, int k, double v) { share[(k * 3 + j) * 3 + i] = v; });
  const int n = 2000000;
  for (int m = 0; m < n; ++m) {
    const double x[3] = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    if (x[0] * x[0] + x[1] * x[1] + x[2] * x[2] > 1) continue;
    int c[3];
    for (int d = 0; d < 3; ++d) c[d] = (x[d] > planes[1]) + (x[d] > planes[2]);
    counted[(c[2] * 3 + c[1]) * 3 + c[0]] += 8.0 / n;
  }
  for (int c = 0; c < 27; ++c)  // four standard deviations
    CHECK(std::abs(share[c] - counted[c]) <= 4 * std::sqrt(8 * share[c] / n) + 1e-9);
}

TEST_CASE("satellites: shares err as they should, less with more points") {
  // Cells as large as the sphere's diameter, random places; rms over the cells that have a share.
  const Grid grid({{0, 0, 0}, {4, 4, 4}}, {4, 4, 4});
  const Cloud cloud = [&] {
    Cloud c = random_cloud({{1.5, 1.5, 1.5}, {2.5, 2.5, 2.5}}, 1000, 1, 3);
    c.radius.assign(1000, 0.5);
    return c;
  }();
  Unresolved::Averaging exact({}, grid, 1);
  exact.place(cloud.seen());
  const auto rms = [&](int points) {
    Unresolved::Averaging op({Unresolved::Share::Satellites, points}, grid, 1);
    op.place(cloud.seen());
    double sum = 0, count = 0;
    for (std::size_t p = 0; p < 1000; ++p) {
      double difference[64] = {};
      exact.stencils().for_weights(
          p, [&](int i, int j, int k, double w) { difference[(k * 4 + j) * 4 + i] += w; });
      for (const double d : difference) count += d > 0;
      op.stencils().for_weights(
          p, [&](int i, int j, int k, double w) { difference[(k * 4 + j) * 4 + i] -= w; });
      for (const double d : difference) sum += d * d;
    }
    return std::sqrt(sum / count);
  };
  const double at8 = rms(8), at29 = rms(29), at100 = rms(100), at1000 = rms(1000);
  CHECK(at8 <= 0.076);
  CHECK(at29 <= 0.038);
  CHECK(at100 <= 0.015);
  CHECK(at1000 <= 0.0029);
}

}  // namespace averaging_overlap_test
