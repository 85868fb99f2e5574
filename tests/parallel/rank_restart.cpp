// silt - BSD-3-Clause, see LICENSE
// Checkpoints of many ranks: the same number of ranks goes on bit for bit, another number with the
// same contacts; what does not belong together is refused.
#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <mutex>
#include <tuple>

#include <silt/io/failure.hpp>
#include <silt/io/observers.hpp>
#include <silt/parallel/decomposition/slabs.hpp>

#include "rank_scenes.hpp"
#include "refusal.hpp"

namespace {

namespace fs = std::filesystem;
using namespace silt_test;
using silt::load_checkpoint;
using silt::save_checkpoint;
using silt_test::has;
using silt_test::refusal;

constexpr double half = 0.006;  // [s], after which the bed touches and rubs

/// All that can be read of a run: particles, walls and the forces of contacts.
struct Outcome {
  using Which = std::tuple<silt::ParticleId, silt::ParticleId, std::size_t>;
  struct Force {
    silt::Vec3d force, spring;
  };
  silt_test::Seen seen;
  std::mutex mutex;
  std::map<Which, Force> contacts;
  std::vector<double> numbers;

  template <class Sim>
  void add(const Sim& sim) {
    seen.add(sim);
    const double kinetic = sim.kinetic_energy();
    const std::lock_guard lock(mutex);
    if (sim.has_contacts())
      sim.for_each_contact([&](const silt::ContactSeen& c) {
        CHECK(contacts.try_emplace({c.a, c.b, c.wall}, Force{c.force, c.spring}).second);
      });
    if (sim.rank() > 0) return;
    numbers = {sim.time(), kinetic, sim.peak_overlap(), sim.largest_overlap()};
    for (std::size_t w = 0; w < sim.walls(); ++w)
      for (const silt::Vec3d& v : {sim.wall(w).force, sim.wall(w).impulse})
        numbers.insert(numbers.end(), {v.x, v.y, v.z});
  }
};
/// The first half of the run, saved to `path`; and the whole of it.
void save_half(int ranks, const std::string& path, Outcome& whole, double more) {
  on(ranks, {}, [&](auto& sim) {
    sim.run(half);
    save_checkpoint(sim, path);
    sim.run(more);
    whole.add(sim);
  });
}
void go_on(int ranks, const std::string& path, Outcome& out, double more) {
  on(ranks, {}, [&](auto& sim) {
    load_checkpoint(sim, path);
    CHECK(sim.step() == 600);
    CHECK(sim.size() == 54);
    sim.run(more);
    out.add(sim);
  });
}
void check_close(const Outcome& a, const Outcome& b, double tolerance) {
  const auto off = a.seen.off(b.seen);
  CHECK(off[0] < tolerance * 0.01);  // [m] of the size of the bed
  CHECK(off[1] < tolerance);         // [m/s]
  REQUIRE(a.contacts.size() == b.contacts.size());
  double largest = 0, wrong = 0, sprung = 0;  // [N]
  for (const auto& [which, force] : a.contacts) {
    REQUIRE(b.contacts.count(which) == 1);
    const auto& other = b.contacts.at(which);
    largest = std::max(largest, norm(force.force)), sprung = std::max(sprung, norm(force.spring));
    wrong = std::max({wrong, norm(force.force - other.force), norm(force.spring - other.spring)});
  }
  CHECK(wrong < 100 * tolerance * largest);
  CHECK(sprung > 0.05 * largest);  // what contacts remember would be missed
}

TEST_CASE("rank restart: the same number of ranks goes on bit for bit; saving changes no bit") {
  const Folder folder;
  for (const int n : {1, 2, 3}) {
    CAPTURE(n);
    const std::string path = folder / ("run" + std::to_string(n));
    Outcome whole, restarted, silent;
    save_half(n, path, whole, half);
    go_on(n, path, restarted, half);
    on(n, {}, [&](auto& sim) { sim.run(half), sim.run(half), silent.add(sim); });
    CHECK(whole.seen.all == restarted.seen.all);
    CHECK(whole.numbers == restarted.numbers);
    CHECK(whole.seen.all == silent.seen.all);
    CHECK(whole.numbers == silent.numbers);
    CHECK_FALSE(whole.seen.doubled);
  }
}

TEST_CASE("rank restart: other numbers of ranks, and one process, go on with the same contacts") {
  const Folder folder;
  const double step = 1e-5, later = 100 * step;  // [s]
  for (const int from : {0, 3}) {
    const std::string path = folder / ("run" + std::to_string(from));
    Outcome next, whole;
    save_half(from, path, next, step), save_half(from, path, whole, later);
    for (const int to : {0, 1, 2, 5, 60}) {
      CAPTURE(from);
      CAPTURE(to);
      if (from == to) continue;
      Outcome one, all;
      go_on(to, path, one, step), go_on(to, path, all, later);
      check_close(one, next, 1e-11);  // rounding: of sums in another order
      check_close(all, whole, 1e-9);  // ... grown by 100 steps of collisions
      CHECK(all.numbers.size() == whole.numbers.size());
      for (std::size_t k = 0; k < all.numbers.size(); ++k)
        CHECK(std::abs(all.numbers[k] - whole.numbers[k]) <=
              1e-7 * std::abs(whole.numbers[k]) + 1e-12);
    }
  }
}

TEST_CASE("rank restart: what was loaded on another number of ranks can be saved again at once") {
  const Folder folder;
  const std::string path = folder / "run", again = folder / "again";
  Outcome next, restarted;
  save_half(3, path, next, 1e-5);
  on(2, {}, [&](auto& sim) { load_checkpoint(sim, path), save_checkpoint(sim, again); });
  on(0, {}, [&](auto& sim) { load_checkpoint(sim, again), save_checkpoint(sim, path + "2"); });
  go_on(4, path + "2", restarted, 1e-5);
  check_close(restarted, next, 1e-11);
}

TEST_CASE("rank restart: blocks that are missing, cut off or of others are refused on all ranks") {
  const Folder folder;
  const auto save = [&](const std::string& name, double time, double floor) {
    on(2, {.floor = floor}, [&](auto& sim) { sim.run(time), save_checkpoint(sim, folder / name); });
  };
  const auto refused = [&](int ranks) {
    std::vector<std::string> words;
    std::mutex mutex;
    on(ranks, {}, [&](auto& sim) {
      const auto before = sim.kinetic_energy();
      std::string one = refusal([&] { load_checkpoint(sim, folder / "run"); });
      CHECK(sim.kinetic_energy() == before);
      const std::lock_guard lock(mutex);
      words.push_back(std::move(one));
    });
    for (const auto& one : words) CHECK(one == words[0]);
    return words[0];
  };
  save("run", 0.001, 0), save("later", 0.002, 0), save("other", 0.001, -1e-4);
  const std::string block = folder / "run.blocks/100.1";
  const std::string own = silt::detail::read_file(block);
  const auto put = [&](const std::string& content) {
    std::ofstream(block, std::ios::binary) << content;
  };
  REQUIRE(fs::exists(block));
  for (const int ranks : {0, 2, 3}) {
    CAPTURE(ranks);
    fs::remove(block);
    has(refused(ranks), "run.blocks/100.1' is missing: a checkpoint is moved and copied together");
    put(own.substr(0, own.size() / 2));
    has(refused(ranks), "run.blocks/100.1' is truncated");
    put(silt::detail::read_file(folder / "later.blocks/200.1"));
    has(refused(ranks), "is of step 100, but its block");
    put(silt::detail::read_file(folder / "other.blocks/100.1"));
    has(refused(ranks), "which belongs to another run: use the blocks that were written with it");
    put(own);
    on(ranks, {}, [&](auto& sim) { CHECK_NOTHROW(load_checkpoint(sim, folder / "run")); });
  }
  put("");
  has(refused(3), "is empty");
  // A file that cannot be written: all ranks say so, and the checkpoint before is whole.
  put(own);
  fs::create_directory(folder / "run.blocks/200.1.partial");
  on(2, {}, [&](auto& sim) {
    sim.run(0.002);
    has(refusal([&] { save_checkpoint(sim, folder / "run"); }), "rank 1 of 2: file");
    CHECK_NOTHROW(load_checkpoint(sim, folder / "run"));
    CHECK(sim.step() == 100);
  });
}

TEST_CASE("rank restart: old blocks go with their index, other files stay") {
  const Folder folder;
  const std::string path = folder / "run";
  const auto blocks = [&] {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(path + ".blocks"))
      names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  };
  using Names = std::vector<std::string>;
  on(3, {}, [&](auto& sim) { sim.run(0.001), save_checkpoint(sim, path); });
  CHECK(blocks() == Names{"100.0", "100.1", "100.2"});
  { std::ofstream(path + ".blocks/notes.txt") << "mine"; }
  { std::ofstream(path + ".blocks/50.7.partial") << "of a kill"; }
  on(2, {}, [&](auto& sim) { sim.run(0.001), save_checkpoint(sim, path); });
  CHECK(blocks() == Names{"100b.0", "100b.1", "notes.txt"});
  on(2, {}, [&](auto& sim) { sim.run(0.001), save_checkpoint(sim, path); });
  CHECK(blocks() == Names{"100.0", "100.1", "notes.txt"});
}

