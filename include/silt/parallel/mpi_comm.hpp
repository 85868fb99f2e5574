// silt - BSD-3-Clause, see LICENSE
#pragma once

#if !__has_include(<mpi.h>)
#error \
    "silt/mpi.hpp needs MPI (Debian: apt-get install libopenmpi-dev openmpi-bin); link silt::mpi, or compile with mpicxx"
#endif
// The C++ bindings of old MPI libraries are not needed.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <silt/parallel/agree.hpp>
#include <silt/parallel/comm.hpp>
#include <silt/parallel/ordered_key.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// Throws if an MPI call has failed.
inline void check_mpi(int code, const char* call) {
  if (code == MPI_SUCCESS) [[likely]]
    return;
  char words[MPI_MAX_ERROR_STRING] = "";
  int length = 0, rank = 0, size = 0;
  MPI_Error_string(code, words, &length);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  throw Error(text(rank_words(rank, size), ": ", call, " has failed: ", words));
}

[[gnu::cold]] inline void check_mpi_runs() {
  int begun = 0, ended = 0, level = MPI_THREAD_SINGLE;
  MPI_Initialized(&begun);
  require(begun != 0, "MPI has not begun: make a silt::Mpi at the start of main()");
  MPI_Finalized(&ended);
  require(ended == 0, "MPI has ended already: ranks cannot talk after MPI_Finalize");
  MPI_Query_thread(&level);
  require(level >= MPI_THREAD_FUNNELED,
          "MPI was begun for programs of one thread (MPI_Init); make a silt::Mpi instead, or call "
          "MPI_Init_thread with MPI_THREAD_FUNNELED");
}

/// A communicator of silt's own, so that its messages cannot be confused with others.
class OwnedMpiComm {
 public:
  explicit OwnedMpiComm(MPI_Comm of) {
    check_mpi_runs();
    require(of != MPI_COMM_NULL,
            "MpiComm: this process is not in the communicator (MPI_COMM_NULL)");
    int two_groups = 0;
    check_mpi(MPI_Comm_test_inter(of, &two_groups), "MPI_Comm_test_inter");
    require(two_groups == 0,
            "MpiComm: a communicator between two groups (an intercommunicator) "
            "cannot be used; merge them by MPI_Intercomm_merge");
    check_mpi(MPI_Comm_dup(of, &comm), "MPI_Comm_dup");
    MPI_Comm_set_errhandler(comm, MPI_ERRORS_RETURN);
    MPI_Comm_rank(comm, &rank);
    MPI_Comm_size(comm, &size);
    MPI_Comm near = MPI_COMM_NULL;
    check_mpi(MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, rank, MPI_INFO_NULL, &near),
              "MPI_Comm_split_type");
    MPI_Comm_size(near, &on_this_machine);
    MPI_Comm_free(&near);
  }
  OwnedMpiComm(const OwnedMpiComm&) = delete;
  OwnedMpiComm& operator=(const OwnedMpiComm&) = delete;
  ~OwnedMpiComm() {
    int ended = 0;
    MPI_Finalized(&ended);
    // All ranks must reach this call; a rank that is unwinding an exception may be alone.
    if (ended == 0 && std::uncaught_exceptions() == 0) MPI_Comm_free(&comm);
  }

  MPI_Comm comm = MPI_COMM_NULL;
  int rank = 0, size = 1, on_this_machine = 1;
};

}  // namespace detail

/// The ranks of an MPI communicator, which is duplicated (a collective call; copies share the
/// duplicate). MPI_THREAD_FUNNELED is sufficient.
///
/// Errors: InputError if MPI is not running, Error with MPI's message if one of its calls fails.
/// Tests:  tests/mpi.
class MpiComm {
 public:
  /// Messages longer than `piece` [bytes] are sent in pieces, because MPI counts in int.
  MpiComm(MPI_Comm of, std::size_t piece = std::size_t{1} << 30)  // NOLINT: converts
      : own_(new detail::OwnedMpiComm(of), end_together), piece_(piece) {
    require(piece >= 1 && piece <= std::size_t{std::numeric_limits<int>::max()},
            "MpiComm: pieces of ", piece, " bytes must be in [1, 2147483647]");
  }

