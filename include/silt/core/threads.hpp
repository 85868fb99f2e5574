// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Number of threads that this machine can run concurrently.
inline int default_threads() {
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

/// Team of threads that execute loops of independent parts together with their owner.
///
/// The work of a part must not depend on the thread: results are then equal for every number of
/// threads. In each loop every thread starts with the same share of consecutive parts, which keeps
/// data of the same particles in its caches. A thread that is done takes parts from the ends of
/// other shares. The owner works too, and waits for parts, not for threads: if a core is taken by
/// another program, only the part on that core is delayed. Waiting threads spin for some
/// microseconds and then sleep, which costs little on a busy machine. (The barriers of OpenMP
/// runtimes spin for milliseconds, and a header cannot change that.)
class Team {
 public:
  Team(int threads = 1)  // NOLINT: implicit
      : shares_(static_cast<std::size_t>(checked(threads))) {
    for (std::size_t k = 1; k < shares_.size(); ++k) workers_.emplace_back([this, k] { work(k); });
  }
  Team(const Team&) = delete;
  ~Team() {
    loop_.store(stop);
    loop_.notify_all();
    for (auto& w : workers_) w.join();
  }

  int threads() const { return static_cast<int>(shares_.size()); }

  static constexpr std::size_t most_ranges = 64;

  /// Calls body(range, from, to) for consecutive ranges that cover 0 ... n-1. Ranges are numbered
  /// from 0, at most most_ranges; they depend only on n and on `least`, the number of items that
  /// are worth a range: 256 particles, or fewer of what takes longer.
  template <class Body>
  void for_ranges(std::size_t n, const Body& body) const {
    for_ranges(n, 256, body);
  }
  template <class Body>
  void for_ranges(std::size_t n, std::size_t least, const Body& body) const {
    const std::size_t ranges = std::clamp<std::size_t>(n / least, 1, most_ranges);
    for_parts(ranges, [&](std::size_t r) { body(r, n * r / ranges, n * (r + 1) / ranges); });
  }

  /// Calls body(part) for part = 0 ... parts-1. Not to be called from within a body. The body is
  /// compiled once, for any number of threads: compilers spend most of their time on bodies.
  template <class Body>
  void for_parts(std::size_t parts, const Body& body) const {
    run(parts, &body,
        [](const void* b, std::size_t part) { (*static_cast<const Body*>(b))(part); });
  }

 private:
  using Call = void (*)(const void*, std::size_t);
  static constexpr std::uint64_t limit = 1u << 20, loops = 1u << 24, stop = ~std::uint64_t{0};

  /// Rest of a thread's share: loop and parts from ... to-1, in 24 + 20 + 20 bits.
  struct Left {
    std::uint64_t loop, from, to;
    explicit Left(std::uint64_t packed)
        : loop(packed >> 40), from(packed >> 20 & (limit - 1)), to(packed & (limit - 1)) {}
    Left(std::uint64_t of, std::uint64_t first, std::uint64_t end)
        : loop(of), from(first), to(end) {}
    std::uint64_t packed() const { return loop << 40 | from << 20 | to; }
  };
  struct alignas(64) Share {
    std::atomic<std::uint64_t> left{0};
  };

  void run(std::size_t parts, const void* body, Call call) const {
    if (workers_.empty() || parts <= 1) {
      for (std::size_t part = 0; part < parts; ++part) call(body, part);
      return;
    }
    SILT_ASSERT(parts < limit);
    call_.store(call, std::memory_order_relaxed);
    body_.store(body, std::memory_order_relaxed);
    done_.store(0, std::memory_order_relaxed);
    const std::uint64_t loop = (loop_.load(std::memory_order_relaxed) + 1) % loops;
    const std::size_t n = shares_.size();
    for (std::size_t t = 0; t < n; ++t)
      shares_[t].left.store(Left{loop, parts * t / n, parts * (t + 1) / n}.packed());
    loop_.store(loop);
    loop_.notify_all();
    take_parts(0);
    wait(done_, [parts](std::size_t done) { return done == parts; });
  }

  static int checked(int threads) {
    require(threads >= 1 && threads <= 4096, "threads = ", threads, " must be in [1, 4096]");
    return threads;
  }

  /// Executes parts of the present loop until none is left. A successful exchange of a share proves
  /// that its loop is still running; call_ and body_ then belong to it.
  void take_parts(std::size_t own) const {
    std::size_t taken = 0;
    for (std::size_t k = 0; k < shares_.size(); ++k) {
      std::atomic<std::uint64_t>& share = shares_[(own + k) % shares_.size()].left;
      std::uint64_t now = share.load();
      for (Left left(now); left.from < left.to; left = Left(now)) {
        const std::uint64_t part = k == 0 ? left.from++ : --left.to;
        if (!share.compare_exchange_weak(now, left.packed())) continue;
        call_.load(std::memory_order_relaxed)(body_.load(std::memory_order_relaxed), part);
        ++taken;
        now = share.load();
      }
    }
    if (taken > 0) {
      done_.fetch_add(taken);
      done_.notify_one();
    }
  }

  void work(std::size_t own) const {
    for (std::uint64_t seen = 0;;) {
      wait(loop_, [&](std::uint64_t loop) { return loop != seen; });
      seen = loop_.load();
      if (seen == stop) return;
      take_parts(own);
    }
  }

  /// Returns when `ready(value)` is true: spins briefly, then sleeps.
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

  mutable std::atomic<std::uint64_t> loop_{0};
  mutable std::atomic<std::size_t> done_{0};
  mutable std::atomic<Call> call_{nullptr};
  mutable std::atomic<const void*> body_{nullptr};
  mutable DynArray<Share> shares_;  // one a thread
  DynArray<std::thread> workers_;
};

namespace detail {

/// Number of pieces of `size` that cover `n`.
constexpr std::size_t pieces(std::size_t n, std::size_t size) { return (n + size - 1) / size; }

}  // namespace detail
}  // namespace silt
