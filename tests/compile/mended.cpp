// silt - BSD-3-Clause, see LICENSE
// The programs of refused/, each with its one mistake mended: they must compile, so that it is the
// mistake that the others are refused for.
#define SILT_MENDED
#include <silt/fluid.hpp>
#include <silt/measure/coordination.hpp>
#include <silt/ranks.hpp>
#include <silt/sph.hpp>

#include "refused/scene.hpp"

namespace gear_in_deforming_box {
#include "refused/gear_in_deforming_box.cpp"
}
namespace bonds_of_bodies {
#include "refused/bonds_of_bodies.cpp"
}
namespace bonds_without_rotation {
#include "refused/bonds_without_rotation.cpp"
}
namespace bonds_by_gear {
#include "refused/bonds_by_gear.cpp"
}
namespace bond_without_policy {
#include "refused/bond_without_policy.cpp"
}
namespace break_without_policy {
#include "refused/break_without_policy.cpp"
}
namespace ranks_with_fluid {
#include "refused/ranks_with_fluid.cpp"
}
namespace foreign_option {
#include "refused/foreign_option.cpp"
}
namespace foreign_policy {
#include "refused/foreign_policy.cpp"
}
namespace law_is_no_law {
#include "refused/law_is_no_law.cpp"
}
namespace law_of_doubles {
#include "refused/law_of_doubles.cpp"
}
namespace no_contacts {
#include "refused/no_contacts.cpp"
}
namespace no_particles {
#include "refused/no_particles.cpp"
}
namespace softened_by_gear {
#include "refused/softened_by_gear.cpp"
}
namespace temporary_field {
#include "refused/temporary_field.cpp"
}
namespace two_domains {
#include "refused/two_domains.cpp"
}
namespace two_fluids {
#include "refused/two_fluids.cpp"
}
namespace two_searches {
#include "refused/two_searches.cpp"
}
namespace force_twice {
#include "refused/force_twice.cpp"
}
namespace two_ledgers {
#include "refused/two_ledgers.cpp"
}
namespace two_rolling_models {
#include "refused/two_rolling_models.cpp"
}
namespace law_with_if {
#include "refused/law_with_if.cpp"
}
namespace law_with_std_max {
#include "refused/law_with_std_max.cpp"
}
namespace law_with_std_sqrt {
#include "refused/law_with_std_sqrt.cpp"
}
namespace rolling_of_several_without_model {
#include "refused/rolling_of_several_without_model.cpp"
}
namespace rolling_with_if {
#include "refused/rolling_with_if.cpp"
}
namespace rolling_without_model {
#include "refused/rolling_without_model.cpp"
}
namespace material_of_another_law {
#include "refused/material_of_another_law.cpp"
}
namespace wall_of_another_law {
#include "refused/wall_of_another_law.cpp"
}
namespace rolling_of_doubles {
#include "refused/rolling_of_doubles.cpp"
}
namespace cohesion_with_if {
#include "refused/cohesion_with_if.cpp"
}
namespace cohesion_of_doubles {
#include "refused/cohesion_of_doubles.cpp"
}
namespace drag_with_if {
#include "refused/drag_with_if.cpp"
}
namespace drag_of_doubles {
#include "refused/drag_of_doubles.cpp"
}
namespace drag_of_one_double {
#include "refused/drag_of_one_double.cpp"
}
namespace flow_without_mode {
#include "refused/flow_without_mode.cpp"
}
namespace bare_flow {
#include "refused/bare_flow.cpp"
}
namespace drag_of_wrong_arguments {
#include "refused/drag_of_wrong_arguments.cpp"
}
namespace formula_of_particle_law {
#include "refused/formula_of_particle_law.cpp"
}
namespace prescribed_flow_with_mode {
#include "refused/prescribed_flow_with_mode.cpp"
}
namespace flow_without_drag {
#include "refused/flow_without_drag.cpp"
}
namespace flow_without_flow {
#include "refused/flow_without_flow.cpp"
}
namespace flow_with_two_drags {
#include "refused/flow_with_two_drags.cpp"
}
namespace law_without_contacts {
#include "refused/law_without_contacts.cpp"
}
namespace torque_without_rotation {
#include "refused/torque_without_rotation.cpp"
}
namespace lift_without_rotation {
#include "refused/lift_without_rotation.cpp"
}
namespace unknown_field {
#include "refused/unknown_field.cpp"
}
namespace field_of_text {
#include "refused/field_of_text.cpp"
}
namespace module_check {
#include "refused/module_check.cpp"
}
namespace module_twice {
#include "refused/module_twice.cpp"
}
namespace coordination_on_ranks {
#include "refused/coordination_on_ranks.cpp"
}
namespace energy_without_ledger {
#include "refused/energy_without_ledger.cpp"
}
namespace module_misfits {
#include "refused/module_misfits.cpp"
}
namespace pair_misfits {
#include "refused/pair_misfits.cpp"
}
namespace contact_misfits {
#include "refused/contact_misfits.cpp"
}
namespace flux_with_if {
#include "refused/flux_with_if.cpp"
}
namespace fluid_active_alone {
#include "refused/fluid_active_alone.cpp"
}
namespace fluid_follows_without_parts {
#include "refused/fluid_follows_without_parts.cpp"
}
namespace fluid_without_advance {
#include "refused/fluid_without_advance.cpp"
}
namespace taps_without_flow {
#include "refused/taps_without_flow.cpp"
}
namespace levels_without_liquid {
#include "refused/levels_without_liquid.cpp"
}
namespace observer_not_called {
#include "refused/observer_not_called.cpp"
}
namespace const_observer {
#include "refused/const_observer.cpp"
}
namespace strength_of_other_unit {
#include "refused/strength_of_other_unit.cpp"
}
namespace sph_twice {
#include "refused/sph_twice.cpp"
}
namespace sph_volume {
#include "refused/sph_volume.cpp"
}
namespace passing_in_deforming_box {
#include "refused/passing_in_deforming_box.cpp"
}
