#include "proximity/sampled/body.h"

namespace sdm::sampled {

Body::Body(const Mesh& mesh, const AtlasOptions& atlas) : surface_(mesh, atlas), sites_(mesh) {
  follow_positions();
}

void Body::refit(std::span<const Vec3> positions) {
  surface_.refit(positions);
  sites_.refit(positions);
  follow_positions();
}

void Body::require_pieces() const {
  std::call_once(pieces_->built, [this] { pieces_->assignment.emplace(surface_); });
}

void Body::follow_positions() {
  box_ = bounds(sites_.mesh());
  inside_.emplace(internals(sites_), solid() ? SignMethod::pseudonormal : SignMethod::none);
}

}  // namespace sdm::sampled
