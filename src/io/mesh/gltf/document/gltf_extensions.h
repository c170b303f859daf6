// Extensions of glTF.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string_view>

namespace sdm::io {

/// Throws sdm::Error, naming the extension, if the file requires one that is neither applied nor known to
/// leave the triangles as they are.
void check_required_extensions(const nlohmann::json& root);

/// Returns the extension of a primitive, a buffer view or a buffer that compresses its data; empty if none
/// does.
[[nodiscard]] std::string_view gltf_compression(const nlohmann::json& object);

[[noreturn]] void refuse_compressed(std::string_view extension);

/// Returns an extension of an object; null if it has none of this name.
[[nodiscard]] const nlohmann::json* gltf_extension(const nlohmann::json& object, const char* name);

}  // namespace sdm::io
