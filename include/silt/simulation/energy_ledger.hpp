// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <span>

#include <silt/boundary/wall.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/ledger.hpp>
#include <silt/engine/contact/contact_energy.hpp>

namespace silt::inline SILT_TARGET {

/// Energy stored in a simulation, and where energy came from and went to since the first step [J].
struct EnergyBalance {
  // Stored now.
  double translation, rotation;        // kinetic, of particles that are not fixed
  double gravity;                      // - m g x, relative to the origin
  double normal, tangential, rolling;  // in the springs of contacts
  double bonds;                        // stored in bonds
  // Dissipated since the start. None of these decreases from one observation to the next by more
  // than the error of the step (residual()), except normal_damping with cohesion. Friction and
  // rolling resistance are the work of tangential forces (without their dashpots) and of couples
  // that is neither stored nor returned. Partial slip (Mindlin's law on loading) counts as
  // friction, and so does the energy in a tangential spring when its contact ends. Damping and
  // friction are separated in every fourth step and in observed ones; their sum is known in each
  // step.
  double normal_damping;      // of dashpots; with cohesion also its net loss
  double tangential_damping;  // of dashpots
  double friction;
  double rolling_resistance;  // including twisting
  double bond_damping;        // of the dashpots of bonds
  double bond_breaking;       // stored in bonds when they broke
  double breaking;            // kinetic energy that particles lost on breaking
  // Supplied since the start.
  double walls;            // work of moving walls, belts and prescribed particles
  double openings;         // of particles added, less those that left
  double changed_gravity;  // by changes of `gravity`
  double going_round;      // by gravity along a repeating direction: m g L of each passage
  double fluid;            // work of the fluid on mobile particles
  double modules;          // work of module forces on mobile particles
  double box;              // work of a DeformingBox; kinetic energies are relative to its flow
  double parting;          // by separating fragments that overlap at birth (Breakage)
  double stiffening;       // gained where stiffness grows and the tangential displacement is kept
                           // (TangentialMemory::Displacement of Hertz contacts, Dcdem)

  /// Present energy of free walls: kinetic, in gravity, in their springs, and of their constant
  /// forces. It is not part of held(): what they give to particles is in `walls`; held() +
  /// free_walls is the total.
  double free_walls;
  double initial;      // total at the first step
  double turned_over;  // by normal forces since then, counting storage and release

  double kinetic() const { return translation + rotation; }
  double elastic() const { return normal + tangential + rolling + bonds; }
  double held() const { return kinetic() + gravity + elastic(); }
  double dissipated() const {
    return normal_damping + tangential_damping + friction + rolling_resistance + bond_damping +
           bond_breaking + breaking;
  }
  double supplied() const {
    return walls + openings + changed_gravity + going_round + fluid + modules + box + parting +
           stiffening;
  }
  /// The energy that the balance does not explain: the error of time integration. It is second
  /// order in the step with Leapfrog, first order with SymplecticEuler while forces act, and with
  /// Gear if there is damping, friction, or a force of a module or fluid: a constant one gives
  /// -m a^2 dt/2 per time (docs/energy.md has numbers). First order are also: a
  /// change of gravity, because half a step uses the previous value; with friction,
  /// the change of the lever arm in half a step (some 1e-7 of the energy turned over at 1000 steps
  /// per contact); RollingOwn; and ends of contact with DampingEnd::ZeroOverlap at walls that are
  /// not planes at rest, or without a Verlet list. It also contains the energy in normal springs of
  /// particles that leave through an outlet during contact, and of bodies that are removed or whose
  /// wall is removed.
  double residual() const { return held() + dissipated() - supplied() - initial; }
};

namespace detail {

/// The energy balance of one simulation.
class EnergyBook {
 public:
  /// Books one step after its forces are known. `start`: energy of the particles at the first step,
  /// kinetic and in gravity; `fixed_power` [W]: of contacts on prescribed particles that move;
  /// `asked`: contacts have reported stored energies; sum(numbers): over all ranks.
  template <class Sum>
  void book(const ContactEnergy<double>& contacts, std::span<const Wall> walls, double time_step,
            double fixed_power, const double* start, bool asked, const Sum& sum) {
    stored_ = contacts;
    if (start != nullptr) {
      at_start_ = contacts;
      initial_ += *start + contacts.normal + contacts.tangential + contacts.rolling;
    } else {
      work_.add(contacts);
      for (std::size_t w = 0; w < walls.size() && w < last_.size(); ++w)
        if (walls[w].moves()) of_walls_ += work_of(walls[w], last_[w]);
      of_walls_ -= 0.5 * time_step * (last_fixed_power_ + fixed_power);
      since_asked_ += time_step;
    }
    if (asked) tell_apart(sum);
    last_.clear();
    for (const auto& wall : walls) last_.push_back({wall.force, wall.torque, wall.reference});
    last_fixed_power_ = fixed_power;
  }
  void bring_in(double energy) { openings_ += energy; }
  /// Energy that was present and left before the first forces [J].
  void was_there(double energy) { initial_ += energy; }
  void change_gravity(double energy) { changed_gravity_ += energy; }
  /// Particles were wrapped into a periodic box, which changed their energy in gravity [J].
  void went_round(double energy) { going_round_ += energy; }
  void fluid_worked(double energy) { of_fluid_ += energy; }
  void modules_worked(double energy) { of_modules_ += energy; }
  void bond_broken(double energy) { bond_breaking_ += energy; }
  void broke(double energy) { breaking_ += energy; }
  /// Contacts that were ended from outside (EndedContacts): work of the non-elastic forces.
  void ended(const ContactEnergy<double>& work) { work_.add(work); }
  /// The same, where an edit has also removed the energy of normal springs.
  void removed(const ContactEnergy<double>& work, double springs) {
    work_.add(work), bring_in(-springs), stored_.normal -= springs;
  }
  /// Books the dashpots of bonds from the power [W] of their forces at the velocities of half a
  /// step ago. The work of a force F_n in the leapfrog is F_n (v_n-1/2 + v_n+1/2)/2; with F_n = -c
  /// v_n-1/2 that is P_n 3/4 + P_n-1 1/4 summed over steps, to second order in the step.
  void bonds_damped(double power, double time_step) {
    bond_damping_ -= time_step * (0.75 * power + 0.25 * last_bond_power_);
    last_bond_power_ = power;
  }

