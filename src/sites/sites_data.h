// The data of Sites, for the engines.
#pragma once

#include <sdm/sites.h>

#include <vector>

#include "core/arrays/stored_arrays.h"
#include "core/intact.h"
#include "core/lazy/kept.h"
#include "core/lazy/unique_number.h"
#include "mesh/crossings/ray_parity.h"
#include "mesh/topology.h"
#include "sites/face_frames.h"
#include "sites/orient_outward.h"
#include "sites/pseudonormals.h"
#include "sites/regions.h"
#include "tree/aabb_tree.h"
#include "tree/wide_tree.h"

namespace sdm::facing {
struct NormalBounds;
}
namespace sdm::inside {
struct ShapeSigns;
}

namespace sdm::sites {

/// The sites of a mesh, with a tree over its faces. Only Sites modifies it; all other code has const access.
class SitesData {
 public:
  /// As Sites::Sites.
  explicit SitesData(Mesh mesh);
  /// Those that were stored. Unless they are `trusted`, throws sdm::Error if their indices or numbers are not
  /// such that all queries end and read nothing else. Cost: linear, all cores.
  SitesData(ArrayReader& stored, bool trusted);
  void refit(std::span<const Vec3> positions);
  void edit(const MeshEdit& edit);
  /// Throws sdm::Error if a refit failed half-way.
  void require_intact() const { intact_.require(); }

  /// Whether the mesh bounds a solid, and so has an inside.
  [[nodiscard]] bool is_solid() const { return closed && orientation.orientable; }
  /// A face that the site belongs to.
  [[nodiscard]] std::uint32_t face_of(SiteType type, std::uint32_t site) const {
    switch (type) {
      case SiteType::vertex:
        return vertex_faces.of(site)[0];
      case SiteType::edge:
        return topology.edge_faces(site)[0];
      default:
        return site;
    }
  }
  /// Valid for the lifetime of this object.
  [[nodiscard]] inside::FaceTree face_tree() const { return {mesh.positions, mesh.triangles, frame, tree}; }

  Mesh mesh;
  mesh::Topology topology;
  mesh::VertexFaces vertex_faces;
  bool closed = false;
  bool consistently_oriented = false;  ///< closed, with the same orientation of neighbouring faces
  mesh::Orientation orientation;
  Shells shells;  ///< if closed and orientable
  Array<std::uint8_t>
      inverted;  ///< of each face: opposite to the outward orientation; if open, to its neighbours

  UnitFrame frame;      ///< of the faces that have sites
  tree::AabbTree tree;  ///< over those faces, in the unit frame
  tree::WideTree wide;  ///< the same, collapsed
  Regions regions;      ///< by the leaves of both
  LeafFrames frames;    ///< of the leaves of both
  Pseudonormals normals;
  Array<std::uint8_t> sliver;  ///< of each face: too thin for a reliable normal
  std::uint64_t shape_number =
      unique_number();                       ///< of the present shape, by which copies elsewhere are known
  Kept<inside::ShapeSigns> signs;            ///< of the present shape: see inside::signs_of()
  Kept<facing::NormalBounds> normal_bounds;  ///< of the present shape: see facing::normal_bounds_of()

  /// What is stored; the rest is derived from it. See core/arrays/stored_arrays.h.
  template <class Self, class Visit>
  static void for_each_member(Self& self, const Visit& visit) {
    visit(self.mesh.positions);
    visit(self.mesh.triangles);
    visit(self.mesh.corner_uvs);
    visit(self.topology);
    visit(self.vertex_faces);
    visit(self.orientation);
    visit(self.inverted);
    visit(self.tree);
    visit(self.wide);
    visit(self.regions);
    visit(self.normals);
    visit(self.sliver);
    visit(self.faces_added_to_tree_);
  }

 private:
  /// Intermediate data of a refit, whose memory the next one reuses.
  struct Refit {
    std::vector<Vec3> placed;
    std::vector<tree::FloatBox> boxes;
    std::vector<FaceShape> shapes;
  };

  /// Those of an edited mesh. Takes the memory of last_refit_, and changes nothing else.
  SitesData(SitesData& before, const MeshEdit& edit);

  /// Whether what was stored belongs together.
  [[nodiscard]] bool is_valid() const;
  [[nodiscard]] std::vector<tree::FloatBox> face_boxes() const;
  void build_tree();
  [[nodiscard]] bool edit_tree(const SitesData& before);
  void find_orientation();
  void find_shells();
  void assign_sites(Refit& refit);  ///< to the leaves of the tree
  void set_inverted();
  void compute_regions(Refit& refit);  ///< refit.placed: the present positions

  Refit last_refit_;
  std::size_t faces_added_to_tree_ = 0;  ///< since it was built
  Intact intact_{"a Sites object"};
};

}  // namespace sdm::sites

namespace sdm {

/// The data of Sites. Throws sdm::Error if a refit failed half-way. Found by argument-dependent lookup.
[[nodiscard]] inline const sites::SitesData& internals(const Sites& sites) {
  sites.data_->require_intact();
  return *sites.data_;
}

/// Sites with this data.
[[nodiscard]] Sites with_data(std::unique_ptr<sites::SitesData> data);

}  // namespace sdm
