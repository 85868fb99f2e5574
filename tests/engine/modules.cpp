// silt - BSD-3-Clause, see LICENSE
// Modules: forces of one's own against closed forms, fields through sorts, checkpoints and files,
// what is refused. Bodies and spheres alike.
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>

#include <engine/support.hpp>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/linear_spring.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/observers.hpp>
#include <silt/io/particle_csv.hpp>
#include <silt/module/body_force.hpp>
#include <silt/shape/super_ellipsoid.hpp>

#include "near.hpp"

namespace modules_test {

using namespace engine_test;
namespace fs = std::filesystem;

/// A folder of this test's own, removed with all in it.
struct Folder {
  std::string path = (fs::temp_directory_path() / "silt_modules_XXXXXX").string();
  Folder() { REQUIRE(::mkdtemp(path.data()) != nullptr); }
  ~Folder() { fs::remove_all(path); }
  std::string operator/(const std::string& name) const { return path + "/" + name; }
};
using silt::Quaternion;
using silt::Seen;
using silt::Vec3d;

const silt::LinearSpring::Material spring{.stiffness = 10};

/// One sphere of 1 g, or a body of one, and modules.
template <class... Modules>
auto one_sphere(const Vec3d& velocity, const Modules&... modules) {
  silt::Particles<silt::Sphere> p;
  p.add({.position = {0, 0, 0},
         .radius = 1e-3,
         .density = 1e-3 / silt::sphere_volume(1e-3),
         .velocity = velocity});
  return silt::Simulation{std::move(p), silt::Contacts<silt::LinearSpring>{spring}, modules...};
}
const silt::HertzMindlin::Material granite{.youngs_modulus = 1e7, .poisson_ratio = 0.3};
template <class... Modules>
auto one_ellipsoid(const Vec3d& velocity, const Modules&... modules) {
  silt::Particles<silt::SuperEllipsoid> p;
  p.add_form(silt::SuperEllipsoid{.a = 2e-3, .b = 1.5e-3, .c = 1e-3});
  p.add({.position = {0, 0, 0}, .density = 1000, .velocity = velocity});
  return silt::Simulation{std::move(p), silt::Contacts<silt::HertzMindlin>{granite}, modules...};
}

/// Counts how long a particle has been in a box.
struct Residence {
  silt::Box region;
  struct Fields {
    double seconds = 0;
  };
  static constexpr std::array names{"seconds"};
  void update(const Seen& p, Fields& f, double dt) const {
    if (region.contains(p.position)) f.seconds += dt;
  }
};

/// A spring to the origin that says how stiff it is.
struct Trap {
  double stiffness;  // [N/m]
  Vec3d force(const Seen& p) const { return -stiffness * p.position; }
  double rate(const Seen& p) const { return std::sqrt(stiffness / p.mass); }
  static constexpr bool needs_velocity = false;
};

struct Grows {
  struct Fields {
    double size = 1;
  };
  static constexpr std::array names{"size"};
  void update(const Seen&, Fields& f, double) const { f.size *= 1e10; }
};

}  // namespace modules_test

using namespace modules_test;

// Catches a force that is added twice or not at all, of the step before, or over the wrong mass.
TEST_CASE("modules: a trap swings with its frequency and keeps its energy") {
  const double omega = std::sqrt(4.0 / 1e-3);  // [1/s]
  const auto check = [omega](auto sim, double dt) {
    sim.time_step = dt;
    sim.run(1.0);
    const double t = sim.time();
    // Leapfrog's frequency is larger by (omega dt)^2/24.
    const double phase = 2 / dt * std::asin(0.5 * omega * dt) * t;
    CHECK(sim.position(0).x == near(0.1 / omega * std::sin(phase)).epsilon(2e-4));
    return std::abs(sim.position(0).x - 0.1 / omega * std::sin(omega * t));
  };
  const double coarse = check(one_sphere({0.1, 0, 0}, Trap{4}), 2e-4);
  const double fine = check(one_sphere({0.1, 0, 0}, Trap{4}), 1e-4);
  CHECK(coarse / fine == near(4).epsilon(0.02));  // second order

  auto books = one_sphere({0.1, 0, 0}, Trap{4}, silt::EnergyLedger{});
  books.time_step = 1e-4;
  books.run(0.1);
  const auto e = books.energy();
  const double start = 0.5e-3 * 0.01;  // [J]
  CHECK(e.modules == near(-2 * dot(books.position(0), books.position(0))).epsilon(1e-4));
  CHECK(std::abs(e.residual()) < 1e-5 * start);
}

