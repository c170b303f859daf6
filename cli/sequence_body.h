// A body of `sdm sequence`: a sequence of meshes and their placement.
#pragma once

#include <sdm/mesh_files.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "src/io/mesh/placement.h"

class Body {
 public:
  /// `steps`: of the placement; `fit` refers to the first frame. Throws sdm::Error.
  Body(const std::string& input, const std::string& steps, const sdm::SequenceOptions& options);

  [[nodiscard]] const std::string& input() const { return input_; }
  [[nodiscard]] std::size_t frames() const { return sequence_.frame_count(); }
  [[nodiscard]] bool still() const { return frames() == 1; }
  [[nodiscard]] std::string xxh3() const { return sequence_.xxh3(); }

  /// Reads a frame of a moving body. Throws sdm::Error.
  void read(std::size_t frame);
  /// The mesh of the frame that was read last, initially the first.
  [[nodiscard]] sdm::Mesh mesh() const;
  /// The positions of the frame. Requires a call of read().
  [[nodiscard]] std::span<const sdm::Vec3> positions() const { return placed_; }
  /// How the frame differs from the last one for which followed() was called, or else from the first, with
  /// placed positions.
  [[nodiscard]] sdm::TopologyChange change() const;
  void followed() { behind_ = false; }
  /// How the surfaces of the CAD file that was read last became triangles; nothing for other files.
  [[nodiscard]] const std::optional<sdm::Tessellation>& tessellation() const {
    return sequence_.tessellation();
  }
  /// How far the body may be from its surface, as it is placed: 0 unless it is CAD.
  [[nodiscard]] double deviation() const;
  /// Identifies the positions of the frame.
  [[nodiscard]] std::uint64_t hash() const;

 private:
  std::string input_;
  bool changes_;
  bool behind_ = false;    // a change of the topology was read that nothing has followed
  bool replaced_ = false;  // by the frame that was read last
  sdm::MeshSequence sequence_;
  std::vector<sdm::io::PlacementStep> steps_;
  std::vector<sdm::Vec3> placed_;
};

/// The number of frames of both; a body at rest has as many as the other. Throws sdm::Error if they differ.
[[nodiscard]] std::size_t common_frames(const Body& a, const Body& b);
