// Two bodies that move: separation, collision, penetration depth and contacts.
#include <sdm/mesh_edit.h>
#include <sdm/proximity_query.h>

#include "module/arguments.h"
#include "module/options.h"
#include "module/result.h"

namespace sdm::js {

SDM_EXPORT(sdm_new_pair)
Result* new_pair(const double* positions1, std::uint32_t vertices1, const std::uint32_t* indices1,
                 std::uint32_t triangles1, const double* positions2, std::uint32_t vertices2,
                 const std::uint32_t* indices2, std::uint32_t triangles2, const char* lines,
                 std::uint32_t bytes, const double* numbers) {
  return guarded([&](Result& result) {
    const auto options = read_options<ProximityOptions>({lines, bytes, numbers});
    result.put_object(std::make_unique<ProximityQuery>(mesh(positions1, vertices1, indices1, triangles1),
                                                       mesh(positions2, vertices2, indices2, triangles2),
                                                       options));
  });
}

SDM_EXPORT(sdm_free_pair) void free_pair(ProximityQuery* pair) {
  delete pair;
}

/// A pose as twelve numbers: the first three rows of the matrix.
SDM_EXPORT(sdm_set_pose) Result* set_pose(ProximityQuery* pair, std::int32_t body, const double* rows) {
  return guarded([&](Result&) {
    Transform pose;
    for (std::size_t i = 0; i < 12; ++i) pose.rows[i / 4][i % 4] = rows[i];
    pair->set_pose(body, pose);
  });
}

SDM_EXPORT(sdm_refit_pair)
Result* refit_pair(ProximityQuery* pair, std::uint32_t body, const double* positions,
                   std::uint32_t vertices) {
  return guarded([&](Result&) {
    const auto moved = points(positions, vertices);
    pair->refit(body == 0 ? moved : std::span<const Vec3>{}, body == 1 ? moved : std::span<const Vec3>{});
  });
}

SDM_EXPORT(sdm_colliding) Result* colliding(ProximityQuery* pair) {
  return guarded([&](Result& result) { result.put("colliding", pair->colliding()); });
}

SDM_EXPORT(sdm_separation) Result* separation(ProximityQuery* pair) {
  return guarded([&](Result& result) { result.put_fields("", pair->separation()); });
}

/// Nothing if neither body is a solid.
SDM_EXPORT(sdm_penetration_depth) Result* penetration_depth(ProximityQuery* pair) {
  return guarded([&](Result& result) {
    if (const auto& depth = pair->penetration_depth()) result.put_fields("depth/", *depth);
  });
}

SDM_EXPORT(sdm_contacts) Result* contacts(ProximityQuery* pair) {
  return guarded([&](Result& result) {
    std::vector<Vec3> points1, points2, normals;
    std::vector<double> depths;
    std::vector<std::uint32_t> patches;
    std::vector<std::uint64_t> ids;
    for (const Contact& contact : pair->contacts()) {
      points1.push_back(contact.point1);
      points2.push_back(contact.point2);
      normals.push_back(contact.normal);
      depths.push_back(contact.depth);
      patches.push_back(contact.patch);
      ids.push_back(contact.id);
    }
    result.put("points1", std::move(points1));
    result.put("points2", std::move(points2));
    result.put("normals", std::move(normals));
    result.put("depths", std::move(depths));
    result.put("patches", std::move(patches));
    result.put("ids", std::move(ids));
  });
}

}  // namespace sdm::js
