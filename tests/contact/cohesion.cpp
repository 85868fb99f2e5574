// silt - BSD-3-Clause, see LICENSE
#include <silt/contact/cohesion/area_cohesion.hpp>
#include <silt/contact/cohesion/capillary_bridge.hpp>
#include <silt/contact/cohesion/dmt.hpp>
#include <silt/contact/cohesion/van_der_waals.hpp>
#include <silt/contact/cohesion/viscous_bridge.hpp>
#include <silt/contact/contacts.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/jkr.hpp>
#include <silt/contact/linear_spring.hpp>

#include "contact/support.hpp"

namespace cohesion_test {

namespace {

using namespace contact_test;
using std::numbers::pi;
using Rabinovich = BasicCapillaryBridge<BridgeForce::Rabinovich>;
using Dusty = Cohesive<HertzMindlin, VanDerWaals>;
using Wet = Cohesive<HertzMindlin, CapillaryBridge>;
using WetSpring = Cohesive<LinearSpring, CapillaryBridge>;
using WetAndDusty = Cohesive<Wet, VanDerWaals>;
using StickyAndWet = Cohesive<Jkr, CapillaryBridge>;

static_assert(ActsAtDistance<Dusty> && ActsAtDistance<WetSpring> && ActsAtDistance<StickyAndWet>);
static_assert(!ActsAtDistance<HertzMindlin> && !ActsAtDistance<Cohesive<HertzMindlin, Dmt>>);
static_assert(is_frictional<Wet> && !is_frictional<WetSpring>);
// Reals kept a contact: what the body keeps, and one for what forms at touch.
static_assert(Contacts<Dusty>::history == 3 && Contacts<Wet>::history == 4);
static_assert(Contacts<Cohesive<LinearSpring, VanDerWaals>>::history == 0);
static_assert(Contacts<WetSpring>::history == 1 && Contacts<StickyAndWet>::history == 5);
static_assert(Contacts<Cohesive<HertzMindlin, Dmt>>::history == 3 && Contacts<Jkr>::history == 4);

const HertzMindlin::Material glass{1e8, 0.25, 0.6, 0.4};
const VanDerWaals::Pair quartz{.hamaker = 6.5e-20, .closest = 1e-9, .cutoff = 1e-6};
const CapillaryBridge::Pair water{
    .surface_tension = 0.072, .contact_angle = 20 * pi / 180, .volume = 1e-12};

/// Two spheres of radius 1 mm at a gap, at rest.
Contact<double> apart(double gap) {
  auto c = contact_at_rest();
  c.overlap = -gap, c.R_eff = 0.5e-3;
  return c;
}
template <class Cohesion, class Pair>
double attraction(const Pair& pair, double gap) {
  return Cohesion::attraction(
      apart(gap), Cohesion::mix({pair.surface_tension, pair.contact_angle, pair.volume}));
}
double attraction(const VanDerWaals::Pair& pair, double gap) {
  return VanDerWaals::attraction(apart(gap), VanDerWaals::mix(pair));
}
template <class Law>
auto mixed(const typename Law::Material& m) {
  return Law::mix(m, m, Law::like(m));
}

}  // namespace

TEST_CASE("van_der_waals: A R*/(6 h^2) less its value at the cutoff, flat below the closest gap") {
  for (const double h : {1e-9, 3e-9, 1e-7, 0.99e-6})
    CHECK(near_relative(attraction(quartz, h), 6.5e-20 * 0.5e-3 / 6 * (1 / (h * h) - 1e12), 1e-13));
  CHECK(attraction(quartz, 1e-6) == 0);
  CHECK(attraction(quartz, 2e-6) == 0);
  CHECK(attraction(quartz, 0.5e-9) == attraction(quartz, 1e-9));
  CHECK(attraction(quartz, -1e-5) == attraction(quartz, 1e-9));
  CHECK(VanDerWaals::range(VanDerWaals::mix(quartz), 1.0) == 1e-6);
}

TEST_CASE("van_der_waals: the force is the slope of its energy, and Hamaker's sum at small gaps") {
  const auto energy = [](double h) { return -6.5e-20 * 0.5e-3 / 6 * (1 / h + h * 1e12); };
  for (const double h : {2e-9, 1e-8, 3e-7}) {
    const double slope = (energy(h * 1.001) - energy(h * 0.999)) / (0.002 * h);
    CHECK(near_relative(attraction(quartz, h), slope, 3e-6));  // differences of second order
  }
  const VanDerWaals::Pair far{6.5e-20, 1e-9, 1};
  const double R = 1e-3;
  for (const auto& row : {std::pair{1e-3, 1.002}, {0.01, 1.02}, {0.1, 1.22}}) {
    const double share = row.first, ratio = row.second;
    const double h = share * R, near = h * h + 4 * R * h;
    const double full = 6.5e-20 / 6 * 64 * std::pow(R, 6) * (h + 2 * R) /
                        (near * near * std::pow(near + 4 * R * R, 2));
    CAPTURE(share);
    CHECK(std::abs(attraction(far, h) / full - ratio) < 6e-3);  // as printed
  }
}

TEST_CASE("capillary_bridge: numbers of B9, and both forms written as in their sources") {
  // B9: R 1 mm, g 0.072 N/m, th 20 deg, V/R^3 1e-3. Three digits; Rabinovich's two terms.
  CHECK(std::abs(attraction<CapillaryBridge>(water, 1e-5) - 2.69e-4) < 0.5e-6);
  // H/R = 0.0352 has three digits itself, 0.2 % of the force.
  CHECK(std::abs(attraction<CapillaryBridge>(water, 3.52e-5) - 8.06e-5) < 1.6e-7);
  CHECK(std::abs(attraction<Rabinovich>(water, 1e-5) - (2.68e-4 + 0.27e-4)) < 1e-6);
  const double R = 1e-3, th = water.contact_angle, g = 0.072, V = 1e-12;
  for (const double H : {1e-6, 1e-5, 3.52e-5, 1.1e-4}) {
    const double root = std::sqrt(1 + 2 * V / (pi * R * H * H)) - 1;
    const double d_sp = H / 2 * root, a = std::sqrt(H / R * root);
    const double source =
        2 * pi * R * g * (std::cos(th) / (1 + H / (2 * d_sp)) + std::sin(a) * std::sin(th + a));
    CHECK(near_relative(attraction<Rabinovich>(water, H), source, 1e-12));
    const double X = H * std::sqrt(R / V);
    CHECK(near_relative(attraction<CapillaryBridge>(water, H),
                        2 * pi * R * g * std::cos(th) / (1 + 1.05 * X + 2.5 * X * X), 1e-13));
    if (H == 3.52e-5)  // B9, the first term alone
      CHECK(std::abs(2 * pi * R * g * std::cos(th) / (1 + H / (2 * d_sp)) - 7.95e-5) < 1.6e-7);
  }
  // In contact 2 pi R g cos th; both partners count, a wall as a sphere of no curvature.
  CHECK(near_relative(attraction<CapillaryBridge>(water, 0), 2 * pi * R * g * std::cos(th), 1e-14));
  auto wall = apart(0);
  wall.R_eff = R;
  CHECK(near_relative(CapillaryBridge::attraction(wall, CapillaryBridge::mix(water)),
                      4 * pi * R * g * std::cos(th), 1e-14));
  CHECK(near_relative(CapillaryBridge::range(CapillaryBridge::mix(water), 1.0), (1 + th / 2) * 1e-4,
                      1e-14));
  CHECK(attraction<CapillaryBridge>(CapillaryBridge::Pair{0.072, 0, 0}, 0) == 0);
  CHECK(attraction<Rabinovich>(CapillaryBridge::Pair{0.072, 0, 0}, 0) == 0);
}

TEST_CASE("capillary_bridge: Rabinovich's first term is the slope of its energy") {
  // th = 0 and V -> 0 leave it alone: -2 pi R g (S - H) is the energy.
  const double R = 1e-3, g = 0.072, V = 1e-15;
  const auto energy = [&](double H) {
    return -2 * pi * R * g * (std::sqrt(H * H + 2 * V / (pi * R)) - H);
  };
  for (const double H : {1e-7, 5e-7, 2e-6}) {
    const double slope = (energy(H * 1.001) - energy(H * 0.999)) / (0.002 * H);
    // sin^2 a of the second term is 1e-3 at most here.
    CHECK(near_relative(attraction<Rabinovich>(CapillaryBridge::Pair{g, 0, V}, H), slope, 5e-3));
  }
}

TEST_CASE("viscous_bridge: resistance by hand, beside the capillary force, by the gap") {
  // 6 pi 0.01 (0.5e-3)^2/1e-5 0.2 = 9.4248e-4 N; 6 pi 0.01 0.5e-3 (8/15 ln 50 + 0.9588) 0.3
  // = 8.6104e-5 N.
  const ViscousBridge::Pair syrup{.surface_tension = 0.072,
                                  .contact_angle = 20 * pi / 180,
                                  .volume = 1e-12,
                                  .viscosity = 0.01,
                                  .roughness = 1e-6};
  const auto p = ViscousBridge::mix(syrup);
  auto c = apart(1e-5);
  const double still = ViscousBridge::attraction(c, p);
  CHECK(near_relative(still, attraction<CapillaryBridge>(water, 1e-5), 1e-14));
  c.normal_velocity = 0.2, c.tangential_velocity = {0, 0.3, 0};
  CHECK(near_relative(ViscousBridge::attraction(c, p) - still, 9.4248e-4, 1e-4));
  CHECK(near_relative(ViscousBridge::resistance(c, p).y, -8.6104e-5, 1e-4));
  // Against the motion in both directions; constant below the roughness and in contact.
  c.normal_velocity = -0.2;
  CHECK(near_relative(still - ViscousBridge::attraction(c, p), 9.4248e-4, 1e-4));
  for (const double gap : {1e-6, 1e-8, -1e-6}) {
    auto close = apart(gap);
    const double at_rest = ViscousBridge::attraction(close, p);
    close.normal_velocity = 0.2;
    CHECK(near_relative(ViscousBridge::attraction(close, p) - at_rest, 9.4248e-3, 1e-4));
  }
  // Not before the bridge has formed, nor after it has ruptured.
  using Syrup = Cohesive<HertzMindlin, ViscousBridge>;
  const auto law = mixed<Syrup>({glass, syrup});
  for (const double attached : {0.0, 1.0})
    for (const double gap : {1e-5, 2e-4}) {
      auto far = apart(gap);
      far.normal_velocity = 0.2, far.tangential_velocity = {0, 0.3, 0};
      Syrup::History<double> h{};
      h.attached = attached;
      const auto f = Syrup::force(far, law, h);
      CHECK((f.tangential.y != 0) == (attached == 1 && gap == 1e-5));
      CHECK((f.normal != 0) == (attached == 1 && gap == 1e-5));
    }
  // The step resolves the relaxation at the roughness, 1e-7 1e-6/(6 pi 0.01 (0.5e-3)^2) s.
  CHECK(near_relative(Syrup::contact_time(law, 0.5e-3, 1e-7, 1e-3), 2.5 * 2.12207e-6, 1e-4));
}

TEST_CASE("dmt: pull-off 2 pi w R*, 4/3 of that of JKR") {
  using Law = Cohesive<HertzMindlin, Dmt>;
  const auto p = mixed<Law>({glass, {0.05}});
  auto c = apart(-1e-12);
  Law::History<double> h{};
  const AdhesivePair pair{p.body.twice_modulus / 2, c.R_eff, 0.05};
  // Hertz' force of a picometre is 1e-7 of it.
  CHECK(near_relative(-Law::force(c, p, h).normal, dmt_pull_off(pair), 1e-6));
  CHECK(near_relative(dmt_pull_off(pair), 2 * pi * 0.05 * 0.5e-3, 1e-15));
}

TEST_CASE("area_cohesion: k times the area of contact, as LIGGGHTS' sjkr and sjkr2") {
  const auto p = AreaCohesion::mix({.energy_density = 1e5});
  // Areas [m2] that the program itself has at an overlap of 20 um, from its forces with and without
  // cohesion: two spheres of 1 mm, of 1 and 2 mm, and one of 1 mm at a wall.
  struct Row {
    double R_eff, sjkr, sjkr2;
    double smaller;  // [-] share by which the circle is smaller than to first order
  };
  const double d = 20e-6;
  for (const Row& row : {Row{0.5e-3, 6.25175e-8, 1.256633e-7, d / 4e-3},
                         Row{2e-3 / 3, 8.33558e-8, 1.675512e-7, 0.005},
                         Row{1e-3, 1.244067e-7, 1.256634e-7, d / 2e-3}}) {
    auto c = apart(-d);
    c.R_eff = row.R_eff;
    const double pull = AreaCohesion::attraction(c, p);
    CHECK(near_relative(pull, 2 * pi * 1e5 * row.R_eff * d, 1e-14));
    CHECK(near_relative(pull * (1 - row.smaller), 1e5 * row.sjkr, 3e-5));  // second order in d/R
    if (row.R_eff < 1e-3) CHECK(near_relative(2 * pull, 1e5 * row.sjkr2, 1e-5));
    if (row.R_eff == 1e-3) CHECK(near_relative(pull, 1e5 * row.sjkr2, 1e-5));
  }
  refuses([] { AreaCohesion::check({-1}); }, {"AreaCohesion.energy_density = -1 [J/m3]"});
}

TEST_CASE("cohesive: the body acts where it touches, and friction sees its force alone") {
  const auto p = mixed<Dusty>({glass, quartz});
  const auto body = mixed<HertzMindlin>(glass);
  Random random(2);
  for (int k = 0; k < 2000; ++k) {
    auto c = random_contact(random);
    if (k % 2 == 1) c.overlap = random.uniform(-2e-6, 0);
    Dusty::History<double> h{{across(random_vector(random, 0.1), c.normal)}, {}};
    HertzMindlin::History<double> alone{h.tangential};
    const auto f = Dusty::force(c, p, h);
    const double pull = -c.overlap < 1e-6 ? VanDerWaals::attraction(c, p.cohesion) : 0;
    if (c.overlap > 0) {
      const auto g = HertzMindlin::force(c, body, alone);
      CHECK(near_relative(f.normal, g.normal - pull, 1e-14));
      // The same expressions, which a compiler may round otherwise in another place.
      CHECK(norm(f.tangential - g.tangential) <= 1e-14 * norm(g.tangential));
      CHECK(norm(h.tangential - alone.tangential) <= 1e-14 * norm(alone.tangential));
      CHECK(near_relative(Dusty::pressing(c, p, f.normal), g.normal, 1e-9));  // after a subtraction
      CHECK(Dusty::stiffness(c, p) == HertzMindlin::stiffness(c, body));
    } else {
      CHECK(f.normal == -pull);
      CHECK(norm(f.tangential) == 0);
      CHECK(norm(h.tangential) == 0);
      CHECK(Dusty::pressing(c, p, f.normal) == 0);
    }
  }
}

TEST_CASE("cohesive: a bridge forms at touch and breaks at its range") {
  const auto p = mixed<Wet>({glass, water});
  const double rupture = CapillaryBridge::range(p.cohesion, 1.0);
  Wet::History<double> h{};
  CHECK(Wet::force(apart(1e-6), p, h).normal == 0);  // none yet
  CHECK(Wet::force(apart(-1e-6), p, h).normal != 0);
  CHECK(h.attached == 1);
  for (const double gap : {1e-6, 0.5 * rupture, 0.999 * rupture})
    CHECK(near_relative(-Wet::force(apart(gap), p, h).normal,
                        attraction<CapillaryBridge>(water, gap), 1e-14));
  CHECK(Wet::force(apart(1.001 * rupture), p, h).normal == 0);
  CHECK(h.attached == 0);
  CHECK(Wet::force(apart(0.5 * rupture), p, h).normal == 0);
}

TEST_CASE("cohesive: several attractions add up, each within its own range") {
  const auto p = mixed<WetAndDusty>({{glass, water}, quartz});
  WetAndDusty::History<double> h{};
  h.attached = 1;
  CHECK(WetAndDusty::range(p, 1e-3) == CapillaryBridge::range(p.body.cohesion, 1.0));
  for (const double gap : {1e-7, 5e-5})
    CHECK(near_relative(
        -WetAndDusty::force(apart(gap), p, h).normal,
        attraction<CapillaryBridge>(water, gap) + (gap < 1e-6 ? attraction(quartz, gap) : 0),
        1e-14));
  const Jkr::Material sticky{1e7, 0.25, 0.1, 1, 0.4};
  const auto q = mixed<StickyAndWet>({sticky, water});
  StickyAndWet::History<double> both{};
  both.attached = 1, both.contact_radius = 1e-5;
  Jkr::History<double> alone{{0, 0, 0}, 1e-5};
  const double gap = 0.5 * Jkr::range(q.body, 0.5e-3);
  CHECK(near_relative(
      StickyAndWet::force(apart(gap), q, both).normal,
      Jkr::force(apart(gap), q.body, alone).normal - attraction<CapillaryBridge>(water, gap),
      1e-14));
  // Beyond its own range the body lets go, while the bridge still holds.
  StickyAndWet::force(apart(3 * gap), q, both);
  CHECK(both.contact_radius == 0);
  CHECK(both.attached == 1);
}

TEST_CASE("cohesive: a batch equals doubles") {
  // Spring and attraction may cancel: 1e-11.
  CHECK(largest_lane_difference<Dusty>(mixed<Dusty>({glass, quartz}), 0.1, 2e-6) < 1e-11);
  CHECK(largest_lane_difference<Wet>(mixed<Wet>({glass, water}), 0.1, 2e-4) < 1e-11);
  using WetR = Cohesive<LinearSpring, Rabinovich>;
  CHECK(largest_lane_difference<WetR>(
            mixed<WetR>({{1e4, 0.6}, {0.072, water.contact_angle, 1e-12}}), 1, 2e-4) < 1e-11);
  CHECK(largest_lane_difference<WetAndDusty>(mixed<WetAndDusty>({{glass, water}, quartz}), 0.1,
                                             2e-4) < 1e-11);
}

TEST_CASE("cohesive: a time step resolves the approach to the closest distance") {
  const auto p = mixed<Dusty>({glass, quartz});
  const double body = HertzMindlin::contact_time(p.body, 1e-3, 1e-6, 0.1);
  CHECK(Dusty::contact_time(p, 1e-3, 1e-6, 0.1) == 2e-9 / 0.1);
  CHECK(body > 2e-9 / 0.1);
  const auto far = mixed<Dusty>({glass, {6.5e-20, 1e-4, 1e-3}});
  CHECK(Dusty::contact_time(far, 1e-3, 1e-6, 0.1) == body);
  CHECK(Wet::contact_time(mixed<Wet>({glass, water}), 1e-3, 1e-6, 0.1) == body);
}

TEST_CASE("cohesion: refuses values out of range and names them") {
  refuses([] { VanDerWaals::check({-1, 1e-9, 1e-6}); }, {"VanDerWaals.hamaker = -1 [J]"});
  refuses([] { VanDerWaals::check({1e-19, 0, 1e-6}); }, {"VanDerWaals.closest = 0 [m]"});
  for (const double bad : {1e-9, 1e-10, std::nan(""), HUGE_VAL})
    refuses(
        [&] {
          VanDerWaals::check({1e-19, 1e-9, bad});
        },
        {"VanDerWaals.cutoff", "greater than closest"});
  refuses(
      [] {
        CapillaryBridge::check({-1, 0, 0});
      },
      {"CapillaryBridge.surface_tension = -1 [N/m]"});
  for (const double bad : {-0.1, 1.6, std::nan("")})
    refuses(
        [&] {
          CapillaryBridge::check({1, bad, 0});
        },
        {"CapillaryBridge.contact_angle", "[0, pi/2)"});
  refuses([] { CapillaryBridge::check({1, 0, -1}); }, {"CapillaryBridge.volume = -1 [m3]"});
  refuses(
      [] {
        ViscousBridge::check({0, 0, 1e-12, -1, 1e-6});
      },
      {"ViscousBridge.viscosity = -1 [Pa s]"});
  for (const double bad : {0.0, 1e-3})
    refuses(
        [&] {
          ViscousBridge::check({0, 0, 1e-12, 1, bad});
        },
        {"ViscousBridge.roughness", "greater than 0 and less than", "1e-04 m"});
  ViscousBridge::check({});
  refuses([] { ViscousBridge::check({0, 2, 1e-12, 1, 1e-6}); }, {"ViscousBridge.contact_angle"});
  refuses([] { Dmt::check({-1}); }, {"Dmt.work_of_adhesion = -1 [J/m2]"});
  // Both parts of a cohesive law are looked at.
  refuses([] { Dusty::check(Dusty::Material{glass, {-1, 1e-9, 1e-6}}); }, {"VanDerWaals.hamaker"});
  refuses(
      [] {
        Dusty::check(Dusty::Material{{0, 0.25}, quartz});
      },
      {"HertzMindlin::Material.youngs_modulus"});
  refuses([] { Dusty::check(Dusty::Pair{{2, 0}, quartz}); }, {"restitution = 2"});
}

}  // namespace cohesion_test
