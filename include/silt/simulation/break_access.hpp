// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>

#include <silt/breakage/breakage.hpp>
#include <silt/breakage/fragment_sizes.hpp>
#include <silt/breakage/smallest_cell.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/quaternion.hpp>
#include <silt/engine/population/openings.hpp>
#include <silt/engine/stages/break_stage.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Breakage; these are member functions of a Simulation with the policy Breakage.
template <class Sim>
class BreakAccess {
 public:
  /// The policy.
  template <class S = Sim>
  const auto& breakage() const requires(S::has_breakage) {
    return sim().modules_.template get<typename S::Composition::Breaking>();
  }
  /// Mass of the fragments that are too small to be simulated, by size and time of birth.
  template <class S = Sim>
  const SizeTable& dust() const requires(S::has_breakage) {
    return sim().breaks_.dust.all;
  }
  /// The same for particles that left through outlets or were removed.
  template <class S = Sim>
  const SizeTable& left() const requires(S::has_breakage && !S::has_ranks) {
    return sim().breaks_.left.all;
  }
  /// With several ranks, the sum over all (collective).
  template <class S = Sim>
  SizeTable left() const requires(S::has_breakage&& S::has_ranks) {
    return merged_over_ranks(sim(), sim().breaks_.left.all);
  }
  /// The same of one material, by number or name.
  template <class S = Sim>
  SizeTable dust(const WhichMaterial& of) const requires(S::has_breakage) {
    return table_of(sim().breaks_.dust, of);
  }
  template <class S = Sim>
  SizeTable left(const WhichMaterial& of) const requires(S::has_breakage) {
    return merged_over_ranks(sim(), table_of(sim().breaks_.left, of));
  }
  template <class S = Sim>
  MassBalance mass_balance() const requires(S::has_breakage) {
    CompensatedSum present;
    for (std::size_t k = 0; k < sim().rows(); ++k)
      if (sim().is_present(k) && std::isfinite(sim().mass(k))) present.add(sim().mass(k));
    const auto& b = sim().breaks_;
    // Dust is known on all ranks.
    std::array<double, 3> own{b.fed.value(), present.value(), b.left.all.mass()};
    sim().sum_over_ranks(std::span<double>(own));
    return {own[0], own[1], own[2], b.dust.all.mass()};
  }
  /// Number of particles broken since the start [-].
  template <class S = Sim>
  std::uint64_t broken(BreakCause cause) const requires(S::has_breakage) {
    return sim().breaks_.broken[static_cast<std::size_t>(cause)];
  }
  template <class S = Sim>
  std::uint64_t broken() const requires(S::has_breakage) {
    const auto& all = sim().breaks_.broken;
    return all[0] + all[1] + all[2];
  }
  /// The same for one material, by number or name.
  template <class S = Sim>
  std::uint64_t broken(BreakCause cause, const WhichMaterial& of) const requires(S::has_breakage) {
    return broken_of(of)[static_cast<std::size_t>(cause)];
  }
  template <class S = Sim>
  std::uint64_t broken(const WhichMaterial& of) const requires(S::has_breakage) {
    const BreakCounts all = broken_of(of);
    return all[0] + all[1] + all[2];
  }
  /// Number of particles that will break before the next step [-].
  template <class S = Sim>
  std::size_t breaks_due() const requires(S::has_breakage) {
    const std::size_t own = sim().breaks_.due.size();
    if constexpr (S::has_ranks)
      return static_cast<std::size_t>(sim().sum_over_ranks(static_cast<double>(own)));
    return own;
  }
  /// Breaks the particle with this id before the next step, whatever its strength, as if by a load
  /// equal to its strength. InputError: no such particle, or its material does not break.
  template <class S = Sim>
  void break_particle(ParticleId id) requires(S::has_breakage) {
    auto& s = sim();
    const std::size_t k = s.find(id);
    if constexpr (S::has_ranks) {  // its rank reports what is wrong
      const bool is_here = s.rows() > k;
      const bool is_there = s.largest_over_ranks(is_here ? 1 : 0) > 0;
      s.engine_.ranks.together("a particle that is to break", [&] {
        if (is_here || !is_there) break_own(id, k);
      });
      s.breaks_.some_due = true;
    } else {
      break_own(id, k);
    }
  }
  /// Impacts since the start; not recorded for breakage by force. With several ranks, the sum over
  /// all (collective).
  template <class S = Sim>
  ImpactEnergies impact_energies() const requires(S::has_breakage&& S::has_ranks) {
    auto numbers = sim().breaks_.impacts.state();
    sim().sum_over_ranks(std::span<double>(numbers));
    ImpactEnergies all;
    all.restore(numbers);
    return all;
  }
  /// Impacts since the start; not recorded for breakage by force.
  template <class S = Sim>
  const ImpactEnergies& impact_energies() const requires(S::has_breakage && !S::has_ranks) {
    return sim().breaks_.impacts;
  }
  /// The largest load since the program began; not saved in checkpoints. With several ranks, of all
  /// (collective).
  template <class S = Sim>
  LargestLoad largest_load() const requires(S::has_breakage) {
    LargestLoad most = sim().breaks_.largest;
    if constexpr (S::has_ranks) {
      sim().engine_.ranks.meet("the largest load");
      std::uint64_t weighed = 0;
      for (const LargestLoad& one : gather_each(sim().engine_.ranks.comm(), most)) {
        weighed += one.weighed;
        if (one.share > most.share) most = one;
      }
      most.weighed = weighed;
    }
    return most;
  }

