// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {
namespace detail {

/// `value` with a fixed number of decimals.
[[gnu::cold]] inline std::string fixed(double value, int decimals) {
  char buffer[352];  // the largest double has 309 digits
  std::snprintf(buffer, sizeof buffer, "%.*f", decimals, value);
  return buffer;
}

/// Three significant digits with k, M or G: "950 ", "23.4 M ".
[[gnu::cold]] inline std::string with_prefix(double value) {
  const char* prefixes[] = {"", "k ", "M ", "G ", "T "};
  int k = 0;
  for (; k < 4 && value >= 999.5; ++k) value /= 1000;
  const int decimals = k == 0 || value >= 99.95 ? 0 : value >= 9.995 ? 1 : 2;
  return text(fixed(value, decimals), ' ', prefixes[k]);
}

/// A waiting time in its two largest units: "45 s", "2 min 05 s", "3 h 07 min", "4 d 02 h".
[[gnu::cold]] inline std::string duration(double seconds) {
  const struct {
    double seconds;
    const char *unit, *part_unit;
    double part_seconds;
  } steps[] = {{86400, " d ", " h", 3600}, {3600, " h ", " min", 60}, {60, " min ", " s", 1}};
  for (const auto& s : steps) {
    const double parts = std::round(seconds / s.part_seconds);
    const double in_whole = s.seconds / s.part_seconds;
    if (parts < in_whole) continue;
    const double rest = std::fmod(parts, in_whole);
    return text(fixed(std::floor(parts / in_whole), 0), s.unit, rest < 10 ? "0" : "",
                fixed(rest, 0), s.part_unit);
  }
  return text(fixed(seconds, 0), " s");
}

}  // namespace detail

/// One line with the state of a run, its speed and its remaining time:
///
///   t = 0.350 of 1.200 s (29 %)  100000 particles  23.4 M particle-steps/s  largest overlap 0.41 %
///   of radius  2 min 05 s left                                                     (all one line)
///
/// `particle_steps` and `wall_seconds` [s] count from `start_time` [s], which is the time of the
/// restart in a continued run. `largest_overlap_ratio` [-] is overlap over radius. `liquid`: number
/// of SPH particles, printed as "100 particles, 5000 of liquid".
[[gnu::cold]] inline std::string progress_line(double time, double end_time,
                                               std::uint64_t particle_steps, double wall_seconds,
                                               std::size_t particles, double largest_overlap_ratio,
                                               double start_time = 0, std::size_t liquid = 0) {
  const bool done = time >= end_time;
  const double done_part = done ? 1 : std::max(0.0, time / end_time);
  // Enough decimals to show a thousandth of the whole run.
  const int decimals =
      end_time > 0 ? static_cast<int>(std::clamp(3 - std::floor(std::log10(end_time)), 0.0, 15.0))
                   : 3;
  std::string line =
      text("t = ", detail::fixed(time, decimals), " of ", detail::fixed(end_time, decimals), " s (",
           detail::fixed(std::floor(100 * done_part + 1e-9), 0), " %)  ", particles, " particles");
  if (liquid > 0) line += text(", ", liquid, " of liquid");
  if (particle_steps > 0 && wall_seconds > 0)
    line += text("  ", detail::with_prefix(static_cast<double>(particle_steps) / wall_seconds),
                 "particle-steps/s");
  line +=
      text("  largest overlap ", detail::fixed(100 * largest_overlap_ratio, 2), " % of radius  ");
  if (done) return line + "done in " + detail::duration(wall_seconds);
  if (time <= start_time || wall_seconds <= 0) return line + "starting";
  const double left = wall_seconds * (end_time - time) / (time - start_time);
  return line + detail::duration(left) + " left";
}

/// One line on how well the balances of a fluid and its particles close (FluidClosure):
///
///   fluid, largest error of any step: solid volume 2.2e-16, momentum 3.1e-16 of the exchange,
///   continuity 1.4e-9 of a cell; clipped 0 of the solid volume                   (all one line)
///
/// For SPH (`cells` false) without continuity, which particles fulfil by themselves.
template <class Closure>
[[gnu::cold]] std::string closure_line(const Closure& most, bool cells = true) {
  const auto number = [](double value) {
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, "%.2g", value);
    return std::string(buffer);
  };
  return text("fluid, largest error of any step: solid volume ", number(most.volume), ", momentum ",
              number(most.momentum), " of the exchange",
              cells ? text(", continuity ", number(most.continuity), " of a cell") : "",
              "; clipped ", number(most.clipped), " of the solid volume");
}

}  // namespace silt
