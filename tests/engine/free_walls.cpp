// silt - BSD-3-Clause, see LICENSE
// Walls that move by what acts on them: closed forms, conservation, and that no contact is missed.
#include <filesystem>

#include <boundary/support.hpp>
#include <engine/support.hpp>

#include <silt/boundary/finite_walls.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/observers.hpp>
#include <silt/io/wall_series.hpp>
#include <silt/shape/mesh_body.hpp>
#include <silt/simulation.hpp>

namespace free_walls_test {

namespace {

using namespace engine_test;
using boundary_test::pi;
using silt::FreeBody;
using silt::Hinge;
using silt::Slide;

constexpr HertzMindlin::Material elastic{
    .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 1, .friction = 0.5};

auto scene(silt::Particles<Sphere> particles, const HertzMindlin::Material& material = elastic) {
  silt::Simulation sim{std::move(particles), silt::Contacts<HertzMindlin>{material},
                       silt::EnergyLedger{}};
  sim.threads = 1;
  return sim;
}
using Sim = decltype(scene({}));

silt::Particles<Sphere> one(const Vec3d& position, double radius = 0.01, const Vec3d& v = {}) {
  silt::Particles<Sphere> p;
  p.add({.position = position, .radius = radius, .density = 2500, .velocity = v});
  return p;
}
/// A fixed sphere far from everything.
silt::Particles<Sphere> nothing() {
  silt::Particles<Sphere> p;
  p.add({.position = {50, 50, 50}, .radius = 0.01, .density = 2500, .fixed = true});
  return p;
}
template <class S>
auto each_step(S& sim, auto action) {
  return silt::at(silt::every(0.5 * *sim.time_step), action);
}

/// Momentum, and angular momentum about the origin, of particles and free bodies.
struct Momenta {
  Vec3d linear{}, angular{};
};
Momenta momenta(const Sim& sim) {
  Momenta all;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const Vec3d p = sim.mass(k) * sim.velocity(k);
    all.linear += p;
    all.angular += cross(sim.position(k), p) +
                   0.4 * sim.mass(k) * sim.radius(k) * sim.radius(k) * sim.angular_velocity(k);
  }
  for (std::size_t w = 0; w < sim.walls(); ++w)
    if (const auto* body = std::get_if<FreeBody>(&sim.wall(w).drive)) {
      const auto& s = sim.wall(w).state;
      all.linear += body->mass * s.velocity_now;
      all.angular += body->mass * cross(s.centre, s.velocity_now) + rotate(s.turn, s.momentum_now);
    }
  return all;
}

/// A bed under a servo lid, with a free box that falls into it and a flap on a spring.
Sim crowd(int threads) {
  silt::Particles<Sphere> p;
  p.fill({{-0.009, -0.018, 0.002}, {0.018, 0.018, 0.03}},
         {.radius = silt::uniform(1.5e-3, 2.5e-3),
          .density = 2500,
          .count = 200,
          .arrangement = silt::Arrangement::Random});
  auto sim = scene(std::move(p), rubber);
  sim.threads = threads;
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::box({-0.02, -0.02, 0}, {0.02, 0.02, 0.2}), rubber, {.name = "container"});
  const auto mesh = silt::box_mesh({-0.006, -0.005, 0.034}, {0.006, 0.005, 0.042});
  auto body = silt::free_body(mesh, 1500);
  body.velocity = {0.05, 0, -0.6}, body.angular_velocity = {10, 40, -20};
  sim.add_wall(mesh, rubber, {.name = "box", .drive = body});
  sim.add_wall(silt::rectangle({-0.012, -0.01, 0.002}, {0, 0.02, 0}, {0, 0, 0.03}), rubber,
               {.name = "flap",
                .drive = Hinge{.centre = {-0.012, 0, 0.033},
                               .axis = {0, 1, 0},
                               .inertia = 2e-6,
                               .mass = 5e-3,
                               .centre_of_mass = {-0.012, 0, 0.017},
                               .rate = 5,
                               .stiffness = 2e-3,
                               .damping = 1e-6}});
  sim.add_wall(
      silt::Plane{{0, 0, 0.045}, {0, 0, -1}}, rubber,
      {.name = "lid",
       .drive = silt::ServoForce{.direction = {0, 0, -1}, .force = 0.5, .max_speed = 0.2}});
  return sim;
}
#ifdef SILT_LONG_TESTS
std::vector<double> wall_bits(const Sim& sim) {
  std::vector<double> all;
  for (std::size_t w = 0; w < sim.walls(); ++w) {
    const auto& wall = sim.wall(w);
    const auto& s = wall.state;
    for (const Vec3d& v : {s.centre, s.velocity, s.momentum, wall.pose.translation, wall.impulse,
                           wall.angular_impulse})
      all.insert(all.end(), {v.x, v.y, v.z});
    all.insert(all.end(), {s.way, s.rate, s.turn.w, s.turn.x, s.stiffness});
  }
  return all;
}
#endif

}  // namespace

