#include "atlas/packing/pack.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <optional>
#include <unordered_map>

#include "atlas/packing/bitmap_bin.h"
#include "atlas/packing/footprint.h"
#include "core/cancellation.h"
#include "core/memory.h"
#include "core/parallel.h"

namespace sdm::atlas {
namespace {

// Above this many cells per side, a cell is a square of several texels: charts are then large and lose little
// space by it. Many small charts get more cells.
constexpr double kCells = 2048, kCellsPerChart = 32;
// The search tries this many scales at a time, regardless of the number of threads, and stops at this
// precision, a fraction of the atlas area.
constexpr int kTrials = 2;
constexpr double kPrecision = 0.005;
// Between these, most meshes stop fitting: the scales tried first.
constexpr std::array<double, kTrials> kFirstShares{0.70, 0.82};
// Rounds of trials around the scale that the rows of the trials before suggest, before the gap is divided.
constexpr int kGuesses = 4;
// How much taller than the atlas the bin of a trial is, so that it shows how many rows are missing.
constexpr double kTallness = 1.25;
// The number of charts from which speed is preferred over filling the last gaps.
constexpr std::size_t kManyCharts = 4096;
constexpr double kPrecisionOfMany = 0.02;

std::uint32_t texels_per_cell(std::uint32_t resolution, std::size_t charts) {
  const double cells = std::max(kCells, kCellsPerChart * std::sqrt(static_cast<double>(charts)));
  return static_cast<std::uint32_t>(std::ceil(resolution / cells));
}

// Lengths with the same three leading bits share a class.
std::uint64_t size_class(std::uint32_t length) {
  const auto shift = static_cast<std::uint32_t>(std::max(0, static_cast<int>(std::bit_width(length)) - 3));
  return std::uint64_t{shift} << 3 | length >> shift;
}

struct Packing {
  std::vector<Placement> placements;
  std::uint32_t rows = 0;  ///< of cells in use, perhaps more than there are
};

class Packer {
 public:
  Packer(std::span<const Shape> shapes, const PackOptions& options)
      : shapes_(shapes),
        resolution_(options.resolution),
        gutter_(options.gutter),
        cell_(texels_per_cell(options.resolution, shapes.size())),
        many_(options.many_small || shapes.size() > kManyCharts) {
    for (const Shape& s : shapes) longest_ = std::max({longest_, s.size[0], s.size[1]});
    order_.resize(shapes.size());
    std::iota(order_.begin(), order_.end(), 0u);
    const auto extent = [&](std::uint32_t s) { return shapes[s].size[0] * shapes[s].size[1]; };
    std::stable_sort(order_.begin(), order_.end(), [&](auto a, auto b) { return extent(a) > extent(b); });
  }

  [[nodiscard]] std::uint32_t cells() const { return resolution_ / cell_; }
  [[nodiscard]] std::uint32_t rows() const {
    return static_cast<std::uint32_t>(std::ceil(kTallness * cells()));
  }
  [[nodiscard]] bool many() const { return many_; }
  /// No packing needs to be tried at a larger scale.
  [[nodiscard]] double largest_scale() const {
    const double gutter = std::ceil(1.0 * gutter_ / cell_) * cell_;
    return (resolution_ - 2 * gutter - 2 * cell_) / longest_;
  }

  // The scale at which footprints cover about the given fraction of the atlas: a region dilated by r grows by
  // r times its perimeter and a few texels for its corners. Empty if corners alone take more.
  [[nodiscard]] std::optional<double> scale_for(double share) const {
    const double gutter = std::ceil(1.0 * gutter_ / cell_) * cell_;
    const double margin = gutter + 0.5 * cell_, corner = 2 * gutter + cell_;
    double area = 0, perimeter = 0;
    for (const Shape& s : shapes_) {
      area += s.area;
      perimeter += s.perimeter;
    }
    const double room =
        share * resolution_ * resolution_ - corner * corner * static_cast<double>(shapes_.size());
    if (room <= 0) return std::nullopt;
    // area s² + margin perimeter s = room, without cancellation; a long thin shape may reach across before
    // that
    const double b = margin * perimeter;
    return std::min(2 * room / (b + std::sqrt(b * b + 4 * area * room)), largest_scale());
  }

  // Places shapes by first fit, large ones first, each in the rotation that extends least far down. Empty if
  // a shape does not fit into the taller bin.
  [[nodiscard]] std::optional<Packing> try_scale(double scale) const {
    BitmapBin bin(cells(), rows());
    Packing packing;
    packing.placements.resize(shapes_.size());
    // A stamp rarely fits above the last one of about the same size: starting from there saves nearly all of
    // the search with many small charts.
    std::unordered_map<std::uint64_t, std::uint32_t> first_rows;
    for (const std::uint32_t s : order_) {
      poll();
      const Vec2& size = shapes_[s].size;
      if (scale * std::max(size[0], size[1]) + 2.0 * gutter_ > resolution_) return std::nullopt;
      const Footprint footprint = make_footprint(shapes_[s], {scale, gutter_, cell_});
      const auto best = lowest_turn(footprint, rows(), [&](const Stamp& stamp, std::uint32_t end_y) {
        std::uint32_t& first_row = first_rows[size_class(stamp.width) << 32 | size_class(stamp.height)];
        const auto spot = bin.first_fit(stamp, first_row, end_y);
        if (many_) first_row = std::max(first_row, spot ? spot->y : end_y);
        return spot;
      });
      if (!best) return std::nullopt;
      bin.place(footprint.stamps[best->turn], best->spot);
      packing.placements[s] = placement_of(footprint, best->turn, scale,
                                           {1.0 * best->spot.x * cell_, 1.0 * best->spot.y * cell_});
      packing.rows = std::max(packing.rows, best->bottom);
    }
    return packing;
  }

