#include "sequence.h"

#include <sdm/io.h>
#include <sdm/sdm.h>
#include <sdm/sequence.h>

#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>

#include "common_options.h"
#include "format.h"
#include "option_checks.h"
#include "output_folder.h"
#include "pair_options.h"
#include "progress_line.h"
#include "scenes/placement.h"
#include "sequence_report.h"
#include "sequence_state.h"
#include "stopwatch.h"

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

struct SequenceCommand {
  PairCommand pair;
  sdm::AtlasOptions atlas{.resolution = 512};
  std::filesystem::path out;
  int maps_every = 0;
  double rate = 0;
  bool keep_going = false, no_temporal = false, resume = false;
};

/// All that affects the files, except the inputs, by the names of the options.
Json options_of(const SequenceCommand& command) {
  const PairCommand& pair = command.pair;
  return {{"version", sdm::kVersion},
          {"--transform-o1", pair.transform_o1},
          {"--transform-o2", pair.transform_o2},
          {"--units", pair.units},
          {"--margin", pair.options.contact_margin},
          {"--precision", pair.options.depth_precision},
          {"--resolution", command.atlas.resolution},
          {"--maps", command.maps_every},
          {"--rate", command.rate},
          {"--no-temporal", command.no_temporal}};
}

/// The files of earlier runs that this run replaces.
std::vector<fs::path> earlier_files(const fs::path& folder, bool resumed) {
  if (resumed) return {"frames.jsonl"};
  std::vector<fs::path> files{"frames.jsonl", "frames.csv", "plot.png", "temporal.exr",
                              "min.png",      "mean.png",   "max.png",  SequenceState::kFile};
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder / "maps", error)) {
    const fs::path& file = entry.path();
    const bool numbered = file.stem().string().find_first_not_of("0123456789") == std::string::npos;
    if (numbered && (file.extension() == ".exr" || file.extension() == ".png"))
      files.push_back(fs::path("maps") / file.filename());
  }
  return files;
}

/// A body: its sequence of meshes and its placement.
class Body {
 public:
  Body(const std::string& input, const std::string& steps, double rate)
      : input_(input),
        sequence_(input, {.rate = rate}),
        steps_(sdm::scenes::without_fit(sequence_.mesh(), sdm::scenes::parse_placement(steps))) {}

  [[nodiscard]] const std::string& input() const { return input_; }
  [[nodiscard]] std::size_t frames() const { return sequence_.frame_count(); }
  [[nodiscard]] bool still() const { return frames() == 1; }
  [[nodiscard]] sdm::Mesh first() const {
    sdm::Mesh mesh = sequence_.mesh();
    sdm::scenes::place(mesh, steps_);
    return mesh;
  }
  /// The placed positions of a frame. Requires a moving body.
  [[nodiscard]] std::span<const sdm::Vec3> positions(std::size_t frame) {
    const std::span<const sdm::Vec3> read = sequence_.positions(frame);
    placed_.assign(read.begin(), read.end());
    sdm::scenes::place(placed_, steps_);
    return placed_;
  }

 private:
  std::string input_;
  sdm::MeshSequence sequence_;
  std::vector<sdm::scenes::PlacementStep> steps_;
  std::vector<sdm::Vec3> placed_;
};

std::size_t common_frames(const Body& a, const Body& b) {
  if (a.still()) return b.frames();
  if (b.still() || a.frames() == b.frames()) return a.frames();
  throw sdm::Error(fmt::format(
      "{} has {} frames and {} has {}; give two sequences of the same length, or one mesh at rest", a.input(),
      a.frames(), b.input(), b.frames()));
}

/// Processes the frames of one command.
class FrameLoop {
 public:
  explicit FrameLoop(const SequenceCommand& command)
      : command_(command),
        resumed_(command.resume ? incomplete_run(command.out, options_of(command)) : std::nullopt),
        out_(command.out, earlier_files(command.out, resumed_.has_value())),
        progress_(command.pair.quiet),
        o1_(command.pair.o1, command.pair.transform_o1, command.rate),
        o2_(command.pair.o2, command.pair.transform_o2, command.rate),
        count_(common_frames(o1_, o2_)),
        lines_(out_.staging() / "frames.jsonl", std::ios::binary) {
    command_.atlas.progress = progress_.callback();
    state_.options = options_of(command);
    state_.meshes = {hash_of(o1_.first()), hash_of(o2_.first())};
    if (resumed_) check_meshes();
    query_.emplace(sdm::Shape(o1_.first(), command_.atlas), sdm::Shape(o2_.first(), command_.atlas),
                   command_.pair.options);
    for (int b = 0; b < 2; ++b) {
      bounds_.emplace_back(query_->surface(b));
      errors_.emplace_back(query_->surface(b), bounds_.back());
    }
  }

