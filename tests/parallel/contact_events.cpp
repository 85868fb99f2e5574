// silt - BSD-3-Clause, see LICENSE
// Contacts that begin and end on ranks: each told once, whichever rank has its particles by then.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <map>
#include <mutex>
#include <string>
#include <tuple>
#include <vector>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/io/contact_observers.hpp>
#include <silt/shape/multi_sphere.hpp>

#include "body_scenes.hpp"
#include "rank_scenes.hpp"

namespace parallel_events_test {

namespace {

using silt::ContactEvent;
using silt_test::glass;
using silt_test::WanderingSlabs;
using Law = silt::HertzMindlin;
using Ranks = silt_test::WanderingRanks;

Ranks ranks(const silt::ThreadComm& comm) { return silt_test::wandering(comm); }

/// What happened, put together by the ranks.
struct Told {
  std::vector<ContactEvent> begun, ended;
  std::mutex mutex;
  void sort() {
    const auto key = [](const ContactEvent& e) {
      return std::tuple(e.a, e.b, e.wall, e.begin, e.end, e.point.x);
    };
    for (auto* all : {&begun, &ended})
      std::sort(all->begin(), all->end(),
                [&](const auto& one, const auto& two) { return key(one) < key(two); });
  }
};
template <class... Policies>
void watch(Told& told, double time, Policies... policies) {
  auto sim =
      silt_test::trough(silt_test::cloud(12, 4, 3), silt::ContactEvents{}, std::move(policies)...);
  std::vector<ContactEvent> begun, ended;
  sim.run(time, silt::on_contact_begin([&](const ContactEvent& e) { begun.push_back(e); }),
          silt::on_contact_end([&](const ContactEvent& e) { ended.push_back(e); }));
  const std::lock_guard lock(told.mutex);
  told.begun.insert(told.begun.end(), begun.begin(), begun.end());
  told.ended.insert(told.ended.end(), ended.begin(), ended.end());
}
/// `rounding` of what they were, in parts of the largest of all.
void check_same(const std::vector<ContactEvent>& many, const std::vector<ContactEvent>& one,
                double rounding) {
  REQUIRE(many.size() == one.size());
  double force = 0, lost = 0, speed = 0;
  for (const auto& e : one)
    force = std::max(force, e.largest_force), lost = std::max(lost, std::abs(e.lost_energy)),
    speed = std::max(speed, std::abs(e.normal_speed));
  std::size_t off = 0;
  for (std::size_t k = 0; k < one.size(); ++k) {
    const ContactEvent &m = many[k], &o = one[k];
    off += m.a != o.a || m.b != o.b || m.wall != o.wall || m.begin != o.begin || m.end != o.end ||
           !(std::abs(m.largest_force - o.largest_force) <= rounding * force) ||
           !(std::abs(m.lost_energy - o.lost_energy) <= rounding * lost) ||
           !(std::abs(m.normal_speed - o.normal_speed) <= rounding * speed) ||
           !(norm(m.point - o.point) <= rounding) || !(norm(m.normal - o.normal) <= rounding);
  }
  CHECK(off == 0);
}

// Catches: events that both ranks tell, or none, as their particle passes on in the meantime;
// forces and energies that are left behind. Steps at which contacts begin and end are whole
// numbers: the same.
TEST_CASE("ranks: contacts begin and end as on one process, each told once") {
  Told one;
  watch(one, 0.03), one.sort();
  CHECK(one.ended.size() > 300);
  for (const int n : {1, 2, 3, 5}) {
    CAPTURE(n);
    Told many;
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) { watch(many, 0.03, ranks(comm)); });
    many.sort();
    const double rounding = n == 1 ? 0 : 1e-8;
    check_same(many.ended, one.ended, rounding);
    check_same(many.begun, one.begun, rounding);
  }
}

