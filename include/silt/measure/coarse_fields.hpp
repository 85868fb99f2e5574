// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/tensor3.hpp>
#include <silt/files/csv_table.hpp>
#include <silt/files/vtk.hpp>
#include <silt/measure/coarse_kernels.hpp>
#include <silt/measure/stress.hpp>
#include <silt/simulation.hpp>

namespace silt::inline SILT_TARGET {

/// Points of coarse-grained fields: the centres of equal cells that divide a box.
struct CoarseGrid {
  Box box;
  std::array<int, 3> cells{1, 1, 1};  // in x, y, z

  void check() const {
    const double volume = box.volume();
    require(std::isfinite(volume) && volume > 0, "CoarseGrid.box from ", box.min, " to ", box.max,
            " [m] must have a volume");
    double count = 1;
    for (const int n : cells) {
      require(n > 0, "CoarseGrid.cells = ", n, " [-] must be at least 1 in each direction");
      count *= n;
    }
    require(count < 1e8, "CoarseGrid.cells: ", count, " cells are more than 1e8; use fewer");
  }
  std::size_t size() const {
    return static_cast<std::size_t>(cells[0]) * static_cast<std::size_t>(cells[1]) *
           static_cast<std::size_t>(cells[2]);
  }
  std::size_t index(int i, int j, int k) const {
    return static_cast<std::size_t>((k * cells[1] + j) * cells[0] + i);
  }
  Vec3d spacing() const {  // [m]
    const Vec3d e = box.extent();
    return {e.x / cells[0], e.y / cells[1], e.z / cells[2]};
  }
  Vec3d centre(int i, int j, int k) const {  // [m]
    const Vec3d h = spacing();
    return {box.min.x + (i + 0.5) * h.x, box.min.y + (j + 0.5) * h.y, box.min.z + (k + 0.5) * h.z};
  }
};

/// Fields at one point, averaged over all samples.
struct CoarseValues {
  double solid_fraction = 0;  // [-]
  double density = 0;         // [kg/m3] bulk density
  Vec3d velocity{0, 0, 0};    // [m/s] momentum over density
  double temperature = 0;     // [m2/s2] granular: a third of the mean square fluctuation
  Symmetric3 kinetic_stress;  // [Pa] compression positive, fluctuations about `velocity`
  Tensor3 contact_stress;     // [Pa] first index: force
  double pressure() const { return (kinetic_stress.trace() + contact_stress.trace()) / 3; }  // [Pa]
};

/// Fields on a grid from particles and contacts, with a coarse-graining function phi:
///
///   density        rho(r)   = sum_k m_k phi(r - r_k)                                           (1)
///   momentum       rho v(r) = sum_k m_k v_k phi(r - r_k)                                       (2)
///   kinetic stress          = sum_k m_k v_k v_k^T phi(r - r_k) - rho v v^T                     (3)
///   contact stress          = sum_c F_c l_c^T int_0^1 phi(r - (from + s l_c)) ds               (4)
///
/// F is the force on a contact's a, l its branch vector from the partner's centre, or from the
/// point at a wall. (1) and (2) fulfil the mass balance. With the wall forces spread by phi at
/// their points, (1) to (4) fulfil the momentum balance at every point and for every phi: d(rho
/// v)/dt = -div(rho v v + stress) + rho g + walls. Averaged over the samples are (1), (2), the sum
/// in (3), and (4); velocity and fluctuations follow from the averages. A velocity gradient counts
/// as fluctuation: with a Gaussian of width w, a shear flow of rate G adds G^2 w^2/3 to the
/// temperature.
///
/// Source: Goldhirsch, Granular Matter 12 (2010) 239; Weinhart et al., Granular Matter 14 (2012)
///         289 (both recalled; as MercuryCG does). In (3) the fluctuations are about the mean of
///         all samples, not of each sample.
/// Tests:  tests/measure/coarse_fields.cpp (mass, balance in a bed, shear, kernels).
template <class Kernel>
class CoarseFields {
 public:
  CoarseFields(const CoarseGrid& grid, const Kernel& kernel) : grid_(grid), kernel_(kernel) {
    grid_.check();
    kernel_.check();
    sums_.resize(grid_.size());
  }

