// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include <silt/core/dyn_array.hpp>
#include <silt/engine/contact/shared_contacts.hpp>
#include <silt/engine/contact/wall_loads.hpp>
#include <silt/engine/contact/wall_wear.hpp>
#include <silt/engine/lists/wall_contacts.hpp>
#include <silt/engine/lists/wall_seams.hpp>
#include <silt/engine/spheres/plane_pipeline.hpp>
#include <silt/engine/spheres/wall_kinematics.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Computes the loads of all contacts with walls: the geometry of each candidate in double, then
/// the same law in lanes as for pairs; load rows; the sum on each wall. Spheres that are near
/// planes at rest only are computed by PlanePipeline.
template <class ContactsType, class Arch, class Scalar, class Fluxes = NoFluxes,
          bool Repeats = false>
class WallPipeline {
  using Planes = PlanePipeline<ContactsType, Arch, Scalar, Fluxes, Repeats>;
  using ParticleMotion = MotionRow<ContactsType::rotates>;
  static constexpr std::size_t W = Lanes<Arch, Scalar>::width;
  static constexpr std::size_t block = Planes::Contacts::block;
  static constexpr std::size_t chunks = load_chunks<ContactsType>;
  static constexpr std::size_t row = 4 * chunks;  // scalars
  static constexpr bool rotates = ContactsType::rotates;

 public:
  using Input = typename Planes::Input;
  using Contacts = typename Planes::Contacts;
  using Candidate = typename Contacts::Candidate;

  /// Adds the loads to the sums of the particles; sets force and torque of the walls.
  Tally<ContactsType> run(const Input& in, Contacts& contacts,
                          const CoefficientTable<ContactsType>& table, std::span<Wall> walls,
                          Scalar* sums, const Team& team) {
    const std::size_t blocks = contacts.blocks(), parts = blocks + contacts.plane_pieces();
    loads_.assign(parts * walls.size(), {});
    tallies_.assign(parts, {});
    crowded_.assign(parts, {});
    wear_.start(blocks);
    team.for_parts(parts, [&](std::size_t b) {
      if (b < blocks) return run_block(in, contacts, table, walls, sums, b);
      for (const PlaneRun& run : contacts.runs(b - blocks))
        tallies_[b].add(Planes::run(in, run, walls[run.wall], contacts, table, sums,
                                    loads_[b * walls.size() + run.wall]));
    });
    sum_wall_loads(walls, loads_, parts, in.times.step);
    wear_.finish(walls);
    Tally<ContactsType> all;
    for (const auto& tally : tallies_) all.add(tally);
    return all;
  }

  /// A sphere that touched a wall in more places than its surface has slots for, in the last step.
  std::optional<CrowdedContact> crowded() const {
    for (const auto& c : crowded_)
      if (c) return c;
    return {};
  }

