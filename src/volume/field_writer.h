// What methods compute a field from, and the arrays that they store it in.
#pragma once

#include <sdm/volume.h>

#include "inside/inside.h"
#include "sites/sites_data.h"

namespace sdm::volume {

struct FieldTask {
  const Sites& o2;
  const sites::SitesData& sites;  ///< of O2
  const Grid& grid;
  const FieldOptions& options;
  const inside::InsideTest& is_inside;
  bool is_signed;
};

/// Stores results in a field whose arrays have their size and no values yet. Threads may store different
/// points concurrently.
class FieldWriter {
 public:
  explicit FieldWriter(DistanceField& field)
      : distance_(field.distance.data()),
        site_(field.site.empty() ? nullptr : field.site.data()),
        site_type_(field.site_type.empty() ? nullptr : field.site_type.data()) {}

  void distance(std::size_t index, float value) const { distance_[index] = value; }
  void site(std::size_t index, SiteType type, std::uint32_t site) const {
    if (site_ == nullptr) return;
    site_[index] = site;
    site_type_[index] = type;
  }

 private:
  float* distance_;
  std::uint32_t* site_;
  SiteType* site_type_;
};

}  // namespace sdm::volume
