// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <tuple>
#include <type_traits>

#include <silt/core/dyn_array.hpp>
#include <silt/core/quaternion.hpp>
#include <silt/core/storage.hpp>
#include <silt/core/threads.hpp>
#include <silt/engine/state/bonded_pairs.hpp>
#include <silt/engine/state/columns.hpp>
#include <silt/engine/state/composition.hpp>
#include <silt/engine/state/fluid_loads.hpp>
#include <silt/engine/state/rows.hpp>

namespace silt::inline SILT_TARGET::detail {

struct NoGhosts {};

/// The state of all particles: rows, ids, and materials if there are several; and a second copy of
/// the motion in PairScalar, if that is not double. There are two rows more than particles: dummy
/// spheres of radius 0, the partners of padding pairs. For bodies, rows are their parts; the bodies
/// themselves are in another table (BodyMotion).
template <class Composition>
class ParticleState {
  static constexpr bool Rotates = Composition::Contacts::rotates,
                        SeveralMaterials = Composition::several_materials,
                        OfBodies = Composition::of_bodies, Bonded = Composition::has_bonds;
  using PairScalar = typename Composition::Scalar;
  /// Derivatives of position and of spin velocity that the integrator stores.
  static constexpr std::size_t Derivatives = Composition::Integrator::derivatives;
  static constexpr FromFluid Given = OfBodies ? FromFluid::Nothing : Composition::from_fluid;
  using Columns =
      ModuleColumns<std::conditional_t<OfBodies, ModuleList<>, typename Composition::Modules>>;

 public:
  static constexpr std::size_t derivative_rows = Derivatives * (1 + Rotates);
  /// Rows of four; the first entry is NaN until the derivatives are known.
  struct alignas(32) HigherDerivatives {
    double row[derivative_rows == 0 ? 1 : derivative_rows][4];
  };
  using ParticleMotion = MotionRow<Rotates>;
  using PairMotion = MotionRow<Rotates, PairScalar>;
  static constexpr bool single = std::is_same_v<PairScalar, float>;
  static constexpr std::size_t bytes_per_particle =
      bytes_of_row<ParticleState>() + (single ? sizeof(PairMotion) : 0) +
      bytes_of_row<FluidLoads<Given>>() + bytes_of_row<Columns>();
  static constexpr bool of_bodies = OfBodies, several = SeveralMaterials, bonded = Bonded;
  static constexpr bool of_ranks = Composition::has_ranks;
  using Ranks = typename Composition::Ranks;

  AlignedVector<PositionRow> position;
  AlignedVector<ParticleMotion> motion;
  AlignedVector<HigherDerivatives> derivatives;  // if the integrator uses any
  DynArray<ParticleId> id;
  DynArray<std::uint16_t> material;
  DynArray<PartRow> part;                 // for bodies
  AlignedVector<Quaternion> orientation;  // of spheres, once there is a bond
  // Mirrors the list of bonds; bonds of particles that have left are removed when it is next read.
  [[no_unique_address]] mutable std::conditional_t<Bonded, BondedPairs, NoPairs> bonds;
  [[no_unique_address]] FluidLoads<Given> fluid;
  [[no_unique_address]] Columns modules;
  double largest_radius = 0;   // [m]
  double smallest_radius = 0;  // [m]
  double mean_diameter = 0;    // [m]
  bool some_fixed = false;     // some particles have infinite mass
  std::size_t parked = 0;      // number that left since the last search
  // Number of ghosts, the last rows: copies of other ranks' particles, which act on the rows before
  // them and are not moved here.
  [[no_unique_address]] std::conditional_t<of_ranks, std::size_t, NoGhosts> ghosts{};
  std::uint64_t changes = 0;  // how often places were reassigned

