// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include <silt/parallel/agreed.hpp>
#include <silt/parallel/comm.hpp>

namespace silt::inline SILT_TARGET {

/// How many numbers agree() can carry in addition to its own.
inline constexpr std::size_t most_agreed = 29;

namespace detail {

/// An error as bytes, so that another rank can throw it as the same type.
struct ErrorMessage {
  enum class Kind : char { None, Plain, Input, File, Simulation, FlowStep, Memory };
  Kind kind = Kind::None;
  std::string sentence;
  std::int64_t step = 0;
  double longest = 0;
  std::array<double, 3> place{};
  std::vector<std::uint64_t> particles;

  [[gnu::cold]] static ErrorMessage of(const std::exception_ptr& error) {
    ErrorMessage m;
    if (!error) return m;
    try {
      std::rethrow_exception(error);
    } catch (const InputError& e) {
      m.kind = Kind::Input, m.sentence = e.what();
    } catch (const FileError& e) {
      m.kind = Kind::File, m.sentence = e.what();
    } catch (const SimulationError& e) {
      m.kind = Kind::Simulation, m.sentence = e.what(), m.step = e.step;
      m.place = {e.position.x, e.position.y, e.position.z}, m.particles = e.particles;
    } catch (const FlowStepError& e) {
      m.kind = Kind::FlowStep, m.sentence = e.what(), m.longest = e.longest;
    } catch (const std::bad_alloc&) {
      m.kind = Kind::Memory, m.sentence = "there is not enough memory";
    } catch (const std::exception& e) {
      m.kind = Kind::Plain, m.sentence = e.what();
    } catch (...) {
      m.kind = Kind::Plain, m.sentence = "an exception that is no std::exception was thrown";
    }
    return m;
  }

  /// Throws it with the message common to all ranks. Lack of memory becomes a plain Error, which
  /// has a message.
  [[noreturn, gnu::cold]] void raise(const std::string& words) const {
    switch (kind) {
      case Kind::Input:
        throw InputError(words);
      case Kind::File:
        throw FileError(words);
      case Kind::Simulation:
        throw SimulationError(words, step, particles,
                              SimulationError::Place{place[0], place[1], place[2]});
      case Kind::FlowStep:
        throw FlowStepError(words, longest);
      default:
        throw Error(words);
    }
  }

  [[gnu::cold]] std::vector<std::byte> packed() const {
    std::vector<std::byte> out;
    const auto put = [&](const void* from, std::size_t bytes) {
      const auto* first = static_cast<const std::byte*>(from);
      out.insert(out.end(), first, first + bytes);
    };
    const std::uint64_t letters = sentence.size(), ids = particles.size();
    put(&kind, sizeof kind), put(&step, sizeof step), put(&longest, sizeof longest);
    put(place.data(), sizeof place), put(&letters, sizeof letters), put(&ids, sizeof ids);
    put(sentence.data(), sentence.size()), put(particles.data(), ids * sizeof particles[0]);
    return out;
  }

