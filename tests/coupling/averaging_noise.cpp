// silt - BSD-3-Clause, see LICENSE
#include "coupling/averaging_support.hpp"

namespace averaging_noise_test {

using namespace averaging_test;

namespace {

struct Spread {
  double mean, deviation, least;
};
/// Of the void fraction in cells farther than `margin` [m] from the sides.
Spread void_fraction(const CellField& solids, double margin) {
  const Grid& g = solids.grid();
  double sum = 0, squares = 0, count = 0, least = 1;
  const auto inner = [&](double x, double low, double high) {
    return x >= low + margin && x <= high - margin;
  };
  for (int k = 0; k < g.nz(); ++k)
    for (int j = 0; j < g.ny(); ++j)
      for (int i = 0; i < g.nx(); ++i) {
        const Vec3d c = g.centre(i, j, k);
        const Box& b = g.box();
        if (!inner(c.x, b.min.x, b.max.x) || !inner(c.y, b.min.y, b.max.y) ||
            !inner(c.z, b.min.z, b.max.z))
          continue;
        const double eps = 1 - solids(i, j, k) / g.cell_volume();
        sum += eps, squares += eps * eps, ++count, least = std::min(least, eps);
      }
  const double mean = sum / count;
  return {mean, std::sqrt(std::max(0.0, squares / count - mean * mean)), least};
}

constexpr double pitch = 1.0202749745;  // cube root of pi/6 over 0.493: void fraction 0.507

/// n^3 spheres of diameter 1 on a cubic lattice, shaken by up to 0.02 in each direction.
Cloud lattice(int n) {
  silt::Random random(8);
  Cloud cloud;
  const auto place = [&](int m) { return (m + 0.5) * pitch + random.uniform(-0.02, 0.02); };
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const double x = place(i), y = place(j), z = place(k);
        cloud.position.push_back({x, y, z});
      }
  cloud.radius.assign(cloud.position.size(), 0.5);
  return cloud;
}

/// rms over cells of the rate of change of the void fraction [1/s] of a dilute cloud that moves
/// at 1 m/s, from differences over dt; spheres of diameter 1.
template <class Mode>
double rate(const Mode& mode, double h, double dt) {
  const int n = static_cast<int>(std::lround(12 / h));
  const Grid grid({{0, 0, 0}, {12, 12, 12}}, {n, n, n}, {true, true, true});
  typename Mode::Averaging op(mode, grid, 1);
  Cloud cloud = random_cloud(grid.box(), 330, 1, 9);  // a volume fraction of 0.1
  cloud.radius.assign(cloud.position.size(), 0.5);
  const Columns volume{cloud.volumes()};
  double sum = 0;
  const int steps = 16;
  op.place(cloud.seen());
  CellField before = spread(op, volume)[0];
  for (int s = 0; s < steps; ++s) {
    for (Vec3d& x : cloud.position) x += Vec3d{0.8, 0.48, 0.36} * dt;
    op.place(cloud.seen());
    CellField now = spread(op, volume)[0];
    for (int k = 0; k < n; ++k)
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          const double r = (now(i, j, k) - before(i, j, k)) / (dt * grid.cell_volume());
          sum += r * r;
        }
    before = now;
  }
  return std::sqrt(sum / (steps * n * n * n));
}

}  // namespace

TEST_CASE("averaging: a packing of 0.507 has its void fraction in every inner cell, h/d 1 to 4") {
  // 19 spheres across cells of h/d = 0.97, 1.5, 1.9, 2.8, 3.9: no number of cells divides them.
  for (const int n : {20, 13, 10, 7, 5}) {
    CAPTURE(n);
    const double length = 19 * pitch;
    const Grid grid({{0, 0, 0}, {length, length, length}}, {n, n, n});
    const Cloud cloud = lattice(19);
    const double true_mean = 1 - sum_of(cloud.volumes()) / grid.box().volume();
    REQUIRE(std::abs(true_mean - 0.507) < 1e-4);
    const auto seen = [&](const auto& mode) {
      typename std::decay_t<decltype(mode)>::Averaging op(mode, grid, 1);
      op.place(cloud.seen());
      return void_fraction(spread(op, {cloud.volumes()})[0], 0);
    };
    const Spread kernel = seen(Kernel{}), gaussian = seen(Kernel{Kernel::Form::Gaussian});
    CHECK(kernel.deviation <= 0.005);
    CHECK(near_relative(kernel.mean, true_mean, 0.01));
    CHECK(gaussian.deviation <= 0.005);
    CHECK(near_relative(gaussian.mean, true_mean, 0.01));
    CHECK(seen(Diffusion{}).deviation <= 0.005);
    CHECK(seen(Unresolved{Unresolved::Share::Centre}).deviation >= 0.05);
  }
}

TEST_CASE("averaging: d eps/dt of a moving cloud does not grow when dt is quartered, PCM's does") {
  for (const double h : {1.0, 3.0}) {
    CAPTURE(h);
    const auto growth = [&](const auto& mode) { return rate(mode, h, 0.05) / rate(mode, h, 0.2); };
    CHECK(growth(Kernel{}) <= 1.1);
    CHECK(growth(Kernel{Kernel::Form::Gaussian}) <= 1.1);
    // Jumps of a number that goes with dt: their rms over dt grows as its root, 2 at a quarter.
    CHECK(growth(Unresolved{Unresolved::Share::Centre}) >= 1.5);
  }
}

}  // namespace averaging_noise_test
