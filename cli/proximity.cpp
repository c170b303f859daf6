#include "proximity.h"

#include <fmt/format.h>
#include <sdm/io.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <iostream>
#include <iterator>
#include <memory>

#include "alignment.h"
#include "common_options.h"
#include "format.h"
#include "notes.h"
#include "pair_options.h"
#include "progress_line.h"
#include "proximity_report.h"
#include "report.h"
#include "stopwatch.h"

namespace {

void run(PairCommand command, const AlignCommand& align) {
  limit_threads(command.threads);
  ProgressLine progress(command.quiet);

  progress.step("import");
  Stopwatch watch;
  Input o1, o2;
  const auto load = [](Input& input, const char* role, const std::string& file,
                       const std::string& transform) {
    input = load_input(role, file, transform);
    inspect(input);
  };
  sdm::run_concurrently({[&] { load(o1, "o1", command.o1, command.transform_o1); },
                         [&] { load(o2, "o2", command.o2, command.transform_o2); }});
  const double import_ms = watch.lap();
  std::optional<AlignOutcome> aligned;
  if (align.on) aligned = align_mesh(o1.mesh, sdm::Sites(o2.mesh), align, progress.callback());
  Notes all_notes = notes_on(o1, o2);
  if (aligned) std::ranges::copy(notes(*aligned), std::back_inserter(all_notes));
  const double size = std::min(size_of(sdm::bounds(o1.mesh)), size_of(sdm::bounds(o2.mesh)));
  watch.lap();
  sdm::ProximityQuery query(o1.mesh, o2.mesh, command.options);
  const double build_ms = watch.lap();
  progress.step("queries");
  nlohmann::ordered_json answers = to_json(query);
  const double query_ms = watch.lap();

  if (command.json) {
    nlohmann::ordered_json json;
    json["version"] = sdm::kVersion;
    json["o1"] = to_json(o1);
    json["o2"] = to_json(o2);
    json["units"] = command.units;
    if (aligned) json["alignment"] = to_json(*aligned);
    json["notes"] = all_notes;
    json.update(answers);
    json["time_ms"] = {{"import", import_ms}, {"build", build_ms}, {"query", query_ms}};
    std::cout << to_text(json);
  } else if (!command.quiet) {
    std::cout << o1.file << ", " << o2.file << "\n" << summary(query, command.units, size);
    if (aligned) std::cout << summary(*aligned, command.units);
    std::cout << note_lines(all_notes, 13);
  }
}

}  // namespace

void add_proximity_command(CLI::App& app) {
  CLI::App* proximity = app.add_subcommand(
      "proximity", "Compute separation, collision, penetration depth and contacts of two meshes");
  proximity->footer(
      "Every number is marked as exact or bounded, with its bounds.\n\n"
      "Example, two meshes in contact:\n"
      "  sdm proximity bunny.obj armadillo.off --transform-o1 fit --transform-o2 fit,translate:0.1:0:0");
  const auto command = std::make_shared<PairCommand>();
  add_options(*proximity, *command, {fmt::format("A mesh ({})", sdm::mesh_format_names()), "The other mesh"});
  const auto align = std::make_shared<AlignCommand>();
  add_align_options(*proximity, *align);
  proximity->callback([command, align] { run(*command, *align); });
}
