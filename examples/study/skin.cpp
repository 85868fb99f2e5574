// silt - BSD-3-Clause, see LICENSE
//
// Cost of a Verlet list over its skin: too small a skin needs frequent searches, too large a one
// carries pairs that do not touch. If none is given, silt gives each sphere a reach that follows
// its motion. The skin affects results only by the order of pairs, hence by rounding.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <tuple>
#include <vector>

#include <silt/files/csv_table.hpp>

#include "study/crowds.hpp"
#include "study/studies.hpp"

namespace skin_study {

namespace {

constexpr double diameter = 2 * studies::mean_radius;  // [m]

silt::VerletList<> with_skin(double share) {  // of the mean diameter [-]; 0: automatic
  silt::VerletList<> list;
  if (share > 0) list.skin = share * diameter;
  return list;
}

/// A scene with several skins, the automatic one first; as a control one with a slightly different
/// start. Velocities are compared after a sixth of the run: later every difference has grown.
///   scene(list, nudge): gravity or speeds are multiplied by `nudge`
template <class Scene>
silt::Study study(const std::string& name, const std::vector<double>& skins, double duration,
                  const Scene& scene) {
  silt::Study study(name);
  const auto with = [=](double skin, double nudge = 1) {
    return [=](silt::StudyRun& run) {
      auto sim = scene(with_skin(skin), nudge);
      run.time([&] { sim.run(duration / 6); });
      run.value("early velocities", studies::velocities(sim));
      run.time([&] { sim.run(duration * 5 / 6); });
      run.value("kinetic energy", 1e3 * studies::kinetic_energy(sim), "mJ");
    };
  };
  study.reference("automatic", with(0));
  study.variant("automatic", with(0));
  for (const double skin : skins) study.variant(silt::text(skin, " d"), with(skin));
  study.control("automatic, 1e-12 off", with(0, 1 + 1e-12));
  study.accept("error of kinetic energy", 1e-3);
  return study;
}

/// Cost over skin, with that of the automatic choice as a horizontal line.
bool draw(const std::string& folder, const std::string& title, const std::vector<double>& skins,
          const silt::Study& study) {
  const auto& rows = study.results().rows;
  silt::CsvTable table(folder + "/cost.csv", {"skin over diameter [-]", "skin of one length [ms]"});
  for (std::size_t k = 0; k < skins.size(); ++k)
    if (!rows[k + 1].failed()) table.add_row({skins[k], 1e3 * rows[k + 1].cost()});
  return example::draw({"curves", folder + "/cost.csv", "--x", "skin over diameter", "--y",
                        "skin of one length", "--log", "xy", "--y-label", "processor time [ms]",
                        "--reference", silt::text("automatic:0,", 1e3 * rows[0].cost()), "--title",
                        title, "--out", folder + "/cost.png"});
}

void summarise(const std::string& name, const silt::Study& study, example::Summary& summary) {
  const auto& rows = study.results().rows;
  const auto error = [&](std::size_t k) {
    return rows[k].error("error of early velocities")->value;
  };
  const std::size_t control = rows.size() - 1;
  double best = INFINITY, worst = 0, energy = 0;
  for (std::size_t k = 1; k < control; ++k) {
    best = std::min(best, rows[k].cost()), worst = std::max(worst, error(k));
    energy = std::max(energy, rows[k].error("error of kinetic energy")->value);
  }
  studies::add_recommendation(summary, name, study);
  summary.result("automatic_over_best_fixed_cost_" + name, rows[0].cost() / best);
  summary.result("error_of_early_velocities_1e-12_off_" + name, error(control));
  summary.check_at_most("same_skin_same_bits_" + name, error(0), 0);
  // Different order of pairs: roundings of 1e-16 at each of some hundred steps.
  summary.check_at_most("less_than_1e-12_off_" + name, worst / error(control), 1);
  summary.check_at_most("error_of_kinetic_energy_" + name, energy, 1e-3);
}

void run(const studies::Setting& setting, example::Summary& summary) {
  const std::size_t count = setting.quick ? 500 : 5000;
  const std::vector<double> skins =
      setting.quick ? std::vector<double>{0.05, 0.2, 0.8}
                    : std::vector<double>{0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8};
  summary.input("particles", static_cast<double>(count));

  const auto name = [&](const char* scene) {
    return silt::text("Skin of the Verlet list over the diameter d: ", count, " spheres, ", scene);
  };
  silt::Study bed = study(name("poured"), skins, 0.03, [=](const auto& list, double nudge) {
    auto sim = studies::poured_bed(count, silt::Double{}, list);
    sim.gravity = nudge * sim.gravity;
    return sim;
  });
  silt::Study gas = study(name("a gas"), skins, 0.01, [=](const auto& list, double nudge) {
    return studies::gas(count, silt::Double{}, nudge, list);
  });
  for (const auto& [study, scene, title] : {std::tuple{&bed, "bed", "Spheres that pour into a box"},
                                            std::tuple{&gas, "gas", "A granular gas"}}) {
    studies::run_and_report(*study, setting, scene);
    const std::string folder = setting.out + "/" + scene;
    if (draw(folder, title, skins, *study)) std::printf("Look at %s/cost.png.\n", folder.c_str());
  }
  summarise("bed", bed, summary);
  summarise("gas", gas, summary);
}

const studies::Registered here{"skin", "cost over the skin of the Verlet list", run};

}  // namespace

}  // namespace skin_study
