// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET::detail {

class ContactRecord;

/// What a step must know of time, and of who looks at it.
struct StepTimes {
  double step;           // [s]
  double worked;         // of it, that forces have been at work since the last step: 0 at the first
  bool ask;              // contacts what they store (ledger_asks_every)
  double lag = 0.5;      // [steps] by which velocities are older than positions
  double now = 0;        // [s]
  bool watched = false;  // somebody wants to know which contacts begin and end
  // Of contacts that are watched and began before this time [s] force and work are looked at in
  // some steps only, and whether this is one.
  double at_rest_from = -1;
  bool look_at_rest = true;
  static constexpr int at_rest_after = 2000, look_at_rest_every = 8;  // steps
  bool renew_areas = true;  // contacts of smooth bodies find their points anew (contact_area.hpp)
  static constexpr int areas_every = 8;  // steps
  double parting = 0;                    // [m/s] at which offsets shrink
  double weak_from = 0;                  // [N] forces up to which nothing breaks
  ContactRecord* record = nullptr;       // takes this step's contacts, if somebody asks
};

}  // namespace silt::detail
