// The surface that `sdm bake` lays textures on.
#pragma once

#include <sdm/surface.h>

#include <memory>
#include <string>
#include <vector>

#include "report.h"

struct BakeSurface {
  std::unique_ptr<sdm::Surface> surface{};
  std::vector<std::string> notes{};
};

/// Lays LOW out. Throws sdm::Error as sdm::Surface does.
[[nodiscard]] BakeSurface bake_surface(const Input& low, const sdm::BakeRequest& request);
