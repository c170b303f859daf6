// A mesh as O1 and as O2: its surface and its sites.
#pragma once

#include <sdm/sites.h>
#include <sdm/surface.h>

#include <optional>
#include <span>

#include "inside/inside.h"

namespace sdm::sampled {

class Body {
 public:
  /// Throws sdm::Error as Surface and Sites do.
  Body(const Mesh& mesh, const AtlasOptions& atlas);

  /// Moves the vertices to positions that are valid for this mesh (see validate_positions).
  void refit(std::span<const Vec3> positions);

  [[nodiscard]] const Surface& surface() const { return surface_; }
  [[nodiscard]] const Sites& sites() const { return sites_; }
  /// Around all faces.
  [[nodiscard]] const Box& box() const { return box_; }
  /// Whether it has an inside.
  [[nodiscard]] bool solid() const { return internals(sites_).is_solid(); }
  [[nodiscard]] const inside::InsideTest& inside() const { return *inside_; }

 private:
  void follow_positions();

  Surface surface_;
  Sites sites_;
  Box box_;
  std::optional<inside::InsideTest> inside_;
};

}  // namespace sdm::sampled
