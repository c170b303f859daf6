#include <sdm/sites.h>

#include <new>
#include <utility>

#include "core/cancellation.h"
#include "core/memory.h"
#include "sites/sites_data.h"

namespace sdm {

Sites::Sites(Mesh mesh) try : data_(std::make_unique<sites::SitesData>(std::move(mesh))) {
} catch (const std::bad_alloc&) {
  throw out_of_memory("the sites of a mesh");
}

Sites::Sites(std::unique_ptr<sites::SitesData> data) : data_(std::move(data)) {}

Sites with_data(std::unique_ptr<sites::SitesData> data) {
  return Sites(std::move(data));
}

Sites::~Sites() = default;
Sites::Sites(Sites&&) noexcept = default;
Sites& Sites::operator=(Sites&&) noexcept = default;

void Sites::refit(std::span<const Vec3> positions) try {
  const Uncancellable whole;
  data_->refit(positions);
} catch (const std::bad_alloc&) {
  throw out_of_memory("the sites of a mesh");
}

void Sites::edit(const MeshEdit& edit) try {
  const Uncancellable whole;
  data_->edit(edit);
} catch (const std::bad_alloc&) {
  throw out_of_memory("the sites of a mesh");
}

const Mesh& Sites::mesh() const {
  return internals(*this).mesh;
}
std::span<const std::array<std::uint32_t, 2>> Sites::edges() const {
  return internals(*this).topology.edges;
}
bool Sites::closed() const {
  return internals(*this).closed;
}
bool Sites::orientable() const {
  return internals(*this).orientation.orientable;
}

}  // namespace sdm
