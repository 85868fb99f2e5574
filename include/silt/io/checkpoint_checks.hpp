// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>

#include <silt/core/dyn_array.hpp>
#include <silt/io/checkpoint_parts.hpp>

/// Consistency checks of a checkpoint: its numbers must fit each other and the scene. A file that
/// passes cannot cause accesses beyond an array, and describes a state that a run can reach. Each
/// check throws FileError by CheckpointLoader::need. Tests: tests/io/fuzz_checkpoint.cpp (every
/// field, forged).

namespace silt::inline SILT_TARGET::detail {

inline bool is_finite(const Pose& p) {
  const Quaternion& q = p.rotation;
  return silt::is_finite(p.translation) && std::isfinite(q.w + q.x + q.y + q.z);
}
/// Of unit length, within the drift of many small rotations.
inline bool is_unit(const Quaternion& q) {
  return std::abs(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z - 1) < 1e-6;
}
/// Equal up to `part` of the larger value, by default the rounding of a few products.
inline bool is_near(double a, double b, double part = 1e-9) {
  return std::abs(a - b) <= part * std::max(std::abs(a), std::abs(b));
}

inline void check_clock(const CheckpointLoader& a, const ClockState& c) {
  a.need(c.step_origin <= c.step, "clock.step_origin = ", c.step_origin,
         " is after clock.step = ", c.step);
  const double since = static_cast<double>(c.step - c.step_origin) * c.step_length;
  a.need(is_near(c.time, c.time_origin + since), "clock.time = ", c.time, " s is not that of ",
         c.step - c.step_origin, " steps of ", c.step_length, " s since ", c.time_origin, " s");
  a.need(c.step_length > 0 || (c.step == 0 && !c.kicked), "clock.step_length = 0 after ", c.step,
         " steps");
  a.need(!c.first_kick || (c.step == 0 && !c.kicked),
         "clock.first_kick is 1, but there was a first step");
  a.need(!c.observed || c.kicked, "clock.observed is 1 where clock.kicked is 0");
  a.need(c.first_kick || c.kicked || c.step > 0, "clock.first_kick is 0 before the first step");
}

template <class Upkeep>
void check_upkeep(const CheckpointLoader& a, const ClockState& c, const Upkeep& u,
                  std::size_t listed, std::size_t rows) {
  a.need(u.searched_at <= u.pruned_at && u.pruned_at <= c.step &&
             (u.searched_at >= 0) == (u.pruned_at >= 0),
         "lists.searched_at = ", u.searched_at, " and lists.pruned_at = ", u.pruned_at,
         " do not match step ", c.step);
  a.need(u.plan.least_outer <= u.plan.most_outer && u.plan.least_inner <= u.plan.most_inner,
         "lists.least_outer or lists.least_inner is larger than its largest value");
  a.need(listed <= rows && (u.searched_at < 0 || listed == rows), "the lists are of ", listed,
         " rows, but there are ", rows);
  a.check("lists.outer_reach", u.outer, not_negative_number);
  a.check("lists.inner_reach", u.inner, not_negative_number);
}

/// Ids must be unique and below the next one. Returns the number of rows with an id.
template <class Ids>
std::size_t check_ids(const CheckpointLoader& a, const char* what, Ids ids, ParticleId next) {
  std::sort(ids.begin(), ids.end());
  const auto end = std::lower_bound(ids.begin(), ids.end(), no_particle);
  const auto twice = std::adjacent_find(ids.begin(), end);
  a.need(twice == end, "two ", what, " have the id ", twice == end ? 0 : *twice);
  a.need(end == ids.begin() || *(end - 1) < next, "a ", what, " has the id ",
         end == ids.begin() ? 0 : *(end - 1), ", but the next one to be given is ", next);
  return static_cast<std::size_t>(end - ids.begin());
}

/// `are_all`: the file of one process. A rank's block has the sizes of the particles of all ranks.
template <class State>
void check_particles(const CheckpointLoader& a, const State& p, std::size_t materials,
                     bool are_all = true) {
  constexpr auto most = std::numeric_limits<float>::max();
  double largest = 0, sum = 0;
  bool parked = false;
  for (std::size_t k = 0; k < p.size(); ++k) {
    const PositionRow& row = p.position[k];
    const auto& m = p.motion[k];
    a.need(silt::is_finite(m.velocity()) && std::isfinite(m.inv_m) && m.inv_m >= 0,
           "motion of row ", k, ": velocity ", Vec3d{m.vx, m.vy, m.vz}, " m/s and inverse mass ",
           m.inv_m, " 1/kg must be finite, and the latter not negative");
    if constexpr (requires { m.inv_r; })
      a.need(std::isfinite(m.wx + m.wy + m.wz) && std::isfinite(m.inv_r), "motion of row ", k,
             ": its spin must be finite");
    if constexpr (State::single)
      a.need(norm(m.velocity()) <= most && m.inv_m <= most, "motion of row ", k,
             " must be below 3.4e38");
    if constexpr (State::several)
      a.need(p.material[k] < materials, "material[", k, "] = ", p.material[k],
             " must be less than ", materials, ", the number of materials");
    if constexpr (State::derivative_rows > 0) {
      const auto& d = p.derivatives[k].row;
      for (std::size_t r = 0; r < State::derivative_rows && !std::isnan(d[0][0]); ++r)
        a.need(std::isfinite(d[r][0] + d[r][1] + d[r][2] + d[r][3]), "derivatives of row ", k,
               " must be finite");
    }
    if (p.is_parked(k)) {
      parked = true;
      a.need(row.r == 0, "row ", k, " has left, but has a radius of ", row.r, " m");
      continue;
    }
    a.need(silt::is_finite(row.centre()) && std::isfinite(row.r) && row.r > 0, "position of row ",
           k, ": ", row.centre(), " m and radius ", row.r,
           " m must be finite, and the latter greater than 0");
    if constexpr (requires { m.inv_r; })
      a.need(is_near(m.inv_r * row.r, 1), "motion of row ", k, ": 1/radius = ", m.inv_r,
             " 1/m, but the radius is ", row.r, " m");
    largest = std::max(largest, row.r), sum += 2 * row.r;
  }
  // Measured at the last search: particles that left or shrank since are included.
  const double mean = p.size() > 0 ? sum / static_cast<double>(p.size()) : 0;
  a.need(p.largest_radius >= largest, "largest.radius = ", p.largest_radius,
         " m, but that of the particles is ", largest, " m");
  a.need(parked || !are_all ? p.mean_diameter <= 2 * p.largest_radius * (1 + 1e-9)
                            : is_near(p.mean_diameter, mean),
         "mean_diameter = ", p.mean_diameter, " m, but that of the particles is ", mean, " m");
}

/// Checks that all numbers of rows are finite.
template <class Rows>
void check_finite_rows(const CheckpointLoader& a, const std::string& name, const Rows& rows) {
  constexpr std::size_t numbers = sizeof(typename Rows::value_type) / sizeof(double);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto* const row = reinterpret_cast<const double*>(&rows[k]);
    for (std::size_t n = 0; n < numbers; ++n)
      a.need(std::isfinite(row[n]), name, "[", k, "] has the number ", row[n],
             ", which must be finite");
  }
}

