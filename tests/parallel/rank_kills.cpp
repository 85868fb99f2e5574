// silt - BSD-3-Clause, see LICENSE
// A process that saves itself again and again and is killed at any moment: no state is lost.
#include <doctest/doctest.h>

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include <silt/io/observers.hpp>

#include "rank_scenes.hpp"

namespace {

namespace fs = std::filesystem;
using namespace silt_test;
using silt::load_checkpoint;

TEST_CASE("rank kills: a process that is killed a hundred times loses no state that was saved") {
  const Folder folder;
  const std::string path = folder / "run";
  const double end = 0.03;  // [s]
  const auto run = [&] {
    on(3, {.particles = 2}, [&](auto& sim) {
      if (fs::exists(path)) load_checkpoint(sim, path);
      sim.run(std::max(0.0, end - sim.time()), silt::checkpoints(path, silt::every(0.0001)));
    });
  };
  std::int64_t before = -1;
  int kills = 0, changes = 0;
  silt::Random random(7);
  while (kills < 100) {
    const pid_t child = ::fork();
    REQUIRE(child >= 0);
    if (child == 0) {
      try {
        run();
      } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        ::_exit(1);
      }
      ::_exit(0);
    }
    std::this_thread::sleep_for(
        std::chrono::microseconds(static_cast<int>(3000 + 30000 * random.uniform())));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    REQUIRE(((WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) ||
             (WIFEXITED(status) && WEXITSTATUS(status) == 0)));
    ++kills;
    if (!fs::exists(path)) continue;
    std::int64_t step = 0;
    on(3, {.particles = 2}, [&](auto& sim) {
      load_checkpoint(sim, path);
      if (sim.rank() == 0) step = sim.step();
    });
    CHECK(step >= before);
    CHECK(step % 10 == 0);
    changes += step > before, before = step;
    if (step == 3000) fs::remove(path), before = -1;  // once more from the beginning
  }
  CHECK(changes > 20);
  run();
  silt_test::Seen killed, whole;
  on(3, {.particles = 2}, [&](auto& sim) { load_checkpoint(sim, path), killed.add(sim); });
  on(3, {.particles = 2}, [&](auto& sim) { sim.run(end), whole.add(sim); });
  CHECK(killed.all == whole.all);
}

}  // namespace
