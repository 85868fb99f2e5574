// silt - BSD-3-Clause, see LICENSE
// A plane approaches an adhesive sphere and is withdrawn: the force over the overlap against
// Johnson, Kendall and Roberts, with their ratios 1, 5/9, 8/9.

#include <algorithm>
#include <cmath>
#include <vector>

#include <silt/contact/adhesion.hpp>
#include <silt/contact/jkr.hpp>
#include <silt/simulation.hpp>

#include "verification/gallery.hpp"

namespace verification {
namespace jkr_contact_cases {

constexpr double radius = 1e-3;  // [m]
constexpr silt::Jkr::Material sticky{
    .youngs_modulus = 1e7, .poisson_ratio = 0.25, .work_of_adhesion = 0.1};

silt::AdhesivePair pair_of() {
  return {silt::effective_modulus(sticky.youngs_modulus, sticky.poisson_ratio,
                                  sticky.youngs_modulus, sticky.poisson_ratio),
          radius, sticky.work_of_adhesion};
}

/// The larger contact radius [m] at an overlap (the stable branch), by bisection.
double contact_radius(double overlap) {
  const auto pair = pair_of();
  const double c = std::sqrt(2 * std::acos(-1.0) * pair.work_of_adhesion / pair.E_eff);
  double low = std::cbrt(radius * c / 4), high = 1;  // of sqrt(a)
  low *= low;
  for (int halving = 0; halving < 200; ++halving) {
    const double a = (low + high) / 2;
    (a * a / radius - c * std::sqrt(a) > overlap ? high : low) = a;
  }
  return (low + high) / 2;
}

struct Point {
  double overlap, force;  // [m], [N] > 0 pushes
};

/// The plane moves up at constant speed to `deepest`, and back to its start. The sphere is heavy
/// enough to stay in place.
std::vector<Point> approach_and_retreat(double deepest, double gap, int steps) {
  silt::Particles<silt::Sphere> one;
  one.add({.position = {0, 0, radius}, .radius = radius, .density = 1e16});
  silt::Simulation sim{std::move(one), silt::Contacts<silt::Jkr>{sticky}};
  const double time = 1, speed = (deepest + gap) / time;  // [s] each way, [m/s]
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, sticky, [=](double t) {
    const double way = t < time ? t : 2 * time - t;
    return silt::Pose{{}, {0, 0, speed * way - gap}};
  });
  sim.threads = 1;
  sim.time_step = time / steps;
  std::vector<Point> out;
  sim.run(2 * time, [&](const auto& s) {
    out.push_back({s.wall(0).pose.translation.z + radius - s.position(0).z, -s.wall(0).force.z});
  });
  return out;
}

struct Course {
  std::vector<Point> points;
  double stride;    // [m] of the plane in a step
  double pull_off;  // [N] by the closed form
};

/// The whole curve against the closed form.
void compare_law(Gallery& gallery, const Course& course) {
  const auto pair = pair_of();
  const double at_rest = silt::jkr_overlap_at_rest(pair);
  const double parting = silt::jkr_overlap_at_parting(pair);
  auto table =
      gallery.table("jkr", {"overlap over that at rest [-]", "force over pull-off [-]", "JKR [-]"});
  Worst law;
  bool attached = false;
  for (std::size_t k = 0; k < course.points.size(); ++k) {
    const auto& p = course.points[k];
    attached = p.overlap > 0 || (attached && p.overlap > parting);
    const double exact = attached ? silt::jkr_force(pair, contact_radius(p.overlap)) : 0;
    const double found = p.force / course.pull_off;
    // The end of a step may be on either side of attachment and separation.
    const double to_edge = std::min(std::abs(p.overlap), std::abs(p.overlap - parting));
    if (to_edge > 1e-6 * course.stride) law.compare(found, exact / course.pull_off, 1e-8);
    if (k % 200 == 0) table.add_row({p.overlap / at_rest, found, exact / course.pull_off});
  }
  gallery.check("jkr_force_over_overlap", law,
                "of the pull-off force; the overlap is the difference of positions 1e4 times as "
                "large");
}

/// Largest tensile force, force at separation and at attachment.
void compare_ratios(Gallery& gallery, const Course& course) {
  const auto pair = pair_of();
  const double parting = silt::jkr_overlap_at_parting(pair);
  double least = 0, last = 0, at_touch = 0;  // [-] of the pull-off force
  for (const auto& p : course.points) {
    if (p.force == 0) continue;
    if (at_touch == 0) at_touch = p.force / course.pull_off;
    last = p.force / course.pull_off;
    least = std::min(least, last);
  }
  const auto change = [&](double from, double to) {
    return std::abs(silt::jkr_force(pair, contact_radius(from)) -
                    silt::jkr_force(pair, contact_radius(to))) /
           course.pull_off;
  };
  Worst ratios;
  ratios.compare(least, -1, change(parting / 3, parting / 3 + course.stride));
  ratios.compare(last, -5.0 / 9, change(parting + course.stride, parting));
  ratios.compare(at_touch, -8.0 / 9, change(0, course.stride));
  gallery.check("jkr_ratios_1_5_9_8_9", ratios,
                "what the force changes by in one step of the plane: its slope at touch, and near "
                "parting a square root");
  gallery.summary.result("jkr_pull_off_over_closed_form", -least);
  gallery.summary.result("jkr_force_at_parting_over_pull_off", last);
  gallery.summary.result("jkr_force_at_touch_over_pull_off", at_touch);
}

}  // namespace jkr_contact_cases

void jkr_contact(Gallery& gallery) {
  using namespace jkr_contact_cases;
  const auto pair = pair_of();
  const double deepest = 3 * silt::jkr_overlap_at_rest(pair);
  const double gap = -1.5 * silt::jkr_overlap_at_parting(pair);
  const int steps = 20000;
  const Course course{approach_and_retreat(deepest, gap, steps), (deepest + gap) / steps,
                      silt::jkr_pull_off(pair)};
  compare_law(gallery, course);
  compare_ratios(gallery, course);
}

}  // namespace verification
