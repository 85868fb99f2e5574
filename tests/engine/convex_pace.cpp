// silt - BSD-3-Clause, see LICENSE
//
// How fast convex bodies may close: what lets pairs that are apart go without a look.
#include <doctest/doctest.h>

#include <random>

#include <silt/engine/convex/convex_rows.hpp>
#include <silt/shape/super_ellipsoid.hpp>

namespace convex_pace_test {

namespace {

using Rows = silt::detail::ConvexRows<silt::KindList<silt::SuperEllipsoid>, true>;
using silt::Vec3d;

std::vector<double> paces(const std::vector<silt::MotionRow<true>>& motions, int threads) {
  Rows rows;
  rows.pose.resize(motions.size());
  rows.measure_pace(motions.data(), silt::Team(threads));
  return {rows.pace.begin(), rows.pace.end()};
}

}  // namespace

TEST_CASE("convex_pace: no two bodies close faster than the sum; a common motion does not count") {
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal;
  const auto any = [&] { return Vec3d{normal(engine), normal(engine), normal(engine)}; };
  std::vector<silt::MotionRow<true>> motions(700), carried;
  for (auto& m : motions) {
    const Vec3d v = 5.0 * any(), w = 3.0 * any();
    m = {v.x, v.y, v.z, 1, w.x, w.y, w.z, 1};
  }
  for (auto m : motions) m.vx += 40, m.vz -= 70, carried.push_back(m);
  const auto pace = paces(motions, 1), pace_carried = paces(carried, 1);
  double slack = 9, changed = 0;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    changed = std::max(changed, std::abs(pace[i] - pace_carried[i]));
    for (std::size_t j = 0; j < i; ++j) {
      const auto &a = motions[i], &b = motions[j];
      // The fastest that any point of the one can come at any point of the other.
      const double closing =
          norm(a.velocity() - b.velocity()) + norm(a.spin_velocity()) + norm(b.spin_velocity());
      slack = std::min(slack, pace[i] + pace[j] - closing);
    }
  }
  CHECK(slack >= -1e-14);            // a few roundings of 10
  CHECK(slack < 1);                  // no bound that is far too wide would do
  CHECK(changed <= 1e-12);           // some of the 700 roundings of 100 in the mean
  CHECK(paces(motions, 3) == pace);  // the same bits for any number of threads
}

}  // namespace convex_pace_test
