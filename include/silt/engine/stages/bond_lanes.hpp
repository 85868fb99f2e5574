// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of BondStage: a group of bonds in SIMD lanes, from the rows of their ends to the load sums.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <silt/core/members.hpp>
#include <silt/core/row4.hpp>
#include <silt/core/row8.hpp>
#include <silt/engine/stages/bond_stage.hpp>

namespace silt::inline SILT_TARGET::detail {

template <class Model, class Domain, class Arch>
template <bool damped, class Engine>
inline void BondStage<Model, Domain, Arch>::run_group(Engine& e, const Domain& domain,
                                                      const typename List::Group& g, double ago,
                                                      Done& done) {
  Block b;
  Real power(0);
  [[maybe_unused]] Virial virial;
  const Real age(ago);
  const bool beyond_caches = e.particles.size() > 8000;
  for (std::size_t from = g.from; from < g.to; from += block) {
    const std::size_t count = std::min(block, g.to - from);
    gather<damped>(e, domain, from, count, beyond_caches, b);
    for (std::size_t k = 0; k < count; k += W)
      if (const auto bits = run_pack<damped>(e, from + k, k, age, b, power, virial))
        for (std::size_t lane = 0; lane < W; ++lane)
          if (bits >> lane & 1 && from + k + lane < g.to)
            done.over.push_back(static_cast<std::uint32_t>(from + k + lane));
    add_up(e, from, count, b.loads);
  }
  if constexpr (keeps_ledger<typename Engine::Contacts>) {
    alignas(Real) double each[W];
    silt::store(each, power);
    for (const double one : each) done.power += one;
  }
  if constexpr (deforms<Domain>) done.virial = virial.sum();
}

template <class Model, class Domain, class Arch>
template <bool damped, class Engine>
__attribute__((flatten)) void BondStage<Model, Domain, Arch>::gather(Engine& e,
                                                                     const Domain& domain,
                                                                     std::size_t from,
                                                                     std::size_t count, bool ahead,
                                                                     Block& b) const {
  for (std::size_t k = 0; k < count; k += W) {
    if (ahead) fetch(e, from + k + List::ahead);
    for_each_member<Real>(ends_of<damped>(e.particles, domain, from + k),
                          [&](auto c, const Real& column) {
                            if constexpr (damped || !of_rates(c))
                              silt::store(b.ends[c] + k, column);
                          });
  }
}

template <class Model, class Domain, class Arch>
template <bool damped, class State>
SILT_INLINE auto BondStage<Model, Domain, Arch>::ends_of(const State& particles,
                                                         const Domain& domain, std::size_t k) const
    -> Pack<Real> {
  const auto* const position = particles.position.data();
  const auto* const motion = particles.motion.data();
  const auto* const orientation = particles.orientation.data();
  const std::uint32_t *a = list.first() + k, *b = list.second() + k;
  const auto turned_rows = [&](const auto& row_of, Real(&c)[4]) {
    read_anew(a), read_anew(b);
    Row rows[W];
    SILT_UNROLL
    for (std::size_t lane = 0; lane < W; ++lane) rows[lane] = row_of(lane);
    rows_to_columns<Arch>(rows, c);
  };
  Pack<Real> p;
  Real c[4];
  turned_rows([&](auto l) { return Row::load(&position[a[l]].x) - Row::load(&position[b[l]].x); },
              c);
  const Vec3<Real> whole{c[0], c[1], c[2]};
  p.ends.apart = whole;
  if constexpr (Domain::periodic) p.ends.apart = domain.shortest(whole);
  if constexpr (damped) {
    turned_rows([&](auto l) { return Row::load(&motion[a[l]].vx) - Row::load(&motion[b[l]].vx); },
                c);
    p.ends.velocity = {c[0], c[1], c[2]};
    if constexpr (deforms<Domain>) p.ends.velocity -= domain.carried(whole - p.ends.apart);
  }
  turned_rows([&](auto l) { return Row::load(&motion[a[l]].wx); }, c);
  p.ends.spin_i = Vec3<Real>{c[0], c[1], c[2]} * c[3], p.inv_r_i = c[3];
  turned_rows([&](auto l) { return Row::load(&motion[b[l]].wx); }, c);
  p.ends.spin_j = Vec3<Real>{c[0], c[1], c[2]} * c[3], p.inv_r_j = c[3];
  turned_rows([&](auto l) { return Row::load(&orientation[a[l]].w); }, c);
  p.ends.orientation_i = {c[0], c[1], c[2], c[3]};
  turned_rows([&](auto l) { return Row::load(&orientation[b[l]].w); }, c);
  p.ends.orientation_j = {c[0], c[1], c[2], c[3]};
  return p;
}

template <class Model, class Domain, class Arch>
template <class Engine>
SILT_INLINE void BondStage<Model, Domain, Arch>::fetch(Engine& e, std::size_t k) const {
  list.fetch(k);
  for (std::size_t lane = 0; lane < W; ++lane) {
    const std::size_t later = std::max(list.first()[k + lane], list.second()[k + lane]);
    __builtin_prefetch(e.particles.position.data() + later);
    __builtin_prefetch(e.particles.motion.data() + later);
    __builtin_prefetch(e.particles.orientation.data() + later);
    __builtin_prefetch(e.load_sums() + later * 4 * Engine::chunks, 1);
  }
}

template <class Model, class Domain, class Arch>
SILT_INLINE void BondStage<Model, Domain, Arch>::put(const Vec3<Real>& v, double* to) {
  const Real turned[4] = {v.x, v.y, v.z, Real(0)};
  Row rows[W];
  columns_to_rows<Arch>(turned, rows);
  SILT_UNROLL
  for (std::size_t lane = 0; lane < W; ++lane) rows[lane].store(to + lane * row);
}

template <class Model, class Domain, class Arch>
template <bool damped, class Engine>
__attribute__((flatten)) std::uint64_t BondStage<Model, Domain, Arch>::run_pack(
    const Engine&, std::size_t of_list, std::size_t k, const Real& ago, Block& b,
    [[maybe_unused]] Real& power, [[maybe_unused]] Virial& virial) const {
  const auto p = members_of<Pack<Real>, Real>([&](auto c) {
    if constexpr (damped || !of_rates(c)) return silt::load<Real>(b.ends[c] + k);
    return Real(0);
  });
  auto s = list.columns().strain(of_list, p.ends);
  if constexpr (damped) take_rates_of(ago, p.ends, s);
  const auto numbers = list.columns().template load_numbers<Real>(of_list);
  const auto a = model.answer(s, numbers);
  const Vec3<Real> none{Real(0), Real(0), Real(0)};
  const auto l = damped ? loads_of(s, a.force, a.couple, a.rate_force, a.rate_couple)
                        : loads_of(s, a.force, a.couple, none, none);
  double* const out = b.loads + k * row;
  put(l.force, out), put(l.torque_i * p.inv_r_i, out + 4), put(l.torque_j * p.inv_r_j, out + 8);
  if constexpr (damped && keeps_ledger<typename Engine::Contacts>)
    power += dot(a.rate_force, s.shift_rate) + dot(a.rate_couple, s.turn_rate);
  if constexpr (deforms<Domain>) virial.add(l.force, p.ends.apart);
  if constexpr (requires { model.holds_always(); })
    if (model.holds_always()) return 0;
  if constexpr (requires { model.holds(a, s.normal, numbers); })
    if (lane_bits(model.holds(a, s.normal, numbers)) == (std::uint64_t{1} << W) - 1) return 0;
  return lane_bits(model.load(a, s.normal, numbers) > Real(1));
}

template <class Model, class Domain, class Arch>
template <class Engine>
inline void BondStage<Model, Domain, Arch>::add_up(Engine& e, std::size_t from, std::size_t count,
                                                   const double* loads) {
  using Scalar = typename Engine::Scalar;
  using SumRow = Row4<Arch, Scalar>;
  constexpr std::size_t stride = 8;
  Scalar* const sums = e.load_sums();
  const std::uint32_t *const a = list.first() + from, *const b = list.second() + from;
  const auto add = [](Scalar* sum, const Row& force, const Row& torque) {
    (SumRow::load(sum) + convert<Scalar>(force)).store(sum);
    (SumRow::load(sum + 4) + convert<Scalar>(torque)).store(sum + 4);
  };
  for (std::size_t first = 0; first < stride; ++first)
    for (std::size_t k = first; k < count; k += stride) {
      const double* const l = loads + k * row;
      Scalar* const of_a = sums + a[k] * 4 * Engine::chunks;
      Scalar* const of_b = sums + b[k] * 4 * Engine::chunks;
      if constexpr (Engine::chunks == 2 && has_row8<Arch, double> &&
                    std::is_same_v<Scalar, double>) {
        using Whole = Row8<Arch, double>;
        (Whole::load(of_a) + Whole::load(l)).store(of_a);
        (Whole::load(of_b) + Whole::of(-1, -1, 1, 1) * Whole::of(Row::load(l), Row::load(l + 8)))
            .store(of_b);
      } else {
        const Row force = Row::load(l);
        add(of_a, force, Row::load(l + 4));
        add(of_b, Row::all(0) - force, Row::load(l + 8));
      }
    }
}

}  // namespace silt::detail
