// silt - BSD-3-Clause, see LICENSE
// Outlets remove and count; inlets place at their rate, without overlap, or say why particles wait.
#include <cmath>
#include <limits>
#include <set>

#include <engine/support.hpp>

#include <silt/contact/linear_spring.hpp>
#include <silt/io/observers.hpp>

#include "near.hpp"

namespace openings_test {

namespace {

using namespace engine_test;
using silt::InletFlow;
using silt::InputError;
using silt::LinearSpring;

constexpr double step = 1e-5;                          // [s]
const Box channel{{0, 0, -1}, {0.02, 0.02, 1}};        // [m] repeats in x and y
const Box mouth{{0, 0, 0.05}, {0.02, 0.02, 0.06}};     // [m] of the inlets
const double mass = 1000 * silt::sphere_volume(1e-3);  // [kg] of one sphere

auto scene(const silt::Particles<Sphere>& particles = {}) {
  silt::Simulation sim{silt::Particles<Sphere>(particles),
                       silt::Contacts<LinearSpring>{{.stiffness = 10}}, silt::VerletList<>{},
                       silt::PeriodicBox{channel, {true, true, false}}};
  sim.time_step = step;
  sim.threads = 1;
  return sim;
}

InletFlow flow(double rate, const Vec3d& velocity) {
  return {.radius = 1e-3, .density = 1000, .rate = rate, .velocity = velocity};
}

}  // namespace

TEST_CASE("outlet: takes away and counts those whose centre enters it, each once") {
  silt::Particles<Sphere> p;
  // Ten fall, ten rise; every second one sideways of the outlet.
  for (int k = 0; k < 20; ++k)
    p.add({.position = {k % 2 ? 0.004 : 0.014, 0.001 + 0.0009 * k, 0},
           .radius = 0.5e-3 * (k + 21) / 40,
           .density = 1000,
           .velocity = {0, 0, k < 10 ? -1.0 : 1.0}});
  auto sim = scene(p);
  // Two that overlap: what is in both counts for the first.
  const auto outlet = sim.add_outlet({{0, 0, -0.02}, {0.01, 0.02, -0.01}});
  const auto second = sim.add_outlet({{0, 0, -0.03}, {0.01, 0.02, -0.01}});
  sim.run(0.009);
  CHECK(sim.outlet(outlet).count == 0);
  CHECK(sim.size() == 20);
  sim.run(0.009);
  CHECK(sim.outlet(outlet).count == 5);
  CHECK(sim.outlet(second).count == 0);
  CHECK(sim.size() == 15);
  double gone = 0;  // [kg]
  for (std::uint32_t id = 0; id < 20; ++id) {
    const bool leaves = id < 10 && id % 2 == 1;
    CHECK((sim.find(id) == sim.rows()) == leaves);
    if (leaves) gone += 1000 * silt::sphere_volume(0.5e-3 * (id + 21) / 40);
  }
  CHECK(sim.outlet(outlet).mass == near(gone).epsilon(1e-12));  // round-off of five sums
}

TEST_CASE("outlet: in a periodic box it takes what has an image in it, on either side") {
  const auto taken = [](const Box& outlet) {
    silt::Particles<Sphere> p;
    for (const double x : {0.5e-3, 10e-3, 19.5e-3})
      p.add({.position = {x, 5e-3 + x / 2, 0}, .radius = 1e-3, .density = 1000});
    auto sim = scene(p);
    sim.add_outlet(outlet);
    sim.run(1e-3);
    return std::vector<bool>{sim.find(0) == sim.rows(), sim.find(1) == sim.rows(),
                             sim.find(2) == sim.rows()};
  };
  using Gone = std::vector<bool>;
  CHECK(taken({{19.8e-3, 0, -0.1}, {22.5e-3, 0.02, 0.1}}) == Gone{true, false, false});
  CHECK(taken({{-2.5e-3, 0, -0.1}, {0.2e-3, 0.02, 0.1}}) == Gone{false, false, true});
  CHECK(taken({{-41e-3, -0.04, -0.1}, {-40.2e-3, -0.02, 0.1}}) == Gone{false, false, true});
  // Not across z, which does not repeat.
  CHECK(taken({{0, 0, 1.9}, {0.02, 0.02, 2.1}}) == Gone{false, false, false});
  const double inf = std::numeric_limits<double>::infinity();
  CHECK(taken({{-inf, -inf, -inf}, {0.2e-3, inf, inf}}) == Gone{false, false, false});
}

TEST_CASE("outlet: an empty region is refused") {
  auto sim = scene();
  CHECK(has_words(refusal<InputError>([&] {
                    sim.add_outlet({{0, 0, 1}, {1, 1, 1}});
                  }),
                  {"add_outlet", "from (0, 0, 1) to (1, 1, 1) m is empty"}));
}

TEST_CASE("inlet: places at its rate, without overlap, and outlets take out as many in the end") {
  auto sim = scene();
  const auto inlet = sim.add_inlet(mouth, flow(5000, {0, 0, -2}));
  const auto outlet = sim.add_outlet({{0, 0, -0.9}, {0.02, 0.02, 0}});
  bool on_time = true;
  sim.run(0.1, [&](const auto& s) {
    // What is due is placed at the insertions, one after the time in which a sphere moves on by its
    // diameter; so many may be outstanding, and one is placed at the very start.
    const double due = 5000 * s.time(), placed = static_cast<double>(s.inlet(inlet).placed);
    const double between = 5000 * s.inlet(inlet).interval;
    on_time = on_time && placed <= due + 1 && placed >= due - between - 1;
  });
  CHECK(on_time);
  CHECK(sim.inlet(inlet).interval == near(2e-3 / 2));
  CHECK(sim.inlet(inlet).waiting == 0);
  CHECK(sim.inlet(inlet).why_waiting().empty());
  // All have one velocity: had none been placed into another, none ever touched.
  CHECK(sim.peak_overlap() == 0);
  CHECK(sim.outlet(outlet).count > 300);
  CHECK(sim.size() + sim.outlet(outlet).count == sim.inlet(inlet).placed);
  CHECK(sim.outlet(outlet).mass ==
        near(mass * static_cast<double>(sim.outlet(outlet).count)).epsilon(1e-9));
  CHECK(sim.inlet(inlet).mass ==
        near(mass * static_cast<double>(sim.inlet(inlet).placed)).epsilon(1e-9));
}

// Catches a table of ids that is older than the particles' places: after a search that sorted them,
// an outlet that took some, an inlet that gave others, in the middle of a run.
TEST_CASE("ids: each leads to its particle at any time, those of particles that left to none") {
  auto sim = scene();
  sim.add_outlet({{0, 0, -0.02}, {0.02, 0.02, -0.01}});
  sim.add_inlet(mouth, flow(20000, {0, 0, -2}));
  std::set<silt::ParticleId> seen;
  std::size_t most = 0, gone = 0;
  sim.run(0.06, [&](const auto& s) {
    for (const silt::ParticleId id : seen) {
      const std::size_t k = s.find(id);
      if (k < s.rows())
        CHECK(s.id(k) == id);
      else
        ++gone;
    }
    for (std::size_t k = 0; k < s.rows(); ++k)
      if (s.is_present(k)) {
        seen.insert(s.id(k));
        CHECK(s.find(s.id(k)) == k);
      }
    most = std::max(most, s.size());
    CHECK(s.find(silt::no_particle) == s.rows());
    CHECK(s.find(silt::ParticleId{1} << 40) == s.rows());
  });
  CHECK(gone > 0);
  CHECK(seen.size() > most);
}

TEST_CASE("inlet: particles start in its region, with its velocity at that very instant") {
  auto sim = scene();
  sim.gravity = {0, 0, -9.81};
  sim.add_inlet(mouth, flow(1000, {0.1, 0, -1}));
  silt::ParticleId seen = 0;
  sim.run(0.05, [&](const auto& s) {
    for (std::size_t k = 0; k < s.rows(); ++k) {
      if (s.id(k) < seen) continue;
      // Round-off: the row holds the velocity of half a step ago.
      CHECK(norm(s.velocity(k) - Vec3d{0.1, 0, -1}) < 1e-14);
      CHECK(mouth.grown(-1e-3 + 1e-15).contains(s.position(k)));
    }
    for (std::size_t k = 0; k < s.rows(); ++k) seen = std::max(seen, s.id(k) + 1);
  });
  CHECK(seen > 40);
}

TEST_CASE("inlet: stops after its total") {
  auto sim = scene();
  auto some = flow(5000, {0, 0, -1});
  some.total = 37;
  const auto inlet = sim.add_inlet(mouth, some);
  sim.run(0.05);
  CHECK(sim.inlet(inlet).placed == 37);
  CHECK(sim.size() == 37);
}

TEST_CASE("inlet: its rate may change, is zero while it is closed, and nothing due is lost") {
  auto sim = scene();
  const auto inlet = sim.add_inlet(mouth, flow(5000, {0, 0, -2}));
  sim.run(0.02);
  sim.set_inlet_rate(inlet, 1000);
  sim.run(0.02);
  CHECK(sim.inlet(inlet).flow.rate == 1000);
  // 100, 20, and one at the start; what came due since the last insertion is outstanding.
  CHECK(std::abs(static_cast<double>(sim.inlet(inlet).placed) - 120) <= 2);
  sim.set_inlet_rate(inlet, 0);
  const auto closed = sim.inlet(inlet).placed;
  sim.run(0.02);
  CHECK(sim.inlet(inlet).placed == closed);
  CHECK(sim.inlet(inlet).waiting == 0);
  sim.set_inlet_mass_rate(inlet, 5000 * mass);
  CHECK(sim.inlet(inlet).flow.rate == near(5000).epsilon(1e-12));
  sim.run(0.02);
  // What would have come while it was closed does not.
  CHECK(std::abs(static_cast<double>(sim.inlet(inlet).placed - closed) - 100) <= 6);
  CHECK(sim.peak_overlap() == 0);
  sim.set_inlet_mass_rate(inlet, 0);
  CHECK(sim.inlet(inlet).flow.rate == 0);
  CHECK(has_words(refusal<InputError>([&] { sim.set_inlet_rate(inlet, -1); }),
                  {"set_inlet_rate: rate = -1 [1/s]"}));
  CHECK(has_words(refusal<InputError>([&] { sim.set_inlet_mass_rate(inlet, -1); }),
                  {"set_inlet_mass_rate: rate = -1 [kg/s]"}));
  CHECK_THROWS_AS(sim.set_inlet_rate(1, 1), InputError);
}

TEST_CASE("inlet: a rate that grows in many small steps brings its integral") {
  auto sim = scene();
  const auto inlet = sim.add_inlet(mouth, flow(1, {0, 0, -2}));
  sim.run(0.1, silt::at(silt::every(1e-3), [&](auto& s) {
            s.set_inlet_rate(inlet, 1 + 5e4 * s.time());  // 250 after 0.1 s
          }));
  CHECK(std::abs(static_cast<double>(sim.inlet(inlet).placed) - 250) <= 8);
}

TEST_CASE("inlet: where nothing clears it particles wait, and a sentence says so") {
  auto sim = scene();
  auto crowd = flow(1e6, {0, 0, 0});
  crowd.interval = 1e-3;
  const auto inlet = sim.add_inlet(Box{{5e-3, 5e-3, 0}, {0.01, 0.01, 5e-3}}, crowd);
  sim.run(0.01);
  const auto& i = sim.inlet(inlet);
  // 2.5 diameters a side: at most 2 x 2 x 2, and some more where they are placed askew.
  CHECK(i.placed >= 4);
  CHECK(i.placed < 16);
  CHECK(i.placed == sim.size());
  CHECK(i.waiting > 5000);
  CHECK(has_words(
      i.why_waiting(),
      {"inlet into the box from (0.005, 0.005, 0)", silt::text(i.placed, " particles placed"),
       silt::text(i.waiting, " wait"), "200 random places in a row were occupied",
       "lower the rate, enlarge the region, or give a velocity"}));
  CHECK(sim.peak_overlap() == 0);
}

// Catches a crowd that is named where a wall is in the way, and ids of particles that are not
// there.
TEST_CASE("inlet: why particles wait names who takes their places") {
  const Box region{{5e-3, 5e-3, 0}, {0.01, 0.01, 5e-3}};
  auto crowd = flow(1e6, {0, 0, 0});
  crowd.interval = 1e-3;
  const auto why = [&](auto& sim) {
    const auto inlet = sim.add_inlet(region, crowd);
    sim.run(2e-3);
    return sim.inlet(inlet).why_waiting();
  };
  silt::Particles<Sphere> one;
  one.add({.position = {0.017, 0.017, 0.05}, .radius = 1e-3, .density = 1000, .fixed = true});
  one.add({.position = {7.5e-3, 7.5e-3, 2.5e-3}, .radius = 2.4e-3, .density = 1000, .fixed = true});
  auto taken = scene(one);
  CHECK(has_words(why(taken), {"by particles (the last by particle 1"}));
  // A lid in the region: grains take what it leaves, walls the rest.
  auto cut = scene();
  cut.add_wall(silt::Plane{{0, 0, 2.5e-3}, {0, 0, 1}}, {.stiffness = 10}, {.name = "lid"});
  const std::string words = why(cut);
  CHECK(has_words(words,
                  {"by particles (the last by particle", "by wall 0 'lid'", "lower the rate"}));
  // The image of a particle is it too.
  silt::Particles<Sphere> far;
  far.add({.position = {7.5e-3 + 0.02, 7.5e-3, 2.5e-3},
           .radius = 2.4e-3,
           .density = 1000,
           .fixed = true});
  auto image = scene(far);
  CHECK(has_words(why(image), {"the last by particle 0"}));
  // Hardly any place of the region holds a sphere: a cylinder that lies askew.
  auto slender = scene();
  const Vec3d a{2e-3, 2e-3, 2e-3}, b{0.018, 0.018, 0.018};
  const auto inlet =
      slender.add_inlet(silt::CylinderRegion{a, b, 1e-3 + 1e-8}, flow(100, {0, 0, 1}));
  slender.run(1e-3);
  CHECK(has_words(slender.inlet(inlet).why_waiting(),
                  {"hardly any point of the region has room for a sphere of radius 0.001 m"}));
}

TEST_CASE("inlet: outside the domain it is refused") {
  auto sim = scene();
  const Box beside{{0.021, 0, 0}, {0.03, 0.02, 0.02}};
  CHECK(has_words(refusal<InputError>([&] {
                    sim.add_inlet(beside, flow(1, {0, 0, 0}));
                  }),
                  {"add_inlet: the box from (0.021, 0, 0)", "lies outside the PeriodicBox from",
                   "along x, which repeats"}));
  CHECK(sim.inlets() == 0);
  sim.add_inlet(Box{{0.015, 0, 0}, {0.025, 0.02, 0.02}}, flow(1, {0, 0, 0}));  // across the face
  sim.add_inlet(Box{{0, 0, 2}, {0.02, 0.02, 2.1}}, flow(1, {0, 0, 0}));        // z does not repeat
  sim.guard.domain = Box{{-1, -1, -1}, {1, 1, 1}};
  CHECK(has_words(refusal<InputError>([&] { sim.run(0.01); }),
                  {"inlet 1 into the box from (0, 0, 2)", "outside guard.domain from (-1, -1, -1)",
                   "enlarge guard.domain"}));
  sim.guard.domain = Box{{-1, -1, -1}, {1, 1, 2.099}};  // centres end a radius before its end
  sim.run(1e-4);
}

TEST_CASE("inlet: keeps clear of spheres that reach into its region through a repeating face") {
  silt::Particles<Sphere> p;  // spheres on the faces and edges of the box, half of each outside
  for (int k = 0; k < 7; ++k) {
    p.add({.position = {0.02 - 1e-6, 1.5e-3 + 2.5e-3 * k, 0.055}, .radius = 1e-3, .density = 1000});
    p.add({.position = {1.5e-3 + 2.5e-3 * k, 1e-6, 0.055}, .radius = 1e-3, .density = 1000});
  }
  auto sim = scene(p);
  auto crowd = flow(1e6, {0, 0, 0});
  crowd.interval = 1e-3;
  const auto inlet = sim.add_inlet(Box{{0, 0, 0.053}, {0.02, 0.02, 0.057}}, crowd);
  sim.run(5e-3);
  CHECK(sim.inlet(inlet).placed > 30);
  CHECK(sim.peak_overlap() == 0);
}

TEST_CASE("inlet: the seed decides the places") {
  const auto places = [](std::uint64_t seed) {
    auto sim = scene();
    auto f = flow(5000, {0, 0, -1});
    f.seed = seed;
    sim.add_inlet(mouth, f);
    sim.run(0.01);
    return bits(sim);
  };
  CHECK(places(1) == places(1));
  CHECK(places(1) != places(2));
}

TEST_CASE("inlet: values that make no sense are refused by name") {
  auto sim = scene();
  const auto refused = [&](auto change) {
    auto f = flow(100, {0, 0, -1});
    change(f);
    return refusal<InputError>([&] { sim.add_inlet(mouth, f); });
  };
  CHECK(has_words(refused([](auto& f) { f.density = 0; }), {"InletFlow.density = 0 [kg/m3]"}));
  CHECK(has_words(refused([](auto& f) { f.rate = std::numeric_limits<double>::infinity(); }),
                  {"InletFlow.rate = inf [1/s]"}));
  // Catches a message that does not say that mass_rate would do.
  CHECK(has_words(refused([](auto& f) { f.rate = 0; }),
                  {"InletFlow.rate = 0 [1/s] and mass_rate = 0 [kg/s]", "give one of them"}));
  CHECK(has_words(refused([](auto& f) { f.interval = -1; }), {"InletFlow.interval = -1 [s]"}));
  CHECK(has_words(refused([](auto& f) { f.velocity.x = std::nan(""); }),
                  {"InletFlow.velocity = (nan, 0, -1) [m/s]"}));
  CHECK(has_words(refused([](auto& f) { f.trials = 0; }), {"InletFlow.trials = 0 [-]"}));
  CHECK(has_words(refused([](auto& f) { f.radius = 6e-3; }),
                  {"add_inlet", "is thinner than the largest sphere of radius 0.006 m"}));
  sim.run(1e-3);
  CHECK(sim.size() == 0);  // none of them was added
}

TEST_CASE("inlet: does not place into walls, planes and meshes, also where they have moved") {
  auto sim = scene();
  // A plane askew through the mouth leaves its upper half, a mesh of one triangle a part of that.
  const LinearSpring::Material wall{.stiffness = 10};
  sim.add_wall(silt::Plane{{0.01, 0.01, 0.045}, {1, 0, 1}}, wall, [](double) {
    return silt::Pose{{}, {0, 0, 0.01}};
  });
  const std::array<Vec3d, 3> triangle{Vec3d{0.015, -0.1, 0}, {0.015, 0.1, 0}, {0.015, 0, 0.3}};
  sim.add_wall(silt::TriangleMesh(std::vector<std::array<Vec3d, 3>>{triangle}), wall);
  InletFlow rising = flow(40000, {0, 0, 2});
  rising.interval = 2e-5;
  sim.add_inlet(mouth, rising);
  sim.run(2e-4);
  CHECK(sim.size() > 5);
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const Vec3d p = sim.position(k) - 2 * sim.time() * Vec3d{0, 0, 1};  // at most that far up since
    // Nothing has touched: all still have the velocity that they came with.
    CHECK(sim.velocity(k) == Vec3d{0, 0, 2});
    CHECK(p.x - 0.01 + sim.position(k).z - 0.055 > 1e-3 * std::sqrt(2.0));
    CHECK(std::abs(p.x - 0.015) > 1e-3);
  }
}

