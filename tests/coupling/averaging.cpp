// silt - BSD-3-Clause, see LICENSE
#include "coupling/averaging_support.hpp"

namespace averaging_test {

using namespace averaging_test;

namespace {

/// Random places, and those at walls, in corners and on cells' faces.
Cloud cloud_in(const Grid& grid, std::size_t n, std::uint64_t seed) {
  Cloud cloud = random_cloud(grid.box(), n, 1, seed);
  const Vec3d &a = grid.box().min, &b = grid.box().max;
  for (int c = 0; c < 8; ++c) {
    cloud.position.push_back({c & 1 ? a.x : b.x, c & 2 ? a.y : b.y, c & 4 ? a.z : b.z});
    cloud.radius.push_back(0.5);
  }
  cloud.position.push_back(grid.centre(0, 0, 0));
  cloud.position.push_back(grid.centre(0, 0, 0) + grid.h() * 0.5);
  cloud.radius.insert(cloud.radius.end(), 2, 0.5);
  return cloud;
}

}  // namespace

TEST_CASE("averaging: every mode gives the particles' volume to open cells, to rounding") {
  for (const Room& room : rooms())
    for_modes(false, [&](const char* name, const auto& mode) {
      CAPTURE(room.name);
      CAPTURE(name);
      typename std::decay_t<decltype(mode)>::Averaging op(mode, room.grid, 1);
      furnish(op, room);
      const Cloud cloud = cloud_in(room.grid, 200, 3);
      op.place(cloud.seen());
      CHECK(op.report().particles == cloud.position.size());
      CHECK(op.report().outside == 0);
      const CellField solids = spread(op, {cloud.volumes()})[0];
      // Each weight is normalised with some 1e-16 n of n cells.
      CHECK(near_relative(silt::total(solids), sum_of(cloud.volumes()), 2e-14));
      const CellField open = room.blocked ? room.open() : CellField(room.grid, 1);
      double least = 0, in_blocked = 0;
      for (int k = 0; k < room.grid.nz(); ++k)
        for (int j = 0; j < room.grid.ny(); ++j)
          for (int i = 0; i < room.grid.nx(); ++i) {
            least = std::min(least, solids(i, j, k));
            if (open(i, j, k) == 0) in_blocked += std::abs(solids(i, j, k));
          }
      CHECK(least >= -1e-15);  // periodic lines are closed by a difference
      CHECK(in_blocked == 0);
    });
}

TEST_CASE("averaging: gather is the adjoint of spread, and keeps constants, in every mode") {
  for (const Room& room : rooms())
    for_modes(false, [&](const char* name, const auto& mode) {
      CAPTURE(room.name);
      CAPTURE(name);
      typename std::decay_t<decltype(mode)>::Averaging op(mode, room.grid, 1);
      furnish(op, room);
      const Cloud cloud = cloud_in(room.grid, 100, 4);
      op.place(cloud.seen());
      const std::size_t n = cloud.position.size();
      silt::Random random(5);
      Columns q(6, std::vector<double>(n));  // more than a block of fields
      for (auto& column : q)
        for (double& v : column) v = random.uniform(-1, 1);
      std::vector<CellField> f;
      for (std::uint64_t m = 0; m < q.size(); ++m) f.push_back(random_field(room.grid, 10 + m));
      f.back().fill(3.25);
      // What blocked cells and ghosts hold must not be seen.
      if (room.blocked) {
        const CellField open = room.open();
        for (int i = 0; i < room.grid.nx(); ++i)
          if (open(i, 0, 0) == 0) f[0](i, 0, 0) = std::nan("");
      }
      for (int m = 0; m < 2; ++m) {
        f[1](-1 - m, 0, 0) = std::nan("");
        f[1](room.grid.nx() + m, 0, 0) = std::nan("");
      }
      const std::vector<CellField> spread_q = spread(op, q);
      const Columns gathered = gather(op, f, n);
      for (std::size_t m = 0; m < q.size(); ++m) {
        double on_particles = 0, size = 0;
        for (std::size_t p = 0; p < n; ++p) {
          on_particles += q[m][p] * gathered[m][p];
          size += std::abs(q[m][p]);
        }
        if (room.blocked && m == 0) {
          CellField clean = f[0];
          for (int i = 0; i < room.grid.nx(); ++i)
            if (std::isnan(clean(i, 0, 0))) clean(i, 0, 0) = 0;
          CHECK(std::abs(dot(spread_q[m], clean) - on_particles) <= 1e-13 * size);
        } else {
          CHECK(std::abs(dot(spread_q[m], f[m]) - on_particles) <= 1e-13 * size);
        }
      }
      for (const double v : gathered.back()) CHECK(near_relative(v, 3.25, 1e-13));
    });
}

TEST_CASE("averaging: linear fields are gathered as symmetry has it, away from walls") {
  // Exact: the share of the sphere's parts has their centroid at the cells' centres alone; hats and
  // what is made from them are exact everywhere; stencils that are symmetric to the particle at
  // cells' centres, faces and edges.
  const Grid grid({{0, 0, 0}, {24, 24, 24}}, {24, 24, 24});
  CellField x(grid);
  const auto value = [](const Vec3d& at) { return 2 * at.x - 3 * at.y + 0.5 * at.z; };
  for (int k = 0; k < 24; ++k)
    for (int j = 0; j < 24; ++j)
      for (int i = 0; i < 24; ++i) x(i, j, k) = value(grid.centre(i, j, k));
  Cloud symmetric, any = random_cloud({{11, 11, 11}, {13, 13, 13}}, 200, 1, 2);
  for (int c = 0; c < 8; ++c)
    symmetric.position.push_back(
        {12 + 0.5 * (c & 1), 12 + 0.5 * (c >> 1 & 1), 12 + 0.5 * (c >> 2)});
  symmetric.radius.assign(8, 0.5);
  const auto worst = [&](auto& op, const Cloud& cloud) {
    op.place(cloud.seen());
    const Columns seen = gather(op, {x}, cloud.position.size());
    double most = 0;
    for (std::size_t p = 0; p < seen[0].size(); ++p)
      most = std::max(most, std::abs(seen[0][p] - value(cloud.position[p])));
    return most;
  };
  Kernel::Averaging compact({}, grid, 1), gaussian({Kernel::Form::Gaussian}, grid, 1);
  Unresolved::Averaging exact({}, grid, 1);
  CHECK(worst(compact, symmetric) <= 1e-12);
  CHECK(worst(gaussian, symmetric) <= 1e-12);
  CHECK(worst(exact, symmetric) <= 1e-12);
  // In between the first moment errs with the place in the cell, by the first term of Poisson's
  // sum, times the slopes' sum of 5.5. The narrowest: s = h/2 of sampled Gaussians, 4 pi s^2 exp(-2
  // pi^2 s^2) = 0.0226 h; of B integrated over cells its transform at z = 2 pi R/h over pi, at most
  // 15 (z^2 - 3) z^-5 / pi = 0.0035 h at R = 1.75 h. The rest is for further terms, and the
  // Gaussian's cut.
  CHECK(worst(gaussian, any) <= 0.0226 * 5.5);
  CHECK(worst(compact, any) <= 0.0035 * 5.5 * 1.1);
  TwoGrid::Averaging same({1}, grid, 1);  // hats on the grid itself
  CHECK(worst(same, any) <= 1e-12);
  TwoGrid::Averaging twice({2}, grid, 1);  // hats of hats, sampled at the middles of the coarse
  CHECK(worst(twice, any) <= 1e-12);
  // Diffusion is linear in the place up to what reaches the walls, 11 away: implicit steps decay as
  // exp(-11 sqrt(3)) with terms of the steps.
  Diffusion::Averaging diffusion({2, 3}, grid, 1);
  CHECK(worst(diffusion, any) <= 1e-5);
}

TEST_CASE("averaging: one thread and three give the same bits") {
  const Team one(1), three(3);
  for (const Room& room : rooms())
    for_modes(false, [&](const char* name, const auto& mode) {
      CAPTURE(room.name);
      CAPTURE(name);
      typename std::decay_t<decltype(mode)>::Averaging a(mode, room.grid, 1), b(mode, room.grid, 1);
      furnish(a, room), furnish(b, room);
      const Cloud cloud = cloud_in(room.grid, 1000, 6);
      a.place(cloud.seen(), one), b.place(cloud.seen(), three);
      const Columns q{cloud.volumes(), cloud.radius};
      const auto fa = spread(a, q, one), fb = spread(b, q, three);
      for (std::size_t m = 0; m < q.size(); ++m)
        for (int k = 0; k < room.grid.nz(); ++k)
          for (int j = 0; j < room.grid.ny(); ++j)
            for (int i = 0; i < room.grid.nx(); ++i) REQUIRE(fa[m](i, j, k) == fb[m](i, j, k));
      CHECK(gather(a, fa, cloud.position.size(), one) ==
            gather(b, fa, cloud.position.size(), three));
    });
}

TEST_CASE(
    "averaging: particles outside are counted and have no weights; those in walls lose none") {
  const Grid grid({{0, 0, 0}, {8, 8, 8}}, {16, 16, 16}, {true, false, false});
  CellField open(grid, 1);
  for (int k = 0; k < 16; ++k)
    for (int j = 0; j < 16; ++j)
      for (int i = 0; i < 16; ++i) open(i, j, k) = k < 13 ? 1 : 0;
  Cloud cloud;
  cloud.position = {{4, 4, 4}, {4, -0.1, 4}, {40.25, 4, 4}, {4, 4, std::nan("")}, {4, 4, 7.9}};
  cloud.radius.assign(5, 0.25);
  for_modes(false, [&](const char* name, const auto& mode) {
    CAPTURE(name);
    typename std::decay_t<decltype(mode)>::Averaging op(mode, grid, 0.5);
    op.open(open);
    op.place(cloud.seen());
    CHECK(op.report().particles == 5);
    CHECK(op.report().outside == 2);
    const Columns ones{std::vector<double>(5, 1)};
    CHECK(near_relative(silt::total(spread(op, ones)[0]), 3, 1e-14));
    const auto seen = gather(op, {CellField(grid, 1)}, 5)[0];
    for (const std::size_t p : {0, 2, 4}) CHECK(near_relative(seen[p], 1, 1e-14));
    for (const std::size_t p : {1, 3}) CHECK(seen[p] == 0);
  });
  Unresolved::Averaging op({Unresolved::Share::Centre}, grid, 0.5);
  op.open(open);
  op.place(cloud.seen());
  CHECK(op.report().without_open == 1);
  const CellField at = spread(op, {{0, 0, 0, 0, 1}})[0];
  CHECK(at(8, 8, 12) == 1);  // below 4, 4, 7.9 the uppermost open cell
  op.place(Cloud{}.seen());
  CHECK(silt::total(spread(op, {{}})[0]) == 0);
}

TEST_CASE("averaging: nonsense is refused") {
  const Grid grid({{0, 0, 0}, {1, 1, 1}}, {4, 4, 4}), other({{0, 0, 0}, {1, 1, 1}}, {4, 4, 5});
  const auto made = [&](const auto& mode, double d = 0.1) {
    return refusal([&] { typename std::decay_t<decltype(mode)>::Averaging op(mode, grid, d); });
  };
  CHECK(made(Kernel{}).empty());
  CHECK(says(made(Kernel{Kernel::Form::Compact, -1}), "Kernel.width = -1"));
  CHECK(says(made(Kernel{Kernel::Form::Compact, std::nan("")}), "Kernel.width = nan"));
  CHECK(says(made(Kernel{}, 0), "diameter of the particles = 0 [m]"));
  CHECK(says(made(Unresolved{Unresolved::Share::Satellites, 0}), "Unresolved.points = 0"));
  CHECK(says(made(TwoGrid{0.5}), "TwoGrid.cell = 0.5"));
  CHECK(says(made(Diffusion{0}), "Diffusion.width = 0"));
  CHECK(says(made(Diffusion{6, 0}), "Diffusion.steps = 0"));

  Kernel::Averaging op({}, grid, 0.1);
  Cloud cloud = random_cloud(grid.box(), 3, 0.1, 1);
  cloud.radius[1] = 0;
  const auto placed = [&] { return refusal([&] { op.place(cloud.seen()); }); };
  CHECK(says(placed(), "radius of particle 1 = 0 [m]"));
  cloud.radius[1] = 1.5;
  CHECK(says(placed(), "radius of particle 1 = 1.5 [m] must be in (0, 1]"));
  cloud.radius = {0.1, 0.1};
  CHECK(says(placed(), "2 radii for 3 positions"));
  cloud.radius.assign(3, 0.1);
  CHECK(placed().empty());
  cloud.form.assign(3, 0);
  CHECK(says(placed(), "set forms"));
  cloud.form.clear();
  op.place(cloud.seen());
  CHECK(says(refusal([&] { spread(op, {{1, 2}}); }), "2 values for 3 particles"));
  CellField wrong(other);
  CellField* const fields[]{&wrong};
  const std::span<const double> columns[]{cloud.radius};
  CHECK(says(refusal([&] { op.spread(columns, fields, {}); }), "not one of the operator's grid"));
  CHECK(says(refusal([&] { op.spread(columns, {}, {}); }), "1 quantities of particles but 0"));
  CHECK(says(refusal([&] { op.open(wrong); }), "not of its grid"));
  CHECK(says(refusal([&] { op.open(CellField(grid, 0)); }), "no cell of the grid is open"));
  CHECK(says(refusal([&] { op.open(CellField(grid, 2)); }), "must be in [0, 1]"));
}

TEST_CASE("averaging: what an engine cuts off is the volume above the limit of each cell") {
  const Grid grid({{0, 0, 0}, {2, 1, 1}}, {2, 1, 1});
  CellField solids(grid);
  solids(0, 0, 0) = 0.9, solids(1, 0, 0) = 0.5;
  CHECK(near_relative(silt::clipped_solids(solids, 0.3), 0.2, 1e-14));
  CHECK(silt::clipped_solids(solids, 0.05) == 0);
}

}  // namespace averaging_test