TEST_CASE("ranks: the same ranks tell the same events in the same order, to the bit") {
  const auto run = [] {
    std::map<int, std::vector<ContactEvent>> of_rank;
    std::mutex mutex;
    silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
      Told own;
      watch(own, 0.02, ranks(comm));
      const std::lock_guard lock(mutex);
      of_rank[comm.rank()] = own.ended;
    });
    return of_rank;
  };
  const auto first = run(), second = run();
  for (int r = 0; r < 3; ++r) {
    const auto &a = first.at(r), &b = second.at(r);
    CHECK(a.size() > 50);
    REQUIRE(a.size() == b.size());
    for (std::size_t k = 0; k < a.size(); ++k)
      CHECK((a[k].a == b[k].a && a[k].b == b[k].b && a[k].end == b[k].end &&
             a[k].lost_energy == b[k].lost_energy));
  }
}

// Parts of a body have contacts of their own; their pairs with ghosts come with the others.
TEST_CASE("ranks: contacts of bodies are told once") {
  const auto forms = [](auto& all) {
    all.add_form(silt::MultiSphere{{{{-1.2e-3, 0, 0}, 1.8e-3}, {{1.2e-3, 0, 0}, 1.8e-3}}});
    return std::size_t{1};
  };
  const auto run = [&](Told& told, auto... policies) {
    auto sim = silt_test::slide<silt::MultiSphere>(forms, silt::ContactEvents{}, policies...);
    std::vector<ContactEvent> ended;
    sim.run(0.02, silt::on_contact_end([&](const ContactEvent& e) { ended.push_back(e); }));
    const std::lock_guard lock(told.mutex);
    told.ended.insert(told.ended.end(), ended.begin(), ended.end());
  };
  Told one, many;
  run(one), one.sort();
  CHECK(one.ended.size() > 20);
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    run(many, silt_test::wandering(comm, silt_test::slide_length));
  });
  many.sort();
  check_same(many.ended, one.ended, 1e-8);
}

/// Removes the own particles for which goes(id) holds, and counts their contacts with ghosts.
template <class Sim, class Goes>
void thin_out(Sim& sim, const Goes& goes, std::atomic<int>& across) {
  const auto& e = sim.engine();
  if constexpr (Sim::has_ranks)
    e.lists.pairs.for_each([&](std::size_t k) {
      const std::uint32_t a = e.lists.pairs.first()[k], b = e.lists.pairs.second()[k];
      across += e.lists.pairs.remembers(k) && std::max(a, b) >= e.particles.owned() &&
                goes(e.id_of(std::min(a, b)));
    });
  std::vector<silt::ParticleId> gone;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k) && goes(sim.id(k))) gone.push_back(sim.id(k));
  for (const auto id : gone) sim.remove(id);
}
/// What is told while particles are removed by an observer and between two runs; goes(id, call):
/// when each goes.
template <class Sim, class Goes>
void watch_thinned(Sim& sim, Told& told, double half, const Goes& goes, std::atomic<int>& across) {
  std::vector<ContactEvent> begun, ended;
  const auto begins = silt::on_contact_begin([&](const ContactEvent& e) { begun.push_back(e); });
  const auto ends = silt::on_contact_end([&](const ContactEvent& e) { ended.push_back(e); });
  int call = 0;
  auto edit = silt::at(silt::every(half / 3), [&](auto& s) {
    ++call;
    thin_out(
        s, [&](silt::ParticleId id) { return goes(id, call); }, across);
    if (call == 5) s.remove(9);  // every rank asks for it
  });
  sim.run(half, begins, ends, edit);
  thin_out(
      sim, [&](silt::ParticleId id) { return goes(id, 6); }, across);
  sim.run(half, begins, ends, edit);
  const std::lock_guard lock(told.mutex);
  told.begun.insert(told.begun.end(), begun.begin(), begun.end());
  told.ended.insert(told.ended.end(), ended.begin(), ended.end());
}

