// The two bodies of `sdm sequence`, from frame to frame.
#pragma once

#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/proximity_query.h>

#include <array>
#include <cstddef>
#include <vector>

#include "sequence_body.h"
#include "sequence_bound.h"
#include "sequence_report.h"
#include "sequence_state.h"
#include "sequence_temporal.h"

/// Both bodies, with their atlases and error bounds, in the frame that was moved to last.
class MovingPair {
 public:
  /// The bodies at their first frames. `precision`: the largest error bound of O1's map; 0: any. `temporal`
  /// is notified of what changes O1's atlas, and must outlive the pair.
  MovingPair(std::array<Body, 2> bodies, const std::array<sdm::AtlasOptions, 2>& atlases,
             const sdm::ProximityOptions& options, double precision, TemporalRecorder& temporal);

  /// Reads both bodies before either is moved. Changes of the topology are followed at once, as they are
  /// relative to the frame that was read before. Sets the times and the changes of topology of `frame`, which
  /// has its number. Throws sdm::Error.
  void move(Frame& frame);
  /// Sets the error bounds of `frame`, and its resolution. A frame that could not be read when the resolution
  /// was chosen, or whose atlas is new, may need a finer one than it has: it then gets another atlas.
  void bound_errors(Frame& frame);
  /// Whether the error bounds depend on which frames they were asked for before.
  [[nodiscard]] bool has_history() const;

  [[nodiscard]] sdm::ProximityQuery& query() { return query_; }
  [[nodiscard]] const sdm::Surface& surface(int body) const { return query_.surface(body); }
  [[nodiscard]] const sdm::Sites& sites(int body) const { return query_.sites(body); }
  [[nodiscard]] const FrameHash& hash() const { return hash_; }
  /// How far both bodies may be from the surfaces that are meant.
  [[nodiscard]] double guard() const { return bodies_[0].deviation() + bodies_[1].deviation(); }

 private:
  void follow(int body, const sdm::TopologyChange& change, Frame& frame);
  void refine(Frame& frame);

  std::array<Body, 2> bodies_;
  std::array<sdm::AtlasOptions, 2> atlases_;
  sdm::ProximityQuery query_;
  std::vector<FrameBound> bounds_;  // one for each body
  double precision_;
  TemporalRecorder& temporal_;
  FrameHash hash_;
  std::array<bool, 2> edited_{};  // bodies, since their bounds were built
};

/// Calls `work`, whose errors then name the frame.
template <class Work>
void naming_frame(std::size_t frame, const Work& work) try {
  work();
} catch (const sdm::Cancelled&) {
  throw;
} catch (const sdm::Error& error) {
  throw sdm::Error(fmt::format("frame {}: {}", frame, error.what()), error.remedy());
}
