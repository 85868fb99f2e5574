// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include <silt/contact/formulas.hpp>
#include <silt/contact/impact.hpp>

#include "near.hpp"

namespace formulas_test {

// "B1" ... "A1.3" are sections of the physics reference from which the numbers come. "mpmath" are
// values computed at 40 digits from the defining equations (restitution by bisection, duration of
// the end ZeroForce by quadrature, of ZeroOverlap by its Gamma functions of complex argument).

namespace {

using namespace silt;
using enum DampingEnd;
constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double restitutions[] = {1, 0.9, 0.5, 0.1, 0.05};
constexpr DampingEnd ends[] = {ZeroOverlap, ZeroForce};

/// `value` printed with so many digits reads as `table`: half a unit of the last digit.
bool rounds_to(double value, double table, double last_digit) {
  return std::abs(value - table) <= 0.5000001 * last_digit;
}

template <class Call>
std::string refusal(const Call& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

bool names(const std::string& sentence, const std::string& words) {
  return sentence.find(words) != std::string::npos;
}

/// The sphere of A1.3: diameter 4 mm, 1123 kg/m3, nu = 0.3, on a wall of its own material.
HertzImpact document_001(double shear, double speed, double zeta = 0, double radius = 0.002) {
  const double E = youngs_modulus(shear, 0.3);
  const double mass = 4.0 / 3.0 * std::numbers::pi * radius * radius * radius * 1123;
  return {effective_modulus(E, 0.3, E, 0.3), effective_radius(radius, infinite),
          effective_mass(mass, infinite), speed, zeta};
}

struct Outcome {
  double restitution, duration, max_overlap, max_force;
};

/// Integrates m d'' = -force(d, d') from first touch to the end of the contact by the classical
/// Runge-Kutta method. Steps shrink with the overlap, where Hertz' law is not smooth.
template <class Force>
class Collision {
 public:
  Collision(Force force, double mass, double speed, double time_scale)
      : force_(force), mass_(mass), speed_(speed), scale_(time_scale) {}

  Outcome run(DampingEnd end) const {
    const auto ended = [&](State s) {
      return end == ZeroOverlap ? s.d <= 0 : force_(std::max(s.d, 0.0), s.v) <= 0;
    };
    State now{0, speed_};
    Outcome out{0, 0, 0, force_(0, speed_)};
    for (int step = 0; step < 1'000'000; ++step) {
      const double h = std::min(scale_ / 2000, 0.002 * now.d / std::abs(now.v) + 1e-9 * scale_);
      const State next = advanced(now, h);
      if (now.v > 0 && next.v <= 0)
        out.max_overlap = advanced(now, moment(now, h, [](State s) { return s.v <= 0; })).d;
      if (ended(next)) {
        const double last = moment(now, h, ended);
        out.duration += last;
        out.restitution = -advanced(now, last).v / speed_;
        return out;
      }
      now = next;
      out.duration += h;
      out.max_force = std::max(out.max_force, force_(now.d, now.v));
    }
    FAIL("the contact did not end");
    return out;
  }

 private:
  struct State {
    double d, v;  // [m] overlap, [m/s] its rate
  };
  State rate(State s) const { return {s.v, -force_(std::max(s.d, 0.0), s.v) / mass_}; }
  State advanced(State s, double h) const {
    const auto along = [&](State k, double share) {
      return State{s.d + share * h * k.d, s.v + share * h * k.v};
    };
    const State a = rate(s), b = rate(along(a, 0.5)), c = rate(along(b, 0.5)),
                e = rate(along(c, 1));
    return {s.d + h / 6 * (a.d + 2 * b.d + 2 * c.d + e.d),
            s.v + h / 6 * (a.v + 2 * b.v + 2 * c.v + e.v)};
  }
  /// The part of the step h from `s` after which `happened` turns true.
  template <class Event>
  double moment(State s, double h, const Event& happened) const {
    double before = 0, after = h;
    for (int halving = 0; halving < 60; ++halving) {
      const double middle = 0.5 * (before + after);
      (happened(advanced(s, middle)) ? after : before) = middle;
    }
    return after;
  }

  Force force_;
  double mass_, speed_, scale_;
};

/// The full law of the Hertz spring with its dashpot.
Outcome collide(const HertzImpact& i, DampingEnd end) {
  const double kH = hertz_stiffness(i.E_eff, i.R_eff);
  const double c = std::sqrt(5) * i.zeta * std::sqrt(i.m_eff * kH);
  const auto force = [=](double d, double rate) {
    return kH * d * std::sqrt(d) + c * std::sqrt(std::sqrt(d)) * rate;
  };
  const double scale = hertz_contact_time(i.E_eff, i.R_eff, i.m_eff, i.speed);
  return Collision(force, i.m_eff, i.speed, scale).run(end);
}

}  // namespace

TEST_CASE("effective quantities: like partners, a wall, a rigid wall") {
  // Powers of two and short decimals: one or two roundings at most.
  static_assert(effective_radius(2, 2) == 1 && effective_radius(2, infinite) == 2);
  static_assert(effective_mass(4, 4) == 2 && effective_mass(4, infinite) == 4);
  const double E = 7e10, nu = 0.25, G = shear_modulus(E, nu);
  CHECK(near_relative(G, 2.8e10, 1e-15));
  CHECK(near_relative(youngs_modulus(G, nu), E, 1e-15));
  CHECK(near_relative(effective_modulus(E, nu, E, nu), E / (2 * (1 - nu * nu)), 1e-15));
  CHECK(near_relative(effective_modulus(E, nu, infinite, 0.3), E / (1 - nu * nu), 1e-15));
  CHECK(near_relative(effective_shear_modulus(E, nu, E, nu), G / (2 * (2 - nu)), 1e-15));
  CHECK(near_relative(effective_shear_modulus(E, nu, infinite, 0.3), G / (2 - nu), 1e-15));
  CHECK(near_relative(effective_radius(1e-3, 3e-3), 0.75e-3, 1e-15));
  CHECK(near_relative(effective_mass(1, 3), 0.75, 1e-15));
  CHECK(effective_modulus(7e10, 0.2, 2e11, 0.3) == effective_modulus(2e11, 0.3, 7e10, 0.2));
  // Steel on glass by hand: 1/(0.91/2e11 + 0.96/7e10) and 1/(1.7/7.6923077e10 + 1.8/2.9166667e10).
  CHECK(near_relative(effective_modulus(2e11, 0.3, 7e10, 0.2), 5.4751662104e10, 1e-10));
  CHECK(near_relative(effective_shear_modulus(2e11, 0.3, 7e10, 0.2), 1.1931140276e10, 1e-10));
  // B2: S_t/S_n = 4 G*/E* = 2 (1 - nu)/(2 - nu) for like materials, 0.8235 at nu = 0.3.
  const double ratio =
      4 * effective_shear_modulus(E, 0.3, E, 0.3) / effective_modulus(E, 0.3, E, 0.3);
  CHECK(rounds_to(ratio, 0.8235, 1e-4));
}

TEST_CASE("damping_ratio: the values of B1, B2 and mpmath, to the last digits") {
  const struct {
    double e, zeta, last_digit;
  } zero_force[] = {// B2
                    {.9, .03427, 1e-5},  {.8, .07436, 1e-5},  {.7, .12221, 1e-5},
                    {.6, .18086, 1e-5},  {.5, .25528, 1e-5},  {.4, .35451, 1e-5},
                    {.39, .36637, 1e-5}, {.3, .49724, 1e-5},  {.2, .73125, 1e-5},
                    {.1353, 1.0, 1e-3},  {.1, 1.24319, 1e-5}, {.05, 1.94535, 1e-5}};
  for (const auto& row : zero_force) {
    CAPTURE(row.e);
    CHECK(rounds_to(damping_ratio(row.e, ZeroForce), row.zeta, row.last_digit));
  }
  const struct {
    double e, zero_force, zero_overlap;
  } exact[] = {// mpmath
               {0.9, 0.034265204126232761, 0.033518449105676372},
               {0.5, 0.25527563764865181, 0.21545376196624678},
               {0.1, 1.2431878510137803, 0.59115503379889751},
               {0.05, 1.9453461844077074, 0.69010673055982166},
               {0.001, 15.717048578941986, 0.91028187401036883}};
  for (const auto& row : exact) {
    CAPTURE(row.e);
    CHECK(near_relative(damping_ratio(row.e, ZeroForce), row.zero_force, 2e-15));
    CHECK(near_relative(damping_ratio(row.e, ZeroOverlap), row.zero_overlap, 2e-15));
  }
  CHECK(near_relative(damping_ratio(std::exp(-2), ZeroForce), 1, 1e-15));
  for (const auto end : ends) CHECK(damping_ratio(1, end) == 0);
}

TEST_CASE("damping_ratio and restitution_of: inverse to each other and monotone, to the extremes") {
  for (const auto end : ends) {
    double last = infinite;
    for (double e = 1e-9; e < 1; e *= 1.03) {
      const double zeta = damping_ratio(e, end);
      CAPTURE(e);
      CHECK(zeta < last);
      // An error of 1e-15 in zeta is one of 2e-15 |ln e| in e, and more where zeta (ZeroOverlap)
      // nears 1: 1 - zeta = 0.01 at e = 1e-9.
      CHECK(near_relative(restitution_of(zeta, end), e, end == ZeroForce ? 1e-13 : 1e-12));
      last = zeta;
    }
    CHECK(restitution_of(0, end) == 1);
    for (const double e : {1 - 1e-3, 1 - 1e-9, 1 - 1e-15})  // zeta = -ln e/pi to first order
      CHECK(near_relative(damping_ratio(e, end) * std::numbers::pi, -std::log(e), 1 - e + 1e-15));
  }
  // zeta = exp(L/2)/2 to first order for L = -ln e large; the error of L = 690 counts half.
  CHECK(near_relative(damping_ratio(1e-300, ZeroForce), 5e149, 2e-13));
  // Smooth through zeta = 1: with A = 1 - h/3 + O(h^2), ln e = -2 (1 + 2/3 h) + O(h^2).
  for (const double h : {-1e-9, -1e-12, 0.0, 1e-12, 1e-9})
    CHECK(near_relative(restitution_of(1 + h, ZeroForce), std::exp(-2 - 4.0 / 3 * h), 1e-15));
  CHECK(restitution_of(1, ZeroOverlap) == 0);
  CHECK(restitution_of(7, ZeroOverlap) == 0);
}

TEST_CASE("damping_ratio: cutting the attraction raises the restitution as in B2") {
  const struct {
    double e, cut;
  } table[] = {{.9, .902}, {.7, .718}, {.5, .550}, {.4, .472},
               {.3, .397}, {.2, .325}, {.1, .253}, {.05, .214}};
  for (const auto& row : table) {
    CAPTURE(row.e);
    CHECK(rounds_to(restitution_of(damping_ratio(row.e, ZeroOverlap), ZeroForce), row.cut, 1e-3));
  }
}

TEST_CASE("damping: a restitution or a damping ratio out of range is refused by name and value") {
  for (const auto end : ends) {
    for (const double e : {0.0, -0.5, 1.3, infinite, std::nan("")})
      CHECK(names(refusal([&] { damping_ratio(e, end); }), "must be in (0, 1]"));
    CHECK(names(refusal([&] { damping_ratio(1.3, end); }), "restitution = 1.3 [-]"));
    for (const double zeta : {-0.1, infinite, std::nan("")}) {
      CHECK(names(refusal([&] { restitution_of(zeta, end); }), "damping ratio = "));
      CHECK(names(refusal([&] { linear_contact_time(1, 1, zeta, end); }), "damping ratio = "));
      CHECK(names(refusal([&] { hertz_contact_time_ratio(zeta, end); }), "damping ratio = "));
    }
  }
  CHECK(names(refusal([] { linear_max_overlap(1, 1, 1, -0.1); }), "damping ratio = -0.1 [-]"));
  CHECK(names(refusal([] { linear_max_force(1, 1, 1, -0.1); }), "damping ratio = -0.1 [-]"));
  CHECK(names(refusal([] { hertz_overlap_ratio(-0.1); }), "damping ratio = -0.1 [-]"));
}

TEST_CASE("linear spring: the full law integrated meets e, t_c, d_max and F_max within 1e-6") {
  const double k = 5e4, m = 3.7632e-5, v = 1.7;
  for (const auto end : ends)
    for (const double e : restitutions) {
      const double zeta = damping_ratio(e, end), c = 2 * zeta * std::sqrt(m * k);
      const auto force = [=](double d, double rate) { return k * d + c * rate; };
      const Outcome run = Collision(force, m, v, std::numbers::pi * std::sqrt(m / k)).run(end);
      CAPTURE(e);
      CAPTURE(static_cast<int>(end));
      // Runge-Kutta at 2000 steps a contact: far below 1e-9. The force is sampled at the steps: its
      // flat top is missed by (pi/2000)^2/8 = 3e-7 at most.
      CHECK(near_relative(run.restitution, e, 1e-9));
      CHECK(near_relative(run.duration, linear_contact_time(k, m, zeta, end), 1e-9));
      CHECK(near_relative(run.max_overlap, linear_max_overlap(k, m, v, zeta), 1e-9));
      CHECK(near_relative(run.max_force, linear_max_force(k, m, v, zeta), 1e-6));
    }
  CHECK(linear_contact_time(k, m, 1, ZeroOverlap) == infinite);
  CHECK(linear_contact_time(k, m, 0) == linear_contact_time(k, m, 0, ZeroOverlap));
}

TEST_CASE("linear_stiffness_from_hertz: stores the impact's energy at Hertz' largest overlap") {
  const HertzImpact impact{5e7, 2e-3, 4e-5, 3};
  const double k =
      linear_stiffness_from_hertz(impact.E_eff, impact.R_eff, impact.m_eff, impact.speed);
  const double overlap = hertz_max_overlap(impact);
  CHECK(near_relative(k * overlap * overlap, impact.m_eff * impact.speed * impact.speed, 1e-14));
  CHECK(near_relative(linear_max_overlap(k, impact.m_eff, impact.speed, 0), overlap, 1e-14));
}

TEST_CASE("hertz: the full law integrated meets e, t_c, d_max and F_max within 1e-6") {
  for (const auto end : ends)
    for (const double e : restitutions) {
      const HertzImpact impact = document_001(1e7, 7, damping_ratio(e, end));
      const Outcome run = collide(impact, end);
      CAPTURE(e);
      CAPTURE(static_cast<int>(end));
      // The first step, 1e-9 of the contact, sees a dashpot like t^(1/4): relative error 1e-11. The
      // force is sampled at the steps: its flat top is missed by less than 1e-6.
      CHECK(near_relative(run.restitution, e, 1e-8));
      CHECK(near_relative(run.duration, hertz_contact_time(impact, end), 1e-8));
      CHECK(near_relative(run.max_overlap, hertz_max_overlap(impact), 1e-8));
      CHECK(near_relative(run.max_force, hertz_max_force(impact), 1e-6));
    }
}

TEST_CASE("hertz: one zeta gives one restitution at every speed, mass and modulus") {
  for (const auto end : ends)
    for (const double e : {0.8, 0.2})
      for (const double speed : {1e-3, 300.0}) {
        const HertzImpact impact{1e6 * speed, 3e-4, 2e-7 / speed, speed, damping_ratio(e, end)};
        CHECK(near_relative(collide(impact, end).restitution, e, 1e-8));
      }
}

TEST_CASE("hertz: undamped overlap, force and contact time of B3") {
  const HertzImpact i = document_001(1e7, 7);
  const double kH = hertz_stiffness(i.E_eff, i.R_eff), energy = i.m_eff * i.speed * i.speed;
  const double factor = 0.8 * std::sqrt(std::numbers::pi) * std::tgamma(0.4) / std::tgamma(0.9);
  CHECK(near_relative(hertz_time_factor, factor, 1e-14));  // tgamma: a few 1e-16 each
  CHECK(rounds_to(hertz_time_factor, 2.943275, 1e-6));
  const double overlap = std::pow(1.25 * energy / kH, 0.4);
  CHECK(near_relative(hertz_max_overlap(i), overlap, 1e-14));
  CHECK(near_relative(hertz_max_elastic_force(i), std::pow(kH, 0.4) * std::pow(1.25 * energy, 0.6),
                      1e-14));
  CHECK(near_relative(hertz_max_force(i), hertz_max_elastic_force(i), 1e-14));
  const double time = hertz_contact_time(i.E_eff, i.R_eff, i.m_eff, i.speed);
  CHECK(near_relative(time, factor * overlap / i.speed, 1e-14));
  // 2.868266 (m*^2/(R* E*^2 v))^(1/5); six decimals are 1.7e-7.
  CHECK(near_relative(
      time, 2.868266 * std::pow(i.m_eff * i.m_eff / (i.R_eff * i.E_eff * i.E_eff * 7), 0.2), 2e-7));
  // Sphere on a wall: d_max/d = 0.5 (1.25 pi rho v^2/E*)^(2/5); equal spheres 2^(-1/5) of it.
  const double share = 0.5 * std::pow(1.25 * std::numbers::pi * 1123 * 49 / i.E_eff, 0.4);
  CHECK(near_relative(hertz_max_overlap(i) / 0.004, share, 1e-14));
  const HertzImpact equal{i.E_eff, i.R_eff / 2, i.m_eff / 2, i.speed};
  CHECK(rounds_to(hertz_max_overlap(equal) / hertz_max_overlap(i), 0.8706, 1e-4));
  for (const auto end : ends) CHECK(hertz_contact_time(i, end) == time);
}

TEST_CASE("hertz_overlap_ratio: table of B3, both closed forms in e, table of B2") {
  const struct {
    double e, r;
  } table[] = {{1, 1},        {.95, .97990}, {.9, .95959},  {.85, .93907}, {.8, .91830},
               {.75, .89728}, {.7, .87599},  {.65, .85439}, {.6, .83247},  {.55, .81017},
               {.5, .78747},  {.45, .76430}, {.4, .74060},  {.35, .71626}, {.3, .69116},
               {.25, .66510}, {.2, .63779},  {.15, .60872}, {.1, .57685},  {.075, .55917},
               {.05, .53941}};
  for (const auto& row : table) {
    CAPTURE(row.e);
    const double r = hertz_overlap_ratio(damping_ratio(row.e, ZeroOverlap));
    CHECK(rounds_to(r, row.r, 1e-5));
    if (row.e < 1) {
      const double exponent =
          0.8 / std::numbers::pi * std::atan(std::numbers::pi / std::abs(std::log(row.e)));
      CHECK(near_relative(r, std::pow(row.e, exponent), 1e-14));
    }
    CHECK(near_relative(hertz_overlap_ratio(damping_ratio(row.e, ZeroForce)), std::pow(row.e, 0.4),
                        1e-14));
  }
  const struct {
    double e, r;
  } cut[] = {{.9, .9587}, {.7, .8670}, {.5, .7579}, {.3, .6178}, {.1, .3981}};
  for (const auto& row : cut)
    CHECK(rounds_to(hertz_overlap_ratio(damping_ratio(row.e, ZeroForce)), row.r, 1e-4));
}

TEST_CASE("hertz_max_force: ratios of B3 to the undamped force, zeta for the end ZeroOverlap") {
  const struct {
    double e, ratio;
  } table[] = {{.9, .942}, {.7, .838}, {.5, .756}, {.4, .728}, {.3, .715}, {.2, .727}, {.1, .785}};
  for (const auto& row : table) {
    CAPTURE(row.e);
    const HertzImpact damped = document_001(1e7, 4, damping_ratio(row.e, ZeroOverlap));
    const double undamped = hertz_max_force(document_001(1e7, 4));
    CHECK(rounds_to(hertz_max_force(damped) / undamped, row.ratio, 1e-3));
    CHECK(near_relative(hertz_max_elastic_force(damped),
                        undamped * std::pow(hertz_overlap_ratio(damped.zeta), 1.5), 1e-14));
  }
}

TEST_CASE("hertz_contact_time_ratio: table of B3 and mpmath within 5e-15") {
  // B3 took zeta for the end ZeroOverlap in both rows.
  const struct {
    double e, zero_overlap, zero_force;
  } table[] = {{.9, 1.011, .971}, {.7, 1.042, .930}, {.5, 1.093, .891},
               {.3, 1.195, .846}, {.1, 1.511, .788}, {.05, 1.778, .767}};
  for (const auto& row : table) {
    CAPTURE(row.e);
    const double zeta = damping_ratio(row.e, ZeroOverlap);
    CHECK(rounds_to(hertz_contact_time_ratio(zeta, ZeroOverlap), row.zero_overlap, 1e-3));
    CHECK(rounds_to(hertz_contact_time_ratio(zeta, ZeroForce), row.zero_force, 1e-3));
  }
  const struct {
    double e, zero_force, zero_overlap;
  } exact[] = {// each with its own zeta
               {0.9, 0.97064244248910996, 1.0110681259017438},
               {0.5, 0.87718622676515238, 1.0933685435775769},
               {0.1, 0.67586319197297603, 1.5106599254542598},
               {0.05, 0.59650515608158917, 1.7783437896061193},
               {0.001, 0.24500137331631484, 4.4257062692966581}};
  for (const auto& row : exact) {
    CAPTURE(row.e);
    CHECK(near_relative(hertz_contact_time_ratio(damping_ratio(row.e, ZeroForce), ZeroForce),
                        row.zero_force, 5e-15));
    CHECK(near_relative(hertz_contact_time_ratio(damping_ratio(row.e, ZeroOverlap), ZeroOverlap),
                        row.zero_overlap, 5e-15));
  }
  // Weak damping, where the end of the quadrature lies next to the singularity of z^(-1/5).
  const struct {
    double zeta, zero_force, zero_overlap;
  } weak[] = {// mpmath
              {1e-2, 0.988235376574797073, 1.00318874775060075},
              {1e-4, 0.999658152907170644, 1.0000314206125641},
              {1e-6, 0.999990938682131839, 1.00000031415973393},
              {1e-8, 0.999999767640389414, 1.0000000031415927},
              {1e-12, 0.999999999851722946, 1.00000000000031416}};
  for (const auto& row : weak) {
    CAPTURE(row.zeta);
    CHECK(near_relative(hertz_contact_time_ratio(row.zeta, ZeroForce), row.zero_force, 5e-15));
    CHECK(near_relative(hertz_contact_time_ratio(row.zeta, ZeroOverlap), row.zero_overlap, 5e-15));
  }
  CHECK(hertz_contact_time_ratio(1, ZeroOverlap) == infinite);
  // Critical damping has its own branch: mpmath, and no step to its neighbours.
  CHECK(near_relative(hertz_contact_time_ratio(1, ZeroForce), 0.711679258973566987, 5e-15));
  for (const double zeta : {1 - 1e-9, 1 + 1e-9}) {
    CHECK(near_relative(hertz_contact_time_ratio(zeta, ZeroForce),
                        hertz_contact_time_ratio(1, ZeroForce), 3e-9));
    CHECK(near_relative(hertz_max_force(document_001(1e7, 7, zeta)),
                        hertz_max_force(document_001(1e7, 7, 1)), 3e-9));
  }
}

TEST_CASE("HertzImpact: every field out of range is refused by name, value and unit") {
  const HertzImpact good{1e7, 1e-3, 1e-5, 1, 0.2};
  const auto with = [&](double HertzImpact::*field, double value) {
    HertzImpact bad = good;
    bad.*field = value;
    for (const auto& sentence : {refusal([&] { hertz_max_elastic_force(bad); }),
                                 refusal([&] { hertz_contact_time(bad, ZeroForce); }),
                                 refusal([&] { hertz_max_force(bad); })})
      CHECK(sentence == refusal([&] { hertz_max_overlap(bad); }));
    return refusal([&] { hertz_max_overlap(bad); });
  };
  CHECK(names(with(&HertzImpact::E_eff, 0), "HertzImpact.E_eff = 0 [Pa]"));
  CHECK(names(with(&HertzImpact::R_eff, -1), "HertzImpact.R_eff = -1 [m]"));
  CHECK(names(with(&HertzImpact::m_eff, infinite), "HertzImpact.m_eff = inf [kg]"));
  CHECK(names(with(&HertzImpact::speed, 0), "HertzImpact.speed = 0 [m/s]"));
  CHECK(names(with(&HertzImpact::zeta, -0.5), "HertzImpact.zeta = -0.5 [-]"));
}

TEST_CASE("softest_modulus: bounds of B5, and an impact at the bound just meets the limit") {
  // E* = 79.66 rho v^2 r^2.5 (wall), 56.33 (equal spheres), at 15 % of the diameter.
  CHECK(rounds_to(softest_modulus_on_wall(1, 1, 0), 79.66, 0.01));
  CHECK(rounds_to(softest_modulus_on_wall(1, 1, 0) / std::numbers::sqrt2, 56.33, 0.01));
  const double zeta = damping_ratio(0.5, ZeroOverlap);
  const struct {
    double speed, modulus, last_digit;
  } table[] = {
      {1, 1.1e5, 1e4}, {10, 1.1e7, 1e6}, {50, 2.7e8, 1e7}, {100, 1.1e9, 1e8}, {200, 4.4e9, 1e8}};
  for (const auto& row : table)
    CHECK(rounds_to(softest_modulus_on_wall(2500, row.speed, zeta), row.modulus, row.last_digit));

  const double radius = 3e-4, mass = 4.0 / 3 * std::numbers::pi * std::pow(radius, 3) * 2500;
  for (const bool wall : {true, false}) {
    const OverlapLimit limit{.R_eff = effective_radius(radius, wall ? infinite : radius),
                             .m_eff = effective_mass(mass, wall ? infinite : mass),
                             .speed = 30,
                             .max_overlap = 0.1 * 2 * radius,
                             .zeta = zeta};
    const double modulus = softest_modulus(limit);
    CHECK(near_relative(hertz_max_overlap({modulus, limit.R_eff, limit.m_eff, 30, zeta}),
                        limit.max_overlap, 1e-14));
    CHECK(near_relative(
        modulus, softest_modulus_on_wall(2500, 30, zeta, 0.1) / (wall ? 1 : std::numbers::sqrt2),
        1e-14));
  }
}

TEST_CASE("softest_modulus: every value out of range is refused by name") {
  const OverlapLimit good{1e-3, 1e-5, 1, 1e-4, 0.2};
  const auto with = [&](double OverlapLimit::*field, double value) {
    OverlapLimit bad = good;
    bad.*field = value;
    return refusal([&] { softest_modulus(bad); });
  };
  CHECK(names(with(&OverlapLimit::R_eff, 0), "OverlapLimit.R_eff = 0 [m]"));
  CHECK(names(with(&OverlapLimit::m_eff, 0), "OverlapLimit.m_eff = 0 [kg]"));
  CHECK(names(with(&OverlapLimit::speed, 0), "OverlapLimit.speed = 0 [m/s]"));
  CHECK(names(with(&OverlapLimit::max_overlap, 0), "OverlapLimit.max_overlap = 0 [m]"));
  CHECK(names(with(&OverlapLimit::zeta, -1), "OverlapLimit.zeta = -1 [-]"));
  CHECK(names(refusal([] { softest_modulus_on_wall(0, 1, 0); }), "density = 0 [kg/m3]"));
  CHECK(names(refusal([] { softest_modulus_on_wall(1, 1, 0, -1); }), "overlap_per_diameter = -1"));
}

TEST_CASE("softest_linear_stiffness: an impact at the bound, integrated, just meets the limit") {
  for (const double zeta : {0.0, 0.25, 1.0, 1.9}) {
    const OverlapLimit limit{1e-3, 3e-5, 12, 2e-4, zeta};
    const double k = softest_linear_stiffness(limit), c = 2 * zeta * std::sqrt(limit.m_eff * k);
    const auto force = [=](double d, double rate) { return k * d + c * rate; };
    const double scale = std::numbers::pi * std::sqrt(limit.m_eff / k);
    const Outcome run = Collision(force, limit.m_eff, limit.speed, scale).run(ZeroForce);
    CAPTURE(zeta);
    CHECK(near_relative(run.max_overlap, limit.max_overlap, 1e-9));  // of the integration
  }
  CHECK(names(refusal([] {
                softest_linear_stiffness({1, 1, 1, -1});
              }),
              "OverlapLimit.max_overlap = -1 [m]"));
}

TEST_CASE("softening_factor: table of B5, equal time steps and the growth of the overlap") {
  using enum Softening;
  const struct {
    double s, rayleigh, contact_time, linear;
  } table[] = {
      {2, .25, .177, .125}, {3, .111, .0642, .037}, {5, .04, .0179, .008}, {10, .01, .00316, .001}};
  for (const auto& row : table) {
    const double small = 1e-4, wanted = row.s * small;
    CAPTURE(row.s);
    CHECK(rounds_to(softening_factor(small, wanted, Rayleigh), row.rayleigh, 1e-3));
    CHECK(rounds_to(softening_factor(small, wanted, ContactTime), row.contact_time,
                    row.s > 5 ? 1e-5 : 1e-4 * (row.s < 3 ? 10 : 1)));
    CHECK(rounds_to(softening_factor(small, wanted, LinearContactTime), row.linear, 1e-3));
    // The time step that counts is the wanted one's.
    const double G = 1e7;
    CHECK(near_relative(
        rayleigh_time_step(small, 2500, G * softening_factor(small, wanted, Rayleigh), 0.3),
        rayleigh_time_step(wanted, 2500, G, 0.3), 1e-14));
    const auto impact = [&](double radius, double E) {
      return HertzImpact{E, radius, 2500 * radius * radius * radius, 3};
    };
    const auto soft = impact(small, 1e7 * softening_factor(small, wanted, ContactTime));
    const auto large = impact(wanted, 1e7), hard = impact(small, 1e7);
    CHECK(near_relative(hertz_contact_time(soft, ZeroForce), hertz_contact_time(large, ZeroForce),
                        1e-14));
    CHECK(near_relative(hertz_max_overlap(soft) / hertz_max_overlap(hard), row.s, 1e-14));
    const auto rayleigh = impact(small, 1e7 * softening_factor(small, wanted, Rayleigh));
    CHECK(near_relative(hertz_max_overlap(rayleigh) / hertz_max_overlap(hard), std::pow(row.s, 0.8),
                        1e-14));
  }
  for (const auto rule : {Rayleigh, ContactTime, LinearContactTime})
    CHECK(softening_factor(2, 1, rule) == 1);  // nothing larger is made stiffer
  CHECK(names(refusal([] { softening_factor(0, 1, Rayleigh); }), "softening: radius = 0 [m]"));
  CHECK(names(refusal([] { softening_factor(1, -1, Rayleigh); }),
              "softening: wanted radius = -1 [m]"));
}

TEST_CASE("document 001: overlap over diameter of A1.3, e = 0.4") {
  const struct {
    double shear, at_1, at_4, at_7, digit_1, digit_4, digit_7;
  } table[] = {{1e3, 58.1, 176, 276, .1, 1, 1},         {5e3, 30.5, 92.6, 145, .1, .1, 1},
               {1e4, 23.1, 70.1, 110, .1, .1, 1},       {5e4, 12.2, 36.8, 57.7, .1, .1, .1},
               {1e5, 9.21, 27.9, 43.7, .01, .1, .1},    {5e5, 4.84, 14.7, 23.0, .01, .1, .1},
               {1e6, 3.67, 11.1, 17.4, .01, .1, .1},    {5e6, 1.93, 5.84, 9.14, .01, .01, .01},
               {1e7, 1.46, 4.43, 6.93, .01, .01, .01},  {1e8, .581, 1.76, 2.76, .001, .01, .01},
               {1e9, .231, .701, 1.10, .001, .001, .01}};
  const double zeta = damping_ratio(0.4, ZeroOverlap);
  const auto percent = [&](double shear, double speed) {
    return 100 * hertz_max_overlap(document_001(shear, speed, zeta)) / 0.004;
  };
  for (const auto& row : table) {
    CAPTURE(row.shear);
    CHECK(rounds_to(percent(row.shear, 1), row.at_1, row.digit_1));
    CHECK(rounds_to(percent(row.shear, 4), row.at_4, row.digit_4));
    CHECK(rounds_to(percent(row.shear, 7), row.at_7, row.digit_7));
  }
}

TEST_CASE("document 001: time steps of A1.3 and steps per contact") {
  const auto recipe = [](const HertzImpact& i) {  // sqrt(m/k_H), a recipe in SI numbers only
    return std::sqrt(i.m_eff / hertz_stiffness(i.E_eff, i.R_eff));
  };
  const auto duration = [](const HertzImpact& i) { return hertz_contact_time(i, ZeroForce); };
  const HertzImpact stiff = document_001(1e9, 7), soft = document_001(1e7, 7);
  CHECK(rounds_to(stiff.m_eff, 3.7632e-5, 1e-9));
  CHECK(rounds_to(recipe(stiff), 6.6466e-7, 1e-11));
  CHECK(rounds_to(recipe(soft), 6.6466e-6, 1e-10));
  CHECK(rounds_to(0.9 * recipe(soft), 5.982e-6, 1e-9));
  CHECK(rounds_to(duration(stiff) / recipe(stiff), 37.5, 0.1));
  CHECK(rounds_to(duration(soft) / (0.9 * recipe(soft)), 26.3, 0.1));
  CHECK(rounds_to(5e-6 / recipe(document_001(1e7, 7, 0, 1.4e-3)), 1.175, 0.001));  // A1.3: 1.18
  CHECK(rounds_to(5e-6 / recipe(document_001(1e7, 7, 0, 1.5e-3)), 1.08, 0.01));
}

TEST_CASE("time steps: numbers of B6 and of the pipes of A1.2") {
  const HertzImpact i = document_001(1e7, 7);
  CHECK(rounds_to(hertz_contact_time(i, ZeroForce), 1.573e-4, 1e-7));
  CHECK(rounds_to(rayleigh_time_step(0.002, 1123, 1e7, 0.3), 7.19e-5, 1e-7));
  // DualSPHysics writes t_c = 3.21 (m/k_H)^(2/5) v^(-1/5), 3.218 in full.
  const double kH = hertz_stiffness(i.E_eff, i.R_eff);
  const double constant =
      hertz_contact_time(i, ZeroForce) / (std::pow(i.m_eff / kH, 0.4) * std::pow(i.speed, -0.2));
  CHECK(rounds_to(constant, 3.218, 1e-3));
  const struct {
    double radius, pair, wall, last_digit_pair, last_digit_wall;
  } pipes[] = {{1.4e-3, 9.6e-5, 1.10e-4, 1e-6, 1e-6}, {1.5e-3, 1.03e-4, 1.18e-4, 1e-6, 1e-6}};
  for (const auto& pipe : pipes) {
    CAPTURE(pipe.radius);
    const HertzImpact wall = document_001(1e7, 7, 0, pipe.radius);
    const HertzImpact pair{wall.E_eff, wall.R_eff / 2, wall.m_eff / 2, 7};
    CHECK(rounds_to(hertz_contact_time(wall, ZeroForce), pipe.wall, pipe.last_digit_wall));
    CHECK(rounds_to(hertz_contact_time(pair, ZeroForce), pipe.pair, pipe.last_digit_pair));
  }
}

TEST_CASE("rayleigh_time_step: pi R over the exact Rayleigh speed, within 0.4 % for all nu") {
  // c_R = x c_s with (2 - x^2)^2 = 4 sqrt(1 - x^2) sqrt(1 - x^2 (1 - 2 nu)/(2 - 2 nu)); the fit's
  // error is 0.31 % at most.
  for (double nu = 0; nu <= 0.5; nu += 0.05) {
    const auto excess = [&](double x) {
      const double q = x * x;
      return (2 - q) * (2 - q) - 4 * std::sqrt((1 - q) * (1 - q * (1 - 2 * nu) / (2 - 2 * nu)));
    };
    double low = 0.5, high = 1;
    for (int halving = 0; halving < 60; ++halving) {
      const double middle = 0.5 * (low + high);
      (excess(middle) > 0 ? high : low) = middle;
    }
    const double time = std::numbers::pi * 0.002 * std::sqrt(1123 / 1e7) / low;
    CAPTURE(nu);
    CHECK(near_relative(rayleigh_time_step(0.002, 1123, 1e7, nu), time, 4e-3));
  }
  CHECK(near_relative(rayleigh_time_step(1, 1, 1, 0) / rayleigh_time_step(1, 1, 1, 0.5),
                      (0.8766 + 0.1631 / 2) / 0.8766, 1e-14));
}

}  // namespace formulas_test