 private:
  /// The contacts of one block, contiguous whatever their slots.
  struct Scratch {
    KinematicsBlock<ContactsType, block, Scalar> kinematics;
    alignas(64) Scalar history[ContactsType::history + 1][block];
    std::uint16_t kind[block];  // index in the coefficient table
    struct Place {
      std::uint32_t slot, particle;
      std::uint16_t wall, surface;
    } place[block];
    Vec3d point[block];  // [m] contact point near the sphere
    // The contact point on the wall, which differs if the sphere touches an image.
    Vec3d on_wall[Repeats ? block : 1];
    WallImage image[Repeats ? block : 1];
    double share[block];                 // [-] overlap over the radius
    Vec3d in_itself[block];              // [m/s] surface velocity of the wall, where it has one
    alignas(64) Scalar of_force[block];  // [-] share of its force (SharedContacts)
    std::size_t count;
    std::optional<CrowdedContact> crowded;
    // Of ended contacts, which are not in this block.
    [[no_unique_address]] NotesOf<ContactsType> ended;
    [[no_unique_address]] EnergyOf<ContactsType, double> last_work =
        start_energy<ContactsType, double>();
    [[no_unique_address]] typename WallWear<Fluxes>::template Rubs<block> rubs;
  };
  using Stage = ContactStage<ContactsType, Arch, Scalar, Fluxes>;
  struct Ends {
    static constexpr bool at_wall = true;
    const Scratch& s;
    std::uint32_t first(std::size_t k) const { return s.place[k].particle; }
    std::size_t wall(std::size_t k) const { return s.place[k].wall; }
    std::uint16_t surface(std::size_t k) const { return s.place[k].surface; }
    WallImage image(std::size_t k) const { return Repeats ? s.image[k] : 0; }
    std::uint32_t order(std::size_t k) const { return s.place[k].slot; }
    void where(std::size_t k, NotedContact& note) const { note.event.point = s.point[k]; }
  };
  void run_block(const Input& in, Contacts& contacts, const CoefficientTable<ContactsType>& table,
                 std::span<const Wall> walls, Scalar* sums, std::size_t b) {
    const auto candidates = contacts.block_candidates(b);
    // Spheres at walls are scattered in memory: prefetch all of them first.
    for (const auto& c : candidates) {
      __builtin_prefetch(in.positions + c.particle);
      __builtin_prefetch(in.motions + c.particle);
      __builtin_prefetch(sums + c.particle * row, 1);
    }
    Scratch s;
    s.count = 0;
    for (std::size_t k = 0, next = 0; k < candidates.size(); k = next) {
      while (next < candidates.size() && candidates[next].particle == candidates[k].particle)
        ++next;
      touch(candidates.subspan(k, next - k), walls, contacts, in, table, s);
    }
    crowded_[b] = s.crowded;
    pad(s);

    alignas(64) Scalar rows[block * row];
    std::array<Scalar*, ContactsType::history + 1> history{};
    for (std::size_t h = 0; h < ContactsType::history; ++h) history[h] = s.history[h];
    const std::size_t padded = pieces(s.count, W) * W;
    RunningTally<ContactsType, typename Lanes<Arch, Scalar>::Real> running;
    const Stage stage{in.times, table, in.fluxes};
    stage.run(s.kinematics, s.count, s.kind, history, Ends{s}, running,
              AtOnePoint<Scalar>{in.sharing != nullptr ? s.of_force : nullptr});
    tallies_[b] = running.end();
    if constexpr (keeps_events<ContactsType>) tallies_[b].notes.add(s.ended);
    tallies_[b].energy.add(s.last_work);
    write_rows<ContactsType, Arch>(s.kinematics, padded, rows);
    for (std::size_t k = 0; k < s.count; ++k) {
      const auto [slot, particle, wall, surface] = s.place[k];
      for (std::size_t h = 0; h < ContactsType::history; ++h)
        contacts.history(h)[slot] = s.history[h][k];
      const Scalar* const r = rows + k * row;
      add_row<Arch, chunks, false>(sums + particle * row, r);
      const Vec3d force{-r[0], -r[1], -r[2]};
      WallLoad& load = loads_[b * walls.size() + wall];
      load.force += force;
      const Vec3d& on_wall = Repeats ? s.on_wall[k] : s.point[k];
      load.torque += cross(on_wall - walls[wall].reference, force);
      if constexpr (ContactsType::has_rolling) load.torque += {-r[8], -r[9], -r[10]};
      if (walls[wall].is_in_itself_moving()) {
        load.power -= dot(force, s.in_itself[k]);
        if constexpr (ContactsType::has_rolling)
          load.power += dot(Vec3d{r[8], r[9], r[10]}, walls[wall].belt.rate);
      }
      tallies_[b].largest = std::max(tallies_[b].largest, s.share[k]);
      if constexpr (Fluxes::wears)
        if (const WallCandidate* const c = s.rubs.of[k])
          wear_.add(
              b, *in.fluxes, *c, walls[wall], contacts.facets(*c),
              {on_wall, normal_of_wear(s.kinematics.template get<Scalar>(k).normal), -force,
               s.rubs.velocity[k], mass_that_wears(in.motions[particle].inv_m, s.kinematics, k),
               in.positions[particle].r, in.times.worked, s.rubs.begins[k]});
    }
  }

