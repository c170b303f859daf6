#include "sequence_report.h"

#include <sdm/map_files.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>

#include "format.h"
#include "notes.h"
#include "report.h"
#include "src/io/json/report_json.h"

using Json = nlohmann::ordered_json;

namespace {

constexpr const char* kBodies[] = {"o1", "o2"};

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// A number with the precision of a float; empty for NaN.
std::string cell(double value) {
  return std::isnan(value) ? std::string() : number(value, 9);
}

// One value per frame, NaN for skipped frames.
template <class Value>
std::vector<double> curve(const std::vector<Frame>& frames, std::size_t count, const Value& value) {
  std::vector<double> values(count, kNaN);
  for (const Frame& frame : frames) values[frame.index - frames.front().index] = value(frame);
  return values;
}

template <class Value>
double median(const std::vector<Frame>& frames, const Value& value) {
  std::vector<double> values;
  values.reserve(frames.size());
  for (const Frame& frame : frames) values.push_back(value(frame));
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

double number_from(const Json& json) {
  return json.is_null() ? kNaN : json.get<double>();  // JSON has no NaN
}

sdm::Certainty certainty(const std::string& text) {
  return sdm::value_of<sdm::Certainty>(text).value_or(sdm::Certainty::estimate);
}

// Leaves out the witness, which only lines of JSON have.
sdm::BoundedLength length_from(const Json& json) {
  sdm::BoundedLength length;
  length.value = number_from(json.at("value"));
  length.lower = number_from(json.at("lower"));
  length.upper = number_from(json.at("upper"));
  length.certainty = certainty(json.at("kind"));
  return length;
}

// Empty if the topology does not change.
std::string topology_summary(const std::vector<Frame>& frames) {
  std::size_t changes = 0;
  std::array<const Frame*, 2> new_layout{};  // the last one
  for (const Frame& frame : frames) {
    changes += frame.topology[0] || frame.topology[1];
    for (int b = 0; b < 2; ++b)
      if (frame.topology[b] && frame.topology[b]->new_layout) new_layout[b] = &frame;
  }
  if (changes == 0) return {};
  std::string text = fmt::format("  topology   changes in {} frames\n", changes);
  for (int b = 0; b < 2; ++b)
    if (new_layout[b])
      text += note_lines(Notes{fmt::format("frame {} of {} could not keep the layout of the frame before{}",
                                           new_layout[b]->index, b == 0 ? "O1" : "O2",
                                           b == 0 ? "; maps over time begin there" : "")},
                         13);
  return text;
}

}  // namespace

Json to_json(const Frame& frame, std::span<const sdm::Contact> contacts) {
  Json json;
  json["frame"] = frame.index;
  json["separation"] = sdm::fields_json(frame.separation);
  json["colliding"] = sdm::collision_json(frame.colliding);
  json["penetration_depth"] = sdm::value_json(frame.depth);
  json["contacts"] = frame.contacts;
  json["patches"] = Json::array();  // for each patch its deepest contact, which comes first
  for (const sdm::Contact& contact : contacts)
    if (contact.patch == json["patches"].size()) json["patches"].push_back(to_json(contact));
  json["error_bound"] = {{"kind", "bounded"}, {"o1", frame.error_bound[0]}, {"o2", frame.error_bound[1]}};
  json["relative_error"] = {
      {"kind", "bounded"}, {"o1", frame.relative_error[0]}, {"o2", frame.relative_error[1]}};
  json["resolution"] = frame.resolution;
  for (int b = 0; b < 2; ++b)
    if (const auto& distances = frame.distances[b]) json["distance"][kBodies[b]] = to_json(*distances);
  if (std::ranges::any_of(frame.distances, [](const auto& d) { return d && d->verdict; }))
    json["doubts"] = to_json(frame.doubts);
  for (int b = 0; b < 2; ++b)
    if (const auto& topology = frame.topology[b]) json["topology"][kBodies[b]] = sdm::fields_json(*topology);
  json["time_ms"] = sdm::fields_json(frame.time);
  json["time_ms"]["total"] = frame.time.total();
  return json;
}

sdm::Verdict verdict_of(const std::vector<Frame>& frames) {
  sdm::Verdict verdict = sdm::Verdict::pass;
  for (const Frame& frame : frames) verdict = worse(verdict, frame.verdict());
  return verdict;
}

const Frame* deciding_frame(const std::vector<Frame>& frames) {
  const auto found = std::ranges::find(frames, verdict_of(frames), &Frame::verdict);
  return found == frames.end() ? nullptr : &*found;
}

bool is_certified(const std::vector<Frame>& frames) {
  const sdm::Verdict verdict = verdict_of(frames);
  bool any = false, all = true;
  for (const Frame& frame : frames)
    for (const auto& d : frame.distances) {
      if (!d || d->judged() != verdict) continue;
      any |= d->certified;
      all &= d->certified;
    }
  return any && (all || verdict == sdm::Verdict::fail);
}

Json to_json(const BadFrame& frame) {
  return {{"frame", frame.index}, {"error", frame.fault}};
}

bool is_bad(const Json& line) {
  return line.contains("error");
}

BadFrame bad_frame_from(const Json& line) {
  return {line.at("frame"), line.at("error")};
}

Frame frame_from(const Json& line) {
  Frame frame;
  frame.index = line.at("frame");
  frame.separation = length_from(line.at("separation"));
  const Json& colliding = line.at("colliding");
  frame.colliding = colliding.at("value");
  if (const Json& depth = line.at("penetration_depth"); !depth.is_null()) frame.depth = length_from(depth);
  frame.contacts = line.at("contacts");
  frame.patches = line.at("patches").size();
  const auto of_bodies = [&](const char* key) -> std::array<double, 2> {
    return {number_from(line.at(key).at("o1")), number_from(line.at(key).at("o2"))};
  };
  frame.error_bound = of_bodies("error_bound");
  frame.relative_error = of_bodies("relative_error");
  frame.resolution = line.at("resolution");
  for (int b = 0; b < 2 && line.contains("distance"); ++b)
    if (const Json& all = line.at("distance"); all.contains(kBodies[b]))
      frame.distances[b] = distances_from(all.at(kBodies[b]));
  frame.doubts = sdm::doubts_from(line.value("doubts", Json::array()));
  for (int b = 0; b < 2 && line.contains("topology"); ++b)
    if (const Json& all = line.at("topology"); all.contains(kBodies[b])) {
      const Json& body = all.at(kBodies[b]);
      frame.topology[b] = {body.at("removed_faces"), body.at("reconnected_faces"), body.at("added_faces"),
                           body.at("new_layout")};
    }
  const Json& t = line.at("time_ms");
  frame.time = {t.at("read"), t.at("update"), t.at("query"), t.at("error"), t.at("map"), t.at("write")};
  return frame;
}

std::string to_csv(const std::vector<Frame>& frames) {
  std::string text =
      "frame,separation,separation_lower,separation_upper,colliding,colliding_kind,penetration_depth,"
      "depth_lower,depth_upper,contacts,patches,error_bound_o1,error_bound_o2,relative_error_o1,"
      "relative_error_o2";
  for (const char* body : kBodies) text += distance_columns(body);
  text += ",read_ms,update_ms,query_ms,error_ms,map_ms,write_ms,total_ms\n";
  for (const Frame& f : frames) {
    std::vector<std::string> cells{fmt::to_string(f.index)};
    const auto add = [&](std::initializer_list<double> values) {
      for (const double v : values) cells.push_back(cell(v));
    };
    add({f.separation.value, f.separation.lower, f.separation.upper});
    cells.push_back(f.colliding ? "1" : "0");
    cells.push_back(sdm::name_of(sdm::Certainty::exact));
    if (f.depth)
      add({f.depth->value, f.depth->lower, f.depth->upper});
    else
      add({kNaN, kNaN, kNaN});
    cells.push_back(fmt::to_string(f.contacts));
    cells.push_back(fmt::to_string(f.patches));
    add({f.error_bound[0], f.error_bound[1], f.relative_error[0], f.relative_error[1]});
    for (const auto& distances : f.distances)
      for (std::string& more : ::cells(distances)) cells.push_back(std::move(more));
    add({f.time.read, f.time.update, f.time.query, f.time.error, f.time.map, f.time.write, f.time.total()});
    text += fmt::format("{}\n", fmt::join(cells, ","));
  }
  return text;
}

void write_plot(const std::filesystem::path& file, const std::vector<Frame>& frames,
                const std::string& units) {
  const std::size_t count = frames.empty() ? 0 : frames.back().index - frames.front().index + 1;
  std::vector<double> places(count);
  for (std::size_t i = 0; i < count; ++i) places[i] = static_cast<double>(frames.front().index + i);
  const auto over = [&](auto value) { return curve(frames, count, value); };
  const std::string in = units.empty() ? std::string() : fmt::format(" ({})", units);
  const std::vector<sdm::PlotPanel> panels{
      {"Separation" + in,
       {{"value", over([](const Frame& f) { return f.separation.value; })},
        {"lower bound", over([](const Frame& f) { return f.separation.lower; })}}},
      {"Penetration depth" + in,
       {{"value", over([](const Frame& f) { return f.depth ? f.depth->value : kNaN; })},
        {"upper bound", over([](const Frame& f) { return f.depth ? f.depth->upper : kNaN; })}}},
      {"Relative error: covering radius against the first frame's, at most",
       {{"O1", over([](const Frame& f) { return f.relative_error[0]; })},
        {"O2", over([](const Frame& f) { return f.relative_error[1]; })}}},
      {"Time (ms)",
       {{"all but files", over([](const Frame& f) { return f.time.total() - f.time.read - f.time.write; })},
        {"queries", over([](const Frame& f) { return f.time.query; })}}}};
  sdm::write_plot_png(file, "frame", places, panels);
}

std::vector<sdm::PlotPanel> player_panels(const std::vector<Frame>& frames, const std::string& units) {
  const std::string in = units.empty() ? std::string() : fmt::format(" ({})", units);
  const auto over = [&](auto value) {
    std::vector<double> values;
    for (const Frame& frame : frames) values.push_back(value(frame));
    return values;
  };
  std::vector<sdm::PlotPanel> panels;
  for (int b = 0; b < 2; ++b) {
    if (std::ranges::none_of(frames, [&](const Frame& f) { return f.distances[b].has_value(); })) continue;
    const auto distance = [&](double FrameDistances::*which) {
      return over([=](const Frame& f) { return f.distances[b] ? (*f.distances[b]).*which : kNaN; });
    };
    panels.push_back({fmt::format("Distance of O{}{}", b + 1, in),
                      {{"max", distance(&FrameDistances::max)},
                       {"mean", distance(&FrameDistances::mean)},
                       {"min", distance(&FrameDistances::min)}}});
  }
  panels.push_back({"Separation" + in, {{"", over([](const Frame& f) { return f.separation.value; })}}});
  if (std::ranges::any_of(frames, [](const Frame& f) { return f.depth && f.depth->value > 0; }))
    panels.push_back({"Penetration depth" + in,
                      {{"", over([](const Frame& f) { return f.depth ? f.depth->value : kNaN; })}}});
  return panels;
}

std::string summary(const std::vector<Frame>& frames, const std::vector<BadFrame>& bad,
                    const std::string& units) {
  const std::string unit = unit_suffix(units);
  std::string text = fmt::format("  frames     {}", frames.size());
  if (!bad.empty()) text += fmt::format(", and {} that could not be used", bad.size());
  text += '\n';
  if (frames.empty()) return text;
  const auto least = std::ranges::min_element(frames, {}, [](const Frame& f) { return f.separation.value; });
  text += fmt::format("  separation at least {}{}, in frame {} ({})\n", number(least->separation.value), unit,
                      least->index, sdm::name_of(least->separation.certainty));
  const auto colliding = std::ranges::count_if(frames, [](const Frame& f) { return f.colliding; });
  text += fmt::format("  colliding  in {} frames\n", colliding);
  const auto deepest =
      std::ranges::max_element(frames, {}, [](const Frame& f) { return f.depth ? f.depth->value : -1; });
  if (deepest->depth && deepest->depth->value > 0)
    text += fmt::format("  depth      at most {}{}, in frame {} ({})\n", number(deepest->depth->value), unit,
                        deepest->index, sdm::name_of(deepest->depth->certainty));
  const auto relative = [](const Frame& f) { return std::max(f.relative_error[0], f.relative_error[1]); };
  text += fmt::format("  error      up to {} times that of the first frame\n",
                      number(relative(*std::ranges::max_element(frames, {}, relative))));
  const auto error = [](const Frame& f) { return f.error_bound[0]; };
  text += fmt::format("  map error  at most {}{} in all frames (bounded)\n",
                      number(error(*std::ranges::max_element(frames, {}, error))), unit);
  for (int b = 0; b < 2; ++b)
    if (const auto& first = frames.front().distances[b]; first && first->verdict) {
      sdm::Verdict worst = sdm::Verdict::pass;
      for (const Frame& f : frames)
        if (f.distances[b]) worst = worse(worst, f.distances[b]->judged());
      const auto count = std::ranges::count_if(
          frames, [&](const Frame& f) { return f.distances[b] && f.distances[b]->judged() == worst; });
      text +=
          fmt::format("  tolerance  O{}: {}\n", b + 1,
                      worst == sdm::Verdict::pass
                          ? "PASS in all frames"
                          : fmt::format("{} in {} of {} frames", sdm::name_of(worst), count, frames.size()));
    }
  const auto doubted = std::ranges::find_if(frames, [](const Frame& f) { return !f.doubts.empty(); });
  if (doubted != frames.end()) text += doubt_lines(doubted->doubts, 13);
  text += topology_summary(frames);
  const auto ms = [&](double FrameTimes::*step) {
    return number(std::round(100 * median(frames, [=](const Frame& f) { return f.time.*step; })) / 100);
  };
  const double total = median(frames, [](const Frame& f) { return f.time.total(); });
  return text + fmt::format("  per frame  {} ms (median): read {}, update {}, queries {}, error {}, map {}\n",
                            number(std::round(100 * total) / 100), ms(&FrameTimes::read),
                            ms(&FrameTimes::update), ms(&FrameTimes::query), ms(&FrameTimes::error),
                            ms(&FrameTimes::map));
}
