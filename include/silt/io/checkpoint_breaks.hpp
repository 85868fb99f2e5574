// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include <silt/breakage/impact_energies.hpp>
#include <silt/breakage/size_table.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/io/checkpoint_checks.hpp>
#include <silt/io/describe_scene.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Breakage in checkpoints: particles due to break, and the tables of mass and impacts. Strengths
/// are stored as fields of a module.
/// Tests: tests/breakage/runs.cpp, step_runs.cpp, compositions.cpp.
template <class Stage>
struct BreaksState {
  DynArray<std::uint64_t> due_ids, due_cause, broken;
  DynArray<double> due, fed, dust, left, impacts;  // due: load and speed of each
  DynArray<double> sizes;                          // if the time step follows them
  DynArray<double> dust_of, left_of;               // if there are several materials
  DynArray<std::uint64_t> broken_of;               // likewise, three of each

  static BreaksState of(const Stage& stage) {
    BreaksState s;
    for (const DueBreak& one : stage.due) {
      s.due_ids.push_back(one.id), s.due_cause.push_back(static_cast<std::uint64_t>(one.cause));
      s.due.insert(s.due.end(), {one.load, one.speed});
    }
    s.broken.assign(stage.broken.begin(), stage.broken.end());
    s.fed = {stage.fed.sum(), stage.fed.rest(), stage.parted};
    s.dust = stage.dust.all.state(), s.left = stage.left.all.state();
    s.dust_of = stage.dust.state_of_materials(), s.left_of = stage.left.state_of_materials();
    s.impacts = stage.impacts.state();
    s.sizes = stage.sizes.state();
    for (const BreakCounts& of : stage.broken_of)
      s.broken_of.insert(s.broken_of.end(), of.begin(), of.end());
    return s;
  }
  template <class Archive>
  void visit(Archive& a) {
    const auto count = [](const auto& column) {
      return Archive::loads ? CheckpointLoader::any_count : column.size();
    };
    a.column("breakage.due", due_ids, count(due_ids));
    a.column("breakage.due_cause", due_cause, due_ids.size());
    a.column("breakage.due_loads", due, 2 * due_ids.size());
    a.column("breakage.broken", broken, 3);
    a.column("breakage.fed", fed, 3);
    a.column("breakage.dust", dust, count(dust)), a.column("breakage.left", left, count(left));
    a.column("breakage.impacts", impacts, ImpactEnergies::numbers);
    const auto if_any = [&](const char* name, auto& column, const NumberRule& rule) {
      bool any = !column.empty();
      if constexpr (Archive::loads) any = a.has(name);
      if (any) a.column(name, column, count(column), rule);
    };
    if_any("breakage.sizes", sizes, known_number);
    if_any("breakage.dust_of", dust_of, finite_number);
    if_any("breakage.left_of", left_of, finite_number);
    bool counts = !broken_of.empty();
    if constexpr (Archive::loads) counts = a.has("breakage.broken_of");
    if (counts) a.column("breakage.broken_of", broken_of, count(broken_of));
  }
  /// Refuses impossible values.
  void check(const CheckpointLoader& a) const {
    const auto all_of_mass = [](const DynArray<double>& numbers) {
      return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
    };
    for (std::size_t k = 0; k < due_ids.size(); ++k) {
      a.need(k == 0 || due_ids[k - 1] < due_ids[k], "breakage.due is not in the order of ids");
      a.need(due_cause[k] <= 2 && due[2 * k] > 0 && due[2 * k + 1] >= 0 &&
                 std::isfinite(due[2 * k]) && std::isfinite(due[2 * k + 1]),
             "breakage.due_loads of particle ", due_ids[k], " cannot be");
    }
    a.need(all_of_mass(fed) && fed[0] >= 0, "breakage.fed is impossible");
    const auto is_table = [](const DynArray<double>& numbers) {
      try {
        SizeTable().restore(numbers);
        return true;
      } catch (const InputError&) {
        return false;
      }
    };
    a.need(is_table(dust), "breakage.dust is not a size table");
    a.need(is_table(left), "breakage.left is not a size table");
    for (const auto* of : {&dust_of, &left_of}) try {
        SizeTables().restore_of_materials(*of);
      } catch (const InputError&) {
        a.refuse("breakage.dust_of or left_of is not a size table");
      }
    a.need(all_of_mass(impacts) && std::all_of(impacts.begin(), impacts.end(),
                                               [](double x) { return x >= 0 && x < 0x1p63; }),
           "breakage.impacts are impossible");
    a.need(LivingSizes::can_be(sizes), "breakage.sizes are impossible");
    for (std::size_t cause = 0; cause < 3 && !broken_of.empty(); ++cause) {
      std::uint64_t sum = 0;
      for (std::size_t k = cause; k < broken_of.size(); k += 3) sum += broken_of[k];
      a.need(broken_of.size() % 3 == 0 && sum == broken[cause],
             "breakage.broken_of does not sum to breakage.broken");
    }
  }
  void put(Stage& stage) const {
    stage.due.clear(), stage.events.clear();
    for (std::size_t k = 0; k < due_ids.size(); ++k)
      stage.due.push_back(
          {due_ids[k], due[2 * k], due[2 * k + 1], static_cast<BreakCause>(due_cause[k])});
    std::copy(broken.begin(), broken.end(), stage.broken.begin());
    stage.fed = {fed[0], fed[1]}, stage.parted = fed[2];
    stage.dust.all.restore(dust), stage.left.all.restore(left), stage.impacts.restore(impacts);
    stage.dust.restore_of_materials(dust_of), stage.left.restore_of_materials(left_of);
    stage.sizes.restore(sizes);
    stage.broken_of.assign(broken_of.size() / 3, {});
    for (std::size_t k = 0; k < broken_of.size(); ++k) stage.broken_of[k / 3][k % 3] = broken_of[k];
  }
};
/// Functions and rules with which a run continues.
template <class Policy>
void describe_breakage(const Describer& is, const Policy& policy) {
  is("breakage: seed", text(policy.rules.seed));
  is("breakage: dust_below", text(policy.rules.dust_below, " m"));
  is("breakage: most_fragments", text(policy.rules.most_fragments));
  is("breakage: separation_speed", text(policy.rules.separation_speed, " m/s"));
  if (policy.rules.step == BreakStep::SmallestLiving)
    is("breakage: step", "of the smallest living");
  const auto numbers = [&](const char* of, const auto& function) {
    using F = std::remove_cvref_t<decltype(function)>;
    if constexpr (requires { F::names.size(); }) describe_numbers(is, of, function);
  };
  numbers("the strength's", policy.strength), numbers("the equivalence's", policy.equivalence);
  numbers("the breakage function's", policy.sizes), numbers("the fatigue's", policy.fatigue);
}

}  // namespace silt::detail