TEST_CASE("free walls: a body in flight follows the parabola and keeps its angular momentum") {
  const auto mesh = silt::box_mesh({-0.1, -0.2, -0.05}, {0.1, 0.2, 0.05});
  auto sim = scene(nothing());
  sim.gravity = {1, 0, -9.81};
  sim.time_step = 1e-4;
  auto body = silt::free_body(mesh, 1000);
  CHECK(body.mass == doctest::Approx(8));
  CHECK(body.inertia.xx == doctest::Approx(8 * (0.16 + 0.01) / 12));
  body.velocity = {0.5, -0.2, 3}, body.angular_velocity = {2, 1, 7};
  sim.add_wall(mesh, elastic, {.name = "body", .drive = body});
  Vec3d first{};
  double energy = 0;
  sim.run(0.4, silt::at(silt::every(0.02), [&](const Sim& s) {
            const auto& state = s.wall("body").state;
            const double t = s.time();
            // Leapfrog is exact under a constant force but for rounding of 4000 steps.
            const Vec3d wanted = t * body.velocity + 0.5 * t * t * s.gravity;
            CHECK(norm(state.centre - wanted) < 1e-12);
            const Vec3d now = rotate(state.turn, state.momentum_now);
            const auto along = [](const Vec3d& x, const Vec3d& w) { return dot(x, w) * x; };
            const Vec3d w = s.wall("body").angular_velocity();
            Vec3d by_hand{0, 0, 0};  // I w from the edges of the box
            for (const auto& [edge, inertia] : {std::pair{Vec3d{1, 0, 0}, body.inertia.xx},
                                                {Vec3d{0, 1, 0}, body.inertia.yy},
                                                {Vec3d{0, 0, 1}, body.inertia.zz}})
              by_hand += inertia * along(s.wall("body").pose.rotate(edge), w);
            CHECK(norm(by_hand - now) < 1e-9 * norm(now));
            const double all = s.wall_energy("body").sum();
            if (s.step() == 0) first = now, energy = all;
            CHECK(norm(now - first) < 1e-12 * norm(first));
            // NoSquish errs by a bounded amount of second order: (7 rad/s * 1e-4 s)^2 is 5e-7.
            CHECK(all == doctest::Approx(energy).epsilon(1e-6));
          }));
}

TEST_CASE(
    "free walls: a hinged plate swings with 2 pi sqrt(I/(m g l)), and decays by its dashpot") {
  for (const double damping : {0.0, 0.02}) {
    const double m = 0.5, l = 0.2, I = 0.03, g = 9.81, start = 0.05;
    auto sim = scene(nothing());
    sim.gravity = {0, 0, -g};
    sim.time_step = 2e-4;
    // It hangs at an angle `start` from straight below.
    const Vec3d at{l * std::sin(start), 0, -l * std::cos(start)};
    sim.add_wall(silt::rectangle({-0.1, -0.1, -0.3}, {0.2, 0, 0}, {0, 0.2, 0.3}), elastic,
                 {.name = "plate",
                  .drive = Hinge{.centre = {0, 0, 0},
                                 .axis = {0, 1, 0},
                                 .inertia = I,
                                 .mass = m,
                                 .centre_of_mass = at,
                                 .damping = damping}});
    std::vector<double> crossings;
    double last = start, largest = 0;
    sim.run(4.9, each_step(sim, [&](const Sim& s) {
              // Positive turns about y bring it to -x.
              const double angle = start - s.wall("plate").state.way;
              if (last > 0 && angle <= 0)
                crossings.push_back(s.time() - 2e-4 * angle / (angle - last));
              if (crossings.size() == 4) largest = std::max(largest, angle);
              last = angle;
            }));
    REQUIRE(crossings.size() >= 5);
    const double per = damping / (2 * I), w0 = std::sqrt(m * g * l / I);
    const double period = 2 * pi / std::sqrt(w0 * w0 - per * per) * (1 + start * start / 16);
    // The amplitude's share of the period, 1.6e-4, is in it; of a damped one it falls.
    CHECK((crossings[4] - crossings[0]) / 4 ==
          doctest::Approx(period).epsilon(damping > 0 ? 2e-4 : 1e-5));
    // The crest after the fourth crossing comes 3/4 of a period later, after 4 of them in all.
    if (damping > 0)
      CHECK(largest == doctest::Approx(start * std::exp(-per * 4 * period)).epsilon(0.01));
  }
}

