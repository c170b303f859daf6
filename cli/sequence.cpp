#include "sequence.h"

#include <sdm/io.h>
#include <sdm/player.h>
#include <sdm/sdm.h>
#include <sdm/sequence.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "common_options.h"
#include "format.h"
#include "interrupts.h"
#include "notes.h"
#include "option_checks.h"
#include "output_folder.h"
#include "pair_options.h"
#include "progress_line.h"
#include "sequence_body.h"
#include "sequence_bound.h"
#include "sequence_colors.h"
#include "sequence_distances.h"
#include "sequence_report.h"
#include "sequence_resolution.h"
#include "sequence_state.h"
#include "sequence_temporal.h"
#include "stopwatch.h"

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

struct SequenceCommand {
  PairCommand pair;
  sdm::AtlasOptions atlas{.resolution = 512};
  sdm::EngineInfo engine = sdm::engines().front();
  std::filesystem::path out;
  int maps_every = 0;
  double rate = 0, map_precision = 0;
  bool keep_going = false, no_temporal = false, resume = false, allow_topology = false;
  bool both = false, player = false, animation = false;
  sdm::PictureOptions picture;
  std::vector<double> range;

  /// Whether the frames are collected for a file that shows all of them.
  [[nodiscard]] bool collects() const { return player || animation; }
  /// Whether distances are measured in each frame.
  [[nodiscard]] bool measures() const { return collects() || both || picture.tolerance; }
};

Json tolerance_json(const SequenceCommand& command) {
  if (const auto& t = command.picture.tolerance) return {t->lo, t->hi};
  return nullptr;
}

/// All that affects the files, except the inputs, by the names of the options.
Json options_of(const SequenceCommand& command) {
  const PairCommand& pair = command.pair;
  return {{"version", sdm::kVersion},
          {"--transform-o1", pair.transform_o1},
          {"--transform-o2", pair.transform_o2},
          {"--units", pair.units},
          {"--margin", pair.options.contact_margin},
          {"--precision", pair.options.depth_precision},
          {"--resolution", {command.atlas.resolution, command.atlas.rows}},
          {"--map-precision", command.map_precision},
          {"--maps", command.maps_every},
          {"--rate", command.rate},
          {"--allow-topology", command.allow_topology},
          {"--engine", command.engine.name},
          {"--no-temporal", command.no_temporal},
          {"--atlas", command.atlas.kind},
          {"--gutter", command.atlas.gutter},
          {"--max-stretch", command.atlas.max_stretch},
          {"--strict-uv", command.atlas.strict_uv},
          {"--both", command.both},
          {"--player", command.player},
          {"--animation", command.animation},
          {"--up", command.picture.up},
          {"--colormap", command.picture.colormap},
          {"--range", command.range},
          {"--tolerance", tolerance_json(command)}};
}

constexpr std::string_view kOfO2 = "_o2";  // ends the names of O2's maps

/// The files of earlier runs that this run replaces.
std::vector<fs::path> earlier_files(const fs::path& folder, bool resumed) {
  if (resumed) return {"frames.jsonl"};
  std::vector<fs::path> files{"frames.jsonl",  "frames.csv",        "plot.png", "temporal.exr",
                              "min.png",       "mean.png",          "max.png",  "player.html",
                              "animation.glb", SequenceState::kFile};
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder / "maps", error)) {
    const fs::path& file = entry.path();
    std::string name = file.stem().string();
    if (name.ends_with(kOfO2)) name.resize(name.size() - kOfO2.size());
    const bool numbered = name.find_first_not_of("0123456789") == std::string::npos;
    if (numbered && (file.extension() == ".exr" || file.extension() == ".png"))
      files.push_back(fs::path("maps") / file.filename());
  }
  return files;
}

sdm::SequenceOptions sequence_options(const SequenceCommand& command) {
  return {.rate = command.rate, .allow_topology = command.allow_topology};
}

