/// A mesh prepared for proximity queries, shared by any number of bodies.
#pragma once

#include <sdm/mesh.h>
#include <sdm/sites.h>
#include <sdm/surface.h>
#include <sdm/types.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <span>

namespace sdm {
namespace shape {
class Body;
}

/// Memory that has a stored shape.
struct StoredShape {
  std::span<std::byte> bytes;         ///< writable, at an address that is a multiple of 64
  std::shared_ptr<const void> owner;  ///< whatever keeps them; null if they outlive the shape anyway
  /// Whether they certainly are what Shape::store() wrote: then only damage is looked for.
  bool trusted = false;
};

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
  /// Takes the bytes that store() wrote: nothing is built, and the shape reads them where they are. Nothing
  /// else may use them while the shape or copies of it exist. All results are those of the shape that was
  /// stored, to the bit. Throws sdm::Error if they are of another version of sdm, incomplete or damaged,
  /// which a checksum finds. Unless they are trusted, all indices, boxes and numbers are checked as well, so
  /// that they may come from anyone: if somebody has changed regions and bounds on purpose, with the
  /// checksum, results can be wrong, or queries throw sdm::Error, but all end and read nothing else. Cost:
  /// linear, all cores, a small part of building.
  explicit Shape(StoredShape stored);

  /// Calls write(bytes) for all bytes of the shape, part after part: some twenty times those of its mesh, for
  /// caches and files, as write_shape() makes them. They can be used by the same version of the format only,
  /// on any little-endian machine. Throws what write() throws. Cost: linear.
  void store(const std::function<void(std::span<const std::byte>)>& write) const;

  /// Whether there is an atlas.
  [[nodiscard]] bool has_surface() const;
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
