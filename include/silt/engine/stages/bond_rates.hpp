// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of BondStage: the highest frequency that bonds give to particles, and the stable time step.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/engine/stages/bond_stage.hpp>

namespace silt::inline SILT_TARGET::detail {

template <class Model, class Domain, class Arch>
template <class Engine>
auto BondStage<Model, Domain, Arch>::fastest(const Engine& e) -> Rate {
  follow(e);
  DynArray<BondStiffness> all(e.particles.size(), BondStiffness{0, 0});
  const auto include = [&](std::size_t at, const BondStiffness& s, double arm) {
    all[at].shift += s.shift, all[at].turn += s.turn + s.shift * arm * arm;
    all[at].shift_damping += s.shift_damping;
    all[at].turn_damping += s.turn_damping + s.shift_damping * arm * arm;
  };
  const auto include_bond = [&](const Bond& b, std::size_t i, std::size_t j) {
    const auto s = model.stiffest(b.numbers);
    const double length = norm(b.rest.apart);
    if (i < all.size()) include(i, s, b.rest.share * length);
    if (j < all.size()) include(j, s, (1 - b.rest.share) * length);
  };
  if (Engine::of_ranks && fresh)
    list.for_each_in_order([&](const Bond& b) {
      const std::size_t i = e.find(b.i), j = e.find(b.j);
      include_bond(list.as_kept(b), i < e.owners() ? i : all.size(),
                   j < e.owners() ? j : all.size());
    });
  else
    list.for_each(
        [&](std::size_t k) { include_bond(list.bond(k), list.first()[k], list.second()[k]); });
  for (const auto& b : at_walls.all)
    include(e.find(b.i), model.stiffest(b.numbers), b.rest.share * norm(b.rest.apart));
  Rate most;
  for (std::size_t k = 0; k < e.owners(); ++k) {
    const auto p = e.owner(k);
    if (!p.is_there() || p.inverse_mass() == 0) continue;
    const double m = p.mass(),
                 I = Engine::ShapeType::inertia_factor() * m * p.radius() * p.radius();
    for (const auto& [w2, g] : {std::pair{2 * all[k].shift / m, 2 * all[k].shift_damping / m},
                                std::pair{2 * all[k].turn / I, 2 * all[k].turn_damping / I}}) {
      most.rate = std::max(most.rate, std::sqrt(w2));
      const double step = 1.6 / (g + std::sqrt(g * g + 4 * w2));
      if (step < most.stable_step) most.stable_step = step, most.particle = p.id();
    }
  }
  return most;
}

template <class Model, class Domain, class Arch>
double BondStage<Model, Domain, Arch>::stiffness() {
  if (counted_made_ == made && counted_ == list.size()) return stiffness_;
  const auto of = [&](std::size_t k) {
    const Bond b = list.bond(k);
    return model.stiffest(b.numbers).shift * dot(b.rest.apart, b.rest.apart);
  };
  double most = 0;
  list.for_each([&](std::size_t k) { most = std::max(most, of(k)); });
  // A sum of whole numbers has no order; 2^30 of up to 2^32 each do not overflow.
  const double unit = std::ldexp(most, -32);
  std::uint64_t sum = 0;
  if (unit > 0)
    list.for_each([&](std::size_t k) { sum += static_cast<std::uint64_t>(of(k) / unit); });
  counted_made_ = made, counted_ = list.size();
  return stiffness_ = static_cast<double>(sum) * unit;
}

}  // namespace silt::detail
