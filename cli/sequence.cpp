#include "sequence.h"

#include <sdm/mesh_files.h>
#include <sdm/sdm.h>

#include <algorithm>
#include <array>
#include <functional>
#include <iostream>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "cad_options.h"
#include "common_options.h"
#include "exit_codes.h"
#include "format.h"
#include "interrupts.h"
#include "notes.h"
#include "output_folder.h"
#include "progress_line.h"
#include "report.h"
#include "sequence_body.h"
#include "sequence_checkpoint.h"
#include "sequence_colors.h"
#include "sequence_files.h"
#include "sequence_frames.h"
#include "sequence_options.h"
#include "sequence_report.h"
#include "sequence_resolution.h"

namespace {

/// The progress of work on all frames: `text` has a place for the number of a frame and one for their count.
std::function<void(std::size_t)> frame_steps(ProgressLine& progress, const char* text, std::size_t count) {
  return [&progress, text, count](std::size_t frame) {
    progress.step(fmt::format(fmt::runtime(text), frame + 1, count));
  };
}

Body open_body(const SequenceCommand& command, int which) {
  const PairCommand& pair = command.pair;
  return which == 0 ? Body(pair.o1, pair.transform_o1, command.reading)
                    : Body(pair.o2, pair.transform_o2, command.reading);
}

std::array<Body, 2> open_bodies(const SequenceCommand& command) {
  return {open_body(command, 0), open_body(command, 1)};
}

Notes notes_on_bodies(const SequenceCommand& command, const std::array<Body, 2>& bodies,
                      const std::array<sdm::Mesh, 2>& first) {
  Notes notes;
  for (int b = 0; b < 2; ++b) {
    if (const auto& tessellation = bodies[b].tessellation())
      notes.push_back(sdm::note_on(*tessellation, bodies[b].input()));
    if (const auto note =
            note_on_precision(bodies[b].input(), first[b].positions, size_of(sdm::bounds(first[b]))))
      notes.push_back(*note);
  }
  std::ranges::copy(sdm::notes_on(sdm::bounds(first[0]), sdm::bounds(first[1])), std::back_inserter(notes));
  if (auto note = note_on_unit(command.pair.units)) notes.push_back(std::move(*note));
  return notes;
}

/// Chooses one scale of colours for all frames, unless it is given or nothing is drawn.
void choose_colors(SequenceCommand& command, std::size_t count, ProgressLine& progress) {
  command.picture.units = command.pair.units;
  if (command.picture.range || (command.outputs.maps_every == 0 && !command.outputs.collect())) return;
  command.picture = colors_for_frames([&] { return open_bodies(command); }, command.picture, command.both,
                                      command.reading.allow_topology,
                                      frame_steps(progress, "colours: frame {} of {}", count));
}

/// The layouts of both bodies.
std::array<sdm::AtlasOptions, 2> layouts(const SequenceCommand& command, const Checkpoint& checkpoint,
                                         std::size_t count, ProgressLine& progress) {
  std::array<sdm::AtlasOptions, 2> atlases{command.atlas, command.atlas};
  if (command.map_precision > 0)
    atlases[0].resolution =
        checkpoint.resumes()
            ? checkpoint.interrupted().resolution
            : resolution_for_frames([&] { return open_body(command, 0); }, command.atlas,
                                    command.map_precision,
                                    frame_steps(progress, "measuring frame {} of {}", count));
  return atlases;
}

std::string sequence_summary(const SequenceCommand& command, const FrameLoop& loop,
                             const SequenceFiles& files) {
  constexpr std::size_t kColumn = 13;
  const std::optional<sdm::Verdict> verdict = command.picture.tolerance && !loop.frames().empty()
                                                  ? std::optional(verdict_of(loop.frames()))
                                                  : std::nullopt;
  return fmt::format("{}{}{}  results    {}/: {}\n{}",
                     heading(fmt::format("{}, {}", command.pair.o1, command.pair.o2), verdict),
                     summary(loop.frames(), loop.bad(), command.pair.units),
                     note_lines(loop.notes(), kColumn), command.out.string(), files.listed(),
                     note_lines(files.notes(), kColumn));
}

/// Throws Interrupted or sdm::Error, with what remains, unless all frames were computed.
void check_end(FrameLoop::End end, const FrameLoop& loop, std::size_t finished, std::size_t count,
               const std::string& folder) {
  if (end == FrameLoop::End::interrupted)
    throw Interrupted(loop.complete()
                          ? fmt::format("interrupted; all {} frames are in {}", count, folder)
                          : fmt::format("interrupted; {} of {} frames are in {} (--resume continues)",
                                        finished, count, folder));
  if (end == FrameLoop::End::stopped)
    throw sdm::Error(
        fmt::format("{}; {} earlier frames are in {} (--keep-going skips bad frames, --resume continues)",
                    loop.bad().back().fault, loop.frames().size(), folder));
}

/// Writes the results of all frames, or of those before an interrupt or the first bad frame, which is then
/// reported as Interrupted or sdm::Error. Returns the exit code.
int run(SequenceCommand command) {
  limit_threads(command.pair.threads);
  Checkpoint checkpoint(command.out, options_json(command), command.resume);
  OutputFolder out(command.out, {.command = "sequence",
                                 .planned = SequenceFiles::planned(command.outputs),
                                 .keeps =
                                     [&](const std::filesystem::path& file) {
                                       return checkpoint.resumes() && file != "frames.jsonl";
                                     },
                                 .check = [&] { checkpoint.check_unchanged(); }});
  ProgressLine progress(command.pair.quiet);
  command.atlas.progress = progress.callback();
  if (command.picture.tolerance)
    command.reading.tessellation.at_most = deflection_for(*command.picture.tolerance);

  std::array<Body, 2> bodies = open_bodies(command);
  check_deflection(command.reading.tessellation,
                   std::ranges::any_of(bodies, [](const Body& b) { return b.tessellation().has_value(); }));
  const std::size_t count = common_frames(bodies[0], bodies[1]);
  const auto engine = make_engine(command.engine, {}, command.atlas);
  const std::array<sdm::Mesh, 2> first{bodies[0].mesh(), bodies[1].mesh()};
  Notes notes = notes_on_bodies(command, bodies, first);
  checkpoint.begin({hash_of(first[0]), hash_of(first[1])}, {command.pair.o1, command.pair.o2}, count);
  choose_colors(command, count, progress);
  SequenceFiles files(command, out, first);
  if (command.outputs.player) files.set_checksums({bodies[0].xxh3(), bodies[1].xxh3()});
  const std::array<sdm::AtlasOptions, 2> atlases = layouts(command, checkpoint, count, progress);
  checkpoint.set_resolution(atlases[0].resolution);
  FrameLoop loop(command, {std::move(bodies), count, atlases, {.engine = engine}, std::move(notes)},
                 checkpoint, files, progress);

  auto end = FrameLoop::End::complete;
  std::optional<Interrupts::Protected> keeping;  // the frames that an interrupt leaves finished
  out.fill(
      [&] {
        end = loop.process();
        if (end == FrameLoop::End::interrupted) keeping.emplace();
        loop.write(out.staging());
      },
      [&] {
        if (loop.complete()) out.remove_earlier(SequenceState::kFile);
      });
  if (!command.pair.json && !command.pair.quiet) std::cout << sequence_summary(command, loop, files);
  check_end(end, loop, checkpoint.finished(), count, command.out.string());
  return exit_code(verdict_of(loop.frames()));
}

}  // namespace