/// Returns the rows of each body's parts, as numbered by BodyMotion.
template <class State, class Forms>
DynArray<std::uint32_t> check_bodies(const CheckpointLoader& a, const DynArray<Body>& bodies,
                                     const State& p, const Forms& forms) {
  std::size_t first = 0;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const Body& b = bodies[k];
    a.need(b.form < forms.size(), "body ", k, " has form ", b.form, " of ", forms.size());
    const auto& form = forms[b.form];
    a.need(b.first == first, "body ", k, " begins at part ", b.first, ", not at ", first);
    a.need(silt::is_finite(b.centre) && silt::is_finite(b.velocity) && silt::is_finite(b.momentum),
           "body ", k, ": its place ", b.centre, " m, velocity ", b.velocity,
           " m/s and angular momentum ", b.momentum, " kg m2/s must be finite");
    a.need(is_unit(b.orientation), "body ", k, ": its orientation is not a unit quaternion");
    a.need(std::isfinite(b.scale) && b.scale > 0 && is_near(b.radius, b.scale * form.radius),
           "body ", k, ": radius ", b.radius, " m and scale ", b.scale, " do not match form ",
           b.form, after_number(form.name), " of ", form.radius, " m");
    // Maximum over many normals: with other rounding another normal may win.
    a.need(norm(b.lever - b.scale * form.lever) <= 1e-6 * b.radius, "body ", k, ": lever ", b.lever,
           " m does not match its form, of ", b.scale * form.lever, " m");
    const Vec3d& I = b.inertia;
    a.need(silt::is_finite(I) && std::min({I.x, I.y, I.z}) > 0 && std::isfinite(b.inv_m) &&
               b.inv_m >= 0,
           "body ", k, ": inertia ", I, " kg m2 and inverse mass ", b.inv_m,
           " 1/kg must be finite, and not negative");
    const double per_mass = b.scale * b.scale / form.mass.volume;  // [1/m3]
    const Vec3d& J = form.mass.inertia;
    a.need(b.inv_m == 0 || (is_near(I.x * b.inv_m, J.x * per_mass, 1e-6) &&
                            is_near(I.y * b.inv_m, J.y * per_mass, 1e-6) &&
                            is_near(I.z * b.inv_m, J.z * per_mass, 1e-6)),
           "body ", k, ": inertia ", I, " kg m2 does not match its form and mass");
    first += form.parts.size();
  }
  a.need(first == p.size(), "bodies have ", first, " parts, but there are ", p.size(), " rows");
  DynArray<std::uint32_t> rows(first, no_place);
  for (std::size_t r = 0; r < p.size(); ++r) {
    const PartRow& part = p.part[r];
    a.need(part.body < bodies.size() && part.local < forms[bodies[part.body].form].parts.size(),
           "row ", r, " is part ", part.local, " of body ", part.body, ", which is not there");
    const Body& b = bodies[part.body];
    std::uint32_t& place = rows[b.first + part.local];
    a.need(place == no_place, "rows ", place, " and ", r, " are one part of body ", part.body);
    place = static_cast<std::uint32_t>(r);
    a.need(p.is_parked(r) == (b.id == no_particle), "row ", r,
           " and its body do not agree whether they have left");
    if (p.is_parked(r)) continue;
    const auto& ball = forms[b.form].parts[part.local];
    a.need(is_near(p.position[r].r, b.scale * ball.radius), "row ", r, " has the radius ",
           p.position[r].r, " m, but as a part of its body ", b.scale * ball.radius, " m");
    const Vec3d at = b.centre + rotate(b.orientation, b.scale * ball.centre) + part.image;
    const double size = b.radius + norm(b.centre) + norm(part.image);
    a.need(norm(p.position[r].centre() - at) <= 1e-6 * size, "row ", r, " is at ",
           p.position[r].centre(), " m, but as a part of its body at ", at, " m");
    a.need(p.motion[r].inv_m == b.inv_m, "row ", r, " has another mass than its body");
  }
  if constexpr (State::several)
    for (std::size_t r = 0; r < p.size(); ++r)
      a.need(p.material[r] == p.material[rows[bodies[p.part[r].body].first]], "row ", r,
             " has another material than its body");
  return rows;
}

