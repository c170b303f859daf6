#include "sequence_frames.h"

#include <fmt/format.h>

#include <span>
#include <utility>

#include "doubts.h"
#include "interrupts.h"
#include "src/core/stopwatch.h"

using Json = nlohmann::ordered_json;

namespace {

std::string status(std::size_t frame, std::size_t count, std::size_t done, double seconds) {
  std::string text = fmt::format("frame {} of {}", frame + 1, count);
  if (done == 0) return text;
  return fmt::format("{}, {:.1f} per second", text, static_cast<double>(done) / seconds);
}

void answer_queries(Frame& frame, sdm::ProximityQuery& query) {
  frame.separation = query.separation();
  frame.colliding = query.colliding();
  frame.depth = query.penetration_depth();
  const std::span<const sdm::Contact> contacts = query.contacts();
  frame.contacts = contacts.size();
  frame.patches = contacts.empty() ? 0 : contacts.back().patch + 1;
}

}  // namespace

FrameLoop::FrameLoop(const SequenceCommand& command, SequenceInput input, Checkpoint& checkpoint,
                     SequenceFiles& files, ProgressLine& progress)
    : command_(command),
      checkpoint_(checkpoint),
      files_(files),
      progress_(progress),
      count_(input.count),
      notes_(std::move(input.notes)),
      pair_(std::move(input.bodies), input.atlases, command.pair.options, command.map_precision, temporal_),
      maps_{.options = std::move(input.map)} {}

FrameLoop::End FrameLoop::process() {
  if (checkpoint_.resumes()) adopt_finished();
  const std::size_t kept = checkpoint_.finished();
  try {
    sdm::Stopwatch watch;
    double seconds = 0;
    bool usable = true;
    for (std::size_t i = kept; i < count_ && usable; ++i) {
      progress_.step(status(i, count_, i - kept, seconds));
      usable = use(i);
      seconds += watch.lap() / 1000;
    }
    progress_.step("export");
    return usable ? End::complete : End::stopped;
  } catch (const sdm::Cancelled&) {
    if (checkpoint_.finished() == kept) throw;
    return End::interrupted;
  }
}

// The results of finished frames are kept, but the bodies move through them: the closest faces of a frame are
// sought near those of the frame before.
void FrameLoop::adopt_finished() {
  const std::size_t kept = checkpoint_.interrupted().frames.size();
  for (std::size_t i = 0; i < kept; ++i) {
    progress_.step(fmt::format("reading finished frame {} of {}", i + 1, kept));
    repeat(i);
  }
  temporal_.resume(checkpoint_.adopt());
  for (const auto& [line, hash] : checkpoint_.state().frames) {
    if (is_bad(line))
      bad_.push_back(bad_frame_from(line));
    else
      frames_.push_back(frame_from(line));
    files_.add_line(line);
  }
}

void FrameLoop::repeat(std::size_t index) {
  const SequenceState::Frame& finished = checkpoint_.interrupted().frames[index];
  Frame frame;
  frame.index = index;
  try {
    pair_.move(frame);
    if (pair_.has_history()) pair_.bound_errors(frame);
    if (!is_bad(finished.line)) {
      temporal_.pass();
      files_.collect(index, pair_);
    }
  } catch (const sdm::Cancelled&) {
    throw;
  } catch (const sdm::Error&) {  // as in the interrupted run, if the hashes agree
  }
  if (pair_.hash() != finished.hash)
    checkpoint_.refuse(fmt::format("frame {} is not that of the interrupted run", index));
}

/// Returns whether the next frame is to be used.
bool FrameLoop::use(std::size_t index) {
  Frame frame;
  frame.index = index;
  try {
    pair_.move(frame);
  } catch (const sdm::Cancelled&) {
    throw;
  } catch (const sdm::Error& error) {
    if (!command_.keep_going && checkpoint_.finished() == 0) throw;  // there is nothing to keep
    return skip(index, error.what());
  }
  sdm::Stopwatch watch;
  pair_.bound_errors(frame);
  frame.time.error = watch.lap();
  answer_queries(frame, pair_.query());
  frame.time.query = watch.lap();
  compute_maps(frame);
  frame.time.map = watch.lap();
  if (command_.outputs.has_maps_of(index)) files_.write_maps(index, pair_, maps_);
  const Interrupts::Protected finished;  // from here on the frame belongs to the results
  if (command_.outputs.temporal) temporal_.add(pair_.surface(0), maps_.of[0]);
  files_.collect(index, pair_);
  frame.time.write = watch.lap();
  Json line = to_json(frame, pair_.query().contacts());
  if (index == 0) line["notes"] = notes_;
  files_.add_line(line);
  frames_.push_back(frame);
  checkpoint_.add({std::move(line), pair_.hash()});
  return true;
}

bool FrameLoop::skip(std::size_t index, const std::string& fault) {
  Json line = to_json(bad_.emplace_back(BadFrame{index, fault}));
  files_.add_line(line);
  if (command_.keep_going) checkpoint_.add({std::move(line), pair_.hash()});
  return command_.keep_going;
}

// Maps that nobody asks for, to be written, measured or added to the maps over time, are not computed.
void FrameLoop::compute_maps(Frame& frame) {
  const SequenceOutputs& outputs = command_.outputs;
  if (outputs.has_maps_of(frame.index) || outputs.temporal || command_.measures()) maps_.compute(pair_, 0);
  if (!command_.measures()) return;
  for (int b = 0; b < command_.measured_bodies(); ++b) {
    if (b == 1) maps_.compute(pair_, 1);
    naming_frame(frame.index, [&] {
      frame.distances[b] =
          frame_distances(pair_.surface(b), pair_.sites(1 - b), maps_.of[b], command_.picture.tolerance,
                          {.error_bound = frame.error_bound[b],
                           .guard = pair_.guard(),
                           .uncertainty = command_.uncertainty,
                           .accept_doubts = command_.accept_doubts});
    });
  }
  if (!command_.picture.tolerance) return;
  naming_frame(frame.index, [&] {
    frame.doubts =
        doubts_in_place(sdm::find_other_unit_in_place(pair_.sites(0).mesh(), pair_.sites(1).mesh()));
  });
  for (const auto& d : frame.distances)
    if (d && d->doubt) frame.doubts.push_back(*d->doubt);
  if (!command_.accept_doubts) frame.withhold_pass();
}

void FrameLoop::write(const std::filesystem::path& folder) {
  files_.finish(frames_, temporal_.of(pair_.surface(0)), pair_, maps_);
  if (!complete()) checkpoint_.write(folder, temporal_.maps());
}
