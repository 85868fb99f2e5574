// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include <silt/core/dyn_array.hpp>
#include <silt/engine/contact/contact_fluxes.hpp>
#include <silt/engine/contact/contact_stage.hpp>
#include <silt/engine/contact/load_rows.hpp>
#include <silt/engine/contact/offset.hpp>
#include <silt/engine/contact/wall_loads.hpp>
#include <silt/engine/contact/wall_wear.hpp>
#include <silt/engine/convex/contacts_with_wall.hpp>
#include <silt/engine/convex/convex_planes.hpp>
#include <silt/engine/convex/joined_contacts.hpp>
#include <silt/engine/lists/wall_contacts.hpp>
#include <silt/engine/lists/wall_seams.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Computes the loads of all contacts of convex parts with walls, fixed or moving: exact contacts
/// of each candidate (ConvexPlanes: in lanes), then the same law in lanes as for pairs; the sum on
/// each wall.
template <class Rows, class ContactsType, class Arch, class Fluxes = NoFluxes, bool Repeats = false>
class ConvexWalls {
  using Real = typename Lanes<Arch>::Real;
  static constexpr std::size_t W = Lanes<Arch>::width;
  static constexpr std::size_t H = ContactsType::history, radius = ContactsType::memory_radius,
                               events = numbers_before_events<ContactsType>,
                               more = radius + 1;  // further history values
  static constexpr std::size_t chunks = load_chunks<ContactsType>, row = 4 * chunks;

 public:
  using Contacts = WallContacts<H, double, most_plane_contacts<typename Rows::Kinds>,
                                most_wall_contacts, Repeats>;
  using Candidate = typename Contacts::Candidate;
  static constexpr std::size_t block = Contacts::block;
  using Input = ConvexInput<Rows>;
  Fluxes* fluxes = nullptr;  // of modules, if there are any

  /// Adds the loads to the sums of the bodies; sets force and torque of the walls.
  Tally<ContactsType> run(const Input& in, Contacts& contacts,
                          const CoefficientTable<ContactsType>& table, std::span<Wall> walls,
                          double* sums, const Team& team) {
    const std::size_t blocks = contacts.blocks();
    loads_.assign(blocks * walls.size(), {});
    tallies_.assign(blocks, {});
    wear_.start(blocks);
    team.for_parts(blocks, [&](std::size_t b) { run_block(in, contacts, table, walls, sums, b); });
    sum_wall_loads(walls, loads_, blocks, in.times.step);
    wear_.finish(walls);
    Tally<ContactsType> all;
    for (const auto& tally : tallies_) all.add(tally);
    return all;
  }
  /// None: each candidate has slots for all contacts that it can have.
  std::optional<CrowdedContact> crowded() const { return {}; }

 private:
  using Planes = ConvexPlanes<Rows, ContactsType, Contacts, Arch>;
  struct Scratch : Planes::Block {
    [[no_unique_address]] typename WallWear<Fluxes>::template Rubs<block> rubs;
  };

