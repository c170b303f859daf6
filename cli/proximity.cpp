#include "proximity.h"

#include <fmt/format.h>
#include <sdm/io.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <optional>

#include "alignment.h"
#include "common_options.h"
#include "input_pair.h"
#include "notes.h"
#include "pair_options.h"
#include "print.h"
#include "progress_line.h"
#include "proximity_report.h"
#include "src/core/stopwatch.h"
#include "src/io/json/report_json.h"
#include "unit_options.h"

namespace {

using Json = nlohmann::ordered_json;

void run(const PairCommand& command, const AlignCommand& align) {
  limit_threads(command.threads);
  ProgressLine progress(command.quiet);
  progress.step("import");
  InputPair pair = load_pair(command, {.inspects = true});
  std::optional<AlignOutcome> aligned;
  if (align.on)
    aligned = align_mesh(pair.o1.mesh, sdm::Sites(pair.o2.mesh), pair.o2, align, progress.callback());
  Notes all_notes = notes_on(pair.o1, pair.o2);
  if (auto note = note_on_unit(command.units)) all_notes.push_back(std::move(*note));
  if (aligned) std::ranges::copy(notes(*aligned), std::back_inserter(all_notes));
  sdm::Stopwatch watch;
  sdm::ProximityQuery query(pair.o1.mesh, pair.o2.mesh, command.options);
  const double build_ms = watch.lap();
  progress.step("queries");
  const Json answers = sdm::to_json(query);
  const double query_ms = watch.lap();

  const auto report = [&] {
    Json json = report_on(pair, command.units);
    if (aligned) json["alignment"] = to_json(*aligned, command.units);
    json["settings"] = sdm::settings_json(command.options);
    json["notes"] = all_notes;
    json.update(answers);
    json["time_ms"] = {{"import", pair.import_ms}, {"build", build_ms}, {"query", query_ms}};
    return json;
  };
  print(command, report, [&] {
    return fmt::format("{}, {}\n{}{}{}", command.o1, command.o2,
                       summary(query, command.units, smaller_size(pair)),
                       aligned ? summary(*aligned, command.units) : "", note_lines(all_notes, 13));
  });
}

}  // namespace

void add_proximity_command(CLI::App& app) {
  CLI::App* proximity = app.add_subcommand(
      "proximity",
      "Compute separation, collision, penetration depth, contacts and the way apart of two meshes");
  proximity->footer(
      "Every number is marked as exact or bounded, with its bounds.\n\n"
      "Example, two meshes in contact:\n"
      "  sdm proximity bunny.obj armadillo.off --transform-o1 fit --transform-o2 fit,translate:0.1:0:0");
  const auto command = std::make_shared<PairCommand>();
  add_options(*proximity, *command, {fmt::format("A mesh ({})", sdm::mesh_format_names()), "The other mesh"});
  add_pair_reading(*proximity, *command);
  const auto align = std::make_shared<AlignCommand>();
  add_align_options(*proximity, *align);
  proximity->callback([command, align] {
    check_units(command->units, command->o1, command->transform_o1);
    check_units(command->units, command->o2, command->transform_o2);
    run(*command, *align);
  });
}