  /// With several ranks, this rank's part, so that all parts add up; `tells`: this rank includes
  /// the terms that are known for all ranks together.
  EnergyBalance balance(double translation, double rotation, double gravity, double free_walls,
                        bool tells) const {
    EnergyBalance e{};
    e.translation = translation, e.rotation = rotation, e.gravity = gravity;
    e.normal = stored_.normal, e.tangential = stored_.tangential, e.rolling = stored_.rolling;
    e.normal_damping = -work_.dashpot;
    e.friction = tells ? friction_ : 0, e.tangential_damping = tangential_loss() - e.friction;
    e.rolling_resistance = -work_.couple - (stored_.rolling - at_start_.rolling);
    e.bond_damping = bond_damping_, e.bond_breaking = bond_breaking_;
    e.breaking = breaking_;
    e.walls = of_walls_, e.openings = openings_, e.changed_gravity = changed_gravity_;
    e.going_round = going_round_;
    e.fluid = of_fluid_, e.modules = of_modules_, e.stiffening = work_.stiffening;
    e.free_walls = free_walls;
    e.initial = initial_, e.turned_over = work_.turned_over;
    return e;
  }

  // The balance as numbers, for a checkpoint.
  DynArray<double> state() const {
    DynArray<double> all{of_walls_,         openings_,        changed_gravity_, initial_,
                         last_fixed_power_, of_fluid_,        since_asked_,     last_power_,
                         damped_,           friction_,        of_modules_,      bond_damping_,
                         bond_breaking_,    last_bond_power_, breaking_};
    for (const auto* e : {&stored_, &at_start_, &work_}) {
      const auto values = ContactEnergy<double>::values(*e);
      all.insert(all.end(), values.begin(), values.end());
    }
    for (const auto& [force, torque, reference] : last_)
      for (const Vec3d& v : {force, torque, reference}) all.insert(all.end(), {v.x, v.y, v.z});
    all.push_back(going_round_);
    return all;
  }
  void restore(const DynArray<double>& all) {
    of_walls_ = all[0], openings_ = all[1], changed_gravity_ = all[2], initial_ = all[3];
    last_fixed_power_ = all[4], of_fluid_ = all[5], since_asked_ = all[6], last_power_ = all[7];
    damped_ = all[8], friction_ = all[9], of_modules_ = all[10];
    bond_damping_ = all[11], bond_breaking_ = all[12], last_bond_power_ = all[13];
    breaking_ = all[14];
    std::size_t at = 15;
    for (auto* e : {&stored_, &at_start_, &work_}) {
      std::array<double, terms> values;
      for (double& v : values) v = all[at++];
      *e = std::bit_cast<ContactEnergy<double>>(values);
    }
    last_.clear();
    for (; at + 9 <= all.size(); at += 9)
      last_.push_back({{all[at], all[at + 1], all[at + 2]},
                       {all[at + 3], all[at + 4], all[at + 5]},
                       {all[at + 6], all[at + 7], all[at + 8]}});
    going_round_ = at < all.size() ? all[at] : 0;  // files of before have none
  }
  /// For the balances of several ranks, if another number of ranks continues: each rank keeps the
  /// terms known to all; of the terms summed over ranks only one rank keeps the sum.
  void forget_own() {
    EnergyBook all;
    all.last_ = last_;
    for (Load& load : all.last_) load.force = load.torque = {0, 0, 0};
    all.since_asked_ = since_asked_, all.last_power_ = last_power_;
    all.damped_ = damped_, all.friction_ = friction_;
    *this = all;
  }
  void add_own_of(const EnergyBook& other) {
    stored_.add(other.stored_), at_start_.add(other.at_start_), work_.add(other.work_);
    for (std::size_t w = 0; w < last_.size() && w < other.last_.size(); ++w)
      last_[w].force += other.last_[w].force, last_[w].torque += other.last_[w].torque;
    of_walls_ += other.of_walls_, openings_ += other.openings_;
    changed_gravity_ += other.changed_gravity_, going_round_ += other.going_round_;
    initial_ += other.initial_;
    last_fixed_power_ += other.last_fixed_power_;
    of_fluid_ += other.of_fluid_, of_modules_ += other.of_modules_;
    breaking_ += other.breaking_, bond_damping_ += other.bond_damping_;
    bond_breaking_ += other.bond_breaking_, last_bond_power_ += other.last_bond_power_;
  }
  static constexpr std::size_t terms = sizeof(ContactEnergy<double>) / sizeof(double);
  static constexpr std::size_t least_size = 15 + 3 * terms;