/// `listed`: number of rows in the lists.
template <class Engine, class Pairs, class State>
void check_pairs(const CheckpointLoader& a, const Pairs& pairs, const State& p,
                 std::size_t listed) {
  const auto left = [&](std::uint32_t row) { return p.id[row] == no_particle; };
  a.need(pairs.grouped <= listed, "pairs.grouped = ", pairs.grouped, " is more than ", listed,
         " rows");
  a.need(pairs.owned <= pairs.grouped, "pairs.owned = ", pairs.owned, " is more than ",
         pairs.grouped, " rows");
  const PairGroups groups(pairs.owned, pairs.grouped - pairs.owned);
  DynArray<std::uint32_t> begin(listed + 1, 0);  // pairs of each row, to detect duplicates
  std::size_t group = 0;
  for (std::size_t k = 0; k < pairs.outer.size(); ++k) {
    const auto [i, j] = pairs.outer[k];
    a.need(i < listed && j < listed && i != j, "pairs.outer[", k, "] is of rows ", i, " and ", j,
           " of ", listed);
    const std::size_t now = groups.of(i, j);
    a.need(now >= group, "pairs.outer[", k, "] is not in its group");
    group = now;
    ++begin[std::min(i, j) + 1];
    if (left(i) || left(j)) continue;
    a.need(p.id[i] < p.id[j], "pairs.outer[", k, "] has the higher id first");
    a.need(p.motion[i].inv_m > 0 || p.motion[j].inv_m > 0, "pairs.outer[", k,
           "] is of two fixed particles");
    if constexpr (State::of_bodies)
      a.need(p.part[i].body != p.part[j].body, "pairs.outer[", k, "] is of one body");
  }
  for (std::size_t r = 0; r < listed; ++r) begin[r + 1] += begin[r];
  DynArray<std::uint32_t> partner(pairs.outer.size()), next(begin.begin(), begin.end());
  for (const auto [i, j] : pairs.outer) partner[next[std::min(i, j)]++] = std::max(i, j);
  for (std::size_t r = 0; r < listed; ++r) {
    const auto from = partner.begin() + begin[r], to = partner.begin() + begin[r + 1];
    std::sort(from, to);
    a.need(std::adjacent_find(from, to) == to, "pairs.outer has a pair of row ", r, " twice");
  }
  for (std::size_t k = 0; k < pairs.origin.size(); ++k)
    a.need(
        pairs.origin[k] < pairs.outer.size() && (k == 0 || pairs.origin[k - 1] < pairs.origin[k]),
        "pairs.inner[", k, "] = ", pairs.origin[k],
        " is not a place in the outer list after the last");
  check_memory<Engine>(a, "pairs.", pairs.history);
}