  using Stage = ContactStage<ContactsType, Arch, double, Fluxes>;
  struct Ends {
    static constexpr bool at_wall = true;
    const Scratch& s;
    bool area;  // these contacts have one
    std::uint32_t first(std::size_t k) const { return s.of[k]->particle; }
    std::size_t wall(std::size_t k) const { return s.of[k]->wall; }
    std::uint16_t surface(std::size_t k) const { return s.of[k]->surface; }
    WallImage image(std::size_t k) const { return image_of(*s.of[k]); }
    std::uint32_t order(std::size_t k) const { return s.slot[k]; }
    void finish(std::size_t k, RecordedContact& one, RecordedTurn& turn) const {
      const auto at = [k](const auto& columns) {
        return Vec3d{columns[0][k], columns[1][k], columns[2][k]};
      };
      const double g = s.gradient[k];
      one.force *= g, one.spring *= g, one.cohesion *= g;
      turn.arm = at(s.arm);
      turn.couple_i = (s.couple[k] * dot(one.force, one.normal)) * one.normal;
      if (area) turn.couple_i += g * at(s.area.moment);
      turn.couple_j = -turn.couple_i;
    }
    void where(std::size_t k, NotedContact& note) const {
      note.event.point = {s.place[0][k], s.place[1][k], s.place[2][k]};
    }
  };
  void run_block(const Input& in, Contacts& contacts, const CoefficientTable<ContactsType>& table,
                 std::span<const Wall> walls, double* sums, std::size_t b) {
    Scratch s;
    find_contacts(in, contacts, table, walls, contacts.block_candidates(b), s);
    pad(s);
    std::array<double*, H + 1> history{};
    for (std::size_t h = 0; h < H; ++h) history[h] = s.history[h];
    RunningTally<ContactsType, Real> running;
    const bool has_area = Scratch::has_area && in.rows->has_area();
    const Stage stage{in.times, table, fluxes};
    if (has_area)
      stage.run(s.kinematics, s.count, s.kind, history, Ends{s, has_area}, running,
                AtAreaPoints{s.area,
                             !Planes::in_lanes || in.times.renew_areas,
                             {s.arm[0], s.arm[1], s.arm[2]},
                             s.gradient});
    else
      stage.run(s.kinematics, s.count, s.kind, history, Ends{s, has_area}, running,
                AtOnePoint<double>{});
    tallies_[b] = running.end();
    if constexpr (keeps_events<ContactsType>) tallies_[b].notes.add(s.ended);
    tallies_[b].energy.add(s.last_work);
    tallies_[b].largest = s.largest;
    for (std::size_t k = 0; k < s.count; ++k) {
      if (s.slot[k] == Scratch::no_slot) continue;
      keep_history(contacts, s, k, has_area);
      add_load(in, contacts, walls, sums, b, s, k, has_area);
    }
  }
  /// Fills the block with the contacts of these candidates.
  static void find_contacts(const Input& in, Contacts& contacts,
                            const CoefficientTable<ContactsType>& table,
                            std::span<const Wall> walls, std::span<const Candidate> candidates,
                            Scratch& s) {
    if constexpr (Planes::in_lanes) {
      typename Planes::Near near;
      for (const Candidate& c : candidates)
        if (in.motions[c.particle].inv_m != 0 && Planes::takes(walls[c.wall], c) &&
            !near.take(in, walls[c.wall], c))
          end(contacts, c.slot, {&c, 1}, walls[c.wall], in, s);
      Planes::touch(in, near, contacts, table, walls, s);
    }
    for (std::size_t k = 0, next = 1; k < candidates.size(); k = next++) {
      const Candidate& c = candidates[k];
      if constexpr (Repeats) next = end_of_images(candidates, k);
      // Fixed bodies touch only walls that their loads move.
      const bool acts = in.motions[c.particle].inv_m != 0 || walls[c.wall].is_driven();
      if (acts && !Planes::takes(walls[c.wall], c))
        touch(in, contacts, table, walls, candidates, candidates.subspan(k, next - k), s);
    }
  }
  static void keep_history(Contacts& contacts, const Scratch& s, std::size_t k, bool has_area) {
    const std::size_t kept = ContactsType::history_kept(has_area);
    for (std::size_t h = 0; h < kept; ++h)  // R_eff is already stored
      contacts.history(h)[s.slot[k]] = s.history[h][k];
    for (std::size_t h = more; h < H; ++h) contacts.history(h)[s.slot[k]] = s.history[h][k];
  }
  /// Adds the load of contact k to the sums of its body and of the wall.
  void add_load(const Input& in, const Contacts& contacts, std::span<const Wall> walls,
                double* sums, std::size_t b, const Scratch& s, std::size_t k, bool has_area) {
    const Candidate& c = *s.of[k];
    const auto at = [&](const auto& columns) {
      return Vec3d{columns[0][k], columns[1][k], columns[2][k]};
    };
    const Vec3d n = at(s.kinematics.normal);
    const Vec3d force = s.gradient[k] * s.kinematics.template get_load<double>(k).force;
    Vec3d couple = (s.couple[k] * dot(force, n)) * n;
    if (has_area) couple += s.gradient[k] * at(s.area.moment);
    const Vec3d torque = cross(at(s.arm), force) + couple;
    double* const sum = sums + c.particle * row;
    sum[0] += force.x, sum[1] += force.y, sum[2] += force.z;
    sum[4] += torque.x, sum[5] += torque.y, sum[6] += torque.z;
    WallLoad& load = loads_[b * walls.size() + c.wall];
    load.force -= force;
    const Vec3d place = contacts.seen(c, at(s.place));
    load.torque -= cross(place - walls[c.wall].reference, force) + couple;
    if constexpr (Fluxes::wears)
      if (is_mesh(walls[c.wall].surfaces[c.surface]))
        wear_.add(b, *fluxes, c, walls[c.wall], contacts.facets(c),
                  {place, n, force, s.rubs.velocity[k],
                   mass_that_wears(in.motions[c.particle].inv_m, s.kinematics, k),
                   in.rows->pose[c.particle].least_radius, in.times.worked, s.rubs.begins[k]});
    if (walls[c.wall].is_in_itself_moving()) {
      load.power += dot(force, velocity_in_itself(walls[c.wall], c.surface, contacts.facets(c),
                                                  place, n, in.times.step));
      if (has_area) load.power += s.gradient[k] * dot(at(s.area.moment), walls[c.wall].belt.rate);
    }
  }

