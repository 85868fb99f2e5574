// silt - BSD-3-Clause, see LICENSE
//
// SPH: cost and error of its settings and policies on four scenes with a closed form
// (sph_scenes.hpp): a column at rest, flow between plates, the elliptic drop, a standing wave. One
// parameter is varied at a time, from the defaults.

#include "study/sph.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace sph_study {

namespace {

namespace sph = studies::sph;

const silt::StudyRow* row_of(const silt::Study& study, const std::string& name) {
  for (const auto& row : study.results().rows)
    if (row.name == name && !row.failed()) return &row;
  return nullptr;
}
double error_of(const silt::Study& study, const std::string& row, const std::string& error) {
  const auto* const found = row_of(study, row);
  return found ? found->error(error)->value : NAN;
}

/// Errors over the varied parameter: one line per error. `at`: the number of each variant.
void draw(const silt::Study& study, const std::vector<double>& at, const std::string& axis,
          const std::vector<std::string>& errors, const std::string& title, const std::string& path,
          const std::string& log) {
  std::string head = axis + " [-]", columns;
  for (const auto& e : errors) {
    head += ',' + e + " [%]";
    columns += (columns.empty() ? "" : ",") + e;
  }
  std::string lines;
  const auto& rows = study.results().rows;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (rows[k].failed() || !(at[k] > 0)) continue;
    lines += silt::text('\n', at[k]);
    for (const auto& e : errors) lines += silt::text(',', rows[k].error(e)->value);
  }
  silt::detail::write_whole(path + ".csv", head + lines + "\n");
  if (example::draw({"curves", path + ".csv", "--x", axis, "--y", columns, "--log", log,
                     "--y-label", "error [%]", "--title", title, "--out", path + ".png"}))
    std::printf("Look at %s.png.\n", path.c_str());
}

/// Relative excess of the wave's speed, and half of the lattice's shear modulus over the pressure.
void draw_periods(const silt::Study& study, const std::string& path) {
  std::string table = "smoothing [-],Wendland [%],... by G/(2 P) [%],cubic spline [%]";
  for (const auto& row : study.results().rows) {
    if (!row.name.starts_with("Wendland, ") || row.failed()) continue;
    const std::string smoothing = row.name.substr(10);
    const auto* const other = row_of(study, "cubic spline, " + smoothing);
    if (other == nullptr) continue;
    table += '\n' + smoothing +
             silt::text(',', -row.note("period")->value, ',', 0.5 * row.note("lattice G/P")->value,
                        ',', -other->note("period")->value);
  }
  silt::detail::write_whole(path + ".csv", table + "\n");
  if (example::draw({"curves", path + ".csv", "--x", "smoothing", "--y",
                     "Wendland,... by G/(2 P),cubic spline", "--y-label",
                     "frequency too high by [%]", "--title",
                     "SPH: a standing wave over the smoothing", "--out", path + ".png"}))
    std::printf("Look at %s.png.\n", path.c_str());
}

silt::Study part(const std::string& name, const sph::Variants& variants,
                 const studies::Setting& setting, const std::string& folder,
                 example::Summary& summary) {
  silt::Study study(name);
  for (const auto& v : variants) study.variant(v.name, v.run);
  // Typical uncertainty of measurements in liquids: a few per cent.
  study.accept("pressure at rest", 2), study.accept("axes of the drop", 1.5);
  study.accept("flow between plates", 2), study.accept("energy of the drop", 3);
  study.accept("period of the wave", 2);
  studies::run_and_report(study, setting, folder);
  studies::add_recommendation(summary, folder, study);
  return study;
}

void run(const studies::Setting& wanted, example::Summary& summary) {
  studies::Setting setting = wanted;
  setting.repeats = std::min<std::size_t>(setting.repeats, setting.quick ? 1 : 2);
  const bool quick = setting.quick;
  const double fine = quick ? 0.5 : 1.5;

  const auto spacing = part("SPH: spacing", sph::resolutions(quick), setting, "spacing", summary);
  std::vector<double> at;
  for (const double f :
       quick ? std::vector<double>{0.5, 0.75, 1} : std::vector<double>{0.75, 1, 1.5, 2, 3})
    at.push_back(20 * f);
  draw(spacing, at, "particles a radius of the drop",
       {"pressure at rest", "flow between plates", "axes of the drop", "energy of the drop",
        "period of the wave", "wave lost a period"},
       "SPH: errors over the spacing", setting.out + "/spacing", "xy");
  const auto& rows = spacing.results().rows;
  summary.check_at_most("finest_energy_of_the_drop_over_coarsest",
                        rows.back().error("energy of the drop")->value /
                            rows.front().error("energy of the drop")->value,
                        0.8);

  const auto kernel =
      part("SPH: kernel and smoothing", sph::kernels(fine, quick), setting, "kernel", summary);
  draw_periods(kernel, setting.out + "/period");
  // A stiff lattice carries waves too fast.
  summary.check_at_least("period_at_smoothing_0.9_over_1.2",
                         error_of(kernel, "Wendland, 0.9", "period of the wave") /
                             error_of(kernel, "Wendland, 1.2", "period of the wave"),
                         1.5);

  const auto time =
      part("SPH: time integration", sph::time_steps(fine, quick), setting, "time", summary);
  summary.check_at_most("axes_of_the_drop_leapfrog_0.6",
                        error_of(time, "leapfrog, 0.6", "axes of the drop"), quick ? 4 : 1.5);
  const auto diffusion =
      part("SPH: diffusion", sph::diffusions(fine, quick), setting, "diffusion", summary);
  // Molteni's term changes the liquid near its surface permanently.
  summary.check_at_least("speed_at_rest_by_Molteni_over_Fourtakas",
                         error_of(diffusion, "Molteni, 0.1", "speed at rest") /
                             error_of(diffusion, "Fourtakas, 0.1", "speed at rest"),
                         1);
  const auto shifting =
      part("SPH: shifting", sph::shifts(fine, quick), setting, "shifting", summary);
  const auto sound =
      part("SPH: sound and alpha", sph::sounds(fine, quick), setting, "sound", summary);
  summary.check_at_least("energy_of_the_drop_alpha_0.1_over_0.02",
                         error_of(sound, "c = 10 v, alpha = 0.1", "energy of the drop") /
                             error_of(sound, "c = 10 v", "energy of the drop"),
                         1.5);

  silt::Study exchange("SPH beside grains: a box that heaves, grains' steps over the liquid's");
  exchange.reference("1/32", sph::box_with_step(1.0 / 32, quick));
  for (const double step : {0.125, 0.5, 1.0, 2.0, 4.0, 8.0})
    exchange.variant(silt::text(step), sph::box_with_step(step, quick));
  exchange.accept("error of heave", 0.02);
  studies::run_and_report(exchange, setting, "exchange");
  studies::add_recommendation(summary, "exchange", exchange);
  summary.check_at_most("heave_with_equal_steps", error_of(exchange, "1", "error of heave"), 0.05);
}

const studies::Registered here{
    "sph", "SPH: spacing, kernel, time integration, diffusion, shifting, sound, on closed forms",
    run};

}  // namespace

}  // namespace sph_study
