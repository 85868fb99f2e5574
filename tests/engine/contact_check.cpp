// silt - BSD-3-Clause, see LICENSE
// The check that can be switched on: it sees a search that loses contacts, and changes nothing.
#include <engine/mixed_scene.hpp>

#include <silt/search/cell_grid.hpp>
#include <silt/simulation/contact_check.hpp>

namespace contact_check_test {

namespace {

using namespace engine_test;

/// A cell grid that forgets one pair from the third search on.
struct Forgetful {
  silt::CellGrid grid = {};
  int searches = 0;
  template <class Domain>
  void find(const silt::SphereSet& spheres, double reach, const Domain& domain,
            const silt::Team& team, std::vector<silt::IndexPair>& pairs) {
    grid.find(spheres, reach, domain, team, pairs);
    if (++searches >= 3 && !pairs.empty()) pairs.erase(pairs.begin());
  }
};

template <class Search>
auto two_spheres(const Search& search) {
  silt::Particles<Sphere> p;
  p.add({.position = {0, 0, 0}, .radius = 1e-3, .density = 2500});
  p.add({.position = {2.01e-3, 0, 0}, .radius = 1e-3, .density = 2500, .velocity = {-0.5, 0, 0}});
  silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}, search};
  sim.time_step = 2e-6;
  sim.threads = 1;
  return sim;
}

}  // namespace

TEST_CASE("contact_check: a search that loses a contact is named at the step of its first miss") {
  auto sim = two_spheres(Forgetful{});
  silt::ContactCheck check;
  const auto sentence = refusal<silt::SimulationError>([&] { sim.run(1e-3, check); });
  CHECK(has_words(sentence, {"particles 0 and 1 touch near", "has not listed them", "step 1"}));
  CHECK(sim.step() >= 10);  // they touch after 1e-5 m at 0.5 m/s: 10 steps
  CHECK(sim.step() <= 11);
}

TEST_CASE("contact_check: a run that is checked at every step gives the same bits, and no error") {
  auto plain = mixed_scene(), checked = mixed_scene();
  silt::ContactCheck check;
  plain.run(0.01);
  checked.run(0.01, check);
  CHECK(check.contacts() > 1000);
  CHECK(bits(checked) == bits(plain));
}

TEST_CASE("contact_check: two fixed particles that overlap are no contact") {
  silt::Particles<Sphere> p;
  p.add({.position = {0, 0, 0}, .radius = 1e-3, .density = 2500, .fixed = true});
  p.add({.position = {1e-3, 0, 0}, .radius = 1e-3, .density = 2500, .fixed = true});
  p.add({.position = {0, 0, 2.5e-3}, .radius = 1e-3, .density = 2500, .velocity = {0, 0, -0.5}});
  silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}, silt::VerletList<>{}};
  sim.time_step = 2e-6;
  silt::ContactCheck check;
  sim.run(2e-3, check);
  CHECK(check.contacts() > 1000);
}

}  // namespace contact_check_test
