// Cancellation of calls that would go on for long.
#include "core/cancellation.h"

#include <sdm/sdm.h>

#include <atomic>
#include <chrono>
#include <ctime>
#include <functional>
#include <thread>

#include "core/parallel.h"
#include "geometry/vec.h"
#include "support/shapes.h"

namespace sdm::test {
namespace {

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Sets a flag once this process has used so much more processor time.
class Timer {
 public:
  Timer(std::atomic<bool>& flag, double seconds)
      : thread_([this, &flag, end = cpu_seconds() + seconds] {
          while (cpu_seconds() < end && !stopped_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
          set_at = cpu_seconds();
          flag = true;
        }) {}
  ~Timer() { stop(); }
  void stop() {
    stopped_ = true;
    if (thread_.joinable()) thread_.join();
  }
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;

  double set_at = cpu_seconds();

 private:
  std::atomic<bool> stopped_{false};
  std::thread thread_;
};

Mesh spheres(int count) {
  Mesh mesh;
  for (int i = 0; i < count; ++i)
    mesh = joined(mesh, moved(sphere(3), {0.31 * (i % 4), 0.29 * (i / 4 % 4), 0.27 * (i / 16)}));
  return mesh;
}

Mesh with_holes(Mesh mesh) {
  for (std::size_t f = 0; f < mesh.triangles.size(); f += 100) mesh.triangles[f].fill(mesh.triangles[f][0]);
  std::erase_if(mesh.triangles, is_removed);
  return mesh;
}

/// n triangles along x and n along y, each of which crosses all of the others.
Mesh grid_of_needles(int n) {
  Mesh mesh;
  for (int i = 0; i < 2 * n; ++i) {
    const double at = static_cast<double>(i / 2) / n, width = 0.3 / n;
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const Vec3& p : {Vec3{-1, at, -0.1}, Vec3{2, at, 0.1}, Vec3{2, at + width, 0.2}})
      mesh.positions.push_back(i % 2 == 0 ? p : Vec3{p[1], p[0], -p[2]});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

struct LongCall {
  std::string name;
  std::function<std::function<void()>()> prepare;  ///< what is not cancelled; returns the call

  friend void PrintTo(const LongCall& call, std::ostream* out) { *out << call.name; }
};

const std::vector<LongCall> kCalls{
    {"inspect", [] { return [mesh = ring(500)] { (void)inspect(mesh); }; }},
    {"sites", [] { return [mesh = ring(500)] { (void)Sites(mesh); }; }},
    {"sites_of_shells", [] { return [mesh = spheres(60)] { (void)Sites(mesh); }; }},
    {"surface", [] { return [mesh = ring(300)] { (void)Surface(mesh, {.resolution = 4096}); }; }},
    {"map",
     [] {
       return [surface = std::make_shared<Surface>(ring(60), AtlasOptions{.resolution = 2048}),
               sites = std::make_shared<Sites>(spheres(20))] { (void)compute_map(*surface, *sites); };
     }},
    {"winding",
     [] {
       return [surface = std::make_shared<Surface>(ring(60), AtlasOptions{.resolution = 1024}),
               sites = std::make_shared<Sites>(with_holes(spheres(20)))] {
         (void)compute_map(*surface, *sites, {.sign = SignMethod::winding});
       };
     }},
    {"inside_flags",
     [] {
       const auto sites = std::make_shared<Sites>(with_holes(spheres(20)));
       std::vector<Vec3> points(300'000);
       for (std::size_t i = 0; i < points.size(); ++i)
         points[i] = {1e-5 * static_cast<double>(i % 1000), 0.3, 1e-5 * static_cast<double>(i % 777)};
       return [=, closest = closest_points(*sites, points)] {
         (void)inside_flags(*sites, points, closest, SignMethod::winding);
       };
     }},
    {"self_intersections",
     [] {
       return [sites = std::make_shared<Sites>(grid_of_needles(2500))] { (void)self_intersections(*sites); };
     }},
    {"hausdorff",
     [] {
       return [mesh = ring(200), sites = std::make_shared<Sites>(spheres(20))] {
         (void)one_sided_hausdorff(mesh, *sites, {.precision = 1e-9});
       };
     }},
    {"depth",
     [] {
       return [o1 = spheres(20), o2 = moved(spheres(20), {0.1, 0.05, 0.02})] {
         (void)ProximityQuery(o1, o2).penetration_depth();
       };
     }},
    {"contacts",
     [] {
       return [o1 = spheres(20), o2 = moved(spheres(20), {0.1, 0.05, 0.02})] {
         (void)ProximityQuery(o1, o2).contacts();
       };
     }},
    {"volume", [] { return [sites = std::make_shared<Sites>(spheres(50))] { (void)solid_volume(*sites); }; }},
    {"field",
     [] {
       return [sites = std::make_shared<Sites>(spheres(20))] {
         (void)compute_field(*sites, make_grid(bounds(sites->mesh()), {300, 300, 300}));
       };
     }},
    {"covering_radius",
     [] {
       return [surface = std::make_shared<Surface>(ring(200), AtlasOptions{.resolution = 2048})] {
         (void)SamplingBound(*surface);
       };
     }},
    {"self_map", [] { return [mesh = spheres(10)] { (void)SelfProximityQuery(mesh).contacts(0.1); }; }}};

struct Cancellation : ::testing::TestWithParam<LongCall> {};
INSTANTIATE_TEST_SUITE_P(Calls, Cancellation, ::testing::ValuesIn(kCalls),
                         [](const auto& call) { return call.param.name; });

// Measured in time of the processor, so that other processes do not matter; of all threads, and including the
// end of what was under way. Without sanitizers it takes 0.1 s at most.
TEST_P(Cancellation, EndsTheCallSoon) {
  constexpr double kMost = 2;
  const std::function<void()> call = GetParam().prepare();
  for (const double seconds : {0.0, 0.02, 0.11, 0.4}) {
    SCOPED_TRACE(seconds);
    std::atomic<bool> flag{seconds == 0};
    Timer timer(flag, seconds);
    const CancelScope scope(flag);
    bool cancelled = false;
    try {
      call();
    } catch (const Cancelled&) {
      cancelled = true;
    }
    const double end = cpu_seconds();
    timer.stop();
    if (seconds == 0) {
      EXPECT_TRUE(cancelled);
    }
    if (!cancelled) break;  // it was finished first
    EXPECT_LT(end - timer.set_at, kMost);
  }
}

// Regression: filling the arrays of a large field took seconds without a poll.
TEST(Cancellation, EndsAFieldSoonWhileItsMemoryIsMade) {
  const Sites sites(test::cube());
  std::atomic<bool> flag{false};
  Timer timer(flag, 0.02);
  const CancelScope scope(flag);
  EXPECT_THROW((void)compute_field(sites, make_grid(bounds(sites.mesh()), {700, 700, 700})), Cancelled);
  const double end = cpu_seconds();
  timer.stop();
  EXPECT_LT(end - timer.set_at, 0.2);
}

TEST(CancelScope, TheInnermostOneApplies) {
  const std::atomic<bool> set{true}, never{false};
  const auto work = [] { parallel_for(100, 1, [](std::size_t, std::size_t) {}); };
  const CancelScope outer(set);
  EXPECT_THROW(work(), Cancelled);
  {
    const CancelScope inner(never);
    work();
  }
  EXPECT_THROW(work(), Cancelled);
  std::thread(work).join();  // another thread
}

TEST(CancelScope, ReachesTheThreadsThatWorkForACall) {
  std::atomic<bool> flag{false};
  const CancelScope scope(flag);
  std::atomic<int> after{0};
  EXPECT_THROW(parallel_for(8, 1,
                            [&](std::size_t, std::size_t) {
                              flag = true;
                              poll();
                              ++after;
                            }),
               Cancelled);
  EXPECT_EQ(after, 0);
  const auto tasks = [&] { parallel_tasks([&](Tasks& group) { group.add([&] { ++after; }); }); };
  EXPECT_THROW(tasks(), Cancelled);
  EXPECT_THROW(parallel_invoke([&] { ++after; }, [&] { ++after; }), Cancelled);
  EXPECT_EQ(after, 0);
}

// Of a loop inside a part of another one, on behalf of the outer one's callback.
TEST(CancelScope, AProgressCallbackCancelsNestedLoops) {
  std::atomic<int> entered{0};
  const auto cancel = [](std::string_view, double) { return false; };
  EXPECT_THROW(parallel_for(100, 1, cancel, "work",
                            [&](std::size_t begin, std::size_t) {
                              if (begin == 0) return;
                              parallel_for(100, 1, [&](std::size_t, std::size_t) { ++entered; });
                            }),
               Cancelled);
  EXPECT_LT(entered, 99 * 100);
}

TEST(CancelScope, ChangesInPlaceAreCompleted) {
  const std::atomic<bool> set{true};
  const Mesh before = ring(20), after = moved(ring(20), {0.3, 0.1, 0});
  Sites sites(before);
  Surface surface(before, {.resolution = 128});
  ProximityQuery query(before, sphere(2));
  Mesh mesh = before;
  const MeshEdit edit{.removed_faces = {3, 5}};
  {
    const CancelScope scope(set);
    sites.refit(after.positions);
    sites.edit(edit);
    surface.refit(after.positions);
    surface.edit(edit);
    query.refit(after.positions, {});
    apply(mesh, edit);
  }
  EXPECT_EQ(sites.mesh().positions, after.positions);
  EXPECT_EQ(sites.mesh().triangles, mesh.triangles);
  EXPECT_EQ(surface.mesh().triangles, mesh.triangles);
  const std::vector<Vec3> points = sphere(3).positions;
  const auto found = closest_points(sites, points), expected = closest_points(Sites(sites.mesh()), points);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(found[i].distance, expected[i].distance);
  EXPECT_EQ(query.separation().value, ProximityQuery(after, sphere(2)).separation().value);
}

// Once, a depth that had been cancelled was absent afterwards.
TEST(CancelScope, ACancelledQueryCanBeAskedAgain) {
  const Mesh o1 = spheres(4), o2 = moved(spheres(4), {0.1, 0.05, 0.02});
  ProximityQuery fresh(o1, o2), query(o1, o2);
  ASSERT_TRUE(fresh.penetration_depth());
  for (const double seconds : {0.0, 0.002, 0.02}) {
    std::atomic<bool> flag{seconds == 0};
    Timer timer(flag, seconds);
    const CancelScope scope(flag);
    try {
      (void)query.penetration_depth();
      (void)query.contacts();
    } catch (const Cancelled&) {
    }
  }
  // A search that was cancelled leaves what it has found, from which the next one may come to other bounds.
  const std::optional<BoundedLength> again = query.penetration_depth(), expected = fresh.penetration_depth();
  ASSERT_TRUE(again);
  EXPECT_LE(again->lower, expected->upper);
  EXPECT_GE(again->upper, expected->lower);
  EXPECT_NEAR(again->upper, expected->upper, ProximityOptions::kDepthPrecision * diagonal(bounds(o1)));
  EXPECT_EQ(query.contacts().size(), fresh.contacts().size());
}

}  // namespace
}  // namespace sdm::test
