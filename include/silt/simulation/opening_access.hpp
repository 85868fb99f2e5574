// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>

#include <silt/boundary/deforming_box.hpp>
#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/engine/population/arrivals.hpp>
#include <silt/engine/population/openings.hpp>

namespace silt::inline SILT_TARGET::detail {

template <class Domain>
void refuse_in_deforming_box(const char* what) {
  require(!deforms<Domain>, "Simulation: ", what,
          " has no place in a DeformingBox, which has no inside and outside; take PeriodicBox");
}

/// Where particles come and leave; a Simulation has these functions as its own.
template <class Sim>
class OpeningAccess {
 public:
  /// Particles whose centre enters `region` leave the simulation and are counted.
  std::size_t add_outlet(const Box& region) {
    refuse_in_deforming_box<typename Sim::Domain>("an outlet");
    sim().engine_.lists.forget();  // also who rests in it leaves
    return sim().openings_.add_outlet(region);
  }
  const Outlet& outlet(std::size_t k) const { return sim().openings_.outlet(k); }
  std::size_t outlets() const { return sim().openings_.outlets().size(); }

  /// Places new particles at a rate; see Inlet.
  template <Region R>
  std::size_t add_inlet(const R& region, const InletFlow& flow) {
    refuse_in_deforming_box<typename Sim::Domain>("an inlet");
    check_form(sim().engine_, flow);
    sim().scene_changed_ = true;
    return sim().openings_.add_inlet(region, with_number(sim().engine_, flow), sim().time_);
  }
  std::size_t add_inlet(const Box& region, const InletFlow& flow) {
    return add_inlet<Box>(region, flow);
  }
  const Inlet& inlet(std::size_t k) const { return sim().openings_.inlet(k); }
  std::size_t inlets() const { return sim().openings_.inlets().size(); }

 private:
  Sim& sim() { return static_cast<Sim&>(*this); }
  const Sim& sim() const { return static_cast<const Sim&>(*this); }
};

}  // namespace silt::detail