TEST_CASE("free walls: a plate that hits a sphere parts from it as two bodies do") {
  // Restitution 0.5: that of the reduced mass, which the damping must know. With the sphere's own
  // mass instead it would be 0.43.
  for (const double e : {1.0, 0.5}) {
    auto material = elastic;
    material.restitution = e;
    auto sim = scene(one({0, 0, 0}), material);
    const double m = sim.mass(0), M = 2 * m, v = -0.5;
    sim.add_wall(silt::Plane{{0, 0, 0.011}, {0, 0, -1}}, material,
                 {.name = "plate", .drive = Slide{.direction = {0, 0, 1}, .mass = M, .speed = v}});
    sim.time_step = 2e-6;
    sim.run(0.02);
    const double of_plate = sim.wall("plate").state.rate_now, of_sphere = sim.velocity(0).z;
    CHECK(M * of_plate + m * of_sphere == doctest::Approx(M * v).epsilon(1e-12));
    // HertzMindlin's damping gives a restitution within 1 % of what is asked for.
    CHECK(of_sphere - of_plate == doctest::Approx(e * v).epsilon(0.01));
  }
}

TEST_CASE("free walls: a plate that falls onto a sphere on the floor keeps the energy to 0.2 %") {
  auto sim = scene(one({0, 0, 0.01}));
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, elastic, {.name = "floor"});
  sim.add_wall(silt::Plane{{0, 0, 0.05}, {0, 0, -1}}, elastic,
               {.name = "plate", .drive = Slide{.direction = {0, 0, 2}, .mass = 0.02}});
  sim.run(0);
  sim.time_step = 0.4 * sim.step_length();  // the error of the step falls with its square
  double start = sim.energy().held() + sim.energy().free_walls, off = 0, lowest = 1, highest = 0;
  sim.run(0.4, silt::at(silt::every(1e-4), [&](const Sim& s) {
            const auto e = s.energy();
            const double all = e.held() + e.free_walls + e.dissipated();
            off = std::max(off, std::abs(all - start));
            const double z = 0.05 + s.wall("plate").state.way;
            lowest = std::min(lowest, z),
            highest = s.time() > 0.15 ? std::max(highest, z) : highest;
            // The ledger of the particles alone closes as well.
            CHECK(std::abs(e.residual()) < 2e-3 * 0.02 * 9.81 * 0.03);
          }));
  CHECK(off < 2e-3 * 0.02 * 9.81 * 0.03);  // of what it falls by
  CHECK(lowest < 0.02);                    // it did meet the sphere
  CHECK(highest > 0.03);                   // and was thrown up again
}

TEST_CASE("free walls: a piston on a column of springs swings with their stiffness in series") {
  // Contacts of Hertz' law are linear about their rest: k = 3/2 F/d. The spheres' mass is 1/125 of
  // the piston's, and their weight too.
  const double r = 0.01, M = 0.05, g = 9.81, F = M * g;
  const double E = 1e7 / (2 * (1 - 0.25 * 0.25));  // [Pa] of both
  const auto rest = [&](double R) { return std::pow(F / (4.0 / 3 * E * std::sqrt(R)), 2.0 / 3); };
  const double at_wall = rest(r), between = rest(r / 2), all = 2 * at_wall + 3 * between;
  silt::Particles<Sphere> p;
  for (int k = 0; k < 4; ++k)
    p.add({.position = {0, 0, r - at_wall + k * (2 * r - between)}, .radius = r, .density = 25});
  auto sim = scene(std::move(p));
  sim.gravity = {0, 0, -g};
  const double compliance = all / (1.5 * F), omega = std::sqrt(1 / (compliance * M));
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, elastic);
  sim.add_wall(silt::Plane{{0, 0, 8 * r - all}, {0, 0, -1}}, elastic,
               {.name = "piston",
                .drive = Slide{.direction = {0, 0, -1}, .mass = M, .speed = 0.02 * all * omega}});
  sim.time_step = 2e-6;
  std::vector<double> crossings;
  double last = 0;
  sim.run(0.2, each_step(sim, [&](const Sim& s) {
            const double way = s.wall("piston").state.way - 2e-3 * all;  // the spheres' weight
            if (last < 0 && way >= 0) crossings.push_back(s.time() - 2e-6 * way / (way - last));
            last = way;
          }));
  REQUIRE(crossings.size() >= 5);
  // Amplitude 2 %: the period of Hertz' contacts differs by less than 1e-4; the mass by 1e-3.
  CHECK((crossings[4] - crossings[0]) / 4 == doctest::Approx(2 * pi / omega).epsilon(5e-3));
}

