// The result of a search for closest points.
#pragma once

#include <nanobind/nanobind.h>
#include <sdm/map.h>
#include <sdm/sites.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "arrays.h"
#include "objects.h"
#include "run.h"

namespace sdm::python {

inline constexpr Vec3 kNoPoint{std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::quiet_NaN()};

/// What a search finds.
struct Found {
  std::vector<ClosestPoint> closest;
  std::vector<std::uint8_t> inside;  ///< empty: unsigned

  [[nodiscard]] double distance_of(std::size_t i) const {
    return !inside.empty() && inside[i] ? -closest[i].distance : closest[i].distance;
  }
  /// The derivative of distance i by its point: 0 where there is none.
  [[nodiscard]] Vec3 gradient_of(std::size_t i, const Vec3& point) const;
};

/// The closest points, with a sign if the options ask for one. Needs no GIL.
[[nodiscard]] Found search(const Sites& sites, std::span<const Vec3> points, const MapOptions& options);

/// The barycentric coordinates of a closest point in its face; NaN where there is none. `positions`: of the
/// vertices of the sites.
[[nodiscard]] Vec3 weights_of(const Sites& sites, std::span<const Vec3> positions,
                              const ClosestPoint& closest);

/// The faces of closest points, of results that no longer have their sites.
struct StoredFaces {
  std::vector<Triangle> corners;  ///< 0 where there is no closest point
  std::vector<Vec3> weights;      ///< as weights_of()
};

/// Holds what the search returned; the arrays are made by the first access.
struct PyClosestPoints {
  PyClosestPoints() = default;
  /// A result that was stored.
  PyClosestPoints(Found found, bool has_gradients, std::vector<Vec3> gradients, StoredFaces faces);

  nb::object owner;  ///< keeps the sites
  const PySites* sites = nullptr;
  std::shared_ptr<SitesVersion> version;  ///< their faces and edges at the time of the search
  Positions positions;                    ///< of its vertices at the time of the search
  Found found;
  std::vector<Vec3> gradients;  ///< empty: not requested

  [[nodiscard]] std::size_t size() const { return found.closest.size(); }
  void set_gradients(std::span<const Vec3> points);
  [[nodiscard]] bool has_gradients() const { return has_gradients_; }
  [[nodiscard]] StoredFaces stored_faces() const;

  nb::object distance();
  nb::object point();
  nb::object face();
  nb::object barycentric();
  nb::object site();
  nb::object site_type();
  nb::object gradient();
  [[nodiscard]] nb::object vertex_gradients() const;
  /// The derivatives of a function by the points, (n, 3), and by `count` vertices, (count, 3), from those by
  /// the distances: the chain rule of python/sdm/_gradients.py, in one pass.
  [[nodiscard]] nb::object pull_back(nb::handle upstream, std::size_t count) const;

 private:
  [[nodiscard]] Vec3 barycentric_of(std::size_t i) const;
  [[nodiscard]] Triangle corners_of(std::size_t i) const;
  /// Keeps the sites from changing, if it has them.
  [[nodiscard]] Use use() const;
  void require_gradients() const;

  bool has_gradients_ = false;
  std::optional<StoredFaces> stored_;  ///< in place of sites, version and positions
  LazyArray distance_, point_, face_, barycentric_, site_, site_type_, gradient_;
};

}  // namespace sdm::python