  /// The motion in the precision of the pair kernel.
  const PairMotion* pair_motion() const {
    if constexpr (single)
      return pair_motion_.data();
    else
      return motion.data();
  }
  PairMotion* pair_rows() { return pair_motion_.data(); }  // the separate copy, if single precision
  /// Copies all motion to the pair kernel's copy; kicks then keep it up to date.
  void renew_pair_motion(const Team& team) {
    if constexpr (single) {
      pair_motion_.resize(motion.size());
      team.for_ranges(motion.size(), [&](std::size_t, std::size_t from, std::size_t to) {
        for (std::size_t k = from; k < to; ++k) set_pair_motion(k);
      });
    }
  }

  /// The same of one row.
  void renew_pair_motion([[maybe_unused]] std::size_t k) {
    if constexpr (single)
      if (k < pair_motion_.size()) set_pair_motion(k);
  }

  /// Changes the velocity of row k by dv [m/s]; pair_motion() is updated at the next kick.
  void add_velocity(std::size_t k, const Vec3d& dv) {
    auto& m = motion[k];
    m.vx += dv.x, m.vy += dv.y, m.vz += dv.z;
  }
  std::size_t size() const { return id.size(); }
  /// Number of rows owned by this rank, which come first; all rows if there is a single rank.
  std::size_t owned() const {
    if constexpr (of_ranks)
      return size() - ghosts;
    else
      return size();
  }
  std::span<const PositionRow> rows() const { return {position.data(), owned()}; }

  ParticleState() { pad(); }

  static constexpr auto columns() {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    return std::tuple_cat(
        std::tuple{column<ParticleId>(
                       "id", [](auto& t) -> auto& { return t.id; }, no_particle, no_particle),
                   column<PositionRow>("position", [](auto& t) -> auto& { return t.position; }, {},
                                       {nan, nan, nan, 0}),
                   column<ParticleMotion>(
                       "motion", [](auto& t) -> auto& { return t.motion; })},
        columns_if<(Derivatives > 0)>([=] {
          return std::tuple{column<HigherDerivatives>(
              "derivatives", [](auto& t) -> auto& { return t.derivatives; }, {{{nan}}})};
        }),
        columns_if<SeveralMaterials>([] {
          return std::tuple{column<std::uint16_t>(
              "material", [](auto& t) -> auto& { return t.material; })};
        }),
        columns_if<OfBodies>([] {
          return std::tuple{column<PartRow>(
              "parts", [](auto& t) -> auto& { return t.part; })};
        }),
        columns_if<Bonded>([] {
          return std::tuple{column<Quaternion>(
              "orientation", [](auto& t) -> auto& { return t.orientation; })};
        }));
  }

  /// For bodies, `body` says which one the row belongs to.
  void add(const PositionRow& p, const ParticleMotion& m, ParticleId new_id, std::uint16_t of,
           [[maybe_unused]] const PartRow& body = {}) {
    const std::size_t k = size();
    position.resize(k), motion.resize(k);
    if constexpr (Bonded) orientation.resize(k);
    add_row(*this), add_row(fluid), add_row(modules);
    id[k] = new_id, position[k] = p, motion[k] = m;
    if constexpr (SeveralMaterials) material[k] = of;
    if constexpr (OfBodies) part[k] = body;
    pad();
  }

  /// Recomputes the size statistics after particles were added or dropped.
  void measure() {
    largest_radius = 0, mean_diameter = 0;
    for (const auto& p : rows()) {
      largest_radius = std::max(largest_radius, p.r);
      mean_diameter += 2 * p.r;
    }
    if (owned() > 0) mean_diameter /= static_cast<double>(owned());
    measure_others();
  }
  /// The same if only the rows from `first` on are new.
  void measure_newcomers(std::size_t first) {
    double sum = mean_diameter * static_cast<double>(first);
    if (first == 0) largest_radius = 0, smallest_radius = std::numeric_limits<double>::infinity();
    for (std::size_t k = first; k < size(); ++k) {
      sum += 2 * position[k].r;
      largest_radius = std::max(largest_radius, position[k].r);
      smallest_radius = std::min(smallest_radius, position[k].r);
      some_fixed |= motion[k].inv_m == 0;
    }
    if (size() > 0) mean_diameter = sum / static_cast<double>(size());
  }
  /// Call after the radius of row k, previously `before` [m], has changed. The largest and smallest
  /// radius are bounds until sizes are measured again.
  void include_size(std::size_t k, double before) {
    largest_radius = std::max(largest_radius, position[k].r);
    smallest_radius = std::min(smallest_radius, position[k].r);
    mean_diameter += 2 * (position[k].r - before) / static_cast<double>(size());
  }
  /// Completes a restored state; sizes are those saved.
  void restored(double radius, double diameter) {
    largest_radius = radius, mean_diameter = diameter;
    parked = static_cast<std::size_t>(
        std::count(id.begin(), id.begin() + static_cast<std::ptrdiff_t>(owned()), no_particle));
    measure_others();
  }