  // Without the policy: a message at compile time.
  template <class S = Sim, class... Any>
  void break_particle(const Any&...) requires(!S::has_breakage) {
    needs_policy<S>();
  }
  template <class S = Sim, class... Any>
  std::uint64_t broken(const Any&...) const requires(!S::has_breakage) {
    return needs_policy<S>(), 0;
  }
  template <class S = Sim, class... Any>
  SizeTable dust(const Any&...) const requires(!S::has_breakage) {
    return needs_policy<S>(), SizeTable();
  }
  template <class S = Sim, class... Any>
  SizeTable left(const Any&...) const requires(!S::has_breakage) {
    return needs_policy<S>(), SizeTable();
  }
  template <class S = Sim>
  MassBalance mass_balance() const requires(!S::has_breakage) {
    return needs_policy<S>(), MassBalance();
  }

 protected:
  /// Replaces the particles that are due to break by their fragments, before a step. Returns
  /// whether the time step must be checked in this step.
  bool break_due();
  /// Whether the time step follows the smallest particles present.
  bool follows_sizes() const {
    return sim().breakage().rules.step == BreakStep::SmallestLiving && !sim().time_step;
  }

  void prepare_breakage() {
    auto& s = sim();
    if constexpr (Sim::has_ranks) s.breaks_.some_due = true;
    using Law = typename Sim::ContactsType::Law;
    using Policy = typename Sim::Composition::Breaking;
    // Throws if the load requires a value that the law, or the kind of breakage, does not provide.
    Impact probe{.diameter = 1,
                 .mass = 1,
                 .speed = 1,
                 .m_eff = 1,
                 .R_eff = 1,
                 .elastic_force = Policy::by_force
                                      ? NAN
                                      : elastic_force<Law>(s.engine_.coefficients.law[0], 1, 1, 1),
                 .contact_force = Policy::by_force ? 1 : NAN,
                 .at_wall = false};
    s.breakage().equivalence.load(probe);
    if constexpr (Sim::of_bodies)
      for (std::size_t f = 0; f < s.forms().size(); ++f)
        require(s.forms()[f].shape.radius() == 0, "Breakage: form ", f, " is dilated by ",
                s.forms()[f].shape.radius(),
                " [m], and dilated cells do not fill a polyhedron; give sharp ones, of radius 0");
    s.breaks_.measure(s.engine_);
    if (!follows_sizes()) s.breaks_.sizes.coming_step = 0, s.breaks_.sizes.forget();
  }
  /// Books the mass of the particles from place `from` on, which were added.
  void feed(std::size_t from) {
    auto& s = sim();
    s.breaks_.start(s.engine_, s.breakage(), from, [](ParticleId) { return 0.0; });
    for (std::size_t k = from; k < s.rows(); ++k)
      if (std::isfinite(s.mass(k))) s.breaks_.fed.add(s.mass(k));
  }
  /// Adds the smallest possible fragments to the spheres that may meet, unless the time step
  /// follows the particles present.
  template <class Meetings>
  void include_fragments(Meetings& all) const {
    if (follows_sizes()) return;
    const auto& s = sim();
    const auto& rules = s.breakage().rules;
    const double volume = sphere_volume(0.5 * rules.dust_below);
    const auto include = [&](std::size_t material, double density) {
      if (rules.breaks(material))
        all.spheres[material].include(
            {0.5 * rules.dust_below, density * volume / SmallestCell::lightness_of<Sim>()});
    };
    for (std::size_t k = 0; k < s.rows(); ++k)
      if (s.is_present(k) && std::isfinite(s.mass(k)))
        include(s.material(k), s.mass(k) / s.engine_.volume_of(k));
    for (const Inlet& inlet : s.openings_.inlets())
      for (std::size_t k = 0; k < inlet.flow.kinds(); ++k)
        include(inlet.flow.kind(k).material, inlet.flow.kind(k).density);
  }
  void note_leaving(std::size_t k) {
    auto& s = sim();
    if (!std::isfinite(s.mass(k))) return;
    const double d = equal_volume_diameter(s.engine_.volume_of(k));
    s.breaks_.left.template add<Sim::ContactsType::several_materials>(
        s.material(k), [&](SizeTable& table) { table.add(d, s.mass(k), 1, s.time_); });
  }

