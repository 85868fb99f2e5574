// silt - BSD-3-Clause, see LICENSE
//
// Economies of a jet mill: what each makes the mill cost, alone and when only it is left out, and
// what error it brings. After T. Brosh, H. Kalman, A. Levy, Particuology 12 (2014) 113, who report
// a factor of 17 for all but the last, and another 18 for dust that is not simulated.
//
// The slow end is timed over some steps of the running mill and scaled to a millisecond.

#include "study/comminution.hpp"

#include <cstdio>
#include <optional>

#include <silt/files/csv_table.hpp>

#include "study/studies.hpp"

namespace comminution_study {

namespace {

using jet_mill::Law;

/// Hertz and Mindlin with a dashpot made for the mean mass of the two grains, as codes have had it.
struct MeanMassHertz : silt::HertzMindlin {
  static constexpr bool needs_radii = true;
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
  std::optional<double> alone, without;          // [s] a millisecond
  std::optional<double> sizes, product, broken;  // [-] errors of all economies against all but this
};

double seconds_of(const studies::Setting& setting) { return setting.quick ? 0.3 : 4; }

class Study {
 public:
  explicit Study(const studies::Setting& setting) : setting_(setting) {
    base_.rate = 1e-3;  // soon full
    base_.most_fragments = 400;
    all_ = {.cell = 0.5e-3, .tolerance = 0.02, .steps = 0, .softened = 60e-6, .dust = 40e-6};
    fine_ = all_, fine_.dust = none_.dust;
  }

  void run(example::Summary& summary) {
    begin();
    costs();
    errors();
    report(summary);
  }

 private:
  static constexpr auto list = [] { return silt::VerletList<silt::HashedGrid>{}; };

  void say(const std::string& what) const {
    std::printf("%s\n", what.c_str()), std::fflush(stdout);
  }

  /// The mill from empty to running, with two limits of dust.
  void begin() {
    const double start = setting_.quick ? 2.5e-3 : 5e-3;
    State empty{{}, jet_mill::air(base_)};
    say("the mill starts");
    found<Law>(empty, base_, all_, start, list(), &coarse_start_.emplace(empty));
    Outcome fine = found<Law>(empty, base_, fine_, start, list(), &fine_start_.emplace(empty));
    say(silt::text("  grains: ", coarse_start_->grains.size(), " of ", 1e6 * all_.dust,
                   " um and more, ", fine_start_->grains.size(), " of ", 1e6 * fine_.dust, " um"));
    (void)fine;
  }

  double slow(const Way& way, Search search, bool fine = true) const {
    return direct_cost(fine ? *fine_start_ : *coarse_start_, base_, way, seconds_of(setting_),
                       search);
  }
  double fast(const Way& way, bool fine = false) const {
    return cost_of<Law>(fine ? *fine_start_ : *coarse_start_, base_, way, seconds_of(setting_),
                        list());
  }

  void costs() {
    say("costs");
    none_cost_ = slow(none_, Search::FullMesh);
    all_cost_ = fast(all_);
    fine_cost_ = fast(fine_, true);
    const auto with = [](Way way, auto change) { return change(way), way; };
    const auto direct = [&](Search s) {
      return direct_cost(*coarse_start_, base_, all_, seconds_of(setting_), s);
    };
    rows_.push_back({"hashed grid", slow(none_, Search::HashedGrid), {}, {}, {}, {}});
    rows_.push_back({"sub-grid for fines", slow(none_, Search::SubGrid), {}, {}, {}, {}});
    rows_.push_back(
        {"half stencil, edge proximity", slow(none_, Search::HalfStencil), {}, {}, {}, {}});
    rows_.push_back({"list of neighbours (silt)",
                     slow(none_, Search::VerletList),
                     direct(Search::FullMesh),
                     {},
                     {},
                     {}});
    rows_.push_back({"fluid steps apart, values on cells",
                     slow(with(none_, [&](Way& w) { w.steps = apart(), w.cell = all_.cell; }),
                          Search::FullMesh),
                     fast(with(all_, [](Way& w) { w.steps = 1, w.cell = 0; })),
                     {},
                     {},
                     {}});
    rows_.push_back(
        {"lazy drag",
         slow(with(none_, [&](Way& w) { w.tolerance = all_.tolerance; }), Search::FullMesh),
         fast(with(all_, [](Way& w) { w.tolerance = 0; })),
         {},
         {},
         {}});
    rows_.push_back(
        {"softened fines",
         slow(with(none_, [&](Way& w) { w.softened = all_.softened; }), Search::FullMesh),
         fast(with(all_, [](Way& w) { w.softened = 0; })),
         {},
         {},
         {}});
    rows_.push_back({"right dashpot",
                     {},
                     cost_of<WrongLaw>(*coarse_start_, base_, all_, seconds_of(setting_), list()),
                     {},
                     {},
                     {}});
    rows_.push_back(
        {"dust",
         slow(with(none_, [&](Way& w) { w.dust = all_.dust; }), Search::FullMesh, false),
         fine_cost_,
         {},
         {},
         {}});
  }
  int apart() const { return 100; }