std::size_t count_faces(const sdm::Mesh& mesh) {
  return mesh.triangles.size() -
         static_cast<std::size_t>(std::ranges::count_if(mesh.triangles, sdm::is_removed));
}

/// Processes the frames of one command.
class FrameLoop {
 public:
  explicit FrameLoop(const SequenceCommand& command)
      : command_(command),
        state_written_(written(command.out / SequenceState::kFile)),
        resumed_(command.resume ? incomplete_run(command.out, options_of(command)) : std::nullopt),
        out_(command.out, [this] { return earlier(); }),
        progress_(command.pair.quiet),
        bodies_{open_o1(), Body(command.pair.o2, command.pair.transform_o2, sequence_options(command))},
        count_(common_frames(bodies_[0], bodies_[1])),
        lines_(out_.staging() / "frames.jsonl", std::ios::binary) {
    command_.atlas.progress = progress_.callback();
    if (command_.engine.name == "gl")
      (void)sdm::gl_device({}, std::max(command_.atlas.resolution, command_.atlas.rows));  // fails early
    map_options_.engine = sdm::make_engine(command_.engine.name);
    state_.options = options_of(command);
    const std::array<sdm::Mesh, 2> first{bodies_[0].mesh(), bodies_[1].mesh()};
    for (int b = 0; b < 2; ++b)
      if (const auto note =
              note_on_precision(bodies_[b].input(), first[b].positions, size_of(sdm::bounds(first[b]))))
        notes_.push_back(*note);
    std::ranges::copy(notes_on(sdm::bounds(first[0]), sdm::bounds(first[1])), std::back_inserter(notes_));
    state_.meshes = {hash_of(first[0]), hash_of(first[1])};
    if (resumed_) check_meshes();
    if (!command_.range.empty()) command_.picture.range = {command_.range[0], command_.range[1]};
    command_.picture.units = command_.pair.units;
    if (!command_.picture.range && (command_.maps_every > 0 || command_.collects()))
      command_.picture = colors();
    if (command_.collects()) player_.emplace(first[0], first[1], command_.both);
    atlases_ = {command_.atlas, command_.atlas};
    if (command_.map_precision > 0) atlases_[0].resolution = first_resolution();
    state_.resolution = atlases_[0].resolution;
    query_.emplace(sdm::Shape(first[0], atlases_[0]), sdm::Shape(first[1], atlases_[1]),
                   command_.pair.options);
    for (int b = 0; b < 2; ++b) bounds_.emplace_back(query_->surface(b));
  }

  /// Writes the results of all frames, or of those before an interrupt or the first bad frame, which is then
  /// reported as Interrupted or sdm::Error.
  /// Returns whether all frames are within the tolerance, if there is one.
  bool process() {
    std::optional<Interrupts::Protected> keeping;  // the frames that an interrupt leaves finished
    out_.fill(
        [&] {
          if (resumed_) follow();
          const std::size_t kept = state_.frames.size();
          try {
            Stopwatch watch;
            double seconds = 0;
            for (std::size_t i = kept; i < count_ && !stopped_; ++i) {
              progress_.step(status(i, i - kept, seconds));
              use(i);
              seconds += watch.lap() / 1000;
            }
            progress_.step("export");
          } catch (const sdm::Cancelled&) {
            if (state_.frames.size() == kept) throw;  // nothing new
            interrupted_ = true;
            keeping.emplace();
          }
          write_results();
        },
        [&] {
          std::error_code ignored;
          if (complete()) fs::remove(command_.out / SequenceState::kFile, ignored);
        });
    if (!command_.pair.json && !command_.pair.quiet) print_summary();
    const std::string folder = command_.out.string();
    if (interrupted_)
      throw Interrupted(complete()
                            ? fmt::format("interrupted; all {} frames are in {}", count_, folder)
                            : fmt::format("interrupted; {} of {} frames are in {} (--resume continues)",
                                          state_.frames.size(), count_, folder));
    if (stopped_)
      throw sdm::Error(
          fmt::format("{}; {} earlier frames are in {} (--keep-going skips bad frames, --resume continues)",
                      bad_.back().fault, frames_.size(), folder));
    return std::ranges::all_of(frames_, [](const Frame& frame) {
      return std::ranges::all_of(frame.distances, [](const auto& d) { return !d || d->within(); });
    });
  }

