// silt - BSD-3-Clause, see LICENSE
//
// Bodies on many ranks that are given another form, in observers and between two runs; beside
// others that come and leave.
#include <silt/shape/mix.hpp>
#include <silt/shape/multi_sphere.hpp>
#include <silt/shape/polyhedron.hpp>
#include <silt/shape/super_ellipsoid.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <silt/io/checkpoint.hpp>
#include <silt/io/contact_observers.hpp>
#include <silt/module/field.hpp>

#include "body_scenes.hpp"
#include "near.hpp"

namespace parallel_forms_test {

namespace {

using silt::ParticleId;
using silt_test::Seen;

auto ranks(const silt::ThreadComm& comm) {
  return silt_test::wandering(comm, silt_test::slide_length);
}

/// What is left, put together by the ranks.
struct Outcome {
  Seen seen;
  std::map<ParticleId, std::array<double, 3>> kinds;  // form, mass [kg], age
  std::vector<double> counts;                         // [-]
  std::vector<double> energies;                       // [J]
  double turned_over = 0;                             // [J]
  std::atomic<std::int64_t> changed_at{-1};           // step
  std::vector<std::array<double, 3>> ended;           // contacts: ids, step of the end
  std::vector<ParticleId> parts;                      // ids of rows
  std::atomic<int> across{0};                         // contacts of changed bodies with ghosts
  silt_test::Copies copies;
  std::mutex mutex;
};
template <class Sim>
void look(Sim& sim, Outcome& out) {
  std::vector<double> counts{static_cast<double>(sim.size())};
  // On ranks the contacts of bodies of another form begin with the search of the next step.
  if (sim.step() != out.changed_at) counts.push_back(static_cast<double>(sim.touching_pairs()));
  const auto energy = sim.energy();
  const double mass = sim.total_mass();
  if (sim.rank() != 0) return;
  out.counts.insert(out.counts.end(), counts.begin(), counts.end());
  const auto books =
      std::bit_cast<std::array<double, sizeof(silt::EnergyBalance) / sizeof(double)>>(energy);
  out.energies.insert(out.energies.end(), books.begin(), books.end());
  out.energies.push_back(mass), out.turned_over = energy.turned_over;
}
template <class Sim>
void change(Sim& sim, ParticleId id, std::size_t form, Outcome& out) {
  const auto& e = sim.engine();
  if constexpr (Sim::has_ranks)
    e.lists.pairs.for_each([&](std::size_t k) {
      const std::uint32_t a = e.lists.pairs.first()[k], b = e.lists.pairs.second()[k];
      out.across += e.lists.pairs.remembers(k) && std::max(a, b) >= e.particles.owned() &&
                    e.id_of(std::min(a, b)) == id;
    });
  sim.set_form(id, form);
}
/// Changes in the order of ids, some by every rank, some by the owner alone.
template <class Sim>
void change_some(Sim& sim, ParticleId from, Outcome& out) {
  for (ParticleId id = from; id < 24; id += 4) {
    const std::size_t k = sim.find(id);
    if (id % 3 == 0)
      change(sim, id, 1, out);
    else if (k < sim.rows())
      change(sim, id, (sim.form(k) + 1) % sim.forms().size(), out);
  }
}

template <class Shape, class AddForms, class... Policies>
void run(Outcome& out, const AddForms& forms, double pull, Policies... policies) {
  auto sim = silt_test::slide<Shape>(forms, silt::EnergyLedger{}, silt::Field<"age">{},
                                     silt::ContactEvents{}, policies...);
  sim.time_step = 1e-5, sim.gravity = {-pull, 0, -pull};
  sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, silt_test::stone);
  for (std::size_t k = 0; k < sim.rows(); ++k)
    sim.template field<"age">(k) = 1 + static_cast<double>(sim.id(k));
  std::vector<silt::ContactEvent> ended;
  const auto ends = silt::on_contact_end([&](const silt::ContactEvent& e) { ended.push_back(e); });
  int call = 0;
  auto edit = silt::at(silt::every(0.003), [&](auto& s) {
    ++call;
    if (call == 3 || call == 5) change_some(s, 0, out);
    if (call == 4) {
      change_some(s, 2, out);
      s.set_velocity(6, {0.1, 0, 0.2});  // those that were just changed
      s.set_form(22, std::size_t{0}), s.set_form(22, 1);
      s.remove(14);
      s.add(silt_test::bodies<Shape>({1, 1, 1}, 6.1e-3, forms, 0.4));  // id 24, not in the way
      s.set_velocity(24, {0, 0, 2}), s.remove(24);
    }
  });
  auto watch = silt::at(silt::every(0.0005), [&](auto& s) { out.copies.add(s); });
  sim.set_form(3, 1);  // before the first step
  sim.run(0.01, ends, watch, edit);
  look(sim, out);
  change_some(sim, 1, out), out.changed_at = sim.step();
  sim.share_edits();
  look(sim, out);
  sim.run(0.006, ends, watch, edit);
  look(sim, out);
  out.seen.add(sim);
  const std::lock_guard lock(out.mutex);
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k))
      out.kinds[sim.id(k)] = {static_cast<double>(sim.form(k)), sim.mass(k),
                              sim.template field<"age">(k)};
  for (const auto& e : ended)
    out.ended.push_back({static_cast<double>(e.a), static_cast<double>(e.b), e.end});
  for (std::size_t k = 0; k < sim.engine().particles.owned(); ++k)
    if (!sim.engine().particles.is_parked(k)) out.parts.push_back(sim.engine().particles.id[k]);
}
template <class Shape, class AddForms>
void check(const AddForms& forms, double pull, double limit) {
  Outcome one;
  run<Shape>(one, forms, pull);
  std::sort(one.ended.begin(), one.ended.end());
  CHECK(one.counts[0] == 23);
  CHECK(one.counts[1] > 5);
  CHECK(one.ended.size() > 20);
  int across = 0;
  for (const int n : {1, 2, 3, 5}) {
    CAPTURE(n);
    Outcome many;
    silt::run_on_ranks(
        n, [&](const silt::ThreadComm& comm) { run<Shape>(many, forms, pull, ranks(comm)); }, 30);
    const auto [place, velocity] = many.seen.off(one.seen);
    CHECK(place < limit);
    CHECK(velocity < 100 * limit);
    CHECK(many.counts == one.counts);
    REQUIRE(many.energies.size() == one.energies.size());
    for (std::size_t k = 0; k < one.energies.size(); ++k) {
      CAPTURE(k);
      CHECK(std::abs(many.energies[k] - one.energies[k]) < 1e4 * limit * one.turned_over);
    }
    REQUIRE(many.kinds.size() == one.kinds.size());
    for (const auto& of_one : one.kinds) {
      const auto id = of_one.first;
      const auto& kind = of_one.second;
      CAPTURE(id);
      CHECK(many.kinds[id][0] == kind[0]);
      CHECK(many.kinds[id][1] == near(kind[1]).epsilon(1e-12));
      CHECK(many.kinds[id][2] == kind[2]);
    }
    std::sort(many.ended.begin(), many.ended.end());
    CHECK(many.ended == one.ended);
    std::sort(many.parts.begin(), many.parts.end());
    CHECK(std::adjacent_find(many.parts.begin(), many.parts.end()) == many.parts.end());
    CHECK(many.parts.back() < 1000);
    CHECK(many.parts.size() == one.parts.size());
#ifdef SILT_TEST_TELLS
    std::printf("forms, ranks %d: off %.3g m, %.3g m/s, across %d\n", n, place, velocity,
                many.across.load());
#endif
    many.copies.compare();
    CHECK(many.copies.alone + many.copies.ghost_pairs == 0);
    CHECK(many.copies.unlike <= (limit > 1e-12 ? 1 : 0));  // a zero of another sign
    across += many.across;
  }
  CHECK(across > 2);
}

