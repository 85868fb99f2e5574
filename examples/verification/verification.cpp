// silt - BSD-3-Clause, see LICENSE
// The verification gallery (docs/verification.md): silt against closed forms, kinetic theory and
// published benchmarks; one check, one table and one picture for each case.

#include <cstdio>
#include <string>
#include <utility>

#include <silt/files/atomic_file.hpp>

#include "verification/gallery.hpp"

namespace {

constexpr std::pair<const char*, void (*)(verification::Gallery&)> cases[] = {
    {"head-on impacts", verification::normal_impacts_of_chung_and_ooi},
    {"restitution over the time step", verification::restitution_and_steps},
    {"size ratios", verification::size_ratios},
    {"softened moduli", verification::softened_moduli},
    {"alumina on glass", verification::alumina_on_glass},
    {"oblique impacts", verification::oblique_impacts_of_chung_and_ooi},
    {"spinning spheres", verification::spinning_impacts_of_chung_and_ooi},
    {"slopes", verification::slopes},
    {"slip to roll", verification::from_slip_to_roll},
    {"JKR contact", verification::jkr_contact},
    {"a cooling gas", verification::cooling_gas},
};

int show(const example::Options& options) {
  const example::Stopwatch whole;
  silt::make_folder(options.out);
  verification::Gallery gallery{
      .folder = options.out, .quick = options.quick, .threads = options.threads};
  gallery.summary.input("quick", options.quick);
  gallery.summary.input("threads", static_cast<double>(options.threads));
  for (const auto& [name, run] : cases) {
    const example::Stopwatch clock;
    run(gallery);
    std::printf("%-32s %6.1f s\n", name, clock.seconds());
    std::fflush(stdout);
  }
  gallery.summary.result("wall_time_s", whole.seconds());
  gallery.summary.write(options.out + "/summary.json");
  const bool drawn = example::run_script(SILT_GALLERY_SCRIPT, {options.out});
  gallery.summary.print_checks();
  std::printf("Look at: %s/*.png, *.csv, summary.json (%.0f s)\n", options.out.c_str(),
              whole.seconds());
  if (!drawn) std::printf("(no pictures: they need Python 3 with numpy and matplotlib)\n");
  return gallery.summary.all_hold() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  example::Command command("silt against closed forms and published benchmarks of DEM",
                           example::Kind::Cases, "out/verification");
  return command.run(argc, argv, [&] { return show(command.options); });
}
