// The result of a search for closest points.
#pragma once

#include <nanobind/nanobind.h>
#include <sdm/sites.h>

#include <cstdint>
#include <span>
#include <vector>

#include "arrays.h"
#include "objects.h"

namespace sdm::python {

/// Holds what the search returned; the arrays are made by the first access.
struct PyClosestPoints {
  nb::object owner;  ///< keeps the sites
  const PySites* sites = nullptr;
  std::shared_ptr<SitesVersion> version;  ///< their faces and edges at the time of the search
  Positions positions;                    ///< of its vertices at the time of the search
  std::vector<ClosestPoint> found;
  std::vector<std::uint8_t> inside;  ///< empty: unsigned
  std::vector<Vec3> gradients;       ///< empty: not requested

  [[nodiscard]] double distance_of(std::size_t i) const {
    return !inside.empty() && inside[i] ? -found[i].distance : found[i].distance;
  }
  void set_gradients(std::span<const Vec3> points);

  nb::object distance();
  nb::object point();
  nb::object face();
  nb::object barycentric();
  nb::object site();
  nb::object site_type();
  nb::object gradient();
  [[nodiscard]] nb::object vertex_gradients() const;

 private:
  [[nodiscard]] Vec3 barycentric_of(const ClosestPoint& closest) const;
  void require_gradients() const;

  bool has_gradients_ = false;
  LazyArray distance_, point_, face_, barycentric_, site_, site_type_, gradient_;
};

}  // namespace sdm::python
