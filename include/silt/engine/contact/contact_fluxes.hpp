// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/lanes.hpp>
#include <silt/core/storage.hpp>
#include <silt/core/threads.hpp>
#include <silt/engine/contact/coefficients.hpp>
#include <silt/engine/contact/touching_of.hpp>
#include <silt/engine/state/module_columns.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Evaluation of fluxes in a step: hold the last ones, evaluate new ones, or also their rates of
/// change.
enum class FluxLook { Hold, Ask, Measure };

/// No module exchanges a flux through contacts.
struct NoFluxes {
  static constexpr bool active = false, takes_loss = false, wears = false, needs_growth = false;
};

/// The fluxes of modules between particles in contact, evaluated block by block once the contact
/// loads are known, and summed in double for each row. The rows of one group of pairs, or one block
/// of wall contacts, are accessed by one thread at a time, in an order that depends only on the
/// lists.
template <class List, class Arch, class Scalar>
class ContactFluxes;

template <class Arch, class Scalar, class... Ms>
class ContactFluxes<ModuleList<Ms...>, Arch, Scalar> {
  using Real = typename Lanes<Arch, Scalar>::Real;
  static constexpr std::size_t W = Lanes<Arch, Scalar>::width;

 public:
  static constexpr bool active = ModuleList<Ms...>::flux;
  static constexpr bool takes_loss = (TakesLoss<Ms> || ...);
  static constexpr bool wears = ModuleList<Ms...>::wear;
  static constexpr bool needs_growth = (NeedsGrowth<Ms> || ...);
  static constexpr std::size_t wearing = ModuleList<Ms...>::wearing;

  /// Before a run: sets the coefficients of each pair of materials.
  template <class Contacts>
  void set_coefficients(const std::tuple<Ms...>& modules, const Contacts& contacts) {
    const std::size_t n = contacts.materials();
    const std::size_t of_particles = Contacts::several_materials ? n : 1;
    others_ = n;
    (make_table<Ms>(modules, contacts, of_particles, n), ...);
  }
  /// The coming step. `ask`: fluxes are evaluated, else the last ones are held; `measure`: the
  /// response rates of the fields are evaluated too.
  struct When {
    double time;  // [s]
    std::size_t walls;
    bool ask, measure;
  };
  /// Before the contacts of a step: collects the input of each row. `owner_of`: the particle of a
  /// row; `seen`: the state of a particle.
  template <class Columns, class OwnerOf, class SeenOf>
  void prepare(const std::tuple<Ms...>& modules, const Columns& columns, std::size_t rows,
               const When& when, const OwnerOf& owner_of, const SeenOf& seen, const Team& team) {
    modules_ = &modules, measure_ = when.measure;
    ask_ = when.ask || takes_loss || std::exchange(renew_, false);
    if (ask_) (prepare_one<Ms>(columns, rows, when, owner_of, seen, team), ...);
  }
  /// With several ranks prepare() covers the owned rows. This does the same for ghosts, the rows
  /// from `first` on, once their state has arrived.
  template <class Columns, class OwnerOf, class SeenOf>
  void prepare_ghosts(const Columns& columns, std::size_t first, std::size_t rows,
                      const OwnerOf& owner_of, const SeenOf& seen, const Team& team) {
    if (ask_) (prepare_one_of_ghosts<Ms>(columns, first, rows, owner_of, seen, team), ...);
  }
  /// After the contacts: each particle's sum over its rows. `all`: sums a number over the ranks;
  /// null for one process.
  template <class Columns, class OwnerOf, class All>
  void collect(Columns& columns, std::size_t rows, const OwnerOf& owner_of, const All& all) {
    if (ask_) (collect_one<Ms>(columns, rows, owner_of, all), ...);
  }
  /// Calls visit(index among the wear modules, [m3]) for each module that wears walls.
  template <class Visit>
  void worn_by(const WallRub& rub, std::size_t wall, const Visit& visit) const {
    (visit_wear<Ms>(rub, wall, visit), ...);
  }
  /// Requests an evaluation in the next step, because a particle was removed.
  void renew() { renew_ = true; }
  bool is_to_renew() const { return renew_; }
  /// Books a step of `dt` [s].
  void book(double dt) {
    for (Rows& all : rows_)
      for (WallGiven& wall : all.from_walls) wall.sum += wall.rate * dt;
  }
  /// What walls have given to the particles of a module; saved in checkpoints.
  template <class M>
  const DynArray<WallGiven>& from_walls() const {
    return rows_[index_of<M>].from_walls;
  }
  DynArray<double> wall_books() const {
    DynArray<double> books;
    for (const Rows& all : rows_) {
      books.push_back(static_cast<double>(all.from_walls.size()));
      for (const WallGiven& w : all.from_walls) books.push_back(w.rate), books.push_back(w.sum);
    }
    return books;
  }
  /// Returns false if the numbers do not fit such books.
  bool take_wall_books(const DynArray<double>& books, std::size_t walls) {
    std::size_t k = 0;
    for (Rows& all : rows_) {
      if (k == books.size() || !(books[k] >= 0 && books[k] <= static_cast<double>(walls)))
        return false;
      const auto count = static_cast<std::size_t>(books[k++]);
      if (books.size() - k < 2 * count) return false;
      all.from_walls.resize(count);
      for (WallGiven& w : all.from_walls) w = {books[k], books[k + 1]}, k += 2;
    }
    return k == books.size();
  }
  /// For a particle, in a step that measured: the sum of a module's fluxes for a field difference
  /// of 1 (partners 1, particle 0).
  template <class M>
  double slope_of(std::size_t owner) const {
    const auto& slopes = rows_[index_of<M>].owned_slope;
    return owner < slopes.size() ? slopes[owner] : 0;
  }
  bool measured() const { return measure_; }
  /// A module's estimate for a particle: the largest rate [1/s] over the materials it may touch.
  template <class M>
  double largest_rate(const M& module, const Seen& p) const {
    const auto& table = std::get<index_of<M>>(tables_).of_pair;
    double most = 0;
    for (std::size_t k = 0; k < others_ && p.material * others_ + k < table.size(); ++k)
      most = std::max(most, double{module.rate(p, table[p.material * others_ + k])});
    return most;
  }
  /// Whether fluxes were evaluated in this step, so that the received sums are new.
  bool asked() const { return ask_; }
  /// Interval [steps] between evaluations, as set by the modules.
  static std::size_t most_steps(const std::tuple<Ms...>& modules) {
    std::size_t least = takes_loss ? 1 : std::numeric_limits<std::size_t>::max();
    ((least = std::min(least, steps_of<Ms>(modules))), ...);
    return std::max<std::size_t>(least, 1);
  }

