// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// A message to a rank. Its bytes must not change until the exchange has ended.
struct Outgoing {
  int rank;
  std::span<const std::byte> bytes;
};

/// A buffer for a message from a rank, of exactly its size.
struct Incoming {
  int rank;
  std::span<std::byte> bytes;
};

/// A received message whose size was not known before.
struct Arrival {
  int rank;
  std::vector<std::byte> bytes;
};

/// The values of each rank, in rank order: those of rank r are from starts[r] to starts[r + 1].
template <class T>
struct Gathered {
  std::vector<T> values;
  std::vector<std::size_t> starts;

  int ranks() const { return static_cast<int>(starts.size()) - 1; }
  std::span<const T> operator[](int rank) const {
    const auto r = static_cast<std::size_t>(rank);
    return std::span(values).subspan(starts[r], starts[r + 1] - starts[r]);
  }
};

/// Communication between the ranks of a run: MpiComm, ThreadComm, NoRanks.
///
///   rank(), size()           number of this rank, counted from 0, and how many there are
///   on_this_machine()        how many of the ranks share this rank's machine
///   max_of(doubles)          replaces each by its maximum over the ranks; NaN counts as the
///                            largest, and +0 as larger than -0
///   sum_of(whole numbers)    replaces each by its sum over all ranks
///   gather_bytes(bytes)      the bytes of each rank, in rank order, of any lengths
///   swap_counts(counts)      sends counts[r] to rank r; returns what rank r sent to this one
///   exchange(out, in)        starts to send and receive messages of known sizes; returns an object
///                            with wait(), and arrived(), which does not wait. Messages between two
///                            ranks arrive in the order in which they were sent
///   barrier()                returns when all ranks have called it
///   abort(sentence)          ends all ranks with this message
///
/// All but rank(), size(), on_this_machine(), exchange() and abort() are collective: every rank
/// calls them, in the same order. No result depends on the order of arrival of messages: results
/// are bitwise reproducible. A copy refers to the same ranks. Calls are made by one thread per
/// rank.
template <class C>
concept Communicator = std::copy_constructible<C> &&
    requires(const C& comm, std::span<double> numbers, std::span<std::int64_t> wholes,
             std::span<const std::byte> bytes, std::span<const std::uint64_t> counts,
             std::span<const Outgoing> out, std::span<const Incoming> in) {
  { comm.rank() } -> std::same_as<int>;
  { comm.size() } -> std::same_as<int>;
  { comm.on_this_machine() } -> std::same_as<int>;
  comm.max_of(numbers);
  comm.sum_of(wholes);
  { comm.gather_bytes(bytes) } -> std::same_as<Gathered<std::byte>>;
  { comm.swap_counts(counts) } -> std::same_as<std::vector<std::uint64_t>>;
  comm.exchange(out, in).wait();
  comm.barrier();
  comm.abort(std::string_view{});
};

namespace detail {

/// "rank 2 of 4"
[[gnu::cold]] inline std::string rank_words(int rank, int size) {
  return text("rank ", rank, " of ", size);
}

[[gnu::cold]] inline void refuse_message(int rank, int size, int other) {
  throw InputError(text(rank_words(rank, size), ": a message to or from rank ", other,
                        ", which is not there; ranks are 0 to ", size - 1));
}

[[gnu::cold]] inline void refuse_length(int rank, int size, int from, std::size_t wanted,
                                        std::size_t came) {
  throw Error(text(rank_words(rank, size), " expected a message of ", wanted, " bytes from rank ",
                   from, ", and ", came, " bytes came: the ranks are out of step"));
}

}  // namespace detail

/// A single process: rank 0 of 1.
struct NoRanks {
  /// Messages of a rank to itself have arrived when the exchange begins.
  struct Exchange {
    void wait() {}
    bool arrived() { return true; }
  };