void add_sequence_command(CLI::App& app) {
  CLI::App* sequence = app.add_subcommand(
      "sequence", "Compute proximity, error bounds and maps of two deforming bodies, frame by frame");
  sequence->footer(
      "A sequence is a folder of numbered mesh files, a pattern such as walk_%04d.ply, mesh.obj+motion.npy\n"
      "with positions (T, V, 3), or an animated glTF file; any other mesh file is a body at rest.\n"
      "Writes frames.jsonl, frames.csv, plot.png, and, for O1, the minimum, mean and maximum distance over\n"
      "time: temporal.exr, min.png, mean.png, max.png; with --player a page that plays the frames, "
      "player.html.\n"
      "An interrupt (Ctrl-C, SIGTERM) or a bad frame keeps the frames that are finished; --resume computes\n"
      "the others, and then all files are those of an uninterrupted run.\n" +
      exit_codes() +
      "\n\nExample:\n"
      "  sdm scene letters -o letters\n"
      "  sdm sequence letters/E.ply+letters/E.npy letters/G.ply+letters/G.npy -o out");
  const auto command = std::make_shared<SequenceCommand>();
  add_options(*sequence, *command);
  sequence->callback([command] {
    check_combination(*command);
    if (const int code = run(*command); code != 0) throw CLI::RuntimeError(code);
  });
}