  static constexpr double same_contact = 0.8;  // cosine of the largest rotation in one step

  /// The contacts of a candidate with its wall or image of the wall.
  static int contacts_of(const Input& in, const Contacts& contacts, std::span<const Wall> walls,
                         const Candidate& c, SolidContact (&found)[most_wall_contacts]) {
    return contacts_with_image(*in.rows, in.positions[c.particle].centre(), walls[c.wall], contacts,
                               c, found);
  }
  /// The same without rims that are seams of other surfaces.
  static int contacts_apart(const Input& in, const Contacts& contacts, std::span<const Wall> walls,
                            std::span<const Candidate> candidates, const Candidate& c,
                            SolidContact (&found)[most_wall_contacts]) {
    int count = contacts_of(in, contacts, walls, c, found);
    if (is_round(walls[c.wall].surfaces[c.surface]) && std::any_of(found, found + count, is_rim))
      for (const Candidate& other : candidates)
        if (other.particle == c.particle && &other != &c) {
          SolidContact beside[most_wall_contacts];
          const int n = contacts_of(in, contacts, walls, other, beside);
          const double tolerance = 1e-6 * in.rows->pose[c.particle].least_radius;
          count = without_seams(found, count, {beside, static_cast<std::size_t>(n)}, &other < &c,
                                tolerance);
        }
    return count;
  }