TEST_CASE("inlet: a mass rate of a recipe brings that mass, and the kinds by their shares") {
  auto sim = scene();
  InletFlow wanted = flow(0, {0, 0, -2});
  wanted.mass_rate = 0.01;  // [kg/s]; 2000 light grains of 1 mm a second would be 0.0084
  wanted.recipe = {{.share = 0.75, .radius = 0.5e-3, .density = 4000}};
  const auto inlet = sim.add_inlet(mouth, wanted);
  const double light = mass, heavy = 4 * mass / 8, mean = 0.25 * light + 0.75 * heavy;
  CHECK(sim.inlet(inlet).flow.rate == near(0.01 / mean).epsilon(1e-12));
  sim.run(0.2);
  double all = 0, heavies = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    all += sim.mass(k), heavies += sim.radius(k) < 0.8e-3;
    CHECK(sim.mass(k) == near(sim.radius(k) < 0.8e-3 ? heavy : light).epsilon(1e-12));
  }
  const auto n = static_cast<double>(sim.size());
  CHECK(sim.inlet(inlet).waiting == 0);
  CHECK(std::abs(heavies / n - 0.75) < 4 * std::sqrt(0.75 * 0.25 / n));  // 4 standard deviations
  CHECK(std::abs(all / (0.01 * 0.2) - 1) < 0.06);  // the same of the mass, and one insertion
  wanted.rate = 1;
  CHECK(has_words(refusal<InputError>([&] { sim.add_inlet(mouth, wanted); }),
                  {"InletFlow.rate = 1", "mass_rate", "both"}));
  wanted.rate = 0, wanted.recipe[0].share = 1.5;
  CHECK(has_words(refusal<InputError>([&] { sim.add_inlet(mouth, wanted); }), {"shares", "1.5"}));
  wanted.recipe[0] = {.share = 0.1, .radius = 1, .density = 1};
  CHECK(has_words(refusal<InputError>([&] { sim.add_inlet(mouth, wanted); }), {"thinner"}));
}

