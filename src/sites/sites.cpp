#include <sdm/sites.h>

#include <utility>

#include "sites/sites_data.h"

namespace sdm {

Sites::Sites(Mesh mesh) : data_(std::make_unique<sites::SitesData>(std::move(mesh))) {}

Sites::~Sites() = default;
Sites::Sites(Sites&&) noexcept = default;
Sites& Sites::operator=(Sites&&) noexcept = default;

void Sites::refit(std::span<const Vec3> positions) {
  data_->refit(positions);
}

const Mesh& Sites::mesh() const {
  return data_->mesh;
}
std::span<const std::array<std::uint32_t, 2>> Sites::edges() const {
  return data_->topology.edges;
}
bool Sites::closed() const {
  return data_->closed;
}
bool Sites::orientable() const {
  return data_->orientation.orientable;
}

}  // namespace sdm