  /// Adds the contacts with a surface and its images.
  static void touch(const Input& in, Contacts& contacts,
                    const CoefficientTable<ContactsType>& table, std::span<const Wall> walls,
                    std::span<const Candidate> candidates, std::span<const Candidate> images,
                    Scratch& s) {
    const Candidate& c = images[0];
    if (Repeats && images.size() > 1) {
      JoinedContacts<Candidate> all;
      all.join(*in.rows, in.positions[c.particle].centre(), walls[c.wall], contacts, images,
               [&](const Candidate& image, auto& found) {
                 return contacts_apart(in, contacts, walls, candidates, image, found);
               });
      return take<JoinedContacts<Candidate>::most>(
          in, contacts, table, walls[c.wall], images,
          {all.contact, all.count}, [&](int k) -> auto& { return *all.of[k]; }, s);
    }
    SolidContact found[most_wall_contacts];
    const int count = contacts_apart(in, contacts, walls, candidates, c, found);
    take<most_wall_contacts>(
        in, contacts, table, walls[c.wall], images,
        {found, static_cast<std::size_t>(count)}, [&](int) -> auto& { return c; }, s);
  }
  /// Finds the slots of contacts among those shared by the images of a surface; `of(k)`: the
  /// candidate of contact k.
  template <std::size_t Most, class Of>
  static void take(const Input& in, Contacts& contacts, const CoefficientTable<ContactsType>& table,
                   const Wall& wall, std::span<const Candidate> images,
                   std::span<const SolidContact> found, const Of& of, Scratch& s) {
    const Candidate& c = images[0];
    const int count = static_cast<int>(found.size());
    const Vec3d centre = in.positions[c.particle].centre();
    const std::size_t slots = images.size() * Contacts::slots_of(wall.surfaces[c.surface]);
    bool taken[Most == most_wall_contacts ? Most : block] = {};
    std::size_t own[Most];
    // In this order: same feature, nearly the same normal, new contacts.
    for (int k = 0; k < count; ++k)
      own[k] = slot_of(found[k], c.slot, slots, contacts, taken, true);
    for (int k = 0; k < count; ++k)
      if (own[k] == slots) own[k] = slot_of(found[k], c.slot, slots, contacts, taken, false);
    for (std::size_t p = 0; p < slots; ++p)
      if (!taken[p]) end(contacts, c.slot + p, images, wall, in, s);
    for (int k = 0; k < count; ++k) {
      for (std::size_t p = 0; own[k] == slots && p < slots; ++p)
        if (!taken[p]) own[k] = p, taken[p] = true;
      describe(found[k], centre, in, contacts, table, wall, of(k), c.slot + own[k], s);
    }
    if constexpr (keeps_offset<ContactsType>)  // the offset ends with the contact
      for (std::size_t p = 0; p < slots; ++p)
        if (!taken[p]) contacts.history(ContactsType::offset_from)[c.slot + p] = 0;
  }
  static std::size_t slot_of(const SolidContact& contact, std::size_t begin, std::size_t slots,
                             Contacts& contacts, bool* taken, bool by_feature) {
    std::size_t best = slots;
    double nearest = same_contact;
    for (std::size_t p = 0; p < slots; ++p) {
      const auto& slot = contacts.slot(begin + p);
      if (taken[p] || !slot.touching || (by_feature && slot.feature != contact.feature)) continue;
      if (const double cosine = dot(slot.normal, contact.normal); cosine > nearest)
        nearest = cosine, best = p;
    }
    if (best < slots) taken[best] = true;
    return best;
  }
  static void end(Contacts& contacts, std::size_t slot,
                  [[maybe_unused]] std::span<const Candidate> images,
                  [[maybe_unused]] const Wall& wall, [[maybe_unused]] const Input& in,
                  [[maybe_unused]] Scratch& s) {
    if (!contacts.slot(slot).touching) return;
    contacts.slot(slot).touching = false;
    if constexpr (keeps_events<ContactsType> || keeps_ledger<ContactsType>) {
      const Candidate& c = images[0];
      const Vec3d normal = contacts.slot(slot).normal;
      const Vec3d arm = -in.rows->pose[c.particle].least_radius * normal;
      const Vec3d point = in.positions[c.particle].centre() + arm;
      const Vec3d on_wall = contacts.seen(nearest_image(point, images, wall, contacts), point);
      const Vec3d velocity =
          body_at_contact(in.motions[c.particle], *in.rows, c.particle).velocity_at(arm) -
          velocity_at_contact(wall, on_wall, normal, in.times.step);
      if constexpr (keeps_ledger<ContactsType>)
        for (std::size_t p = 0; p < ContactsType::points; ++p)
          add_last_work<ContactsType>(
              [&](std::size_t k) {
                return contacts.history(ContactsType::history_of(p) + ContactsType::kept_from +
                                        k)[slot];
              },
              normal, velocity, {0, 0, 0}, s.last_work);
      if constexpr (keeps_events<ContactsType>) {
        NotedContact note;
        note.first = c.particle, note.event.wall = c.wall;
        note.event.normal = normal, note.event.point = point;
        end_watched<ContactsType>(
            [&](std::size_t k) -> double& { return contacts.history(events + k)[slot]; }, velocity,
            in.times, note, s.ended);
      }
    }
    for (std::size_t h = 0; h < H; ++h) contacts.history(h)[slot] = 0;
  }

  /// 1/m* [1/kg] of body and wall along the normal; `arm` [m] from the part's centre.
  static double inverse_mass_with(const Wall& wall, const BodyAtContact<double>& body,
                                  const SolidContact& contact, const Vec3d& arm,
                                  const Vec3d& on_wall, double R_eff) {
    const Vec3d& n = contact.normal;
    if (body.inv_m == 0) return inverse_mass_at_fixed(wall.drive, wall.state, on_wall, n, R_eff);
    double inverse_mass = body.inverse_mass(arm, n, contact.couple);
    if (wall.is_driven()) inverse_mass += inverse_mass_of(wall.drive, wall.state, on_wall, n);
    return inverse_mass;
  }