 private:
  /// Work of tangential forces that is not stored in their springs [J].
  double tangential_loss() const {
    return work_.stiffening - work_.shear - (stored_.tangential - at_start_.tangential);
  }
  /// The loss in dashpots is their power, known in some steps, integrated over time. Friction is
  /// the rest of the loss, and its largest value so far: the integral has errors of both signs, and
  /// friction returns no energy. So neither part decreases while the loss grows.
  template <class Sum>
  void tell_apart(const Sum& sum) {
    std::array<double, 2> of{stored_.shear_damping, tangential_loss()};
    sum(of);
    damped_ += 0.5 * since_asked_ * (last_power_ + of[0]);
    last_power_ = of[0], since_asked_ = 0;
    friction_ = std::max(friction_, of[1] - damped_);
  }

  struct Load {
    Vec3d force, torque, reference;  // [N], [N m], [m]
  };

  /// Work of a wall on the particles in the last step [J]: mean load times displacement.
  static double work_of(const Wall& wall, const Load& last) {
    // Displacement of the wall at the reference point of the torque; symmetric in time.
    const auto moved = [&](const Vec3d& p) {
      return 0.5 * (wall.pose.to_space(wall.last_pose.to_body(p)) -
                    wall.last_pose.to_space(wall.pose.to_body(p)));
    };
    const Vec3d here = wall.reference;
    const Quaternion turn = wall.pose.rotation * conjugate(wall.last_pose.rotation);
    const Vec3d axis{turn.x, turn.y, turn.z};
    const double sine = norm(axis);
    const double angle = 2 * std::atan2(turn.w < 0 ? -sine : sine, std::abs(turn.w));
    const Vec3d rotation = sine == 0 ? Vec3d{0, 0, 0} : axis * (angle / sine);
    // The last torque about the present reference.
    const Vec3d torque = last.torque + cross(last.reference - here, last.force);
    return -0.5 * (dot(last.force + wall.force, moved(here)) + dot(torque + wall.torque, rotation));
  }

  ContactEnergy<double> stored_ = no_energy<double>(), at_start_ = stored_, work_ = stored_;
  DynArray<Load> last_;  // per wall
  double of_walls_ = 0, openings_ = 0, changed_gravity_ = 0, initial_ = 0, last_fixed_power_ = 0;
  double going_round_ = 0;
  double of_fluid_ = 0, of_modules_ = 0;
  double breaking_ = 0, bond_damping_ = 0, bond_breaking_ = 0;  // [J]
  double last_bond_power_ = 0;                                  // [W] of their dashpots
  double since_asked_ = 0;                                      // [s]
  double last_power_ = 0;  // [W] of tangential dashpots, last value
  double damped_ = 0;      // [J] their loss, integrated
  double friction_ = 0;    // [J]
};

}  // namespace detail
}  // namespace silt
