// silt - BSD-3-Clause, see LICENSE
//
// Economies of a jet mill: effect of each on the cost of the mill, alone and when only it is left
// out, and its error. After T. Brosh, H. Kalman, A. Levy, Particuology 12 (2014) 113, who report a
// factor of 17 for all but the last, and another 18 for dust that is not simulated.
//
// The slow end is timed over some steps of the running mill and scaled to a millisecond.

#include "study/comminution.hpp"

#include <cstdio>
#include <optional>

#include "study/studies.hpp"

namespace comminution_study {

namespace {

using jet_mill::Law;

/// Hertz-Mindlin with a dashpot for the mean mass of the two grains, as some codes use.
struct MeanMassHertz : silt::HertzMindlin {
  template <class Real>
  static SILT_INLINE silt::Traction<Real> force(const silt::Contact<Real>& c,
                                                const Coefficients<Real>& p, History<Real>& h) {
    using silt::select;
    using std::sqrt;
    const Real a = c.radius_i * c.radius_i * c.radius_i, b = c.radius_j * c.radius_j * c.radius_j;
    Coefficients<Real> wrong = p;
    // (m1 + m2)/2 over m1 m2/(m1 + m2); walls keep their own.
    const Real product = select(b > Real(0), a * b, Real(1));
    const Real over = select(b > Real(0), (a + b) * (a + b) / (Real(2) * product), Real(1));
    wrong.normal_damping = p.normal_damping * sqrt(over);
    return silt::HertzMindlin::force(c, wrong, h);
  }
};
using WrongLaw = silt::Softened<MeanMassHertz>;

struct Row {
  std::string name;
  std::optional<double> alone, without;          // [s] a millisecond: none but this, all but this
  std::optional<double> sizes, product, broken;  // [-] all against all but this
};
/// A dust limit: products of feeds of several seeds from an empty mill, summed, and the final state
/// of the mill for the first seed.
struct Dust {
  Dust(double diameter, const State& start) : below(diameter), running(start) {}
  double below;  // [m]
  State running;
  Outcome found;
  double cost = 0;  // [s] a millisecond, all other economies
};

class Study {
 public:
  explicit Study(const studies::Setting& setting) : setting_(setting) {
    base_.rate = 1e-3;  // soon full
    base_.most_fragments = 400;
    base_.exponent = 0.6;  // dust is too strong for this mill
    all_ = {.steps = 0, .softened = 45e-6, .dust = 60e-6};
  }

  void run(example::Summary& summary) {
    begin();
    costs();
    errors();
    report(summary);
  }

 private:
  static silt::VerletList<silt::HashedGrid> list() { return {}; }
  static void say(const std::string& what) { std::fprintf(stderr, "%s\n", what.c_str()); }
  template <class Change>
  static Way with(Way way, const Change& change) {
    change(way);
    return way;
  }

  /// The mill from empty to running, with every dust limit, the finest first.
  void begin() {
    const double start = setting_.quick ? 2.5e-3 : 5e-3;  // [s]
    const State empty{{}, jet_mill::air(base_)};
    for (const double below : {Way{}.dust, 30e-6, 40e-6, all_.dust}) {
      Dust& dust = dusts_.emplace_back(below, empty);
      for (std::size_t seed = 1; seed <= (setting_.quick ? 1u : 4u); ++seed) {
        Scene scene = base_;
        scene.seed = seed;
        const Way way = with(all_, [&](Way& w) { w.dust = below; });
        dust.found.add(found<Law, false>(empty, scene, way, start, list(),
                                         seed == 1 ? &dust.running : nullptr));
      }
      dust.cost = fast(with(all_, [&](Way& w) { w.dust = below; }));
      say(silt::text("the mill has run with dust below ", 1e6 * below,
                     " um: ", dust.running.grains.size(), " grains"));
    }
  }
  const State& running(const Way& way) const {
    for (const Dust& dust : dusts_)
      if (dust.below == way.dust) return dust.running;
    throw silt::Error("no mill has run with this dust");
  }

