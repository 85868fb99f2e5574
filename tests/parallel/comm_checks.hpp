// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include <silt/parallel/agree.hpp>
#include <silt/parallel/comm.hpp>

/// What every communicator must do, as functions that all ranks call: by threads in comm.cpp, by
/// MPI in tests/mpi. They throw where something is wrong.
namespace silt_test {

inline void expect(bool holds, const std::string& what) {
  if (!holds) throw std::runtime_error("wrong: " + what);
}

template <class Call>
std::string said(const Call& call) {
  try {
    call();
  } catch (const std::exception& e) {
    return e.what();
  }
  return "nothing was refused";
}

inline void expect_words(const std::string& sentence, const std::string& words) {
  expect(sentence.find(words) != std::string::npos, "'" + sentence + "' lacks '" + words + "'");
}

template <silt::Communicator C>
void reductions_are_the_same_on_all_ranks(const C& comm) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const int r = comm.rank(), n = comm.size();
  std::vector<double> x{1.0 * r, -1.0 * r, r == n - 1 ? nan : inf, r == 0 ? 0.0 : -0.0, -inf};
  comm.max_of(x);
  expect(x[0] == n - 1 && x[1] == 0 && x[4] == -inf, "largest numbers");
  expect(x[2] != x[2], "not-a-number is larger than all");
  expect(x[3] == 0 && !std::signbit(x[3]), "+0 is larger than -0");
  std::vector<std::int64_t> k{r, 1, std::int64_t{1} << 52};
  comm.sum_of(k);
  expect(k[0] == n * (n - 1) / 2 && k[1] == n && k[2] == n * (std::int64_t{1} << 52), "sums");
  const double total = silt::sum(comm, 0.1 * (r + 1));
  double wanted = 0;
  for (int i = 0; i < n; ++i) wanted += 0.1 * (i + 1);
  expect(total == wanted, "a sum in rank order, to the bit");
}

template <silt::Communicator C>
void gathers_in_rank_order(const C& comm) {
  const int r = comm.rank(), n = comm.size();
  std::vector<int> mine(static_cast<std::size_t>(r % 3), 100 + r);  // some ranks have nothing
  const auto all = silt::gather(comm, std::span<const int>(mine));
  expect(all.ranks() == n, "as many as there are ranks");
  for (int i = 0; i < n; ++i) {
    expect(all[i].size() == static_cast<std::size_t>(i % 3), "length of what a rank gave");
    for (const int v : all[i]) expect(v == 100 + i, "what a rank gave");
  }
  const auto each = silt::gather_each(comm, r * r);
  for (int i = 0; i < n; ++i) expect(each[static_cast<std::size_t>(i)] == i * i, "one value each");
  expect(silt::gather(comm, std::span<const double>()).values.empty(), "nothing from anybody");
}

/// Every rank to its two neighbours, with sizes that both know; two messages to the same one in
/// order.
template <silt::Communicator C>
void exchanges_with_neighbours(const C& comm, std::size_t most = 20000) {
  const int r = comm.rank(), n = comm.size(), up = (r + 1) % n, down = (r + n - 1) % n;
  const auto letter = [](int from, int which) { return static_cast<char>(7 * from + which); };
  const auto size = [&](int from, int which) {
    return static_cast<std::size_t>(which * 3 + from) % 11 * (most / 10);
  };
  std::vector<std::vector<char>> out, in;
  std::vector<silt::Outgoing> sends;
  std::vector<silt::Incoming> receives;
  for (const int which : {0, 1, 2}) out.emplace_back(size(r, which), letter(r, which));
  in.emplace_back(size(down, 0)), in.emplace_back(size(down, 1)), in.emplace_back(size(up, 2));
  const auto bytes = [](auto& v) { return std::as_writable_bytes(std::span(v)); };
  sends = {{up, bytes(out[0])}, {up, bytes(out[1])}, {down, bytes(out[2])}};
  receives = {{down, bytes(in[0])}, {down, bytes(in[1])}, {up, bytes(in[2])}};
  auto first = comm.exchange(sends, receives);
  // A second one begins before the first has ended.
  std::vector<int> told{r}, heard{-1};
  const silt::Outgoing tell{up, std::as_bytes(std::span(told))};
  const silt::Incoming hear{down, std::as_writable_bytes(std::span(heard))};
  auto second = comm.exchange({&tell, 1}, {&hear, 1});
  first.wait();
  second.wait();
  expect(heard[0] == down, "the second exchange");
  for (const int which : {0, 1, 2})
    for (const char c : in[static_cast<std::size_t>(which)])
      expect(c == letter(which == 2 ? up : down, which), "what a neighbour sent");
}