template <class Openings>
void check_openings(const CheckpointLoader& a, const OpeningsState& s, const Openings& openings,
                    const ClockState& c, const AcceptedChanges& accepted) {
  for (std::size_t k = 0; k < openings.inlets().size() && !accepted.inlets; ++k) {
    const auto& flow = openings.inlets()[k].flow;
    a.need(s.start[k] <= c.time, "inlets.start[", k, "] = ", s.start[k],
           " s is after the checkpoint's time ", c.time, " s");
    a.need(s.counter[k] <= std::uint64_t{1} << 53 && s.insertions[k] <= std::uint64_t{1} << 53,
           "inlets.counter or inlets.insertions of inlet ", k, " is too large");
    const double since = c.time - s.start[k];
    const double most = (s.before[k] + flow.rate * since) * (1 + 1e-9) + 2;
    a.need(static_cast<double>(s.placed[k]) <= most && static_cast<double>(s.waiting[k]) <= most &&
               (flow.total == 0 || s.placed[k] <= flow.total),
           "inlets: inlet ", k, " has placed ", s.placed[k], " particles, and ", s.waiting[k],
           " wait, more than its rate makes in ", since, " s");
    a.need(s.interval[k] > 0
               ? static_cast<double>(s.insertions[k]) <= since / s.interval[k] * (1 + 1e-9) + 2
               : s.insertions[k] == 0,
           "inlets: inlet ", k, " has placed particles ", s.insertions[k], " times, every ",
           s.interval[k], " s, in ", since, " s");
    a.need(s.seed[k] == flow.seed, "inlets.seed[", k, "] = ", s.seed[k], ", but the inlet's is ",
           flow.seed);
  }
}

/// A part of a fluid's state, by name. All numbers are finite and the clock is known; the fluid
/// itself checks the rest.
template <class Fluid>
void check_fluid_part(const CheckpointLoader& a, const std::string& name,
                      std::span<const double> values, const Fluid& fluid) {
  a.check(name, values, finite_number);
  if (name == "fluid.clock" && values.size() >= 3)
    for (const std::size_t k : {0, 1, 2}) {
      const NumberRule& rule = k == 1 ? count_number : not_negative_number;
      a.need(rule.holds(values[k]), name, "[", k, "] = ", values[k], " ", rule.words);
    }
  if constexpr (FluidTraits<Fluid>::checks_state) fluid.check_state(name, values);
}

/// Loads on particles: finite, except values of new particles that are not known yet.
template <class Loads>
void check_loads(const CheckpointLoader& a, const Loads& loads) {
  for_each_column(loads, [&](const auto& column, const auto& values) {
    const std::string name = column.name.text();
    for (std::size_t k = 0; k < values.size(); ++k) {
      const auto& row = values[k];
      if constexpr (requires { row.fourth; }) {
        const bool may_be_new = std::isnan(column.start.x);
        a.need((std::isfinite(row.x + row.y + row.z) || (may_be_new && std::isnan(row.x))) &&
                   std::isfinite(row.fourth),
               name, " of particle ", k, " must be finite");
      } else {
        a.need(std::isfinite(row) && row >= 0, name, " of particle ", k,
               " must be finite and not negative");
      }
    }
  });
}

}  // namespace silt::detail