 private:
  void break_own(ParticleId id, std::size_t k) {
    auto& s = sim();
    require(k < s.rows(), "Simulation::break_particle: there is no particle ", id,
            id < s.next_.particle ? " any more: it has broken, has left or was removed"
                                  : "; none has had this id so far");
    const double strength =
        s.engine_.modules().template of<typename Sim::Composition::Breaking>()[k].strength;
    require(strength > 0, "Simulation::break_particle: particle ", id,
            " cannot break: it is fixed, or BreakageRules.materials leaves its material out");
    s.breaks_.add_due({id, strength, 0, BreakCause::Asked});
  }
  template <class Tables>
  SizeTable table_of(const Tables& tables, const WhichMaterial& of) const {
    const std::size_t material = sim().contacts().material_number(of);
    if constexpr (Sim::ContactsType::several_materials) return tables.of_material(material);
    return material == 0 ? tables.all : SizeTable();  // others belong to walls
  }
  BreakCounts broken_of(const WhichMaterial& of) const {
    const std::size_t material = sim().contacts().material_number(of);
    const auto& stage = sim().breaks_;
    if constexpr (Sim::ContactsType::several_materials)
      return material < stage.broken_of.size() ? stage.broken_of[material] : BreakCounts{};
    return material == 0 ? stage.broken : BreakCounts{};  // others belong to walls
  }
  template <class S>
  static void needs_policy() {
    static_assert(S::has_breakage,
                  "particles of this simulation do not break: give it the policy "
                  "silt::Breakage{strength, equivalence, sizes, fatigue, rules} beside particles "
                  "and contacts");
  }
  static constexpr std::size_t nowhere = static_cast<std::size_t>(-1);
  struct Parent {
    std::size_t place, fragments;  // place: nowhere, if on another rank
    double rests_until;
  };
  const auto& own_fields(std::size_t k) const {
    return sim().engine_.modules().template of<typename Sim::Composition::Breaking>()[k];
  }

