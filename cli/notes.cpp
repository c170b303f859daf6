#include "notes.h"

#include <fmt/format.h>
#include <sdm/mesh.h>

#include <algorithm>
#include <cmath>

#include "format.h"

namespace {

sdm::Box posed(const sdm::Box& box, const sdm::Transform& pose) {
  sdm::Box result;
  for (int corner = 0; corner < 8; ++corner) {
    sdm::Vec3 p;
    for (int k = 0; k < 3; ++k) p[k] = (corner >> k & 1) != 0 ? box.upper[k] : box.lower[k];
    p = pose(p);
    for (int k = 0; k < 3; ++k) {
      result.lower[k] = std::min(result.lower[k], p[k]);
      result.upper[k] = std::max(result.upper[k], p[k]);
    }
  }
  return result;
}

void append(Notes& notes, const Notes& more) {
  for (const std::string& note : more)
    if (std::ranges::find(notes, note) == notes.end()) notes.push_back(note);
}

}  // namespace

std::optional<std::string> note_on_precision(const std::string& file, std::span<const sdm::Vec3> positions,
                                             double size) {
  constexpr double kCoarse = 1e-5;
  constexpr int kBits = 23;  // of the fraction of a float
  double largest = 0;
  for (const sdm::Vec3& p : positions)
    for (const double x : p) {
      if (!std::isfinite(x)) continue;  // a place of a cloud without a point
      if (static_cast<double>(static_cast<float>(x)) != x) return std::nullopt;
      largest = std::max(largest, std::abs(x));
    }
  if (!(largest > 0 && size > 0 && std::isfinite(size))) return std::nullopt;
  const double step = std::ldexp(1, std::ilogb(largest) - kBits);
  if (!(step > kCoarse * size)) return std::nullopt;
  // Round numbers, such as the integers of a text file, are as they are meant: of rounded ones, some have the
  // last bit.
  const auto has_last_bit = [&](const sdm::Vec3& p) {
    return std::ranges::any_of(p, [&](double x) { return std::fmod(std::abs(x) / step, 2) == 1; });
  };
  if (std::ranges::none_of(positions, has_last_bit)) return std::nullopt;
  return fmt::format(
      "{}: coordinates in single precision are {} apart so far from the origin, {} of its size; export it in "
      "double precision, or near the origin",
      file, number(step, 2), number(step / size, 2));
}

std::optional<std::string> note_on_unit(const std::string& units) {
  if (units.empty() || sdm::metres_per(units)) return std::nullopt;
  return fmt::format("the unit {} is not known: it is only a label", units);
}

Notes file_notes(const Input& o1, const Input& o2) {
  Notes notes;
  append(notes, o1.notes);
  append(notes, o2.notes);
  return notes;
}

Notes notes_on(const Input& o1, const Input& o2) {
  Notes notes = file_notes(o1, o2);
  // The mesh of an inspected input may have moved elsewhere.
  const auto box = [](const Input& input) {
    return input.info ? input.info->bounds : sdm::bounds(input.mesh);
  };
  append(notes, sdm::notes_on(box(o1), box(o2)));
  return notes;
}

Notes notes_on(std::span<const Input> bodies, std::span<const sdm::Transform> poses) {
  constexpr std::size_t kMost = 1000;  // bodies of which each is compared with each
  Notes notes;
  std::vector<sdm::Box> boxes;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    append(notes, bodies[i].notes);
    boxes.push_back(posed(sdm::bounds(bodies[i].mesh), poses[i]));
  }
  const auto largest = std::ranges::max_element(boxes, {}, size_of);
  for (std::size_t i = 0; i < boxes.size(); ++i)
    if (const auto note = sdm::note_on_sizes(*largest, boxes[i]))
      append(notes,
             {fmt::format("{} and {}: {}", bodies[static_cast<std::size_t>(largest - boxes.begin())].file,
                          bodies[i].file, *note)});
  if (boxes.size() > kMost) return notes;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const auto is_near = [&](const sdm::Box& other) {
      return &other != &boxes[i] && !sdm::note_on_places(boxes[i], other);
    };
    if (std::ranges::none_of(boxes, is_near))
      notes.push_back(fmt::format(
          "body {} is more than 100 times its size from all others; are they in the same place?", i));
  }
  return notes;
}

std::string note_lines(std::span<const std::string> notes, std::size_t column) {
  std::string text;
  for (const std::string& note : notes) text += fmt::format("  {:<{}}{}\n", "note", column - 2, note);
  return text;
}