TEST_CASE("rank restart: decompositions tell what they remember of the partition before") {
  const silt::Vec3d points[] = {{0, 0, 0}, {1, 2, 3}, {4, 1, 2}, {3, 3, 1}, {2, 5, 5}, {5, 4, 0}};
  const auto check = [&](auto parts) {
    silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
      auto mine = parts;
      const std::vector<double> weights(6, 1);
      if (comm.rank() == 0)
        mine.partition(comm, points, weights);
      else
        mine.partition(comm, std::span<const silt::Vec3d>{}, std::span<const double>{});
      silt::detail::BytesOut out;
      mine.for_each_state(out);
      auto other = parts;
      const Folder folder;
      silt::CheckpointWriter file("none");
      file.commit(folder / "none");
      const silt::CheckpointReader reader(folder / "none");
      const std::string path = folder / "none";
      silt::detail::BytesIn in{silt::detail::CheckpointLoader(reader, path), out.words};
      other.for_each_state(in);
      int differ = 0;
      for (const auto& p : points) {
        CHECK(other.rank_of(p) == mine.rank_of(p));
        differ += parts.rank_of(p) != mine.rank_of(p);
      }
      CHECK(differ > 0);
      out.words.pop_back();
      silt::detail::BytesIn cut{silt::detail::CheckpointLoader(reader, path), out.words};
      has(refusal([&] { other.for_each_state(cut); }), "ranks.parts are cut off");
    });
  };
  check(silt::Bisection{}), check(silt::StaticSlabs{.axis = 0}),
      check(silt::MovingSlabs{.axis = 0});
}

