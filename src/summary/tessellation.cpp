#include <sdm/mesh.h>

#include <array>
#include <cstdio>

namespace sdm {

std::string note_on(const Tessellation& t, const std::string& file) {
  std::array<char, 512> text{};
  std::snprintf(
      text.data(), text.size(),
      "was tessellated with a deflection of %.4g mm%s: distances are those of its triangles, from which its "
      "surface was found to deviate by up to %.4g mm (an estimate, from %zu points); verdicts keep so far "
      "from the limits",
      t.deflection, t.limited ? ", as a tenth of the tolerance would take too many triangles" : "",
      t.largest_deviation, t.measured_points);
  return file + " " + text.data();
}

}  // namespace sdm
