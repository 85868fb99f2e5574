// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <atomic>
#include <chrono>

#include <silt/parallel/thread_comm.hpp>

#include "comm_checks.hpp"
#include "refusal.hpp"

namespace parallel_comm_test {

namespace {

using silt_test::has;
using silt_test::refusal;

TEST_CASE("comm: one process and 1 to 16 ranks reduce, gather, exchange and deliver alike") {
  silt_test::all_checks(silt::NoRanks{});
  for (const int n : {1, 2, 3, 4, 7, 8, 16}) {
    std::atomic<int> done{0};
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
      silt_test::all_checks(comm);
      ++done;
    });
    CHECK(done == n);
  }
}

TEST_CASE("comm: largest numbers do not depend on the order in which ranks come, to the bit") {
  for (const double first : {0.0, -0.0})
    silt::run_on_ranks(2, [&](const silt::ThreadComm& comm) {
      double x[] = {comm.rank() == 0 ? first : -first};
      comm.max_of(x);
      CHECK(!std::signbit(x[0]));
    });
  // Keys have the order of the numbers.
  const double inf = std::numeric_limits<double>::infinity();
  const double rising[] = {-inf, -1e300, -2, -1, -5e-324, -0.0, 0.0, 5e-324, 1, 2, 1e300, inf, NAN};
  for (std::size_t k = 0; k + 1 < std::size(rising); ++k) {
    CHECK(silt::detail::ordered_key(rising[k]) < silt::detail::ordered_key(rising[k + 1]));
    CHECK(silt::detail::value_of_key(silt::detail::ordered_key(rising[k])) == rising[k]);
  }
  CHECK(silt::detail::ordered_key(-NAN) == silt::detail::ordered_key(NAN));
}

TEST_CASE("comm: an exchange that has arrived says so; one that nobody waits for delays no other") {
  silt::run_on_ranks(2, [](const silt::ThreadComm& comm) {
    const int other = 1 - comm.rank();
    int told = comm.rank(), heard = -1;
    const silt::Outgoing out{other, std::as_bytes(std::span(&told, 1))};
    const silt::Incoming in{other, std::as_writable_bytes(std::span(&heard, 1))};
    { auto dropped = comm.exchange({&out, 1}, {&in, 1}); }
    CHECK(heard == other);
    auto first = comm.exchange({}, {&in, 1});
    comm.barrier();
    CHECK_FALSE(first.arrived());
    comm.barrier();
    auto second = comm.exchange({&out, 1}, {});
    comm.barrier();
    CHECK(first.arrived());
    first.wait();
    second.wait();
  });
}

TEST_CASE("comm: a rank that throws ends the others, and its error is the one that is told") {
  const auto begin = std::chrono::steady_clock::now();
  for (const int guilty : {0, 1, 2}) {
    std::vector<std::string> others(3);
    const auto sentence = refusal([&] {
      silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
        if (comm.rank() == guilty) throw silt::InputError("this rank has no disk");
        try {
          for (int k = 0; k < 2; ++k) comm.barrier();
        } catch (const silt::Error& e) {
          others[static_cast<std::size_t>(comm.rank())] = e.what();
          throw;
        }
      });
    });
    CHECK(sentence == "this rank has no disk");
    for (int r = 0; r < 3; ++r)
      if (r != guilty) {
        has(others[static_cast<std::size_t>(r)],
            silt::text("rank ", r, " of 3 cannot end barrier without rank ").c_str());
        has(others[static_cast<std::size_t>(r)], "it has ended with: ");
      }
  }
  // A rank that waits for a message of one that has ended.
  has(refusal([] {
        silt::run_on_ranks(2, [](const silt::ThreadComm& comm) {
          char c = 0;
          const silt::Incoming in{1, std::as_writable_bytes(std::span(&c, 1))};
          if (comm.rank() == 0) comm.exchange({}, {&in, 1}).wait();
        });
      }),
      "rank 0 of 2 cannot end exchange without rank 1 (it has ended)");
  // Nobody waited for the patience of 60 s.
  CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(30));
}

TEST_CASE("comm: ranks that wait too long, make different calls or abort get a sentence") {
  const auto waits = refusal([] {
    silt::run_on_ranks(
        3,
        [](const silt::ThreadComm& comm) {
          char c = 0;
          const silt::Incoming in{0, std::as_writable_bytes(std::span(&c, 1))};
          if (comm.rank() == 2)
            comm.exchange({}, {&in, 1}).wait();
          else
            comm.barrier();
        },
        0.3);
  });
  has(waits, " has waited 0.3 s in ");
  has(refusal([] {
        silt::run_on_ranks(2, [](const silt::ThreadComm& comm) {
          double x[] = {1};
          if (comm.rank() == 0)
            comm.max_of(x);
          else
            comm.barrier();
        });
      }),
      "the ranks are out of step: rank 0 calls max_of, rank 1 calls barrier");
  has(refusal([] {
        silt::run_on_ranks(2, [](const silt::ThreadComm& comm) {
          std::vector<double> x(static_cast<std::size_t>(1 + comm.rank()));
          comm.max_of(x);
        });
      }),
      "the ranks are out of step");
  has(refusal([] {
        silt::run_on_ranks(2, [](const silt::ThreadComm& comm) {
          int x = 0, y[2] = {0, 0};
          const silt::Outgoing out{1 - comm.rank(), std::as_bytes(std::span(&x, 1))};
          const silt::Incoming in{1 - comm.rank(), std::as_writable_bytes(std::span(y))};
          comm.exchange({&out, 1}, {&in, 1}).wait();
        });
      }),
      "expected a message of 8 bytes from rank 1, and 4 bytes came");
  has(refusal([] {
        silt::run_on_ranks(2, [](const silt::ThreadComm& comm) {
          if (comm.rank() == 1) comm.abort("enough");
          comm.barrier();
        });
      }),
      "rank 1 of 2: enough");
  has(refusal([] { silt::NoRanks::abort("enough"); }), "enough");
  has(refusal([] { silt::run_on_ranks(0, [](const silt::ThreadComm&) {}); }), "must be at least 1");
}

}  // namespace

}  // namespace parallel_comm_test
