#include "weld.h"

#include <sdm/error.h>

#include "declared_options.h"
#include "format.h"

namespace {

constexpr const char* kAutomatic = "auto";
constexpr auto kTolerance = sdm::option_of(&sdm::WeldOptions::tolerance);

// What --weld would do for a mesh that is open, as a clause; empty if that does not close it, or was done.
std::string weld_advice(const Input& input) {
  if (input.weld) return {};
  const sdm::Welded welded = sdm::weld(input.mesh);
  if (welded.joined_vertices == 0 || !sdm::inspect(welded.mesh).closed) return {};
  return fmt::format("it closes with --weld auto, which moves vertices by at most {}",
                     number(welded.largest_move));
}

}  // namespace

void add_weld_option(CLI::App& app, std::optional<sdm::WeldOptions>& weld, const std::string& meshes) {
  sdm::OptionInfo info = sdm::info_of(kTolerance);
  info.name = "weld";
  info.text = fmt::format(
      "Join boundary edges of {} whose ends are at most T apart, after the transforms; auto: at "
      "most 0.001 of the diagonal. No gap wider than a quarter of its edges is closed. Distances "
      "are then to the welded mesh.",
      meshes);
  info.words = {kAutomatic};
  info.value = "T|auto";
  add_declared_option(app, std::move(info), [&weld](const std::string& text) {
    sdm::WeldOptions& options = weld.emplace();
    return text == kAutomatic || sdm::read_value(kTolerance, text, options);
  });
}

void weld(Input& input, const sdm::WeldOptions& options) {
  sdm::Welded welded = sdm::weld(input.mesh, options);
  input.weld = welded;
  if (input.vertices)
    for (std::uint32_t& vertex : input.vertices->mesh_vertex)
      if (vertex != sdm::kNone) vertex = welded.vertex[vertex];
  input.mesh = std::move(welded.mesh);
  if (welded.joined_vertices == 0) {
    if (welded.boundary_edges > 0)
      input.notes.push_back(fmt::format("{}: --weld joined nothing: {} boundary edges are left", input.file,
                                        welded.boundary_edges));
    return;
  }
  std::string text = fmt::format("{}: {} vertices were joined to others, by moves of at most {}", input.file,
                                 welded.joined_vertices, number(welded.largest_move));
  if (welded.boundary_edges > 0) text += fmt::format("; {} boundary edges are left", welded.boundary_edges);
  if (welded.t_junctions > 0)
    text += fmt::format(", with {} vertices in the middle of others", welded.t_junctions);
  input.notes.push_back(std::move(text));
}

std::optional<std::string> note_on_welding(const sdm::SignUsed& used, sdm::SignMethod wanted,
                                           const Input& to) {
  if (used.method != sdm::SignMethod::none || wanted == sdm::SignMethod::none) return std::nullopt;
  const std::string advice = weld_advice(to);
  if (advice.empty()) return std::nullopt;
  return fmt::format("{} is open, so distances are unsigned; {}", to.file, advice);
}

void check_closed(const Input& input, const std::string& what) {
  if (input.info->closed) return;
  const std::string advice = weld_advice(input);
  if (input.info->boundary_edges == 0)
    throw sdm::Error(
        fmt::format("{}: {} needs a closed mesh, and {} edges of this one have more than two faces",
                    input.file, what, input.info->nonmanifold_edges));
  throw sdm::Error(fmt::format("{}: {} needs a closed mesh, and this one is open; {}", input.file, what,
                               advice.empty() ? "close its holes" : advice));
}

void check_sign(const std::optional<sdm::Tolerance>& tolerance, const sdm::SignUsed& sign, const Input& to) {
  if (!tolerance || !tolerance->needs_sign() || sign.method != sdm::SignMethod::none) return;
  const std::string advice = weld_advice(to);
  throw sdm::Error(
      fmt::format("{}: the tolerance {}:{} differs by sign, but the distances are unsigned: {}; {}", to.file,
                  tolerance->lower, tolerance->upper, sign.reason,
                  advice.empty() ? "use one number, or another --sign" : advice));
}