 private:
  [[nodiscard]] static fs::file_time_type written(const fs::path& file) {
    std::error_code missing;
    return fs::last_write_time(file, missing);
  }
  // What is in the folder is continued only if it is still that of the run that was interrupted.
  [[nodiscard]] std::vector<fs::path> earlier() const {
    if (resumed_ && written(command_.out / SequenceState::kFile) != state_written_)
      refuse_to_resume(command_.out, "another run has changed it meanwhile");
    return earlier_files(command_.out, resumed_.has_value());
  }
  [[nodiscard]] std::string status(std::size_t frame, std::size_t done, double seconds) const {
    std::string text = fmt::format("frame {} of {}", frame + 1, count_);
    if (done == 0) return text;
    return fmt::format("{}, {:.1f} per second", text, static_cast<double>(done) / seconds);
  }

  [[nodiscard]] Body open_o1() const {
    return {command_.pair.o1, command_.pair.transform_o1, sequence_options(command_)};
  }

  [[nodiscard]] std::uint32_t first_resolution() {
    if (resumed_) return resumed_->resolution;
    return resolution_for_frames([&] { return open_o1(); }, command_.atlas, command_.map_precision,
                                 [&](std::size_t frame) {
                                   progress_.step(fmt::format("measuring frame {} of {}", frame + 1, count_));
                                 });
  }

  [[nodiscard]] sdm::PictureOptions colors() {
    const auto open = [&] {
      return std::array<Body, 2>{
          open_o1(), Body(command_.pair.o2, command_.pair.transform_o2, sequence_options(command_))};
    };
    return colors_for_frames(open, command_.picture, command_.both, command_.allow_topology,
                             [&](std::size_t frame) {
                               progress_.step(fmt::format("colours: frame {} of {}", frame + 1, count_));
                             });
  }

  [[nodiscard]] bool complete() const { return state_.frames.size() == count_; }

  void check_meshes() const {
    for (int b = 0; b < 2; ++b)
      if (resumed_->meshes[b] != state_.meshes[b])
        refuse_to_resume(command_.out,
                         fmt::format("{} is not the mesh of the interrupted run", bodies_[b].input()));
    if (resumed_->frames.size() > count_)
      refuse_to_resume(command_.out,
                       fmt::format("the inputs have {} frames and the interrupted run has finished {}",
                                   count_, resumed_->frames.size()));
  }

  // Moves the bodies through the finished frames, whose results are kept: the closest faces of a frame are
  // sought near those of the frame before.
  void follow() {
    const std::size_t kept = resumed_->frames.size();
    for (std::size_t i = 0; i < kept; ++i) {
      progress_.step(fmt::format("reading finished frame {} of {}", i + 1, kept));
      Frame frame;
      frame.index = i;
      try {
        move(frame);
        if (command_.map_precision > 0 || bounds_[0].has_history() || bounds_[1].has_history())
          measure(frame);
        if (!is_bad(resumed_->frames[i].line)) {
          temporal_.pass();
          if (player_) player_->add(i, query_->sites(0), query_->sites(1));
        }
      } catch (const sdm::Cancelled&) {
        throw;
      } catch (const sdm::Error&) {  // as in the interrupted run, if the hashes agree
      }
      if (hash_ != resumed_->frames[i].hash)
        refuse_to_resume(command_.out, fmt::format("frame {} is not that of the interrupted run", i));
    }
    state_.frames = std::move(resumed_->frames);
    temporal_.resume(std::move(resumed_->temporal));
    for (const auto& [line, hash] : state_.frames) {
      if (is_bad(line))
        bad_.push_back(bad_frame_from(line));
      else
        frames_.push_back(frame_from(line));
      add_line(line);
    }
  }

