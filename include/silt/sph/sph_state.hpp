// silt - BSD-3-Clause, see LICENSE
#pragma once

// Part of Sph used only by checkpoints.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <span>

#include <silt/core/dyn_array.hpp>
#include <silt/sph/sph.hpp>

namespace silt::inline SILT_TARGET {

template <class... Policies>
template <class Visit>
void Sph<Policies...>::for_each_state(const Visit& visit) {
  constexpr std::size_t row = 8;
  reading_.known = false;
  const auto is_lane = [](std::uint32_t label) { return label == Core::Lists::none; };
  clock.for_each_state(visit);
  Core& c = core();
  auto& bodies = c.solids.bodies;
  DynArray<double> rows, labels, built, growth, kinds = bodies.kinds(), points = bodies.points();
  for (std::size_t k = 0; k < c.columns.size(); ++k) {
    const auto put = [&](const Row& r) {
      rows.insert(rows.end(), {r.x, r.y, r.z, r.vx, r.vy, r.vz, r.density, r.pressure});
    };
    put(c.columns.rows[k]), put(c.columns.start[k]);
    labels.push_back(is_lane(c.columns.label[k]) ? -1 : static_cast<double>(c.columns.label[k]));
    labels.push_back(static_cast<double>(c.columns.kind[k]));
    if constexpr (Core::Time::leaps) {
      const detail::SphGrowth g = c.begun ? c.columns.growth[k] : detail::SphGrowth{};
      growth.insert(growth.end(), {g.density, g.parting});
    }
    const Vec3d at = c.stale ? c.columns.rows[k].position() : c.lists.built(k);
    built.insert(built.end(), {at.x, at.y, at.z, c.stale ? 0 : c.lists.slack(k)});
  }
  std::array<double, 13> numbers{static_cast<double>(c.next_number),
                                 static_cast<double>(c.left),
                                 static_cast<double>(c.displaced),
                                 static_cast<double>(c.steps),
                                 c.time,
                                 c.last_step,
                                 c.most.pair,
                                 c.stale ? 1.0 : 0.0,
                                 c.made ? 1.0 : 0.0,
                                 std::isfinite(c.exchange) ? c.exchange : 0,
                                 c.begun ? 1.0 : 0.0,
                                 c.most.acceleration,
                                 static_cast<double>(c.lists.width)};
  auto [solid, poses] = c.solids.walls.state();
  DynArray<double> small, shares;
  if constexpr (Axes::Grains::averaged) small = c.grains.state();
  for (std::size_t k = 0; k < c.columns.voidage.size(); ++k)
    shares.insert(shares.end(), {c.columns.voidage[k], c.columns.share[k], c.columns.fullness[k]});
  if constexpr (Axes::Grains::averaged) visit("fluid.grains", small), visit("fluid.shares", shares);
  visit("fluid.rows", rows), visit("fluid.labels", labels), visit("fluid.built", built);
  if constexpr (Core::Time::leaps) visit("fluid.growth", growth);
  DynArray<double> openings_of = c.openings.state();
  if (!c.openings.empty()) visit("fluid.openings", openings_of);
  DynArray<double> gap_sums = c.gaps.state(bodies);
  DynArray<double> pushes = c.solids.holding.state();
  visit("fluid.gaps", gap_sums), visit("fluid.pushes", pushes);
  visit("fluid.walls", solid), visit("fluid.poses", poses);
  visit("fluid.bodies", kinds), visit("fluid.points", points),
      visit("fluid.numbers", std::span<double>(numbers));

  DynArray<double> loads;
  for (const detail::LiquidOnWall& l : c.on_walls)
    for (const double x : std::bit_cast<std::array<double, detail::LiquidOnWall::numbers>>(l))
      loads.push_back(x);
  visit("fluid.wall_loads", loads);
  std::array<double, detail::LiquidOnWall::numbers> load;
  require(loads.size() % load.size() == 0, "Sph: a state has ", loads.size(),
          " numbers of loads on walls");
  c.on_walls.resize(loads.size() / load.size());
  for (std::size_t w = 0; w < c.on_walls.size(); ++w) {
    std::copy_n(loads.data() + w * load.size(), load.size(), load.begin());
    c.on_walls[w] = std::bit_cast<detail::LiquidOnWall>(load);
  }
  if constexpr (Axes::ledger) {
    const auto kept = c.book.state();
    DynArray<double> books(kept.begin(), kept.end());
    visit("fluid.ledger", books), c.book.restore(books);
  }

  const std::size_t n = labels.size() / 2;
  require(labels.size() == 2 * n && rows.size() == 2 * row * n && built.size() == 4 * n,
          "Sph: a state of ", n, " particles has ", rows.size(), " numbers of rows and ",
          built.size(), " of places");
  require(!Core::Time::leaps || growth.size() == 2 * n, "Sph: a state of ", n, " particles has ",
          growth.size(), " rates of density");
  require(small.size() % 7 == 0 && (shares.empty() || shares.size() == 3 * n), "Sph: a state of ",
          n, " particles has ", small.size(), " numbers of grains and ", shares.size(),
          " of shares");
  c.columns = {};
  DynArray<Row> then(n);
  DynArray<double> slacks(n);
  for (std::size_t k = 0; k < n; ++k) {
    const auto get = [&](std::size_t of) {
      const double* const r = rows.data() + row * (2 * k + of);
      return Row{r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7]};
    };
    const double label = labels[2 * k], kind = labels[2 * k + 1];
    require(label == std::floor(label) && label >= -1 && label < Core::Lists::none &&
                (kind == 0 || kind == 1 || kind == 2 || kind == 3),
            "Sph: particle ", k, " of a state has number ", label, " and kind ", kind);
    c.columns.add(get(0), static_cast<int>(kind),
                  label < 0 ? Core::Lists::none : static_cast<std::uint32_t>(label));
    c.columns.start.back() = get(1);
    then[k].place({built[4 * k], built[4 * k + 1], built[4 * k + 2]}), slacks[k] = built[4 * k + 3];
  }
  for (std::size_t k = 0; k < shares.size(); k += 3) {
    c.columns.voidage.push_back(shares[k]), c.columns.share.push_back(shares[k + 1]);
    c.columns.fullness.push_back(shares[k + 2]);
  }
  if constexpr (Core::Time::leaps)
    for (std::size_t k = 0; k < growth.size(); k += 2)
      c.columns.growth.push_back({growth[k], growth[k + 1]});
  if constexpr (Axes::Grains::averaged) c.grains.restore(small);
  c.openings.restore(openings_of);
  c.next_number = static_cast<std::uint32_t>(numbers[0]);
  c.left = static_cast<std::size_t>(numbers[1]), c.displaced = static_cast<std::size_t>(numbers[2]);
  c.steps = static_cast<std::int64_t>(numbers[3]), c.time = c.now = numbers[4],
  c.last_step = numbers[5];
  c.begun = numbers[10] != 0, c.most.acceleration = numbers[11];
  c.most.pair = numbers[6], c.stale = numbers[7] != 0, c.made = numbers[8] != 0, c.known = false;
  c.exchange = numbers[9] > 0 ? numbers[9] : INFINITY;  // 0: no free body
  bodies.restore(kinds, points), c.gaps.restore(gap_sums, bodies);
  if (c.made) c.solids.walls.restore(solid, poses);
  c.solids.holding.restore(pushes);
  // Packs of another processor are sorted anew.
  if (numbers[12] != static_cast<double>(c.lists.width)) c.stale = true;
  if (!c.stale) sph_restore_lists(c, then, slacks);
}

}  // namespace silt
