// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>

#include <silt/boundary/deforming_box.hpp>
#include <silt/contact/concept.hpp>
#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/engine/population/arrivals.hpp>
#include <silt/engine/population/openings.hpp>
#include <silt/engine/state/module_columns.hpp>
#include <silt/fill/region.hpp>

namespace silt::inline SILT_TARGET::detail {

template <class Domain>
void refuse_in_deforming_box(const char* what) {
  require(!deforms<Domain>, "Simulation: ", what,
          " has no place in a DeformingBox, which has no inside and outside; take PeriodicBox");
}

/// A pressure below 0 pulls particles, which are held only by an attractive law.
template <class Law>
void refuse_tension(const Deformation& how) {
  using Numbers = typename Law::template Coefficients<double>;
  using Kept = typename HistoryOf<Law, double>::type;
  constexpr bool attracts =
      ActsAtDistance<Law> || requires(const Contact<double>& c, const Numbers& p, Kept& h) {
    Law::attraction(c, p, h);
  }
  || requires(const Contact<double>& c, const Numbers& p) { Law::pressing(c, p, 1.0); };
  static constexpr const char* names[3] = {"x", "y", "z"};
  for (std::size_t k = 0; k < 3 && !attracts; ++k)
    if (const auto stress = how.all()[k].stress; stress && *stress < 0)
      throw InputError(text(
          "Deformation.", names[k], ".stress = ", *stress,
          " [Pa] is a tension (compression is "
          "greater than 0), but the contact law ",
          name_of_module<Law>(),
          " never pulls: the box would grow at most_rate without end. Give at least 0 Pa, or a law "
          "with cohesion; a law of your own says that it pulls by attraction()"));
}

/// Refuses an inlet that lies outside the box in a periodic direction.
template <class Domain>
void refuse_outside(const Domain& domain, const Box& inlet, const std::string& region) {
  if constexpr (Domain::periodic && !deforms<Domain>) {
    const Box& box = domain.box();
    const Vec3d &low = box.min, &high = box.max;
    const bool outside[3] = {inlet.max.x <= low.x || inlet.min.x >= high.x,
                             inlet.max.y <= low.y || inlet.min.y >= high.y,
                             inlet.max.z <= low.z || inlet.min.z >= high.z};
    for (int d = 0; d < 3; ++d)
      require(!(outside[d] && domain.repeats(d)), "add_inlet: ", region,
              " lies outside the PeriodicBox from ", low, " to ", high, " m along ", "xyz"[d],
              ", which repeats; move it into the box");
  }
}

/// Refuses inlet k if its smallest particles could be placed beyond guard.domain.
inline void refuse_beyond(const Inlet& inlet, std::size_t k, const Box& domain) {
  double least = inlet.flow.radius.min();
  for (const auto& other : inlet.flow.recipe) least = std::min(least, other.radius.min());
  const Box centres = inlet.bounds.grown(-least);
  require(domain.contains(centres.min) && domain.contains(centres.max), "inlet ", k, " into ",
          inlet.region, " places particles outside guard.domain from ", domain.min, " to ",
          domain.max, " m; move it, or enlarge guard.domain");
}

/// Inlets and outlets; member functions of Simulation.
template <class Sim>
class OpeningAccess {
 public:
  /// Particles whose centre enters `region` leave the simulation and are counted.
  std::size_t add_outlet(const Box& region) {
    refuse_in_deforming_box<typename Sim::Domain>("an outlet");
    sim().engine_.lists.forget();  // particles at rest in it leave, too
    return sim().openings_.add_outlet(region);
  }
  const Outlet& outlet(std::size_t k) const { return sim().openings_.outlet(k); }
  std::size_t outlets() const { return sim().openings_.outlets().size(); }

  /// Places new particles at a rate; see Inlet.
  template <Region R>
  std::size_t add_inlet(const R& region, const InletFlow& flow) {
    refuse_in_deforming_box<typename Sim::Domain>("an inlet");
    check_form(sim().engine_, flow);
    refuse_outside(sim().domain_, region_of(region).bounds(), region_of(region).describe());
    sim().scene_changed_ = true;
    const InletFlow sized = with_radii(sim().engine_, flow);
    return sim().openings_.add_inlet(region, with_number(sim().engine_, sized), sim().time_);
  }
  std::size_t add_inlet(const Box& region, const InletFlow& flow) {
    return add_inlet<Box>(region, flow);
  }
  /// From now on inlet k places particles at another rate [1/s] or [kg/s]; 0 closes it.
  void set_inlet_rate(std::size_t k, double rate) {
    sim().openings_.set_rate(k, rate, sim().time_);
  }
  void set_inlet_mass_rate(std::size_t k, double rate) {
    require_not_negative("set_inlet_mass_rate: rate", rate, "kg/s");
    InletFlow flow = inlet(k).flow;
    flow.rate = 0, flow.mass_rate = rate;
    set_inlet_rate(k, with_number(sim().engine_, flow).rate);
  }
  const Inlet& inlet(std::size_t k) const { return sim().openings_.inlet(k); }
  std::size_t inlets() const { return sim().openings_.inlets().size(); }

 protected:
  /// Called before a run.
  void check_inlets() const {
    const auto& contacts = sim().contacts_;
    for (std::size_t i = 0; i < inlets(); ++i) {
      const InletFlow& flow = inlet(i).flow;
      for (std::size_t k = 0; k < flow.kinds(); ++k)
        require(flow.kind(k).material < contacts.materials(), k == 0 ? "InletFlow" : "InletShare",
                ".material = ", flow.kind(k).material, " is not in the table of ",
                contacts.materials(), " materials; add it to the contacts first");
      if (sim().guard.domain) refuse_beyond(inlet(i), i, *sim().guard.domain);
    }
  }

 private:
  Sim& sim() { return static_cast<Sim&>(*this); }
  const Sim& sim() const { return static_cast<const Sim&>(*this); }
};

}  // namespace silt::detail