// Catches: an end that is told of a removed sphere, by its rank or that of its partner; contacts of
// its partners that begin anew, or whose records are lost, in the search that follows.
TEST_CASE("ranks: contacts of removed spheres end untold, those of their partners go on") {
  const auto run = [](Told& told, std::atomic<int>& across, auto... policies) {
    auto sim =
        silt_test::trough(silt_test::cloud(12, 4, 3, 0.0074), silt::ContactEvents{}, policies...);
    sim.time_step = 2e-5, sim.gravity = {-20, 0, -40};
    const auto goes = [](silt::ParticleId id, int call) {
      const unsigned rest = id % 9;
      return (call == 2 && (rest == 1 || rest == 2)) || (call == 3 && rest == 4) ||
             (call == 5 && rest == 3) || (call == 6 && rest == 7);
    };
    watch_thinned(sim, told, 0.024, goes, across);
    CHECK(sim.size() == 63);
  };
  Told one;
  std::atomic<int> none{0};
  run(one, none), one.sort();
  CHECK(one.ended.size() > 200);
  for (const int n : {1, 2, 3, 5}) {
    CAPTURE(n);
    Told many;
    std::atomic<int> across{0};
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) { run(many, across, ranks(comm)); });
    many.sort();
    check_same(many.ended, one.ended, 1e-8);
    check_same(many.begun, one.begun, 1e-8);
    if (n > 1) CHECK(across.load() > 0);
  }
}
TEST_CASE("ranks: contacts of removed bodies end untold, those of their partners go on") {
  const auto forms = [](auto& all) {
    all.add_form(silt::MultiSphere{{{{-0.4e-3, 0, 0}, 1.8e-3}, {{0.4e-3, 0, 0}, 1.8e-3}}});
    return std::size_t{1};
  };
  const auto run = [&](Told& told, std::atomic<int>& across, auto... policies) {
    auto sim = silt_test::slide<silt::MultiSphere>(forms, silt::ContactEvents{}, policies...);
    sim.time_step = 1e-5, sim.gravity = {-30, 0, -30};
    sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, silt_test::stone);
    const auto goes = [](silt::ParticleId id, int call) {  // every second one along the slide
      const bool even = id / 4 % 2 == 0, low = id % 2 == 0;
      return (call == 3 && even && low) || (call == 6 && !even && !low) ||
             (call == 5 && !even && low);
    };
    watch_thinned(sim, told, 0.024, goes, across);
    CHECK(sim.size() == 24 - 3 * 6 - 1);
  };
  Told one;
  std::atomic<int> none{0};
  run(one, none), one.sort();
  CHECK(one.ended.size() > 20);
  for (const int n : {2, 3}) {
    Told many;
    std::atomic<int> across{0};
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
      run(many, across, silt_test::wandering(comm, silt_test::slide_length));
    });
    many.sort();
    check_same(many.ended, one.ended, 1e-8);
    check_same(many.begun, one.begun, 1e-8);
    CHECK(across.load() > 0);
  }
}

// The other ranks do not know that one has failed, and do not wait for it in between.
TEST_CASE("ranks: what is thrown as one rank is told of a contact, all throw") {
  std::atomic<int> told{0};
  const auto run = [&](const silt::ThreadComm& comm) {
    silt::Simulation sim{silt_test::cloud(12, 4, 3), silt::Contacts<Law>{glass},
                         silt::ContactEvents{}, ranks(comm)};
    sim.gravity = {0, 0, -9.81};
    sim.threads = 1;
    int count = 0;
    try {
      sim.run(0.03, silt::on_contact_end([&](const ContactEvent&) {
                if (comm.rank() == 1 && ++count == 20) throw silt::Error("the table is full");
              }));
    } catch (const silt::Error& e) {
      told += std::string(e.what()).find("rank 1 of 3: the table is full") == 0;
      throw;
    }
  };
  CHECK_THROWS_AS(silt::run_on_ranks(3, run), silt::Error);
  CHECK(told == 3);
}

}  // namespace

}  // namespace parallel_events_test
