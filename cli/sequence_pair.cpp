#include "sequence_pair.h"

#include <algorithm>
#include <span>
#include <utility>

#include "src/core/stopwatch.h"

namespace {

std::size_t count_faces(const sdm::Mesh& mesh) {
  return mesh.triangles.size() -
         static_cast<std::size_t>(std::ranges::count_if(mesh.triangles, sdm::is_removed));
}

}  // namespace

MovingPair::MovingPair(std::array<Body, 2> bodies, const std::array<sdm::AtlasOptions, 2>& atlases,
                       const sdm::ProximityOptions& options, double precision, TemporalRecorder& temporal)
    : bodies_(std::move(bodies)),
      atlases_(atlases),
      query_(sdm::Shape(bodies_[0].mesh(), atlases[0]), sdm::Shape(bodies_[1].mesh(), atlases[1]), options),
      precision_(precision),
      temporal_(temporal) {
  for (int b = 0; b < 2; ++b) bounds_.emplace_back(surface(b));
}

bool MovingPair::has_history() const {
  return precision_ > 0 || std::ranges::any_of(bounds_, &FrameBound::has_history);
}

void MovingPair::move(Frame& frame) {
  sdm::Stopwatch watch;
  std::array<std::span<const sdm::Vec3>, 2> positions;
  hash_ = {};
  for (int b = 0; b < 2; ++b) {
    Body& body = bodies_[b];
    if (body.still()) continue;
    body.read(frame.index);
    hash_[b] = body.hash();
    frame.time.read += watch.lap();
    if (const sdm::TopologyChange change = body.change(); !change.none())
      naming_frame(frame.index, [&] { follow(b, change, frame); });
    else
      positions[b] = body.positions();
    frame.time.update += watch.lap();
  }
  naming_frame(frame.index, [&] {
    query_.refit(positions[0], positions[1]);
    for (int b = 0; b < 2; ++b)
      if (edited_[b]) {
        bounds_[b].rebuild(surface(b));
        edited_[b] = false;
      }
  });
  frame.time.update += watch.lap();
}

void MovingPair::follow(int b, const sdm::TopologyChange& change, Frame& frame) {
  edited_[b] = true;
  const std::size_t faces_before = count_faces(sites(b).mesh());
  bool replaced = change.replaced;
  if (!replaced) try {
      if (b == 0) temporal_.before_edit(surface(0));
      query_.edit(b, change.edit);
    } catch (const sdm::Cancelled&) {
      throw;
    } catch (const sdm::Error&) {  // the atlas has no room
      replaced = true;
    }
  if (replaced) {
    query_.replace(b, sdm::Shape(bodies_[b].mesh(), atlases_[b]));
    if (b == 0) temporal_.before_restart();
  }
  bodies_[b].followed();
  frame.topology[b] = {
      .removed_faces = replaced ? faces_before : change.edit.removed_faces.size(),
      .reconnected_faces = replaced ? 0 : change.edit.reconnected_faces.size(),
      .added_faces = replaced ? count_faces(sites(b).mesh()) : change.edit.added_faces.size(),
      .new_layout = replaced};
}

void MovingPair::bound_errors(Frame& frame) {
  bounds_[0].measure(surface(0), precision_);
  bounds_[1].measure(surface(1), 0);
  if (precision_ > 0 && bounds_[0].value() > precision_) refine(frame);
  for (int b = 0; b < 2; ++b) {
    frame.error_bound[b] = bounds_[b].value();
    frame.relative_error[b] = bounds_[b].relative_error();
  }
  frame.resolution = surface(0).resolution();
}

void MovingPair::refine(Frame& frame) {
  const sdm::Mesh mesh = surface(0).mesh();
  atlases_[0].resolution = sdm::resolution_for(mesh, precision_, atlases_[0]);
  query_.replace(0, sdm::Shape(mesh, atlases_[0]));
  temporal_.before_restart();
  bounds_[0].rebuild(surface(0));
  if (!frame.topology[0]) frame.topology[0].emplace();
  frame.topology[0]->new_layout = true;
}
