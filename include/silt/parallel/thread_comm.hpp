// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <silt/parallel/comm.hpp>
#include <silt/parallel/ordered_key.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// A rank cannot continue because another one does not arrive.
struct RankLost : Error {
  using Error::Error;
};

/// Where the ranks of a ThreadComm synchronise. Each collective call is a round: a rank deposits
/// its data, waits until all have, and reads. The data of a round stay until their rank enters the
/// round after the next, which it can only do when all have read.
class ThreadHub {
 public:
  ThreadHub(int ranks, std::chrono::duration<double> patience)
      : patience_(patience), seats_(static_cast<std::size_t>(ranks)) {}

  int size() const { return static_cast<int>(seats_.size()); }

  /// Calls read(r, bytes) for the data of each rank r in this round, in rank order.
  template <class Read>
  void meet(int rank, const char* call, std::span<const std::byte> given, const Read& read) {
    std::unique_lock lock(mutex_);
    Seat& own = seat(rank);
    const std::uint64_t round = ++own.rounds;
    const std::size_t side = round % 2;
    own.given[side].assign(given.begin(), given.end());
    own.calls[side] = call;
    if (std::all_of(seats_.begin(), seats_.end(), [&](auto& s) { return s.rounds >= round; }))
      for (auto& other : seats_) other.awake.notify_one();
    wait(lock, rank, call, [&](int r) { return seat(r).rounds < round; });
    for (const auto& other : seats_)
      if (std::string_view(other.calls[side]) != call) fail(out_of_step(side));
    lock.unlock();
    for (int r = 0; r < size(); ++r) read(r, std::span<const std::byte>(seat(r).given[side]));
  }

  void send(int from, int to, std::span<const std::byte> bytes) {
    const std::lock_guard lock(mutex_);
    mail_[{from, to}].emplace_back(bytes.begin(), bytes.end());
    seat(to).awake.notify_one();
  }

  std::vector<std::byte> receive(int from, int to) {
    std::unique_lock lock(mutex_);
    auto& mail = mail_[{from, to}];
    wait(lock, to, "exchange", [&](int r) { return r == from && mail.empty(); });
    auto bytes = std::move(mail.front());
    mail.pop_front();
    return bytes;
  }

  /// Number of messages waiting for `to` from `from`.
  std::size_t waiting(int from, int to) {
    const std::lock_guard lock(mutex_);
    return mail_[{from, to}].size();
  }

  /// A rank has ended; `why` is empty if it ended without an error.
  void leave(int rank, const std::string& why) {
    const std::lock_guard lock(mutex_);
    seat(rank).left = true;
    seat(rank).why = why;
    for (auto& other : seats_) other.awake.notify_one();
  }

  [[noreturn]] void abort(int rank, std::string_view sentence) {
    const std::lock_guard lock(mutex_);
    fail(text(rank_words(rank, size()), ": ", sentence));
  }

 private:
  struct Seat {
    std::uint64_t rounds = 0;
    std::array<std::vector<std::byte>, 2> given;
    std::array<const char*, 2> calls{"", ""};
    const char* waits_in = nullptr;
    bool left = false;
    std::string why;
    std::condition_variable awake;
  };

  Seat& seat(int rank) { return seats_[static_cast<std::size_t>(rank)]; }

  /// Waits until missing(r) is false for all ranks. Throws if a rank will never arrive.
  template <class Missing>
  void wait(std::unique_lock<std::mutex>& lock, int rank, const char* call,
            const Missing& missing) {
    const auto until = std::chrono::steady_clock::now() +
                       std::chrono::duration_cast<std::chrono::steady_clock::duration>(patience_);
    bool late = false;
    seat(rank).waits_in = call;
    while (true) {
      bool all = true, gone = false;
      for (int r = 0; r < size(); ++r)
        if (missing(r)) all = false, gone = gone || seat(r).left;
      if (all) break;
      if (!broken_.empty()) throw RankLost(broken_);
      if (gone || late) {
        const std::string sentence = absent(rank, call, missing, late);
        if (late) fail(sentence);
        throw RankLost(sentence);
      }
      late = seat(rank).awake.wait_until(lock, until) == std::cv_status::timeout;
    }
    seat(rank).waits_in = nullptr;
  }