TEST_CASE("free walls: momentum and angular momentum are kept when a sphere hits a free box") {
  const auto mesh = silt::box_mesh({0, 0, 0}, {0.06, 0.04, 0.02});
  auto sim = scene(one({0.05, 0.032, 0.032}, 0.01, {-0.3, 0.1, -1}), rubber);
  sim.set_angular_velocity(sim.id(0), {30, -20, 10});
  auto body = silt::free_body(mesh, 2500);
  body.angular_velocity = {1, 2, 3};
  sim.add_wall(mesh, rubber, {.name = "box", .drive = body});
  sim.run(0);
  const Momenta before = momenta(sim);
  sim.run(0.05);
  const Momenta after = momenta(sim);
  const auto& s = sim.wall("box").state;
  CHECK(s.velocity_now.z < -0.05);                     // they have met
  CHECK(norm(rotate(s.turn, s.momentum_now)) > 2e-5);  // and the box turns by it
  CHECK(sim.position(0).z > sim.radius(0));            // friction acts: it is not central
  CHECK(norm(after.linear - before.linear) < 1e-13 * norm(before.linear));
  CHECK(norm(after.angular - before.angular) < 1e-12 * norm(before.angular));
}

TEST_CASE("free walls: no contact with walls that move by their loads is missed") {
  auto sim = crowd(1);
  sim.time_step = 1e-5;
  std::size_t touching = 0, missed = 0, renewed = 0;
  std::int64_t last = -1;
  sim.run(0.12, each_step(sim, [&](const Sim& s) {
            const auto& e = s.engine();
            renewed += std::exchange(last, e.lists.upkeep.pruned_at) != e.lists.upkeep.pruned_at;
            std::vector<std::array<std::size_t, 3>> listed;  // sphere, wall, triangle
            for (const auto& c : e.lists.walls.candidates()) {
              if (c.facet_count == 0) listed.push_back({c.particle, c.wall, c.surface});
              for (const auto t : e.lists.walls.facets(c))
                listed.push_back({c.particle, c.wall, t});
            }
            std::sort(listed.begin(), listed.end());
            const auto look = [&](std::size_t p, std::size_t w, std::size_t t) {
              ++touching,
                  missed += !std::binary_search(listed.begin(), listed.end(), std::array{p, w, t});
            };
            for (std::size_t w = 1; w < s.walls(); ++w)
              for (std::size_t p = 0; p < s.rows(); ++p)
                silt::detail::visit_surface(s.wall(w).surfaces[0], [&](const auto& surface) {
                  const Vec3d at = s.wall(w).pose.to_body(s.position(p));
                  silt::SurfacePoint points[4];
                  if constexpr (requires { surface.distance_to(0, at); }) {
                    for (std::uint32_t t = 0; t < surface.triangles().size(); ++t)
                      if (surface.distance_to(t, at) < s.radius(p)) look(p, w, t);
                  } else {
                    if (surface.contacts(at, s.radius(p), points) > 0) look(p, w, 0);
                  }
                });
          }));
  CHECK(missed == 0);
  CHECK(touching > 10000);      // a test that looks at something
  CHECK(renewed < 12000 / 10);  // and the lists live for more than ten steps
}

#ifdef SILT_LONG_TESTS
TEST_CASE("free walls: the same bits from a checkpoint, and with any number of threads") {
  const auto path = (std::filesystem::temp_directory_path() / "silt_free_walls.silt").string();
  auto whole = crowd(1);
  whole.run(0.04);
  silt::save_checkpoint(whole, path);
  whole.run(0.04);
  auto other = crowd(3);
  other.run(0.04), other.run(0.04);
  auto restarted = crowd(2);
  silt::load_checkpoint(restarted, path);
  restarted.run(0.04);
  std::filesystem::remove(path);
  CHECK(bits(whole) == bits(other));
  CHECK(bits(whole) == bits(restarted));
  CHECK(wall_bits(whole) == wall_bits(other));
  CHECK(wall_bits(whole) == wall_bits(restarted));
  CHECK(whole.energy().residual() == restarted.energy().residual());
  CHECK(whole.wall("flap").state.way != 0);
}
#endif

#ifdef SILT_LONG_TESTS
TEST_CASE("free walls: a checkpoint of another drive is refused, and accepted as other motions") {
  const auto path = (std::filesystem::temp_directory_path() / "silt_other_drive.silt").string();
  const auto lid = [](silt::WallDrive drive) {
    auto sim = scene(one({0, 0, 0.01}), rubber);
    sim.gravity = {0, 0, -9.81};
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber);
    sim.add_wall(silt::Plane{{0, 0, 0.021}, {0, 0, -1}}, rubber, {.name = "lid", .drive = drive});
    return sim;
  };
  auto at_rest = lid({});
  at_rest.run(0.01);
  silt::save_checkpoint(at_rest, path);
  auto falls = lid(Slide{.direction = {0, 0, 1}, .mass = 0.1});
  CHECK(has_words(refusal<silt::InputError>([&] { silt::load_checkpoint(falls, path); }),
                  {"wall 1 'lid': moves is 'no' in the file and 'yes' in the scene", ".motions"}));
  silt::load_checkpoint(falls, path, {.motions = true});
  const double before = falls.wall("lid").pose.translation.z;
  falls.run(0.005);
  CHECK(before == 0);
  // From rest, with the half kick that particles have had as well.
  CHECK(falls.wall("lid").state.way == doctest::Approx(-0.5 * 9.81 * 0.005 * 0.005).epsilon(0.01));
  auto twice = lid(Slide{.direction = {0, 0, 1}, .mass = 0.2});
  silt::save_checkpoint(falls, path);
  CHECK(has_words(refusal<silt::InputError>([&] { silt::load_checkpoint(twice, path); }),
                  {"wall 1 'lid': mass [kg] is 0.1 in the file and 0.2 in the scene"}));
  std::filesystem::remove(path);
}
#endif