// Catches velocities that are half a step old in the force: the orbit of a charge in a magnetic
// field then grows by half of omega dt each radian; with the force's own velocity it must not.
TEST_CASE("modules: a charge in a magnetic field keeps its speed, as a sphere and as a body") {
  const Vec3d B{0, 0, 2};             // [T]
  const double q = 0.05;              // [C]
  const double omega = q * 2 / 1e-3;  // [1/s] of 1 g: 100
  const auto orbit = [&](auto sim, double of) {
    sim.template field<"charge">(0) = q;
    sim.time_step = 0.05 / of;  // 126 steps a turn
    sim.run(20 * std::numbers::pi / of);
    CHECK(norm(sim.velocity(0)) == near(0.1).epsilon(1e-6));
    // The middle of ten orbits is where the first has it: no drift.
    CHECK(std::abs(sim.position(0).x) < 0.05 * 0.1 / of);
  };
  const auto magnet = [B](const Seen& p, double charge) { return charge * cross(p.velocity, B); };
  orbit(one_sphere({0.1, 0, 0}, silt::BodyForce{silt::Field<"charge">{}, magnet}), omega);
  auto body = one_ellipsoid({0.1, 0, 0}, silt::BodyForce{silt::Field<"charge">{}, magnet});
  orbit(std::move(body), q * 2 / one_ellipsoid({0, 0, 0}).mass(0));
}

// Catches drag that is taken at the velocity of half a step ago: first order instead of second.
TEST_CASE("modules: Stokes' drag under gravity, to second order") {
  const double tau = 0.02;  // [s]
  const auto error = [tau](double dt) {
    auto sim = one_sphere(
        {0, 0, 0}, silt::BodyForce{[tau](const Seen& p) { return (-p.mass / tau) * p.velocity; }});
    sim.gravity = {0, 0, -9.81};
    sim.time_step = dt;
    sim.run(0.05);
    return std::abs(sim.velocity(0).z + 9.81 * tau * (1 - std::exp(-sim.time() / tau)));
  };
  CHECK(error(1e-3) < 1e-3 * 9.81 * tau);
  CHECK(error(1e-3) / error(5e-4) == near(4).epsilon(0.15));
}

// Catches a torque that is left out, or turned into another frame, or counted over the radius.
TEST_CASE("modules: a torque turns spheres and bodies by their inertia") {
  const auto twist = silt::BodyForce{[](const Seen&) {
    return silt::Push{{0, 0, 0}, {0, 0, 1e-9}};
  }};
  silt::Particles<silt::Sphere> p;
  p.add({.position = {0, 0, 0}, .radius = 1e-3, .density = 1000});
  silt::Simulation ball{std::move(p), silt::Contacts<silt::HertzMindlin>{granite}, twist};
  ball.time_step = 5e-5;
  ball.run(0.1);
  const double I = 0.4 * ball.mass(0) * 1e-6;
  CHECK(ball.angular_velocity(0).z == near(1e-9 / I * 0.1).epsilon(1e-9));

  auto body = one_ellipsoid({0, 0, 0}, twist);
  body.time_step = 5e-5;
  body.run(0.1);
  const double of_body = body.mass(0) / 5 * (4e-6 + 2.25e-6);
  CHECK(body.angular_velocity(0).z == near(1e-9 / of_body * 0.1).epsilon(1e-6));
}

