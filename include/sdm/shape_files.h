/// Shapes as files, so that a program that starts does not build them again.
///
/// Threads: the functions may be called concurrently, unless two of them write the same file.
#pragma once

#include <sdm/api.h>
#include <sdm/shape.h>

#include <filesystem>

namespace sdm {

/// Writes a shape, some twenty times the size of its mesh; the file appears whole or not at all. Throws
/// sdm::Error if it cannot be written. Cost: linear.
SDM_API void write_shape(const std::filesystem::path& file, const Shape& shape);

/// What is checked of a file.
struct ReadShapeOptions {
  /// Whether write_shape() certainly wrote the file, so that only damage is looked for: see StoredShape.
  bool trusted = false;
};

/// Reads a shape that write_shape() wrote, in a small part of the time of building it: its arrays are views
/// of the file, which is mapped into memory, so that processes that read the same file share it. All results
/// are those of the shape that was written, to the bit. The file may be deleted, renamed or written anew by
/// write_shape() while the shape exists, but not changed in place by other programs. Throws sdm::Error if it
/// cannot be read, if another version of sdm has written it, or if it is incomplete or damaged. A file that
/// is not trusted may come from anyone; see Shape::Shape(StoredShape). Cost: linear, all cores.
[[nodiscard]] SDM_API Shape read_shape(const std::filesystem::path& file,
                                       const ReadShapeOptions& options = {});

}  // namespace sdm
