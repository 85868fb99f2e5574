// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <tuple>
#include <type_traits>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/row4.hpp>
#include <silt/core/storage.hpp>
#include <silt/core/threads.hpp>
#include <silt/core/upper3.hpp>
#include <silt/engine/lists/pair_history.hpp>
#include <silt/engine/state/rows.hpp>
#include <silt/shape/narrow/kinds.hpp>
#include <silt/shape/narrow/super_ellipsoid_plane.hpp>

namespace silt::inline SILT_TARGET::detail {

/// A Contacts type whose contacts have `Points` points, each with its own history
/// (contact_area.hpp), and store the narrow phase's data of the last step: NormalMemory. The order
/// is: the first point's history; NormalMemory without its last value; the other points' histories;
/// AreaFrame and SlipFrame; the last value of NormalMemory. Contacts of one point therefore need
/// the first values only. At walls only the last value of NormalMemory is used.
template <class ContactsType, std::size_t Points>
struct WithNormals : ContactsType {
  static constexpr bool rotates = true;
  static constexpr std::size_t points = Points, point_history = ContactsType::history;
  static constexpr bool shares_contacts = Points > 1;
  static constexpr std::size_t memory_from = point_history;
  static constexpr std::size_t memory_to = memory_from + sizeof(NormalMemory<double>) / 8 - 1;
  static constexpr std::size_t frame_from = memory_to + (Points - 1) * point_history;
  static constexpr std::size_t area_numbers = 9;  // AreaFrame and SlipFrame
  static constexpr std::size_t memory_radius =
      frame_from + (Points > 1 ? area_numbers : 0);  // R_eff: touching
  static constexpr std::size_t history = memory_radius + 1;
  /// For contacts with walls: number of values before R_eff that are in use.
  static constexpr std::size_t history_kept(bool has_area) {
    return has_area ? memory_radius : memory_from;
  }
  /// Where the history of a point begins.
  static constexpr std::size_t history_of(std::size_t point) {
    return point == 0 ? 0 : memory_to + (point - 1) * point_history;
  }
};

/// Kinds whose contacts have an area: all but balls.
template <class Kind>
inline constexpr bool has_flats = !std::is_same_v<Kind, Ball>;
/// Points at which the contacts of these kinds act.
template <class Kinds>
inline constexpr std::size_t points_of_contacts = 1;
template <class... Kind>
inline constexpr std::size_t points_of_contacts<KindList<Kind...>> = (has_flats<Kind> || ...) ? 3
                                                                                              : 1;

/// Which history values of a pair are stored in rows, as few pairs of a list touch: all except the
/// last one, whose sign says which pairs touch. Those of further points are separate, as only
/// contacts with an area have them.
template <class ContactsType>
inline constexpr HistoryRows history_in_rows{};
template <class ContactsType>
requires(requires {
  ContactsType::memory_radius;
}) inline constexpr HistoryRows history_in_rows<ContactsType>{
    ContactsType::memory_to, ContactsType::memory_radius - ContactsType::memory_to};
/// Largest number of history values of a contact.
template <class ContactsType>
inline constexpr std::size_t history_numbers = [] {
  constexpr HistoryRows rows = history_in_rows<ContactsType>;
  return ContactsType::history - rows.first - rows.more + (rows.first + 3) / 4 * 4 +
         (rows.more + 3) / 4 * 4;
}();

/// Orientation of a convex part and the inertia of its body; one cache line.
struct alignas(64) PoseRow {
  Quaternion q;         // rotation from its axes to space
  Vec3d inv_inertia;    // [1/(kg m2)] about the body's principal axes
  double least_radius;  // [m] of the inscribed sphere
};
static_assert(sizeof(PoseRow) == 64);

/// For a part of a composite body: its position in the body, and the body's principal axes.
struct alignas(64) LeverRow {
  Quaternion q;  // rotation from the body's principal axes to space
  Vec3d offset;  // [m] from the body's centre to the part's, in the space frame
  double none = 0;
};

/// A part in its actual size as rows of four numbers, for any of the kinds.
template <std::size_t Bytes>
struct alignas(32) FormRow {
  static constexpr std::size_t rows = (Bytes + 31) / 32;
  double value[4 * rows] = {};
  template <class Row>
  void set(const Row& row) {
    static_assert(sizeof row <= sizeof value && std::is_trivially_copyable_v<Row>);
    std::memcpy(value, static_cast<const void*>(&row), sizeof row);
  }
  template <class Row>
  Row get() const {
    Row row;
    std::memcpy(static_cast<void*>(&row), value, sizeof row);
    return row;
  }
};

/// The rows as the narrow phases use them: convex parts of bodies.
template <class Kinds, bool OnePart>
struct ConvexRows;
template <class... Kind, bool OnePart>
struct ConvexRows<KindList<Kind...>, OnePart> {
  using Kinds = KindList<Kind...>;
  static constexpr bool several = sizeof...(Kind) > 1, has_levers = !OnePart;
  template <std::size_t K>
  using KindAt = std::tuple_element_t<K, std::tuple<Kind...>>;
  using Form = FormRow<std::max({sizeof(typename KernelOf<Kind>::Row)...})>;