  const CoarseGrid& grid() const { return grid_; }
  std::size_t samples() const { return samples_; }
  void clear() { samples_ = 0, sums_.assign(sums_.size(), {}); }

  /// Adds the present state as a sample.
  template <class Sim>
  void add(const Sim& sim) {
    add_particles(sim);
    sim.for_each_contact([&](const ContactSeen& c) { add_contact(sim, c); });
  }
  /// The same for an observer that declares itself that it reads contacts.
  template <class Sim>
  void add_recorded(const Sim& sim) {
    add_particles(sim);
    sim.visit_contacts([&](const ContactSeen& c) { add_contact(sim, c); }, "coarse_grained");
  }

  CoarseValues at(int i, int j, int k) const { return at(grid_.index(i, j, k)); }
  CoarseValues at(std::size_t cell) const {
    const Sums& s = sums_[cell];
    const double per = samples_ > 0 ? 1 / static_cast<double>(samples_) : 0;
    CoarseValues v;
    v.solid_fraction = per * s.solid, v.density = per * s.mass;
    v.contact_stress = per * s.contact;
    if (!(s.mass > 0)) return v;
    v.velocity = (1 / s.mass) * s.momentum;
    v.kinetic_stress = per * s.flux;
    v.kinetic_stress += -v.density * outer(v.velocity);
    v.temperature = std::max(v.kinetic_stress.trace(), 0.0) / (3 * v.density);
    return v;
  }

  /// For ParaView; `path` should end in .vti. Tensors have nine components, row by row.
  void write_vti(const std::string& path) const {
    std::vector<double> solid, density, temperature, pressure;
    std::vector<Vec3d> velocity;
    std::vector<std::array<double, 9>> contact, kinetic;
    const auto row_by_row = [](const Tensor3& t) {
      return std::array<double, 9>{t.xx, t.xy, t.xz, t.yx, t.yy, t.yz, t.zx, t.zy, t.zz};
    };
    for (std::size_t c = 0; c < grid_.size(); ++c) {
      const CoarseValues v = at(c);
      solid.push_back(v.solid_fraction), density.push_back(v.density);
      velocity.push_back(v.velocity), temperature.push_back(v.temperature);
      pressure.push_back(v.pressure()), contact.push_back(row_by_row(v.contact_stress));
      kinetic.push_back(row_by_row(full(v.kinetic_stress)));
    }
    VtkFields fields;
    fields.add("solid_fraction", solid).add("density", density).add("velocity", velocity);
    fields.add("granular_temperature", temperature).add("pressure", pressure);
    fields.add("contact_stress", contact).add("kinetic_stress", kinetic);
    silt::write_vti(path, grid_.box, grid_.cells, fields);
  }
  /// One row per cell, x fastest.
  void write_csv(const std::string& path) const {
    CsvTable table(
        path, {"x [m]", "y [m]", "z [m]", "solid fraction [-]", "density [kg/m3]", "speed [m/s]",
               "velocity x [m/s]", "velocity y [m/s]", "velocity z [m/s]",
               "granular temperature [m2/s2]", "pressure [Pa]", "stress xx [Pa]", "stress yy [Pa]",
               "stress zz [Pa]", "stress xy [Pa]", "stress yz [Pa]", "stress zx [Pa]"});
    for (int k = 0; k < grid_.cells[2]; ++k)
      for (int j = 0; j < grid_.cells[1]; ++j)
        for (int i = 0; i < grid_.cells[0]; ++i) {
          const Vec3d x = grid_.centre(i, j, k);
          const CoarseValues v = at(i, j, k);
          const Tensor3 s = v.contact_stress + full(v.kinetic_stress);
          table.add_row({x.x, x.y, x.z, v.solid_fraction, v.density, norm(v.velocity), v.velocity.x,
                         v.velocity.y, v.velocity.z, v.temperature, v.pressure(), s.xx, s.yy, s.zz,
                         s.xy, s.yz, s.zx});
        }
  }