TEST_CASE("servo: a lid presses a bed with its force within 1 %, and keeps it") {
  silt::Particles<Sphere> p;
  p.fill({{-0.015, -0.015, 0.002}, {0.015, 0.015, 0.06}},
         {.radius = silt::uniform(1.5e-3, 2.5e-3),
          .density = 2500,
          .count = 500,
          .arrangement = silt::Arrangement::Random});
  auto sim = scene(std::move(p), rubber);
  sim.threads = 2;
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::box({-0.017, -0.017, 0}, {0.017, 0.017, 0.2}), rubber);
  const double force = 1;  // [N] ten times the weight of a layer
  sim.add_wall(
      silt::Plane{{0, 0, 0.07}, {0, 0, -1}}, rubber,
      {.name = "lid",
       .drive = silt::ServoForce{.direction = {0, 0, -1}, .force = force, .max_speed = 0.2}});
  sim.run(0.35);
  double most = 0, least = 10 * force, fastest = 0;
  const double before = sim.wall("lid").impulse.z;
  sim.run(0.1, silt::at(silt::every(1e-4), [&](const Sim& s) {
            const auto& lid = s.wall("lid");
            most = std::max(most, lid.force.z), least = std::min(least, lid.force.z);
            fastest = std::max(fastest, std::abs(lid.state.rate));
          }));
  CHECK((sim.wall("lid").impulse.z - before) / 0.1 == doctest::Approx(force).epsilon(2e-3));
  CHECK(most < 1.01 * force);
  CHECK(least > 0.99 * force);
  CHECK(fastest < 0.05);  // it has come to rest, but for grains that still settle
  CHECK(sim.wall("lid").pose.translation.z < -0.02);
  // Asked for more, it gives more.
  sim.set_drive("lid", silt::ServoForce{.direction = {0, 0, -1}, .force = 2, .max_speed = 0.2});
  sim.run(0.2);
  CHECK(sim.wall("lid").force.z == doctest::Approx(2).epsilon(0.01));
}

TEST_CASE("servo: strong dashpots and short steps do not make the lid swing") {
  // Without the dashpots in its gain the lid's speed would change sign in each step, and the mean
  // force be too small, since contacts do not pull: 0.9 of what is wanted at e = 0.6.
  auto material = rubber;
  material.restitution = 0.1;
  silt::Particles<Sphere> p;
  for (int k = 0; k < 9; ++k)
    p.add({.position = {0.021 * (k % 3), 0.021 * (k / 3), 0.01}, .radius = 0.01, .density = 2500});
  auto sim = scene(std::move(p), material);
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, material);
  sim.add_wall(silt::Plane{{0, 0, 0.021}, {0, 0, -1}}, material,
               {.name = "lid",
                .drive = silt::ServoForce{.direction = {0, 0, -1}, .force = 3, .max_speed = 0.1}});
  sim.time_step = 5e-6;
  // The lid approaches its load in 47 ms, C/(gain K), and forgets the way there in 40 times that.
  sim.run(0.5);
  CHECK(sim.wall("lid").force.z == doctest::Approx(3).epsilon(0.01));
  sim.run(8);
  double most = 0, least = 10;
  sim.run(0.01, each_step(sim, [&](const Sim& s) {
            most = std::max(most, s.wall("lid").force.z),
            least = std::min(least, s.wall("lid").force.z);
          }));
  CHECK(most < 3.003);
  CHECK(least > 2.997);
}