  void use(std::size_t index) {
    Frame frame;
    frame.index = index;
    try {
      move(frame);
    } catch (const sdm::Cancelled&) {
      throw;
    } catch (const sdm::Error& error) {
      if (!command_.keep_going && state_.frames.empty()) throw;  // there is nothing to keep
      bad_.push_back({index, error.what()});
      const Json line = to_json(bad_.back());
      add_line(line);
      stopped_ = !command_.keep_going;
      if (!stopped_) state_.frames.push_back({line, hash_});
      return;
    }
    Stopwatch watch;
    measure(frame);
    frame.time.error = watch.lap();
    frame.separation = query_->separation();
    frame.colliding = query_->colliding();
    frame.depth = query_->penetration_depth();
    const std::span<const sdm::Contact> contacts = query_->contacts();
    frame.contacts = contacts.size();
    frame.patches = contacts.empty() ? 0 : contacts.back().patch + 1;
    frame.time.query = watch.lap();
    const bool write = command_.maps_every > 0 && index % static_cast<std::size_t>(command_.maps_every) == 0;
    if (write || command_.measures() || !command_.no_temporal)
      sdm::compute_map(query_->surface(0), query_->sites(1), map_options_, map_);
    if (command_.measures()) measure_distances(frame);
    frame.time.map = watch.lap();
    if (write) write_maps(index);
    const Interrupts::Protected finished;  // from here on the frame belongs to the results
    if (!command_.no_temporal) temporal_.add(query_->surface(0), map_);
    if (player_) player_->add(index, query_->sites(0), query_->sites(1));
    frame.time.write = watch.lap();
    Json line = to_json(frame, contacts);
    if (index == 0) line["notes"] = notes_;
    add_line(line);
    frames_.push_back(frame);
    state_.frames.push_back({line, hash_});
  }

  // Both bodies are read before either is moved. Changes of the topology are followed at once, as they are
  // relative to the frame that was read before.
  void move(Frame& frame) {
    Stopwatch watch;
    std::array<std::span<const sdm::Vec3>, 2> positions;
    hash_ = {};
    for (int b = 0; b < 2; ++b) {
      Body& body = bodies_[b];
      if (body.still()) continue;
      body.read(frame.index);
      hash_[b] = body.hash();
      frame.time.read += watch.lap();
      if (const sdm::TopologyChange change = body.change(); !change.none())
        naming(frame, [&] { follow(b, change, frame); });
      else
        positions[b] = body.positions();
      frame.time.update += watch.lap();
    }
    naming(frame, [&] {
      query_->refit(positions[0], positions[1]);
      for (int b = 0; b < 2; ++b)
        if (edited_[b]) bounds_[b].rebuild(query_->surface(b)), edited_[b] = false;
    });
    frame.time.update += watch.lap();
  }

  // Errors of `work` name the frame.
  template <class Work>
  static void naming(const Frame& frame, const Work& work) try {
    work();
  } catch (const sdm::Cancelled&) {
    throw;
  } catch (const sdm::Error& error) {
    throw sdm::Error(fmt::format("frame {}: {}", frame.index, error.what()), error.remedy());
  }