  /// Pads the last pack with copies of its first contact, moved out of reach.
  static void pad(Scratch& s) {
    for (std::size_t k = s.count; k % W != 0; ++k) {
      const std::size_t from = s.count / W * W;
      auto kinematics = s.kinematics.template get<Scalar>(from);
      kinematics.overlap = Scalar(-1e30);
      s.kinematics.put(k, kinematics);
      s.kinematics.put(k, s.kinematics.template get_rolling<Scalar>(from));
      s.kinematics.put(k, s.kinematics.template get_radii<Scalar>(from));
      for (auto& h : s.history) h[k] = 0;
      s.kind[k] = s.kind[from];
      s.of_force[k] = 1;
    }
  }

  static constexpr double same_contact = 0.8;  // cosine of the largest rotation in one step

  /// All contacts of one sphere with the surfaces near it. Usually that is one surface with one
  /// contact.
  static void touch(std::span<const Candidate> candidates, std::span<const Wall> walls,
                    Contacts& contacts, const Input& in,
                    const CoefficientTable<ContactsType>& table, Scratch& s) {
    const Candidate& c = candidates[0];
    if (candidates.size() > 1 || Contacts::slots_of(walls[c.wall].surfaces[c.surface]) > 1)
      return touch_several(candidates, walls, contacts, in, table, s);
    const PositionRow& sphere = in.positions[c.particle];
    SurfacePoint point;
    const int count = visit_surface(walls[c.wall].surfaces[c.surface], [&](const auto& surface) {
      if constexpr (std::remove_cvref_t<decltype(surface)>::max_contacts == 1)
        return touching_points(surface, walls[c.wall], c, sphere, contacts, &point);
      else
        return 0;
    });
    auto& slot = contacts.slot(c.slot);
    if (count == 0) return end(contacts, c.slot, {&c, 1}, walls[c.wall], in, s);
    if (slot.touching && dot(slot.normal, point.normal) < same_contact)
      end(contacts, c.slot, {&c, 1}, walls[c.wall], in, s);
    const Vec3d last = slot.touching ? slot.normal : point.normal;
    if constexpr (Fluxes::wears) s.rubs.next_begins = !slot.touching;
    slot = {point.normal, true};
    describe(point, last, sphere, walls[c.wall], c, c.slot, contacts, in, table, s);
  }