/// Rank r sends r + s values to each rank s that it divides.
template <silt::Communicator C>
void delivers_what_nobody_expects(const C& comm) {
  const int r = comm.rank(), n = comm.size();
  std::vector<std::vector<int>> out;
  std::vector<silt::Outgoing> sends;
  for (int s = n - 1; s >= 0; --s)
    if (s % (r + 1) == 0) out.emplace_back(static_cast<std::size_t>(r + s), 1000 * r + s);
  std::size_t k = 0;
  for (int s = n - 1; s >= 0; --s)
    if (s % (r + 1) == 0) sends.push_back({s, std::as_bytes(std::span(out[k++]))});
  const auto came = silt::deliver(comm, sends);
  std::size_t next = 0;
  for (int from = 0; from < n; ++from) {
    if (r % (from + 1) != 0 || from + r == 0) continue;  // empty messages do not come
    expect(next < came.size() && came[next].rank == from, "arrivals in rank order");
    const auto values = silt::values_of<int>(came[next++].bytes);
    expect(values.size() == static_cast<std::size_t>(from + r), "length of a delivery");
    for (const int v : values) expect(v == 1000 * from + r, "what was delivered");
  }
  expect(next == came.size(), "nothing else came");
  expect(silt::deliver(comm, {}).empty(), "nothing from anybody");
}

template <silt::Communicator C>
void all_throw_what_one_rank_throws(const C& comm) {
  const int r = comm.rank(), n = comm.size();
  std::vector<double> told{1.0 * r, 2.0};
  silt::agree(comm, "a step", nullptr, told);
  expect(told[0] == n - 1 && told[1] == 2, "maxima that were agreed on");
  if (n == 1) return;
  const std::string last = "rank " + std::to_string(n - 1) + " of " + std::to_string(n) + ": ";
  try {
    silt::together(comm, "a step", [&] {
      if (r == n - 1)
        throw silt::SimulationError("sphere 7 is lost", 42, {7, 8}, silt::Vec3d{1, 2, 3});
    });
    expect(false, "nothing was thrown");
  } catch (const silt::SimulationError& e) {
    expect(e.what() == last + "sphere 7 is lost", e.what());
    expect(e.step == 42 && e.particles == std::vector<std::uint64_t>{7, 8}, "step and ids");
    expect(silt::Vec3d(e.position) == silt::Vec3d{1, 2, 3}, "place");
    // Agreed on again, at another call, it keeps its sentence.
    const auto error = std::current_exception();
    expect(said([&] { silt::agree(comm, "the end", error); }) == last + "sphere 7 is lost",
           "an error that all have");
  }
  // The lowest of several; whoever fails may be at another call.
  const std::string first = "rank 0 of " + std::to_string(n) + ": ";
  const auto failing = [&](auto error) {
    return said([&] { silt::agree(comm, r == 0 ? "a search" : "a step", error); });
  };
  expect(failing(std::make_exception_ptr(silt::FileError("disk " + std::to_string(r)))) ==
             first + "disk 0",
         "the lowest rank's error");
  expect_words(failing(r == 0 ? std::make_exception_ptr(std::bad_alloc()) : nullptr),
               first + "there is not enough memory");
  expect_words(failing(r == 0 ? std::make_exception_ptr(3) : nullptr), "no std::exception");
  // Nobody fails, but one is elsewhere.
  const auto apart = failing(nullptr);
  expect_words(apart, "out of step: rank 0 is at 'a search', rank 1 is at 'a step'");
  silt::agree(comm, "after that");
}

template <silt::Communicator C>
void refuses_ranks_that_are_not_there(const C& comm) {
  const silt::Outgoing to{comm.size(), {}}, own{0, std::as_bytes(std::span("a"))};
  const silt::Incoming from{-1, {}};
  expect_words(said([&] {
                 (void)comm.exchange({&to, 1}, {});
               }),
               "which is not there; ranks are 0 to");
  expect_words(said([&] { (void)comm.exchange({}, {&from, 1}); }), "rank -1, which is not there");
  expect_words(said([&] { (void)silt::deliver(comm, {&to, 1}); }), "which is not there");
  const std::vector<silt::Outgoing> twice{own, own};
  expect_words(said([&] { (void)silt::deliver(comm, twice); }), "two messages to rank 0");
  std::vector<double> many(silt::most_agreed + 1);
  if (comm.size() > 1)
    expect_words(said([&] { silt::agree(comm, "a step", nullptr, many); }), "there is room for 29");
  expect_words(said([&] { (void)silt::values_of<int>(std::as_bytes(std::span("ab"))); }),
               "a message of 3 bytes cannot be values of 4 bytes");
  // Nobody waits for anything after these.
  comm.barrier();
}

template <silt::Communicator C>
void all_checks(const C& comm) {
  expect(comm.rank() >= 0 && comm.rank() < comm.size(), "a rank's number");
  expect(comm.on_this_machine() == comm.size(), "all ranks share this machine");
  for (int repeat = 0; repeat < 3; ++repeat) {
    reductions_are_the_same_on_all_ranks(comm);
    gathers_in_rank_order(comm);
    exchanges_with_neighbours(comm);
    delivers_what_nobody_expects(comm);
    all_throw_what_one_rank_throws(comm);
    refuses_ranks_that_are_not_there(comm);
  }
}

}  // namespace silt_test