// Catches fields that stay in place while particles are sorted, that a checkpoint loses or that
// depend on threads or on who looks.
TEST_CASE("modules: fields go with their particles, through sorts, checkpoints and observers") {
  using silt::Particles, silt::Sphere;
  const auto make = [](int threads) {
    Particles<Sphere> p;
    p.fill({{0, 0, 0}, {0.02, 0.02, 0.04}},
           {.radius = silt::uniform(0.8e-3, 1.2e-3), .density = 2500, .count = 600});
    silt::Simulation sim{std::move(p), silt::Contacts<silt::HertzMindlin>{granite},
                         Residence{{{0, 0, 0}, {0.02, 0.02, 0.005}}},
                         silt::Field<"origin", Vec3d>{}, silt::Field<"colour">{.initial = 7}};
    sim.add_wall(silt::box({0, 0, 0}, {0.02, 0.02, 0.05}), granite);
    sim.gravity = {0, 0, -9.81};
    sim.threads = threads;
    for (std::size_t k = 0; k < sim.rows(); ++k) {
      CHECK(sim.template field<"colour">(k) == 7);
      sim.template field<"colour">(k) = static_cast<double>(sim.id(k));
      sim.template field<"origin">(k) = sim.position(k);
    }
    return sim;
  };
  auto sim = make(1);
  std::vector<double> inside(sim.size(), 0);  // [s] counted from outside, after each step
  std::size_t moved = 0;
  sim.run(0.06, [&](const auto& s) {
    if (s.step() == 0) return;
    for (std::size_t k = 0; k < s.rows(); ++k)
      if (s.template module<Residence>().region.contains(s.position(k)))
        inside[s.id(k)] += s.step_length();
  });
  double longest = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    CHECK(sim.field<"colour">(k) == static_cast<double>(sim.id(k)));
    CHECK(std::abs(sim.field<Residence>(k).seconds - inside[sim.id(k)]) < 1e-12);
    longest = std::max(longest, inside[sim.id(k)]);
    moved += sim.id(k) != k;
  }
  CHECK(moved > 300);  // they were sorted
  CHECK(longest > 0.02);

  const Folder folder;
  auto half = make(2);
  half.run(0.03);
  silt::save_checkpoint(half, folder / "half.silt");
  auto again = make(3);
  silt::load_checkpoint(again, folder / "half.silt");
  again.run(0.03), half.run(0.03);
  for (std::size_t k = 0; k < half.rows(); ++k) {
    const std::size_t other = again.find(half.id(k));
    CHECK(again.field<Residence>(other).seconds == half.field<Residence>(k).seconds);
    CHECK(again.field<"origin">(other).x == half.field<"origin">(k).x);
  }
}

// Catches particles that come later without their first values, and those that leave with others'.
TEST_CASE("modules: fields of particles that an inlet brings") {
  struct Born {
    struct Fields {
      double at = -1;
    };
    Fields start(const Seen& p) const { return {p.time}; }
  };
  auto sim = one_sphere({1, 0, 0}, Born{});  // out of the way
  sim.time_step = 1e-4;
  sim.add_inlet(silt::Box{{-0.01, -0.01, 0.1}, {0.01, 0.01, 0.12}},
                {.radius = 1e-3, .density = 1000, .rate = 500, .velocity = {0, 0, -1}});
  sim.add_outlet({{-1, -1, -0.2}, {1, 1, -0.1}});
  sim.run(0.5);
  CHECK(sim.size() > 50);
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k) && sim.id(k) > 0) {
      const double age = sim.time() - sim.field<Born>(k).at;  // it fell with 1 m/s since
      CHECK(sim.position(k).z + age > 0.1);
      CHECK(sim.position(k).z + age < 0.121);
    }
}

// Catches fields that are written in the order of places, not of ids, or under another's name.
TEST_CASE("modules: fields in VTK and CSV files, under their names") {
  const Folder folder;
  auto sim = one_sphere({0, 0, 0}, silt::Field<"charge">{.initial = 3},
                        silt::Field<"pull", Vec3d>{}, Residence{{{-1, -1, -1}, {1, 1, 1}}});
  sim.time_step = 1e-4;
  sim.run(1e-4, silt::vtk_series(folder / "out", silt::every(1e-4)));
  std::string all;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "out"))
    if (entry.path().extension() == ".vtp") {
      std::ifstream in(entry.path(), std::ios::binary);
      all.append(std::istreambuf_iterator<char>(in), {});
    }
  for (const char* name : {"Name=\"charge\"", "Name=\"pull\"", "Name=\"seconds\""})
    CHECK(all.find(name) != all.npos);

  silt::write_particle_csv(folder / "all.csv", sim);
  std::ifstream in(folder / "all.csv");
  std::string header, row;
  std::getline(in, header), std::getline(in, row);
  CHECK(header ==
        "id,x,y,z,velocity x,velocity y,velocity z,radius,material,charge,pull x,pull y,pull z,"
        "seconds");
  CHECK(row == "0,0,0,0,0,0,0,0.001,0,3,0,0,0,1e-04");
}

TEST_CASE("modules: what is not finite or not resolved stops the run, by name") {
  const auto sentence = [](auto sim, double dt) {
    sim.time_step = dt;
    return refusal<silt::SimulationError>([&] { sim.run(0.1); });
  };
  CHECK(has_words(sentence(one_sphere({1, 0, 0}, silt::BodyForce{[](const Seen& p) {
                                        return Vec3d{p.position.x > 0.05 ? NAN : 0.0, 0, 0};
                                      }}),
                           1e-4),
                  {"the force of the module BodyForce on particle 0", "mend its force()"}));
  CHECK(has_words(sentence(one_sphere({1, 0, 0}, Grows{}), 1e-4),
                  {"the field 'size' of the module Grows became inf", "mend its update()"}));
  // omega dt = 2 at the limit of stability; the guard's 1.25 comes before it.
  CHECK(has_words(sentence(one_sphere({1, 0, 0}, Trap{4e4}), 1.3 / std::sqrt(4e4 / 1e-3)),
                  {"the modules' rate of particle 0", "guard.max_rate", "time_step to less than"}));
}