 private:
  struct Sums {
    double solid = 0, mass = 0;
    Vec3d momentum{0, 0, 0};
    Symmetric3 flux;
    Tensor3 contact;
  };
  struct Range {
    int from, to;
  };

  /// Cells in one direction whose centres are between two positions [m].
  static Range range(double low, double high, double min, double h, int cells) {
    const double from = std::ceil((low - min) / h - 0.5), to = std::floor((high - min) / h - 0.5);
    return {static_cast<int>(std::clamp(from, 0.0, double(cells))),
            static_cast<int>(std::clamp(to + 1, 0.0, double(cells)))};
  }
  /// Calls visit(sums of a cell, its centre) for the cells near the box from `low` to `high` [m].
  template <class Visit>
  void for_cells(const Vec3d& low, const Vec3d& high, const Visit& visit) {
    const double reach = kernel_.reach();
    const Vec3d h = grid_.spacing(), &o = grid_.box.min;
    const Range x = range(low.x - reach, high.x + reach, o.x, h.x, grid_.cells[0]),
                y = range(low.y - reach, high.y + reach, o.y, h.y, grid_.cells[1]),
                z = range(low.z - reach, high.z + reach, o.z, h.z, grid_.cells[2]);
    for (int k = z.from; k < z.to; ++k)
      for (int j = y.from; j < y.to; ++j)
        for (int i = x.from; i < x.to; ++i)
          visit(sums_[grid_.index(i, j, k)], grid_.centre(i, j, k));
  }

  template <class Sim>
  void add_particles(const Sim& sim) {
    detail::need_one_process<Sim>();
    ++samples_;
    const double reach2 = kernel_.reach() * kernel_.reach();
    for (std::size_t k = 0; k < sim.rows(); ++k) {
      if (!sim.is_present(k) || !std::isfinite(sim.mass(k))) continue;
      const double m = sim.mass(k), volume = sim.engine().volume_of(k);
      const Vec3d v = sim.velocity(k), at = detail::in_domain(sim.domain(), sim.position(k));
      const Symmetric3 flux = m * outer(v);
      detail::for_each_image(sim.domain(), [&](const Vec3d& shift) {
        const Vec3d place = at + shift;
        for_cells(place, place, [&](Sums& s, const Vec3d& centre) {
          const Vec3d d = centre - place;
          const double distance2 = dot(d, d);
          if (distance2 >= reach2) return;
          const double phi = kernel_.value(distance2);
          s.solid += volume * phi, s.mass += m * phi;
          s.momentum += (m * phi) * v, s.flux += phi * flux;
        });
      });
    }
  }
  template <class Sim>
  void add_contact(const Sim& sim, const ContactSeen& c) {
    const Vec3d place = detail::in_domain(sim.domain(), sim.position(c.place_a));
    const double length = norm(c.branch), reach2 = kernel_.reach() * kernel_.reach();
    if (!(length > 0)) return;
    const Vec3d way = c.branch * (1 / length);
    const Tensor3 stress = (1 / length) * dyad(c.force, c.branch);
    detail::for_each_image(sim.domain(), [&](const Vec3d& shift) {
      const Vec3d to = place + shift, from = to - c.branch;
      Box around;
      around.include(from), around.include(to);
      for_cells(around.min, around.max, [&](Sums& s, const Vec3d& centre) {
        // Part of the branch within reach, measured from its point nearest to the centre.
        const Vec3d d = centre - from;
        const double along = dot(d, way), across2 = std::max(dot(d, d) - along * along, 0.0);
        if (across2 >= reach2) return;
        const double half = std::sqrt(reach2 - across2);
        const double first = std::max(-along, -half), last = std::min(length - along, half);
        if (first < last) s.contact += kernel_.along(across2, first, last) * stress;
      });
    });
  }
  CoarseGrid grid_;
  Kernel kernel_;
  std::vector<Sums> sums_;
  std::size_t samples_ = 0;
};
template <class Kernel>
CoarseFields(const CoarseGrid&, const Kernel&) -> CoarseFields<Kernel>;

}  // namespace silt
