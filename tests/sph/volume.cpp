// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include <silt/silt.hpp>
#include <silt/sph.hpp>

#include "near.hpp"

namespace sph_volume_test {

using namespace silt;

namespace {

constexpr double g = 9.81;

/// A tank in 2D, 20 spacings wide, filled up to 30; of `holes` sites one is left empty. Returns the
/// height of the liquid's centre over that by its volume, after 1 s.
template <class Volume>
double height(int holes, const Volume& volume) {
  const double s = 0.01, width = 20 * s;
  Sph water{Liquid{.density = 1000, .sound_speed = 20},
            {.spacing = s,
             .region = {{0, 0, 0}, {width, 0, 0.6}},
             .smoothing = 1.0,
             .dimensions = 2,
             .periodic = {true, false, false},
             .gravity = {0, 0, -g}},
            ArtificialViscosity{.alpha = 0.1},
            VerletTime{},
            volume};
  Random random(1);
  water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
  water.fill(
      [=](const Vec3d& x) {
        const int i = static_cast<int>(x.x / s), k = static_cast<int>(x.z / s);
        return k < 30 && (holes == 0 || (i + 3 * k) % holes != 0);
      },
      [&](const Vec3d&) {  // so that rows of holes do not hold themselves open
        return Vec3d{random.uniform(-0.05, 0.05), 0, random.uniform(-0.05, 0.05)};
      },
      [=](const Vec3d& x) { return 1000 * g * (0.3 - x.z); });
  water.run(1.0, Team{2});
  double sum = 0;
  std::size_t n = 0;
  water.for_each(
      [&](std::uint32_t, const Vec3d& x, const Vec3d&, double, double) { sum += x.z, ++n; });
  const double count = static_cast<double>(n);
  return sum / count / (0.5 * count * s * s / width);
}

}  // namespace

TEST_CASE("RestoredVolume: a liquid whose particles stand too far apart goes back to its volume") {
  // One of six sites is empty, and all have the density of rest. By the continuity equation the
  // holes stay: 6/5, less what the density of rest gives away as particles close up.
  CHECK(height(6, DriftingVolume{}) > 1.08);
  // 2 %: by how far two layers of particles at the surface have less than full kernels.
  CHECK(height(6, RestoredVolume{}) == near(1).epsilon(0.02));
}

TEST_CASE("RestoredVolume: a liquid at rest stays where it is") {
  CHECK(height(0, DriftingVolume{}) == near(1).epsilon(0.005));
  CHECK(height(0, RestoredVolume{}) == near(1).epsilon(0.01));
}

TEST_CASE("RestoredVolume.rate that cannot be is refused by name") {
  const auto made = [](double rate) {
    return [rate] {
      Sph{Liquid{.density = 1000, .sound_speed = 20},
          {.spacing = 0.01, .region = {{0, 0, 0}, {0.2, 0, 0.2}}, .dimensions = 2},
          RestoredVolume{.rate = rate}};
    };
  };
  CHECK_THROWS_WITH_AS(made(0)(), doctest::Contains("RestoredVolume.rate = 0"), InputError);
  CHECK_THROWS_WITH_AS(made(1)(), doctest::Contains("must be in (0, 0.2]"), InputError);
}

}  // namespace sph_volume_test
