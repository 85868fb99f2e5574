// silt - BSD-3-Clause, see LICENSE
//
// The ball mill of examples/ball_mill: Bond's charge and the speeds beside the paper's, and what
// lifters do to a ball, in closed form.
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "../examples/ball_mill/charge.hpp"
#include "../examples/ball_mill/drum.hpp"
#include "near.hpp"
#include "refusal.hpp"

#include <silt/silt.hpp>

namespace ball_mill_test {

using namespace ball_mill;
using silt::Vec3d;
using silt_test::has;
using silt_test::refusal;

TEST_CASE("ball mill: speeds are the printed 24.8, 21.1, 18.7 1/min to their digits") {
  // 24.79, 21.10, 18.69 (computed before, by the same reading of the paper). With the mean by
  // number, or the outer radius, the first would be 24.4 and 24.1.
  constexpr std::array<double, 3> printed{24.8, 21.1, 18.7}, computed{24.79, 21.10, 18.69};
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(std::abs(turns_a_minute(mills[k]) - printed[k]) < 0.05);
    CHECK(std::abs(turns_a_minute(mills[k]) - computed[k]) < 0.005);
  }
  // A ball at the top whose weight is what its circle needs.
  const double rate = critical_speed(0.2, 0.01) * std::numbers::pi / 30;
  CHECK(rate * rate * 0.19 == near(9.81).epsilon(1e-12));
}

TEST_CASE("ball mill: mass shares and counts of Bond's classes") {
  const std::array<std::vector<double>, 3> shares{{{0.0400, 0.0793, 0.1592, 0.2782, 0.4433},
                                                   {0.1192, 0.1592, 0.2782, 0.4433},
                                                   {0.2784, 0.2782, 0.4433}}};
  const std::array<std::vector<std::size_t>, 3> counts{
      {{45, 38, 39, 40, 40}, {103, 70, 71, 71}, {194, 112, 113}}};
  constexpr std::array<double, 3> means{0.03003, 0.03023, 0.03082}, mass{15.7, 28.2, 44.5};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto classes = bond_classes(mills[k].least);
    const auto balls = ball_counts(mills[k], 0.1);
    REQUIRE(classes.size() == shares[k].size());
    double all = 0, steel = 0;
    for (std::size_t c = 0; c < classes.size(); ++c) {
      CHECK(std::abs(classes[c].mass_share - shares[k][c]) < 5.1e-5);

      CHECK(balls[c] == counts[k][c]);
      all += classes[c].mass_share;
      steel += static_cast<double>(balls[c]) * steel_density * std::numbers::pi / 6 *
               std::pow(classes[c].diameter, 3);
    }
    CHECK(all == near(1).epsilon(1e-12));
    CHECK(classes.back().diameter == near(0.035).epsilon(1e-12));
    CHECK(std::abs(mean_diameter(classes) - means[k]) < 5.1e-6);
    CHECK(std::abs(steel - mass[k]) < 0.05 + 0.09);  // a digit; half of the largest ball
  }
  CHECK(has(refusal([] { mill("350"); }), "350"));
  CHECK(has(refusal([] { bond_classes(0.04); }), "sizes that grow"));
}

constexpr double R = 0.146, r = 0.0125, h = lifter_size;  // [m]
constexpr double g = 9.81;

/// The bar whose middle is at `turn` [rad] from the x axis holds a ball on its side away from x;
/// their contacts with shell and bar point along `shell` and `edge`.
struct Held {
  Vec3d centre, shell, edge;  // [m], [-]
};
Held held(double turn) {
  const Vec3d out{std::cos(turn), 0, std::sin(turn)}, side{-out.z, 0, out.x};
  const Vec3d corner = (R - h) * out + (0.5 * h) * side;
  // On the circle R - r, at the distance r from the corner.
  const double a = R - r, b = norm(corner);
  const double angle =
      std::acos((a * a + b * b - r * r) / (2 * a * b)) + std::atan2(0.5 * h, R - h);
  const Vec3d centre = a * (std::cos(angle) * out + std::sin(angle) * side);
  return {centre, (-1 / a) * centre, (1 / r) * (centre - corner)};
}

