// silt - BSD-3-Clause, see LICENSE
#include <silt/contact/contacts.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/linear_spring.hpp>
#include <silt/contact/rolling/epsd.hpp>
#include <silt/contact/rolling/twisting.hpp>
#include <silt/simulation.hpp>

#include "contact/support.hpp"

namespace contacts_test {

namespace {

using namespace contact_test;

constexpr HertzMindlin::Material glass{5e7, 0.25, 0.8, 0.4}, steel{2e8, 0.3, 0.6, 0.2};

/// A user's own law: Kuwabara and Kono's Hertz contact with damping in proportion to the spring,
/// and friction that resists the sliding velocity.
struct OwnKuwabaraKono {
  struct Material {
    double modulus, damping_time, friction, drag;  // [Pa], [s], [-], [N s/m]
    bool operator==(const Material&) const = default;
  };
  template <class Real>
  struct Coefficients {
    Real modulus, damping_time, friction, drag;
  };
  static Coefficients<double> mix(const Material& a, const Material&) {
    return {a.modulus, a.damping_time, a.friction, a.drag};
  }
  template <class Real>
  static Traction<Real> force(const Contact<Real>& c, const Coefficients<Real>& p) {
    const Real spring = p.modulus * sqrt(c.R_eff * c.overlap);
    const Real Fn = max(spring * (c.overlap - p.damping_time * c.normal_velocity), Real(0));
    const Real speed = sqrt(dot(c.tangential_velocity, c.tangential_velocity) + Real(1e-30));
    return {Fn, -(min(p.drag, p.friction * Fn / speed) * c.tangential_velocity)};
  }
};

/// A user's own rolling model without check(), which is optional as in a law.
struct OwnRolling {
  static constexpr bool is_rolling_model = true;
  struct Pair {
    double slowness = 1e-10;  // [N m s]
  };
  template <class Real>
  struct Coefficients {
    Real slowness;
  };
  static Coefficients<double> mix(const Pair& p) { return {p.slowness}; }
  template <class Real>
  static Vec3<Real> torque(const RollingContact<Real>& c, const Coefficients<Real>& p) {
    return -p.slowness * c.angular_velocity;
  }
};

struct Motion {
  std::vector<Vec3d> positions, spins;
};
/// Ten spheres fall on each other in a box: some hundred steps with many contacts.
template <class Kernels>
Motion user_law_run(Kernels kernels) {
  const OwnKuwabaraKono::Material material{1e7, 2e-5, 0.5, 0.01};
  Particles<Sphere> spheres;
  Random random(2);
  for (int k = 0; k < 10; ++k)
    spheres.add({.position = {2e-3 * (k % 2) + 1e-4 * k + 2e-3, 2e-3 + 3e-5 * k, 1.9e-3 * k + 1e-3},
                 .radius = 1e-3 * (1 + 0.02 * k),
                 .density = 2500,
                 .velocity = random_vector(random, 0.2)});
  Simulation sim{std::move(spheres), Contacts<OwnKuwabaraKono>{material}, kernels};
  sim.add_wall(box({0, 0, 0}, {6e-3, 6e-3, 0.03}), material);
  sim.gravity = {0, 0, -9.81};
  sim.threads = 1;
  sim.time_step = 5e-6;  // the law has no contact_time, so it must be given
  sim.run(2e-3);
  CHECK(sim.peak_overlap() > 1e-3);
  Motion out;
  for (std::uint32_t id = 0; id < 10; ++id) {
    out.positions.push_back(sim.position(sim.find(id)));
    out.spins.push_back(sim.angular_velocity(sim.find(id)));
  }
  return out;
}

double turned(const Contact<double>& c, double degrees, int steps, Vec3d axis, Vec3d* vector) {
  const double angle = degrees * std::numbers::pi / 180 / steps;
  Contact<double> now = c;
  for (int k = 0; k < steps; ++k) {
    // The frame turns with `axis`, the normal with it.
    now.turn = angle * axis;
    const Vec3d n = now.normal;
    now.normal =
        n + std::sin(angle) * cross(axis, n) + (1 - std::cos(angle)) * cross(axis, cross(axis, n));
    *vector = now.transported(*vector);
  }
  return norm(now.normal - c.normal);
}

}  // namespace

TEST_CASE("contacts: a user's own law runs, and gives the same scalar and in lanes") {
  const auto scalar = user_law_run(KernelsFor<OneLane>{});
  const auto lanes = user_law_run(KernelsFor<DefaultArch>{});
  double spin = 0;
  for (const Vec3d& w : scalar.spins) spin = std::max(spin, norm(w));
  CHECK(spin > 1);
  for (std::size_t k = 0; k < 10; ++k) {
    // The same operations in the same order: what differs is round-off of sums of three products,
    // 1e-16, which grows in a chain of contacts by at most some hundred in 400 steps.
    CHECK(norm(scalar.positions[k] - lanes.positions[k]) < 1e-13 * norm(scalar.positions[k]));
    CHECK(norm(scalar.spins[k] - lanes.spins[k]) < 1e-11 * spin);
  }
  const OwnKuwabaraKono::Material m{1e7, 2e-5, 0.5, 0.01};
  CHECK(largest_lane_difference<OwnKuwabaraKono>(OwnKuwabaraKono::mix(m, m), 0) < 1e-13);
}

TEST_CASE("contacts: an axis costs nothing that its law does not use") {
  static_assert(!Contacts<LinearSpring>::rotates && Contacts<LinearSpring>::history == 0);
  static_assert(Contacts<OwnKuwabaraKono>::rotates && Contacts<OwnKuwabaraKono>::history == 0);
  static_assert(Contacts<HertzMindlin>::rotates && Contacts<HertzMindlin>::history == 3);
  static_assert(Contacts<HertzMindlin, RollingEpsd>::history == 6);
  static_assert(!Contacts<HertzMindlin>::several_materials);
  static_assert(Contacts<HertzMindlin, SeveralMaterials>::several_materials);
  CHECK(Contacts<HertzMindlin>{glass}.materials() == 1);
}

TEST_CASE("contacts: materials are told apart by their values") {
  Contacts<HertzMindlin, SeveralMaterials> contacts{{glass, steel}};
  CHECK(contacts.add(glass) == 0);
  CHECK(contacts.add(steel) == 1);
  auto other = glass;
  other.friction = 0.41;
  CHECK(contacts.add(other) == 2);
  CHECK(contacts.material(2) == other);
}

TEST_CASE(
    "contacts: pair values hold in either order, outlive new materials, and default to like "
    "pairs") {
  Contacts<HertzMindlin, SeveralMaterials> contacts{{glass, steel}};
  contacts.set_pair(steel, glass, {.restitution = 0.5, .friction = 0.33});
  auto other = glass;
  other.friction = 0.41;
  contacts.add(other);
  CHECK(contacts.coefficients(0, 1).friction == 0.33);
  CHECK(contacts.coefficients(1, 0).friction == 0.33);
  CHECK(contacts.coefficients(0, 1).normal_damping == contacts.coefficients(1, 0).normal_damping);
  CHECK(contacts.coefficients(0, 0).friction == 0.4);
  CHECK(contacts.coefficients(1, 1).friction == 0.2);
  contacts.set_pair(glass, glass, {.restitution = 0.5, .friction = 0.1});
  CHECK(contacts.coefficients(0, 0).friction == 0.1);
}

TEST_CASE("contacts: a user's rolling model needs no check(), alone and in Both") {
  Contacts<HertzMindlin, SeveralMaterials, OwnRolling> own{{glass, steel}, {.slowness = 2e-10}};
  own.set_rolling(glass, steel, {.slowness = 3e-10});
  CHECK(own.rolling_coefficients(0, 0).slowness == 2e-10);
  CHECK(own.rolling_coefficients(1, 0).slowness == 3e-10);
  using Pair = Contacts<HertzMindlin, Both<OwnRolling, RollingEpsd>>;
  CHECK(Pair(glass, {{.slowness = 2e-10}, {}}).rolling_coefficients(0, 0).first.slowness == 2e-10);
  refuses(
      [&] {
        Pair(glass, {{}, {.rolling_friction = -0.1}});
      },
      {"RollingEpsd.rolling_friction = -0.1"});
}

TEST_CASE("contacts: rolling resistance is that of the pair, or the general one") {
  Contacts<HertzMindlin, SeveralMaterials, RollingEpsd> contacts{{glass, steel},
                                                                 {.rolling_friction = 0.1}};
  contacts.set_rolling(glass, steel, {.rolling_friction = 0.3});
  CHECK(contacts.rolling_coefficients(0, 0).rolling_friction == 0.1);
  CHECK(contacts.rolling_coefficients(1, 0).rolling_friction == 0.3);
}

TEST_CASE("contacts: what is missing or out of range is refused by name") {
  const Contacts<HertzMindlin, SeveralMaterials> contacts{{glass, steel}};
  refuses([&] { contacts.coefficients(0, 1); }, {"materials 0 and 1", "set_pair"});
  auto bad = glass;
  bad.youngs_modulus = -1;
  refuses([&] { Contacts<HertzMindlin>{bad}; }, {"HertzMindlin::Material.youngs_modulus = -1"});
  Contacts<HertzMindlin, SeveralMaterials> open{{glass, steel}};
  refuses([&] { open.set_pair(glass, steel, {.restitution = 1.5, .friction = 0.1}); },
          {"restitution = 1.5"});
  refuses([&] { open.set_pair(glass, steel, {.restitution = 0.5, .friction = -1}); },
          {"friction = -1"});
  refuses(
      [&] {
        Contacts<HertzMindlin, SeveralMaterials>(std::initializer_list<HertzMindlin::Material>{});
      },
      {"list of materials is empty"});
  refuses([&] { Contacts<HertzMindlin, RollingEpsd>(glass, {.rolling_friction = -0.1}); },
          {"RollingEpsd.rolling_friction = -0.1"});
  using Several = Contacts<HertzMindlin, SeveralMaterials, RollingEpsd>;
  refuses(
      [&] {
        Several({glass, steel}, {.rolling_friction = -0.1});
      },
      {"RollingEpsd.rolling_friction = -0.1"});
  refuses([&] { Contacts<HertzMindlin, RollingEpsd>(glass, {.damping = std::nan("")}); },
          {"RollingEpsd.damping"});
}

TEST_CASE("contacts: pair and rolling values by number or name are for these two materials alone") {
  Contacts<HertzMindlin, SeveralMaterials, RollingEpsd> contacts{{glass, steel},
                                                                 {.rolling_friction = 0.1}};
  contacts.add(glass, "glass"), contacts.add(steel, "steel"), contacts.add(steel, "coated");
  contacts.set_pair("glass", "steel", {.restitution = 0.5, .friction = 0.33})
      .set_pair("coated", 0, {.restitution = 0.5, .friction = 0.44});
  contacts.set_rolling("steel", "glass", {.rolling_friction = 0.3}).set_rolling(2, 2, {});
  CHECK(contacts.coefficients(1, 0).friction == 0.33);
  CHECK(contacts.coefficients(0, 2).friction == 0.44);
  CHECK(contacts.rolling_coefficients(0, 1).rolling_friction == 0.3);
  CHECK(contacts.rolling_coefficients(2, 0).rolling_friction == 0.1);
  CHECK(contacts.rolling_coefficients(2, 2).rolling_friction == 0);
  refuses([&] { contacts.set_pair("glass", "wood", {.restitution = 0.5, .friction = 0.1}); },
          {"material 'wood' is not there"});
}

TEST_CASE("contacts: a refused value says of which material or pair it is") {
  using Several = Contacts<HertzMindlin, SeveralMaterials, RollingEpsd>;
  auto bad = steel;
  bad.restitution = 1.2;
  const auto starts = [](const auto& action, const std::string& words) {
    std::string sentence;
    try {
      action();
    } catch (const InputError& e) {
      sentence = e.what();
    }
    CAPTURE(sentence);
    CAPTURE(words);
    CHECK(sentence.rfind(words, 0) == 0);
  };
  // The only one, without a name, needs no words.
  starts([&] { Contacts<HertzMindlin>{bad}; }, "HertzMindlin restitution = 1.2 [-]");
  Contacts<HertzMindlin, RollingEpsd> one{glass};
  starts([&] { one.set_pair(glass, glass, {.restitution = 2, .friction = 0}); },
         "HertzMindlin restitution = 2 [-]");
  starts([&] { one.add(bad); }, "material 1: HertzMindlin restitution = 1.2 [-]");
  starts([&] { one.set_pair(glass, steel, {.restitution = 2, .friction = 0}); },
         "the pair of material 0 and a new material: HertzMindlin restitution = 2 [-]");
  CHECK(one.materials() == 1);

  starts([&] { Several{{glass, glass, bad}}; }, "material 1: HertzMindlin restitution = 1.2 [-]");
  starts([&] { Several{{bad, glass}}; }, "material 0: HertzMindlin restitution = 1.2 [-]");
  Several contacts{{glass, steel}};
  contacts.add(steel, "steel");
  starts([&] { contacts.add(bad, "ore"); }, "material 2 'ore': HertzMindlin restitution = 1.2");
  const std::string pair = "the pair of material 1 'steel' and material 0: ";
  starts([&] { contacts.set_pair(steel, glass, {.restitution = 2, .friction = 0}); },
         pair + "HertzMindlin restitution = 2 [-]");
  starts([&] { contacts.set_pair("steel", 0, {.restitution = 0.5, .friction = -1}); },
         pair + "HertzMindlin friction = -1 [-]");
  starts([&] { contacts.set_rolling(steel, glass, {.rolling_friction = -0.1}); },
         pair + "RollingEpsd.rolling_friction = -0.1");
  starts([&] { contacts.set_rolling("steel", 0, {.rolling_friction = -0.1}); },
         pair + "RollingEpsd.rolling_friction = -0.1");
}

TEST_CASE(
    "contacts: what a contact carries keeps its length and turns with it, over a whole turn") {
  // A rotation to second order: the length errs by turn^4/8 a step, the angle by turn^3/6.
  for (const int steps : {100, 1000}) {
    const double turn = 2 * std::numbers::pi / steps;
    const double length_error = steps * std::pow(turn, 4) / 8,
                 angle = steps * std::pow(turn, 3) / 6;
    Contact<double> c = contact_at_rest();
    for (const Vec3d& axis : {Vec3d{1, 0, 0}, Vec3d{0, 0, 1}, Vec3d{0.6, 0, 0.8}}) {
      Vec3d carried{0.3, 0.4, 0};
      CHECK(turned(c, 360, steps, axis, &carried) < 1e-12);
      CAPTURE(steps);
      CHECK(std::abs(norm(carried) / 0.5 - 1) < 1.01 * length_error + 1e-12);
      CHECK(norm(carried - Vec3d{0.3, 0.4, 0}) < 0.5 * 1.5 * (angle + length_error));
    }
  }
}

}  // namespace contacts_test
