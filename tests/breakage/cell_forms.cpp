// silt - BSD-3-Clause, see LICENSE
// Forms of fragments of polyhedra: as many as fragments live, behind those that users added.
#include <vector>

#include <doctest/doctest.h>

#include <silt/shape/laguerre_cells.hpp>
#include <silt/shape/polyhedron.hpp>

#include "breakage/scene.hpp"
#include "breakage/stones.hpp"
#include "refusal.hpp"

namespace breakage_cell_forms_test {

using namespace breakage_scene;  // NOLINT: of this test alone
using silt_test::has, silt_test::refusal;
using Stones = silt::Particles<silt::Polyhedron>;

Stones::Particle one(std::size_t form, double x) {
  Stones::Particle p{};
  p.form = form, p.position = {x, 0, 0}, p.density = 2165;
  return p;
}
auto simulation_of(Stones stones) {
  silt::Simulation sim{std::move(stones), silt::Contacts<silt::HertzMindlin>{salt},
                       silt::EnergyLedger{}, policy({.dust_below = 3e-4})};
  sim.time_step = 5e-8;
  return sim;
}
template <class Sim>
std::vector<silt::ParticleId> all_ids(const Sim& sim) {
  std::vector<silt::ParticleId> ids;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k)) ids.push_back(sim.id(k));
  return ids;
}
/// Of each body: its form's volume, and the mass that it must have.
template <class Sim>
bool forms_fit(const Sim& sim) {
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k)) {
      const auto& form = sim.forms()[sim.form(k)];
      const double scale = sim.scale(k), volume = form.mass.volume * scale * scale * scale;
      if (std::abs(sim.mass(k) - 2165 * volume) > 1e-12 * sim.mass(k)) return false;
      // What contacts take is the form's, in its size.
      const auto& mover = sim.engine().mover;
      const std::size_t row = mover.rows_of(mover.bodies[k]).front();
      const auto* const shape = mover.convex_rows.form_row(row)
                                    .template get<silt::KernelOf<silt::Polyhedron>::Row>()
                                    .shape;
      if (shape->core_volume() !=
          std::get<silt::Polyhedron>(form.solids[0].solid).scaled(scale).core_volume())
        return false;
    }
  return true;
}

TEST_CASE("breakage: as many forms as fragments at one time, round after round") {
  Stones stones;
  stones.add_form(stone(9), "stone");
  auto sim = simulation_of(stones);
  std::size_t most_living = 0, most_forms = 0, made = 0;
  for (int round = 0; round < 12; ++round) {
    Stones more;
    more.add_form(stones.forms()[0].shape);
    more.add(one(0, 0)), more.add(one(0, 0.01));
    CHECK(sim.add(more) == std::vector<std::size_t>{0});
    for (int generation = 0; generation < 2; ++generation) {
      const auto parents = all_ids(sim);
      for (const auto id : parents) sim.break_particle(id);
      sim.run(1e-7);
      REQUIRE(sim.size() > 10);
      made += sim.size();
      // Parents stay in the tables until the lists are made anew.
      most_living = std::max(most_living, sim.size() + parents.size());
      most_forms = std::max(most_forms, sim.forms().size());
      // Each fragment has a form of its own.
      std::vector<int> uses(sim.forms().size(), 0);
      for (std::size_t k = 0; k < sim.rows(); ++k)
        if (sim.is_present(k)) ++uses[sim.form(k)];
      CHECK(uses[0] == 0);
      CHECK(*std::max_element(uses.begin(), uses.end()) == 1);
      CHECK(forms_fit(sim));
    }
    for (const auto id : all_ids(sim)) sim.remove(id);
    sim.run(1e-7);
  }
  CHECK(made > 10 * most_living);
  CHECK(most_forms <= most_living + 1);
  CHECK(sim.form_name(0) == "form 0 'stone'");
}

TEST_CASE("breakage: forms that come later stand before those of fragments, and stay") {
  Stones stones;
  stones.add_form(stone(9), "stone");
  stones.add(one(0, 0));
  auto sim = simulation_of(stones);
  sim.run(1e-7);
  sim.break_particle(0);
  sim.run(1e-7);
  const std::size_t fragments = sim.size();
  REQUIRE(fragments > 5);
  REQUIRE(sim.forms().size() == fragments + 1);
  std::vector<double> volumes;
  for (std::size_t f = 1; f <= fragments; ++f) volumes.push_back(sim.forms()[f].mass.volume);

  Stones later;
  later.add_form(stone(4), "late"), later.add_form(stone(9)), later.add_form(stone(5));
  // The shape of a fragment that a user adds is a form of its own, which does not go with it.
  later.add_form(sim.forms()[2].shape, "splinter");
  later.add(one(3, 0.02));
  CHECK(sim.add(later) == std::vector<std::size_t>{1, 0, 2, 3});
  CHECK(sim.forms().size() == fragments + 4);
  for (std::size_t f = 0; f < fragments; ++f) CHECK(sim.forms()[f + 4].mass.volume == volumes[f]);
  sim.run(1e-7);
  CHECK(forms_fit(sim));

  const std::size_t of_fragment = sim.form(sim.find(1));
  CHECK(of_fragment >= 4);
  has(refusal([&] { sim.name_form(of_fragment, "mine"); }),
      "Simulation::name_form: form 4 is that of a fragment, and goes with it");
  has(refusal([&] {
        sim.add_inlet(
            {{-1, -1, -1}, {-0.9, -0.9, -0.9}},
            {.radius = silt::uniform(1e-3, 2e-3), .density = 1, .rate = 1, .form = of_fragment});
      }),
      "InletFlow.form = 4 is none of the 4 forms of the simulation");
  // A body may take the form of a fragment; it stays as long as one of both is there.
  const auto splinter = all_ids(sim).back();
  sim.set_form(splinter, of_fragment);
  sim.remove(1);
  sim.run(1e-7);
  for (const auto id : all_ids(sim))
    if (id != splinter) sim.remove(id);
  CHECK(sim.form(sim.find(splinter)) == of_fragment);
  Stones again;
  again.add_form(stone(9));
  again.add(one(0, 0.05));
  sim.add(again);
  sim.run(1e-7);
  sim.break_particle(all_ids(sim).back());
  sim.run(1e-7);
  CHECK(sim.form(sim.find(splinter)) == of_fragment);
  CHECK(sim.forms()[of_fragment].mass.volume == volumes[0]);
  CHECK(forms_fit(sim));
  CHECK(sim.find_form("late") == 1);
  CHECK(sim.find_form("splinter") == 3);
  CHECK(sim.forms()[3].mass.volume == volumes[1]);
}

}  // namespace breakage_cell_forms_test
