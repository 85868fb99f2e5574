// silt - BSD-3-Clause, see LICENSE
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/jkr.hpp>

#include "contact/support.hpp"

namespace jkr_test {

namespace {

using namespace contact_test;

Jkr::Material sticky(double w = 0.1, double restitution = 1, double friction = 0.4) {
  return {.youngs_modulus = 1e7,
          .poisson_ratio = 0.25,
          .work_of_adhesion = w,
          .restitution = restitution,
          .friction = friction};
}
auto coefficients(const Jkr::Material& m) { return Jkr::mix(m, m, Jkr::like(m)); }
AdhesivePair pair_of(const Jkr::Material& m, double R_eff = 1e-3) {
  return {coefficients(m).twice_modulus / 2, R_eff, m.work_of_adhesion};
}
const Contact<double> at_rest = contact_at_rest();

/// The law's normal force at rest and an overlap, attached or not.
double force_at(const Jkr::Material& m, double overlap, bool attached) {
  auto c = at_rest;
  c.overlap = overlap;
  Jkr::History<double> h{{0, 0, 0}, attached ? 1e-5 : 0};
  return Jkr::force(c, coefficients(m), h).normal;
}

}  // namespace

TEST_CASE("jkr: the contact radius solves A^4 - R* c A = R* d to 1e-12 at all overlaps") {
  // In units of A_t: with A = A_t x it is x^4 - 4 x = y, y >= -3; solved by bisection in long
  // double, near the double root at y = -3 in the distance from it.
  for (double log_y = -14; log_y < 30; log_y += 0.01) {
    const double e = std::pow(10.0, log_y);  // y + 3
    long double low = 0, high = 2 * std::pow(e, 0.25) + 2;
    for (int k = 0; k < 300; ++k) {
      const long double u = (low + high) / 2;
      (u * u * (6 + u * (4 + u)) > static_cast<long double>(e) ? high : low) = u;
    }
    const double A = detail::root_of_contact_radius(1.0, std::sqrt(e));
    CAPTURE(e);
    CHECK(near_relative(A * A, static_cast<double>((1 + low) * (1 + low)), 1e-14));
    const float single = detail::root_of_contact_radius(1.0f, static_cast<float>(std::sqrt(e)));
    CHECK(near_relative(static_cast<double>(single), A, 1e-6));
  }
  CHECK(detail::root_of_contact_radius(1.0, 0.0) == 1);
  CHECK(detail::root_of_contact_radius(0.0, 0.0) == 0);
  CHECK(near_relative(detail::root_of_contact_radius(0.0, 4.0), 2, 1e-15));
}

TEST_CASE("jkr: the contact radius is that of B9's closed form") {
  const auto pair = pair_of(sticky());
  const double R = pair.R_eff, E = pair.E_eff, w = pair.work_of_adhesion;
  for (const double share : {-0.9, -0.5, 0.0, 0.3, 3.0, 30.0}) {
    const double d = -share * jkr_overlap_at_parting(pair);
    const double c0 = R * R * d * d, c1 = -2 * std::numbers::pi * w * R * R / E, c2 = -2 * R * d;
    const double P = -c2 * c2 / 12 - c0, Q = -c2 * c2 * c2 / 108 + c0 * c2 / 3 - c1 * c1 / 8;
    const double U = std::cbrt(-Q / 2 + std::sqrt(Q * Q / 4 + P * P * P / 27));
    const double s = -5 * c2 / 6 + (U != 0 ? U - P / (3 * U) : -std::cbrt(Q));
    const double W = std::sqrt(c2 + 2 * s), L = c1 / (2 * W);
    const double a = (W + std::sqrt(W * W - 4 * (c2 + s + L))) / 2;
    CAPTURE(share);
    // B9's form cancels: 1e-12 where it was checked, less by far at large overlaps.
    CHECK(near_relative(force_at(sticky(), d, true), jkr_force(pair, a), share > 10 ? 1e-6 : 1e-9));
  }
}

TEST_CASE("jkr: pull-off 3/2 pi w R*, 5/9 of it at parting, 8/9 at touch, none at rest") {
  const auto m = sticky();
  const auto pair = pair_of(m);
  const double Fc = jkr_pull_off(pair), parting = jkr_overlap_at_parting(pair);
  CHECK(near_relative(Fc, 1.5 * std::numbers::pi * 0.1 * 1e-3, 1e-15));
  CHECK(near_relative(dmt_pull_off(pair), 2 * std::numbers::pi * 0.1 * 1e-3, 1e-15));
  // The closed forms themselves, by (1).
  const double at_pull_off = std::cbrt(9 * std::numbers::pi * 0.1 * 1e-6 / (8 * pair.E_eff));
  CHECK(near_relative(jkr_force(pair, at_pull_off), -Fc, 1e-14));
  const double rest = jkr_radius_at_rest(pair);
  CHECK(std::abs(jkr_force(pair, rest)) < 1e-14 * Fc);
  // The law: the force is flat at its least value, so that steps of 1/4000 come within 1e-6 of it.
  double least = 0;
  for (int k = 0; k < 4000; ++k) least = std::min(least, force_at(m, parting * k / 4000, true));
  CHECK(near_relative(least, -Fc, 1e-6));
  // At parting a goes as a square root: 1e-12 of the way there counts 1e-6.
  CHECK(near_relative(force_at(m, parting * (1 - 1e-13), true), -5.0 / 9 * Fc, 1e-6));
  CHECK(near_relative(force_at(m, 0, true), -8.0 / 9 * Fc, 1e-14));
  CHECK(std::abs(force_at(m, jkr_overlap_at_rest(pair), true)) < 1e-13 * Fc);
  CHECK(near_relative(Jkr::range(coefficients(m), 1e-3), -parting, 1e-15));
  // B9: -(3/4)(pi^2 w^2 R*/E*^2)^(1/3), and the Tabor parameter by hand.
  CHECK(near_relative(tabor_parameter({1e9, 1e-3, 0.1}, 3e-10), std::cbrt(1e-23) / 3e-10, 1e-14));
}

TEST_CASE("jkr: bodies attach where they touch and let go at parting, not before") {
  const auto m = sticky();
  const auto p = coefficients(m);
  const double parting = jkr_overlap_at_parting(pair_of(m));
  auto c = at_rest;
  Jkr::History<double> h{};
  for (const double overlap : {0.9 * parting, 0.1 * parting, 0.0}) {
    c.overlap = overlap;
    CHECK(Jkr::force(c, p, h).normal == 0);
    CHECK(h.contact_radius == 0);
    CHECK(Jkr::pressing(c, p, 0.0) == 0);
  }
  c.overlap = 1e-12;
  CHECK(Jkr::force(c, p, h).normal < 0);
  for (const double overlap : {0.1 * parting, 0.99 * parting}) {
    c.overlap = overlap;
    const double Fn = Jkr::force(c, p, h).normal;
    CHECK(Fn < 0);
    CHECK(h.contact_radius > 0);
    CHECK(near_relative(Jkr::pressing(c, p, Fn), Fn + 2 * jkr_pull_off(pair_of(m)), 1e-14));
  }
}

TEST_CASE("jkr: touching and parting costs 7.092 (w^5 R*^4/E*^2)^(1/3)") {
  const auto m = sticky();
  const auto pair = pair_of(m);
  const double parting = jkr_overlap_at_parting(pair), loss = jkr_energy_loss(pair);
  const double rough = std::cbrt(std::pow(0.1, 5) * 1e-12 / (pair.E_eff * pair.E_eff));
  CHECK(near_relative(loss, 7.09 * rough, 1e-3));  // three digits in the source
  // -F over the way from touch to parting, in x with d = d_t (1 - x^2), smooth at parting.
  double work = 0;
  const int n = 2000;
  for (int k = 0; k < n; ++k) {
    const double x = (k + 0.5) / n;
    work += -force_at(m, parting * (1 - x * x), true) * -parting * 2 * x / n;
  }
  CHECK(near_relative(work, loss, 1e-6));  // midpoints: 1/n^2
  CHECK(near_relative(jkr_sticking_speed(pair, 1e-6), std::sqrt(2e6 * loss), 1e-15));
}

TEST_CASE("jkr: without adhesion it is Hertz and Mindlin") {
  using Hertz = BasicHertzMindlin<DampingEnd::ZeroOverlap>;
  const Hertz::Material hertz{1e7, 0.25, 0.7, 0.4};
  const auto p = Hertz::mix(hertz, hertz, Hertz::like(hertz));
  const auto q = coefficients(sticky(0, 0.7));
  Random random(4);
  for (int k = 0; k < 1000; ++k) {
    const auto c = random_contact(random);
    Hertz::History<double> h{across(random_vector(random, 0.1), c.normal)};
    Jkr::History<double> j{h.tangential, 0};
    // Its contact radius a step ago, so that it unloads alike.
    j.contact_radius =
        std::sqrt(c.R_eff * std::max(c.overlap + c.time_step * c.normal_velocity, 0.0));
    const auto f = Hertz::force(c, p, h), g = Jkr::force(c, q, j);
    CHECK(std::abs(f.normal - g.normal) <= 1e-13 * (std::abs(f.normal) + 1));
    CHECK(norm(f.tangential - g.tangential) <= 1e-12 * (norm(f.tangential) + 1e-3));
    CHECK(near_relative(Jkr::stiffness(c, q), Hertz::stiffness(c, p), 1e-14));
  }
  CHECK(Jkr::range(q, 1e-3) == 0);
}

TEST_CASE("jkr: a batch equals doubles") {
  // Spring and adhesion cancel.
  for (const double w : {0.0, 0.1, 10.0})
    CHECK(largest_lane_difference<Jkr>(coefficients(sticky(w, 0.6)), 0.1, 1e-6) < 1e-11);
}

TEST_CASE("jkr: friction stays within mu (F_n + 2 F_c), and holds where the bodies pull") {
  const auto m = sticky(0.1, 0.6);
  const auto p = coefficients(m);
  Random random(9);
  int sliding = 0, pulled = 0;
  for (int k = 0; k < 20000; ++k) {
    auto c = random_contact(random);
    const auto pair = pair_of(m, c.R_eff);
    c.overlap = random.uniform(jkr_overlap_at_parting(pair), -2 * jkr_overlap_at_parting(pair));
    c.normal_velocity = random.uniform(-1e-3, 1e-3);
    Jkr::History<double> h{across(random_vector(random, 1e-3), c.normal), 1e-6};
    const auto f = Jkr::force(c, p, h);
    const double limit = 0.4 * std::max(f.normal + 2 * jkr_pull_off(pair), 0.0);
    CHECK(norm(f.tangential) <= limit * (1 + 1e-13));
    sliding += norm(f.tangential) > 0.999 * limit;
    pulled += f.normal < 0 && norm(f.tangential) > 0;
  }
  CHECK(sliding > 500);
  CHECK(pulled > 1000);
}

TEST_CASE("jkr: no closed cycle of displacements gives energy") {
  Random random(3);
  for (const double friction : {0.3, 1e6})
    for (int k = 0; k < 100; ++k) {
      const RandomCycle path(random);
      const auto work = cycle<Jkr>(coefficients(sticky(0.1, 1, friction)), path, 4000);
      CAPTURE(k);
      // The force of a step sees its end, not its middle: 1/4000 of what is turned over.
      CHECK(work.gained < 2.5e-4 * work.turned_over);
    }
}

TEST_CASE("jkr: each parameter of the material changes the force") {
  auto c = at_rest;
  c.normal_velocity = -0.1, c.tangential_velocity = {0.1, 0, 0};
  const auto force = [&](const Jkr::Material& m, double kept) {
    Jkr::History<double> h{{kept, 0, 0}, 0};
    return Jkr::force(c, coefficients(m), h);
  };
  const auto base = sticky(0.1, 0.6);
  const auto reference = force(base, 0);
  for (const auto field : {&Jkr::Material::youngs_modulus, &Jkr::Material::poisson_ratio,
                           &Jkr::Material::restitution, &Jkr::Material::work_of_adhesion}) {
    auto changed = base;
    changed.*field *= 0.9;
    CHECK(std::abs(force(changed, 0).normal / reference.normal - 1) > 1e-4);
  }
  auto changed = base;
  changed.friction *= 0.9;
  CHECK(near_relative(force(changed, -100).tangential.x, 0.9 * force(base, -100).tangential.x,
                      1e-14));
}

TEST_CASE("jkr: refuses values out of range and names them") {
  const auto with = [](double Jkr::Material::*field, double value) {
    return [=] {
      auto m = sticky();
      m.*field = value;
      Jkr::check(m);
    };
  };
  using M = Jkr::Material;
  for (const double bad : {0.0, -1e7, std::nan(""), HUGE_VAL})
    refuses(with(&M::youngs_modulus, bad), {"Jkr::Material.youngs_modulus", "[Pa]"});
  refuses(with(&M::poisson_ratio, 0.6), {"poisson_ratio = 0.6", "[0, 0.5]"});
  for (const double bad : {-0.1, std::nan(""), HUGE_VAL})
    refuses(with(&M::work_of_adhesion, bad), {"Jkr work_of_adhesion", "[J/m2]"});
  refuses(with(&M::restitution, 0), {"Jkr restitution = 0 [-]"});
  refuses(with(&M::friction, -1), {"Jkr friction = -1 [-]"});
  refuses([] { jkr_pull_off({0, 1, 1}); }, {"AdhesivePair.E_eff = 0 [Pa]"});
  refuses([] { jkr_energy_loss({1, -1, 1}); }, {"AdhesivePair.R_eff = -1 [m]"});
  refuses([] { jkr_overlap_at_rest({1, 1, -1}); }, {"AdhesivePair.work_of_adhesion = -1 [J/m2]"});
  refuses([] { tabor_parameter({1, 1, 1}, 0); }, {"z0 = 0 [m]"});
  refuses([] { jkr_sticking_speed({1, 1, 1}, 0); }, {"m_eff = 0 [kg]"});
}

}  // namespace jkr_test
