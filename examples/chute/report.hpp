// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is left of a run: tables, summary.json with its checks.

#include <cmath>
#include <string>

#include "chute/measure.hpp"
#include "support/example.hpp"

namespace chute {

/// Depths in mm after 100 000 t, and the angles at which impacts cause wear.
inline void write_tables(const Scene& s, const std::string& out, const Worn& slid, const Worn& cuts,
                         const Seen& seen, double fed) {
  silt::CsvTable profile(out + "/profile.csv", {"place [m]", "sliding", "sliding by contacts",
                                                "block", "impacts", "impacts by events"});
  const double depth = 1e11 / fed / (s.cell() * s.width);
  const auto block = block_depth(s);
  for (std::size_t k = 0; k < block.size(); ++k)
    profile.add_row({s.middle(k), depth * slid.floor[k], depth * seen.sliding.floor[k],
                     1e11 * block[k], depth * cuts.floor[k], depth * seen.impacts.floor[k]});
  silt::CsvTable by_angle(out + "/angles.csv", {"angle [degrees]", "share of wear [%]"});
  for (std::size_t k = 0; k < seen.angles.size(); ++k)
    by_angle.add_row({5 * static_cast<double>(k) + 2.5, 100 * seen.angles[k] / seen.impacts.all});
}

inline void check_wear(example::Summary& summary, const Scene& s, const Worn& slid,
                       const Worn& cuts, const Seen& seen, double work, double fed) {
  summary.check_within("sliding_over_that_of_contacts", slid.all / seen.sliding.all, 1, 0.02,
                       "contacts are read every half millisecond; impacts do not last as long");
  summary.check_within("sliding_over_work_of_friction",
                       slid.all / (s.archard_factor() * work / s.friction), 1, 1e-3,
                       "grains slide all the way; loading the tangential springs takes some 1e-5");
  summary.check_within("impacts_over_those_of_events", cuts.all / seen.impacts.all, 1, 1e-9,
                       "rounding: the same impacts");
  double elsewhere = 0;
  for (std::size_t k = 0; k < cuts.floor.size(); ++k)
    elsewhere += std::abs(cuts.floor[k] - seen.impacts.floor[k]);
  summary.check_at_most("impacts_at_another_place", elsewhere / cuts.all, 5e-3);
  const auto block = block_depth(s);
  const double bend = s.upper + s.bend();
  const auto over_block = [&](const char* name, double from, double to) {
    double worn = 0, expected = 0;
    for (std::size_t k = 0; k < block.size(); ++k)
      if (s.middle(k) > from && s.middle(k) < to)
        worn += slid.floor[k], expected += block[k] * s.cell() * s.width * fed;
    summary.check_within(name, worn / expected, 1, 0.1,
                         "grains next to the floor are slower than the mean, and bounce");
  };
  over_block("plate_over_block", s.landing() + 0.15, s.upper);
  over_block("bend_over_block", s.upper, bend);
  over_block("outflow_over_block", bend, s.length());
}

inline void add_inputs(example::Summary& summary, const Scene& s) {
  summary.input("rate_kg_s", s.rate);
  summary.input("batch_kg", s.batch);
  summary.input("width_m", s.width);
  summary.input("slope_of_plate_degrees", s.steep);
  summary.input("slope_of_outflow_degrees", s.flat);
  summary.input("friction_on_steel", s.friction);
  summary.input("facet_m", s.facet);
  summary.input("archard_k_over_h_1_pa", s.archard_factor());
}

}  // namespace chute