  /// The fluxes of the first `count` contacts of a block whose loads are known. `ends`, `kinds`:
  /// see ContactStage; `losses` [W] of the contacts and `growth` (Touching), if a module uses them.
  template <class ContactsType, class Block, class Ends>
  void add(const Block& block, std::size_t count, const CoefficientTable<ContactsType>& table,
           const std::uint16_t* kinds, [[maybe_unused]] const Scalar* losses, const Scalar* growth,
           const Ends& ends) {
    if (!ask_) return;
    (add_one<ContactsType, Ms>(block, count, table, kinds, growth, ends), ...);
    if constexpr (takes_loss) (add_loss<Ms>(count, kinds, losses, ends), ...);
  }

 private:
  template <class M>
  static std::size_t steps_of(const std::tuple<Ms...>& modules) {
    if constexpr (SaysFluxSteps<M>) return std::get<index_of<M>>(modules).flux_every;
    return Exchanges<M> ? 1 : std::numeric_limits<std::size_t>::max();
  }
  template <class M, class Visit>
  void visit_wear(const WallRub& rub, std::size_t wall, const Visit& visit) const {
    if constexpr (WearsWalls<M>)
      visit(ModuleList<Ms...>::template wear_index<M>, module<M>().worn(rub, wall));
  }
  template <class M>
  using Coefficients = typename CoefficientsOf<M>::template type<double>;
  template <class M>
  struct Table {
    DynArray<Coefficients<M>> of_pair{Coefficients<M>{}};
  };
  /// Stored side by side, because contacts access both at scattered rows.
  struct Row {
    double value, sum;
  };
  struct Rows {
    AlignedVector<Row> row;
    AlignedVector<double> slope, owned_slope;
    DynArray<std::optional<double>> of_wall, given;  // per wall; given: the total
    DynArray<AlignedVector<double>> of_rows;  // per wall: flux into each row, or its share of a
                                              // prescribed total of the wall
    DynArray<WallGiven> from_walls;
  };
  template <class M>
  struct Nothing {
    explicit Nothing(const DynArray<Coefficients<M>>&) {}
    void choose(const std::uint16_t*) {}
    NoCoefficients<Real> operator()() const { return {}; }
  };
  template <class M, bool Has = HasCoefficients<M>>
  struct LanesFor {
    using type = Nothing<M>;
  };
  template <class M>
  struct LanesFor<M, true> {
    using type = CoefficientLanes<CoefficientsOf<M>::template type, Real>;
  };
  template <class M>
  static constexpr std::size_t index_of = ModuleList<Ms...>::template index_of<M>;
  template <class M>
  Rows& rows_of() {
    return rows_[index_of<M>];
  }
  template <class M>
  const M& module() const {
    return std::get<index_of<M>>(*modules_);
  }
  template <class M>
  auto& table_of() {
    return std::get<index_of<M>>(tables_).of_pair;
  }