  AlignedVector<PoseRow> pose;            // of each row, and of two more for padding pairs
  AlignedVector<LeverRow> lever;          // of each row, and of two more, if has_levers
  AlignedVector<Form> form;               // of each row, or a single one for all
  DynArray<std::uint8_t> kind;            // of each row, if there are several
  AlignedVector<double> pace;             // [m/s] see measure_pace()
  Exponents exponents = Exponents::Ball;  // the most general of all parts
  double least_radius = 0;                // [m] of the smallest inscribed sphere
  std::tuple<typename KernelOf<Kind>::Store...> stores;
  Vec3d agreed_mean{0, 0, 0};  // [m/s] over all ranks, when the rows were renewed

  /// Upper bound of the speed of any point of a row's bounding sphere, rotating with it, relative
  /// to the mean velocity of all; the sum of the bounds of two rows bounds their closing speed. It
  /// is relative to the mean because a falling heap does not close its gaps, and per body because
  /// there are many more pairs than bodies. With several ranks it is the mean that they have agreed
  /// on, so that all ranks treat a pair alike.
  void measure_pace(const MotionRow<true>* motions, const Team& team, bool agreed = false) {
    const std::size_t n = pose.size();
    pace.resize(n);
    std::array<Vec3d, Team::most_ranges> sum{};
    team.for_ranges(n, [&](std::size_t r, std::size_t from, std::size_t to) {
      Vec3d of_range{0, 0, 0};
      for (std::size_t k = from; k < to; ++k) of_range += motions[k].velocity();
      sum[r] = of_range;
    });
    Vec3d mean{0, 0, 0};
    for (const Vec3d& s : sum) mean += s;
    mean = mean * (1 / static_cast<double>(n));
    if (agreed) mean = agreed_mean;
    team.for_ranges(n, [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) {
        const auto& m = motions[k];  // the spin velocity is that at the bounding sphere
        pace[k] = norm(m.velocity() - mean) + norm(Vec3d{m.wx, m.wy, m.wz});
      }
    });
  }

  /// The same in a box that deforms, in which images move too: relative to its flow, which adds no
  /// more than its gradient times the distance of two centres. `inner` [m]: reaches of the list.
  template <class Domain>
  void measure_pace_in_flow(const PositionRow* positions, const MotionRow<true>* motions,
                            std::span<const double> inner, const Domain& box, const Team& team) {
    pace.assign(pose.size(), 0);
    const double strain = std::sqrt(silt::inner(box.gradient(), box.gradient()));  // [1/s]
    team.for_ranges(inner.size(), [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) {
        const auto& m = motions[k];
        const Vec3d own = m.velocity() - box.flow_at(positions[k].centre());
        pace[k] = norm(own) + norm(Vec3d{m.wx, m.wy, m.wz}) + strain * (positions[k].r + inner[k]);
      }
    });
  }

  bool one_form() const { return form.size() == 1; }
  /// Whether contacts may have an area. Ellipsoids alone do not, unless their pairs use the kernels
  /// for any exponents (ConvexPairs), which store the data for areas.
  bool has_area() const {
    return several || Kinds::template has<Polyhedron> || exponents > Exponents::Two;
  }
  const Form& form_row(std::size_t row) const { return form[one_form() ? 0 : row]; }
  std::size_t kind_of([[maybe_unused]] std::size_t row) const {
    if constexpr (several)
      return kind[row];
    else
      return 0;
  }
  /// Part `row` of kind K at position `at` with orientation q.
  template <std::size_t K>
  auto placed(std::size_t row, const Vec3d& at, const Quaternion& q) const {
    using Narrow = KernelOf<KindAt<K>>;
    return Narrow::place(form_row(row).template get<typename Narrow::Row>(), body_axes(q), at);
  }
  template <std::size_t K>
  auto placed(std::size_t row, const Vec3d& at) const {
    return placed<K>(row, at, pose[row].q);
  }
  /// Calls visit(placed part).
  template <class Visit>
  void visit(std::size_t row, const Vec3d& at, const Visit& visit) const {
    visit_turned(row, at, pose[row].q, visit);
  }
  template <class Visit>
  void visit_turned(std::size_t row, const Vec3d& at, const Quaternion& q,
                    const Visit& visit) const {
    const std::size_t k = kind_of(row);
    [&]<std::size_t... K>(std::index_sequence<K...>) {
      (void)((k == K && (visit(placed<K>(row, at, q)), true)) || ...);
    }
    (std::index_sequence_for<Kind...>{});
  }
};