  void follow(int b, const sdm::TopologyChange& change, Frame& frame) {
    edited_[b] = true;
    const std::size_t faces_before = count_faces(query_->sites(b).mesh());
    bool replaced = change.replaced;
    if (!replaced) try {
        if (b == 0) temporal_.before_edit(query_->surface(0));
        query_->edit(b, change.edit);
      } catch (const sdm::Cancelled&) {
        throw;
      } catch (const sdm::Error&) {  // the atlas has no room
        replaced = true;
      }
    if (replaced) {
      query_->replace(b, sdm::Shape(bodies_[b].mesh(), atlases_[b]));
      if (b == 0) temporal_.before_restart();
    }
    bodies_[b].followed();
    frame.topology[b] = {
        .removed_faces = replaced ? faces_before : change.edit.removed_faces.size(),
        .reconnected_faces = replaced ? 0 : change.edit.reconnected_faces.size(),
        .added_faces = replaced ? count_faces(query_->sites(b).mesh()) : change.edit.added_faces.size(),
        .new_layout = replaced};
  }

  void measure(Frame& frame) {
    bounds_[0].measure(query_->surface(0), command_.map_precision);
    bounds_[1].measure(query_->surface(1), 0);
    if (command_.map_precision > 0 && bounds_[0].value() > command_.map_precision) refine(frame);
    for (int b = 0; b < 2; ++b) {
      frame.error_bound[b] = bounds_[b].value();
      frame.relative_error[b] = bounds_[b].relative_error();
    }
    frame.resolution = query_->surface(0).resolution();
  }

  // A frame that could not be read when the resolution was chosen, or whose atlas is new, may need a finer
  // one.
  void refine(Frame& frame) {
    const sdm::Mesh mesh = query_->surface(0).mesh();
    atlases_[0].resolution = sdm::resolution_for(mesh, atlases_[0], command_.map_precision);
    query_->replace(0, sdm::Shape(mesh, atlases_[0]));
    temporal_.before_restart();
    bounds_[0].rebuild(query_->surface(0));
    if (!frame.topology[0]) frame.topology[0].emplace();
    frame.topology[0]->new_layout = true;
  }

  void measure_distances(Frame& frame) {
    for (int b = 0; b < (command_.both ? 2 : 1); ++b) {
      const sdm::Surface& surface = query_->surface(b);
      const sdm::Sites& sites = query_->sites(1 - b);
      if (b == 1) sdm::compute_map(surface, sites, map_options_, other_map_);
      naming(frame, [&] {
        frame.distances[b] = frame_distances(surface, sites, b == 0 ? map_ : other_map_, frame.error_bound[b],
                                             command_.picture.tolerance);
      });
    }
  }

  // All of the frame's maps or, if it throws, none.
  void write_maps(std::size_t index) {
    const fs::path folder = out_.staging("maps");
    std::vector<fs::path> written;
    try {
      for (int b = 0; b < (command_.both ? 2 : 1); ++b) {
        const std::string name = fmt::format("{:04}{}", index, b == 0 ? "" : kOfO2);
        const sdm::DistanceMap& map = b == 0 ? map_ : other_map_;
        sdm::write_exr(written.emplace_back(folder / (name + ".exr")), query_->surface(b), map);
        sdm::write_distance_png(written.emplace_back(folder / (name + ".png")), query_->surface(b), map,
                                command_.picture);
      }
    } catch (...) {
      std::error_code ignored;
      for (const fs::path& file : written) fs::remove(file, ignored);
      throw;
    }
  }

  void add_line(const Json& json) {
    const std::string text = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    lines_ << text;
    if (command_.pair.json) std::cout << text << std::flush;
  }

  void write_results() {
    const fs::path folder = out_.staging();
    lines_.close();
    if (!lines_) throw_write_failure(folder / "frames.jsonl");
    write_text(folder / "frames.csv", to_csv(frames_));
    if (!frames_.empty()) write_plot(folder / "plot.png", frames_, command_.pair.units);
    const sdm::TemporalMaps temporal = temporal_.of(query_->surface(0));
    if (temporal.maps() > 0) write_temporal(folder, temporal);
    if (player_ && player_->frames() > 0) write_collected(folder);
    if (complete()) return;
    state_.temporal = temporal_.maps();
    state_.write(folder / SequenceState::kFile);
  }

