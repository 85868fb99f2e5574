// silt - BSD-3-Clause, see LICENSE
#include <silt/contact/damped_impact.hpp>
#include <silt/contact/hertz_mindlin.hpp>

#include "contact/support.hpp"

namespace hertz_damped_test {

namespace {

using namespace contact_test;
using enum DampingEnd;

/// The dashpot of HertzMindlin, whose impacts have closed forms.
struct QuarterPower {
  static constexpr std::string_view unit = "kg^1/2 N^1/2 / m^3/4";
  static constexpr double exponent = 0.25;
  static double prefactor(double dissipation, double) { return dissipation; }
};

const HertzImpact impact{5e6, 1e-3, 2e-5, 1.5};

template <class Law>
typename Law::Material rubber(double dissipation, double friction = 0.4) {
  return {.youngs_modulus = 1e8,
          .poisson_ratio = 0.25,
          .dissipation = dissipation,
          .friction = friction};
}
template <class Law>
auto coefficients(double dissipation, double friction = 0.4) {
  const auto m = rubber<Law>(dissipation, friction);
  return Law::mix(m, m, Law::like(m));
}

/// Rebound speed over `speed` of the law itself, by leapfrog in the limit of a short step.
template <class Law>
double rebound(const typename Law::template Coefficients<double>& p, const HertzImpact& i,
               DampingEnd end) {
  Contact<double> c{};
  c.normal = {1, 0, 0};
  c.R_eff = i.R_eff, c.m_eff = i.m_eff, c.inverse_m_eff = 1 / i.m_eff, c.time_step = 0;
  const double dt = Law::contact_time(p, i.R_eff, i.m_eff, i.speed) / 40000;
  double d = 0, v = i.speed;
  const auto pull = [&](double overlap, double rate) {
    typename Law::template History<double> h{};
    c.overlap = std::max(overlap, 0.0), c.normal_velocity = -rate;
    return Law::force(c, p, h).normal / i.m_eff;
  };
  for (int k = 0; k < 1'000'000; ++k) {
    const double half = v - 0.5 * dt * pull(d, v), middle = d + 0.5 * dt * v;
    const double a = pull(middle, half);
    if (end == ZeroForce && v < 0 && a == 0) break;
    d += dt * half, v -= dt * a;
    if (d <= 0) break;
  }
  return -v / i.speed;
}

template <class Damping>
void law_rebounds_as_computed() {
  for (const double e : {0.9, 0.5, 0.2}) {
    using Cut = HertzDamped<Damping>;
    using Kept = HertzDamped<Damping, ZeroOverlap>;
    const double E = coefficients<Cut>(0).twice_modulus / 2;
    const HertzImpact i{E, 1e-3, 2e-5, 1.5};
    CAPTURE(e);
    // Steps of 1/40000 of the contact, the start of which is not smooth: 1e-4.
    CHECK(std::abs(rebound<Cut>(coefficients<Cut>(dissipation_for<Damping>(e, i)), i, ZeroForce) -
                   e) < 1e-4);
    const auto p = coefficients<Kept>(dissipation_for<Damping>(e, i, ZeroOverlap));
    CHECK(std::abs(rebound<Kept>(p, i, ZeroOverlap) - e) < 1e-4);
  }
}

template <class Damping>
void law_as_any_other(double dissipation) {
  using Law = HertzDamped<Damping>;
  using Kept = HertzDamped<Damping, ZeroOverlap, TangentialMemory::Displacement>;
  // Sums of three products in another order or fused: 1e-15 each, some tens of operations.
  CHECK(largest_lane_difference<Law>(coefficients<Law>(dissipation), 0.1) < 1e-13);
  CHECK(largest_lane_difference<Kept>(coefficients<Kept>(dissipation), 1e-6) < 1e-13);
  check_coulomb_limit<Law>(coefficients<Law>(dissipation), 0.4, 1);

  auto c = contact_at_rest();
  typename Law::template History<double> none{};
  const auto still = Law::force(c, coefficients<Law>(dissipation), none);
  HertzMindlin::History<double> h{};
  const HertzMindlin::Material hertz{1e8, 0.25, 1, 0.4};
  const auto p = HertzMindlin::mix(hertz, hertz, HertzMindlin::like(hertz));
  CHECK(still.normal == HertzMindlin::force(c, p, h).normal);
  CHECK(Law::stiffness(c, coefficients<Law>(0)) == HertzMindlin::stiffness(c, p));

  c.normal_velocity = -0.1, c.tangential_velocity = {0.1, 0, 0};
  const auto force = [&](const typename Law::Material& m, double kept) {
    typename Law::template History<double> memory{{kept, 0, 0}};
    return Law::force(c, Law::mix(m, m, Law::like(m)), memory);
  };
  const auto base = rubber<Law>(dissipation);
  const auto reference = force(base, 0);
  for (const auto field : {&Law::Material::youngs_modulus, &Law::Material::poisson_ratio,
                           &Law::Material::dissipation}) {
    auto changed = base;
    changed.*field *= 0.9;
    CHECK(std::abs(force(changed, 0).normal / reference.normal - 1) > 1e-3);
  }
  auto changed = base;
  changed.friction *= 0.9;
  CHECK(near_relative(force(changed, -100).tangential.x, 0.9 * force(base, -100).tangential.x,
                      1e-14));

  const auto with = [&](double Law::Material::*field, double value) {
    return [=] {
      auto m = base;
      m.*field = value;
      Law::check(m);
    };
  };
  using M = typename Law::Material;
  for (const double bad : {0.0, -1.0, std::nan("")})
    refuses(with(&M::youngs_modulus, bad), {"HertzDamped::Material.youngs_modulus", "[Pa]"});
  refuses(with(&M::poisson_ratio, 0.51), {"poisson_ratio = 0.51", "[0, 0.5]"});
  for (const double bad : {-1.0, std::nan(""), HUGE_VAL})
    refuses(with(&M::dissipation, bad),
            {"HertzDamped dissipation", "[" + std::string(Damping::unit) + "]"});
  refuses(with(&M::friction, -0.1), {"HertzDamped friction = -0.1"});
}

}  // namespace

TEST_CASE("damped_impact: the power 1/4 gives the closed forms of HertzMindlin's dashpot") {
  const double unit = std::sqrt(5 * impact.m_eff * hertz_stiffness(impact.E_eff, impact.R_eff));
  for (const auto end : {ZeroForce, ZeroOverlap})
    for (const double e : {0.99, 0.9, 0.5, 0.1, 0.02}) {
      const double zeta = damping_ratio(e, end);
      const auto is = damped_impact<QuarterPower>(impact, zeta * unit, end);
      CAPTURE(e);
      // Runge-Kutta at steps of 1/560 of the contact: far below 1e-9.
      CHECK(near_relative(is.restitution, e, 1e-8));
      CHECK(near_relative(is.overlap_ratio, hertz_overlap_ratio(zeta), 1e-8));
      CHECK(near_relative(dissipation_for<QuarterPower>(e, impact, end), zeta * unit, 1e-7));
    }
  CHECK(damped_impact<QuarterPower>(impact, 1.5 * unit, ZeroOverlap).restitution == 0);
}

TEST_CASE("damped_impact: Hunt and Crossley's closed form, whichever the end") {
  for (const double kappa : {0.01, 0.3, 1.0, 4.0, 20.0}) {
    const double alpha = kappa / impact.speed;
    for (const auto end : {ZeroForce, ZeroOverlap}) {
      const auto is = damped_impact<HuntCrossley>(impact, alpha, end);
      const double e = is.restitution;
      CAPTURE(kappa);
      CHECK(near_relative((1 + e) * kappa, std::log((1 + kappa) / (1 - kappa * e)), 1e-7));
      CHECK(near_relative(is.overlap_ratio,
                          std::pow(2 * (kappa - std::log1p(kappa)) / (kappa * kappa), 0.4), 1e-8));
    }
  }
}

TEST_CASE("damped_impact: Kuwabara and Kono's expansion for weak damping") {
  // e = 1 - C1 b + 3/5 C1^2 b^2 + O(b^(5/2)), b = 3/2 A (k_H/m*)^(2/5) v^(1/5), C1 = 1.15344
  // (T. Schwager, T. Poeschel, Phys. Rev. E 57 (1998) 650).
  for (const double b : {1e-3, 1e-2}) {
    const double kH = hertz_stiffness(impact.E_eff, impact.R_eff);
    const double A = b / (1.5 * std::pow(kH / impact.m_eff, 0.4) * std::pow(impact.speed, 0.2));
    for (const auto end : {ZeroForce, ZeroOverlap}) {
      const double e = damped_impact<KuwabaraKono>(impact, A, end).restitution;
      CAPTURE(b);
      CHECK(std::abs(e - (1 - 1.15344 * b + 0.79826 * b * b)) < 1e-5 * b + 0.5 * std::pow(b, 2.5));
    }
  }
}

TEST_CASE("damped_impact: largest overlaps of B2 for the same restitution, the attraction cut") {
  const struct {
    double e, kuwabara_kono, hunt_crossley, linear;
  } table[] = {{.9, .9593, .9593, .9575},
               {.7, .8711, .8725, .8606},
               {.5, .7675, .7756, .7446},
               {.3, .6338, .6589, .5977},  // B2 has .5978; it is 0.597745
               {.1, .4177, .4708, .3754}};
  for (const auto& row : table) {
    const auto ratio = [&]<class Damping>(Damping) {
      return damped_impact<Damping>(impact, dissipation_for<Damping>(row.e, impact)).overlap_ratio;
    };
    CAPTURE(row.e);
    CHECK(std::abs(ratio(KuwabaraKono{}) - row.kuwabara_kono) < 5.1e-5);  // four digits
    CHECK(std::abs(ratio(HuntCrossley{}) - row.hunt_crossley) < 5.1e-5);
    CHECK(std::abs(ratio(LinearDashpot{}) - row.linear) < 5.1e-5);
  }
}

TEST_CASE("damped_impact: values out of range are refused by name") {
  refuses([] { dissipation_for<KuwabaraKono>(1.2, impact); }, {"restitution = 1.2 [-]", "(0, 1]"});
  refuses([] { dissipation_for<KuwabaraKono>(0, impact); }, {"restitution = 0 [-]"});
  refuses([] { damped_impact<HuntCrossley>(impact, -1); }, {"dissipation = -1 [s/m]"});
  refuses([] { damped_impact<HuntCrossley>({1e6, 1e-3, 1e-5, 0}, 1); }, {"HertzImpact.speed = 0"});
  refuses(
      [] {
        damped_impact<HuntCrossley>({1e6, 1e-3, 1e-5, 1, 0.2}, 1);
      },
      {"HertzImpact.zeta = 0.2 [-] must be 0"});
  CHECK(dissipation_for<LinearDashpot>(1, impact) == 0);
}

TEST_CASE("hertz_damped: the law rebounds as damped_impact says") {
  law_rebounds_as_computed<KuwabaraKono>();
  law_rebounds_as_computed<HuntCrossley>();
  law_rebounds_as_computed<LinearDashpot>();
}

TEST_CASE("hertz_damped: batch, Coulomb's limit, parameters and refusals as any other law") {
  law_as_any_other<KuwabaraKono>(1e-5);
  law_as_any_other<HuntCrossley>(0.5);
  law_as_any_other<LinearDashpot>(1);
}

}  // namespace hertz_damped_test