// Beds that move the lid: the mean load must be the wanted one. Catches a servo that follows the
// difference alone, which would stay off by v (K dt + C)/gain: it bears 1.11 and 3.8 times the load
// here.
TEST_CASE("servo: a lid that is moved steadily keeps its mean force, 1e-3") {
  const double force = 10, v = 0.5, R = 0.01;  // [N], [m/s], [m]
  for (const double restitution : {1.0, 0.4}) {
    auto material = elastic;
    material.restitution = restitution;
    auto sim = scene(one({0, 0, R - 1e-4}, R, {0, 0, v}), material);
    sim.time_step = 2e-5;
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, material, silt::translation({0, 0, v}));
    sim.add_wall(silt::Plane{{0, 0, 2 * R - 1e-4}, {0, 0, -1}}, material,
                 {.name = "lid",
                  .drive = silt::ServoForce{
                      .direction = {0, 0, -1}, .force = force, .max_speed = 5, .gain = 0.25}});
    sim.run(restitution < 1 ? 1 : 0.1);
    silt::MeanLoad load(sim, "lid");
    sim.run(0.02);
    CHECK(load.read(sim).force.z == doctest::Approx(force).epsilon(1e-3));
    CHECK(sim.wall("lid").state.rate == doctest::Approx(-v).epsilon(1e-2));
    // Stopped, the floor leaves the lid at rest with its force.
    sim.set_motion(0, {});
    sim.run(restitution < 1 ? 1 : 0.1);
    CHECK(sim.wall("lid").force.z == doctest::Approx(force).epsilon(1e-3));
  }
}

// Catches: a servo that begins anew, without its integral, when its load is set again as for a
// pressure on an area that changes; its mean force was 1.1 times what was asked for.
TEST_CASE("servo: set_drive along the same direction goes on, another direction begins anew") {
  const double v = 0.5, R = 0.01;  // [m/s], [m]
  const auto run = [&](const auto& force_at, Vec3d direction = {0, 0, -1}) {
    auto sim = scene(one({0, 0, R - 1e-4}, R, {0, 0, v}), elastic);
    sim.time_step = 2e-5;
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, elastic, silt::translation({0, 0, v}));
    silt::ServoForce servo{.direction = {0, 0, -1}, .force = 10, .max_speed = 5};
    sim.add_wall(silt::Plane{{0, 0, 2 * R - 1e-4}, {0, 0, -1}}, elastic,
                 {.name = "lid", .drive = servo});
    sim.run(0.1, silt::at(silt::every(1e-3), [&](Sim& s) {
              servo.force = force_at(s.time());
              if (s.time() > 0.05) servo.direction = direction;
              s.set_drive("lid", servo);
            }));
    silt::MeanLoad load(sim, "lid");
    sim.run(0.02);
    return std::pair{load.read(sim).force.z, sim.wall("lid").state};
  };
  const auto once = run([](double) { return 10; }, {0, 0, -2});
  CHECK(once.first == doctest::Approx(10).epsilon(1e-3));
  CHECK(once.second.since == 0);
  const auto rising = run([](double t) { return 10 + 20 * std::min(t, 0.08); });
  CHECK(rising.first == doctest::Approx(11.6).epsilon(2e-3));
  // Askew: another drive, from where the lid is now.
  const auto askew = run([](double) { return 10; }, {0, 0.1, -1});
  CHECK(askew.second.since > 0.05);
}

TEST_CASE("free walls: a fixed sphere stops what falls onto it, and throws it back with e") {
  // A plate on a slide, as in the test of two bodies: k d^1.5 between sphere and plate, e = 0.6.
  HertzMindlin::Material lossy = elastic;
  lossy.restitution = 0.6;
  silt::Particles<Sphere> p;
  p.add({.position = {0, 0, 0.01}, .radius = 0.01, .density = 2500, .fixed = true});
  auto sim = scene(std::move(p), lossy);
  sim.time_step = 1e-6;
  sim.add_wall(
      silt::Plane{{0, 0, 0.0201}, {0, 0, -1}}, lossy,
      {.name = "plate", .drive = Slide{.direction = {0, 0, 1}, .mass = 0.1, .speed = -0.5}});
  sim.run(0.01);
  // Without the contact it would go on with -0.5. Of second order in the step; the model's own e
  // is that of its damping with the end at zero force: 1e-3.
  CHECK(sim.wall("plate").state.rate_now == doctest::Approx(0.6 * 0.5).epsilon(1e-3));
  const auto e = sim.energy();
  CHECK(std::abs(e.residual()) < 1e-5 * e.turned_over);
  CHECK(e.normal_damping == doctest::Approx(0.5 * 0.1 * 0.25 * (1 - 0.36)).epsilon(2e-3));
}