  double seconds() const { return setting_.quick ? 0.3 : 4; }
  /// No economies except those in `way` and `search`; starts with fine grains, if they are not
  /// dust.
  double alone(const Way& way, Search search = Search::FullMesh) const {
    return direct_cost(running(way), base_, way, seconds(), search);
  }
  /// All economies except those missing in `way`.
  double fast(const Way& way) const {
    return way.followed ? cost_of<Law, true>(running(way), base_, way, seconds(), list())
                        : cost_of<Law, false>(running(way), base_, way, seconds(), list());
  }
  Outcome found_by(const Way& way) const {
    return way.followed ? found<Law, true>(running(way), base_, way, duration(), list())
                        : found<Law, false>(running(way), base_, way, duration(), list());
  }
  double duration() const { return setting_.quick ? 2e-4 : 4e-3; }  // [s] of errors

  void costs() {
    say("costs");
    const Way none;
    none_cost_ = alone(none), all_cost_ = dusts_.back().cost, fine_cost_ = dusts_.front().cost;
    const auto add = [&](const char* name, std::optional<double> one,
                         std::optional<double> others) {
      rows_.push_back({name, one, others, {}, {}, {}});
      say(name);
    };
    add("hashed grid", alone(none, Search::HashedGrid), {});
    add("sub-grid for fines", alone(none, Search::SubGrid), {});
    add("half stencil, edge proximity", alone(none, Search::HalfStencil), {});
    add("list of neighbours", {},
        direct_cost(running(all_), base_, all_, seconds(), Search::FullMesh));
    add("fluid steps apart", alone(with(none, [](Way& w) { w.steps = 100; })),
        fast(with(all_, [](Way& w) { w.steps = 1; })));
    add("held drag", {}, fast(with(all_, [](Way& w) { w.followed = true; })));
    const auto lazy = [](Way& w) { w.followed = true, w.cell = 0.5e-3, w.tolerance = 0.02; };
    add("lazy drag on cells, not held", alone(with(none, lazy)), fast(with(all_, lazy)));
    add("softened fines", alone(with(none, [&](Way& w) { w.softened = all_.softened; })),
        fast(with(all_, [](Way& w) { w.softened = 0; })));
    add("right dashpot", {},
        cost_of<WrongLaw, false>(running(all_), base_, all_, seconds(), list()));
    add("dust", alone(with(none, [&](Way& w) { w.dust = all_.dust; })), fine_cost_);
  }

  /// The same start, continued with all economies, and with all but one.
  void errors() {
    say("errors: all economies");
    all_found_ = found_by(all_);
    const auto compare = [&](const std::string& name, const Outcome& one,
                             const Outcome& reference) {
      say("errors: " + name);
      for (Row& row : rows_)
        if (row.name == name) {
          row.sizes = one.off(reference), row.product = one.product_off(reference);
          row.broken = one.broken / reference.broken - 1;
        }
    };
    rows_.push_back({"gravity 1e-9 more (control)", {}, {}, {}, {}, {}});
    compare(rows_.back().name, all_found_,
            found_by(with(all_, [](Way& w) { w.gravity *= 1 + 1e-9; })));
    compare("fluid steps apart", all_found_, found_by(with(all_, [](Way& w) { w.steps = 20; })));
    const Outcome followed = found_by(with(all_, [](Way& w) { w.followed = true; }));
    compare("held drag", all_found_, followed);
    compare("lazy drag on cells, not held",
            found_by(
                with(all_, [](Way& w) { w.followed = true, w.cell = 0.5e-3, w.tolerance = 0.02; })),
            followed);
    compare("softened fines", all_found_, found_by(with(all_, [](Way& w) { w.softened = 0; })));
    compare("right dashpot", all_found_,
            found<WrongLaw, false>(running(all_), base_, all_, duration(), list()));
    compare("dust", dusts_.back().found, dusts_.front().found);
  }

