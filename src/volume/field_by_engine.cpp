#include "volume/field_by_engine.h"

#include "core/stopwatch.h"
#include "volume/field_arrays.h"
#include "volume/grid_queries.h"

namespace sdm::volume {

DistanceField field_by_engine(const Sites& sites, const Grid& grid, const FieldOptions& options,
                              const Engine& engine, bool only_near, FieldReport& report) {
  const SignUsed sign = choose_sign(sites, options.sign);
  DistanceField field = new_field(sites, grid,
                                  {.max_distance = options.max_distance,
                                   .sites = options.sites,
                                   .relative_error = engine.info().relative_error});
  field.sign = sign;
  Stopwatch watch;
  const sites::SitesData& data = internals(sites);
  const inside::InsideTest is_inside(data, sign.method, field.accuracy);
  const FieldTask task{sites, data, grid, options, is_inside, sign.method != SignMethod::none};
  report.working_bytes = query_grid(task, engine, only_near, field);
  report.milliseconds = watch.lap();
  report.field_bytes = bytes_of(field);
  field.beyond_max_distance = count_without_value(field.distance);
  return field;
}

}  // namespace sdm::volume
