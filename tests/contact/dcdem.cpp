// silt - BSD-3-Clause, see LICENSE
#include <silt/contact/contacts.hpp>
#include <silt/contact/dcdem.hpp>

#include "contact/support.hpp"

namespace dcdem_test {

namespace {

using namespace contact_test;
using std::numbers::pi;

static_assert(Contacts<Dcdem>::history == 3 && Contacts<DcdemLiteral>::history == 0);

template <class Law>
typename Law::Material steel(double restitution = 0.39, double friction = 0.496) {
  return {1e8, 0.29, restitution, friction};
}
template <class Law>
auto coefficients(double restitution = 0.39, double friction = 0.496) {
  const auto m = steel<Law>(restitution, friction);
  return Law::mix(m, m, Law::like(m));
}

/// A pair of steel balls of document 002, of this diameter [m].
Contact<double> balls(double diameter) {
  Contact<double> c{};
  c.normal = {0, 0, 1};
  c.overlap = 1e-4, c.R_eff = diameter / 4;
  c.m_eff = 7800.92 * pi / 12 * std::pow(diameter, 3), c.inverse_m_eff = 1 / c.m_eff;
  c.time_step = 1e-5;
  return c;
}

/// Restitution of the law itself, where the contact ends with the overlap. `damped_mass`: share of
/// the mass that the dashpot is made for.
template <class Law>
double rebound(double restitution, double damped_mass = 1) {
  auto p = coefficients<Law>(restitution);
  p.damping *= std::sqrt(damped_mass);
  auto c = balls(0.025);
  c.time_step = 0;
  const double dt = Law::contact_time(p, c.R_eff, c.m_eff, 1) / 40000;
  double d = 0, v = 1;
  const auto pull = [&](double overlap, double rate) {
    typename Law::template History<double> h{};
    c.overlap = std::max(overlap, 0.0), c.normal_velocity = -rate;
    return Law::force(c, p, h).normal / c.m_eff;
  };
  do {
    const double half = v - 0.5 * dt * pull(d, v), middle = d + 0.5 * dt * v;
    d += dt * half, v -= dt * pull(middle, half);
  } while (d > 0);
  return -v;
}

}  // namespace

TEST_CASE("dcdem: mended, it meets the restitution, C_n = 0.303 for 0.39") {
  for (const double e : {0.9, 0.5, 0.39, 0.2}) CHECK(std::abs(rebound<Dcdem>(e) - e) < 1e-4);
  // g_n = C_n sqrt(6 m* E* sqrt(R*)) = C_n sqrt(4.5) sqrt(m* k_n). E8: three digits.
  CHECK(std::abs(coefficients<Dcdem>(0.39).damping / std::sqrt(4.5) - 0.303) < 5e-4);
}

TEST_CASE("dcdem: literal, it rebounds with 0.234 for 0.39, 0.339 for 0.5, 0.702 for 0.8") {
  CHECK(std::abs(rebound<DcdemLiteral>(0.39) - 0.234) < 6e-4);  // E8: three digits
  CHECK(std::abs(rebound<DcdemLiteral>(0.5) - 0.339) < 6e-4);
  CHECK(std::abs(rebound<DcdemLiteral>(0.8) - 0.702) < 6e-4);
  CHECK(std::abs(rebound<DcdemLiteral>(0.39, 0.5) - 0.377) < 6e-4);  // at a wall, there
}

TEST_CASE("dcdem: literal, friction is a dashpot of 28 ... 120 N s/m that mu does not touch") {
  // E8: k dt = 25.7, g = 125 ... 445 of balls of 15 ... 35 mm, k of points of spacing 5 mm.
  for (const auto& row : {std::array{0.015, 28.4}, {0.035, 119.8}}) {
    const double diameter = row[0], dashpot = row[1];
    auto c = balls(diameter);
    c.R_eff = 0.00125;
    for (const double speed : {1e-3, 0.1, 2.0}) {
      c.tangential_velocity = {speed, 0, 0};
      DcdemLiteral::History<double> none{};
      const double with = DcdemLiteral::force(c, coefficients<DcdemLiteral>(), none).tangential.x;
      const auto slick = coefficients<DcdemLiteral>(0.39, 0.05);
      CHECK(DcdemLiteral::force(c, slick, none).tangential.x == with);
      CAPTURE(diameter);
      CHECK(near_relative(-with / speed, dashpot, 2e-3));  // three digits
    }
    // With a longer step it pushes along the sliding.
    c.time_step = 1e-3, c.tangential_velocity = {1e-3, 0, 0};
    DcdemLiteral::History<double> none{};
    CHECK(DcdemLiteral::force(c, coefficients<DcdemLiteral>(), none).tangential.x > 0);
  }
}

TEST_CASE("dcdem: mended, friction stays within mu F_n at every normal velocity") {
  check_coulomb_limit<Dcdem>(coefficients<Dcdem>(), 0.496, 1e-4);
}

TEST_CASE("dcdem: mended, tangential and normal half periods are equal for solid spheres") {
  // Of a small slip at a fixed overlap: stiffness 2/7 of the secant of F_n, as 2/7 of the mass.
  auto c = balls(0.02);
  c.tangential_velocity = {1e-6, 0, 0};
  const auto p = coefficients<Dcdem>(1);
  Dcdem::History<double> h{};
  const auto f = Dcdem::force(c, p, h);
  CHECK(near_relative(-f.tangential.x / (1e-6 * 1e-5), 2.0 / 7 * f.normal / c.overlap, 1e-13));
  const double E = 1e8 / (2 * (1 - 0.29 * 0.29));
  CHECK(near_relative(f.normal, 4.0 / 3 * E * std::sqrt(c.R_eff) * std::pow(1e-4, 1.5), 1e-14));
  CHECK(near_relative(Dcdem::stiffness(c, p), 1.5 * f.normal / c.overlap, 1e-14));
}

TEST_CASE("dcdem: a batch equals doubles") {
  // Sums of three products in another order or fused: 1e-15 each, some tens of operations; tanh.
  CHECK(largest_lane_difference<Dcdem>(coefficients<Dcdem>(), 1e-5) < 1e-13);
  CHECK(largest_lane_difference<DcdemLiteral>(coefficients<DcdemLiteral>(), 0) < 1e-12);
}

TEST_CASE("dcdem: refuses values out of range and names them") {
  refuses([] { Dcdem::check(Dcdem::Material{0, 0.3}); }, {"Dcdem::Material.youngs_modulus = 0"});
  refuses([] { Dcdem::check(Dcdem::Material{1, 0.6}); }, {"poisson_ratio = 0.6", "[0, 0.5]"});
  refuses([] { Dcdem::check(Dcdem::Material{1, 0.3, 0}); }, {"Dcdem restitution = 0"});
  refuses([] { Dcdem::check(Dcdem::Material{1, 0.3, 1, -1}); }, {"Dcdem friction = -1"});
}

}  // namespace dcdem_test