auto mill_with(const Vec3d& at, const Vec3d& down) {
  const silt::HertzMindlin::Material slick{
      .youngs_modulus = 1e9, .poisson_ratio = 0.29, .restitution = 0.1, .friction = 0};
  silt::Particles<silt::Sphere> ball;
  ball.add({.position = at, .radius = r, .density = 7800.92});
  silt::Simulation sim{std::move(ball), silt::Contacts<silt::HertzMindlin>{slick}};
  sim.gravity = g * down;
  sim.add_wall(drum_surfaces(R, 0.1, true), slick);
  return sim;
}

TEST_CASE("ball mill: a ball between shell and lifter is held by their edge, in closed form") {
  const double turn = 2 * std::numbers::pi * 0.5 / lifter_count;
  const Held h0 = held(turn);
  const Vec3d at{h0.centre.x, 0.05, h0.centre.z};
  // Weight between the two contacts: shares solve s shell + e edge = up.
  const Vec3d down = silt::normalised(-0.7 * h0.shell - 0.3 * h0.edge);
  auto sim = mill_with(at, down);
  sim.run(0.5);
  const double weight = sim.mass(0) * g;
  const double c = dot(h0.shell, h0.edge), ds = -dot(down, h0.shell), de = -dot(down, h0.edge);
  const double by_shell = weight * (ds - c * de) / (1 - c * c);
  const double by_edge = weight * (de - c * ds) / (1 - c * c);
  CHECK(norm(sim.position(0) - at) < 5e-6);  // overlaps of a weight
  int contacts = 0;
  sim.for_each_contact([&](const silt::ContactSeen& seen) {
    ++contacts;
    const bool is_edge = dot(seen.normal, h0.edge) > dot(seen.normal, h0.shell);
    // What a bar with round edges, or facets that count twice, would bear differs by percents.
    CHECK(seen.normal_force == near(is_edge ? by_edge : by_shell).epsilon(2e-3));
    CHECK(dot(seen.normal, is_edge ? h0.edge : h0.shell) > 1 - 1e-6);
  });
  CHECK(contacts == 2);
}

TEST_CASE("ball mill: a ball rolls over a lifter when its weight points beyond the edge") {
  const double turn = 2 * std::numbers::pi * 0.5 / lifter_count;
  const Held h0 = held(turn);
  const Vec3d at{h0.centre.x, 0.05, h0.centre.z};
  const Vec3d over = silt::normalised(Vec3d{h0.shell.z, 0, -h0.shell.x});  // along the shell
  const double side = dot(over, h0.edge) < 0 ? 1 : -1;                     // towards the bar
  for (const double beyond : {-0.02, 0.02}) {  // [rad] of the weight past the edge
    const double co = std::cos(beyond), si = std::sin(beyond);
    const Vec3d edge = -1.0 * h0.edge;
    const Vec3d across{-edge.z, 0, edge.x};
    const double towards = dot(across, h0.shell) > 0 ? 1 : -1;  // away from the shell
    auto sim = mill_with(at, co * edge + (si * towards) * across);
    sim.run(1.0);
    const Vec3d x = sim.position(0);
    const double moved = side * dot(x - at, over);
    CAPTURE(beyond);
    CHECK((beyond < 0 ? std::abs(moved) < 1e-4 : moved > h));
  }
}

TEST_CASE("ball mill: the lifters close eight times the same wedge, and leave the rest free") {
  const auto bars = lifters(R, 0.1);
  CHECK(bars.is_closed());
  CHECK(bars.volume() == near(lifter_count * 2 * h * h * 0.3).epsilon(1e-9));
  const auto deep = [&](double turn, double from_axis) {
    return bars.contains({from_axis * std::cos(turn), 0.05, from_axis * std::sin(turn)});
  };
  for (int k = 0; k < lifter_count; ++k) {
    const double turn = 2 * std::numbers::pi * (k + 0.5) / lifter_count;
    CHECK(deep(turn, R - 0.99 * h));
    CHECK(!deep(turn, R - 1.01 * h));
    CHECK(deep(turn + 0.49 * h / R, R - 0.5 * h));
    CHECK(!deep(turn + 0.55 * h / (R - h), R - 0.5 * h));
    CHECK(!deep(turn + std::numbers::pi / lifter_count, R - 0.5 * h));
  }
}

}  // namespace ball_mill_test