const auto grains = [](auto& all) {
  using Shape = silt::MultiSphere;
  all.add_form(Shape{{{{-0.2e-3, 0, 0}, 1e-3}, {{0.2e-3, 0, 0}, 0.95e-3}}});
  all.add_form(
      Shape{{{{-0.2e-3, 0, 0}, 1e-3}, {{0, 0.15e-3, 0}, 0.95e-3}, {{0.2e-3, 0, 0}, 0.95e-3}}});
  return std::size_t{2};
};
silt::Polyhedron dodecahedron() {
  std::vector<silt::Vec3d> corners;
  const double a = 0.5773e-3, b = 0.3568e-3, c = 0.9342e-3;  // [m]
  for (int k = 0; k < 8; ++k) {
    corners.push_back({k & 1 ? a : -a, k & 2 ? a : -a, k & 4 ? a : -a});
    if (k < 4) {
      const double p = k & 1 ? b : -b, q = k & 2 ? c : -c;
      corners.insert(corners.end(), {{0, p, q}, {p, q, 0}, {q, 0, p}});
    }
  }
  return silt::Polyhedron::from_points(corners);
}

// Catches: ghosts of the form before, or whose parts have no body; parts of two ranks with one id;
// fields or velocities of another body; contacts of the form before that go on or are told to end;
// books of the change on two ranks or on none.
TEST_CASE("ranks: multi-spheres that are given other forms are those of one process") {
  check<silt::MultiSphere>(grains, 40, 1e-12);
}
TEST_CASE("ranks: likewise super-ellipsoids") {
  using Shape = silt::SuperEllipsoid;
  check<Shape>(
      [](auto& all) {
        all.add_form(Shape{.a = 1e-3, .b = 0.9e-3, .c = 0.6e-3, .s1 = 4, .s2 = 4});
        all.add_form(Shape{.a = 1e-3, .b = 1e-3, .c = 0.8e-3});
        return std::size_t{2};
      },
      40, 1e-12);
}
// A narrow phase that iterates ends at another point within its tolerance where places differ by
// 1e-16 m.
TEST_CASE("ranks: likewise a mix of shapes") {
  check<silt::Mix<silt::Sphere, silt::MultiSphere, silt::SuperEllipsoid, silt::Polyhedron>>(
      [](auto& all) {
        all.add_form(silt::Sphere{});
        all.add_form(silt::MultiSphere{{{{-0.1e-3, 0, 0}, 1e-3}, {{0.1e-3, 0, 0}, 0.9e-3}}});
        all.add_form(silt::SuperEllipsoid{.a = 1e-3, .b = 1e-3, .c = 0.9e-3, .s1 = 3, .s2 = 2});
        all.add_form(dodecahedron());
        return std::size_t{4};
      },
      40, 1e-8);
}