  /// Messages in transit. They are completed before the object is destroyed.
  class Exchange {
   public:
    Exchange(Exchange&& other) noexcept
        : own_(std::move(other.own_)),
          requests_(std::exchange(other.requests_, {})),
          expected_(std::exchange(other.expected_, {})) {}
    ~Exchange() {
      for (auto& request : requests_) MPI_Wait(&request, MPI_STATUS_IGNORE);
    }

    void wait() {
      auto requests = std::exchange(requests_, {});
      if (requests.empty()) return;
      // One by one: in Open MPI 4.1 MPI_Waitall may hang if a message is longer than its buffer.
      std::string refusal;
      for (std::size_t k = 0; k < requests.size(); ++k) {  // receives come first
        MPI_Status state{};
        try {
          detail::check_mpi(MPI_Wait(&requests[k], &state), "a message of an exchange");
          int came = 0;
          if (k < expected_.size()) MPI_Get_count(&state, MPI_BYTE, &came);
          if (k < expected_.size() && came != expected_[k])
            detail::refuse_length(own_->rank, own_->size, state.MPI_SOURCE,
                                  static_cast<std::size_t>(expected_[k]),
                                  static_cast<std::size_t>(came));
        } catch (const Error& e) {  // the others must be completed first
          if (refusal.empty()) refusal = e.what();
        }
      }
      if (!refusal.empty()) throw Error(refusal);
      expected_.clear();
    }

    /// Whether all messages are completed; lets MPI make progress on them.
    bool arrived() {
      if (requests_.empty()) return true;
      int all = 0;
      // Tested one by one: MPI_Testall would lose the lengths of those that have arrived.
      for (auto& request : requests_) {
        detail::check_mpi(MPI_Request_get_status(request, &all, MPI_STATUS_IGNORE),
                          "MPI_Request_get_status");
        if (all == 0) return false;
      }
      return true;
    }

   private:
    friend class MpiComm;
    explicit Exchange(std::shared_ptr<detail::OwnedMpiComm> own) : own_(std::move(own)) {}

    std::shared_ptr<detail::OwnedMpiComm> own_;
    std::vector<MPI_Request> requests_;
    std::vector<int> expected_;  // [bytes], of the receives
  };

  int rank() const { return own_->rank; }
  int size() const { return own_->size; }
  int on_this_machine() const { return own_->on_this_machine; }

  void barrier() const { detail::check_mpi(MPI_Barrier(own_->comm), "MPI_Barrier"); }

  void max_of(std::span<double> numbers) const {
    std::vector<std::int64_t> keys(numbers.size());
    std::transform(numbers.begin(), numbers.end(), keys.begin(), detail::ordered_key);
    reduce(keys, MPI_MAX);
    std::transform(keys.begin(), keys.end(), numbers.begin(), detail::value_of_key);
  }
  void sum_of(std::span<std::int64_t> wholes) const { reduce(wholes, MPI_SUM); }

  Gathered<std::byte> gather_bytes(std::span<const std::byte> bytes) const {
    const auto n = static_cast<std::size_t>(size());
    const std::uint64_t own = bytes.size();
    std::vector<std::uint64_t> sizes(n);
    detail::check_mpi(
        MPI_Allgather(&own, 1, MPI_UINT64_T, sizes.data(), 1, MPI_UINT64_T, own_->comm),
        "MPI_Allgather");
    Gathered<std::byte> all{{}, {0}};
    for (const auto s : sizes) all.starts.push_back(all.starts.back() + s);
    all.values.resize(all.starts.back());
    if (all.values.size() <= piece_) {
      std::vector<int> counts(sizes.begin(), sizes.end()),
          starts(all.starts.begin(), all.starts.end() - 1);
      gather_round(bytes, counts, starts, all.values.data());
      return all;
    }
    // In rounds, each within the range that MPI can count.
    const std::size_t most = std::max<std::size_t>(1, piece_ / n);
    std::vector<std::byte> round;
    const std::size_t longest = *std::max_element(sizes.begin(), sizes.end());
    for (std::size_t from = 0; from < longest; from += most) {
      std::vector<int> counts(n), starts(n);
      int end = 0;
      for (std::size_t r = 0; r < n; ++r) {
        starts[r] = end;
        counts[r] = static_cast<int>(std::min(most, sizes[r] - std::min(sizes[r], from)));
        end += counts[r];
      }
      round.resize(static_cast<std::size_t>(end));
      gather_round(bytes.subspan(std::min(from, bytes.size())), counts, starts, round.data());
      for (std::size_t r = 0; r < n; ++r)
        std::copy_n(round.begin() + starts[r], counts[r],
                    all.values.begin() + static_cast<std::ptrdiff_t>(all.starts[r] + from));
    }
    return all;
  }

