// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>

#include <silt/bond/concept.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/io/checkpoint_checks.hpp>
#include <silt/io/describe_scene.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Bonds in checkpoints: both ends of each, its reference state, and the numbers of its model.
/// Tests: tests/bond/checkpoint.cpp.
template <class Stage>
struct BondsState {};
template <class Stage>
requires requires { typename Stage::Bond; }
struct BondsState<Stage> {
  using Bond = typename Stage::Bond;
  using AtWall = typename Stage::AtWalls::Bond;
  using Numbers = decltype(Bond::numbers);
  DynArray<std::uint64_t> ids, number;  // two per bond; one per bond
  DynArray<BondRest<double>> rest;
  DynArray<Numbers> numbers;
  DynArray<std::uint64_t> wall_ids, wall_number;  // particle and wall; one per bond
  DynArray<std::uint64_t> wall_excludes, freed;   // 0 or 1 per bond; particle and wall
  DynArray<std::uint64_t> asked;                  // two per bond that is to break (unbond)
  DynArray<Vec3d> wall_place;
  DynArray<BondRest<double>> wall_rest;
  DynArray<Numbers> wall_numbers;
  std::uint64_t made = 0, broken = 0;

  static BondsState of(const Stage& stage, const BondedPairs& held) {
    BondsState s;
    s.made = stage.made, s.broken = stage.broken;
    stage.list.for_each_in_order([&](const Bond& b) {
      s.ids.insert(s.ids.end(), {b.i, b.j}), s.number.push_back(b.number);
      s.rest.push_back(b.rest), s.numbers.push_back(b.numbers);
    });
    for (const AtWall& b : stage.at_walls.all) {
      s.wall_ids.insert(s.wall_ids.end(), {b.i, b.wall}), s.wall_number.push_back(b.number);
      s.wall_place.push_back(b.place), s.wall_rest.push_back(b.rest);
      s.wall_numbers.push_back(b.numbers), s.wall_excludes.push_back(b.excludes);
    }
    for (const auto& [a, b] : stage.asked) s.asked.insert(s.asked.end(), {a, b});
    for (const auto& [id, wall] : held.freed_at_walls) s.freed.insert(s.freed.end(), {id, wall});
    return s;
  }
  template <class Archive>
  void visit(Archive& a) {
    a.number("bonds.made", made, count_number), a.number("bonds.broken", broken, count_number);
    const auto count = [](const auto& column) {
      return Archive::loads ? CheckpointLoader::any_count : column.size();
    };
    a.column("bonds.number", number, count(number));
    a.column("bonds.ids", ids, 2 * number.size());
    a.rows("bonds.rest", rest, number.size()), a.rows("bonds.numbers", numbers, number.size());
    a.column("bonds.wall_number", wall_number, count(wall_number));
    const std::size_t at_walls = wall_number.size();
    a.column("bonds.wall_ids", wall_ids, 2 * at_walls);
    a.rows("bonds.wall_place", wall_place, at_walls);
    a.rows("bonds.wall_rest", wall_rest, at_walls);
    a.rows("bonds.wall_numbers", wall_numbers, at_walls);
    a.column("bonds.wall_excludes", wall_excludes, at_walls);
    a.column("bonds.freed_at_walls", freed, count(freed));
    bool any_asked = !asked.empty();
    if constexpr (Archive::loads) any_asked = a.has("bonds.asked");
    if (any_asked) a.column("bonds.asked", asked, count(asked));
  }
  /// Refuses impossible values; `p`: particles of the file, `surfaces`: number for each wall.
  template <class State>
  void check(const CheckpointLoader& a, const State& p,
             const DynArray<std::uint64_t>& surfaces) const {
    DynArray<ParticleId> present;
    for (std::size_t k = 0; k < p.size(); ++k) {
      if (p.is_parked(k)) continue;
      present.push_back(p.id[k]);
      a.need(is_unit(p.orientation[k]), "orientation of row ", k, " is not a unit quaternion");
    }
    std::sort(present.begin(), present.end());
    const auto is_there = [&](ParticleId id) {
      return std::binary_search(present.begin(), present.end(), id);
    };
    DynArray<std::pair<std::uint64_t, std::uint64_t>> pairs;
    for (std::size_t k = 0; k < number.size(); ++k) {
      const std::uint64_t i = ids[2 * k], j = ids[2 * k + 1];
      a.need(i < j && is_there(i) && is_there(j), "bonds.ids[", k, "] = ", i, " and ", j,
             " are not two particles");
      pairs.push_back({i, j});
      check_one(a, "bonds", k, rest[k], number[k]);
    }
    std::sort(pairs.begin(), pairs.end());
    const auto twice = std::adjacent_find(pairs.begin(), pairs.end());
    a.need(twice == pairs.end(), "two bonds are between the same particles");
    check_finite_rows(a, "bonds.numbers", numbers);
    for (std::size_t k = 0; k < wall_number.size(); ++k) {
      a.need(is_there(wall_ids[2 * k]), "bonds.wall_ids: there is no particle ", wall_ids[2 * k]);
      const std::uint64_t wall = wall_ids[2 * k + 1];
      a.need(wall < surfaces.size() && surfaces[wall] > 0, "bonds.wall_ids: there is no wall ",
             wall);
      a.need(wall_excludes[k] <= 1, "bonds.wall_excludes[", k, "] must be 0 or 1");
      a.need(silt::is_finite(wall_place[k]), "bonds.wall_place[", k, "] must be finite");
      check_one(a, "bonds.wall", k, wall_rest[k], wall_number[k]);
    }
    check_finite_rows(a, "bonds.wall_numbers", wall_numbers);
    a.need(asked.size() % 2 == 0, "bonds.asked are not pairs");
    a.need(freed.size() % 2 == 0, "bonds.freed_at_walls are not pairs");
    for (std::size_t k = 0; k + 1 < freed.size(); k += 2)
      a.need(is_there(freed[k]) && freed[k + 1] < surfaces.size(), "bonds.freed_at_walls[", k,
             "]: particle ", freed[k], " and wall ", freed[k + 1], " are not there");
  }
  /// Puts the bonds into a stage without bonds, and into the particles' table of pairs.
  template <class State>
  void put(Stage& stage, const State& p) const {
    for (std::size_t k = 0; k < number.size(); ++k) {
      stage.list.add({ids[2 * k], ids[2 * k + 1], rest[k], numbers[k], number[k]});
      p.bonds.add(ids[2 * k], ids[2 * k + 1]);
    }
    for (std::size_t k = 0; k < wall_number.size(); ++k) {
      stage.at_walls.all.push_back({wall_ids[2 * k], wall_ids[2 * k + 1], wall_place[k],
                                    wall_rest[k], wall_numbers[k], wall_number[k],
                                    wall_excludes[k] == 1});
      if (wall_excludes[k] == 1)
        p.bonds.add(wall_ids[2 * k], p.bonds.id_of_wall(wall_ids[2 * k + 1]));
    }
    for (std::size_t k = 0; k < freed.size(); k += 2)
      p.bonds.freed_at_walls.push_back({freed[k], freed[k + 1]});
    for (std::size_t k = 0; k < asked.size(); k += 2)
      stage.asked.push_back({asked[k], asked[k + 1]});
    stage.made = made, stage.broken = broken;
  }

 private:
  void check_one(const CheckpointLoader& a, const char* of, std::size_t k,
                 const BondRest<double>& r, std::uint64_t count) const {
    a.need(silt::is_finite(r.apart) && norm(r.apart) > 0 && r.share >= 0 && r.share <= 1 &&
               is_unit(r.turn),
           of, ".rest[", k, "]: from ", r.apart, " m, share ", r.share, " [-], cannot be");
    a.need(count < made, of, ".number[", k, "] = ", count, ", but ", made, " have been made");
  }
};

/// The model's own coefficients, if it names them. They apply to all bonds, old and new.
template <class Stage>
void describe_bonds(const Describer& is, const Stage& stage) {
  using Model = std::remove_cvref_t<decltype(stage.model)>;
  is("seed of bonds", text(stage.seed));
  if constexpr (requires { Model::names.size(); }) describe_numbers(is, "the bonds'", stage.model);
}

}  // namespace silt::detail
