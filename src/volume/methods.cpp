#include <sdm/error.h>
#include <sdm/volume.h>

#include <algorithm>
#include <string>

namespace sdm {
namespace {

// The errors of best and reference are those of their engines. Those of the others follow from the slack of
// regions and single precision (volume/slice_raster.h).
constexpr FieldMethodInfo kMethods[] = {
    {FieldMethod::best, "best", "the cpu engine on blocks of points", 1e-6, false},
    {FieldMethod::reference, "reference", "each point by itself, in double precision", 1e-7, false},
    {FieldMethod::brute_force, "brute_force", "every site in every slice (Hoff et al. 1999)", 2e-6, false},
    {FieldMethod::difi, "difi", "slices swept, sites culled and clamped (Sud et al. 2004)", 2e-6, false},
    {FieldMethod::linear_factorization, "linear_factorization",
     "regions clipped to slices, linear vectors (Sud et al. 2006)", 2e-6, false},
    {FieldMethod::csc, "csc", "polyhedra scan converted in a narrow band (Mauch 2003)", 2e-6, true},
};

}  // namespace

std::span<const FieldMethodInfo> field_methods() {
  return kMethods;
}

const FieldMethodInfo& field_method(std::string_view name) {
  std::string names;
  for (const FieldMethodInfo& info : kMethods) {
    if (info.name == name) return info;
    names += (names.empty() ? "" : ", ") + std::string(info.name);
  }
  throw Error("there is no method \"" + std::string(name) + "\" for fields; choose one of " + names);
}

const FieldMethodInfo& field_method(FieldMethod method) {
  const auto found = std::ranges::find(kMethods, method, &FieldMethodInfo::method);
  if (found == std::end(kMethods)) throw Error("unknown method for fields");
  return *found;
}

}  // namespace sdm
