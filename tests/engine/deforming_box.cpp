// silt - BSD-3-Clause, see LICENSE
// A box that deforms: no place of it differs from another, no contact is missed, bits do not depend
// on threads nor on a restart, and what it cannot do is refused.
#include <engine/deforming_box.hpp>

#include <filesystem>
#include <set>

#include <silt/contact/cohesion/cohesive.hpp>
#include <silt/contact/cohesion/dmt.hpp>
#include <silt/contact/jkr.hpp>
#include <silt/io/checkpoint.hpp>

namespace deforming_box_test {
namespace {

using Sim = decltype(sheared(cloud(1, 1), cube(1), silt::EnergyLedger{}));
/// The sum of all [kg m/s] relative to the flow.
Vec3d momentum(const Sim& sim) {
  Vec3d sum{0, 0, 0};
  for (std::size_t k = 0; k < sim.rows(); ++k)
    sum += sim.mass(k) * (sim.velocity(k) - sim.domain().flow_at(sim.position(k)));
  return sum;
}

/// What two touching spheres do after some steps, the second as seen from the first.
struct Touch {
  Vec3d velocity, spin, spring;  // [m/s], [rad/s], [m]
};
Touch touch_at(const Vec3d& where, const Deformation& how) {
  silt::Particles<Sphere> two;
  for (const double side : {-0.495e-3, 0.495e-3})
    two.add({.position = where + side * Vec3d{0.6, 0.8, 0},
             .radius = 0.5e-3,
             .density = 2500,
             .velocity = side * Vec3d{-20, 30, 50}});
  Sim sim = sheared(two, cube(8e-3, how), silt::EnergyLedger{});
  sim.time_step = 2e-6, sim.threads = 1;
  sim.run(40e-6);
  const std::size_t a = sim.find(0), b = sim.find(1);
  const auto own = [&](std::size_t k) {
    return sim.velocity(k) - sim.domain().flow_at(sim.position(k));
  };
  const auto& pairs = sim.engine().lists.pairs;
  Touch t{own(b) - own(a), sim.angular_velocity(a) + sim.angular_velocity(b), {0, 0, 0}};
  pairs.for_each([&](std::size_t k) {
    t.spring = {pairs.history(0, k), pairs.history(1, k), pairs.history(2, k)};
  });
  return t;
}

TEST_CASE(
    "deforming_box: a pair across a sheared face has the velocities, spins and tangential spring "
    "of a pair inside, to rounding") {
  const Deformation how{.x = {.rate = 30},
                        .y = {.rate = -50},
                        .xy = {.rate = 200},
                        .xz = {.rate = -100},
                        .yz = {.rate = 70}};
  const Touch inside = touch_at({3e-3, 4e-3, 4e-3}, how);
  CHECK(norm(inside.spring) > 1e-8);  // without the flow it would be a fifth of that
  // Across the faces of y, of x and y, of all. Wrong offsets would change all by some percent.
  for (const Vec3d& where : {Vec3d{3e-3, 8e-3, 4e-3}, Vec3d{0, 8e-3, 4e-3}, Vec3d{8e-3, 0, 0},
                             Vec3d{3e-3, 4e-3, 8e-3}}) {
    const Touch across = touch_at(where, how);
    CHECK(norm(across.velocity - inside.velocity) < 1e-12 * norm(inside.velocity));
    CHECK(norm(across.spin - inside.spin) < 1e-11 * norm(inside.spin));
    CHECK(norm(across.spring - inside.spring) < 1e-11 * norm(inside.spring));
  }
}

TEST_CASE(
    "deforming_box: a crowd that is moved as a whole does the same to 1e-8 after a strain "
    "of 0.3, and its momentum obeys dP/dt = -L P") {
  // 500 steps; images pass each other by a third of a box length, and the box shrinks by 7 %.
  const Deformation how{.x = {.rate = -20}, .z = {.rate = 4}, .xy = {.rate = 60}};
  std::vector<ParticleBits> first;
  for (const Vec3d& shift : {Vec3d{0, 0, 0}, Vec3d{1.3e-3, 2.9e-3, -2.2e-3}}) {
    Sim sim = sheared(cloud(4, 1.06e-3, 0.05, shift), cube(4.24e-3, how), silt::EnergyLedger{});
    sim.time_step = 1e-5, sim.threads = 1;
    sim.run(0);
    const Vec3d before = momentum(sim);
    sim.run(5e-3);
    CHECK(sim.touching_pairs() > 15);
    // P_y stays, as nothing compresses y; P_z goes with 1/length.
    const auto& f = sim.domain();
    const Vec3d now = momentum(sim);
    CHECK(now.z * f.length(2) == doctest::Approx(before.z * 4.24e-3).epsilon(1e-3));
    CHECK(now.y == doctest::Approx(before.y).epsilon(1e-9));
    std::vector<ParticleBits> all;
    for (silt::ParticleId id = 0; id < 64; ++id) {
      const std::size_t k = sim.find(id);
      const Vec3d v = sim.velocity(k) - f.flow_at(sim.position(k)), w = sim.angular_velocity(k);
      all.push_back({id, {v.x, v.y, v.z, w.x, w.y, w.z}});
    }
    if (first.empty()) first = all;
    double most = 0;
    for (std::size_t k = 0; k < 64; ++k)
      for (std::size_t c = 0; c < 6; ++c)
        most =
            std::max(most, std::abs(all[k].values[c] - first[k].values[c]) / (c < 3 ? 0.1 : 100));
    CHECK(most < 1e-8);  // a wrong offset at one face: of order 1
  }
}

/// Stops if a contact is missed, and counts how often the lists were made.
struct Watch {
  silt::ContactCheck<silt::BruteForce> check;
  std::set<std::int64_t> searches, prunings;
  int steps = 0;
  template <class S>
  void operator()(const S& sim) {
    check(sim), ++steps;
    searches.insert(sim.engine().lists.upkeep.searched_at);
    prunings.insert(sim.engine().lists.upkeep.pruned_at);
  }
};

TEST_CASE("deforming_box: no contact is missed in 1500 steps of shear and compression") {
  for (const Deformation& how :
       {Deformation{.xy = {.rate = 100}},
        Deformation{.x = {.rate = 20}, .y = {.rate = -40}, .z = {.rate = 15}, .xz = {.rate = 30}},
        Deformation{.x = {.stress = 500, .most_rate = 20}, .yz = {.rate = 60}}}) {
    // Slow particles: what uses up the lists is the flow.
    Sim sim = sheared(cloud(5, 1.06e-3, 0.01), cube(5.3e-3, how), silt::EnergyLedger{});
    sim.time_step = 5e-6, sim.threads = 2;
    Watch watch;
    sim.run(7.5e-3, watch);
    CHECK(watch.check.contacts() > 5000);
    CHECK(watch.prunings.size() > 10);
    CHECK(watch.searches.size() > 3);
    CHECK(2 * watch.prunings.size() < std::size_t(watch.steps));  // lists are kept meanwhile
  }
}

TEST_CASE("deforming_box: any number of threads gives the same bits, and so does a restart") {
  const Deformation how{.x = {.stress = 400, .most_rate = 10}, .xy = {.rate = 50}};
  const auto begin = [&](int threads) {
    Sim sim = sheared(cloud(9, 1.2e-3), cube(10.8e-3), silt::EnergyLedger{});
    sim.time_step = 1e-5, sim.threads = threads;
    sim.deform(how);
    return sim;
  };
  const auto dir = std::filesystem::temp_directory_path() / "silt_deforming_box";
  const std::string file = dir.string() + ".silt";
  Sim one = begin(1);
  one.run(1.5e-3);
  silt::save_checkpoint(one, file);
  one.run(1.5e-3);
  for (const int threads : {2, 3}) {
    Sim many = begin(threads);
    many.run(1.5e-3), many.run(1.5e-3);
    CHECK(bits(many) == bits(one));
    CHECK(many.domain().state() == one.domain().state());
  }
  Sim again = begin(2);
  again.deform({});  // what the file says holds
  silt::load_checkpoint(again, file);
  again.run(1.5e-3);
  CHECK(bits(again) == bits(one));
  CHECK(again.domain().state() == one.domain().state());
  CHECK(again.energy().residual() == one.energy().residual());
  Sim other = sheared(cloud(9, 1.2e-3), cube(10.9e-3), silt::EnergyLedger{});
  CHECK(refusal<silt::InputError>([&] {
          silt::load_checkpoint(other, file);
        }).find("deforming box") != std::string::npos);
  std::filesystem::remove(file);
}

TEST_CASE("deforming_box: the motion of the sample as a whole is no stress") {
  // The mean velocity of 1 m/s alone would be a pressure of 1000 Pa along x.
  const Deformation how{.y = {.rate = -10}, .z = {.rate = 5}};
  double pressure[2][3];
  for (const int moves : {0, 1}) {
    auto all = cloud(5, 1.05e-3);
    for (std::size_t k = 0; k < all.size(); ++k)
      all[k].velocity += double(moves) * Vec3d{1, -0.5, 0.7};
    Sim sim = sheared(all, cube(5.25e-3, how), silt::EnergyLedger{});
    sim.time_step = 1e-5, sim.threads = 1;
    sim.run(1e-3);
    const auto& s = sim.domain().stress();
    pressure[moves][0] = s.x, pressure[moves][1] = s.y, pressure[moves][2] = s.z;
    const auto e = sim.energy();  // which hold it: its flow does work on it
    CHECK(std::abs(e.residual()) < 2e-3 * e.turned_over);
  }
  for (int d = 0; d < 3; ++d)
    CHECK(std::abs(pressure[1][d] - pressure[0][d]) < 1e-6 * pressure[0][1]);
}

TEST_CASE("deforming_box: pairs in float give the stress of pairs in double to 1e-4") {
  const Deformation how{.y = {.rate = -5}, .xy = {.rate = 40}};
  double stress[2][3];
  const auto of = [&](auto&& sim, double(&out)[3]) {
    sim.time_step = 1e-5, sim.threads = 1;
    sim.run(1e-3);
    const auto& s = sim.domain().stress();
    out[0] = s.x, out[1] = s.y, out[2] = s.xy;
  };
  of(sheared(cloud(5, 1.05e-3), cube(5.25e-3, how)), stress[0]);
  of(sheared(cloud(5, 1.05e-3), cube(5.25e-3, how), silt::Mixed{}), stress[1]);
  CHECK(stress[0][1] > 10);
  for (int k = 0; k < 3; ++k) CHECK(std::abs(stress[0][k] - stress[1][k]) < 1e-4 * stress[0][1]);
}

TEST_CASE("deforming_box: what cannot be is refused in a sentence") {
  const auto says = [](auto&& action) { return refusal<silt::InputError>(action); };
  CHECK(says([] { DeformingBox({{0, 0, 0}, {1, 0, 1}}); }).find("its lengths") == 14);
  CHECK(says([] { cube(1, {.x = {.rate = NAN}}); }).find("Deformation.x.rate") == 0);
  CHECK(says([] { cube(1, {.y = {.stress = 1e3}}); }).find("Deformation.y.most_rate = 0") == 0);
  CHECK(says([] { cube(1, {.xy = {.stress = INFINITY, .most_rate = 1}}); }).find(".stress") == 14);
  CHECK(says([] {
          cube(1, {.xz = {.rate = 1, .stress = 2}});
        }).find("has both a rate and a stress") != std::string::npos);
  Sim sim = sheared(cloud(4, 1.3e-3), cube(5.2e-3), silt::EnergyLedger{});
  // Catches a box that grows without end, as nothing pulls.
  const Deformation pulled{.y = {.stress = -100, .most_rate = 1}};
  const std::string tension = says([&] { sim.deform(pulled); });
  CHECK(tension.find("Deformation.y.stress = -100 [Pa] is a tension") == 0);
  CHECK(tension.find("HertzMindlin never pulls") != std::string::npos);
  Sim from_start = sheared(cloud(4, 1.3e-3), cube(5.2e-3, pulled), silt::EnergyLedger{});
  CHECK(says([&] { from_start.run(0.01); }) == tension);
  sim.deform({.xy = {.stress = -100, .most_rate = 1}});  // a shear stress has a sign
  sim.deform({});
  silt::Simulation sticky{
      cloud(4, 1.3e-3),
      silt::Contacts<silt::Jkr>{
          {.youngs_modulus = 1e6, .poisson_ratio = 0.3, .work_of_adhesion = 0.1}},
      cube(5.2e-3)};
  sticky.deform(pulled);
  silt::Simulation bound{
      cloud(4, 1.3e-3),
      silt::Contacts<silt::Cohesive<HertzMindlin, silt::Dmt>>{{rubber, {.work_of_adhesion = 0.05}}},
      cube(5.2e-3)};
  bound.deform(pulled);
  CHECK(says([&] { sim.add_wall(silt::Surfaces{silt::Plane{}}, rubber); }).find("a wall") !=
        std::string::npos);
  CHECK(says([&] {
          sim.add_outlet({{0, 0, 0}, {1, 1, 1}});
        }).find("an outlet") != std::string::npos);
  CHECK(says([&] {
          sim.add_inlet(Box{{0, 0, 0}, {1, 1, 1}},
                        silt::InletFlow{.radius = 1e-3, .density = 1, .rate = 1});
        }).find("an inlet") != std::string::npos);
  // With or without books: all would fall without end, and the fall would count as stress.
  sim.gravity = {0, 0, -9.81};
  CHECK(says([&] { sim.run(0.1); }).find("DeformingBox: Simulation::gravity = ") == 0);
  silt::Simulation falls{cloud(4, 1.3e-3), silt::Contacts<HertzMindlin>{rubber}, cube(5.2e-3)};
  falls.gravity = {0, 0, -9.81};
  CHECK(says([&] { falls.run(0.1); }).find("DeformingBox: Simulation::gravity = ") == 0);
  sim.gravity = {0, 0, 0};
  CHECK(says([&] {
          sim.run(0.01, [](auto& s) { s.gravity = {0, 0, -9.81}; });
        }).find("DeformingBox: Simulation::gravity = ") == 0);
  sim.gravity = {0, 0, 0};
  sim.deform({.x = {.rate = -100}});  // to less than two diameters
  CHECK(says([&] {
          sim.guard.max_overlap = 100, sim.guard.max_rate = 100, sim.run(0.1);
        }).find("DeformingBox: its length") == 0);
  auto fixed = cloud(4, 1.3e-3);
  fixed.add({.position = {0, 0, 0}, .radius = 1e-5, .density = 1, .fixed = true});
  Sim held = sheared(fixed, cube(5.2e-3), silt::EnergyLedger{});
  held.time_step = 1e-6;
  CHECK(says([&] { held.run(1e-5); }).find("fixed particle") != std::string::npos);
}

}  // namespace
}  // namespace deforming_box_test
