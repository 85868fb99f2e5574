// silt - BSD-3-Clause, see LICENSE
#pragma once
#include <vector>
#include <algorithm>
#include <silt/breakage/impact.hpp>
#include <silt/core/random.hpp>
namespace silt::inline SILT_TARGET {
struct FragmentLimits { double dust_below; std::size_t most; };
struct FragmentSizes { std::vector<double> masses; double dust; };
template <class B>
FragmentSizes fragment_sizes(const B& sizes, const Broken& b, double density, const FragmentLimits& limits, Random& random) {
  FragmentSizes out{{}, b.mass};
  const double least = density * 3.14159265358979 / 6 * limits.dust_below * limits.dust_below * limits.dust_below;
  for (std::size_t k = 0; k < limits.most; ++k) {
    const double m = out.dust * random.uniform(0.1, 0.5);
    if (m < least) break;
    out.masses.push_back(m), out.dust -= m;
  }
  std::sort(out.masses.rbegin(), out.masses.rend());
  (void)sizes;
  return out;
}
template <class B> 
std::vector<double> dust_shares(const B&, const Broken&, double) { return {}; }
}
