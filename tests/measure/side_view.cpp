// silt - BSD-3-Clause, see LICENSE
//
// Heat maps of beds, and the angle of repose that is read from them: beds of known slopes.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "near.hpp"
#include "refusal.hpp"

#include <silt/core/random.hpp>
#include <silt/measure/side_view.hpp>

namespace side_view_test {

using silt::SideView;
using silt_test::has;
using silt_test::refusal;

constexpr double R = 0.2, pixel = 1e-3;  // [m] of a drum

/// A frame of a bed in a drum: pixels below a line that falls at `angle` [degrees] to the right
/// through the axis, with a flat shoulder on the left, each column raised by normal noise [m].
void add_bed(SideView& view, double angle, double noise, silt::Random& random, double side = 1) {
  view.next_frame();
  const double slope = std::tan(angle * std::numbers::pi / 180);
  for (double x = -R + 0.5 * pixel; x < R; x += pixel) {
    const double rim = std::sqrt(R * R - x * x);
    const double shoulder = 0.7 * R * slope;
    const double top = std::min({rim, -slope * x, shoulder}) + noise * random.normal();
    for (double z = -rim; z < top; z += 0.5 * pixel) view.add_disc(side * x, z, 0.6 * pixel);
  }
}

SideView drum() { return {-R, R, -R, R, pixel}; }

TEST_CASE("side view: a disc covers its area, once a frame, clipped at the picture's sides") {
  SideView view(0, 0.1, 0, 0.1, pixel);
  view.next_frame();
  view.add_disc(0.05, 0.0503, 0.02), view.add_disc(0.05, 0.0503, 0.02);
  view.next_frame();
  double sum = 0;
  for (const float v : view.share().value) sum += v;
  // Of 1257 pixels half the frames; the circle's pixels to 1 %.
  CHECK(sum * pixel * pixel == near(0.5 * std::numbers::pi * 4e-4).epsilon(0.01));
  CHECK(view.share().at(50, 50) == 0.5f);
  CHECK(view.share().at(50, 72) == 0);
  view.add_disc(0, 0, 0.01), view.add_disc(1, 1, 0.01), view.add_disc(0.1, 0.05, 0.005);
  CHECK(view.share().at(0, 0) == 0.5f);
  CHECK(view.share().at(99, 50) == 0.5f);
  CHECK(view.share().x(0) == near(0.5 * pixel));
  CHECK(view.share().top_of(99) == near(0.1));
}

TEST_CASE("smoothed: the sum stays away from the sides, and a point becomes a square") {
  silt::Picture p{0, 0, pixel, 20, 30, std::vector<float>(600, 0)};
  p.at(8, 10) = 1;
  const auto q = silt::smoothed(p, 2);
  double sum = 0;
  for (std::size_t row = 0; row < 30; ++row)
    for (std::size_t column = 0; column < 20; ++column) {
      const bool in = column >= 6 && column <= 10 && row >= 8 && row <= 12;
      CHECK(q.at(column, row) == doctest::Approx(in ? 0.04 : 0).epsilon(1e-5));
      sum += q.at(column, row);
    }
  CHECK(sum == near(1).epsilon(1e-5));
}

TEST_CASE("repose line: the slope of a bed is met to 0.15 degrees, either way round") {
  silt::Random random(1);
  for (const double angle : {30.0, 40.35, 43.25, 50.0})
    for (const double side : {1.0, -1.0}) {
      auto view = drum();
      add_bed(view, angle, 0, random, side);
      const auto found = silt::repose_line(view.share(), {.to_right = side > 0});
      CHECK(std::abs(found.angle - angle) < 0.15);
      CHECK(found.line.points > 100);
      CHECK(found.error < 0.1);
      CHECK(side * found.top_x < -0.5 * R);
    }
}

TEST_CASE("repose line: with 2 pixels of noise within 0.3 degrees, of one frame and of 20") {
  silt::Random random(2);
  for (const int frames : {1, 20}) {
    auto view = drum();
    for (int k = 0; k < frames; ++k) add_bed(view, 42, 2 * pixel, random);
    const auto found = silt::repose_line(view.share());
    CHECK(std::abs(found.angle - 42) < 0.3);
  }
}

TEST_CASE(
    "repose line: flying balls do not count, the shoulder is left out; else it is off by 2 and 0.5 "
    "degrees") {
  silt::Random random(3);
  auto view = drum();
  for (int k = 0; k < 20; ++k) {
    add_bed(view, 42, 0, random);
    // In the air, now here, now there, above the lower half of the line.
    view.add_disc(0.04 + 0.005 * k, 0.05, 0.015);
  }
  CHECK(std::abs(silt::repose_line(view.share()).angle - 42) < 0.15);
  // Mutants: every pixel that was ever covered; the whole surface from its highest point on.
  CHECK(std::abs(silt::repose_line(view.share(), {.level = 0.01}).angle - 42) > 2);
  auto flat = drum();
  add_bed(flat, 30, 0, random);
  CHECK(std::abs(silt::repose_line(flat.share(), {.from_top = 0}).angle - 30) > 0.5);
}

TEST_CASE("side view: what is refused") {
  CHECK(has(refusal([] { SideView(0, 1, 0, 1, 0); }), "pixel = 0"));
  CHECK(has(refusal([] { SideView(0, -1, 0, 1, 1e-3); }), "rectangle"));
  CHECK(has(refusal([] { SideView(0, 1, 0, 1, 1e-3).add_disc(0, 0, 1); }), "next_frame"));
  const auto empty = drum().share();
  CHECK(has(refusal([&] { silt::repose_line(empty); }), "no pixel is covered"));
  CHECK(has(refusal([&] { silt::repose_line(empty, {.level = 2}); }), "level = 2"));
  CHECK(has(refusal([&] { silt::repose_line(empty, {.from_top = -1}); }), "at least 0"));
  auto small = drum();
  small.next_frame(), small.add_disc(0, 0, 0.02);
  CHECK(has(refusal([&] { silt::repose_line(small.share()); }), "use a smaller from_top"));
}

}  // namespace side_view_test