  static void describe(const SolidContact& contact, const Vec3d& centre, const Input& in,
                       Contacts& contacts, const CoefficientTable<ContactsType>& table,
                       const Wall& wall, const Candidate& c, std::size_t slot, Scratch& s) {
    auto& kept = contacts.slot(slot);
    const Vec3d change = kept.touching ? contact.normal - kept.normal : Vec3d{0, 0, 0};
    if constexpr (Fluxes::wears) s.rubs.next_begins = !kept.touching;
    kept = {contact.normal, true, contact.feature};
    double& R_eff = contacts.history(radius)[slot];  // from the first step in contact
    if (!(R_eff > 0)) R_eff = contact.R_eff;
    const auto body = body_at_contact(in.motions[c.particle], *in.rows, c.particle);
    const Vec3d arm = contact.point - centre, n = contact.normal;
    const Vec3d on_wall = contacts.seen(c, contact.point);
    // With a `distance` of 0: velocity_at() takes `arm` as that of now.
    auto [wall_velocity, wall_spin] =
        velocity_of_wall(wall, on_wall, change, body.velocity, 0, in.times);
    Vec3d surface_spin = wall_spin;  // which does not turn the normal
    if (wall.is_in_itself_moving()) {
      wall_velocity +=
          velocity_in_itself(wall, c.surface, contacts.facets(c), on_wall, n, in.times.step);
      if (wall.has_belt())
        surface_spin += wall.belt.rate,
            wall_velocity += belt_before(wall.belt, on_wall, n, change, body.velocity, 0, in.times);
    }
    const std::size_t k = s.count++;
    if constexpr (Fluxes::wears) s.rubs.put(k, c, wall, body.velocity_at(arm) - wall_velocity);
    const double g = contact.gradient;
    Kinematics<double> kin;
    kin.normal = n, kin.change = change;
    kin.velocity = body.velocity_at(arm) - wall_velocity;
    // The overlap rate and the force both carry the factor `gradient`.
    kin.velocity = g * (kin.velocity + (contact.couple * dot(body.spin - wall_spin, n)) * n);
    kin.overlap = contact.overlap, kin.R_eff = R_eff;
    if constexpr (keeps_offset<ContactsType>)
      kin.overlap = without_offset(kin.overlap, &contacts.history(ContactsType::offset_from)[slot]);
    const double inverse_mass = inverse_mass_with(wall, body, contact, arm, on_wall, R_eff);
    kin.inverse_m_eff = std::max(g * g * inverse_mass, 1e-300);
    kin.m_eff = 1 / kin.inverse_m_eff;
    kin.arm = 0, kin.spin = {0, 0, 0};
    kin.twist = dot(surface_spin, n);
    s.kinematics.put(k, kin);
    if constexpr (Scratch::has_area) {
      s.area.put_spread(k, contact.spread);
      s.area.put_spin(k, g * (body.spin - surface_spin));
    }
    s.kinematics.put(k, Radii<double>{R_eff, 0});
    std::size_t material = 0;
    if constexpr (ContactsType::several_materials) material = in.materials[c.particle];
    s.kind[k] = static_cast<std::uint16_t>(material * table.materials + wall.material);
    s.of[k] = &c, s.slot[k] = static_cast<std::uint32_t>(slot);
    const Vec3d& x = contact.point;
    s.arm[0][k] = arm.x, s.arm[1][k] = arm.y, s.arm[2][k] = arm.z;
    s.place[0][k] = x.x, s.place[1][k] = x.y, s.place[2][k] = x.z;
    s.gradient[k] = g, s.couple[k] = contact.couple;
    const std::size_t in_use = ContactsType::history_kept(in.rows->has_area());
    for (std::size_t h = 0; h < in_use; ++h) s.history[h][k] = contacts.history(h)[slot];
    for (std::size_t h = more; h < H; ++h) s.history[h][k] = contacts.history(h)[slot];
    s.largest = std::max(s.largest, contact.overlap / in.rows->pose[c.particle].least_radius);
  }

  /// Pads the last pack with copies of its first contact, moved out of reach.
  static void pad(Scratch& s) {
    for (std::size_t k = s.count; k % W != 0; ++k) {
      const std::size_t from = s.count / W * W;
      auto kinematics = s.kinematics.template get<double>(from);
      kinematics.overlap = -1;
      s.kinematics.put(k, kinematics);
      s.kinematics.put(k, s.kinematics.template get_radii<double>(from));
      for (auto& h : s.history) h[k] = 0;
      s.kind[k] = s.kind[from];
      if constexpr (Scratch::has_area) {
        s.area.put_spread(k, Symmetric3{});
        s.area.put_spin(k, Vec3d{0, 0, 0});
      }
    }
  }

  [[no_unique_address]] WallWear<Fluxes> wear_;
  DynArray<WallLoad> loads_;               // per block and wall
  DynArray<Tally<ContactsType>> tallies_;  // per block
};

}  // namespace silt::detail
