// The wall thickness of a solid, as a measure.
#pragma once

#include <sdm/thickness.h>

#include "map/measure.h"
#include "map/thickness/thickness_search.h"

namespace sdm::thickness {

class ThicknessMeasure final : public map::FaceMeasure {
 public:
  /// All must outlive this. Throws sdm::Error for options that do not apply.
  ThicknessMeasure(const Mesh& mesh, const Sites& sites, const ThicknessOptions& options);

  [[nodiscard]] std::unique_ptr<map::FaceSearch> search() const override;

 private:
  Walls walls_;
  ThicknessMethod method_;
};

}  // namespace sdm::thickness