  void write_collected(const fs::path& folder) {
    sdm::PlayerOptions options{.names = {bodies_[0].input(), bodies_[1].input()},
                               .units = command_.pair.units,
                               .up = command_.picture.up,
                               .colors = command_.picture};
    if (command_.rate > 0) options.frames_per_second = command_.rate;
    if (command_.player)
      player_->write(folder / "player.html", player_panels(frames_, command_.pair.units), options);
    if (command_.animation) animated_frames_ = player_->write_glb(folder / "animation.glb", options);
  }

  void print_summary() const {
    const bool temporal = temporal_.of(query_->surface(0)).maps() > 0;
    std::cout << fmt::format(
        "{}, {}\n{}{}  results    {}/: frames.jsonl frames.csv{}{}{}{}{}\n", bodies_[0].input(),
        bodies_[1].input(), summary(frames_, bad_, command_.pair.units), note_lines(notes_, 13),
        command_.out.string(), frames_.empty() ? "" : " plot.png",
        temporal ? " temporal.exr min.png mean.png max.png" : "",
        command_.player && player_->frames() > 0 ? " player.html" : "",
        animated_frames_ > 0 ? " animation.glb" : "", command_.maps_every > 0 ? " maps/" : "");
    if (animated_frames_ > 0 && animated_frames_ < player_->frames())
      std::cout << note_lines(Notes{fmt::format("animation.glb has {} of {} frames, evenly spaced",
                                                animated_frames_, player_->frames())},
                              13);
  }

  void write_temporal(const fs::path& folder, const sdm::TemporalMaps& temporal) {
    const sdm::Surface& surface = query_->surface(0);
    sdm::write_exr(folder / "temporal.exr", surface, temporal);
    // The pictures need the other layers of a map.
    if (map_.distance.size() != surface.texel_faces().size())
      sdm::compute_map(surface, query_->sites(1), map_options_, map_);
    const auto use = [&](std::span<const float> values) { std::ranges::copy(values, map_.distance.begin()); };
    sdm::PictureOptions picture = command_.picture;
    if (!picture.range) {  // one scale for the three
      use(temporal.least());
      sdm::DistanceStatistics all = sdm::statistics(surface, map_);
      use(temporal.largest());
      const sdm::DistanceStatistics largest = sdm::statistics(surface, map_);
      all.max = largest.max, all.p99_abs = std::max(all.p99_abs, largest.p99_abs);
      picture = sdm::fixed_colors(picture, all);
    }
    const auto draw = [&](const char* file, std::span<const float> values) {
      use(values);
      sdm::write_distance_png(folder / file, surface, map_, picture);
    };
    draw("min.png", temporal.least());
    draw("mean.png", temporal.mean());
    draw("max.png", temporal.largest());
  }

  SequenceCommand command_;
  fs::file_time_type state_written_;      // before it was read
  std::optional<SequenceState> resumed_;  // its parts move to state_
  OutputFolder out_;
  ProgressLine progress_;
  std::array<Body, 2> bodies_;
  std::size_t count_;
  std::ofstream lines_;
  std::array<sdm::AtlasOptions, 2> atlases_;
  std::optional<sdm::ProximityQuery> query_;
  std::vector<FrameBound> bounds_;  // one for each body
  std::vector<Frame> frames_;
  std::vector<BadFrame> bad_;
  std::array<std::optional<std::uint64_t>, 2> hash_;  // of the positions of the current frame
  SequenceState state_;
  TemporalRecorder temporal_;
  std::array<bool, 2> edited_{};  // bodies, since their bounds were built
  Notes notes_;                   // on the inputs
  bool stopped_ = false, interrupted_ = false;
  sdm::MapOptions map_options_;
  sdm::DistanceMap map_, other_map_;
  std::optional<sdm::SequencePlayer> player_;
  std::size_t animated_frames_ = 0;  // in animation.glb
};

}  // namespace

