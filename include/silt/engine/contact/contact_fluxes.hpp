// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>

#include <silt/core/lanes.hpp>
#include <silt/core/storage.hpp>
#include <silt/core/threads.hpp>
#include <silt/engine/state/module_columns.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Nothing flows between particles in contact.
struct NoFluxes {
  static constexpr bool active = false;
};

/// The fluxes of modules between particles in contact, asked for block by block once the contacts'
/// loads are known, and summed in double for each row. Rows of one group of pairs, or one block of
/// walls, are touched by one thread at a time, in an order that depends on nothing but the lists.
template <class List, class Arch, class Scalar>
class ContactFluxes;

template <class Arch, class Scalar, class... Ms>
class ContactFluxes<ModuleList<Ms...>, Arch, Scalar> {
  using Real = typename Lanes<Arch, Scalar>::Real;
  static constexpr std::size_t W = Lanes<Arch, Scalar>::width;

 public:
  static constexpr bool active = ModuleList<Ms...>::flux;

  /// Before the contacts of a step: takes up what the rows have. `owner_of` a row.
  template <class Columns, class OwnerOf>
  void prepare(const std::tuple<Ms...>& modules, const Columns& columns, std::size_t rows,
               double time, const OwnerOf& owner_of, const Team& team) {
    modules_ = &modules, time_ = time;
    (prepare_one<Ms>(columns, rows, owner_of, team), ...);
  }
  /// After them: each owner's sum over its rows.
  template <class Columns, class OwnerOf>
  void collect(Columns& columns, std::size_t rows, const OwnerOf& owner_of) const {
    (collect_one<Ms>(columns, rows, owner_of), ...);
  }

  /// The fluxes of the first `count` contacts of a block, whose loads are known. `ends`: of the
  /// ContactStage.
  template <class Block, class Ends>
  void add(const Block& block, std::size_t count, const Ends& ends) {
    if constexpr (Ends::at_wall && !(flows_at_walls<Ms> || ...)) return;
    for (std::size_t k = 0; k < count; k += W) {
      const auto c = touching(block, k);
      if (any(c.overlap > Real(0))) (flow_of<Ms>(c, k, std::min(W, count - k), ends), ...);
    }
  }

 private:
  struct Rows {
    AlignedVector<double> value, sum;
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

  template <class M, class Columns, class OwnerOf>
  void prepare_one(const Columns& columns, std::size_t rows, const OwnerOf& owner_of,
                   const Team& team) {
    if constexpr (Exchanges<M>) {
      static_assert(FluxOnLanes<M, Real>,
                    "a module's flux() works on one double, but not on a pack of lanes: make it a "
                    "template of Real, as silt/module/concept.hpp says");
      AlignedVector<double>&value = rows_of<M>().value, &sum = rows_of<M>().sum;
      value.resize(rows + 2), sum.resize(rows + 2);  // two for the pairs that fill packs up
      const auto& own = columns.template of<M>();
      team.for_ranges(rows, [&](std::size_t, std::size_t from, std::size_t to) {
        for (std::size_t r = from; r < to; ++r)
          value[r] = own[owner_of(r)].*M::exchanged, sum[r] = 0;
      });
      for (std::size_t r = rows; r < rows + 2; ++r) value[r] = sum[r] = 0;
    }
  }
  template <class M, class Columns, class OwnerOf>
  void collect_one(Columns& columns, std::size_t rows, const OwnerOf& owner_of) const {
    if constexpr (Exchanges<M>) {
      auto& received = columns.template received_of<M>();
      std::fill(received.begin(), received.end(), 0.0);
      const auto& sum = rows_[index_of<M>].sum;
      for (std::size_t r = 0; r < rows; ++r) received[owner_of(r)] += sum[r];
    }
  }

  /// What a module sees of a pack of contacts, whose loads have taken the place of velocities.
  template <class Block>
  static Touching<Real> touching(const Block& block, std::size_t k) {
    const auto kin = block.template get<Real>(k);
    const auto load = block.template get_load<Real>(k);
    return {kin.normal, load.force, dot(load.force, kin.normal), kin.overlap, kin.R_eff, kin.m_eff};
  }
  template <class M, class Ends>
  void flow_of(const Touching<Real>& c, std::size_t k, std::size_t valid, const Ends& ends) {
    if constexpr (Ends::at_wall ? flows_at_walls<M> : Exchanges<M>) {
      auto& [value, sum] = rows_of<M>();
      alignas(64) Scalar of_ends[2][W] = {};
      for (std::size_t lane = 0; lane < valid; ++lane) {
        of_ends[0][lane] = static_cast<Scalar>(value[ends.first(k + lane)]);
        if constexpr (Ends::at_wall)
          of_ends[1][lane] = static_cast<Scalar>(module<M>().at_wall(ends.wall(k + lane), time_));
        else
          of_ends[1][lane] = static_cast<Scalar>(value[ends.second(k + lane)]);
      }
      alignas(64) Scalar flux[W];
      ask<M>(c, of_ends, flux);
      for (std::size_t lane = 0; lane < valid; ++lane) {
        sum[ends.first(k + lane)] += static_cast<double>(flux[lane]);
        if constexpr (!Ends::at_wall) sum[ends.second(k + lane)] -= static_cast<double>(flux[lane]);
      }
    }
  }
  template <class M>
  void ask(const Touching<Real>& c, const Scalar (&of_ends)[2][W], Scalar (&flux)[W]) const {
    const Real answer = module<M>().flux(c, load<Real>(of_ends[0]), load<Real>(of_ends[1]));
    store(flux, select(c.overlap > Real(0), answer, Real(0)));
  }

  const std::tuple<Ms...>* modules_ = nullptr;
  double time_ = 0;  // [s]
  Rows rows_[sizeof...(Ms) > 0 ? sizeof...(Ms) : 1];
};

/// Those of a composition.
template <class Modules, class Arch, class Scalar>
using FluxesOf = std::conditional_t<Modules::flux, ContactFluxes<Modules, Arch, Scalar>, NoFluxes>;

}  // namespace silt::detail
