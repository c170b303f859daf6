#include "scenes/scene.h"

#include "scenes/simulation.h"

namespace sdm::scenes {

struct Scene::Impl {
  std::vector<Body> bodies;
  std::unique_ptr<Simulation> simulation;
};

Scene::Scene(SceneKind kind, const SceneOptions& options) : impl_(std::make_unique<Impl>()) {
  switch (kind) {
    case SceneKind::letters:
      impl_->simulation = make_letters(impl_->bodies);
      break;
    case SceneKind::bunnies:
      impl_->simulation = make_bunnies(impl_->bodies, options.mesh);
      break;
    case SceneKind::figure:
      impl_->simulation = make_figure(impl_->bodies);
      break;
    case SceneKind::crowd:
      impl_->simulation = make_crowd(impl_->bodies);
      break;
    case SceneKind::tear:
      impl_->simulation = make_tear(impl_->bodies);
      break;
    case SceneKind::cloth:
      impl_->simulation = make_cloth(impl_->bodies);
      break;
  }
}
Scene::~Scene() = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;

std::span<const Scene::Body> Scene::bodies() const {
  return impl_->bodies;
}

double Scene::time_step() const {
  return kTimeStep;
}

void Scene::advance() {
  impl_->simulation->advance(impl_->bodies);
}

}  // namespace sdm::scenes