TEST_CASE("free walls: a flap, a box and a lid rest on fixed spheres; walls with motions do not") {
  constexpr double g = 9.81, R = 0.01;
  silt::Particles<Sphere> p;
  for (const double x : {-0.02, 0.02})
    for (const double y : {-0.02, 0.02})
      p.add({.position = {x, y, R}, .radius = R, .density = 2500, .fixed = true});
  p.add({.position = {1, 1, R}, .radius = R, .density = 2500});  // sets the time step
  const auto in = [&](auto set) {
    auto sim = scene(p, rubber);
    sim.gravity = {0, 0, -g};
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber, {.name = "floor"});
    set(sim);
    sim.run(0.4);
    CHECK(sim.wall("floor").force.z == doctest::Approx(-sim.mass(4) * g).epsilon(1e-3));
    return sim;
  };
  SUBCASE("a box") {
    const auto mesh = silt::box_mesh({-0.03, -0.03, 0.0201}, {0.03, 0.03, 0.03});
    const auto body = silt::free_body(mesh, 500);
    const auto sim = in([&](auto& s) { s.add_wall(mesh, rubber, {.name = "it", .drive = body}); });
    CHECK(sim.wall("it").force.z == doctest::Approx(body.mass * g).epsilon(1e-3));
    CHECK(norm(sim.wall("it").state.velocity_now) < 1e-4);
  }
  SUBCASE("a flap") {
    const auto sim = in([&](auto& s) {
      s.add_wall(silt::rectangle({-0.06, -0.03, 0.0201}, {0.09, 0, 0}, {0, 0.06, 0}), rubber,
                 {.name = "it",
                  .drive = Hinge{.centre = {-0.06, 0, 0.0201},
                                 .axis = {0, 1, 0},
                                 .inertia = 1e-4,
                                 .mass = 0.03,
                                 .centre_of_mass = {-0.015, 0, 0.0201}}});
    });
    // The weight's moment m g 45 mm.
    CHECK(sim.wall("it").torque.y == doctest::Approx(-0.03 * g * 0.045).epsilon(1e-3));
    CHECK(std::abs(sim.wall("it").state.rate_now) < 1e-3);
  }
  SUBCASE("a lid of a servo") {
    const auto sim = in([&](auto& s) {
      s.add_wall(
          silt::rectangle({-0.03, -0.03, 0.021}, {0.06, 0, 0}, {0, 0.06, 0}), rubber,
          {.name = "it",
           .drive = silt::ServoForce{.direction = {0, 0, -1}, .force = 0.5, .max_speed = 0.05}});
    });
    // k d^1.5 of four springs, k = 4/3 E* sqrt(R), E* = E/(2 (1 - nu^2)).
    const double k = 4.0 / 3 * 1e6 / (2 * (1 - 0.09)) * std::sqrt(R);
    CHECK(sim.wall("it").force.z == doctest::Approx(0.5).epsilon(1e-3));
    CHECK(sim.wall("it").pose.translation.z + 0.001 ==
          doctest::Approx(-std::pow(0.5 / 4 / k, 2.0 / 3)).epsilon(1e-3));
  }
  SUBCASE("a wall with a motion passes through them") {
    const auto sim = in([&](auto& s) {
      s.add_wall(silt::rectangle({-0.03, -0.03, 0.0201}, {0.06, 0, 0}, {0, 0.06, 0}), rubber,
                 {.name = "it", .motion = silt::translation({0, 0, -1e-3})});
    });
    CHECK(norm(sim.wall("it").force) == 0);
  }
}

TEST_CASE("servo: a paddle presses a fixed sphere with torque over arm") {
  silt::Particles<Sphere> p;
  p.add({.position = {0.05, 0.02, 0}, .radius = 0.005, .density = 2500, .fixed = true});
  p.add({.position = {0.05, 0.01, 0}, .radius = 0.005, .density = 2500});
  auto sim = scene(std::move(p), rubber);
  sim.add_wall(silt::rectangle({0, 0, -0.02}, {0.08, 0, 0}, {0, 0, 0.04}), rubber,
               {.name = "paddle",
                .drive = silt::ServoTorque{
                    .centre = {0, 0, 0}, .axis = {0, 0, 1}, .torque = 0.01, .max_rate = 1}});
  sim.set_reference("paddle", {0, 0, 0});
  sim.run(0.3);
  CHECK(sim.wall("paddle").torque.z == doctest::Approx(-0.01).epsilon(1e-3));
  // Its limit: without the spheres it turns with max_rate until max_turn.
  sim.remove(sim.id(0)), sim.remove(sim.id(1));
  sim.set_drive("paddle", silt::ServoTorque{.centre = {0, 0, 0},
                                            .axis = {0, 0, 1},
                                            .torque = -0.01,
                                            .max_rate = 1,
                                            .max_turn = 0.05});
  sim.run(0.04);
  CHECK(sim.wall("paddle").state.way == doctest::Approx(-0.04).epsilon(1e-3));
  sim.run(0.04);
  CHECK(sim.wall("paddle").state.way == doctest::Approx(-0.05));
}

