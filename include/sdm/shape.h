/// A mesh or a primitive solid prepared for proximity queries, shared by any number of bodies.
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

  // Primitive solids, without triangles but for the box, which is a mesh: exact, and for all queries but
  // maps. They throw sdm::Error for sizes that are not finite or not above 0. Cost: constant.

  /// The ball of that radius about the origin.
  [[nodiscard]] static Shape sphere(double radius);
  /// The points within the radius of a segment of that length, about the origin, along z.
  [[nodiscard]] static Shape capsule(double radius, double length);
  /// The cylinder of that radius and length, about the origin, along z.
  [[nodiscard]] static Shape cylinder(double radius, double length);
  /// The box with sides of these lengths about the origin.
  [[nodiscard]] static Shape box(const Vec3& sides);
  /// The points x with n · x ≤ offset, n the normal divided by its length, as a floor. Two half-spaces are no
  /// pair of bodies.
  [[nodiscard]] static Shape half_space(const Vec3& normal, double offset = 0);
  /// The points within that radius of this shape, a convex one. Throws sdm::Error for a shape that is not
  /// convex, or was deformed. Cost: that of Shape(mesh) of a mesh.
  [[nodiscard]] Shape with_margin(double radius) const;

  /// Calls write(bytes) for all bytes of the shape, part after part: some twenty times those of its mesh, for
  /// caches and files, as write_shape() makes them. They can be used by the same version of the format only,
  /// on any little-endian machine. Throws what write() throws. Cost: linear.
  void store(const std::function<void(std::span<const std::byte>)>& write) const;

  /// Whether there is an atlas.
  [[nodiscard]] bool has_surface() const;
  /// Throws sdm::Error if there is no atlas.
  [[nodiscard]] const Surface& surface() const;
  /// Whether it is a mesh, without or with a margin. A sphere, a capsule, a cylinder and a half-space are
  /// none.
  [[nodiscard]] bool has_mesh() const;
  /// The radius around the mesh, or that of a sphere or a capsule; otherwise 0.
  [[nodiscard]] double margin() const;
  /// The sites, in the frame of the mesh, without its margin. Throws sdm::Error if there is no mesh.
  [[nodiscard]] const Sites& sites() const;
  /// Whether the mesh bounds a convex solid, exactly, with at most 16,384 faces: closed, in one piece,
  /// consistently oriented, without reflex edges and faces without area. Two such shapes are searched by
  /// support functions, which takes less time and gives the same results. False once the shape was deformed;
  /// true of all primitives.
  [[nodiscard]] bool convex() const;

 private:
  friend const std::shared_ptr<shape::Body>& internals(const Shape& shape);
  explicit Shape(std::shared_ptr<shape::Body> body);

  std::shared_ptr<shape::Body> body_;
};

}  // namespace sdm