TEST_CASE("rank restart: on_failure keeps the state of all ranks, and what the failed one has") {
  const Folder folder;
  const std::string failed = folder / "failed";
  std::vector<std::string> words;
  std::mutex mutex;
  on(3, {}, [&](auto& sim) {
    auto breaks = silt::at(silt::every(0.005), [](const auto& s) {
      if (s.step() > 0 && s.find(7) < s.rows())
        throw silt::SimulationError("sphere 7 broke", s.step(), {7}, {});
    });
    std::string one = refusal([&] { sim.run(0.02, breaks, silt::on_failure(failed)); });
    load_checkpoint(sim, failed + "/last_good.silt");
    CHECK(sim.step() == 0);
    load_checkpoint(sim, failed + "/at_failure.silt");
    CHECK(sim.step() == 500);
    const std::lock_guard lock(mutex);
    words.push_back(std::move(one));
  });
  REQUIRE(words.size() == 3);
  CHECK(words[0] == words[1]);
  CHECK(words[0] == words[2]);
  has(words[0], "sphere 7 broke");
  has(words[0], "failure.txt");
  has(words[0], "at_failure.silt is the state at the failure");
  int tables = 0;
  for (int r = 0; r < 3; ++r)
    tables += fs::exists(failed + "/particles_r" + std::to_string(r) + ".csv");
  CHECK(tables == 1);
}

}  // namespace
