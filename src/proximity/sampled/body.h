// A mesh in both roles: the surface of an O1 and the sites of an O2.
#pragma once

#include <sdm/sites.h>
#include <sdm/surface.h>

#include <memory>
#include <mutex>
#include <optional>
#include <span>

#include "inside/inside.h"
#include "surface/sampling_bound/piece_assignment.h"

namespace sdm::sampled {

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

  /// Builds pieces() for the current shape unless already built: queries answered from the triangles alone do
  /// not need them. Thread-safe.
  void require_pieces() const;
  /// The pieces of the surface. Requires a call of require_pieces().
  [[nodiscard]] const surface::PieceAssignment& pieces() const { return *pieces_->assignment; }

 private:
  void follow_positions();

  Surface surface_;
  Sites sites_;
  Box box_;
  std::optional<inside::InsideTest> inside_;

  struct Pieces {
    std::once_flag built;
    std::optional<surface::PieceAssignment> assignment;
  };
  std::unique_ptr<Pieces> pieces_ = std::make_unique<Pieces>();
};

}  // namespace sdm::sampled