  /// Writes the results of all frames, or of those before an interrupt or the first bad frame, which is then
  /// reported as Interrupted or sdm::Error.
  void process() {
    out_.fill([&] {
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
      }
      write_results();
    });
    std::error_code ignored;
    if (complete()) fs::remove(command_.out / SequenceState::kFile, ignored);
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
  }

 private:
  [[nodiscard]] std::string status(std::size_t frame, std::size_t done, double seconds) const {
    std::string text = fmt::format("frame {} of {}", frame + 1, count_);
    if (done == 0) return text;
    return fmt::format("{}, {:.1f} per second", text, static_cast<double>(done) / seconds);
  }

  [[nodiscard]] bool complete() const { return state_.frames.size() == count_; }

  void check_meshes() const {
    for (int b = 0; b < 2; ++b)
      if (resumed_->meshes[b] != state_.meshes[b])
        refuse_to_resume(command_.out, fmt::format("{} is not the mesh of the interrupted run",
                                                   (b == 0 ? o1_ : o2_).input()));
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
      } catch (const sdm::Cancelled&) {
        throw;
      } catch (const sdm::Error&) {  // as in the interrupted run, if the hashes agree
      }
      if (hash_ != resumed_->frames[i].hash)
        refuse_to_resume(command_.out, fmt::format("frame {} is not that of the interrupted run", i));
    }
    state_.frames = std::move(resumed_->frames);
    state_.temporal = std::move(resumed_->temporal);
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
    frame.separation = query_->separation();
    frame.colliding = query_->colliding();
    frame.depth = query_->penetration_depth();
    const std::span<const sdm::Contact> contacts = query_->contacts();
    frame.contacts = contacts.size();
    frame.patches = contacts.empty() ? 0 : contacts.back().patch + 1;
    frame.time.query = watch.lap();
    for (int b = 0; b < 2; ++b) {
      bounds_[b].refit(query_->surface(b));
      frame.error_bound[b] = bounds_[b].value();
      frame.relative_error[b] = errors_[b].of(bounds_[b]);
    }
    frame.time.error = watch.lap();
    const bool write = command_.maps_every > 0 && index % static_cast<std::size_t>(command_.maps_every) == 0;
    if (write || !command_.no_temporal) sdm::compute_map(query_->surface(0), query_->sites(1), {}, map_);
    if (!command_.no_temporal) state_.temporal.add(map_);
    frame.time.map = watch.lap();
    if (write) write_map(index);
    frame.time.write = watch.lap();
    const Json line = to_json(frame, contacts);
    add_line(line);
    frames_.push_back(frame);
    state_.frames.push_back({line, hash_});
  }

  // Both bodies are read before either is moved.
  void move(Frame& frame) {
    Stopwatch watch;
    std::array<std::span<const sdm::Vec3>, 2> positions;
    hash_ = {};
    for (int b = 0; b < 2; ++b) {
      Body& body = b == 0 ? o1_ : o2_;
      if (body.still()) continue;
      positions[b] = body.positions(frame.index);
      hash_[b] = hash_of(positions[b]);
    }
    frame.time.read = watch.lap();
    try {
      query_->refit(positions[0], positions[1]);
    } catch (const sdm::Error& error) {
      throw sdm::Error(fmt::format("frame {}: {}", frame.index, error.what()), error.remedy());
    }
    frame.time.update = watch.lap();
  }

  void write_map(std::size_t index) {
    const fs::path folder = out_.staging("maps");
    sdm::write_exr(folder / fmt::format("{:04}.exr", index), query_->surface(0), map_);
    sdm::write_distance_png(folder / fmt::format("{:04}.png", index), query_->surface(0), map_,
                            {.units = command_.pair.units});
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
    if (state_.temporal.maps() > 0) write_temporal(folder);
    if (!complete()) state_.write(folder / SequenceState::kFile);
  }

  void print_summary() const {
    std::cout << fmt::format("{}, {}\n{}  results    {}/: frames.jsonl frames.csv{}{}{}\n", o1_.input(),
                             o2_.input(), summary(frames_, bad_, command_.pair.units), command_.out.string(),
                             frames_.empty() ? "" : " plot.png",
                             state_.temporal.maps() > 0 ? " temporal.exr min.png mean.png max.png" : "",
                             command_.maps_every > 0 ? " maps/" : "");
  }

  void write_temporal(const fs::path& folder) {
    const sdm::Surface& surface = query_->surface(0);
    sdm::write_exr(folder / "temporal.exr", surface, state_.temporal);
    // The picture needs the other layers of a map.
    if (map_.distance.empty()) sdm::compute_map(surface, query_->sites(1), {}, map_);
    const auto draw = [&](const char* file, std::span<const float> values) {
      std::ranges::copy(values, map_.distance.begin());
      sdm::write_distance_png(folder / file, surface, map_, {.units = command_.pair.units});
    };
    draw("min.png", state_.temporal.least());
    draw("mean.png", state_.temporal.mean());
    draw("max.png", state_.temporal.largest());
  }

  SequenceCommand command_;
  std::optional<SequenceState> resumed_;  // its parts move to state_
  OutputFolder out_;
  ProgressLine progress_;
  Body o1_, o2_;
  std::size_t count_;
  std::ofstream lines_;
  std::optional<sdm::ProximityQuery> query_;
  std::vector<sdm::SamplingBound> bounds_;  // one for each body
  std::vector<sdm::RelativeError> errors_;  // one for each body
  std::vector<Frame> frames_;
  std::vector<BadFrame> bad_;
  std::array<std::optional<std::uint64_t>, 2> hash_;  // of the positions of the current frame
  SequenceState state_;
  bool stopped_ = false, interrupted_ = false;
  sdm::DistanceMap map_;
};

}  // namespace

