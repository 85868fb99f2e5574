// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>
#include <vector>

#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// How many threads this machine runs at once.
inline int default_threads() {
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

/// Threads that share loops of independent parts with the one that owns them.
///
/// What a part does must not depend on who does it: results are then the same for every number of
/// threads. Parts are handed out one by one, the owner takes part, and it waits for parts, not for
/// threads: where a core is taken away only the part on that core is held up. Whoever waits spins
/// for some microseconds and then sleeps, so that a busy machine loses nothing to waiting (the
/// barriers of OpenMP runtimes spin for milliseconds, and a header cannot tell them otherwise).
class Team {
 public:
  Team(int threads = 1) {  // NOLINT: a number of threads is a team
    require(threads >= 1 && threads <= 4096, "threads = ", threads, " must be in [1, 4096]");
    for (int k = 1; k < threads; ++k) workers_.emplace_back([this] { work(); });
  }
  Team(const Team&) = delete;
  ~Team() {
    ticket_.store(stop);
    ticket_.notify_all();
    for (auto& w : workers_) w.join();
  }

  int threads() const { return static_cast<int>(workers_.size()) + 1; }

  static constexpr std::size_t most_ranges = 64;

  /// Calls body(range, from, to) for consecutive ranges that cover 0 ... n-1. Ranges are numbered
  /// from 0, at most most_ranges; which ones there are depends on n alone.
  template <class Body>
  void for_ranges(std::size_t n, const Body& body) const {
    const std::size_t ranges = std::clamp<std::size_t>(n / 256, 1, most_ranges);
    for_parts(ranges, [&](std::size_t r) { body(r, n * r / ranges, n * (r + 1) / ranges); });
  }

  /// Calls body(part) for part = 0 ... parts-1. Not to be called from within a body.
  template <class Body>
  void for_parts(std::size_t parts, const Body& body) const {
    if (workers_.empty() || parts <= 1) {
      for (std::size_t part = 0; part < parts; ++part) body(part);
      return;
    }
    SILT_ASSERT(parts < limit);
    call_.store([](const void* b, std::size_t part) { (*static_cast<const Body*>(b))(part); },
                std::memory_order_relaxed);
    body_.store(&body, std::memory_order_relaxed);
    done_.store(0, std::memory_order_relaxed);
    epoch_ = (epoch_ + 1) & (limit - 1);
    ticket_.store(epoch_ << 40 | parts << 20);
    ticket_.notify_all();
    take_parts();
    wait(done_, [parts](std::size_t done) { return done == parts; });
  }

 private:
  // A ticket says which loop it is, how many parts it has, and which is the next: 24 + 20 + 20
  // bits.
  static constexpr std::uint64_t limit = 1u << 20, stop = ~std::uint64_t{0};
  static std::uint64_t parts_of(std::uint64_t ticket) { return ticket >> 20 & (limit - 1); }
  static std::uint64_t next_of(std::uint64_t ticket) { return ticket & (limit - 1); }

  /// Does parts of the present loop until none is left. That an exchange of the ticket succeeds
  /// proves that the loop is still under way, so that call_ and body_ belong to it.
  void take_parts() const {
    std::uint64_t ticket = ticket_.load();
    while (ticket != stop && next_of(ticket) < parts_of(ticket)) {
      if (!ticket_.compare_exchange_weak(ticket, ticket + 1)) continue;
      const std::size_t parts = parts_of(ticket);
      call_.load(std::memory_order_relaxed)(body_.load(std::memory_order_relaxed), next_of(ticket));
      if (done_.fetch_add(1) + 1 == parts) done_.notify_one();
      ticket = ticket_.load();
    }
  }

  void work() const {
    for (std::uint64_t seen = 0;;) {
      wait(ticket_, [&](std::uint64_t t) { return t == stop || t >> 40 != seen >> 40; });
      seen = ticket_.load();
      if (seen == stop) return;
      take_parts();
    }
  }

  /// Returns when `ready(value)` holds: spins a little, then sleeps.
  template <class T, class Ready>
  static void wait(const std::atomic<T>& value, const Ready& ready) {
    for (int spin = 0; spin < 2000; ++spin) {
      if (ready(value.load())) return;
#if defined(__x86_64__) || defined(__i386__)
      __builtin_ia32_pause();
#endif
    }
    for (T now = value.load(); !ready(now); now = value.load()) value.wait(now);
  }

  using Call = void (*)(const void*, std::size_t);
  mutable std::atomic<std::uint64_t> ticket_{0};
  mutable std::atomic<std::size_t> done_{0};
  mutable std::atomic<Call> call_{nullptr};
  mutable std::atomic<const void*> body_{nullptr};
  mutable std::uint64_t epoch_ = 0;
  std::vector<std::thread> workers_;
};

namespace detail {

/// The number of pieces of `size` that cover `n`.
constexpr std::size_t pieces(std::size_t n, std::size_t size) { return (n + size - 1) / size; }

}  // namespace detail
}  // namespace silt