  static constexpr int rank() { return 0; }
  static constexpr int size() { return 1; }
  static constexpr int on_this_machine() { return 1; }
  static void barrier() {}
  static void max_of(std::span<double>) {}
  static void sum_of(std::span<std::int64_t>) {}
  static Gathered<std::byte> gather_bytes(std::span<const std::byte> bytes) {
    return {{bytes.begin(), bytes.end()}, {0, bytes.size()}};
  }
  static std::vector<std::uint64_t> swap_counts(std::span<const std::uint64_t> counts) {
    return {counts.begin(), counts.end()};
  }
  static Exchange exchange(std::span<const Outgoing> out, std::span<const Incoming> in) {
    for (const auto& message : out)
      if (message.rank != 0) detail::refuse_message(0, 1, message.rank);
    for (std::size_t k = 0; k < in.size(); ++k) {
      if (in[k].rank != 0) detail::refuse_message(0, 1, in[k].rank);
      const std::size_t came = k < out.size() ? out[k].bytes.size() : 0;
      if (in[k].bytes.size() != came) detail::refuse_length(0, 1, 0, in[k].bytes.size(), came);
      if (came > 0) std::memmove(in[k].bytes.data(), out[k].bytes.data(), came);
    }
    return {};
  }
  [[noreturn]] static void abort(std::string_view sentence) { throw Error(std::string(sentence)); }
};
static_assert(Communicator<NoRanks>);

/// Converts received bytes to the values that another rank has sent.
template <class T>
requires std::is_trivially_copyable_v<T> std::vector<T> values_of(
    std::span<const std::byte> bytes) {
  require(bytes.size() % sizeof(T) == 0, "a message of ", bytes.size(),
          " bytes cannot be values of ", sizeof(T), " bytes each");
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

/// Collective: the values of each rank, in rank order.
template <class T, Communicator C>
requires std::is_trivially_copyable_v<T> Gathered<T> gather(const C& comm,
                                                            std::span<const T> values) {
  auto bytes = comm.gather_bytes(std::as_bytes(values));
  Gathered<T> all{values_of<T>(bytes.values), std::move(bytes.starts)};
  for (auto& start : all.starts) start /= sizeof(T);
  return all;
}

/// Collective: one value per rank, in rank order.
template <class T, Communicator C>
requires std::is_trivially_copyable_v<T> std::vector<T> gather_each(const C& comm, const T& value) {
  return gather(comm, std::span<const T>(&value, 1)).values;
}

/// Collective: the sum of one number per rank, added in rank order.
template <Communicator C>
double sum(const C& comm, double own) {
  double all = 0;
  for (const double one : gather_each(comm, own)) all += one;
  return all;
}

/// Collective: sends messages whose sizes the receivers do not know, at most one to each rank.
/// Returns the received messages, in rank order; empty ones are not sent.
template <Communicator C>
std::vector<Arrival> deliver(const C& comm, std::span<const Outgoing> out) {
  std::vector<std::uint64_t> counts(static_cast<std::size_t>(comm.size()), 0);
  std::vector<Outgoing> sent;
  for (const auto& message : out) {
    if (message.rank < 0 || message.rank >= comm.size())
      detail::refuse_message(comm.rank(), comm.size(), message.rank);
    auto& count = counts[static_cast<std::size_t>(message.rank)];
    require(count == 0, detail::rank_words(comm.rank(), comm.size()), ": two messages to rank ",
            message.rank, " in one delivery; join them");
    count = message.bytes.size();
    if (count > 0) sent.push_back(message);
  }
  const auto coming = comm.swap_counts(counts);
  std::vector<Arrival> arrivals;
  for (std::size_t r = 0; r < coming.size(); ++r)
    if (coming[r] > 0) arrivals.push_back({static_cast<int>(r), std::vector<std::byte>(coming[r])});
  std::vector<Incoming> in;
  for (auto& arrival : arrivals) in.push_back({arrival.rank, arrival.bytes});
  comm.exchange(sent, in).wait();
  return arrivals;
}

}  // namespace silt
