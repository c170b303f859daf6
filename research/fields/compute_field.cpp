#include <sdm/error.h>

#include <algorithm>
#include <string>
#include <vector>

#include "closest/reference/reference_engine.h"
#include "core/memory.h"
#include "core/stopwatch.h"
#include "research/fields/drawing_task.h"
#include "research/fields/scan_convert.h"
#include "research/fields/site_signs.h"
#include "research/fields/sweep_slices.h"
#include "volume/field_arrays.h"
#include "volume/field_by_engine.h"

namespace sdm::fields {
namespace {

// The errors of best and reference are those of their engines. Those of the others follow from the slack of
// regions and single precision (drawn_sites.cpp).
constexpr MethodInfo kMethods[] = {
    {Method::best, "best", 1e-6, false},
    {Method::reference, "reference", 1e-7, false},
    {Method::brute_force, "brute_force", 2e-6, false},
    {Method::difi, "difi", 2e-6, false},
    {Method::linear_factorization, "linear_factorization", 2e-6, false},
    {Method::csc, "csc", 2e-6, true},
};

void check_options(const Options& options, const MethodInfo& method) {
  if (method.needs_max_distance && options.max_distance == std::numeric_limits<double>::infinity())
    throw Error("the method " + std::string(method.name) + " needs a maximum distance");
  if (!(options.tessellation >= 0)) throw Error("the tessellation must not be negative");
  if (options.tessellation == 0) return;
  if (method.method != Method::brute_force)
    throw Error("distance functions are drawn as meshes by the method brute_force only, not by " +
                std::string(method.name));
  if (options.sign != SignMethod::automatic && options.sign != SignMethod::none)
    throw Error("distances of distance functions that are drawn as meshes have no sign");
}

Field draw_field(const Sites& sites, const Grid& grid, const Options& options, const MethodInfo& method) {
  const SignUsed sign =
      options.tessellation > 0
          ? SignUsed{SignMethod::none,
                     "distance functions are drawn as meshes, and what is drawn closest need not be"}
          : choose_sign(sites, options.sign);
  const bool is_signed = sign.method != SignMethod::none;
  const bool with_winners = is_signed || options.sites;
  Field field{volume::new_field(sites, grid,
                                {.max_distance = options.max_distance,
                                 .sites = options.sites,
                                 .relative_error = method.relative_error,
                                 .more_bytes_per_point = with_winners ? sizeof(std::uint32_t) : 0})};
  field.sign = sign;
  field.accuracy += options.tessellation;

  Stopwatch watch;
  const sites::SitesData& data = internals(sites);
  const inside::InsideTest is_inside(data, sign.method, field.accuracy);
  const DrawingTask task{data, grid, options, is_inside, is_signed};
  std::vector<std::uint32_t> winners;  // for signs and sites
  if (with_winners) winners.assign(grid.size(), kNone);
  if (method.method == Method::csc)
    scan_convert(task, field, winners);
  else
    sweep_slices(task, field, winners);
  field.report.milliseconds = watch.lap();
  field.report.field_bytes = volume::bytes_of(field);
  if (with_winners) {
    field.report.working_bytes += winners.size() * sizeof(std::uint32_t);
    store_sites(task, winners, field);
    field.work.sign_milliseconds = watch.lap();
  }
  field.beyond_max_distance = volume::count_without_value(field.distance);
  return field;
}

}  // namespace

std::span<const MethodInfo> methods() {
  return kMethods;
}

const MethodInfo& info(Method method) {
  const auto found = std::ranges::find(kMethods, method, &MethodInfo::method);
  if (found == std::end(kMethods)) throw Error("unknown method for fields");
  return *found;
}

Field compute_field(const Sites& sites, const Grid& grid, const Options& options) try {
  const MethodInfo& method = info(options.method);
  check_options(options, method);
  const FieldOptions common{.sign = options.sign,
                            .max_distance = options.max_distance,
                            .sites = options.sites,
                            .progress = options.progress};
  Field field;
  FieldReport report;
  switch (options.method) {
    case Method::best:
      field = {sdm::compute_field(sites, grid, common, report), {}, report};
      break;
    case Method::reference:
      field = {volume::field_by_engine(sites, grid, common, reference::ReferenceEngine(), false, report),
               {},
               report};
      break;
    default:
      field = draw_field(sites, grid, options, method);
  }
  field.method = options.method;
  return field;
} catch (const std::bad_alloc&) {
  throw out_of_memory("a distance field");
}

}  // namespace sdm::fields