  /// Removes particle k from all contacts at once; the next search drops its row.
  void park(std::size_t k) {
    fluid.leave(k);
    [[maybe_unused]] PartRow of{};  // it stays a row of its body, which goes with it
    if constexpr (OfBodies) of = part[k];
    park_row(*this, k), park_row(fluid, k), park_row(modules, k);
    if constexpr (OfBodies) part[k] = of;
    ++parked;
  }
  bool is_parked(std::size_t k) const { return id[k] == no_particle; }

  /// Moves particle order[k] to place k; particles not in `order` are dropped.
  void reorder(std::span<const std::uint32_t> order, const Team& team) {
    gather_rows(*this, order, team), gather_rows(fluid, order, team);
    gather_rows(modules, order, team);
    pad();
    ++changes;
  }

  /// Call before rows are appended column by column; pad() must follow.
  void take_off_pads() {
    position.resize(size()), motion.resize(size());
    if constexpr (Bonded) orientation.resize(size());
  }
  void pad() {
    position.resize(size()), motion.resize(size());
    if constexpr (Bonded) orientation.resize(size()), orientation.resize(size() + 2);
    for (int k = 0; k < 2; ++k) {
      position.push_back({k * padding_.x, k * padding_.y, k * padding_.z, 0});
      ParticleMotion m{};
      m.inv_m = 1;
      if constexpr (Rotates) m.inv_r = 1;
      motion.push_back(m);
    }
  }

  /// Keeps the two rows of padding apart in a periodic box. Folded together, a law that acts at a
  /// distance would divide by their radii, and its energies would be NaN.
  template <class Domain>
  void keep_padding_apart([[maybe_unused]] const Domain& box) {
    if constexpr (Domain::periodic) {
      const auto apart = [&](int d) { return box.repeats(d) ? 0.5 * box.length(d) : far; };
      padding_ = {apart(0), apart(1), apart(2)};
      position[size() + 1] = {padding_.x, padding_.y, padding_.z, 0};
    }
  }

 private:
  static constexpr double far = 1e6;  // [m] beyond the range of any law
  Vec3d padding_{far, 0, 0};          // [m] from one row of padding to the other
  AlignedVector<PairMotion> pair_motion_;  // if it is not the same as motion

  void set_pair_motion(std::size_t k) {
    const ParticleMotion& m = motion[k];
    PairMotion& p = pair_motion_[k];
    p.vx = float(m.vx), p.vy = float(m.vy), p.vz = float(m.vz), p.inv_m = float(m.inv_m);
    if constexpr (Rotates)
      p.wx = float(m.wx), p.wy = float(m.wy), p.wz = float(m.wz), p.inv_r = float(m.inv_r);
  }

  void measure_others() {
    smallest_radius = largest_radius;
    for (const auto& p : rows())
      if (p.r > 0) smallest_radius = std::min(smallest_radius, p.r);
    some_fixed = std::any_of(motion.begin(), motion.begin() + static_cast<std::ptrdiff_t>(owned()),
                             [](const ParticleMotion& m) { return m.inv_m == 0; });
  }
};

}  // namespace silt::detail
