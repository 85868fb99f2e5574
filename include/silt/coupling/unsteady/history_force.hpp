// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <silt/core/dyn_array.hpp>
#include <silt/core/id_table.hpp>
#include <silt/core/threads.hpp>
#include <silt/coupling/fluid_force.hpp>
#include <silt/coupling/unsteady/basset.hpp>

namespace silt::inline SILT_TARGET {

/// Basset's history force in a CoupledFlow, by the window method, for every particle since its
/// start:
///
///   F = 1.5 d^2 sqrt(pi rho mu) [int_0^t g(s)/sqrt(t - s) ds + W(0)/sqrt(t)],  g = dW/dt       (1)
///
/// W is the slip (fluid minus particle). The force in a fluid step is the mean of (1) over it,
/// exact (within the window) for g constant in each step. The part of the present step's g is
/// treated as an added mass, which makes light particles stable. The initial slip W(0) of a
/// particle, at the start or from an inlet, counts as a sudden motion. The fluid's acceleration in
/// the present step's g is Du/Dt of that step. Particles outside the grid lose their history.
///
///   auto fluid = silt::CoupledFlow{silt::Stokes{}, silt::Kernel{}, flow, silt::HistoryForce{},
///                                  silt::VirtualMass{}};
///   fluid.steps = 5;
///
/// Particles are identified by their ids, independent of their order in memory. 24 (N + 13) bytes
/// per particle.
///
/// Source: M. A. T. van Hinsberg, J. H. M. ten Thije Boonkkamp, H. J. H. Clercx, J. Comput. Phys.
///         230 (2011) 1465; BassetKernel.
/// Valid:  single spheres, Re << 1; at large Re the real history force decays faster than (1).
/// Errors: InputError if fluid steps differ in length, except the first, which may be shorter
///         (leapfrog's first kick is half a step): set the number of particle steps
///         (CoupledFlow.steps) and their length (time_step).
/// Tests:  tests/coupling/history_force.cpp.
/// Units:  SI.
class HistoryForce {
 public:
  static constexpr bool has_history = true, needs_spin = false;

  explicit HistoryForce(std::size_t window_steps = 20) : window_(window_steps) {
    BassetKernel(1, window_);  // refuses invalid values
  }

  Vec3d force_on(const InFluid& at) const {
    const std::uint32_t slot = slot_[at.place];
    if (!history_) return (factor(at) * 2 / std::sqrt(first_)) * last_[slot];
    return factor(at) * history_->past(slot);
  }
  double added_mass(const InFluid& at) const {
    return factor(at) * (history_ ? history_->newest() : std::sqrt(first_) * 4 / 3);
  }

  /// A fluid step of dt [s] begins; slips [m/s] of particles with these ids, NaN outside the fluid.
  void remember(std::span<const ParticleId> id, std::span<const Vec3d> slip, double dt,
                const Team& team) {
    const double known = history_ ? history_->kernel().dt : first_;
    require(known == 0 || std::abs(dt - known) <= 1e-9 * known || (!history_ && dt > known),
            "HistoryForce: a fluid step of ", dt, " s after ones of ", known,
            " s, but it needs equal steps; set CoupledFlow.steps, and Simulation.time_step");
    const auto advance = [&] {
      if (!owner_.empty())
        history_->advance(
            [&](std::size_t blocks, const auto& one) { team.for_parts(blocks, one); });
    };
    if (!history_ && known > 0) {  // the first step, now that the length of the others is known
      history_.emplace(BassetKernel(dt, window_), owner_.size());
      for (std::size_t slot = 0; slot < owner_.size(); ++slot)
        history_->start_mean(slot, last_[slot], std::min(1.0, known / dt));
      advance();
    }
    forget_those_not_in(id, slip);
    slot_.resize(id.size());
    for (std::size_t p = 0; p < id.size(); ++p) {
      slot_[p] = 0;
      if (std::isnan(slip[p].x)) continue;
      std::uint32_t& slot = slot_of_.at(id[p]);
      if (slot == none) {
        slot = static_cast<std::uint32_t>(owner_.size());
        owner_.push_back(id[p]), last_.push_back(slip[p]);
        if (history_) history_->resize(owner_.size()), history_->start_mean(slot, slip[p]);
      } else {
        if (history_) history_->record(slot, (1 / dt) * (slip[p] - last_[slot]));
        last_[slot] = slip[p];
      }
      slot_[p] = slot;
    }
    if (history_)
      advance();
    else
      first_ = dt;
  }

