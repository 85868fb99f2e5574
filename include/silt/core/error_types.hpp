// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/target.hpp>

// Exceptions of silt are outside the namespace of its instruction set. An uncaught one is then
// shown as silt::SimulationError, and a translation unit with other compile flags can catch it.
// Nothing here may depend on those flags. Constructors and assignments are inlined into their
// callers; only destructors are shared between units, and they move no numbers
// (tests/compile/units_apart.py).
#define SILT_COPIES_INLINE(Class)                       \
  [[gnu::always_inline]] Class(const Class&) = default; \
  [[gnu::always_inline]] Class& operator=(const Class&) = default

namespace silt {

/// Base class of all exceptions of silt; `what()` is one sentence: what, where, what to change.
struct Error : std::runtime_error {
  [[gnu::always_inline]] explicit Error(const std::string& sentence)
      : std::runtime_error(sentence) {}
  SILT_COPIES_INLINE(Error);
};

/// An unusable value, file or combination. Nothing has been changed or written.
struct InputError : Error {
  [[gnu::always_inline]] explicit InputError(const std::string& sentence) : Error(sentence) {}
  SILT_COPIES_INLINE(InputError);
};

/// A file or folder that cannot be read or written (missing, full disk, damaged content).
struct FileError : Error {
  [[gnu::always_inline]] explicit FileError(const std::string& sentence) : Error(sentence) {}
  SILT_COPIES_INLINE(FileError);
};

/// The run failed: NaN, overlap or time step over its limit, a particle outside the domain.
struct SimulationError : Error {
  /// Three coordinates [m]; converts to a Vec3d.
  struct Place {
    double x, y, z;
    template <class V>
    requires requires(V v) { v = V{v.x, v.y, v.z}; }
    [[gnu::always_inline]] operator V() const { return {x, y, z}; }  // NOLINT: converts
  };
  template <class V = Place>
  [[gnu::always_inline]] SimulationError(const std::string& sentence, std::int64_t at_step,
                                         DynArray<std::uint64_t> ids, const V& where)
      : Error(sentence),
        step(at_step),
        particles(std::move(ids)),
        position{where.x, where.y, where.z} {}
  SILT_COPIES_INLINE(SimulationError);
  std::int64_t step;
  DynArray<std::uint64_t> particles;  // ids
  Place position;                     // [m]
};

/// A flow step that is too long for the present flow.
struct FlowStepError : Error {
  [[gnu::always_inline]] FlowStepError(const std::string& sentence, double longest_step)
      : Error(sentence), longest(longest_step) {}
  SILT_COPIES_INLINE(FlowStepError);
  double longest;  // [s] longest step of this flow
};

}  // namespace silt

#undef SILT_COPIES_INLINE
