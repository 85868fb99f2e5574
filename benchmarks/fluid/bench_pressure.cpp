// silt - BSD-3-Clause, see LICENSE
//
// The pressure solver beside hypre's Struct PCG preconditioned by PFMG, in one process on one core:
// the same systems from p = 0 to |b - A p| / |b| <= 1e-8, repeats interleaved, medians. hypre runs
// with each combination of its relaxations and coarse operators, twice; the first run is a warm-up.
// The combination with the shortest total of set-up and solve counts: in a coupled run coefficients
// change at every step, and both solvers repeat their set-up at each. silt keeps its memory from
// step to step; hypre creates a new solver, as its set-up cannot be repeated. hypre is Debian's,
// compiled for generic machines.
//
//   bench_pressure [--repeats 5] [--quick] [--out DIR] [cells across ...]        default: 64 128
//
// Processor times, not wall-clock times: less disturbed by other load. DIR/summary.json: all
// numbers, and checks that both have solved the same system equally well.
#include <HYPRE_struct_ls.h>
#include <mpi.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include <silt/files/atomic_file.hpp>
#include <silt/fluid/pressure_solver.hpp>

#include "fluid/pressure_cases.hpp"
#include "support/example.hpp"

namespace {

using silt_test::PressureCase;

double seconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Run {
  double setup, solve, residual;  // [s], [s], [-]
  int iterations;
  double all() const { return setup + solve; }
};

double median(std::vector<double> of) {
  std::sort(of.begin(), of.end());
  return of[of.size() / 2];
}

/// |b - A p| / |b|, by the definition.
double residual_of(const PressureCase& a, const silt::CellField& p) {
  double left = 0, whole = 0;
  const auto& g = a.grid;
  a.for_cells([&](int i, int j, int k) {
    double r = a.b(i, j, k) - a.d(i, j, k) * p(i, j, k);
    if (i > 0) r -= a.ax(i, j, k) * (p(i, j, k) - p(i - 1, j, k));
    if (j > 0) r -= a.ay(i, j, k) * (p(i, j, k) - p(i, j - 1, k));
    if (k > 0) r -= a.az(i, j, k) * (p(i, j, k) - p(i, j, k - 1));
    if (i + 1 < g.nx()) r -= a.ax(i + 1, j, k) * (p(i, j, k) - p(i + 1, j, k));
    if (j + 1 < g.ny()) r -= a.ay(i, j + 1, k) * (p(i, j, k) - p(i, j + 1, k));
    if (k + 1 < g.nz()) r -= a.az(i, j, k + 1) * (p(i, j, k) - p(i, j, k + 1));
    left += r * r;
    whole += a.b(i, j, k) * a.b(i, j, k);
  });
  return std::sqrt(left / whole);
}

class Hypre {
 public:
  Hypre(const PressureCase& from, int relax, int rap, int skip)
      : case_(from), relax_(relax), rap_(rap), skip_(skip) {
    int low[3] = {0, 0, 0}, high[3] = {from.grid.nx() - 1, from.grid.ny() - 1, from.grid.nz() - 1};
    HYPRE_StructGridCreate(MPI_COMM_WORLD, 3, &grid_);
    HYPRE_StructGridSetExtents(grid_, low, high);
    HYPRE_StructGridAssemble(grid_);
    int offsets[4][3] = {{0, 0, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
    HYPRE_StructStencilCreate(3, 4, &stencil_);
    for (int s = 0; s < 4; ++s) HYPRE_StructStencilSetElement(stencil_, s, offsets[s]);
    HYPRE_StructMatrixCreate(MPI_COMM_WORLD, grid_, stencil_, &A_);
    HYPRE_StructMatrixSetSymmetric(A_, 1);
    HYPRE_StructMatrixInitialize(A_);
    std::vector<double> values, right, zero(from.grid.size(), 0.0);
    const auto& g = from.grid;
    from.for_cells([&](int i, int j, int k) {
      const double x = i > 0 ? from.ax(i, j, k) : 0, y = j > 0 ? from.ay(i, j, k) : 0,
                   z = k > 0 ? from.az(i, j, k) : 0;
      double diagonal = x + y + z + from.d(i, j, k);
      if (i + 1 < g.nx()) diagonal += from.ax(i + 1, j, k);
      if (j + 1 < g.ny()) diagonal += from.ay(i, j + 1, k);
      if (k + 1 < g.nz()) diagonal += from.az(i, j, k + 1);
      for (const double v : {diagonal > 0 ? diagonal : 1.0, -x, -y, -z}) values.push_back(v);
      right.push_back(from.b(i, j, k));
    });
    int entries[4] = {0, 1, 2, 3};
    HYPRE_StructMatrixSetBoxValues(A_, low, high, 4, entries, values.data());
    HYPRE_StructMatrixAssemble(A_);
    for (auto* v : {&b_, &x_}) {
      HYPRE_StructVectorCreate(MPI_COMM_WORLD, grid_, v);
      HYPRE_StructVectorInitialize(*v);
    }
    HYPRE_StructVectorSetBoxValues(b_, low, high, right.data());
    HYPRE_StructVectorAssemble(b_);
    HYPRE_StructVectorSetBoxValues(x_, low, high, zero.data());
    HYPRE_StructVectorAssemble(x_);
  }
  Hypre(const Hypre&) = delete;
  ~Hypre() {
    HYPRE_StructVectorDestroy(x_);
    HYPRE_StructVectorDestroy(b_);
    HYPRE_StructMatrixDestroy(A_);
    HYPRE_StructStencilDestroy(stencil_);
    HYPRE_StructGridDestroy(grid_);
  }

  Run run() {
    HYPRE_StructSolver pcg, pfmg;
    const double start = seconds();
    HYPRE_StructVectorSetConstantValues(x_, 0.0);
    HYPRE_StructPFMGCreate(MPI_COMM_WORLD, &pfmg);
    HYPRE_StructPFMGSetMaxIter(pfmg, 1);
    HYPRE_StructPFMGSetTol(pfmg, 0.0);
    HYPRE_StructPFMGSetZeroGuess(pfmg);
    HYPRE_StructPFMGSetRelaxType(pfmg, relax_);
    HYPRE_StructPFMGSetRAPType(pfmg, rap_);
    HYPRE_StructPFMGSetSkipRelax(pfmg, skip_);
    HYPRE_StructPFMGSetNumPreRelax(pfmg, 1);
    HYPRE_StructPFMGSetNumPostRelax(pfmg, 1);
    HYPRE_StructPCGCreate(MPI_COMM_WORLD, &pcg);
    HYPRE_StructPCGSetTol(pcg, 1e-8);
    HYPRE_StructPCGSetMaxIter(pcg, 300);
    HYPRE_StructPCGSetTwoNorm(pcg, 1);
    HYPRE_StructPCGSetPrecond(pcg, HYPRE_StructPFMGSolve, HYPRE_StructPFMGSetup, pfmg);
    HYPRE_StructPCGSetup(pcg, A_, b_, x_);
    const double set_up = seconds();
    HYPRE_StructPCGSolve(pcg, A_, b_, x_);
    const double solved = seconds();
    Run result{set_up - start, solved - set_up, 0, 0};
    HYPRE_StructPCGGetNumIterations(pcg, &result.iterations);
    HYPRE_StructPCGDestroy(pcg);
    HYPRE_StructPFMGDestroy(pfmg);
    result.residual = residual_of(case_, solution());
    return result;
  }

  silt::CellField solution() const {
    silt::CellField p(case_.grid);
    case_.for_cells([&](int i, int j, int k) {
      int at[3] = {i, j, k};
      HYPRE_StructVectorGetValues(x_, at, &p(i, j, k));
    });
    return p;
  }

 private:
  const PressureCase& case_;
  int relax_, rap_, skip_;
  HYPRE_StructGrid grid_;
  HYPRE_StructStencil stencil_;
  HYPRE_StructMatrix A_;
  HYPRE_StructVector b_, x_;
};

/// Largest difference of the gradients over faces of open cells, over the largest gradient: the
/// pressure itself may be undetermined by a constant.
double difference(const PressureCase& of, const silt::CellField& p, const silt::CellField& q) {
  double most = 0, largest = 0;
  const auto face = [&](double a, double dp, double dq) {
    if (a <= 0) return;
    most = std::max(most, std::abs(a * (dp - dq)));
    largest = std::max(largest, std::abs(a * dp));
  };
  of.for_cells([&](int i, int j, int k) {
    const double u = p(i, j, k), v = q(i, j, k);
    if (i > 0) face(of.ax(i, j, k), u - p(i - 1, j, k), v - q(i - 1, j, k));
    if (j > 0) face(of.ay(i, j, k), u - p(i, j - 1, k), v - q(i, j - 1, k));
    if (k > 0) face(of.az(i, j, k), u - p(i, j, k - 1), v - q(i, j, k - 1));
  });
  return most / largest;
}

struct Choice {
  int relax, rap, skip;
  double time;
};

/// The fastest combination: Jacobi, red-black Gauss-Seidel (symmetric); Galerkin or not; levels
/// skipped or not.
Choice fastest(const PressureCase& of) {
  Choice best{1, 0, 0, 1e30};
  for (const int relax : {1, 2})
    for (const int rap : {0, 1})
      for (const int skip : {0, 1}) {
        Hypre hypre(of, relax, rap, skip);
        hypre.run();
        const Run run = hypre.run();
        if (run.residual < 2e-8 && run.all() < best.time) best = {relax, rap, skip, run.all()};
      }
  return best;
}

void compare(example::Summary& summary, char name, int n, std::size_t repeats) {
  const silt::Team team(1);
  const PressureCase of = silt_test::pressure_case(name, n);
  silt::PressureSolver own(of.grid);
  silt::CellField p(of.grid);
  own.set(of.ax, of.ay, of.az, of.d, team);  // memory and open faces known, as in a run
  const Choice best = fastest(of);
  Hypre hypre(of, best.relax, best.rap, best.skip);
  std::vector<double> ours_solve, ours_all, its_solve, its_all, ratio;
  Run last{};
  silt::PressureSolution ours;
  for (std::size_t repeat = 0; repeat < repeats; ++repeat) {
    const double start = seconds();
    own.set(of.ax, of.ay, of.az, of.d, team);
    p.fill(0);
    const double set = seconds();
    ours = own.solve(of.b, p, {.relative = 1e-8, .most_iterations = 200}, team);
    const double end = seconds();
    last = hypre.run();
    ours_solve.push_back(end - set), ours_all.push_back(end - start);
    its_solve.push_back(last.solve), its_all.push_back(last.all());
    ratio.push_back(its_all.back() / ours_all.back());
  }
  const auto [least, most] = std::minmax_element(ratio.begin(), ratio.end());
  const double residual = residual_of(of, p), apart = difference(of, p, hypre.solution());
  std::printf(
      "%c %d^3  silt %.4f (solve %.4f) %d, %.1e   PFMG %.4f (solve %.4f) %d, %.1e "
      "[relax %d rap %d skip %d]   PFMG / silt %.1f (%.1f to %.1f)\n",
      name, n, median(ours_all), median(ours_solve), ours.iterations, residual, median(its_all),
      median(its_solve), last.iterations, last.residual, best.relax, best.rap, best.skip,
      median(ratio), *least, *most);
  std::fflush(stdout);
  const std::string key = silt::text(name, "_", n);
  summary.result(key + "_silt_s", median(ours_all));
  summary.result(key + "_silt_solve_s", median(ours_solve));
  summary.result(key + "_pfmg_s", median(its_all));
  summary.result(key + "_pfmg_solve_s", median(its_solve));
  summary.result(key + "_pfmg_over_silt", median(ratio));
  summary.result(key + "_pfmg_over_silt_least", *least);
  summary.result(key + "_pfmg_over_silt_most", *most);
  summary.check_at_most(key + "_silt_residual", residual, 1.01e-8);
  summary.check_at_most(key + "_pfmg_residual", last.residual, 2e-8);
  summary.check_at_most(key + "_flows_apart", apart, 1e-5);
}

int run(const example::Options& options, std::vector<std::size_t> sizes, std::size_t repeats) {
  silt::make_folder(options.out);
  if (sizes.empty())
    sizes = options.quick ? std::vector<std::size_t>{16} : std::vector<std::size_t>{64, 128};
  if (options.quick) repeats = std::min<std::size_t>(repeats, 3);
  example::Summary summary;
  summary.input("quick", options.quick);
  summary.input("repeats", static_cast<double>(repeats));
  std::printf(
      "%s\nseconds to 1e-8 from zero, one core, medians of %zu: set-up and solve (solve alone) "
      "iterations, |b - A p| / |b|\n",
      example::processor().c_str(), repeats);
  for (const std::size_t n : sizes)
    for (const char name : {'C', 'B', 'D', 'P'})
      compare(summary, name, static_cast<int>(n), repeats);
  summary.write(options.out + "/summary.json");
  summary.print_checks();
  std::printf("Look at: %s/summary.json\n", options.out.c_str());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  example::Command command("The pressure solver beside hypre's PFMG", example::Kind::Study,
                           "out/bench-fluid/pressure");
  std::vector<std::size_t> sizes;
  std::size_t repeats = 5;
  command.add("cells", sizes, 8, 512, "Cells across; default 64 128, with --quick 16");
  command.add("--repeats", repeats, 1, 1000, "Of each, interleaved");
  const int status = command.run(argc, argv, [&] { return run(command.options, sizes, repeats); });
  MPI_Finalize();
  return status;
}
