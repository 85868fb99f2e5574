// silt - BSD-3-Clause, see LICENSE
// What ranks.sh runs on several ranks: each word is a case. Those that must end well say "fine" on
// rank 0.

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <silt/mpi.hpp>

#include "../parallel/comm_checks.hpp"

namespace {

using silt_test::expect;
using silt_test::expect_words;
using silt_test::said;

void communicators(const silt::MpiComm& world) {
  silt_test::all_checks(world);
  // Pieces so small that every message has several, and every gathering several rounds.
  for (const std::size_t piece : {std::size_t{7}, std::size_t{1000}}) {
    const silt::MpiComm pieces(world.mpi(), piece);
    silt_test::exchanges_with_neighbours(pieces, 2000);
    silt_test::gathers_in_rank_order(pieces);
    silt_test::delivers_what_nobody_expects(pieces);
    silt_test::all_throw_what_one_rank_throws(pieces);
  }
  silt_test::exchanges_with_neighbours(world, 3000000);  // larger than what MPI sends at once
  // Half of the ranks each.
  MPI_Comm half = MPI_COMM_NULL;
  MPI_Comm_split(world.mpi(), world.rank() % 2, world.rank(), &half);
  silt_test::all_checks(silt::MpiComm(half));
  MPI_Comm_free(&half);
  expect_words(said([] { silt::MpiComm{MPI_COMM_NULL}; }), "MPI_COMM_NULL");
  expect_words(said([] { silt::MpiComm(MPI_COMM_WORLD, 0); }), "pieces of 0 bytes must be in");
  int argc = 0;
  char** argv = nullptr;
  expect_words(said([&] { silt::Mpi(argc, argv); }), "MPI has begun already");
}

void wrong_sizes(const silt::MpiComm& comm) {
  const int n = comm.size(), up = (comm.rank() + 1) % n, down = (comm.rank() + n - 1) % n;
  double out[2] = {1, 2}, in[2] = {};
  const auto swap = [&](std::size_t sent, std::size_t expected) {
    const silt::Outgoing to{up, std::as_bytes(std::span(out, sent))};
    const silt::Incoming from{down, std::as_writable_bytes(std::span(in, expected))};
    comm.exchange({&to, 1}, {&from, 1}).wait();
  };
  expect_words(said([&] { swap(1, 2); }), "expected a message of 16 bytes from rank");
  expect_words(said([&] { swap(2, 1); }), "a message of an exchange has failed: MPI_ERR_TRUNCATE");
  swap(2, 2);
}

void arrivals(const silt::MpiComm& comm) {
  const int n = comm.size(), up = (comm.rank() + 1) % n, down = (comm.rank() + n - 1) % n;
  int out = comm.rank(), in = -1;
  const silt::Outgoing to{up, std::as_bytes(std::span(&out, 1))};
  const silt::Incoming from{down, std::as_writable_bytes(std::span(&in, 1))};
  auto receive = comm.exchange({}, {&from, 1});
  expect(!receive.arrived(), "nothing has been sent");
  comm.barrier();
  auto send = comm.exchange({&to, 1}, {});
  while (!receive.arrived()) std::this_thread::yield();
  receive.wait();
  expect(in == down, "what came");
  { auto dropped = comm.exchange({&to, 1}, {&from, 1}); }  // ends before it is forgotten
  send.wait();
}

}  // namespace

int main(int argc, char** argv) {
  const std::string word = argc > 1 ? argv[1] : "";
  if (word == "before") {
    std::puts(said([] { silt::MpiComm{MPI_COMM_WORLD}; }).c_str());
    return 0;
  }
  if (word == "one_thread") {
    MPI_Init(&argc, &argv);
    std::puts(said([] { silt::MpiComm{MPI_COMM_WORLD}; }).c_str());
    MPI_Finalize();
    return 0;
  }
  const auto in_ranks = [&](const silt::MpiComm& comm) {
    const bool last = comm.rank() == comm.size() - 1;
    if (word == "communicators") communicators(comm), arrivals(comm);
    if (word == "sizes") wrong_sizes(comm);
    if (word.ends_with("one") && last) throw silt::InputError("this rank has no disk");
    if (word.ends_with("all"))
      silt::together(comm, "a step", [&] {
        if (last) throw silt::InputError("this rank has no disk");
      });
    if (word == "kill" && last) std::raise(SIGKILL);
    if (word == "exit" && last) std::exit(3);
    if (word == "by_itself" && comm.rank() == 0) silt::agree(comm, "a sum that rank 0 wants");
    if (word == "by_itself") return;
    if (word == "abort" && last) comm.abort("enough");
    comm.barrier();
    if (comm.rank() == 0) std::puts("fine");
  };
  if (word.starts_with("caught")) {  // MPI ends before main() knows what has failed
    try {
      silt::Mpi mpi(argc, argv);
      in_ranks(mpi.comm());
    } catch (const std::exception& e) {
      if (word.starts_with("caught_again")) throw;
      std::fprintf(stderr, "main: %s\n", e.what());
      return 2;
    }
    return 0;
  }
  silt::Mpi mpi(argc, argv);
  if (!word.starts_with("failed")) {
    in_ranks(mpi.comm());
    return 0;
  }
  try {
    in_ranks(mpi.comm());
  } catch (const std::exception& e) {
    mpi.fail(e.what());
  }
}
