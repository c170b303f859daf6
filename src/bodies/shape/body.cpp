#include "bodies/shape/body.h"

#include <sdm/error.h>

#include <algorithm>
#include <cmath>

#include "bodies/shape/convexity.h"
#include "geometry/rounding.h"
#include "geometry/vec.h"
#include "surface/stored_atlas.h"

namespace sdm::shape {
namespace {

// The version changes with all that is stored, and with what it means.
constexpr StoredFormat kFormat{{'s', 'd', 'm', 's', 'h', 'a', 'p', 'e'}, 1, "shape", "mesh"};

bool are_parts(std::span<const ContactPart> parts, const sites::SitesData& sites) {
  const std::size_t leaves = sites.regions.bounds.size();
  if (parts.size() != sites.tree.nodes.size()) return false;
  for (std::size_t i = 0; i < parts.size(); ++i)
    if ((parts[i].part > i && parts[i].part != kNone) || parts[i].first_leaf > parts[i].last_leaf ||
        parts[i].last_leaf > leaves)
      return false;
  return true;
}

// The ball about a point that contains the boxes two levels below the root of the tree.
Ball ball_about(const Vec3& centre, const sites::SitesData& sites) {
  const Vec3 c = sites.frame.to_unit(centre);
  double squared = 0;
  const auto include = [&](const tree::WideTree::Node& node, std::uint32_t i) {
    double to_corner = 0;
    for (int k = 0; k < 3; ++k) {
      const double x = std::max(c[k] - node.lower[k][i], node.upper[k][i] - c[k]);
      to_corner += x * x;
    }
    squared = std::max(squared, to_corner);
  };
  const tree::WideTree::Node& root = sites.wide.nodes[0];
  for (std::uint32_t i = 0; i < root.count; ++i) {
    if (tree::WideTree::is_leaf(root.child[i])) {
      include(root, i);
      continue;
    }
    const tree::WideTree::Node& node = sites.wide.nodes[root.child[i]];
    for (std::uint32_t j = 0; j < node.count; ++j) include(node, j);
  }
  return {centre, (std::sqrt(squared) + kSingleRounding) / sites.frame.scale};
}

}  // namespace

Body::Body(const Mesh& mesh, const AtlasOptions* atlas) : sites_(mesh) {
  if (atlas) surface_.emplace(mesh, *atlas);
  follow_positions();
  find_parts();
}

Body::Body(const solids::Core& core) : core_(core), box_(solids::box_of(core)) {
  ball_ = {0.5 * (box_.lower + box_.upper), 0.5 * diagonal(box_)};
  if (core.thin()) ball_.radius = core.half_length + core.radius;
}

Body::Body(const Mesh& mesh, double margin) : Body(mesh, nullptr) {
  if (!convex_)
    throw Error(
        "only a convex mesh can have a margin; make it convex by convex_hull(), or enlarge the contact "
        "margin");
  core_.radius = margin;
  for (int k = 0; k < 3; ++k) {
    box_.lower[k] -= margin;
    box_.upper[k] += margin;
  }
  ball_.radius += margin;
}

const Sites& Body::sites() const {
  if (!sites_)
    throw Error(
        "this shape has no mesh: it is a sphere, a capsule, a cylinder or a half-space; use the shape of a "
        "mesh");
  return *sites_;
}

void Body::require_deformable() const {
  if (rounded())
    throw Error(
        "its shape is a primitive or has a margin and cannot be deformed; use the shape of a mesh, or "
        "replace it");
}

Body::Body(StoredBytes stored, bool trusted) : Body(ArrayReader(std::move(stored), kFormat), trusted) {}

Body::Body(ArrayReader stored, bool trusted)
    : sites_(with_data(std::make_unique<sites::SitesData>(stored, trusted))) {
  Array<sites::BoundingCylinders> cylinders;
  bool is_convex = false;
  std::vector<std::uint8_t> atlas;
  stored(cylinders);
  stored(contact_parts_);
  stored(is_convex);
  stored(atlas);
  stored.finish();
  follow_positions();
  const sites::SitesData& sites = internals(*sites_);
  if (!cylinders_.set_nodes(std::move(cylinders), sites.wide)) stored.fail();
  if (!trusted && (!are_parts(contact_parts_, sites) || !cylinders_.have_valid_numbers())) stored.fail();
  if (is_convex) convex_ = convex::recognise(sites);
  if (!atlas.empty()) surface_.emplace(sites.mesh, surface::stored_options(atlas), atlas);
}

void Body::store(const std::function<void(std::span<const std::byte>)>& write) const {
  require_intact();
  if (rounded())
    throw Error("a primitive shape and one with a margin cannot be stored; make it again from its sizes");
  const bool is_convex = convex_ != nullptr;
  const std::vector<std::uint8_t> atlas = surface_ ? surface_->stored_atlas() : std::vector<std::uint8_t>{};
  ArrayWriter list;
  list(internals(*sites_));
  list(cylinders_.nodes);
  list(contact_parts_);
  list(is_convex);
  list(atlas);
  list.write(kFormat, write);
}

void Body::refit(std::span<const Vec3> positions) {
  intact_.change([&] {
    if (surface_) surface_->refit(positions);
    sites_->refit(positions);
    follow_positions();
  });
}

void Body::edit(const MeshEdit& edit) {
  // Parts of contacts are nodes of the tree: with one that has grown by edits, they would be other contacts
  // than those of the edited mesh by itself.
  Mesh mesh = sites_->mesh();
  apply(mesh, edit);
  Sites sites(std::move(mesh));
  if (surface_) surface_->edit(edit);
  intact_.change([&] {
    sites_ = std::move(sites);
    inside_.reset();
    follow_positions();
    find_parts();
  });
}

void Body::find_parts() {
  cylinders_ = {internals(*sites_).wide, internals(*sites_).regions};
  convex_ = convex::recognise(internals(*sites_));
  contact_parts_ = shape::contact_parts(internals(*sites_).tree);
}

const Surface& Body::surface() const {
  if (!surface_)
    throw Error(
        "there is no map of this body: its shape has no atlas; construct its Shape with AtlasOptions");
  return *surface_;
}

void Body::require_boundary() const {
  boundary_->get([this](auto& value) { value.emplace(internals(*sites_), inside_->sides()); });
}

const convex::ConvexMesh* Body::convex_solid() const {
  if (convex_ || !sites_) return convex_.get();
  const auto& found = refitted_convex_.get([this] {
    return std::make_shared<std::unique_ptr<const convex::ConvexMesh>>(convex::recognise(internals(*sites_)));
  });
  return found.get();
}

bool Body::is_small_and_convex() const {
  // After a refit, deciding it for more faces takes as long as the bounds by planes save.
  constexpr std::size_t kMostFaces = 512;
  if (sites_->mesh().triangles.size() > kMostFaces) return false;
  if (convex_) return true;
  return is_convex_.get([this] { return std::make_shared<bool>(convex::is_convex(internals(*sites_))); },
                        [this](bool& value) { value = convex::is_convex(internals(*sites_)); });
}

double Body::convexity_deficit() const {
  return convexity_->get(
      [this](auto& value) { value = shape::convexity_deficit(internals(*sites_), *inside_); });
}

const InnerBalls& Body::inner_balls() const {
  return inner_balls_->get([this](auto& value) { value = shape::inner_balls(internals(*sites_), *inside_); });
}

const WallThickness& Body::wall_thickness() const {
  return walls_->get([this](auto& value) { value.emplace(internals(*sites_), *inside_); });
}

void Body::follow_positions() {
  cylinders_ = {};
  convex_.reset();
  is_convex_.outdate();
  refitted_convex_.forget();
  box_ = bounds(sites_->mesh());
  ball_ = ball_about(0.5 * (box_.lower + box_.upper), internals(*sites_));
  if (boundary_->value) boundary_ = std::make_unique<Lazy<inside::SolidBoundary>>();
  if (convexity_->value) convexity_ = std::make_unique<Lazy<double>>();
  if (inner_balls_->value) inner_balls_ = std::make_unique<Lazy<InnerBalls>>();
  if (inside_) {
    if (walls_->value) walls_->value->forget();
    inside_->refit();
    return;
  }
  walls_ = std::make_unique<Lazy<WallThickness>>();
  inside_.emplace(internals(*sites_), solid() ? SignMethod::exact : SignMethod::none);
}

}  // namespace sdm::shape
