// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET::detail {

class ContactRecord;

/// Times of a step, and what is observed in it.
struct StepTimes {
  double step;    // [s]
  double worked;  // [s] part of it in which forces have acted since the last step: 0 at the first
  bool ask;       // evaluate stored energies (ledger_asks_every)
  double lag = 0.5;      // [steps] lag of velocities behind positions
  double now = 0;        // [s]
  bool watched = false;  // an observer asks for begins and ends of contacts
  // Force and work of tracked contacts at rest are evaluated in some steps only: whether this is
  // one of them, steps since the last of them, and the time [s] before which such contacts began.
  bool look_at_rest = true;
  int since_look = look_at_rest_every;
  double at_rest_from = -1;
  static constexpr int at_rest_after = 2000, look_at_rest_every = 8;  // steps
  static constexpr int calm_at_rest = 16;                             // evaluations
  static constexpr double move_at_rest = 0.05;  // [-] of the overlap between evaluations
  bool renew_areas = true;  // contacts of smooth bodies recompute their points (contact_area.hpp)
  static constexpr int areas_every = 8;  // steps
  double parting = 0;                    // [m/s] rate at which offsets shrink
  double weak_from = 0;                  // [N] below this force nothing breaks
  ContactRecord* record = nullptr;       // records this step's contacts, if requested
};

}  // namespace silt::detail
