// Where the points of a file come from.
#pragma once

#include <sdm/types.h>

#include <vector>

namespace sdm::io {

struct PointSource {
  PointSource() = default;
  PointSource(const PointSource&) = delete;
  PointSource& operator=(const PointSource&) = delete;
  virtual ~PointSource() = default;

  /// Appends the next points, at most `most`, fewer only at the end, and their normals, if the file has them.
  /// Throws sdm::Error, which does not name the file.
  virtual void read(std::size_t most, std::vector<Vec3>& points, std::vector<Vec3>& normals) = 0;
};

}  // namespace sdm::io
