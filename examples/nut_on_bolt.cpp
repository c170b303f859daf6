// A nut screws down its bolt: it is turned by 6°, falls until the threads touch, and so on. MultiBodyQuery
// says how far it falls, and that it is free on the way. Exits with 1 if a turn does not advance it by the
// pitch.
#include <sdm/sdm.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <vector>

namespace {

constexpr std::uint32_t kSides = 48, kRows = 4;  // around the axis, and along each pitch
constexpr double kPitch = 1, kCrest = 3, kRoot = 2.5;

// A band around the axis whose rows climb by a pitch with each turn: after kSides columns, row j meets row
// j + kRows of the first one.
struct Helix {
  std::uint32_t rows;

  std::uint32_t size() const { return kSides * (rows + 1) + kRows; }
  std::uint32_t vertex(std::uint32_t column, std::uint32_t row) const {
    if (column == kSides) return vertex(0, row + kRows);
    return column == 0 ? row : kRows + column * (rows + 1) + row;
  }
  // The vertices at radius(angle, row), from the first column to the last.
  template <class Radius>
  void add_vertices(sdm::Mesh& mesh, double from, const Radius& radius) const {
    for (std::uint32_t i = 0; i < kSides; ++i)
      for (std::uint32_t j = 0; j <= (i == 0 ? rows + kRows : rows); ++j) {
        const double angle = 2 * std::numbers::pi * i / kSides, r = radius(angle, j);
        const double height = from + kPitch * (1.0 * j / kRows + 1.0 * i / kSides);
        mesh.positions.push_back({r * std::cos(angle), r * std::sin(angle), height});
      }
  }
  // The vertices of an end in order around the axis: a turn of the first or last row, and the step back.
  std::vector<std::uint32_t> end(std::uint32_t row) const {
    std::vector<std::uint32_t> loop;
    for (std::uint32_t i = 0; i < kSides; ++i) loop.push_back(vertex(i, row));
    for (std::uint32_t j = kRows; j > 0; --j) loop.push_back(vertex(0, row + j));
    return loop;
  }
};

void add_quad(sdm::Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
}

// Two rows on the crest of the thread, and two on its root.
double thread(std::uint32_t row) {
  return row % kRows < kRows / 2 ? kCrest : kRoot;
}

sdm::Mesh bolt(std::uint32_t rows) {
  const Helix helix{rows};
  sdm::Mesh mesh;
  helix.add_vertices(mesh, 0, [](double, std::uint32_t row) { return thread(row); });
  for (std::uint32_t i = 0; i < kSides; ++i)
    for (std::uint32_t j = 0; j < helix.rows; ++j)
      add_quad(mesh, helix.vertex(i, j), helix.vertex(i + 1, j), helix.vertex(i + 1, j + 1),
               helix.vertex(i, j + 1));
  for (const std::uint32_t row : {0u, helix.rows}) {  // each end to a point of the axis
    const auto middle = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back({0, 0, kPitch * (1.0 * row / kRows + 0.5)});
    const std::vector<std::uint32_t> loop = helix.end(row);
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const std::uint32_t a = loop[k], b = loop[(k + 1) % loop.size()];
      mesh.triangles.push_back(row == 0 ? sdm::Triangle{a, middle, b} : sdm::Triangle{a, b, middle});
    }
  }
  return mesh;
}

// Hexagonal outside; the thread inside is wider than that of the bolt by `clearance`.
sdm::Mesh nut(std::uint32_t rows, double clearance) {
  const Helix helix{rows};
  sdm::Mesh mesh;
  helix.add_vertices(mesh, 0, [&](double, std::uint32_t row) { return thread(row) + clearance; });
  helix.add_vertices(mesh, 0, [](double angle, std::uint32_t) {
    constexpr double side = std::numbers::pi / 3;
    return 4.5 / std::cos(std::fmod(angle, side) - side / 2);
  });
  const std::uint32_t outside = helix.size();
  for (std::uint32_t i = 0; i < kSides; ++i)
    for (std::uint32_t j = 0; j < helix.rows; ++j) {
      const std::uint32_t a = helix.vertex(i, j), b = helix.vertex(i + 1, j);
      const std::uint32_t c = helix.vertex(i + 1, j + 1), d = helix.vertex(i, j + 1);
      add_quad(mesh, d, c, b, a);
      add_quad(mesh, outside + a, outside + b, outside + c, outside + d);
    }
  for (const std::uint32_t row : {0u, helix.rows}) {
    const std::vector<std::uint32_t> loop = helix.end(row);
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const std::uint32_t a = loop[k], b = loop[(k + 1) % loop.size()];
      if (row == 0)
        add_quad(mesh, a, b, outside + b, outside + a);
      else
        add_quad(mesh, outside + a, outside + b, b, a);
    }
  }
  return mesh;
}

// The nut, turned as a right-handed screw that is driven down.
sdm::Transform pose(double degrees, double height) {
  return sdm::Transform::translation({0, 0, height}) * sdm::Transform::rotation({0, 0, -degrees});
}

}  // namespace

int main() {
  constexpr double kStep = 6, kFall = kPitch / 2, kTolerance = 1e-4;
  constexpr int kTurns = 2, kSteps = 60;  // in a turn
  std::vector<sdm::Shape> shapes;
  shapes.emplace_back(bolt(6 * kRows));
  shapes.emplace_back(nut(kRows + 2, 0.05));
  sdm::MultiBodyQuery world(shapes);
  world.set_filter(0, {.fixed = true});

  double angle = 0, height = 4 * kPitch;
  bool as_it_should = world.sites(0).closed() && world.sites(1).closed() && sdm::is_embedded(world.sites(1));
  for (int turn = 0; turn <= kTurns; ++turn) {
    const double before = height;
    for (int step = 0; step < (turn == 0 ? 1 : kSteps); ++step) {
      // The bodies are more than half of the tolerance apart, and turning makes room for the nut.
      const sdm::Transform from = pose(angle, height), turned = pose(angle += turn == 0 ? 0 : kStep, height);
      std::vector<sdm::Motion> motions{{}, {from, turned}};
      as_it_should &= world.time_of_contact(motions, kTolerance / 4).empty();
      motions[1] = {turned, pose(angle, height - kFall)};
      const auto found = world.time_of_contact(motions, kTolerance);
      as_it_should &= found.size() == 1;
      if (!found.empty()) height -= kFall * found.front().time_of_contact.time;
      world.set_pose(1, pose(angle, height));
      as_it_should &= world.colliding().empty();
    }
    if (turn == 0) continue;  // from where it was held to where it rests on the thread
    std::printf("turn %d: advanced by %.4f\n", turn, before - height);
    as_it_should &= std::abs(before - height - kPitch) < 4 * kTolerance;
  }
  std::printf(as_it_should ? "one pitch per turn, without a collision\n" : "not as a nut should\n");
  return as_it_should ? 0 : 1;
}
