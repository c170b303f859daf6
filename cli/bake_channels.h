// The channels of `sdm bake`, baked into files.
#pragma once

#include <sdm/bake_files.h>
#include <sdm/match.h>
#include <sdm/sites.h>
#include <sdm/surface.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bake_options.h"
#include "notes.h"
#include "report.h"

/// What is baked.
struct BakePair {
  const BakeCommand& command;
  const Input& high;  ///< its mesh is that of the sites
  const sdm::Sites& sites;
  const sdm::Surface& surface;  ///< of LOW: its texels are the samples
  const sdm::TexelMatches& matches;
  const sdm::MeshLook& look;          ///< of HIGH
  const sdm::MeshAttribute* normals;  ///< of HIGH; null: no channel needs them
};

/// Tangent-space normals, with what the model needs to be drawn with them.
struct NormalMap {
  std::vector<char> png{};  ///< empty: not asked for
  sdm::MeshAttribute normals{}, tangents{};
};

/// What was baked, beside the files.
struct BakedChannels {
  std::vector<std::string> names, files;
  nlohmann::ordered_json report = nlohmann::ordered_json::object();  ///< `textures`
  std::vector<sdm::BakedTexture> textures;                           ///< of the model
  NormalMap normal_map;
  /// The same as the page has them, no larger than it can show.
  std::vector<sdm::BakedTexture> page_textures;
  std::vector<char> page_normal_map;
};

/// Bakes the channels that are asked for, and writes their files into `folder`. Throws sdm::Error as the
/// functions of <sdm/bake.h> do, and for `material` of a mesh that has none.
[[nodiscard]] BakedChannels bake_channels(const BakePair& pair, const std::filesystem::path& folder,
                                          Notes& notes);
