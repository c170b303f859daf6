// The rows of the file that measure_points() writes.
#pragma once

#include <sdm/types.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

namespace sdm::io {

/// Where the values are in a row, in bytes: three doubles, the normal if there is one (floats), the distance
/// (float), the face (int) and the colour.
struct RowLayout {
  bool has_normals = false;

  static constexpr std::size_t kNormalAt = 3 * sizeof(double);
  [[nodiscard]] std::size_t distance_at() const { return kNormalAt + (has_normals ? 3 * sizeof(float) : 0); }
  [[nodiscard]] std::size_t face_at() const { return distance_at() + sizeof(float); }
  [[nodiscard]] std::size_t colour_at() const { return face_at() + sizeof(std::int32_t); }
  [[nodiscard]] std::size_t size() const { return colour_at() + 3; }
};

struct MeasuredPoint {
  Vec3 point{};
  Vec3f normal{};              ///< 0 if the file has none
  float distance = 0;          ///< NaN if there is none
  std::uint32_t face = kNone;  ///< of O2
};

/// Reads a file back, in parts.
class MeasuredRows {
 public:
  /// Throws sdm::Error unless the file can hold `points` rows.
  MeasuredRows(const std::filesystem::path& ply, std::uint64_t points, bool has_normals);

  /// Calls visit(number, point) for all points in order.
  void for_each(const std::function<void(std::uint64_t, const MeasuredPoint&)>& visit);
  [[nodiscard]] MeasuredPoint read(std::uint64_t number);

 private:
  void load_rows(std::uint64_t first, std::uint64_t count, std::string& bytes);

  std::string name_;
  std::ifstream file_;
  RowLayout layout_;
  std::uint64_t points_, begin_ = 0;
};

}  // namespace sdm::io