// Catches: a file in which parts have the ids of a rank alone, or ghosts another form than their
// bodies.
TEST_CASE("ranks: what is saved after a change of forms goes on") {
  const silt_test::Folder folder;
  const std::string path = folder / "run";
  const auto scene = [](auto... policies) {
    auto sim = silt_test::slide<silt::MultiSphere>(grains, silt::Field<"age">{}, policies...);
    sim.time_step = 1e-5;
    return sim;
  };
  Seen through, alone;
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    auto sim = scene(ranks(comm));
    int call = 0;
    sim.run(0.01, silt::at(silt::every(0.005), [&](auto& s) {
              if (++call < 3) return;
              for (ParticleId id = 0; id < 24; id += 5) s.set_form(id, 1);
              for (std::size_t k = 0; k < s.rows(); ++k)
                if (s.is_present(k) && s.id(k) % 7 == 1) s.remove(s.id(k));
              silt::save_checkpoint(s, path);
            }));
    sim.run(0.003), through.add(sim);
  });
  const auto go_on = [&](auto& sim, Seen& again) {
    silt::load_checkpoint(sim, path);
    CHECK(sim.size() == 20);
    sim.run(0.003), again.add(sim);
  };
  auto sim = scene();
  go_on(sim, alone);
  CHECK(alone.off(through)[0] < 1e-12);
  for (const int n : {2, 3, 5}) {
    CAPTURE(n);
    Seen again;
    silt::run_on_ranks(
        n,
        [&](const silt::ThreadComm& comm) {
          auto of_rank = scene(ranks(comm));
          go_on(of_rank, again);
        },
        30);
    CHECK(again.off(through)[0] < 1e-12);
    if (n == 3) CHECK(again.all == through.all);  // the same bits
  }
}

