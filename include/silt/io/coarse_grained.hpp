// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <optional>
#include <string>
#include <utility>

#include <silt/files/vtk.hpp>
#include <silt/io/contact_series.hpp>
#include <silt/measure/coarse_fields.hpp>

namespace silt::inline SILT_TARGET {

/// Output of coarse_grained() during a run: means over some samples.
struct CoarseOutput {
  std::string folder = {};  // of coarse.pvd and its .vti files; empty: only fields() are kept
  int samples = 1;          // number of samples per file
};

/// See coarse_grained().
template <class Kernel>
class CoarseGrained {
 public:
  static constexpr bool reads_contacts = true, reads_forces_alone = true;
  CoarseGrained(const CoarseGrid& grid, const Kernel& kernel, Schedule schedule,
                CoarseOutput output)
      : fields_(grid, kernel), schedule_(schedule), output_(std::move(output)) {
    require(output_.samples > 0, "CoarseOutput.samples = ", output_.samples,
            " [-] must be at least 1");
  }

  const CoarseFields<Kernel>& fields() const { return fields_; }
  void clear() { fields_.clear(); }

  template <class Sim>
  void begin(const Sim& sim, double) {
    schedule_.begin(sim);
    if (series_ || output_.folder.empty()) return;
    series_ =
        sim.continues(output_.folder + "/coarse.pvd")
            ? VtkSeries::resume(output_.folder, "coarse", sim.time() + 0.5 * sim.step_length())
            : VtkSeries(output_.folder, "coarse");
  }
  template <class Sim>
  bool is_due(const Sim& sim) const {
    return schedule_.is_due(sim) && !sim.awaits_contacts();
  }
  template <class Sim>
  void operator()(const Sim& sim) {
    fields_.add_recorded(sim);
    schedule_.mark(sim);
    if (!series_ || fields_.samples() < static_cast<std::size_t>(output_.samples)) return;
    const auto file = detail::file_of_step("coarse", sim.step(), ".vti");
    fields_.write_vti(text(output_.folder, '/', file));
    series_->add(sim.time(), file);
    fields_.clear();
  }

 private:
  CoarseFields<Kernel> fields_;
  Schedule schedule_;
  CoarseOutput output_;
  std::optional<VtkSeries> series_;
};

/// Observer that samples the coarse-grained fields (CoarseFields) at the times of its schedule and
/// averages them:
///
///   auto flow = silt::coarse_grained(silt::CoarseGrid{box, {40, 1, 60}},
///                                    silt::GaussianKernel{.width = 2e-3}, silt::every(1e-3));
///   sim.run(1.0, flow);
///   flow.fields().write_vti("flow.vti");
///
/// With a CoarseOutput it writes the mean of every `samples` samples and starts a new mean.
/// Errors: InputError for an invalid grid or kernel, or samples = 0.
template <class Kernel>
CoarseGrained<Kernel> coarse_grained(const CoarseGrid& grid, const Kernel& kernel,
                                     Schedule schedule, CoarseOutput output = {}) {
  return {grid, kernel, schedule, std::move(output)};
}

}  // namespace silt
