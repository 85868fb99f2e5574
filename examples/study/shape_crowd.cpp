// silt - BSD-3-Clause, see LICENSE

#include "study/shape_crowd.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include <silt/contact/rolling/epsd.hpp>
#include <silt/files/vtk.hpp>
#include <silt/simulation.hpp>

namespace studies::shape {

namespace {

using silt::Particles;

template <class S>
auto contacts_of(const Model& model, const World& world) {
  if constexpr (std::is_same_v<S, silt::Sphere>)
    return silt::Contacts<silt::HertzMindlin, silt::RollingEpsd>{
        world.material, {.rolling_friction = std::get<RollingSphere>(model.form).friction}};
  else
    return silt::Contacts<silt::HertzMindlin>{world.material};
}

template <class S>
Particles<S> particles_of(const Model& model, const std::vector<Grain>& grains) {
  Particles<S> all;
  if constexpr (std::is_same_v<S, silt::Sphere>) {
    for (const auto& g : grains)
      all.add(
          {.position = g.position, .radius = radius, .density = density, .velocity = g.velocity});
  } else {
    all.add_form(std::get<S>(model.form));
    const auto& form = all.forms()[0];
    const double size = form.radius * std::cbrt(volume / form.mass.volume);
    for (const auto& g : grains)
      all.add({.position = g.position,
               .orientation = g.orientation,
               .radius = size,
               .density = density,
               .velocity = g.velocity});
  }
  return all;
}

template <class S>
auto simulation_of(const Model& model, const World& world, const std::vector<Grain>& grains) {
  silt::Simulation sim{particles_of<S>(model, grains), contacts_of<S>(model, world), world.period};
  sim.gravity = world.gravity;
  sim.threads = 1;
  // The guard's limits are relative to the smallest sphere's radius, and spheres that fill edges
  // are a hundredth of the body.
  if constexpr (std::is_same_v<S, silt::MultiSphere>)
    sim.guard.max_overlap = 10, sim.guard.max_travel = 10;
  return sim;
}

template <class S>
class CrowdOf final : public Crowd {
  using Sim = decltype(simulation_of<S>(std::declval<Model>(), std::declval<World>(),
                                        std::vector<Grain>{}));
  static constexpr bool bodies = Sim::of_bodies;

 public:
  CrowdOf(const Model& model, const World& world, const std::vector<Grain>& grains)
      : model_(model), material_(world.material), sim_(simulation_of<S>(model, world, grains)) {}

  void add_wall(silt::Surfaces surfaces, silt::Motion motion) override {
    sim_.add_wall(std::move(surfaces), material_, std::move(motion));
  }
  void remove_wall(std::size_t k) override { sim_.remove_wall(k); }
  void add(const std::vector<Grain>& grains) override { sim_.add(particles_of<S>(model_, grains)); }
  void run(double duration) override {
    if (model_.step_share < 1 && !sim_.time_step) {
      sim_.run(0);
      sim_.time_step = model_.step_share * sim_.step_length();
    }
    sim_.run(duration);
  }