  std::vector<std::uint64_t> swap_counts(std::span<const std::uint64_t> counts) const {
    require(counts.size() == static_cast<std::size_t>(size()), "swap_counts: ", counts.size(),
            " counts for ", size(), " ranks");
    std::vector<std::uint64_t> mine(counts.size());
    detail::check_mpi(
        MPI_Alltoall(counts.data(), 1, MPI_UINT64_T, mine.data(), 1, MPI_UINT64_T, own_->comm),
        "MPI_Alltoall");
    return mine;
  }

  [[nodiscard]] Exchange exchange(std::span<const Outgoing> out,
                                  std::span<const Incoming> in) const {
    for (const auto& message : in)
      if (message.rank < 0 || message.rank >= size())
        detail::refuse_message(rank(), size(), message.rank);
    for (const auto& message : out)
      if (message.rank < 0 || message.rank >= size())
        detail::refuse_message(rank(), size(), message.rank);
    Exchange pending(own_);
    auto& requests = pending.requests_;
    for (const auto& message : in)
      in_pieces(message.bytes, [&](std::byte* from, int count) {
        MPI_Request request = MPI_REQUEST_NULL;
        detail::check_mpi(MPI_Irecv(from, count, MPI_BYTE, message.rank, tag, own_->comm, &request),
                          "MPI_Irecv");
        requests.push_back(request);
        pending.expected_.push_back(count);
      });
    for (const auto& message : out)
      in_pieces(message.bytes, [&](const std::byte* from, int count) {
        MPI_Request request = MPI_REQUEST_NULL;
        detail::check_mpi(MPI_Isend(from, count, MPI_BYTE, message.rank, tag, own_->comm, &request),
                          "MPI_Isend");
        requests.push_back(request);
      });
    return pending;
  }

  [[noreturn]] void abort(std::string_view sentence) const {
    const std::string who = detail::rank_words(rank(), size());
    std::fprintf(stderr, "silt: %s: %.*s\n", who.c_str(), static_cast<int>(sentence.size()),
                 sentence.data());
    std::fflush(stderr);
    MPI_Abort(own_->comm, 1);
    std::abort();
  }

  /// The duplicate, for libraries that need an MPI communicator.
  MPI_Comm mpi() const { return own_->comm; }

 private:
  MpiComm() : piece_(std::size_t{1} << 30) {}
  static constexpr int tag = 0;

  void reduce(std::span<std::int64_t> wholes, MPI_Op op) const {
    detail::check_mpi(MPI_Allreduce(MPI_IN_PLACE, wholes.data(), static_cast<int>(wholes.size()),
                                    MPI_INT64_T, op, own_->comm),
                      "MPI_Allreduce");
  }

  void gather_round(std::span<const std::byte> bytes, const std::vector<int>& counts,
                    const std::vector<int>& starts, std::byte* to) const {
    const int own = counts[static_cast<std::size_t>(rank())];
    detail::check_mpi(MPI_Allgatherv(bytes.data(), own, MPI_BYTE, to, counts.data(), starts.data(),
                                     MPI_BYTE, own_->comm),
                      "MPI_Allgatherv");
  }

  /// Also one piece for an empty message.
  template <class Byte, class Send>
  void in_pieces(std::span<Byte> bytes, const Send& send) const {
    do {
      const std::size_t count = std::min(piece_, bytes.size());
      send(bytes.data(), static_cast<int>(count));
      bytes = bytes.subspan(count);
    } while (!bytes.empty());
  }

  /// The last copy ends when those of the other ranks do. A rank that waits in a call which the
  /// others do not make, as in `if (comm.rank() == 0) sim.kinetic_energy()`, is told so here.
  static void end_together(detail::OwnedMpiComm* own) noexcept;

  std::shared_ptr<detail::OwnedMpiComm> own_;
  std::size_t piece_;
};
static_assert(Communicator<MpiComm>);

