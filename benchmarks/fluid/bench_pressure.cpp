// silt - BSD-3-Clause, see LICENSE
//
// The pressure solver beside hypre's Struct PCG preconditioned by PFMG, in one process on one core:
// the same systems from p = 0 to |b - A p| / |b| <= 1e-8, repeats interleaved, medians. hypre runs
// with each combination of its relaxations and coarse operators; the fastest counts.
//
//   bench_pressure [repeats [cells across ...]]        default: 5 64 128
//
// Times are of the processor, not of the clock on the wall: other load then disturbs less.
#include <HYPRE_struct_ls.h>
#include <mpi.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include <silt/fluid/pressure_solver.hpp>

#include "fluid/pressure_cases.hpp"

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
};

double median(std::vector<double> of) {
  std::sort(of.begin(), of.end());
  return of[of.size() / 2];
}

/// |b - A p| / |b|, by the definition.
double residual_of(const PressureCase& a, const silt::Field& p) {
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
    silt::Field p(case_.grid);
    case_.for_cells([&](int i, int j, int k) {
      int at[3] = {i, j, k};
      HYPRE_StructVectorGetValues(x_, at, &p(i, j, k));
    });
    result.residual = residual_of(case_, p);
    return result;
  }

 private:
  const PressureCase& case_;
  int relax_, rap_, skip_;
  HYPRE_StructGrid grid_;
  HYPRE_StructStencil stencil_;
  HYPRE_StructMatrix A_;
  HYPRE_StructVector b_, x_;
};

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  const int repeats = argc > 1 ? std::max(1, std::atoi(argv[1])) : 5;
  std::vector<int> sizes;
  for (int a = 2; a < argc; ++a) sizes.push_back(std::atoi(argv[a]));
  if (sizes.empty()) sizes = {64, 128};
  std::printf(
      "seconds to 1e-8 from zero, one core, medians of %d: solve (set-up) iterations, "
      "|b - A p| / |b|\n",
      repeats);
  const silt::Team team(1);
  for (const int n : sizes)
    for (const char name : {'C', 'B', 'D', 'P'}) {
      const PressureCase of = silt_test::pressure_case(name, n);
      silt::PressureSolver own(of.grid);
      silt::Field p(of.grid);
      own.set(of.ax, of.ay, of.az, of.d, team);  // memory and open faces known, as in a run
      // Jacobi, red-black Gauss-Seidel (symmetric); Galerkin or not; levels skipped or not.
      struct Choice {
        int relax, rap, skip;
        double time;
      };
      std::vector<Choice> choices;
      for (const int relax : {1, 2})
        for (const int rap : {0, 1})
          for (const int skip : {0, 1}) {
            Hypre hypre(of, relax, rap, skip);
            const Run run = hypre.run();
            choices.push_back({relax, rap, skip, run.residual < 2e-8 ? run.solve : 1e9});
          }
      const Choice best =
          *std::min_element(choices.begin(), choices.end(),
                            [](const Choice& a, const Choice& b) { return a.time < b.time; });
      Hypre hypre(of, best.relax, best.rap, best.skip);
      std::array<std::vector<double>, 4> times;
      Run last{};
      silt::PressureSolution ours;
      for (int repeat = 0; repeat < repeats; ++repeat) {
        const double start = seconds();
        own.set(of.ax, of.ay, of.az, of.d, team);
        p.fill(0);
        const double set = seconds();
        ours = own.solve(of.b, p, {.relative = 1e-8, .most_iterations = 200}, team);
        times[0].push_back(seconds() - set);
        times[1].push_back(set - start);
        last = hypre.run();
        times[2].push_back(last.solve);
        times[3].push_back(last.setup);
      }
      std::printf(
          "%c %d^3  silt %.4f (%.4f) %d, %.1e   PFMG %.4f (%.4f) %d, %.1e "
          "[relax %d rap %d skip %d]   PFMG / silt %.2f\n",
          name, n, median(times[0]), median(times[1]), ours.iterations, residual_of(of, p),
          median(times[2]), median(times[3]), last.iterations, last.residual, best.relax, best.rap,
          best.skip, median(times[2]) / median(times[0]));
      std::fflush(stdout);
    }
  MPI_Finalize();
}
