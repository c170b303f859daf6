// One scale of colours and grey values for several maps.
#pragma once

#include <sdm/io.h>
#include <sdm/map.h>

#include <algorithm>
#include <cmath>
#include <limits>

/// The scale of the distances of all maps together.
class SharedScale {
 public:
  void add(const sdm::DistanceMap& map) {
    for (const float d : map.distance)
      if (std::isfinite(d)) lo_ = std::min(lo_, d), hi_ = std::max(hi_, d);
  }
  void set(sdm::PictureOptions& picture) const {
    if (!(lo_ < hi_)) return;
    if (const auto& tolerance = picture.tolerance;
        tolerance && picture.colormap == sdm::Colormap::automatic) {
      picture.range = {std::min<double>(lo_, tolerance->lo), std::max<double>(hi_, tolerance->hi)};
      return;
    }
    if (picture.colormap == sdm::Colormap::automatic)
      picture.colormap = lo_ < 0 && hi_ > 0 ? sdm::Colormap::diverging : sdm::Colormap::viridis;
    const double most = std::max(std::abs(lo_), std::abs(hi_));
    if (picture.colormap == sdm::Colormap::diverging)
      picture.range = {-most, most};
    else
      picture.range = {double{lo_}, double{hi_}};
  }

 private:
  float lo_ = std::numeric_limits<float>::infinity(), hi_ = -lo_;
};
