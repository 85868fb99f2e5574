// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/study/unequal_damping.hpp>

namespace unequal_damping_test {

namespace {

using namespace silt;
using enum DampingEnd;
using enum DashpotRule;

}  // namespace

TEST_CASE("unequal_damping: what wrong rules make of e = 0.5 and 0.8, the table of B4") {
  // Size ratios 1, 2, 5, 10; three digits.
  const struct {
    DashpotRule rule;
    double half[4], four_fifths[4];
  } table[] = {{DashpotsInSeries, {.616, .584, .529, .511}, {.854, .840, .814, .805}},
               {MeanMass, {.366, .175, 0, 0}, {.729, .602, .117, 0}},
               {HarmonicMeanMass, {.366, .366, .366, .366}, {.729, .729, .729, .729}},
               {MeanDashpot, {.366, .217, 0, 0}, {}}};
  const double sizes[] = {1, 2, 5, 10};
  for (const auto& row : table)
    for (int k = 0; k < 4; ++k) {
      CAPTURE(static_cast<int>(row.rule));
      CAPTURE(sizes[k]);
      const double ratio = std::pow(sizes[k], 3);
      CHECK(std::abs(restitution_with(row.rule, 0.5, ratio, ZeroOverlap) - row.half[k]) < 5.1e-4);
      // B4 gives no numbers of 0.8 for the mean of the dashpots.
      if (row.rule != MeanDashpot)
        CHECK(std::abs(restitution_with(row.rule, 0.8, ratio, ZeroOverlap) - row.four_fifths[k]) <
              5.1e-4);
      // Either of the two may be the larger one.
      CHECK(std::abs(restitution_with(row.rule, 0.5, ratio, ZeroForce) -
                     restitution_with(row.rule, 0.5, 1 / ratio, ZeroForce)) < 1e-13);
    }
}

TEST_CASE("unequal_damping: the law itself, its dashpot changed as a rule says, rebounds so") {
  using Law = BasicHertzMindlin<ZeroOverlap>;
  const Law::Material m{1e7, 0.3, 0.8};
  for (const double size : {1.0, 2.0, 5.0})
    for (const auto rule : {DashpotsInSeries, MeanMass, MeanDashpot}) {
      const double m1 = 1e-6, m2 = m1 * std::pow(size, 3);
      auto p = Law::mix(m, m, Law::like(m));
      const double m_eff = effective_mass(m1, m2);
      const double c =
          rule == DashpotsInSeries
              ? 1 / (1 / std::sqrt(m1) + 1 / std::sqrt(m2))
              : (rule == MeanMass ? std::sqrt((m1 + m2) / 2) : (std::sqrt(m1) + std::sqrt(m2)) / 2);
      p.normal_damping *= c / std::sqrt(m_eff);
      Contact<double> contact{};
      contact.normal = {1, 0, 0};
      contact.R_eff = effective_radius(1e-3, size * 1e-3);
      contact.m_eff = m_eff, contact.inverse_m_eff = 1 / m_eff;
      contact.time_step = 0;  // no lag of the velocity to allow for
      const double dt = Law::contact_time(p, contact.R_eff, m_eff, 1) / 20000;
      double overlap = 0, v = 1;  // [m], [m/s] of approach; Euler's midpoint rule
      const auto pull = [&](double d, double rate) {
        Law::History<double> h{};
        contact.overlap = std::max(d, 0.0), contact.normal_velocity = -rate;
        return Law::force(contact, p, h).normal / m_eff;
      };
      do {
        const double half = v - 0.5 * dt * pull(overlap, v), middle = overlap + 0.5 * dt * v;
        overlap += dt * half, v -= dt * pull(middle, half);
      } while (overlap > 0);
      CAPTURE(size);
      CAPTURE(static_cast<int>(rule));
      // The last step ends up to dt late, and the first ones see d^(1/4): some 1e-5.
      CHECK(std::abs(-v - restitution_with(rule, 0.8, m2 / m1, ZeroOverlap)) < 1e-4);
    }
}

TEST_CASE("unequal_damping: a mass ratio out of range is refused") {
  std::string sentence;
  try {
    restitution_with(MeanMass, 0.5, 0, ZeroForce);
  } catch (const InputError& error) {
    sentence = error.what();
  }
  CHECK(sentence == "mass ratio = 0 [-] must be finite and greater than 0");
  CHECK_THROWS_AS(restitution_with(MeanMass, 1.5, 1, ZeroForce), InputError);
}

}  // namespace unequal_damping_test
