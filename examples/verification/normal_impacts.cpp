// silt - BSD-3-Clause, see LICENSE
// Head-on impacts: Chung and Ooi's tests 1, 2 and 3, the restitution over the time step, unequal
// spheres, softened moduli. References are closed forms.

#include <string>

#include <silt/contact/softened.hpp>

#include "verification/gallery.hpp"
#include "verification/strike.hpp"

namespace verification {
namespace normal_impacts_cases {

using silt::DampingEnd;
using silt::HertzMindlin;
using Attracting = silt::BasicHertzMindlin<DampingEnd::ZeroOverlap>;

// Chung and Ooi 2011; each value read in Yade's and Kratos' own set-ups of these tests.
constexpr Solid glass{4.8e10, 0.20, 2800}, limestone{2.0e10, 0.25, 2500};
constexpr Solid aluminium_alloy{7.0e10, 0.30, 2699}, magnesium_alloy{4.0e10, 0.35, 1800};
constexpr Solid aluminium_oxide{3.8e11, 0.23, 4000}, cast_iron{1.0e11, 0.25, 7000};

const char* const step_reason =
    "first touch lies within a step: 2 pi zeta/n of the damping and 1.9/n^2 of leapfrog";

/// Force [N] in an undamped impact after `time` [s], by the classical Runge-Kutta method.
class HertzHistory {
 public:
  explicit HertzHistory(const Impact& impact)
      : k_(silt::hertz_stiffness(impact.E_eff(), impact.R_eff())),
        m_(impact.m_eff()),
        dt_(impact.contact_time() / 4000) {
    State s{0, impact.normal_speed()};
    for (; s.d >= 0; s = stepped(s)) force_.push_back(force(s.d));
    force_.insert(force_.end(), 2, 0);
  }
  double operator()(double time) const {
    const double at = std::max(time / dt_, 0.0);
    const auto k = static_cast<std::size_t>(at);
    if (k + 1 >= force_.size()) return 0;
    return force_[k] + (at - static_cast<double>(k)) * (force_[k + 1] - force_[k]);
  }
  double force(double overlap) const { return k_ * std::pow(std::max(overlap, 0.0), 1.5); }

