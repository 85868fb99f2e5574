// silt - BSD-3-Clause, see LICENSE
#include <silt/contact/contacts.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/rolling/directional.hpp>
#include <silt/contact/rolling/epsd.hpp>
#include <silt/contact/rolling/own.hpp>
#include <silt/contact/rolling/twisting.hpp>
#include <silt/contact/rolling/viscous.hpp>

#include "contact/support.hpp"

namespace rolling_models_test {

namespace {

using namespace contact_test;
using Full = Both<RollingEpsd, Twisting>;
using FullA = Both<RollingDirectional, Twisting>;
template <class Model>
constexpr std::size_t kept = Contacts<HertzMindlin, Model>::rolling_history;
static_assert(kept<RollingDirectional> == 0 && kept<RollingViscous> == 0 && kept<RollingOwn> == 0);
static_assert(kept<RollingEpsd> == 3 && kept<Twisting> == 1 && kept<Full> == 4 && kept<FullA> == 1);

/// Two spheres of 1 and 2 mm, pressed with 0.1 N.
RollingContact<double> random_rolling(Random& random) {
  RollingContact<double> c{};
  c.normal = normalised(random_vector(random, 1));
  c.angular_velocity = across(random_vector(random, 100), c.normal);
  c.twist = random.uniform(-100, 100);
  c.spin_velocity = random_vector(random, 0.1);
  c.overlap = 1e-5, c.normal_force = random.uniform(0, 0.2), c.normal_stiffness = 2e4;
  c.R_eff = 1e-3 * 2 / 3, c.inertia_eff = 2e-11;
  c.turn = random_vector(random, 1e-3);
  c.time_step = 1e-6;
  return c;
}

template <class Model, class Real, class Coefficients, class History>
Vec3<Real> torque_of(const RollingContact<Real>& c, const Coefficients& p, History& h) {
  if constexpr (detail::HasHistory<Model>)
    return Model::torque(c, p, h);
  else
    return Model::torque(c, p);
}

/// Largest difference of couple and history between doubles and a batch, over their size.
template <class Model>
double lane_difference(const typename Model::Pair& pair) {
  using Batch = typename Lanes<DefaultArch>::Real;
  constexpr std::size_t W = Lanes<DefaultArch>::width;
  constexpr std::size_t H = detail::history_size<Model>(), C = sizeof(RollingContact<double>) / 8;
  using History = typename detail::HistoryOf<Model, double>::type;
  const auto p = Model::mix(pair);
  Random random(6);
  double worst = 0;
  for (int pack = 0; pack < 200; ++pack) {
    std::array<RollingContact<double>, W> contacts;
    std::array<std::array<double, W>, C> lanes;
    std::array<std::array<double, W>, H + 1> kept_lanes{};
    for (std::size_t w = 0; w < W; ++w) {
      contacts[w] = random_rolling(random);
      for (std::size_t k = 0; k < C; ++k) lanes[k][w] = reals<double>(contacts[w])[k];
      for (auto& h : kept_lanes) h[w] = random.uniform(-1e-5, 1e-5);
    }
    std::array<Batch, C> packed;
    for (std::size_t k = 0; k < C; ++k) packed[k] = load_any<Batch>(lanes[k].data());
    typename detail::HistoryOf<Model, Batch>::type h{};
    if constexpr (H > 0) {
      std::array<Batch, H> values;
      for (std::size_t k = 0; k < H; ++k) values[k] = load_any<Batch>(kept_lanes[k].data());
      h = std::bit_cast<decltype(h)>(values);
    }
    const auto couples = reals<Batch>(
        torque_of<Model>(std::bit_cast<RollingContact<Batch>>(packed),
                         detail::broadcast<Model::template Coefficients, Batch>(p), h));
    for (std::size_t w = 0; w < W; ++w) {
      History alone{};
      if constexpr (H > 0) {
        std::array<double, H> values;
        for (std::size_t k = 0; k < H; ++k) values[k] = kept_lanes[k][w];
        alone = std::bit_cast<History>(values);
      }
      const Vec3d expected = torque_of<Model>(contacts[w], p, alone);
      alignas(64) double lane[3][W];
      for (std::size_t d = 0; d < 3; ++d) silt::store(lane[d], couples[d]);
      const Vec3d found{lane[0][w], lane[1][w], lane[2][w]};
      worst = std::max(worst, norm(found - expected) / std::max(norm(expected), 1e-12));
    }
  }
  return worst;
}

}  // namespace

TEST_CASE("rolling models: A is mu_r R* F_n against the rotation, and damps what is slow") {
  Random random(1);
  const auto p = RollingDirectional::mix({0.1});
  for (int k = 0; k < 100; ++k) {
    auto c = random_rolling(random);
    c.angular_velocity = c.angular_velocity * 1e3;
    const Vec3d w = c.angular_velocity;
    const double limit = 0.1 * c.R_eff * c.normal_force;
    const Vec3d M = RollingDirectional::torque(c, p);
    CHECK(near_relative(norm(M), limit, 1e-14));
    CHECK(norm(M + limit / norm(w) * w) <= 1e-14 * limit);
    c.angular_velocity = 1e-9 * w;
    CHECK(norm(RollingDirectional::torque(c, p) + c.inertia_eff / 8e-6 * c.angular_velocity) <
          1e-14 * limit);
  }
}

TEST_CASE("rolling models: B is mu_v R* F_n |v_w| against the rotation") {
  Random random(1);
  for (int k = 0; k < 100; ++k) {
    const auto c = random_rolling(random);
    const double speed = norm(cross(c.spin_velocity, c.normal));
    const double size = 0.1 * c.R_eff * c.normal_force * speed, w = norm(c.angular_velocity);
    CHECK(norm(RollingViscous::torque(c, RollingViscous::mix({0.1})) +
               size / w * c.angular_velocity) <= 1e-14 * size);
  }
}

TEST_CASE("rolling models: D brakes each partner by its own rotation, alike ones too") {
  Random random(1);
  const auto p = RollingOwn::mix({0.1});
  auto c = random_rolling(random);
  c.time_step = 1e-9;
  const OwnRotations<double> own{{0, 0, 50}, {0, 0, 50}, 1e-3, 2e-3};
  c.angular_velocity = {0, 0, 0};
  const auto M = RollingOwn::torque(c, own, p);
  CHECK(near_relative(-M.on_i.z, 0.1 * c.normal_force * 1e-3, 1e-14));
  CHECK(near_relative(-M.on_j.z, 0.1 * c.normal_force * 2e-3, 1e-14));
  CHECK(norm(RollingDirectional::torque(c, RollingDirectional::mix({0.1}))) == 0);
}

TEST_CASE(
    "twisting: elastic to 3 pi/16 mu a F_n, which is Coulomb's friction under Hertz' pressure") {
  // M_m = integral of mu p r over the area, p = 3 F/(2 pi a^2) sqrt(1 - (r/a)^2), by midpoints.
  double sum = 0;
  for (int k = 0; k < 100000; ++k) {
    const double r = (k + 0.5) / 100000;
    sum += 3 * r * r * std::sqrt(1 - r * r) / 100000;
  }
  CHECK(near_relative(sum, 3 * std::numbers::pi / 16, 1e-6));
  Random random(1);
  auto c = random_rolling(random);
  c.normal_force = 0.1;
  const auto p = Twisting::mix({.twisting_friction = 0.4, .damping = 0});
  const double a = std::sqrt(c.R_eff * c.overlap), limit = 0.4 * sum * a * 0.1;
  const double kw = c.normal_stiffness * a * a;
  Twisting::History<double> h{};
  double angle = 0;
  for (const double step : {1e-4, -3e-5, 2e-4}) {
    c.twist = step / c.time_step;
    angle += step;
    const Vec3d M = Twisting::torque(c, p, h);
    CHECK(near_relative(dot(M, c.normal), -kw * angle, 1e-12));
    CHECK(norm(M - dot(M, c.normal) * c.normal) < 1e-15 * norm(M) + 1e-30);
  }
  for (const double step : {1.0, -1.0}) {
    c.twist = step / c.time_step;
    const Vec3d M = Twisting::torque(c, p, h);
    CHECK(near_relative(dot(M, c.normal), -step * limit, 1e-5));
  }
  // While it sticks the dashpot adds 2 eta sqrt(I k_w) w_n, I of two solid spheres.
  Twisting::History<double> none{};
  c.twist = 1e-3;
  const double M = dot(Twisting::torque(c, Twisting::mix({0.4, 0.3}), none), c.normal);
  CHECK(near_relative(-M, kw * 1e-9 + 0.6 * std::sqrt(2.0 / 7 * c.inertia_eff * kw) * 1e-3, 1e-12));
}

TEST_CASE("rolling models: both at once are their sum, each with its own history") {
  Random random(8);
  const Full::Pair pair{{0.1, 0.3}, {0.4, 0.3}};
  Full::History<double> h{};
  RollingEpsd::History<double> first{};
  Twisting::History<double> second{};
  for (int k = 0; k < 100; ++k) {
    const auto c = random_rolling(random);
    const Vec3d sum = RollingEpsd::torque(c, RollingEpsd::mix(pair.first), first) +
                      Twisting::torque(c, Twisting::mix(pair.second), second);
    CHECK(norm(Full::torque(c, Full::mix(pair), h) - sum) == 0);
  }
}

TEST_CASE("rolling models: a batch equals doubles to a few ulp") {
  // Sums of three products in another order or fused: 1e-15 each, some tens of operations.
  CHECK(lane_difference<RollingDirectional>({0.1}) < 1e-13);
  CHECK(lane_difference<RollingViscous>({0.1}) < 1e-13);
  CHECK(lane_difference<RollingEpsd>({0.1, 0.3}) < 1e-12);
  CHECK(lane_difference<Twisting>({0.1, 0.3}) < 1e-12);
  CHECK(lane_difference<Full>({{0.1, 0.3}, {0.1, 0.3}}) < 1e-12);
}

TEST_CASE("rolling models: refuse values out of range and name them") {
  refuses([] { RollingDirectional::check({-1}); },
          {"RollingDirectional.rolling_friction = -1 [-]"});
  refuses([] { RollingViscous::check({-1}); }, {"RollingViscous.rolling_viscosity = -1 [s/m]"});
  refuses([] { RollingOwn::check({HUGE_VAL}); }, {"RollingOwn.rolling_friction = inf"});
  refuses([] { Twisting::check({-1}); }, {"Twisting.twisting_friction = -1"});
  refuses([] { Twisting::check({0, -1}); }, {"Twisting.damping = -1"});
  refuses([] { Full::check({{-1}, {}}); }, {"RollingEpsd.rolling_friction"});
  refuses([] { Full::check({{}, {-1}}); }, {"Twisting.twisting_friction"});
}

}  // namespace rolling_models_test
