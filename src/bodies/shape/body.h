// A mesh in both roles, the sites of an O2 and, for maps, the surface of an O1; or a solid without a mesh.
#pragma once

#include <sdm/sites.h>
#include <sdm/surface.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "bodies/convex/convex_mesh.h"
#include "bodies/convex/core.h"
#include "bodies/shape/contact_parts.h"
#include "bodies/shape/inner_balls.h"
#include "bodies/shape/node_ball.h"
#include "bodies/shape/wall_thickness.h"
#include "core/arrays/array.h"
#include "core/arrays/stored_arrays.h"
#include "core/intact.h"
#include "core/lazy/kept.h"
#include "core/lazy/once.h"
#include "inside/inside.h"
#include "inside/solid_boundary.h"
#include "sites/bounding_cylinders.h"

namespace sdm::shape {

class Body {
 public:
  /// Throws sdm::Error as Surface and Sites do. `atlas`: none if null.
  Body(const Mesh& mesh, const AtlasOptions* atlas);
  /// A solid without a mesh: the core is none.
  explicit Body(const solids::Core& core);
  /// A convex mesh with a margin. Throws sdm::Error as Sites does, and for a mesh that is not convex.
  Body(const Mesh& mesh, double margin);
  /// The body that was stored. Throws sdm::Error if the bytes are not one, are damaged or, unless they are
  /// `trusted`, if what they contain does not belong together.
  Body(StoredBytes stored, bool trusted);
  /// Calls write(bytes) for all bytes of the body in its present shape. What queries build when they need it
  /// is not among them.
  void store(const std::function<void(std::span<const std::byte>)>& write) const;

  /// Moves the vertices to positions that are valid for this mesh (see validate_positions).
  void refit(std::span<const Vec3> positions);
  /// Changes the mesh. Throws sdm::Error, and changes nothing, as Surface::edit and Sites::edit do. Then it
  /// is like a body of the edited mesh, to the bit. Cost: that of its sites, and of Surface::edit.
  void edit(const MeshEdit& edit);
  /// Throws sdm::Error if a refit or an edit failed half-way. Whoever changes a body asks this before all
  /// else that uses it.
  void require_intact() const { intact_.require(); }

  [[nodiscard]] bool has_surface() const { return surface_.has_value(); }
  /// Throws sdm::Error if there is no atlas.
  [[nodiscard]] const Surface& surface() const;
  /// Throws sdm::Error if there is no mesh.
  [[nodiscard]] const Sites& sites() const;
  [[nodiscard]] bool has_mesh() const { return sites_.has_value(); }
  /// The core and the radius around it; of a mesh without a margin, the radius is 0.
  [[nodiscard]] const solids::Core& core() const { return core_; }
  /// Whether it is not a mesh, or one with a margin: such bodies are compared by their cores.
  [[nodiscard]] bool rounded() const { return !has_mesh() || core_.radius > 0; }
  /// Whether it is convex, and its support functions are those of its core.
  [[nodiscard]] bool has_support() const { return !has_mesh() || convex_solid() != nullptr; }
  [[nodiscard]] bool half_space() const { return core_.kind == solids::CoreKind::half_space; }
  /// Throws sdm::Error unless vertices can be moved and faces edited.
  void require_deformable() const;
  /// The bounding box of all faces, with the margin.
  [[nodiscard]] const Box& box() const { return box_; }
  /// The box about whose middle the body turns: box(), or the origin of a half-space.
  [[nodiscard]] Box turning_box() const { return half_space() ? Box{Vec3{}, Vec3{}} : box_; }
  /// A ball about the middle of the box that contains all faces: of round bodies, it is smaller than the box.
  [[nodiscard]] const Ball& ball() const { return ball_; }
  /// Whether it is a solid, with an inside.
  [[nodiscard]] bool solid() const { return !sites_ || internals(*sites_).is_solid(); }
  [[nodiscard]] const inside::InsideTest& inside() const { return *inside_; }

  /// Builds boundary() for the current shape unless already built: only solids that intersect themselves need
  /// it. Thread-safe.
  void require_boundary() const;
  /// The boundary of the solid. Requires a call of require_boundary().
  [[nodiscard]] const inside::SolidBoundary& boundary() const { return *boundary_->value; }

  /// The mesh, if it bounds a convex solid (see convex::recognise); none after a refit, as with cylinders().
  /// None with a margin.
  [[nodiscard]] const convex::ConvexMesh* convex() const { return rounded() ? nullptr : convex_.get(); }
  /// convex(), also after a refit, and of the core of a margin. Thread-safe; found by the first call after
  /// one.
  [[nodiscard]] const convex::ConvexMesh* convex_solid() const;
  /// Whether it bounds a convex solid (see convex::is_convex) of so few faces that bounds by their planes
  /// take less time, also after a refit. Thread-safe; decided by the first call after one.
  [[nodiscard]] bool is_small_and_convex() const;
  /// See convexity_deficit(). Thread-safe; computed by the first call.
  [[nodiscard]] double convexity_deficit() const;
  /// Balls inside and points of the surface. Thread-safe; computed by the first call.
  [[nodiscard]] const InnerBalls& inner_balls() const;

  /// The walls of a solid. Thread-safe; made by the first call, and filled by its functions.
  [[nodiscard]] const WallThickness& wall_thickness() const;

  /// Around the nodes of the tree; none after a refit, for which they would take longer than a few searches
  /// save.
  [[nodiscard]] const sites::CylinderTree& cylinders() const { return cylinders_; }
  /// See contact_parts(), of the first shape or that after the last edit.
  [[nodiscard]] std::span<const ContactPart> contact_parts() const { return contact_parts_; }

 private:
  Body(ArrayReader stored, bool trusted);
  void follow_positions();
  void find_parts();

  Intact intact_{"a body"};
  std::optional<Surface> surface_;
  solids::Core core_;
  std::optional<Sites> sites_;
  Box box_;
  Ball ball_;
  std::optional<inside::InsideTest> inside_;
  sites::CylinderTree cylinders_;
  std::unique_ptr<const convex::ConvexMesh> convex_;
  Kept<bool> is_convex_;
  Kept<std::unique_ptr<const convex::ConvexMesh>> refitted_convex_;
  Array<ContactPart> contact_parts_;

  /// A value that queries build when they need it.
  template <class Value>
  struct Lazy {
    Once built;
    std::optional<Value> value;

    /// make(value) is called once.
    template <class Make>
    const Value& get(const Make& make) {
      built.call([&] { make(value); });
      return *value;
    }
  };
  std::unique_ptr<Lazy<inside::SolidBoundary>> boundary_ = std::make_unique<Lazy<inside::SolidBoundary>>();
  std::unique_ptr<Lazy<double>> convexity_ = std::make_unique<Lazy<double>>();
  std::unique_ptr<Lazy<InnerBalls>> inner_balls_ = std::make_unique<Lazy<InnerBalls>>();
  std::unique_ptr<Lazy<WallThickness>> walls_ = std::make_unique<Lazy<WallThickness>>();
};

}  // namespace sdm::shape