TEST_CASE("drives: what cannot be is refused by name") {
  auto sim = scene(one({0, 0, 0.02}));
  const silt::Plane floor{{0, 0, 0}, {0, 0, 1}};
  const double nan = boundary_test::not_a_number;
  const auto refused = [&](silt::WallDrive drive, std::initializer_list<std::string> words) {
    const auto sentence = refusal<silt::InputError>(
        [&] { sim.add_wall(floor, elastic, {.name = "it", .drive = std::move(drive)}); });
    CHECK(has_words(sentence, words));
  };
  refused(Slide{.direction = {0, 0, 0}, .mass = 1}, {"Slide.direction", "not zero"});
  refused(Slide{.direction = {0, 0, 1}, .mass = 0}, {"Slide.mass = 0 [kg]"});
  refused(Slide{.direction = {0, 0, 1}, .mass = 1, .stiffness = -1}, {"Slide.stiffness"});
  refused(Slide{.direction = {0, 0, 1}, .mass = 1, .speed = nan}, {"Slide.speed"});
  refused(Hinge{.centre = {}, .axis = {0, 0, 0}, .inertia = 1}, {"Hinge.axis"});
  refused(Hinge{.centre = {}, .axis = {0, 0, 1}, .inertia = -1}, {"Hinge.inertia = -1 [kg m2]"});
  refused(Hinge{.centre = {0, 1, 0},
                .axis = {2, 0, 0},
                .inertia = 1e-9,
                .mass = 2,
                .centre_of_mass = {5, 1, 0.5}},
          {"Hinge.inertia = 1e-09 [kg m2]", "at least mass times the square", "0.5 kg m2"});
  CHECK_NOTHROW(silt::detail::check_drive(Hinge{.centre = {0, 0, 0},  // a point mass
                                                .axis = {0, 1, 0},
                                                .inertia = 0.3 * 0.7 * 0.7,
                                                .mass = 0.3,
                                                .centre_of_mass = {0.7, 0, 0}}));
  refused(silt::ServoForce{.direction = {0, 0, 1}, .force = nan, .max_speed = 1},
          {"ServoForce.force"});
  refused(silt::ServoForce{.direction = {0, 0, 1}, .force = 1, .max_speed = 0},
          {"ServoForce.max_speed"});
  refused(silt::ServoForce{.direction = {0, 0, 1}, .force = 1, .max_speed = 1, .gain = 3},
          {"ServoForce.gain = 3 [-] must be in (0, 1]"});
  refused(silt::ServoTorque{.centre = {}, .axis = {0, 0, 1}, .torque = 1, .max_rate = -1},
          {"ServoTorque.max_rate"});
  const silt::Symmetric3 round{.xx = 1, .yy = 1, .zz = 1}, flat{.xx = 1, .yy = 1, .zz = 3};
  refused(FreeBody{.mass = 1, .inertia = round, .centre = {}}, {"FreeBody", "finite size"});
  refused(FreeBody{.mass = 0, .inertia = round, .centre = {}}, {"FreeBody.mass"});
  refused(FreeBody{.mass = 1, .inertia = flat, .centre = {}}, {"FreeBody.inertia", "moments"});
  CHECK(has_words(refusal<silt::InputError>([&] {
                    sim.add_wall(floor, elastic,
                                 {.motion = silt::translation({0, 0, 1}),
                                  .drive = Slide{.direction = {0, 0, 1}, .mass = 1}});
                  }),
                  {"either a motion or a drive"}));
  CHECK(has_words(refusal<silt::InputError>([&] {
                    silt::free_body(silt::open_box({0, 0, 0}, {1, 1, 1}), 1000);
                  }),
                  {"free_body", "not closed"}));
  const auto cube = silt::box_mesh({0, 0, 0}, {1, 1, 1});
  std::vector<std::array<Vec3d, 3>> doubled;
  for (int copy = 0; copy < 2; ++copy)
    for (const auto& [a, b, c] : cube.triangles())
      doubled.push_back({cube.vertices()[a], cube.vertices()[b], cube.vertices()[c]});
  CHECK(has_words(
      refusal<silt::InputError>([&] { silt::free_body(silt::TriangleMesh(doubled), 1000); }),
      {"free_body: the mesh holds 12 triangles twice", "remove the copies"}));
  CHECK(sim.walls() == 0);  // none of them left anything
}

TEST_CASE("free walls: one too light for its contacts stops the run, and is named") {
  silt::Particles<Sphere> p;
  for (int k = 0; k < 400; ++k)
    p.add(
        {.position = {0.02 * (k % 20), 0.02 * (k / 20), 0.0095}, .radius = 0.01, .density = 2500});
  auto sim = scene(std::move(p));
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, elastic);
  sim.add_wall(silt::Plane{{0, 0, 0.019}, {0, 0, -1}}, elastic,
               {.name = "foil", .drive = Slide{.direction = {0, 0, 1}, .mass = 0.01}});
  const auto words = refusal<silt::SimulationError>([&] { sim.run(0.01); });
  CHECK(has_words(words, {"wall 1 'foil' is too light for its contacts", "Simulation::time_step"}));
}

}  // namespace free_walls_test