  template <class Missing>
  [[gnu::cold]] std::string absent(int rank, const char* call, const Missing& missing, bool late) {
    std::string who;
    for (int r = 0; r < size(); ++r) {
      if (!missing(r)) continue;
      const Seat& other = seat(r);
      who += text(who.empty() ? "" : ", ", "rank ", r,
                  other.left && other.why.empty() ? " (it has ended)"
                  : other.left                    ? text(" (it has ended with: ", other.why, ")")
                  : other.waits_in != nullptr     ? text(" (it waits in ", other.waits_in, ")")
                                                  : std::string());
    }
    return text(rank_words(rank, size()), late ? text(" has waited ", patience_.count(), " s") : "",
                late ? " in " : " cannot end ", call, late ? " for " : " without ", who);
  }

  [[gnu::cold]] std::string out_of_step(std::size_t side) {
    std::string who;
    for (int r = 0; r < size(); ++r)
      who += text(r == 0 ? "" : ", ", "rank ", r, " calls ", seat(r).calls[side]);
    return text("the ranks are out of step: ", who);
  }

  /// Called when no rank can continue; the mutex is held.
  [[noreturn, gnu::cold]] void fail(const std::string& sentence) {
    if (broken_.empty()) broken_ = sentence;
    for (auto& other : seats_) other.awake.notify_one();
    throw RankLost(broken_);
  }

  std::chrono::duration<double> patience_;
  std::mutex mutex_;
  std::deque<Seat> seats_;
  std::map<std::array<int, 2>, std::deque<std::vector<std::byte>>> mail_;
  std::string broken_;
};

}  // namespace detail

/// Ranks as threads of one program, for tests: MPI is not needed, and sanitizers check the
/// communication. See run_on_ranks.
///
/// Errors: a rank that waits for one that has ended, or longer than the patience of run_on_ranks,
///         gets an Error that names the missing ranks and the call; so do ranks that make different
///         calls.
/// Tests:  tests/parallel/comm.cpp.
class ThreadComm {
 public:
  ThreadComm(detail::ThreadHub& hub, int rank) : hub_(&hub), rank_(rank) {}

  class Exchange {
   public:
    Exchange(detail::ThreadHub& hub, int rank, std::span<const Incoming> in)
        : hub_(&hub), rank_(rank), in_(in.begin(), in.end()) {}
    Exchange(Exchange&& other) noexcept
        : hub_(other.hub_), rank_(other.rank_), in_(std::exchange(other.in_, {})) {}
    ~Exchange() {
      try {
        wait();
      } catch (...) {  // whoever did not wait has an error of its own
      }
    }

    void wait() {
      for (const auto& message : std::exchange(in_, {})) {
        const auto bytes = hub_->receive(message.rank, rank_);
        if (bytes.size() != message.bytes.size())
          detail::refuse_length(rank_, hub_->size(), message.rank, message.bytes.size(),
                                bytes.size());
        std::copy(bytes.begin(), bytes.end(), message.bytes.begin());
      }
    }
    bool arrived() {
      std::map<int, std::size_t> wanted;
      for (const auto& message : in_) ++wanted[message.rank];
      for (const auto& [from, messages] : wanted)
        if (hub_->waiting(from, rank_) < messages) return false;
      return true;
    }

   private:
    detail::ThreadHub* hub_;
    int rank_;
    std::vector<Incoming> in_;
  };

  int rank() const { return rank_; }
  int size() const { return hub_->size(); }
  int on_this_machine() const { return hub_->size(); }