  /// A breaking particle of any rank; all ranks have the same list of them, to the bit.
  struct BreakingParticle {
    DueBreak due;
    Vec3d centre_, velocity_, angular_velocity_;
    Quaternion principal_axes_;
    double radius_, scale_, mass_, volume, strength, generation;
    std::uint64_t material_, form_;
    Vec3d centre() const { return centre_; }
    Vec3d velocity() const { return velocity_; }
    Vec3d angular_velocity() const { return angular_velocity_; }
    Quaternion principal_axes() const { return principal_axes_; }
    double radius() const { return radius_; }
    double scale() const { return scale_; }
    double mass() const { return mass_; }
    std::size_t material() const { return material_; }
    std::size_t form() const { return form_; }
  };
  /// What all ranks know as particles break: their ids, sorted, and the forms in use.
  struct OfRanks {
    DynArray<ParticleId> gone;
    DynArray<bool> forms;
  };
  BreakingParticle breaking_at(const DueBreak& due, std::size_t k) const {
    const auto& e = sim().engine_;
    const auto p = e.owner(k);
    const auto& f = own_fields(k);
    return {due,          p.centre(),   p.velocity(), p.angular_velocity(), p.principal_axes(),
            p.radius(),   p.scale(),    p.mass(),     e.volume_of(k),       f.strength,
            f.generation, p.material(), p.form()};
  }
  /// The same with several ranks: every rank breaks the particles of all ranks, in the order of
  /// ids, and keeps its own fragments. Ids, random numbers and dust are thus those of one process.
  /// Returns whether the time step must be checked because of them (collective).
  bool break_due_of_ranks();
  /// Whether some of these fragments are smaller than the smallest living particles.
  template <class Particles>
  bool any_less(const Particles& fragments) const;

  /// Adds the fragments of the particle at place k, with their velocities, to `all`, and books dust
  /// and energy. `own`: the policy's fields of the particle.
  template <class Owner, class Fields, class Particles>
  void break_one(const DueBreak& due, const Owner& p, double volume, const Fields& own,
                 std::size_t k, DynArray<Parent>& parents, Particles& all);
  template <class Owner, class Particles>
  void add_spheres(const Owner& p, const FragmentSizes& sizes, double density, Random& random,
                   Particles& all) const;
  template <class Owner, class Particles>
  void add_cells(const Owner& p, FragmentSizes& sizes, double density, Random& random,
                 Particles& all) const;
  template <class Owner>
  static Vec3d shared_rotation(const Owner& p, std::span<const Vec3d> places,
                               std::span<const double> radii, std::span<const double> masses,
                               double share);

  /// Books the energy of the breaking particle at place k as lost. Dust takes its share of the
  /// energy, and its `potential` [J], out of the simulation.
  void book(std::size_t k, double of_dust, double potential);
  /// [J] of all own particles now: kinetic energy, potential energy in gravity and energy in bonds.
  double energy_of_all() const;
  /// The rows of the particles at these places, sorted.
  DynArray<std::uint32_t> rows_of(const DynArray<std::size_t>& places) const;
  /// The rows of these particles on this rank, ghosts included, sorted.
  DynArray<std::uint32_t> rows_of_ranks(std::span<const ParticleId> ids) const;
  /// Books the energy of the contacts of these rows, which end without a step of the ledger.
  void book_contacts(const DynArray<std::uint32_t>& rows, std::span<const ParticleId> gone);
  /// The same for contacts with particles of other ranks. If both break, the rank with the lower id
  /// books it.
  template <class Book>
  void book_contacts_with_ghosts(std::span<const ParticleId> gone, const Book& book);
  /// Removes the parents and adds their fragments. `all`: with several ranks.
  template <class Particles>
  void take_place(const DynArray<Parent>& parents, const Particles& fragments,
                  const OfRanks& all = {});

  Sim& sim() { return static_cast<Sim&>(*this); }
  const Sim& sim() const { return static_cast<const Sim&>(*this); }
};

}  // namespace silt::detail

#include <silt/simulation/break_books.hpp>
#include <silt/simulation/break_due.hpp>
#include <silt/simulation/break_up.hpp>