  template <class M, class Contacts>
  void make_table(const std::tuple<Ms...>& modules, const Contacts& contacts, std::size_t rows,
                  std::size_t n) {
    if constexpr (HasCoefficients<M>) {
      table_of<M>().clear();
      for (std::size_t a = 0; a < rows; ++a)
        for (std::size_t b = 0; b < n; ++b)
          table_of<M>().push_back(std::get<index_of<M>>(modules).coefficients(contacts, a, b));
    }
  }
  template <class M, class Columns, class OwnerOf, class SeenOf>
  void prepare_one(const Columns& columns, std::size_t rows, const When& when,
                   const OwnerOf& owner_of, const SeenOf& seen, const Team& team) {
    if constexpr (Exchanges<M>) {
      static_assert(FluxOnLanes<M, Real>,
                    "a module's flux() works on one double, but not on a pack of lanes: make it a "
                    "template of Real, as silt/module/concept.hpp says");
      set_values<M>(columns, 0, rows, owner_of, seen, team);
      if (SaysItsFluxRate<M> && measure_) rows_of<M>().slope.assign(rows, 0);
      if constexpr (flows_at_walls<M>) prepare_walls<M>(rows, when);
    }
  }
  /// Adds the rows from `first` on.
  template <class M, class Columns, class OwnerOf, class SeenOf>
  void set_values(const Columns& columns, std::size_t first, std::size_t rows,
                  const OwnerOf& owner_of, const SeenOf& seen, const Team& team) {
    AlignedVector<Row>& row = rows_of<M>().row;
    row.resize(rows);
    const auto& own = columns.template of<M>();
    team.for_ranges(rows - first, [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t r = first + from; r < first + to; ++r) {
        const std::size_t k = owner_of(r);
        if constexpr (HasContactValue<M>)
          row[r] = {module<M>().at_contact(seen(k), own[k]), 0};
        else
          row[r] = {own[k].*M::exchanged, 0};
      }
    });
  }
  template <class M, class Columns, class OwnerOf, class SeenOf>
  void prepare_one_of_ghosts(const Columns& columns, std::size_t first, std::size_t rows,
                             const OwnerOf& owner_of, const SeenOf& seen, const Team& team) {
    if constexpr (Exchanges<M>) {
      set_values<M>(columns, first, rows, owner_of, seen, team);
      if (SaysItsFluxRate<M> && measure_) rows_of<M>().slope.resize(rows, 0);
    }
  }
  template <class M>
  void prepare_walls(std::size_t rows, const When& when) {
    Rows& all = rows_of<M>();
    all.of_wall.resize(when.walls), all.given.resize(when.walls), all.of_rows.resize(when.walls);
    all.from_walls.resize(when.walls);
    for (std::size_t w = 0; w < when.walls; ++w) {
      all.of_wall[w] = module<M>().at_wall(w, when.time);
      if constexpr (HasGivingWalls<M>) all.given[w] = module<M>().given_by_wall(w, when.time);
      if (all.given[w] || all.of_wall[w]) all.of_rows[w].assign(rows, 0);
    }
  }
  template <class M, class Columns, class OwnerOf, class All>
  void collect_one(Columns& columns, std::size_t rows, const OwnerOf& owner_of,
                   [[maybe_unused]] const All& all_of) {
    if constexpr (Exchanges<M>) {
      auto& received = columns.template received_of<M>();
      std::fill(received.begin(), received.end(), 0.0);
      Rows& all = rows_of<M>();
      for (std::size_t w = 0; w < all.given.size(); ++w) {
        double& rate = all.from_walls[w].rate = 0;
        if (!all.given[w] && !all.of_wall[w]) continue;
        double whole = 0;
        for (std::size_t r = 0; r < rows; ++r) whole += all.of_rows[w][r];
        rate = whole;
        if (!all.given[w]) continue;
        if constexpr (!std::is_null_pointer_v<All>) whole = all_of(whole);
        if (!(whole > 0)) continue;
        [[maybe_unused]] const double own = rate;
        rate = *all.given[w];
        for (std::size_t r = 0; r < rows; ++r) all.row[r].sum += rate * (all.of_rows[w][r] / whole);
        if constexpr (!std::is_null_pointer_v<All>) rate *= own / whole;  // this rank's part
      }
      for (std::size_t r = 0; r < rows; ++r) received[owner_of(r)] += all.row[r].sum;
      if (!SaysItsFluxRate<M> || !measure_) return;
      all.owned_slope.assign(received.size(), 0);
      for (std::size_t r = 0; r < rows; ++r) all.owned_slope[owner_of(r)] += all.slope[r];
    }
  }

  template <class ContactsType, class M, class Block, class Ends>
  void add_one(const Block& block, std::size_t count, const CoefficientTable<ContactsType>& table,
               const std::uint16_t* kinds, const Scalar* growth, const Ends& ends) {
    if constexpr (Ends::at_wall ? flows_at_walls<M> : Exchanges<M>) {
      CoefficientLanes<ContactsType::Law::template Coefficients, Real> law(table.law);
      typename LanesFor<M>::type own(table_of<M>());
      for (std::size_t k = 0; k < count; k += W) {
        if (!any(load<Real>(block.overlap + k) > Real(0))) continue;
        if (kinds != nullptr) {
          own.choose(kinds + k);
          if constexpr (SaysSoftness<typename ContactsType::Law>) law.choose(kinds + k);
        }
        flow_of<M>(touching_of<ContactsType, Ends::at_wall, Real>(block, k, growth, law), own(), k,
                   std::min(W, count - k), ends);
      }
    }
  }
  template <class M, class P, class Ends>
  void flow_of(const Touching<Real>& c, const P& p, std::size_t k, std::size_t valid,
               const Ends& ends) {
    Rows& all = rows_of<M>();
    alignas(64) Scalar of_ends[2][W] = {}, flux[W], slope[W] = {};
    const std::uint64_t touch = lane_bits(c.overlap > Real(0)) & ((std::uint64_t{1} << valid) - 1);
    const auto for_each = [touch](const auto& visit) {
      for (std::uint64_t bits = touch; bits != 0; bits &= bits - 1)
        visit(static_cast<std::size_t>(std::countr_zero(bits)));
    };
    for_each([&](std::size_t lane) {
      of_ends[0][lane] = static_cast<Scalar>(all.row[ends.first(k + lane)].value);
      if constexpr (Ends::at_wall)
        of_ends[1][lane] = static_cast<Scalar>(all.of_wall[ends.wall(k + lane)].value_or(0));
      else
        of_ends[1][lane] = static_cast<Scalar>(all.row[ends.second(k + lane)].value);
    });
    ask<M>(c, p, load<Real>(of_ends[0]), load<Real>(of_ends[1]), flux);
    if (measure_ || (Ends::at_wall && HasGivingWalls<M>)) ask<M>(c, p, Real(0), Real(1), slope);
    for_each([&](std::size_t lane) {
      const auto i = ends.first(k + lane);
      if constexpr (Ends::at_wall) {
        const std::size_t w = ends.wall(k + lane);
        if (all.given[w]) {
          all.of_rows[w][i] += static_cast<double>(slope[lane]);
          return;
        }
        if (!all.of_wall[w]) return;
        all.of_rows[w][i] += static_cast<double>(flux[lane]);
      }
      all.row[i].sum += static_cast<double>(flux[lane]);
      if constexpr (!Ends::at_wall)
        all.row[ends.second(k + lane)].sum -= static_cast<double>(flux[lane]);
      if (SaysItsFluxRate<M> && measure_) {
        all.slope[i] += static_cast<double>(slope[lane]);
        if constexpr (!Ends::at_wall)
          all.slope[ends.second(k + lane)] += static_cast<double>(slope[lane]);
      }
    });
  }
  template <class M, class P>
  void ask(const Touching<Real>& c, const P& p, const Real& a, const Real& b,
           Scalar (&flux)[W]) const {
    const Real answer = flux_of<M, Real>(module<M>(), c, p, a, b);
    store(flux, select(c.overlap > Real(0), answer, Real(0)));
  }
  /// The last increment of a contact's loss is booked in the step after its end.
  template <class M, class Ends>
  void add_loss(std::size_t count, const std::uint16_t* kinds, const Scalar* losses,
                const Ends& ends) {
    if constexpr (TakesLoss<M>) {
      AlignedVector<Row>& row = rows_of<M>().row;
      for (std::size_t k = 0; k < count; ++k) {
        const auto loss = static_cast<double>(losses[k]);
        if (loss == 0) continue;
        const double share =
            module<M>().share_of_loss(table_of<M>()[kinds == nullptr ? 0 : kinds[k]]);
        row[ends.first(k)].sum += share * loss;
        if constexpr (!Ends::at_wall) row[ends.second(k)].sum += (1 - share) * loss;
      }
    }
  }

  const std::tuple<Ms...>* modules_ = nullptr;
  bool ask_ = false, measure_ = false, renew_ = false;
  std::size_t others_ = 1;  // entries of a material in the tables
  std::tuple<Table<Ms>...> tables_;
  Rows rows_[sizeof...(Ms) > 0 ? sizeof...(Ms) : 1];
};

/// The fluxes of a composition.
template <class Modules, class Arch, class Scalar>
using FluxesOf = std::conditional_t<Modules::flux || Modules::wear,
                                    ContactFluxes<Modules, Arch, Scalar>, NoFluxes>;

}  // namespace silt::detail