  /// For a checkpoint.
  DynArray<double> state() const {
    if (first_ == 0) return {};
    DynArray<double> all{first_, history_ ? history_->kernel().dt : 0,
                         static_cast<double>(owner_.size())};
    for (std::size_t k = 0; k < owner_.size(); ++k)
      all.insert(all.end(), {double(owner_[k]), last_[k].x, last_[k].y, last_[k].z});
    if (!history_) return all;
    const auto more = history_->state();
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  void restore(std::span<const double> all) {
    history_.reset(), owner_.clear(), last_.clear(), slot_of_.clear(), slot_.clear();
    first_ = 0;
    if (all.empty()) return;
    require(all.size() > 2 && all[2] >= 0 && 3 + 4 * all[2] <= static_cast<double>(all.size()) &&
                all[2] == std::floor(all[2]),
            "HistoryForce: its state in the checkpoint is not complete");
    require(std::isfinite(all[0]) && all[0] > 0 && std::isfinite(all[1]) && all[1] >= 0,
            "HistoryForce: its state is of steps of ", all[0], " and ", all[1], " s");
    const auto n = static_cast<std::size_t>(all[2]);
    require((all[1] > 0) == (all.size() > 3 + 4 * n),
            "HistoryForce: its state in the checkpoint is not complete");
    DynArray<double> owners;
    for (std::size_t k = 0; k < n; ++k) {
      const double id = all[3 + 4 * k];
      require(id >= 0 && id <= 0x1p53 && id == std::floor(id),
              "HistoryForce: its state is of particle ", id);
      owners.push_back(id);
    }
    std::sort(owners.begin(), owners.end());
    require(std::adjacent_find(owners.begin(), owners.end()) == owners.end(),
            "HistoryForce: its state has a particle twice");
    first_ = all[0];
    for (std::size_t k = 0; k < n; ++k) {
      const double* of = &all[3 + 4 * k];
      owner_.push_back(static_cast<ParticleId>(of[0])), last_.push_back({of[1], of[2], of[3]});
      slot_of_.at(owner_[k]) = static_cast<std::uint32_t>(k);
    }
    if (!(all[1] > 0)) return;
    history_.emplace(BassetKernel(all[1], window_), n);
    history_->restore(all.subspan(3 + 4 * n));
  }

 private:
  static constexpr std::uint32_t none = no_place;

  static double factor(const InFluid& at) {
    return basset_coefficient(at.diameter, at.density, at.viscosity);
  }
  /// Moves the last particles to the places of those that have left.
  void forget_those_not_in(std::span<const ParticleId> id, std::span<const Vec3d> slip) {
    here_.assign(owner_.size(), 0);
    for (std::size_t p = 0; p < id.size(); ++p)
      if (const std::uint32_t slot = slot_of_.find(id[p]); slot != none && !std::isnan(slip[p].x))
        here_[slot] = 1;
    std::size_t n = owner_.size();
    for (std::size_t k = n; k-- > 0;) {
      if (here_[k]) continue;
      slot_of_.at(owner_[k]) = none;
      if (k != --n) {
        if (history_) history_->copy(n, k);
        owner_[k] = owner_[n], last_[k] = last_[n],
        slot_of_.at(owner_[k]) = static_cast<std::uint32_t>(k);
      }
    }
    owner_.resize(n), last_.resize(n);
    if (history_) history_->resize(n);
  }

  std::size_t window_;  // [fluid steps]
  double first_ = 0;    // [s] the first fluid step; 0: none yet
  std::optional<BassetHistory<>> history_;
  DynArray<ParticleId> owner_;    // id of a place in the history
  detail::IdTable slot_of_;       // the opposite
  DynArray<Vec3d> last_;          // [m/s] slip of each place, a step ago
  DynArray<std::uint32_t> slot_;  // of each particle of this step
  DynArray<char> here_;
};

static_assert(FluidForce<HistoryForce>);

}  // namespace silt