TEST_CASE("modules: a field without an update that is set to NaN stops the run, by name") {
  // Else checkpoints would be written that cannot be read.
  auto sim = one_sphere({1, 0, 0}, silt::Field<"q">{2});
  sim.time_step = 1e-4;
  const std::initializer_list<std::string> words{"the field 'q' of particle 0", "is nan",
                                                 "must be finite", "has set it"};
  CHECK(has_words(refusal<silt::SimulationError>([&] {
                    sim.run(0.01, silt::at(silt::every(1e-3), [](auto& s) {
                              if (s.time() > 0.004) s.template field<"q">(0) = NAN;
                            }));
                  }),
                  words));
  auto again = one_sphere({1, 0, 0}, silt::Field<"q">{2});
  again.time_step = 1e-4;
  again.run(0.001);
  again.field<"q">(0) = NAN;
  CHECK(has_words(refusal<silt::SimulationError>([&] { again.run(0.001); }), words));
  again.field<"q">(0) = 3;
  again.run(0.001);
  CHECK(again.field<"q">(0) == 3);
}

struct Follows {
  double speed = 1;  // [1/s]
  std::size_t flux_every = 10;
  struct Fields {
    double value = 0;
  };
  static constexpr std::array names{"value"};
  static constexpr auto exchanged = &Fields::value;
  template <class Real>
  Real flux(const silt::Touching<Real>&, const Real& a, const Real& b) const {
    return b - a;
  }
  void update(const Seen&, Fields& f, double received, double dt) const {
    f.value += received * dt;
  }
  double rate(const Seen&) const { return speed; }
};
// Catches limits that a rate of NaN lifts, a step of 0 s that is proposed, and an interval of 0.
TEST_CASE("modules: a rate that is not a number or below 0, and no interval, are refused by name") {
  const auto sentence = [](auto module) {
    auto sim = one_sphere({1, 0, 0}, module);
    sim.time_step = 1e-4;
    return refusal<silt::InputError>([&] { sim.run(0.01); });
  };
  for (const double wrong : {double{NAN}, -1.0, double{INFINITY}})
    CHECK(has_words(sentence(Follows{.speed = wrong}),
                    {"the rate() of the module Follows is ", " 1/s for particle 0 at (",
                     "finite and at least 0: mend its rate()"}));
  CHECK(has_words(sentence(Follows{.flux_every = 0}), {"Follows.flux_every = 0 [steps]"}));
}
// Catches a step of 0 s for an impact at a speed of inf.
TEST_CASE("modules: a force that is infinite is named before the time step is chosen") {
  const auto pushed = [](const Seen&) { return Vec3d{INFINITY, 0, 0}; };
  auto sim = one_sphere({1, 0, 0}, silt::BodyForce{pushed});
  CHECK(has_words(
      refusal<silt::SimulationError>([&] { sim.run(0.01); }),
      {"the force of the module BodyForce on particle 0", "is (inf, 0, 0) N", "mend its force()"}));
}

// Catches a header with more columns than the rows have numbers.
TEST_CASE("modules: a table of particles refuses names of fields that would be two columns") {
  const auto file = (std::filesystem::temp_directory_path() / "silt_field_names.csv").string();
  std::filesystem::remove(file);
  const auto sentence = [&](auto field) {
    const auto sim = one_sphere({1, 0, 0}, field);
    return refusal<silt::InputError>([&] { silt::write_particle_csv(file, sim); });
  };
  CHECK(has_words(sentence(silt::Field<"wet, dry">{}),
                  {"the column name 'wet, dry' must not contain commas"}));
  CHECK(has_words(sentence(silt::Field<"radius">{}), {"two columns named 'radius'"}));
  CHECK_FALSE(std::filesystem::exists(file));
}

// The trap is what makes the time step short, where contacts are soft.
TEST_CASE("modules: the time step that silt chooses resolves what modules push with") {
  auto sim = one_sphere({0.1, 0, 0}, Trap{4e4});
  sim.add_wall(silt::Plane{{0, 0, -1}, {0, 0, 1}}, spring);
  sim.run(0);
  CHECK(sim.step_length() == near(std::numbers::pi / 20 / std::sqrt(4e4 / 1e-3)).epsilon(1e-12));
}
