// A mesh in both roles: the surface of an O1 and the sites of an O2.
#pragma once

#include <sdm/sites.h>
#include <sdm/surface.h>

#include <memory>
#include <mutex>
#include <optional>
#include <span>

#include "inside/inside.h"
#include "inside/solid_boundary.h"
#include "surface/sampling_bound/piece_assignment.h"

namespace sdm::shape {

class Body {
 public:
  /// Throws sdm::Error as Surface and Sites do.
  Body(const Mesh& mesh, const AtlasOptions& atlas);

  /// Moves the vertices to positions that are valid for this mesh (see validate_positions).
  void refit(std::span<const Vec3> positions);

  [[nodiscard]] const Surface& surface() const { return surface_; }
  [[nodiscard]] const Sites& sites() const { return sites_; }
  /// The bounding box of all faces.
  [[nodiscard]] const Box& box() const { return box_; }
  /// Whether it is a solid, with an inside.
  [[nodiscard]] bool solid() const { return internals(sites_).is_solid(); }
  [[nodiscard]] const inside::InsideTest& inside() const { return *inside_; }

  /// Builds boundary() for the current shape unless already built: only solids that intersect themselves need
  /// it. Thread-safe.
  void require_boundary() const;
  /// The boundary of the solid. Requires a call of require_boundary().
  [[nodiscard]] const inside::SolidBoundary& boundary() const { return *boundary_->value; }

  /// Builds pieces() for the current shape unless already built: queries answered from the triangles alone do
  /// not need them. Thread-safe.
  void require_pieces() const;
  /// The pieces of the surface. Requires a call of require_pieces().
  [[nodiscard]] const surface::PieceAssignment& pieces() const { return *pieces_->value; }

 private:
  void follow_positions();

  Surface surface_;
  Sites sites_;
  Box box_;
  std::optional<inside::InsideTest> inside_;

  /// A value that queries build when they need it.
  template <class Value>
  struct Lazy {
    std::once_flag built;
    std::optional<Value> value;
  };
  std::unique_ptr<Lazy<surface::PieceAssignment>> pieces_ =
      std::make_unique<Lazy<surface::PieceAssignment>>();
  std::unique_ptr<Lazy<inside::SolidBoundary>> boundary_ = std::make_unique<Lazy<inside::SolidBoundary>>();
};

}  // namespace sdm::shape
