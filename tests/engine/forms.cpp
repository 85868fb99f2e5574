// silt - BSD-3-Clause, see LICENSE
#include <memory>
#include <utility>
#include <vector>

#include <silt/silt.hpp>

#include <doctest/doctest.h>

namespace forms_test {

namespace {

using namespace silt;

constexpr HertzMindlin::Material stone{
    .youngs_modulus = 5e7, .poisson_ratio = 0.25, .restitution = 0.6, .friction = 0.4};

/// Spheres that count their copies.
struct Counted {
  static constexpr bool is_body = true;
  static inline int copies = 0;
  MultiSphere spheres;

  explicit Counted(double length)
      : spheres{.balls = {{{-length, 0, 0}, 1e-3}, {{length, 0, 0}, 1e-3}}} {}
  Counted(const Counted& from) : spheres(from.spheres) { ++copies; }
  Counted(Counted&&) noexcept = default;
  Counted& operator=(const Counted&) = default;
  bool operator==(const Counted&) const = default;
  void check() const { spheres.check(); }
  MassProperties mass_properties() const { return spheres.mass_properties(); }
  std::vector<Ball> parts() const { return spheres.parts(); }
};
/// The same without operator==.
struct Unequal : Counted {
  using Counted::Counted;
  bool operator==(const Unequal&) const = delete;
};

Particles<Counted> at(double x, double length) {
  Particles<Counted> one;
  one.add_form(Counted(length));
  one.add({.form = 0, .position = {x, 0, 0}, .density = 2500});
  return one;
}

}  // namespace

TEST_CASE("forms: what is added again shares the forms that are there") {
  const Particles<Counted> first = at(0, 1e-3);
  Simulation sim{first, Contacts<HertzMindlin>{stone}};
  Particles<Counted> again = first;
  // As the same object, and as forms that are only equal.
  for (int k = 1; k <= 100; ++k) {
    again[0].position.x = 0.01 * k;
    CHECK(sim.add(again) == std::vector<std::size_t>{0});
    CHECK(sim.add(at(-0.01 * k, 1e-3)) == std::vector<std::size_t>{0});
  }
  CHECK(sim.forms().size() == 1);
  CHECK(sim.size() == 201);
  // Others come after them, and particles keep theirs.
  Particles<Counted> both;
  both.add_form(Counted(0.5e-3)), both.add_form(Counted(1e-3)), both.add_form(Counted(0.8e-3));
  for (std::size_t form = 0; form < 3; ++form)
    both.add({.form = form, .position = {0, 0.1, 0.01 * double(form)}, .density = 2500});
  CHECK(sim.add(both) == std::vector<std::size_t>{1, 0, 2});
  CHECK(sim.add(both) == std::vector<std::size_t>{1, 0, 2});
  CHECK(sim.forms().size() == 3);
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const auto id = sim.id(k);
    const std::size_t wanted = id < 201 ? 0 : std::vector<std::size_t>{1, 0, 2}[(id - 201) % 3];
    CHECK(sim.form(k) == wanted);
    CHECK(sim.radius(k) == sim.forms()[wanted].radius);
  }
}

TEST_CASE("forms: those that a simulation starts with keep their numbers, also equal ones") {
  Particles<Counted> twins;
  for (int k = 0; k < 3; ++k) twins.add_form(Counted(k == 2 ? 0.5e-3 : 1e-3));
  for (std::size_t form = 0; form < 3; ++form)
    twins.add({.form = form, .position = {0.01 * double(form), 0, 0}, .density = 2500});
  Simulation sim{twins, Contacts<HertzMindlin>{stone}};
  CHECK(sim.forms().size() == 3);
  for (std::size_t k = 0; k < 3; ++k) CHECK(sim.form(sim.find(static_cast<std::uint32_t>(k))) == k);
  sim.add(twins);
  CHECK(sim.forms().size() == 3);
}

TEST_CASE("forms: without operator== copies of a form are one, and made twice they are two") {
  Particles<Unequal> a, b;
  a.add_form(Unequal(1e-3)), b.add_form(Unequal(1e-3));
  const BodyForm<Unequal> copy = a.forms()[0];
  CHECK(copy.is(a.forms()[0]));
  CHECK_FALSE(b.forms()[0].is(a.forms()[0]));
  const Particles<Counted> c = at(0, 1e-3), d = at(1, 1e-3), e = at(1, 0.9e-3);
  CHECK(c.forms()[0].is(d.forms()[0]));
  CHECK_FALSE(c.forms()[0].is(e.forms()[0]));
  // A vector of forms that grows must not copy them: narrow phases keep addresses of their parts.
  static_assert(std::is_nothrow_move_constructible_v<BodyForm<Polyhedron>>);
  static_assert(std::is_nothrow_move_constructible_v<BodyForm<Compound<Polyhedron>>>);
  static_assert(std::is_nothrow_move_constructible_v<BodyForm<Mix<Sphere, Polyhedron>>>);
}

TEST_CASE("forms: an inlet copies none") {
  Particles<Counted> kinds;
  for (int k = 0; k < 20; ++k) kinds.add_form(Counted(1e-3 - 1e-5 * k));
  Simulation sim{kinds, Contacts<HertzMindlin>{stone}};
  sim.gravity = {0, 0, -9.81};
  sim.threads = 1, sim.time_step = 5e-6;
  const Box region{{0, 0, 0.05}, {0.02, 0.02, 0.056}};
  for (std::size_t form : {3, 7})
    sim.add_inlet(region, {.radius = uniform(1e-3, 1.1e-3),
                           .density = 2500,
                           .rate = 1000,
                           .velocity = {0, 0, -1},
                           .interval = 5e-3,
                           .form = form});
  Counted::copies = 0;
  sim.run(0.02);
  CHECK(sim.inlet(0).insertions + sim.inlet(1).insertions >= 8);
  CHECK(sim.size() > 20);
  CHECK(Counted::copies == 0);
  for (std::size_t k = 0; k < sim.rows(); ++k) CHECK((sim.form(k) == 3 || sim.form(k) == 7));
}

TEST_CASE("forms: a scene of one form keeps its one row when more of it come") {
  const auto grains = [](double x, double a) {
    Particles<SuperEllipsoid> all;
    all.add_form({.a = a, .b = 1e-3, .c = 1e-3});
    all.add({.form = 0, .position = {x, 0, 0}, .density = 2500});
    return all;
  };
  Simulation sim{grains(0, 2e-3), Contacts<HertzMindlin>{stone}};
  sim.threads = 1, sim.time_step = 1e-6;
  for (int k = 1; k < 4; ++k) sim.add(grains(0.01 * k, 2e-3));
  sim.run(2e-6);
  CHECK(sim.engine().mover.convex_rows.one_form());
  sim.add(grains(0.1, 1.5e-3));
  sim.run(2e-6);
  CHECK_FALSE(sim.engine().mover.convex_rows.one_form());
}

}  // namespace forms_test