 private:
  std::span<const Shape> shapes_;
  std::uint32_t resolution_, gutter_, cell_;
  bool many_;                         // small charts
  double longest_ = 0;                // side of a shape's rectangle
  std::vector<std::uint32_t> order_;  // of placement
};

// The shares that a round tries: those that divide the gap between `low` and `high`, or the two around the
// guess of what just fits, 0 if there is none. If it fits just below the guess and not just above it, the
// search ends.
std::array<double, kTrials> shares_of(int round, double low, double high, double guess, double precision) {
  if (round == 0) return kFirstShares;
  if (guess > 0 && round <= kGuesses && high - low > 3 * precision) {
    const double half = 0.49 * precision, centre = std::clamp(guess, low + precision, high - precision);
    return {centre - half, centre + half};
  }
  std::array<double, kTrials> shares{};
  for (int k = 0; k < kTrials; ++k) shares[k] = low + (high - low) * (k + 1) / (kTrials + 1);
  return shares;
}

[[noreturn]] void throw_too_small(std::size_t charts, std::uint32_t resolution, std::uint32_t gutter) {
  // Assumes charts of one or two texels, packed to four fifths.
  const double side = (2.0 * gutter + 1) * std::sqrt(1.25 * static_cast<double>(charts));
  const auto enough =
      static_cast<std::uint64_t>(std::exp2(std::ceil(std::log2(std::max(side, resolution + 1.0)))));
  throw TooSmall("an atlas of " + std::to_string(resolution) + "² texels is too small for " +
                     std::to_string(charts) + " charts with gutters of " + std::to_string(gutter) +
                     "; use a resolution of about " + std::to_string(enough),
                 enough);
}

}  // namespace

Vec2 Placement::apply(const Vec2& q) const {
  return Vec2{dot(matrix[0], q), dot(matrix[1], q)} + offset;
}

Placement placement_of(const Footprint& footprint, unsigned turn, double scale, const Vec2& corner) {
  const Vec2 origin = turned(footprint, turn, {0, 0});
  const Vec2 x = turned(footprint, turn, {1, 0}) - origin, y = turned(footprint, turn, {0, 1}) - origin;
  return {{Vec2{scale * x[0], scale * y[0]}, Vec2{scale * x[1], scale * y[1]}},
          turned(footprint, turn, footprint.shift) + corner};
}

std::vector<Placement> pack(std::span<const Shape> shapes, const PackOptions& options,
                            const Progress& progress) {
  const Packer packer(shapes, options);
  require_memory(kTrials * BitmapBin::bytes(packer.cells(), packer.rows()), "packing the atlas");
  // Fractions of the atlas: once there is a best packing, `low` is known to fit; before, it does not even
  // hold the gutters. `high` is known not to fit, if it is below 1; it is `low` if no larger scale
  // needs to be tried.
  double low = 0, high = 1;
  std::optional<std::vector<Placement>> best;
  const double precision = packer.many() ? kPrecisionOfMany : kPrecision;
  // Rounds divide the gap by about kTrials + 1, or by more. Those that achieve less report nothing new.
  const double first_gap = high - low;
  const auto done_at = [&](double gap) {
    return std::log(first_gap / gap) / std::log(first_gap / precision);
  };
  double done = 0;
  const auto report = [&](std::string_view step, double of_round) {
    const double begin = done_at(high - low), end = done_at((high - low) / (kTrials + 1));
    done = std::max(done, std::min(1.0, begin + of_round * (end - begin)));
    return progress(step, done);
  };
  double guess = 0;  // what should just fit; 0: unknown
  for (int round = 0; !best || high - low > precision; ++round) {
    if (high - low < kPrecision) throw_too_small(shapes.size(), options.resolution, options.gutter);
    const std::array<double, kTrials> shares = shares_of(round, low, high, guess, precision);
    std::array<std::optional<double>, kTrials> scales;
    std::array<std::optional<Packing>, kTrials> packings;
    parallel_for(kTrials, 1, progress ? Progress(report) : Progress(), "packing",
                 [&](std::size_t begin, std::size_t end) {
                   for (std::size_t k = begin; k < end; ++k)
                     if ((scales[k] = packer.scale_for(shares[k])))
                       packings[k] = packer.try_scale(*scales[k]);
                 });
    guess = 0;
    double off = 1;
    for (int k = 0; k < kTrials; ++k) {
      if (packings[k]) {
        // Rows are filled about equally at scales that differ little.
        const double fitting = shares[k] * packer.cells() / packings[k]->rows;
        if (std::abs(fitting - shares[k]) < off) {
          guess = fitting;
          off = std::abs(fitting - shares[k]);
        }
      }
      if (packings[k] && packings[k]->rows <= packer.cells()) {
        low = shares[k];
        best = std::move(packings[k]->placements);
        if (scales[k] == packer.largest_scale()) high = low;
      } else if (!scales[k] && !best) {
        low = shares[k];
      }
    }
    for (int k = kTrials - 1; k >= 0; --k)
      if (shares[k] > low) high = std::min(high, shares[k]);
  }
  return std::move(*best);
}

}  // namespace sdm::atlas