  /// The same start, run on with all economies, and with all but one.
  void errors() {
    const double duration = setting_.quick ? 2e-4 : 2e-3;
    say("errors: all economies");
    const State& from = *coarse_start_;
    all_found_ = found<Law>(from, base_, all_, duration, list());
    const auto compare = [&](const std::string& name, const Outcome& reference) {
      say("errors: without " + name);
      for (Row& row : rows_)
        if (row.name == name) {
          row.sizes = all_found_.off(reference), row.product = all_found_.product_off(reference);
          row.broken = all_found_.broken / reference.broken - 1;
        }
    };
    Way other = all_;
    other.gravity *= 1 + 1e-9;
    rows_.push_back({"gravity 1e-9 more (control)", {}, {}, {}, {}, {}});
    compare(rows_.back().name, found<Law>(from, base_, other, duration, list()));
    other = all_, other.steps = 5, other.cell = 0;
    if (!setting_.quick)
      compare("fluid steps apart, values on cells",
              found<Law>(from, base_, other, duration, list()));
    other = all_, other.tolerance = 0;
    compare("lazy drag", found<Law>(from, base_, other, duration, list()));
    other = all_, other.softened = 0;
    compare("softened fines", found<Law>(from, base_, other, duration, list()));
    compare("right dashpot", found<WrongLaw>(from, base_, all_, duration, list()));
  }

  void report(example::Summary& summary) const;

  studies::Setting setting_;
  Scene base_;
  Way none_, all_, fine_;
  std::optional<State> coarse_start_, fine_start_;
  double none_cost_ = 0, all_cost_ = 0, fine_cost_ = 0;
  Outcome all_found_;
  std::vector<Row> rows_;
};

void Study::report(example::Summary& summary) const {
  const auto cell = [](const std::optional<double>& x) {
    return x ? silt::text(*x) : std::string("-");
  };
  std::printf("%-36s %12s %8s %14s %8s %10s %10s %10s\n", "economy", "alone [s/ms]", "factor",
              "all but [s/ms]", "factor", "sizes", "product", "broken");
  for (const Row& row : rows_) {
    std::optional<double> gain, loss;
    if (row.alone) gain = none_cost_ / *row.alone;
    if (row.without) loss = *row.without / all_cost_;
    std::printf("%-36s %12s %8s %14s %8s %10s %10s %10s\n", row.name.c_str(),
                cell(row.alone).c_str(), cell(gain).c_str(), cell(row.without).c_str(),
                cell(loss).c_str(), cell(row.sizes).c_str(), cell(row.product).c_str(),
                cell(row.broken).c_str());
  }
  std::printf("none %g s/ms, all but dust %g, all %g: factors %.0f and %.0f\n", none_cost_,
              fine_cost_, all_cost_, none_cost_ / fine_cost_, none_cost_ / all_cost_);
  summary.result("factor_without_dust", none_cost_ / fine_cost_);
  summary.result("factor", none_cost_ / all_cost_);
}

void run(const studies::Setting& setting, example::Summary& summary) {
  Study(setting).run(summary);
}

const studies::Registered here{"comminution", "a jet mill: what each economy gains, and its error",
                               run};

}  // namespace

}  // namespace comminution_study
