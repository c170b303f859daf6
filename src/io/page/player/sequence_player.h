/// A page that plays a sequence: two deforming bodies, coloured by distance.
///
/// Threads: an object is used by one thread at a time.
#pragma once

#include <sdm/map_files.h>
#include <sdm/mesh.h>
#include <sdm/sites.h>
#include <sdm/tolerance.h>
#include <sdm/types.h>

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace sdm {

/// Verdicts on a tolerance.
struct PlayerVerdicts {
  Tolerance tolerance{};
  Verdict of_all = Verdict::pass;
  std::vector<Verdict> of_frames;  ///< one for each frame added
  bool certified = false;          ///< of_all is proven
  std::string doubt{};             ///< a clause: why of_all is Verdict::doubtful
};

/// Options of a SequencePlayer.
struct PlayerOptions {
  std::array<std::string, 2> names{"O1", "O2"};
  std::array<std::string, 2>
      xxh3{};  ///< player.html: of the files, as of MeshSequence::xxh3(); empty: unknown
  std::string units{};
  UpAxis up = UpAxis::y;
  /// Colormap, range and tolerance, of all frames. Default: as fixed_colors() chooses from the distances of
  /// all frames.
  PictureOptions colors{};
  double frames_per_second = 30;             ///< animation.glb: greater than 0
  std::optional<PlayerVerdicts> verdicts{};  ///< player.html: if there is a tolerance
};

/// Collects the frames of a sequence, and writes them as player.html: one file that opens in a browser, from
/// disk and without a network, with a time slider and curves that are linked to it. Coarse bodies are drawn
/// with more triangles, which have distances of their own. Long sequences are thinned out, to about 8 million
/// coordinates: of every second, fourth, … frame; the page states that.
class SDM_API SequencePlayer {
 public:
  /// The bodies in any frame; their triangles must not change. `both`: O2 is also coloured, by its distance
  /// to O1.
  SequencePlayer(const Mesh& o1, const Mesh& o2, bool both);
  ~SequencePlayer();
  SequencePlayer(SequencePlayer&&) noexcept;
  SequencePlayer& operator=(SequencePlayer&&) noexcept;

  /// Adds a frame, whose number is greater than that of the last one. Throws sdm::Error, and changes nothing,
  /// if a mesh has other triangles or there is not enough memory. Cost: a closest point for each vertex
  /// drawn.
  void add(std::size_t frame, const Sites& o1, const Sites& o2);

  /// `options` with a range from the distances of the frames so far, as fixed_colors() does it.
  [[nodiscard]] PictureOptions colors(const PictureOptions& options) const;

  /// The number of frames added, shown or not.
  [[nodiscard]] std::size_t frames() const;

  /// Writes the page. `panels`: curves with one value for each frame added, in order. Throws sdm::Error
  /// unless they and the verdicts have that, if there is no frame, if the file cannot be written, and if
  /// can_write_html() is false.
  void write(const std::filesystem::path& file, std::span<const PlotPanel> panels,
             const PlayerOptions& options = {}) const;

  /// Writes animation.glb: both bodies as one glTF model, which any viewer plays. Each frame after the first
  /// is a morph target of the positions and of the colours of the vertices, between which viewers
  /// interpolate. The units m, cm, mm, um, in and ft scale it to metres. At most 250 frames and some 50 MB:
  /// of longer sequences one of several frames. Returns the number of frames written. Throws sdm::Error if
  /// there is no frame, if the file cannot be written, and if the bodies are too large for single precision.
  std::size_t write_glb(const std::filesystem::path& file, const PlayerOptions& options = {}) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sdm
