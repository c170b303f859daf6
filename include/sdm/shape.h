/// A mesh prepared for proximity queries, shared by any number of bodies.
#pragma once

#include <sdm/api.h>
#include <sdm/atlas.h>
#include <sdm/mesh.h>
#include <sdm/sites.h>
#include <sdm/surface.h>

#include <memory>

namespace sdm {
namespace shape {
class Body;
}

/// The sites of a mesh and, if it is to have maps, its atlas, in the frame of the mesh. Copies share them: a
/// thousand bodies of one shape need the memory of one. Copies may be used by several threads at once, as the
/// data do not change; only the refit of a query changes the shape of a body, and only if nothing else shares
/// it.
class SDM_API Shape {
 public:
  /// Makes a shape without an atlas, for all queries but maps. Throws sdm::Error as Sites does. Cost: that of
  /// Sites.
  explicit Shape(const Mesh& mesh);
  /// Makes a shape with an atlas. Throws sdm::Error as Surface and Sites do. Cost: theirs.
  Shape(const Mesh& mesh, const AtlasOptions& atlas);

  /// Throws sdm::Error if there is no atlas.
  [[nodiscard]] const Surface& surface() const;
  /// The sites, in the frame of the mesh.
  [[nodiscard]] const Sites& sites() const;
  /// Whether the mesh bounds a convex solid, exactly, with at most 16,384 faces: closed, in one piece,
  /// consistently oriented, without reflex edges and faces without area. Two such shapes are searched by
  /// support functions, which takes less time and gives the same results. False once the shape was deformed.
  [[nodiscard]] bool convex() const;

 private:
  friend const std::shared_ptr<shape::Body>& internals(const Shape& shape);

  std::shared_ptr<shape::Body> body_;
};

}  // namespace sdm
