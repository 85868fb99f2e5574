// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>

#include <silt/core/row4.hpp>
#include <silt/engine/contact/step_times.hpp>
#include <silt/engine/convex/convex_rows.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Input of the kernels of convex parts.
template <class Rows>
struct ConvexInput {
  const PositionRow* positions;
  const MotionRow<true>* motions;
  const Rows* rows;
  // With several materials: the index of each pair in the coefficient table, and the material of
  // each row.
  const std::uint16_t *kinds, *materials;
  StepTimes times;
};

/// Writes values[k] to to[place[k]] one by one, as scatter instructions are slower.
SILT_INLINE void scatter(const double* values, const std::uint32_t* place, std::size_t count,
                         double* to) {
  for (std::size_t k = 0; k < count; ++k) {
    to[place[k]] = values[k];
#if defined(__GNUC__)
    asm volatile("" ::: "memory");
#endif
  }
}

/// Packs of convex parts from their rows.
template <class Rows, class Arch>
struct ConvexGather {
  using Real = typename Lanes<Arch>::Real;
  static constexpr std::size_t W = Lanes<Arch>::width;
  template <std::size_t K, Exponents E>
  using FormOf = typename KernelOf<typename Rows::template KindAt<K>>::template Form<Real, E>;

  template <std::size_t K, Exponents E>
  static SILT_INLINE FormOf<K, E> form_pack(const ConvexInput<Rows>& in,
                                            const std::uint32_t* which) {
    constexpr std::size_t rows =
        (sizeof(typename KernelOf<typename Rows::template KindAt<K>>::Row) + 31) / 32;
    Real columns[4 * rows];
    if (in.rows->one_form()) {
      for (std::size_t c = 0; c < 4 * rows; ++c) columns[c] = Real(in.rows->form.front().value[c]);
    } else {
      const double* at[W];
      for (std::size_t lane = 0; lane < W; ++lane) at[lane] = in.rows->form[which[lane]].value;
      gather_columns<Arch, rows>(at, columns);
    }
    FormOf<K, E> form;
    static_assert(sizeof form <= sizeof columns);
    for (std::size_t c = 0; c < sizeof form / sizeof(Real);
         ++c)  // copying all at once would be a call
      std::memcpy(reinterpret_cast<char*>(&form) + c * sizeof(Real), columns + c, sizeof(Real));
    return form;
  }
  static SILT_INLINE BodyAxes<Real> axes_pack(const ConvexInput<Rows>& in,
                                              const std::uint32_t* which) {
    const double* at[W];
    for (std::size_t lane = 0; lane < W; ++lane) at[lane] = &in.rows->pose[which[lane]].q.w;
    Real q[4];
    gather_columns<Arch, 1>(at, q);
    return body_axes<Real>(q[0], q[1], q[2], q[3]);
  }
  static SILT_INLINE void body_pack(const ConvexInput<Rows>& in, const std::uint32_t* which,
                                    BodyAtContact<Real>& body, Real& least_radius) {
    const double* at[W];
    Real m[8], i[4];
    for (std::size_t lane = 0; lane < W; ++lane) at[lane] = &in.motions[which[lane]].vx;
    gather_columns<Arch, 2>(at, m);
    for (std::size_t lane = 0; lane < W; ++lane)
      at[lane] = &in.rows->pose[which[lane]].inv_inertia.x;
    gather_columns<Arch, 1>(at, i);
    body.velocity = {m[0], m[1], m[2]}, body.inv_m = m[3];
    body.spin = Vec3<Real>{m[4], m[5], m[6]} * m[7];
    body.inv_inertia = {i[0], i[1], i[2]}, least_radius = i[3];
    body.offset = {Real(0), Real(0), Real(0)};
    if constexpr (Rows::has_levers) {
      Real lever[8];
      for (std::size_t lane = 0; lane < W; ++lane) at[lane] = &in.rows->lever[which[lane]].q.w;
      gather_columns<Arch, 2>(at, lever);
      body.axes = body_axes<Real>(lever[0], lever[1], lever[2], lever[3]);
      body.offset = {lever[4], lever[5], lever[6]};
    }
  }
};

/// Gathers packs of the history of pairs (WithNormals): all of it, or the part that contacts at one
/// point have.
template <class List, class ContactsType, class Arch>
struct KeptGather {
  using Real = typename Lanes<Arch>::Real;
  using Memory = NormalMemory<Real>;
  static constexpr std::size_t W = Lanes<Arch>::width;
  static constexpr std::size_t M = ContactsType::memory_from, first = ContactsType::memory_to,
                               radius = ContactsType::memory_radius;
  static constexpr std::size_t chunks = (first + 3) / 4, more_chunks = (radius - first + 3) / 4;

  static NormalMemory<double> memory_at(List& list, std::uint32_t place) {
    const double* const row = list.history_row(place) + M;
    return {{row[0], row[1], row[2]}, row[3], list.history(radius)[place]};
  }
  /// History in the first rows, and R_eff.
  static SILT_INLINE void kept_of(List& list, const std::uint32_t* place,
                                  Real (&numbers)[4 * chunks], Memory& memory) {
    const double* at[W];
    for (std::size_t lane = 0; lane < W; ++lane) at[lane] = list.history_row(place[lane]);
    gather_columns<Arch, chunks>(at, numbers);
    alignas(64) double radii[W];
    const double* const from = list.history(radius);
    for (std::size_t lane = 0; lane < W; ++lane) radii[lane] = from[place[lane]];
    memory = {{numbers[M], numbers[M + 1], numbers[M + 2]}, numbers[M + 3], load<Real>(radii)};
  }
  /// History in the second rows.
  static SILT_INLINE void more_of(List& list, const std::uint32_t* place,
                                  Real (&numbers)[4 * more_chunks]) {
    const double* at[W];
    for (std::size_t lane = 0; lane < W; ++lane) at[lane] = list.more_history_row(place[lane]);
    gather_columns<Arch, more_chunks>(at, numbers);
  }
  static SILT_INLINE Memory memory_of(List& list, const std::uint32_t* place) {
    Real numbers[4 * chunks];
    Memory memory;
    kept_of(list, place, numbers, memory);
    return memory;
  }
  /// Writes the rows of a pack whose values are in columns; with the second rows if `All`.
  template <bool All, std::size_t Columns, std::size_t N>
  static SILT_INLINE void keep(List& list, const std::uint32_t* place, std::size_t valid,
                               const double (&columns)[Columns][N], std::size_t k) {
    put_rows<chunks>(columns, 0, first, valid, k,
                     [&](std::size_t lane) { return list.history_row(place[lane]); });
    if constexpr (All)
      put_rows<more_chunks>(columns, first, radius, valid, k,
                            [&](std::size_t lane) { return list.more_history_row(place[lane]); });
  }

 private:
  template <std::size_t Chunks, std::size_t Columns, std::size_t N, class RowOf>
  static SILT_INLINE void put_rows(const double (&columns)[Columns][N], std::size_t from,
                                   std::size_t to, std::size_t valid, std::size_t k,
                                   const RowOf& row_of) {
    SILT_UNROLL
    for (std::size_t c = 0; c < Chunks; ++c) {
      Real four[4] = {Real(0), Real(0), Real(0), Real(0)};
      for (std::size_t h = 0; h < 4 && from + 4 * c + h < to; ++h)
        four[h] = load<Real>(columns[from + 4 * c + h] + k);
      Row4<Arch> rows[W];
      columns_to_rows<Arch>(four, rows);
      for (std::size_t lane = 0; lane < valid; ++lane) rows[lane].store(row_of(lane) + 4 * c);
    }
  }
};

}  // namespace silt::detail