TEST_CASE("inlet: velocities scatter uniformly, all spin as they are told, and the ledger closes") {
  silt::Simulation sim{silt::Particles<Sphere>{}, silt::Contacts<HertzMindlin>{rubber},
                       silt::EnergyLedger{}};
  sim.gravity = {0, 0, -9.81};
  sim.time_step = step;
  InletFlow wanted = flow(20000, {0, 0, -2});
  wanted.angular_velocity = {0, 30, 0}, wanted.scatter = {0.5, 0, 1};
  sim.add_inlet(Box{{0, 0, 0.05}, {3, 3, 0.06}}, wanted);  // so wide that none meet
  sim.run(0.02);
  const auto n = static_cast<double>(sim.size());
  CHECK(n > 300);
  double sum = 0, squares = 0, most = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const double x = sim.velocity(k).x;
    sum += x, squares += x * x, most = std::max(most, std::abs(x));
    CHECK(sim.velocity(k).y == 0);
  }
  // Uniform in +-0.5: variance 1/12; 4 standard deviations of mean and variance.
  CHECK(std::abs(sum / n) < 4 * std::sqrt(1.0 / 12 / n));
  CHECK(std::abs(squares / n - 1.0 / 12) < 4 * std::sqrt(1.0 / 180 / n));
  CHECK(most < 0.5);
  CHECK(sim.angular_velocity(0) == Vec3d{0, 30, 0});
  // Catches a booking with the mean velocity in place of that of each.
  const auto e = sim.energy();
  CHECK(std::abs(e.residual()) < 1e-10 * sim.kinetic_energy());
  // Catches an interval that knows the mean velocity alone: one particle, then none for days.
  auto drifting = scene();
  InletFlow cloud = flow(10000, {0, 0, 0});
  cloud.scatter = {0.1, 0.1, 0.1};
  drifting.add_inlet(mouth, cloud);
  drifting.run(0.03);
  CHECK(drifting.size() > 5);
  wanted.scatter = {0, -1, 0};
  CHECK(has_words(refusal<InputError>([&] { sim.add_inlet(mouth, wanted); }),
                  {"InletFlow.scatter", "not negative"}));
  wanted.scatter = {0, 0, 0}, wanted.angular_velocity.x = std::nan("");
  CHECK(has_words(refusal<InputError>([&] { sim.add_inlet(mouth, wanted); }),
                  {"InletFlow.angular_velocity", "finite"}));
}

TEST_CASE(
    "outlet: sees where a particle is in a periodic box, though it has left it for a moment") {
  silt::Particles<Sphere> p;
  p.add({.position = {0.0199, 0.01, 0}, .radius = 0.5e-3, .density = 1000, .velocity = {1, 0, 0}});
  auto sim = scene(p);
  // Slow, far from all: the next search comes late; without the image the grain would pass.
  const auto outlet = sim.add_outlet({{0, 0, -0.1}, {0.004, 0.02, 0.1}});
  sim.run(3e-3);
  CHECK(sim.outlet(outlet).count == 1);
}

}  // namespace openings_test