void add_sequence_command(CLI::App& app) {
  CLI::App* sequence = app.add_subcommand(
      "sequence", "Compute proximity, error bounds and maps of two deforming bodies, frame by frame");
  sequence->footer(
      "A sequence is a folder of numbered mesh files, a pattern such as walk_%04d.ply, mesh.obj+motion.npy\n"
      "with positions (T, V, 3), or a glTF file with morph targets; any other mesh file is a body at rest.\n"
      "Writes frames.jsonl, frames.csv, plot.png, and, for O1, the minimum, mean and maximum distance over\n"
      "time: temporal.exr, min.png, mean.png, max.png.\n"
      "An interrupt (Ctrl-C, SIGTERM) or a bad frame keeps the frames that are finished; --resume computes\n"
      "the others, and then all files are those of an uninterrupted run.\n\n"
      "Example:\n"
      "  sdm scene letters -o letters\n"
      "  sdm sequence letters/E.ply+letters/E.npy letters/G.ply+letters/G.npy -o out");
  const auto command = std::make_shared<SequenceCommand>();
  add_options(*sequence, command->pair, {"A sequence, or a mesh at rest", "The other sequence or mesh"});
  add_resolution_option(*sequence, command->atlas, "both bodies' maps");
  add_output_option(*sequence, command->out);
  sequence
      ->add_option("--maps", command->maps_every, "Write the map of O1 of every K-th frame, as EXR and PNG")
      ->check(whole_number(1, 1000000))
      ->type_name("K");
  sequence->add_option("--rate", command->rate, "glTF animations: frames per second; 0: one frame per key")
      ->check(number("a number, 0 or more", [](double x) { return x >= 0; }))
      ->type_name("FPS");
  sequence->add_flag("--resume", command->resume,
                     "Continue an interrupted run in the same folder, with the same inputs and options; "
                     "without one, start from the first frame");
  sequence->add_flag("--keep-going", command->keep_going, "Skip frames that cannot be read");
  sequence->add_flag("--no-temporal", command->no_temporal,
                     "Do not compute maps over time; faster, because frames then need no complete map");
  sequence->callback([command] {
    limit_threads(command->pair.threads);
    FrameLoop(*command).process();
  });
}