 private:
  struct State {
    double d, v;
  };
  State rate(State s) const { return {s.v, -force(s.d) / m_}; }
  State stepped(State s) const {
    const auto at = [&](State k, double h) { return State{s.d + h * k.d, s.v + h * k.v}; };
    const State a = rate(s), b = rate(at(a, dt_ / 2)), c = rate(at(b, dt_ / 2)),
                d = rate(at(c, dt_));
    return {s.d + dt_ / 6 * (a.d + 2 * b.d + 2 * c.d + d.d),
            s.v + dt_ / 6 * (a.v + 2 * b.v + 2 * c.v + d.v)};
  }
  double k_, m_, dt_;
  std::vector<double> force_;
};

void elastic_impact(Gallery& gallery, const std::string& name, const Impact& impact) {
  const auto found = strike<HertzMindlin>(impact);
  const HertzHistory exact(impact);
  const auto closed = impact.hertz(DampingEnd::ZeroForce);
  const double peak = silt::hertz_max_force(closed), n = impact.steps;
  auto table = gallery.table(
      name, {"time [us]", "overlap [um]", "force [kN]", "force by Hertz at this time [kN]",
             "force by Hertz at this overlap [kN]"});
  Worst course;
  for (std::size_t k = 0; k < found.history.size(); ++k) {
    const auto& m = found.history[k];
    course.compare(m.force / peak, exact(m.time) / peak, 4 / (n * n));
    if (k % 10 == 0)
      table.add_row({1e6 * m.time, 1e6 * m.overlap, 1e-3 * m.force, 1e-3 * exact(m.time),
                     1e-3 * exact.force(m.overlap)});
  }
  gallery.check(
      name + "_force_over_time", course,
      "share of the largest force; leapfrog: 1.9/n^2 of the peak, and (w0 dt)^2/24 of the "
      "time, which is 2/n^2 of the force where the curve is steepest");
  Worst peaks;
  peaks.compare_relative(found.largest_force, peak, step_error(0, n));
  peaks.compare_relative(found.largest_overlap, silt::hertz_max_overlap(closed), step_error(0, n));
  peaks.compare_relative(impact.ball.velocity.z, -found.velocity.z, step_error(0, n));
  gallery.check(name + "_peaks_and_rebound", peaks, step_reason);
  gallery.summary.result(name + "_largest_force_n", found.largest_force);
  gallery.summary.result(name + "_largest_force_by_hertz_n", peak);
}

Impact on_plane(const Solid& solid, double radius, double speed) {
  Impact impact{.ball = {.solid = solid, .radius = radius, .velocity = {0, 0, -speed}}};
  impact.plane = rigid(solid);
  return impact;
}

template <class Law>
void restitutions(Gallery& gallery, const std::string& law, DampingEnd end) {
  auto table = gallery.table("chung_ooi_3_" + law,
                             {"restitution given [-]", "aluminium oxide [-]", "cast iron [-]"});
  Worst worst;
  for (int k = 1; k <= 10; ++k) {
    const double e = 0.1 * k;
    double seen[2];
    for (int s = 0; s < 2; ++s) {
      auto impact = on_plane(s == 0 ? aluminium_oxide : cast_iron, 2.5e-3, 3.9);
      impact.restitution = e;
      seen[s] = strike<Law>(impact).velocity.z / 3.9;
      worst.compare_relative(seen[s], e, step_error(silt::damping_ratio(e, end), impact.steps));
    }
    table.add_row({e, seen[0], seen[1]});
  }
  gallery.check("chung_ooi_3_restitution_" + law, worst, step_reason);
}

}  // namespace normal_impacts_cases

void normal_impacts_of_chung_and_ooi(Gallery& gallery) {
  using namespace normal_impacts_cases;
  for (const auto& [solid, name] : {std::pair{glass, "glass"}, std::pair{limestone, "limestone"}}) {
    const Ball ball{.solid = solid, .radius = 0.010, .velocity = {0, 0, -10}};
    Ball other = ball;
    other.velocity.z = 10;
    elastic_impact(gallery, std::string("chung_ooi_1_") + name, {.ball = ball, .other = other});
  }
  for (const auto& [solid, name] : {std::pair{aluminium_alloy, "aluminium_alloy"},
                                    std::pair{magnesium_alloy, "magnesium_alloy"}})
    elastic_impact(gallery, std::string("chung_ooi_2_") + name, on_plane(solid, 0.1, 0.2));
  restitutions<HertzMindlin>(gallery, "cut_at_zero_force", DampingEnd::ZeroForce);
  restitutions<Attracting>(gallery, "to_zero_overlap", DampingEnd::ZeroOverlap);
}

namespace normal_impacts_cases {

/// V1 for one law: prescribed against measured values, over the steps per contact.
template <class Law>
void steps_a_contact(Gallery& gallery, const std::string& law, DampingEnd end) {
  using namespace normal_impacts_cases;
  auto table = gallery.table(
      "restitution_" + law,
      {"steps a contact [-]", "restitution [-]", "error of restitution [-]", "error of overlap [-]",
       "error of force [-]", "error of duration [-]", "bound [-]"});
  Worst errors, durations;
  for (const double e : {1.0, 0.9, 0.5, 0.1})
    for (const double n : {10.0, 20.0, 50.0, 100.0, 200.0}) {
      const double zeta = silt::damping_ratio(e, end), bound = step_error(zeta, n);
      double worst[4] = {0, 0, 0, 0};
      const int phases = gallery.quick ? 4 : 16;
      for (int k = 0; k < phases; ++k) {  // where within a step first touch lies
        auto impact = on_plane(aluminium_oxide, 2.5e-3, 3.9);
        impact.restitution = e, impact.steps = n, impact.first_gap = 2 + (k + 0.5) / phases;
        const auto closed = impact.hertz(end);
        const auto found = strike<Law>(impact);
        const double lasts = silt::hertz_contact_time(closed, end);
        const double error[4] = {found.velocity.z / 3.9 / e - 1,
                                 found.largest_overlap / silt::hertz_max_overlap(closed) - 1,
                                 found.largest_force / silt::hertz_max_force(closed) - 1,
                                 (found.duration - lasts) / lasts};
        for (int q = 0; q < 3; ++q) errors.compare(error[q], 0, bound);
        // Counted in whole steps from velocities that are means of half steps: 4.5 steps.
        durations.compare(found.duration / lasts, 1, 4.5 * impact.contact_time() / n / lasts);
        for (int q = 0; q < 4; ++q)
          if (std::abs(error[q]) > std::abs(worst[q])) worst[q] = error[q];
      }
      table.add_row({n, e, worst[0], worst[1], worst[2], worst[3], bound});
    }
  gallery.check("restitution_overlap_force_" + law, errors, step_reason);
  gallery.check("duration_" + law, durations, "counted in whole steps: 4.5 of them");
}

}  // namespace normal_impacts_cases

void restitution_and_steps(Gallery& gallery) {
  using namespace normal_impacts_cases;
  steps_a_contact<HertzMindlin>(gallery, "cut_at_zero_force", DampingEnd::ZeroForce);
  steps_a_contact<Attracting>(gallery, "to_zero_overlap", DampingEnd::ZeroOverlap);
}

void size_ratios(Gallery& gallery) {
  using namespace normal_impacts_cases;
  auto table = gallery.table(
      "size_ratio", {"size ratio [-]", "restitution given [-]", "restitution [-]", "error [-]"});
  Worst worst;
  for (const double e : {0.8, 0.5})
    for (const double ratio : {1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0}) {
      Impact impact{.ball = {.solid = {1e8, 0.25, 2500}, .radius = 1e-3, .velocity = {0, 0, -1}}};
      impact.other = Ball{.solid = impact.ball.solid, .radius = ratio * 1e-3};
      impact.restitution = e, impact.steps = 1000;
      const auto found = strike<HertzMindlin>(impact);
      const double seen = found.velocity.z - found.other_velocity.z;
      worst.compare_relative(seen, e, 0.001);
      table.add_row({ratio, e, seen, seen / e - 1});
    }
  gallery.check("size_ratio_1_to_100_restitution", worst,
                "0.1 % is asked for; at 1000 steps a contact the d^(1/4) of the Hertz dashpot "
                "leaves less than half of 2 pi zeta/n = 0.16 %");
}

namespace normal_impacts_cases {

using Soft = silt::Softened<HertzMindlin>;
constexpr double wanted = 2e-3, given_restitution = 0.5;  // [m] radius of full stiffness, [-]

/// Two equal spheres of a radius [m] that meet at 1 m/s, softened for the time step of `wanted`.
Impact softened_pair(double radius) {
  using namespace normal_impacts_cases;
  Impact impact{.ball = {.solid = {1e8, 0.25, 2500}, .radius = radius, .velocity = {0, 0, -1}}};
  impact.other = Ball{.solid = impact.ball.solid, .radius = radius};
  impact.restitution = given_restitution, impact.full_radius = wanted;
  impact.softness = silt::softening_factor(radius, wanted, silt::Softening::ContactTime);
  return impact;
}

}  // namespace normal_impacts_cases

void softened_moduli(Gallery& gallery) {
  using namespace normal_impacts_cases;
  auto table = gallery.table(
      "softening", {"radius over wanted [-]", "factor on the modulus [-]",
                    "overlap over diameter by the closed form [-]", "overlap over diameter [-]",
                    "contact time over that wanted [-]", "safeguarded [-]"});
  Worst overlaps, times, rebounds, counts;
  const auto large = softened_pair(wanted);
  const double target = strike<Soft>(large).duration;
  const double share = silt::hertz_max_overlap(large.hertz(DampingEnd::ZeroForce)) / wanted / 2;
  for (const double s : {1.0, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0}) {
    const auto impact = softened_pair(wanted / s);
    const auto found = strike<Soft>(impact);
    const double overlap = found.largest_overlap / impact.ball.radius / 2, deepest = 0.15;
    const double bound = step_error(impact.hertz(DampingEnd::ZeroForce).zeta, impact.steps);
    const double way = impact.contact_time() / impact.steps / impact.ball.radius / 2;  // of a step
    const bool too_deep = s * share > deepest;
    rebounds.compare_relative(found.velocity.z - found.other_velocity.z, given_restitution, bound);
    counts.compare(found.safeguarded, too_deep ? 1 : 0, 0.5);
    if (too_deep)
      overlaps.compare(overlap, deepest + way / 2, way / 2);
    else
      overlaps.compare_relative(overlap, s * share, bound);
    if (!too_deep) times.compare_relative(found.duration, target, 9.0 / impact.steps);
    table.add_row(
        {1 / s, impact.softness, s * share, overlap, found.duration / target, found.safeguarded});
  }
  gallery.check("softening_overlap", overlaps,
                "2 pi zeta/n and 1.9/n^2; where the safeguard acts, the way of one step");
  gallery.check("softening_contact_time_is_that_wanted", times,
                "both counted in whole steps: 4.5 of them each");
  gallery.check("softening_restitution", rebounds, step_reason);
  gallery.check("softening_safeguard_counts", counts, "none to 15 % of the diameter, one beyond");
}

}  // namespace verification