  std::size_t size() const override { return sim_.size(); }
  Grain grain(std::size_t id) const override {
    const std::size_t k = sim_.find(static_cast<std::uint32_t>(id));
    Grain g{.position = sim_.position(k), .velocity = sim_.velocity(k)};
    if constexpr (bodies) g.orientation = sim_.orientation(k);
    return g;
  }
  Vec3d angular_velocity(std::size_t id) const override {
    return sim_.angular_velocity(sim_.find(static_cast<std::uint32_t>(id)));
  }
  Vec3d angular_momentum(std::size_t id) const override {
    const std::size_t k = sim_.find(static_cast<std::uint32_t>(id));
    const Vec3d w = sim_.angular_velocity(k);
    if constexpr (bodies) {
      const auto& m = sim_.forms()[sim_.form(k)].mass;
      const silt::Quaternion axes = sim_.orientation(k) * m.axes;
      const double scale = density * std::pow(sim_.scale(k), 5);
      const Vec3d own = rotate(conjugate(axes), w);
      return scale *
             rotate(axes, Vec3d{own.x * m.inertia.x, own.y * m.inertia.y, own.z * m.inertia.z});
    } else {
      return 0.4 * mass() * radius * radius * w;
    }
  }
  double mass() const override { return density * volume; }
  double kinetic_energy() const override {
    double sum = 0;
    for (std::size_t k = 0; k < sim_.size(); ++k) {
      const Vec3d v = grain(k).velocity;
      sum += 0.5 * (mass() * dot(v, v) + dot(angular_momentum(k), angular_velocity(k)));
    }
    return sum;
  }
  double time() const override { return sim_.time(); }
  double step_length() const override { return sim_.step_length(); }
  double peak_overlap() const override { return sim_.peak_overlap(); }
  Vec3d force_on_wall(std::size_t k) const override { return sim_.wall(k).force; }

  double partners() const override {
    double pairs = 0;
    if constexpr (std::is_same_v<S, silt::MultiSphere>) {
      const auto& e = sim_.engine();
      std::set<std::pair<std::uint32_t, std::uint32_t>> touching;
      e.lists.pairs.for_each([&](std::size_t k) {
        const auto i = e.lists.pairs.first()[k], j = e.lists.pairs.second()[k];
        const auto &p = e.particles.position[i], &q = e.particles.position[j];
        if (norm(sim_.domain().shortest(p.centre() - q.centre())) < p.r + q.r)
          touching.insert(std::minmax(e.particles.part[i].body, e.particles.part[j].body));
      });
      pairs = static_cast<double>(touching.size());
    } else {
      pairs = static_cast<double>(sim_.touching_pairs());
    }
    return 2 * pairs / static_cast<double>(sim_.size());
  }

  void write(const std::string& path) const override {
    std::vector<Vec3d> points;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (std::size_t k = 0; k < sim_.size(); ++k) {
      silt::SurfaceMesh mesh;
      double scale = radius;
      silt::Quaternion turn{};
      Vec3d centre{0, 0, 0};
      if constexpr (bodies) {
        const auto& form = sim_.forms()[0];
        mesh = silt::surface_of(form.shape), centre = form.mass.centroid;
        scale = sim_.scale(k), turn = sim_.orientation(k);
      } else {
        mesh = silt::surface_of(silt::Sphere{});
      }
      const auto first = static_cast<std::uint32_t>(points.size());
      for (const auto& x : mesh.points)
        points.push_back(sim_.position(k) + scale * rotate(turn, x - centre));
      for (const auto& t : mesh.triangles)
        triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
    silt::write_vtp_triangles(path, points, triangles);
  }

 private:
  Model model_;
  silt::HertzMindlin::Material material_;
  Sim sim_;
};

}  // namespace

std::vector<Grain> lattice(const Vec3d& corner, const std::array<int, 3>& cells, std::size_t count,
                           std::uint64_t seed) {
  std::vector<Grain> grains;
  silt::Random random(seed);
  for (int z = 0; z < cells[2]; ++z)
    for (int y = 0; y < cells[1]; ++y)
      for (int x = 0; x < cells[0] && grains.size() < count; ++x)
        grains.push_back({corner + pitch * Vec3d{x + 0.5, y + 0.5, z + 0.5},
                          silt::random_orientation(random),
                          {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), -0.5}});
  return grains;
}

std::unique_ptr<Crowd> make_crowd(const Model& model, const World& world,
                                  const std::vector<Grain>& grains) {
  return std::visit(
      [&](const auto& form) -> std::unique_ptr<Crowd> {
        using F = std::decay_t<decltype(form)>;
        using S = std::conditional_t<std::is_same_v<F, RollingSphere>, silt::Sphere, F>;
        return std::make_unique<CrowdOf<S>>(model, world, grains);
      },
      model.form);
}

}  // namespace studies::shape