  [[gnu::cold]] static ErrorMessage unpacked(std::span<const std::byte> from) {
    ErrorMessage m;
    const auto take = [&](void* to, std::size_t bytes) {
      require(bytes <= from.size(), "an error of another rank was cut off on its way");
      if (bytes > 0) std::memcpy(to, from.data(), bytes);
      from = from.subspan(bytes);
    };
    std::uint64_t letters = 0, ids = 0;
    take(&m.kind, sizeof m.kind), take(&m.step, sizeof m.step), take(&m.longest, sizeof m.longest);
    take(m.place.data(), sizeof m.place), take(&letters, sizeof letters), take(&ids, sizeof ids);
    require(letters <= from.size() && ids <= from.size() / sizeof ids,
            "an error of another rank was cut off on its way");
    m.sentence.resize(letters), m.particles.resize(ids);
    take(m.sentence.data(), letters), take(m.particles.data(), ids * sizeof ids);
    return m;
  }
};

/// Whether all ranks have already thrown this error together; observers append words to it.
[[gnu::cold]] inline bool is_told(const std::exception_ptr& error) {
  return error && is_agreed() && !last_agreed().empty() &&
         ErrorMessage::of(error).sentence.starts_with(last_agreed());
}

/// A name as a whole number below 2^32, which a double holds.
inline double number_of_name(std::string_view name) {
  std::uint32_t hash = 2166136261u;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619u;
  return hash;
}

/// Collective: all ranks throw the error of the lowest rank that has one.
template <Communicator C>
[[gnu::cold]] void throw_together(const C& comm, const std::exception_ptr& error) {
  auto own = ErrorMessage::of(error);
  if (error && (last_agreed().empty() || own.sentence != last_agreed()))
    own.sentence = text(rank_words(comm.rank(), comm.size()), ": ", own.sentence);
  const auto bytes = own.packed();
  const auto all = comm.gather_bytes(bytes);
  for (int r = 0; r < all.ranks(); ++r) {
    const auto first = ErrorMessage::unpacked(all[r]);
    if (first.kind == ErrorMessage::Kind::None) continue;
    last_agreed() = first.sentence, is_agreed() = true;
    first.raise(first.sentence);
  }
}

/// Collective: all ranks throw, because they are at different calls.
template <Communicator C>
[[gnu::cold]] void throw_out_of_step(const C& comm, std::string_view call) {
  const auto all = gather(comm, std::span<const char>(call));
  std::string who;
  for (int r = 0; r < all.ranks(); ++r)
    who += text(r == 0 ? "" : ", ", "rank ", r, " is at '",
                std::string_view(all[r].data(), all[r].size()), "'");
  who = text("the ranks are out of step: ", who,
             "; every rank must make the same calls in the same order, none of them behind `if "
             "(sim.rank() == 0)`");
  last_agreed() = who, is_agreed() = true;
  throw Error(who);
}

}  // namespace detail

/// Collective: every rank reports whether it has failed, and which call it is at. All return, or
/// all throw the same error: that of the lowest rank that has one, with the rank's number before
/// its message; or, if ranks are at different calls, a message about that. `maxima` (at most
/// most_agreed numbers, the same count on all ranks) become the maxima over all ranks. There is one
/// message of one length, whatever the call, so that a rank that has failed can meet the others at
/// the next agree(), wherever that is. An error that all ranks have thrown at a nested agree() is
/// rethrown without a message.
template <Communicator C>
void agree(const C& comm, std::string_view call, const std::exception_ptr& error = nullptr,
           std::span<double> maxima = {}) {
  if (comm.size() == 1) {
    if (error) std::rethrow_exception(error);
    return;
  }
  if (error && detail::is_told(error)) std::rethrow_exception(error);
  detail::is_agreed() = false;
  require(maxima.size() <= most_agreed, "agree(", call, "): ", maxima.size(),
          " numbers; there is room for ", most_agreed);
  std::array<double, most_agreed + 3> told{};
  told[0] = error ? 1 : 0;
  told[1] = detail::number_of_name(call);
  told[2] = -told[1];
  std::copy(maxima.begin(), maxima.end(), told.begin() + 3);
  comm.max_of(told);
  if (told[0] != 0) detail::throw_together(comm, error);
  if (told[1] != -told[2]) detail::throw_out_of_step(comm, call);
  std::copy_n(told.begin() + 3, maxima.size(), maxima.begin());
}

/// Collective: runs f() on each rank. If it throws on any, all throw the same. If f itself
/// communicates, it does so after an agree(), at which a rank that has failed meets the others.
template <Communicator C, class F>
void together(const C& comm, std::string_view call, const F& f) {
  detail::is_agreed() = false;
  std::exception_ptr error;
  try {
    f();
  } catch (...) {
    error = std::current_exception();
  }
  agree(comm, call, error);
}

}  // namespace silt
