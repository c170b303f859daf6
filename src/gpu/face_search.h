// The search on a device: the faces that may be closest to each of many points.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "gpu/sites_on_device.h"

namespace sdm::gpu {

/// The faces that may be closest to a point, as the device writes them.
struct FaceList {
  static constexpr std::uint32_t kMost = 15;

  std::uint32_t head;
  std::uint32_t number[kMost];  ///< of the faces, in the order of the leaves

  [[nodiscard]] std::uint32_t count() const { return head & 15u; }
  /// Whether there may be others: there was no room for them.
  [[nodiscard]] bool incomplete() const { return (head & 16u) != 0; }
  /// Whether it was searched for alone, as the points beside it are too far from each other.
  [[nodiscard]] bool alone() const { return (head & 32u) != 0; }
  [[nodiscard]] std::uint32_t nodes() const { return head >> 6 & 0xfffu; }  ///< visited, at most 4095
  [[nodiscard]] std::uint32_t tests() const { return head >> 18; }          ///< faces compared, at most 16383
};

/// The lists of some points for each part of the sites (SitesOnDevice).
struct FaceLists {
  std::size_t points = 0;
  std::vector<std::uint32_t> first;  ///< of the faces of each part
  std::vector<FaceList> lists;       ///< those of all points for the first part, then for the next

  [[nodiscard]] const FaceList& of(std::size_t part, std::size_t point) const {
    return lists[points * part + point];
  }
};

/// A point in the unit frame, and nothing farther than `within` is closest; negative if there is nothing to
/// be found.
struct QueryPoint {
  float position[3];
  float within;
};

/// A sample, as in shaders/place_samples.wgsl.
struct Sample {
  std::uint32_t vertices[3];
  float weights[2];  ///< of vertices 1 and 2; that of vertex 0 is what is left of 1
};

/// Samples on a device, and the vertices in the unit frame, of three numbers each.
struct SamplesOnDevice {
  const Buffer& samples;
  const Buffer& positions;
};

/// What searches on a device took.
struct SearchTimes {
  std::size_t dispatches = 0;
  double upload_ms = 0;  ///< of sites
  double search_ms = 0;  ///< of points, with their transfers
};

class FaceSearch {
 public:
  /// Points that are searched for together, if they are near each other.
  static constexpr std::size_t kTile = 64;

  /// Opens a device as Device() does.
  explicit FaceSearch(std::string_view wanted);

  [[nodiscard]] const Device& device() const { return device_; }
  Device& device() { return device_; }

  /// Finds the faces of each part of the sites that may be closest to each of the points, whose number is a
  /// multiple of kTile. In dispatches that are expected to take 10 to 30 ms, between which the call can be
  /// cancelled.
  void find(const sites::SitesData& sites, std::span<const QueryPoint> points, FaceLists& found,
            SearchTimes& times);
  /// Writes the distances of `count` samples in the unit frame to a buffer on the device, of 4 bytes each.
  void measure(const sites::SitesData& sites, const SamplesOnDevice& samples, std::size_t count,
               const Buffer& distances);

 private:
  const SitesOnDevice& place(const sites::SitesData& sites);
  void reserve(std::size_t points);
  /// Calls search(first, count) for parts of so many points.
  template <class Search>
  void in_dispatches(std::size_t points, SearchTimes& times, const Search& search);
  [[nodiscard]] BindGroup bind(const Pipeline& pipeline, const SitesOnDevice::Part& part,
                               std::initializer_list<Device::Binding> others);
  /// Calls run(steps) for the steps of the search of points that were uploaded.
  template <class Run>
  void search(const SitesOnDevice& sites, const SitesOnDevice::Part& part, std::size_t points,
              const Run& run);

  static constexpr std::size_t kKept = 4;  // shapes

  Device device_;
  Pipeline samples_, tile_balls_, tiles_together_, points_alone_, distances_;
  std::vector<std::unique_ptr<SitesOnDevice>> kept_;  // the last ones that were searched, the latest first
  Buffer part_, points_, results_, read_back_, tiles_;
  std::size_t room_ = 0;         // points of the buffers
  std::size_t dispatch_ = 4096;  // points
};

}  // namespace sdm::gpu