/// Three bodies above the others, elsewhere at each call from 6 to 11.
silt::Particles<silt::MultiSphere> three(int call) {
  silt::Particles<silt::MultiSphere> all;
  grains(all);
  for (int m = 3 * (call - 6); m < 3 * (call - 5); ++m)
    all.add({.form = static_cast<std::size_t>(m % 2),
             .position = {6.1e-3 * (m % 6 + 0.5), 6.1e-3 * (m / 6 % 2 + 0.5),
                          0.0185 + 0.0065 * (m / 12)},
             .radius = 3e-3,
             .density = 2500,
             .velocity = {0, 0, -0.4}});
  return all;
}
// Rows of bodies that have left are there until the next search, and others come before that.
// Catches: rows that are taken for parts of another body; ghosts sent in another order; contacts
// read with the ghosts at the places of before.
TEST_CASE("ranks: bodies that come at the instant at which others are removed") {
  const auto run = [](Seen& seen, std::vector<double>& read, auto... policies) {
    auto sim = silt_test::slide<silt::MultiSphere>(grains, silt::EnergyLedger{}, policies...);
    sim.time_step = 1e-5, sim.gravity = {-30, 0, -30};
    sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, silt_test::stone);
    sim.add_inlet(silt::Box{{0.003, 0.003, 0.04}, {0.034, 0.0092, 0.047}},
                  {.radius = silt::uniform(0.0022, 0.003),
                   .density = 2500,
                   .rate = 1000,
                   .velocity = {0, 0, -0.5},
                   .interval = 1e-4,
                   .form = 1});
    int call = 0;
    const auto edit = [&](auto& s) {
      if (++call < 6 || call > 11) return;
      if (call % 2 == 0) s.remove(static_cast<ParticleId>(2 * call));
      s.add(three(call));
    };
    const auto look = [&](auto& s) {
      if (call > 5 && call % 2 == 0) return;  // other ranks do not know of the removed one yet
      double sum = 0;                         // [N]
      s.for_each_contact([&](const silt::ContactSeen& c) {
        const bool at_wall = c.b == silt::no_particle;
        sum += c.normal_force * static_cast<double>(100 + 10 * (c.a % 7) + (at_wall ? 0 : c.b % 5));
      });
      sum = s.sum_over_ranks(sum);
      const auto touching = static_cast<double>(s.touching_pairs());
      if (s.rank() == 0) read.push_back(sum), read.push_back(touching);
    };
    sim.run(0.014, silt::at(silt::every(0.001), edit), silt::at(silt::every(0.001), look));
    CHECK(sim.size() == 24 + 18 + sim.inlet(0).placed - 3);
    seen.add(sim);
  };
  Seen one;
  std::vector<double> read;
  run(one, read);
  const double most = *std::max_element(read.begin(), read.end());
  CHECK(read.back() > 5);
  for (const int n : {2, 3, 5}) {
    CAPTURE(n);
    Seen many;
    std::vector<double> of_many;
    silt::run_on_ranks(
        n, [&](const silt::ThreadComm& comm) { run(many, of_many, ranks(comm)); }, 30);
    CHECK(many.off(one)[0] < 1e-12);
    REQUIRE(of_many.size() == read.size());
    for (std::size_t k = 0; k < read.size(); ++k) {
      CAPTURE(k);
      CHECK(std::abs(of_many[k] - read[k]) <= 1e-8 * (k % 2 == 0 ? most : 0));
    }
  }
}

TEST_CASE("ranks: a form that is not there, and a body that no rank has, are refused on all") {
  std::atomic<int> told{0};
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    auto sim = silt_test::slide<silt::MultiSphere>(grains, ranks(comm));
    sim.run(1e-4);
    const auto refused = [&](const auto& call, const std::string& words) {
      try {
        call();
      } catch (const silt::InputError& e) {
        told += std::string(e.what()).find(words) != std::string::npos;
      }
    };
    refused([&] { sim.set_form(0, 2); },
            "Simulation::set_form: form 2 is none of the 2 forms of the simulation");
    refused([&] { sim.set_form(24, 1), sim.share_edits(); },
            "Simulation::set_form: there is no particle 24 on any rank");
    sim.run(1e-4);
  });
  CHECK(told == 6);
}

// Rank 0 has the contact of which all throw the error, and rank 1 the body that was changed.
TEST_CASE("ranks: an overlap that a new form makes is named as such by every rank") {
  std::atomic<int> told{0};
  silt::run_on_ranks(2, [&](const silt::ThreadComm& comm) {
    silt::Particles<silt::MultiSphere> pair;
    pair.add_form(silt::MultiSphere{{{{0, 0, -0.9e-3}, 0.1e-3}, {{0, 0, 0.9e-3}, 0.1e-3}}});
    pair.add_form(silt::MultiSphere{{{{0, 0, 0}, 1e-3}}});
    pair.add({.form = 1, .position = {-0.5e-3, 0, 0}, .density = 2500});
    pair.add({.form = 0, .position = {0.5e-3, 0, 0}, .density = 2500});
    silt::Simulation sim{pair, silt::Contacts<silt_test::BodyLaw>{silt_test::stone},
                         silt::Ranks{comm, silt_test::WanderingSlabs{-0.01, 0.01, false}}};
    sim.threads = 1, sim.time_step = 1e-5;
    try {
      sim.run(1e-4, silt::at(silt::every(5e-5), [](auto& s) {
                if (s.time() > 4e-5) s.set_form(1, 1);
              }));
    } catch (const silt::SimulationError& e) {
      told += std::string(e.what()).find("Simulation::set_form") != std::string::npos;
    }
  });
  CHECK(told == 2);
}

}  // namespace

}  // namespace parallel_forms_test