/// Initialises and finalises MPI; create one at the start of main().
///
///   int main(int argc, char** argv) {
///     silt::Mpi mpi(argc, argv);
///     ...
///   }
///
/// An exception that leaves main() is reported once, with the number of its rank, and ends all
/// ranks with a non-zero status (instead of the language's own message from each rank). If main()
/// catches an exception itself it must call fail(), as the other ranks may be waiting for this one.
class Mpi {
 public:
  Mpi(int& argc, char**& argv) {
    int begun = 0, level = MPI_THREAD_SINGLE;
    MPI_Initialized(&begun);
    require(begun == 0,
            "silt::Mpi: MPI has begun already; a program has one silt::Mpi, or calls "
            "MPI_Init_thread itself");
    const int code = MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);
    require(code == MPI_SUCCESS, "MPI could not begin (MPI_Init_thread: ", code, ")");
    own() = std::make_unique<detail::OwnedMpiComm>(MPI_COMM_WORLD);
    words() = detail::rank_words(own()->rank, own()->size);
    std::set_terminate(end_all);
  }
  Mpi(const Mpi&) = delete;
  Mpi& operator=(const Mpi&) = delete;
  ~Mpi() {
    if (std::uncaught_exceptions() > 0 && !meet(5)) {
      std::fprintf(stderr,
                   "silt: %s leaves by an exception, and other ranks do not: all are ended. Let it "
                   "leave main(), or call silt::Mpi::fail, to see its sentence\n",
                   words().c_str());
      end();
    }
    own() = nullptr;  // the handler stays, for an exception that propagates
    MPI_Finalize();
  }

  /// All ranks of the program.
  MpiComm comm() const { return MPI_COMM_WORLD; }
  int rank() const { return own()->rank; }
  int size() const { return own()->size; }

  /// Reports what has failed, and ends all ranks.
  [[noreturn]] static void fail(std::string_view sentence) {
    const bool by_all = !detail::last_agreed().empty() && sentence == detail::last_agreed();
    // An error that all ranks throw is reported by rank 0; the others wait for that. After MPI was
    // finalised they cannot.
    if (!by_all || !own() || own()->rank == 0)
      std::fprintf(stderr, "silt: %s%s%.*s\n", by_all ? "" : words().c_str(), by_all ? "" : ": ",
                   static_cast<int>(sentence.size()), sentence.data());
    std::fflush(stderr);
    if (by_all && own()) meet(5);
    end();
  }

 private:
  static std::unique_ptr<detail::OwnedMpiComm>& own() {
    static std::unique_ptr<detail::OwnedMpiComm> comm;
    return comm;
  }
  static std::string& words() {  // "rank 2 of 4", also after the end of MPI
    static std::string who;
    return who;
  }

  /// Whether all ranks arrive here within some seconds.
  static bool meet(double seconds) {
    MPI_Request request = MPI_REQUEST_NULL;
    if (MPI_Ibarrier(own()->comm, &request) != MPI_SUCCESS) return false;
    int all = 0;
    for (int k = 0; k < 1000 * seconds; ++k) {
      if (MPI_Test(&request, &all, MPI_STATUS_IGNORE) != MPI_SUCCESS) return false;
      if (all != 0) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }

  [[noreturn]] static void end() {
    std::fflush(nullptr);
    if (own()) MPI_Abort(MPI_COMM_WORLD, 1);
    std::_Exit(1);  // MPI has ended
  }

  /// Called by std::terminate, with an uncaught exception or without one.
  static void end_all() {
    std::string sentence = "std::terminate was called";
    if (const auto error = std::current_exception())
      sentence = detail::ErrorMessage::of(error).sentence;
    fail(sentence);
  }
};

inline void MpiComm::end_together(detail::OwnedMpiComm* own) noexcept {
  const std::unique_ptr<detail::OwnedMpiComm> last(own);
  int ended = 0;
  MPI_Finalized(&ended);
  // A rank that an exception unwinds may be alone.
  if (ended != 0 || std::uncaught_exceptions() > 0) return;
  MpiComm comm;
  comm.own_ = std::shared_ptr<detail::OwnedMpiComm>(own, [](auto*) {});
  try {
    silt::agree(comm, "the end of a simulation or communicator");
  } catch (const std::exception& e) {
    Mpi::fail(e.what());
  }
}

}  // namespace silt
