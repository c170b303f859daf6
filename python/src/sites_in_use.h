// The sites that an argument stands for.
#pragma once

#include <nanobind/nanobind.h>
#include <sdm/sites.h>

#include <optional>
#include <utility>

#include "objects.h"

namespace sdm::python {

/// The sites of a Sites, in use meanwhile, or those of any other mesh.
class SitesInUse {
 public:
  explicit SitesInUse(nb::handle mesh) {
    if (nb::isinstance<PySites>(mesh)) {
      const auto& given = nb::cast<const PySites&>(mesh);
      lock_ = given.access.use();
      sites_ = &given.sites;
      deviation_ = given.deviation;
    } else {
      PyMesh given = given_mesh(mesh, nb::none());
      mesh_ = std::move(given.mesh);
      deviation_ = given.deviation;
    }
  }
  [[nodiscard]] const Mesh& mesh() const { return sites_ ? sites_->mesh() : mesh_; }
  /// As of PyMesh.
  [[nodiscard]] double deviation() const { return deviation_; }
  /// Builds them, if they are not there. Needs no GIL.
  const Sites& get() {
    if (!sites_) sites_ = &own_.emplace(std::move(mesh_));
    return *sites_;
  }

 private:
  Use lock_;
  const Sites* sites_ = nullptr;
  Mesh mesh_;
  double deviation_ = 0;
  std::optional<Sites> own_;
};

}  // namespace sdm::python
