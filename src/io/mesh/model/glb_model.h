// glTF models under construction.
#pragma once

#include <sdm/error.h>
#include <sdm/map_files.h>
#include <sdm/version.h>
#include <tiny_gltf.h>

#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "core/parallel.h"

namespace sdm::io {

/// The model under construction: a single buffer that grows at the end.
struct GlbModel {
  tinygltf::Model model;

  GlbModel() { model.buffers.emplace_back(); }

  void reserve(std::size_t bytes) { model.buffers[0].data.reserve(bytes + 64); }  // alignment

  int add_view(std::size_t size, int target) {
    auto& data = model.buffers[0].data;
    const std::size_t begin = (data.size() + 3) / 4 * 4;  // accessors of floats start at multiples of 4
    if (begin + size > std::numeric_limits<std::uint32_t>::max() - (1u << 20))
      throw Error("the model exceeds the 4 GB limit of GLB files");
    data.resize(begin + size);
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = begin;
    view.byteLength = size;
    view.target = target;
    model.bufferViews.push_back(view);
    return static_cast<int>(model.bufferViews.size()) - 1;
  }
  [[nodiscard]] unsigned char* view_bytes(int view) {
    return model.buffers[0].data.data() + model.bufferViews[static_cast<std::size_t>(view)].byteOffset;
  }

  /// `Element`: a scalar or an array of N scalars, consistent with `type`. Sets the elements by fill(i,
  /// element), in parallel.
  template <class Element, class Fill>
  int add_accessor(std::size_t count, int type, int component_type, int target, const Fill& fill) {
    tinygltf::Accessor accessor;
    accessor.bufferView = add_view(count * sizeof(Element), target);
    accessor.componentType = component_type;
    accessor.type = type;
    accessor.count =
        count * sizeof(Element) /
        (4 * static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type))));
    unsigned char* const bytes = view_bytes(accessor.bufferView);
    parallel_for(count, 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        Element element;
        fill(i, element);
        std::memcpy(bytes + i * sizeof(Element), &element, sizeof(Element));
      }
    });
    model.accessors.push_back(accessor);
    return static_cast<int>(model.accessors.size()) - 1;
  }

  /// The only scene, of these nodes.
  void add_scene(const std::vector<tinygltf::Node>& nodes) {
    tinygltf::Scene scene;
    for (std::size_t i = 0; i < nodes.size(); ++i) scene.nodes.push_back(static_cast<int>(i));
    model.nodes = nodes;
    model.scenes.push_back(scene);
    model.defaultScene = 0;
    model.asset.version = "2.0";
    model.asset.generator = std::string("sdm ") + kVersion;
  }
};

/// glTF uses single precision: positions far from the origin are stored relative to an origin near the mesh.
struct Placement {
  Vec3 origin{};
  double scale = 1;  ///< metres per unit
};

/// The placement of what is in a box. Throws sdm::Error if it is too large.
[[nodiscard]] Placement placement(const Box& box, const std::string& units);

/// A node in this place, whose vertical axis is that of glTF, y.
[[nodiscard]] tinygltf::Node placed_node(const Placement& place, UpAxis up);

}  // namespace sdm::io