  void print(std::FILE* out) const;
  void report(example::Summary& summary) const;

  studies::Setting setting_;
  Scene base_;
  Way all_;
  std::vector<Dust> dusts_;
  double none_cost_ = 0, all_cost_ = 0, fine_cost_ = 0;
  Outcome all_found_;
  std::vector<Row> rows_;
};

/// The table, as text in `out`.
void Study::print(std::FILE* out) const {
  const auto column = [out](int width, const std::optional<double>& value) {
    value ? std::fprintf(out, "%*.3g", width, *value) : std::fprintf(out, "%*s", width, "-");
  };
  std::fprintf(out, "%-30s%10s%8s%10s%8s%9s%9s%9s\n", "economy", "alone", "factor", "all but",
               "factor", "sizes", "product", "broken");
  std::fprintf(out, "%-30s%10s%8s%10s%8s\n", "", "[s/ms]", "", "[s/ms]", "");
  for (const Row& row : rows_) {
    std::optional<double> gain, loss;
    if (row.alone) gain = none_cost_ / *row.alone;
    if (row.without) loss = *row.without / all_cost_;
    std::fprintf(out, "%-30s", row.name.c_str());
    column(10, row.alone), column(8, gain), column(10, row.without), column(8, loss);
    column(9, row.sizes), column(9, row.product), column(9, row.broken);
    std::fprintf(out, "\n");
  }
  std::fprintf(out, "%-30s%10s%8s%10s%8s%9s%9s%9s\n", "dust below [um]", "grains", "", "[s/ms]",
               "factor", "sizes", "product", "broken");
  const Dust& finest = dusts_.front();
  for (const Dust& dust : dusts_)
    std::fprintf(out, "%-30.0f%10zu%8s%10.3g%8.3g%9.2g%9.2g%9.2g\n", 1e6 * dust.below,
                 dust.running.grains.size(), "", dust.cost, finest.cost / dust.cost,
                 dust.found.off(finest.found), dust.found.product_off(finest.found),
                 dust.found.broken / finest.found.broken - 1);
  std::fprintf(
      out,
      "s/ms: processor time for a millisecond in the mill. None: %.4g; all but dust: %.3g, "
      "%.0f times as fast; all: %.3g, %.0f times.\n",
      none_cost_, fine_cost_, none_cost_ / fine_cost_, all_cost_, none_cost_ / all_cost_);
}

void Study::report(example::Summary& summary) const {
  print(stdout);
  silt::make_folder(setting_.out);
  const std::string path = setting_.out + "/factors.txt";
  std::FILE* const file = std::fopen(path.c_str(), "w");
  silt::require(file != nullptr, "file '", path, "' cannot be written");
  print(file);
  std::fclose(file);
  summary.input("grains_fine", static_cast<double>(dusts_.front().running.grains.size()));
  summary.input("grains_coarse", static_cast<double>(dusts_.back().running.grains.size()));
  summary.result("none_s_per_ms", none_cost_);
  summary.result("all_but_dust_s_per_ms", fine_cost_);
  summary.result("all_s_per_ms", all_cost_);
  for (const Row& row : rows_) {
    if (row.alone) summary.result("alone_s_per_ms: " + row.name, *row.alone);
    if (row.without) summary.result("all_but_s_per_ms: " + row.name, *row.without);
  }
  summary.check_at_least("factor_without_dust", none_cost_ / fine_cost_, 17);
  summary.check_at_least("factor", none_cost_ / all_cost_, setting_.quick ? 17 : 700);
  for (const Row& row : rows_)
    if (row.sizes) {
      summary.result("sizes_off: " + row.name, *row.sizes);
      summary.result("broken_off: " + row.name, *row.broken);
    }
}

void run(const studies::Setting& setting, example::Summary& summary) {
  Study(setting).run(summary);
}

const studies::Registered here{"comminution", "a jet mill: speed-up and error of each economy",
                               run};

}  // namespace

}  // namespace comminution_study