/// The rows of a shape; empty for shapes other than solids.
template <class ShapeType>
struct ConvexRowsOf {
  struct type {};
};
template <SolidShape ShapeType>
struct ConvexRowsOf<ShapeType> {
  using type = ConvexRows<typename ShapeType::Kinds, ShapeType::one_part>;
};

/// Calls run with the exponents as a compile-time constant.
template <class Run>
auto with_exponents(Exponents e, const Run& run) {
  const auto as = [&]<Exponents E>() { return run(std::integral_constant<Exponents, E>{}); };
  switch (e) {
    case Exponents::Ball:
      return as.template operator()<Exponents::Ball>();
    case Exponents::Two:
      return as.template operator()<Exponents::Two>();
    case Exponents::Equal:
      return as.template operator()<Exponents::Equal>();
    default:
      return as.template operator()<Exponents::Any>();
  }
}

/// Transposes rows of four numbers per lane into columns.
template <class Arch, std::size_t Rows, class Real>
SILT_INLINE void gather_columns(const double* const* at, Real (&out)[4 * Rows]) {
  constexpr std::size_t W = Lanes<Arch>::width;
  for (std::size_t r = 0; r < Rows; ++r) {
    Row4<Arch> rows[W];
    SILT_UNROLL
    for (std::size_t lane = 0; lane < W; ++lane) rows[lane] = Row4<Arch>::load(at[lane] + 4 * r);
    Real columns[4];
    rows_to_columns<Arch>(rows, columns);
    for (int c = 0; c < 4; ++c) out[4 * r + c] = columns[c];
  }
}

/// The motion of a body as its contacts need it.
template <class Real>
struct BodyAtContact {
  Vec3<Real> velocity, spin;  // [m/s] of the part's centre, [rad/s]; at the last half step
  Real inv_m;                 // [1/kg]
  BodyAxes<Real> axes;        // principal
  Vec3<Real> inv_inertia;     // [1/(kg m2)] about these
  Vec3<Real> offset;          // [m] of the part's centre from the body's

  SILT_INLINE Vec3<Real> velocity_at(const Vec3<Real>& arm) const {
    return velocity + cross(spin, arm);
  }
  /// The inverse effective mass [1/kg] for a force along n at `arm` with the couple c n: 1/m + l
  /// I^-1 l, l = r x n + c n.
  SILT_INLINE Real inverse_mass(const Vec3<Real>& arm, const Vec3<Real>& n,
                                const Real& couple = Real(0)) const {
    const Vec3<Real> lever = axes.to_body(cross(arm + offset, n) + couple * n);
    return inv_m + inv_inertia.x * lever.x * lever.x + inv_inertia.y * lever.y * lever.y +
           inv_inertia.z * lever.z * lever.z;
  }
};

/// The body of a row; contacts give their arms from the part's centre.
template <class Rows>
BodyAtContact<double> body_at_contact(const MotionRow<true>& m, const Rows& rows, std::size_t row) {
  const PoseRow& p = rows.pose[row];
  BodyAtContact<double> body{
      m.velocity(), m.spin_velocity() * m.inv_r, m.inv_m, body_axes(p.q), p.inv_inertia, {0, 0, 0}};
  if constexpr (Rows::has_levers) {
    body.axes = body_axes(rows.lever[row].q);
    body.offset = rows.lever[row].offset;
  }
  return body;
}

}  // namespace silt::detail
