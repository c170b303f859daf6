#include "sequence_body.h"

#include <fmt/format.h>
#include <sdm/error.h>

#include "cad_options.h"
#include "sequence_state.h"

namespace {

sdm::SequenceOptions before_placement(sdm::SequenceOptions options,
                                      const std::vector<sdm::io::PlacementStep>& steps) {
  options.tessellation = ::before_placement(options.tessellation, steps);
  return options;
}

}  // namespace

Body::Body(const std::string& input, const std::string& steps, const sdm::SequenceOptions& options)
    : input_(input),
      changes_(options.allow_topology),
      sequence_(input, before_placement(options, sdm::io::parse_placement(steps))),
      steps_(sdm::io::without_fit(sequence_.mesh(), sdm::io::parse_placement(steps))) {}

void Body::read(std::size_t frame) {
  const std::span<const sdm::Vec3> read = sequence_.positions(frame);
  replaced_ = behind_ || sequence_.change().replaced;
  behind_ |= !sequence_.change().none();
  placed_.assign(read.begin(), read.end());
  sdm::io::place(placed_, steps_);
}

sdm::Mesh Body::mesh() const {
  sdm::Mesh mesh = sequence_.mesh();
  sdm::io::place(mesh, steps_);
  return mesh;
}

sdm::TopologyChange Body::change() const {
  if (replaced_) return {.edit = {}, .replaced = true};
  sdm::TopologyChange change = sequence_.change();
  for (auto& moved : change.edit.moved_vertices) moved.position = placed_[moved.vertex];
  const std::size_t first = placed_.size() - change.edit.added_vertices.size();
  for (std::size_t i = 0; i < change.edit.added_vertices.size(); ++i)
    change.edit.added_vertices[i] = placed_[first + i];
  return change;
}

double Body::deviation() const {
  return placed_deviation(tessellation(), steps_);
}

std::uint64_t Body::hash() const {
  return changes_ ? hash_of(sequence_.mesh()) : hash_of(placed_);
}

std::size_t common_frames(const Body& a, const Body& b) {
  if (a.still()) return b.frames();
  if (b.still() || a.frames() == b.frames()) return a.frames();
  throw sdm::Error(fmt::format(
      "{} has {} frames and {} has {}; give two sequences of the same length, or one mesh at rest", a.input(),
      a.frames(), b.input(), b.frames()));
}