  static void touch_several(std::span<const Candidate> candidates, std::span<const Wall> walls,
                            Contacts& contacts, const Input& in,
                            const CoefficientTable<ContactsType>& table, Scratch& s) {
    const PositionRow& sphere = in.positions[candidates[0].particle];
    std::array<Touch, block> found;  // the number of slots of a block
    std::size_t count = 0;
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      const auto& c = candidates[k];
      visit_surface(walls[c.wall].surfaces[c.surface], [&](const auto& surface) {
        using S = std::remove_cvref_t<decltype(surface)>;
        SurfacePoint points[S::max_contacts];
        const int n = touching_points(surface, walls[c.wall], c, sphere, contacts, points);
        if constexpr (S::max_contacts > 1)
          if (n == S::max_contacts &&
              surface.has_more_contacts(in_wall(walls[c.wall], contacts.seen(c, sphere.centre())),
                                        sphere.r, contacts.facets(c)))
            s.crowded = CrowdedContact{c.particle, c.wall};
        for (int p = 0; p < n; ++p) found[count++] = {points[p], k, false};
      });
    }
    if (count > 1 && candidates.size() > 1) {
      const std::span<Touch> all(found.data(), count);
      if constexpr (Repeats) drop_image_seams(all, candidates, walls, 1e-6 * sphere.r);
      drop_seams(all, 1e-6 * sphere.r);
    }
    // Images of a surface share slots.
    for (std::size_t k = 0, end_k = 1, next = 0; k < candidates.size(); k = end_k++) {
      const auto& c = candidates[k];
      const Surface& surface = walls[c.wall].surfaces[c.surface];
      if constexpr (Repeats) end_k = end_of_images(candidates, k);
      const std::span<const Candidate> images = candidates.subspan(k, end_k - k);
      const std::size_t from = next, slots = images.size() * Contacts::slots_of(surface);
      while (next < count && found[next].candidate < end_k) ++next;
      bool taken[Repeats ? block : 8] = {};
      for (const Touch& touch : std::span(found.data() + from, next - from)) {
        if (touch.seam) continue;
        const SurfacePoint& point = touch.point;
        const std::size_t own =
            slot_for(point.normal, images, walls[c.wall], contacts, taken, slots, in, s);
        const Vec3d last = contacts.slot(own).touching ? contacts.slot(own).normal : point.normal;
        if constexpr (Fluxes::wears) s.rubs.next_begins = !contacts.slot(own).touching;
        contacts.slot(own) = {point.normal, true};
        describe(point, last, sphere, walls[c.wall], candidates[touch.candidate], own, contacts, in,
                 table, s);
      }
      for (std::size_t p = 0; p < slots; ++p)
        if (!taken[p]) end(contacts, c.slot + p, images, walls[c.wall], in, s);
    }
  }

  template <class S>
  static int touching_points(const S& surface, const Wall& wall, const Candidate& c,
                             const PositionRow& sphere, const Contacts& contacts,
                             SurfacePoint* points) {
    double within = sphere.r;
    if constexpr (ActsAtDistance<typename ContactsType::Law>) within += contacts.range;
    return detail::touching_points(surface, wall, c, contacts.seen(c, sphere.centre()), within,
                                   contacts, points);
  }

  /// The slot whose contact had nearly this normal a step ago, else a free one: history continues
  /// while a contact moves from facet to edge to facet.
  static std::size_t slot_for(const Vec3d& normal, std::span<const Candidate> images,
                              const Wall& wall, Contacts& contacts, bool* taken, std::size_t slots,
                              const Input& in, Scratch& s) {
    const std::size_t begin = images[0].slot;
    std::size_t best = slots;
    double nearest = same_contact;
    for (std::size_t k = 0; k < slots; ++k) {
      const auto& slot = contacts.slot(begin + k);
      if (taken[k] || !slot.touching) continue;
      if (const double cosine = dot(slot.normal, normal); cosine > nearest)
        nearest = cosine, best = k;
    }
    for (std::size_t k = 0; best == slots && k < slots; ++k)
      if (!taken[k] && !contacts.slot(begin + k).touching) best = k;
    for (std::size_t k = 0; best == slots && k < slots; ++k)
      if (!taken[k]) {
        best = k;  // a contact that ended in this step
        end(contacts, begin + k, images, wall, in, s);
      }
    taken[best] = true;
    return begin + best;
  }

  /// Ends the contact, if any, in a slot of a surface and its images.
  static void end(Contacts& contacts, std::size_t slot,
                  [[maybe_unused]] std::span<const Candidate> images,
                  [[maybe_unused]] const Wall& wall, [[maybe_unused]] const Input& in,
                  [[maybe_unused]] Scratch& s) {
    if constexpr (keeps_impacts<ContactsType>)
      contacts.history(ContactsType::offset_from)[slot] = 0;
    if (!contacts.slot(slot).touching) return;
    contacts.slot(slot).touching = false;
    if constexpr (keeps_events<ContactsType> || keeps_ledger<ContactsType>) {
      const Candidate& c = images[0];
      const Vec3d normal = contacts.slot(slot).normal;
      const PositionRow& p = in.positions[c.particle];
      const Vec3d point = p.centre() - p.r * normal;
      const Vec3d on_wall = contacts.seen(nearest_image(point, images, wall, contacts), point);
      const auto [velocity, turning] =
          relative_to_wall(in.motions[c.particle], wall, on_wall, normal, in.times.step);
      if constexpr (keeps_ledger<ContactsType>)
        add_last_work<ContactsType>(
            [&](std::size_t k) {
              return static_cast<double>(contacts.history(ContactsType::kept_from + k)[slot]);
            },
            normal, velocity, turning, s.last_work);
      if constexpr (keeps_events<ContactsType>) {
        NotedContact note;
        note.first = c.particle, note.event.wall = c.wall;
        note.event.normal = normal, note.event.point = point;
        end_watched<ContactsType>(
            [&](std::size_t k) -> Scalar& {
              return contacts.history(ContactsType::events_from + k)[slot];
            },
            velocity, in.times, note, s.ended);
      }
    }
    for (std::size_t h = 0; h < ContactsType::history; ++h) contacts.history(h)[slot] = 0;
  }

  static void describe(const SurfacePoint& point, const Vec3d& last_normal,
                       const PositionRow& sphere, const Wall& wall, const Candidate& c,
                       std::size_t slot, Contacts& contacts, const Input& in,
                       const CoefficientTable<ContactsType>& table, Scratch& s) {
    const ParticleMotion& motion = in.motions[c.particle];
    const bool fixed = motion.inv_m == 0;
    if (fixed && !wall.is_driven()) return;  // nothing would move by the force
    const std::size_t k = s.count++;
    const Vec3d contact = sphere.centre() - point.distance * point.normal;
    const Vec3d change = point.normal - last_normal;
    const Vec3d on_wall = contacts.seen(c, contact);
    WallVelocity of_wall =
        velocity_of_wall(wall, on_wall, change, motion.velocity(), point.distance, in.times);
    if (wall.is_in_itself_moving()) {
      s.in_itself[k] = velocity_in_itself(wall, c.surface, contacts.facets(c), on_wall,
                                          point.normal, in.times.step);
      of_wall.velocity += s.in_itself[k];
      if (wall.has_belt())
        add_belt(of_wall, wall.belt, on_wall, point, change, motion.velocity(), in.times);
    }
    if constexpr (Fluxes::wears) {
      Vec3d slip = motion.velocity() - of_wall.velocity;
      if constexpr (rotates)
        slip -= (point.distance * motion.inv_r) * cross(motion.spin_velocity(), point.normal);
      s.rubs.put(k, c, wall, slip);
    }
    double inverse_mass = motion.inv_m;  // [1/kg] of sphere plus wall
    if (fixed)
      inverse_mass = inverse_mass_at_fixed(wall.drive, wall.state, on_wall, point.normal, sphere.r);
    else if (wall.is_driven())
      inverse_mass += inverse_mass_of(wall.drive, wall.state, on_wall, point.normal);
    auto kin = kinematics_at_wall<Scalar>(point, change, sphere, motion, of_wall, inverse_mass);
    if constexpr (rotates)
      s.kinematics.put(
          k, rolling_at_wall<Scalar>(sphere, motion, of_wall, InertiaOf<ContactsType>::rolling(),
                                     fixed ? inverse_mass : motion.inv_m));
    s.share[k] = (sphere.r - point.distance) / sphere.r;
    if constexpr (keeps_offset<ContactsType>) {
      Scalar& offset = contacts.history(ContactsType::offset_from)[slot];
      offset = kin.overlap > 0 ? std::min(offset, kin.overlap) : Scalar(0);
      kin.overlap -= std::max(offset, Scalar(0)),
          s.share[k] = static_cast<double>(kin.overlap) / sphere.r;
    }
    s.kinematics.put(k, kin);
    s.kinematics.put(k, Radii<Scalar>{static_cast<Scalar>(sphere.r), Scalar(0)});
    if constexpr (shares_contacts<ContactsType>)
      if (in.sharing != nullptr)
        s.of_force[k] =
            static_cast<Scalar>(in.sharing->of_wall(in.parts[c.particle].body, c, point.normal));
    s.point[k] = contact;
    if constexpr (Repeats) s.on_wall[k] = on_wall, s.image[k] = image_of(c);
    put_contact(wall, c, slot, contacts, in, table, k, s);
  }
  /// Stores identity and history of contact k in the block.
  static void put_contact(const Wall& wall, const Candidate& c, std::size_t slot,
                          Contacts& contacts, const Input& in,
                          const CoefficientTable<ContactsType>& table, std::size_t k, Scratch& s) {
    std::size_t material = 0;
    if constexpr (ContactsType::several_materials) material = in.materials[c.particle];
    s.kind[k] = static_cast<std::uint16_t>(material * table.materials + wall.material);
    s.place[k] = {static_cast<std::uint32_t>(slot), c.particle, c.wall, c.surface};
    for (std::size_t h = 0; h < ContactsType::history; ++h)
      s.history[h][k] = contacts.history(h)[slot];
  }

  [[no_unique_address]] WallWear<Fluxes> wear_;
  DynArray<WallLoad> loads_;                         // per block and wall
  DynArray<Tally<ContactsType>> tallies_;            // per block
  DynArray<std::optional<CrowdedContact>> crowded_;  // per block
};

}  // namespace silt::detail