  void barrier() const {
    hub_->meet(rank_, "barrier", {}, [](int, std::span<const std::byte>) {});
  }
  void max_of(std::span<double> numbers) const {
    reduce("max_of", numbers, [](double a, double b) {
      return detail::value_of_key(std::max(detail::ordered_key(a), detail::ordered_key(b)));
    });
  }
  void sum_of(std::span<std::int64_t> wholes) const {
    reduce("sum_of", wholes, [](std::int64_t a, std::int64_t b) { return a + b; });
  }
  Gathered<std::byte> gather_bytes(std::span<const std::byte> bytes) const {
    Gathered<std::byte> all{{}, {0}};
    hub_->meet(rank_, "gather_bytes", bytes, [&](int, std::span<const std::byte> given) {
      all.values.insert(all.values.end(), given.begin(), given.end());
      all.starts.push_back(all.values.size());
    });
    return all;
  }
  std::vector<std::uint64_t> swap_counts(std::span<const std::uint64_t> counts) const {
    std::vector<std::uint64_t> mine(counts.size());
    hub_->meet(rank_, "swap_counts", std::as_bytes(counts),
               [&](int r, std::span<const std::byte> given) {
                 const auto theirs = values_of<std::uint64_t>(given);
                 mine[static_cast<std::size_t>(r)] = theirs[static_cast<std::size_t>(rank_)];
               });
    return mine;
  }
  [[nodiscard]] Exchange exchange(std::span<const Outgoing> out,
                                  std::span<const Incoming> in) const {
    for (const auto& message : in)
      if (message.rank < 0 || message.rank >= size())
        detail::refuse_message(rank_, size(), message.rank);
    for (const auto& message : out)
      if (message.rank < 0 || message.rank >= size())
        detail::refuse_message(rank_, size(), message.rank);
    for (const auto& message : out) hub_->send(rank_, message.rank, message.bytes);
    return {*hub_, rank_, in};
  }
  [[noreturn]] void abort(std::string_view sentence) const { hub_->abort(rank_, sentence); }

 private:
  template <class T, class Both>
  void reduce(const char* call, std::span<T> numbers, const Both& both) const {
    hub_->meet(rank_, call, std::as_bytes(numbers), [&](int r, std::span<const std::byte> given) {
      const auto theirs = values_of<T>(given);
      if (theirs.size() != numbers.size())
        detail::refuse_length(rank_, size(), r, numbers.size_bytes(), given.size());
      if (r == rank_) return;
      for (std::size_t k = 0; k < theirs.size(); ++k) numbers[k] = both(numbers[k], theirs[k]);
    });
  }

  detail::ThreadHub* hub_;
  int rank_;
};
static_assert(Communicator<ThreadComm>);

/// Runs f(comm) on the given number of ranks, each a thread, and waits for all. An error of a rank
/// is rethrown, that of the lowest rank if there are several; errors that only report a missing
/// rank come last. No rank waits longer than `patience` [s] for another.
template <class F>
void run_on_ranks(int ranks, const F& f, double patience = 60) {
  require(ranks >= 1, "run_on_ranks: ", ranks, " ranks [-] must be at least 1");
  detail::ThreadHub hub(ranks, std::chrono::duration<double>(patience));
  std::vector<std::exception_ptr> errors(static_cast<std::size_t>(ranks));
  std::vector<char> lost(errors.size(), 0);
  std::vector<std::thread> threads;
  for (int rank = 0; rank < ranks; ++rank)
    threads.emplace_back([&, rank] {
      const auto r = static_cast<std::size_t>(rank);
      std::string why;
      try {
        f(ThreadComm(hub, rank));
      } catch (const std::exception& e) {
        errors[r] = std::current_exception();
        lost[r] = dynamic_cast<const detail::RankLost*>(&e) != nullptr;
        why = e.what();
      } catch (...) {
        errors[r] = std::current_exception();
        why = "an exception without a sentence";
      }
      hub.leave(rank, why);
    });
  for (auto& thread : threads) thread.join();
  for (const bool as_last : {false, true})
    for (std::size_t r = 0; r < errors.size(); ++r)
      if (errors[r] && (lost[r] != 0) == as_last) std::rethrow_exception(errors[r]);
}

}  // namespace silt