void add_sequence_command(CLI::App& app) {
  CLI::App* sequence = app.add_subcommand(
      "sequence", "Compute proximity, error bounds and maps of two deforming bodies, frame by frame");
  sequence->footer(
      "A sequence is a folder of numbered mesh files, a pattern such as walk_%04d.ply, mesh.obj+motion.npy\n"
      "with positions (T, V, 3), or a glTF file with morph targets; any other mesh file is a body at rest.\n"
      "Writes frames.jsonl, frames.csv, plot.png, and, for O1, the minimum, mean and maximum distance over\n"
      "time: temporal.exr, min.png, mean.png, max.png; with --player a page that plays the frames, "
      "player.html.\n"
      "An interrupt (Ctrl-C, SIGTERM) or a bad frame keeps the frames that are finished; --resume computes\n"
      "the others, and then all files are those of an uninterrupted run.\n\n"
      "Example:\n"
      "  sdm scene letters -o letters\n"
      "  sdm sequence letters/E.ply+letters/E.npy letters/G.ply+letters/G.npy -o out");
  const auto command = std::make_shared<SequenceCommand>();
  add_options(*sequence, command->pair, {"A sequence, or a mesh at rest", "The other sequence or mesh"});
  add_resolution_option(*sequence, command->atlas, "both bodies' maps");
  sequence
      ->add_option(
          "--map-precision", command->map_precision,
          "A resolution of O1's map for which its error bound is at most EPS in every frame, instead "
          "of --resolution; reads all frames beforehand")
      ->check(number("a positive number", [](double x) { return x > 0; }))
      ->type_name("EPS");
  add_layout_options(*sequence, command->atlas, "each body");
  add_output_option(*sequence, command->out);
  add_engine_option(*sequence, command->engine);
  if (sdm::can_write_html())
    sequence->add_flag("--player", command->player,
                       "Write player.html, a page that plays the frames, with their distances at vertices");
  sequence->add_flag("--animation", command->animation,
                     "Write animation.glb, a model that any viewer of glTF plays, coloured by distance");
  sequence->add_flag("--both", command->both,
                     "Also measure O2: its distances to O1, maps NNNN_o2 with --maps, colours in the player");
  add_tolerance_option(*sequence, command->picture.tolerance);
  add_color_options(*sequence, command->picture, command->range);
  add_up_option(*sequence, command->picture.up, "player.html and animation.glb");
  sequence
      ->add_option("--maps", command->maps_every, "Write the map of O1 of every K-th frame, as EXR and PNG")
      ->transform(whole_number(1, 1000000))
      ->type_name("K");
  sequence->add_option("--rate", command->rate, "glTF animations: frames per second; 0: one frame per key")
      ->check(number("a number, 0 or more", [](double x) { return x >= 0; }))
      ->type_name("FPS");
  sequence->add_flag("--allow-topology", command->allow_topology,
                     "Numbered files may add and remove vertices and faces between frames; what stays keeps "
                     "its texels, and maps over time are of what stays");
  sequence->add_flag("--resume", command->resume,
                     "Continue an interrupted run in the same folder, with the same inputs and options; "
                     "without one, start from the first frame");
  sequence->add_flag("--keep-going", command->keep_going, "Skip frames that cannot be read");
  sequence->add_flag("--no-temporal", command->no_temporal,
                     "Do not compute maps over time; faster, because frames then need no complete map");
  sequence->callback([command] {
    check_range(command->range);
    if (command->collects() && command->allow_topology)
      throw CLI::ValidationError(command->player ? "--player" : "--animation",
                                 "needs bodies that keep their faces: omit --allow-topology");
    check_layout(command->atlas);
    // The gl engine would lay out its tiles anew after each edit.
    if (command->allow_topology && command->engine.name == "gl")
      throw CLI::ValidationError("--allow-topology", "cannot be used with --engine gl");
    limit_threads(command->pair.threads);
    if (!FrameLoop(*command).process()) throw CLI::RuntimeError(3);
  });
}
