// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <exception>
#include <string>

#include <doctest/doctest.h>

/// What a call says as it throws, and whether a sentence has the words it should have.
namespace silt_test {

template <class Call>
std::string refusal(const Call& call) {
  try {
    call();
  } catch (const std::exception& e) {
    return e.what();
  }
  return "nothing was refused";
}

inline bool has(const std::string& all, const char* part) {
  const bool found = all.find(part) != std::string::npos;
  CHECK_MESSAGE(found, all, " lacks ", part);
  return found;
}

}  // namespace silt_test
