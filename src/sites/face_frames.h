// The faces of a leaf in a form from which eight distances take few instructions, made when first needed.
#pragma once

#include <sdm/types.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>

#include "geometry/triangle.h"
#include "geometry/unit_frame.h"

namespace sdm::sites {

/// Up to eight triangles in the unit frame, one per lane, each in a frame of its own: `along` its longest
/// side, `beside` this side in its plane, and `normal`. With A the start of that side, B its end, C the third
/// corner and q = x − A in the frame,
///   |x − triangle|² = q_normal² + |(q_along, q_beside) − triangle in its plane|².
/// The frame is computed in double precision and orthonormal for any shape: that of a needle may be any that
/// contains its longest side, and is off by the height of the needle at most. Unused lanes are NaN.
struct FaceFrames {
  static constexpr int kWidth = 8;
  /// A direction in the plane and a length; direction (1, 0) if the length is 0.
  struct Side {
    alignas(32) float along[kWidth], beside[kWidth], length[kWidth];
  };
  alignas(64) float origin[3][kWidth];  ///< A
  alignas(32) float along[3][kWidth];
  alignas(32) float beside[3][kWidth];
  alignas(32) float normal[3][kWidth];
  alignas(32) float length[kWidth];  ///< of AB
  Side ac, bc;                       ///< from A to C, and from B to C
  alignas(32) std::uint32_t face[kWidth];

  /// Sets a lane to a triangle with these corners in the unit frame.
  void set(std::size_t lane, const Corners& corners);
  void set_unused(std::size_t lane);
};

/// What frames are made from.
struct FrameSource {
  std::span<const Vec3> positions;
  std::span<const Triangle> triangles;
  const UnitFrame& frame;
  std::span<const std::uint32_t> faces;   ///< in the order of the leaves
  std::span<const std::uint32_t> leaves;  ///< the first of the faces of each leaf; and an end
};

/// The frames of all leaves. Those of a leaf are made by the first search that needs them, so maps and builds
/// take no time for them, nor memory. The const functions may be called concurrently.
class LeafFrames {
 public:
  /// Forgets all frames, after a change of positions. Cost: constant.
  void forget();

  /// Access by one search.
  class View {
   public:
    View(const LeafFrames& frames, const FrameSource& source);

    /// Valid until the next call.
    const FaceFrames& operator[](std::uint32_t leaf) {
      if (made_[leaf].load(std::memory_order_acquire) == version_) return frames_[leaf];
      return make(leaf);
    }

   private:
    const FaceFrames& make(std::uint32_t leaf);

    FrameSource source_;
    FaceFrames* frames_;
    std::atomic<std::uint32_t>* made_;
    std::uint32_t version_;
    FaceFrames own_;  ///< made here while another thread makes the shared ones
  };

 private:
  struct Store {
    explicit Store(std::size_t leaves);
    std::unique_ptr<FaceFrames[]> frames;  ///< not initialized: pages that no search reads take no memory
    /// The version for which the frames of each leaf were made; kBeingMade while they are.
    std::unique_ptr<std::atomic<std::uint32_t>[]> made;
  };
  /// Owns a store that any thread may have allocated.
  struct Shared {
    Shared() = default;
    Shared(Shared&& other) noexcept : store(other.store.exchange(nullptr)) {}
    Shared& operator=(Shared&& other) noexcept {
      delete store.exchange(other.store.exchange(nullptr));
      return *this;
    }
    ~Shared() { delete store.load(); }
    Store& get(std::size_t leaves);

    std::atomic<Store*> store = nullptr;
  };
  static constexpr std::uint32_t kNever = 0, kBeingMade = ~0u;

  mutable Shared shared_;
  std::uint32_t version_ = 1;
};

}  // namespace sdm::sites
