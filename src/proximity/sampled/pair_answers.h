// The results for two bodies, as computed by ProximityQuery for its pair and by MultiBodyQuery for each pair.
#pragma once

#include <sdm/proximity_query.h>

#include <array>
#include <optional>
#include <span>

#include "proximity/exact/pair_search.h"
#include "proximity/sampled/body.h"
#include "proximity/sampled/contacts.h"
#include "proximity/sampled/local_distances.h"

namespace sdm::sampled {

/// Results as documented at ProximityQuery, each computed on first use. Memory is reused from pair to pair;
/// results do not depend on earlier pairs.
class PairAnswers {
 public:
  struct Options {
    bool exact = false;
    double contact_margin = 0;
  };

  explicit PairAnswers(const Options& options) : options_(options) {}

  /// Sets the bodies to which the results refer. They must outlive this object and remain unchanged until the
  /// next call.
  void begin(const Body& o1, const Body& o2);

  [[nodiscard]] const BoundedLength& separation();
  [[nodiscard]] BoundedBool colliding();
  [[nodiscard]] const std::optional<BoundedLength>& penetration_depth();
  [[nodiscard]] std::span<const Contact> contacts();
  [[nodiscard]] std::size_t samples_used() const;

 private:
  /// A measured sample of one of the bodies.
  struct Sample {
    int body = 0;
    std::size_t index = kNone;
  };

  /// The depth of some samples: lower ≤ depth ≤ upper; `value` is attained by `points`.
  struct Depth {
    double lower = 0, value = 0, upper = 0;
    std::optional<std::array<Vec3, 2>> points{};
  };

  void measure();
  template <class Value>
  [[nodiscard]] std::pair<double, Sample> least(const Value& value) const;
  [[nodiscard]] std::optional<std::array<Vec3, 2>> witness(const Sample& sample) const;
  [[nodiscard]] exact::MeshPair meshes() const;
  const exact::Separation& closest_triangles();
  [[nodiscard]] BoundedLength exact_separation();
  [[nodiscard]] bool surfaces_intersect();
  [[nodiscard]] BoundedLength bounded_separation();
  [[nodiscard]] std::optional<BoundedLength> depth();
  [[nodiscard]] BoundedLength bounded_depth();
  [[nodiscard]] static Depth deeper(const Depth& a, const Depth& b);
  [[nodiscard]] Depth depth_at_faces(int body) const;
  [[nodiscard]] Depth depth_of_buried(int body, Depth known);

  Options options_;
  std::array<const Body*, 2> bodies_{};
  double precision_ = 0;                     // error of a computed distance
  std::array<LocalDistances, 2> distances_;  // of each body to the other
  ContactFinder finder_;
  exact::PairWorkspace workspace_;
  std::vector<std::optional<inside::SolidBoundary::Closest>> closest_boundary_;  // of the buried samples

  // Results for the current bodies.
  bool measured_ = false, depth_found_ = false;
  std::optional<exact::Separation> closest_, intersection_;  // from the triangles
  std::optional<BoundedLength> separation_, depth_;
  std::optional<BoundedBool> colliding_;
  std::optional<std::span<const Contact>> contacts_;
};

}  // namespace sdm::sampled
