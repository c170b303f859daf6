#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sdm/error.h>
#include <sdm/mesh_files.h>
#include <sdm/sites.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "support/error_of.h"
#include "support/temporary_folder.h"

namespace sdm::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string cad_file(const std::string& name) {
  return std::string(SDM_CAD_FILES) + "/" + name;
}

std::string contents(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

double volume_of(const Mesh& mesh) {
  return solid_volume(Sites(mesh), {.embedded = true}).value;
}

const FaceNames& names_of_kind(const MeshFile& file, const std::string& kind) {
  for (const FaceNames& names : file.names)
    if (names.kind == kind) return names;
  throw Error("no names of kind " + kind);
}

TEST(Cad, SolidsAreClosedAndOriented) {
  for (const char* name : {"box.step", "cylinder.step", "tube.step", "sphere.step", "tube.igs"}) {
    const MeshFile file = read_mesh_file(cad_file(name));
    const MeshInfo info = inspect(file.mesh);
    EXPECT_TRUE(info.closed && info.oriented && info.manifold) << name;
    EXPECT_EQ(info.components, 1u) << name;
    EXPECT_EQ(info.degenerate_faces, 0u) << name;
    EXPECT_GT(volume_of(file.mesh), 0) << name;
  }
}

TEST(Cad, TheDeflectionIsLimited) {
  const auto ball = [](const TessellationOptions& options) {
    return read_mesh_file(cad_file("sphere.step"), {.tessellation = options});
  };
  const MeshFile fine = ball({.at_most = 0.008});
  EXPECT_EQ(fine.tessellation->deflection, 0.008);
  EXPECT_LE(fine.tessellation->largest_deviation, 2.2 * 0.008) << "of a sphere, twice";
  EXPECT_FALSE(fine.tessellation->limited);
  const MeshFile few = ball({.at_most = 1e-4, .most_triangles = fine.mesh.triangles.size()});
  EXPECT_LE(few.mesh.triangles.size(), fine.mesh.triangles.size());
  EXPECT_GT(few.tessellation->deflection, 1e-4);
  EXPECT_TRUE(few.tessellation->limited);
  EXPECT_THAT(note_on(*few.tessellation, "ball.step"), HasSubstr("too many triangles"));
  EXPECT_EQ(ball({.at_most = 1}).mesh.triangles.size(), ball({}).mesh.triangles.size()) << "no coarser";
  EXPECT_EQ(ball({.deflection = 0.1, .at_most = 0.008}).tessellation->deflection, 0.1);
  EXPECT_THROW((void)ball({.at_most = 0}), Error);
}

/// A folder that is the current one.
struct CurrentFolder {
  explicit CurrentFolder(const std::filesystem::path& folder) { std::filesystem::current_path(folder); }
  ~CurrentFolder() { std::filesystem::current_path(before); }
  CurrentFolder(const CurrentFolder&) = delete;
  CurrentFolder& operator=(const CurrentFolder&) = delete;
  std::filesystem::path before = std::filesystem::current_path();
};

// Two instances of a part of 1 × 2 × 3, which is a file of its own.
TEST(Cad, PartsThatAreFilesAreBesideTheAssembly) {
  namespace fs = std::filesystem;
  const TemporaryFolder folder;
  const fs::path here = std::string(folder / "here"), there = std::string(folder / "there");
  fs::create_directory(here);
  fs::create_directory(there);
  fs::copy(cad_file("external.step"), there / "external.step");
  fs::copy(cad_file("external_part.stp"), there / "external_part.stp");
  const auto read = [](const fs::path& file) { return read_mesh_file(file); };
  {
    const CurrentFolder current(here);
    fs::copy(cad_file("box.step"), "external_part.stp");  // another part of the name
    for (const fs::path& file : {there / "external.step", fs::path("../there/external.step")}) {
      const MeshFile found = read(file);
      EXPECT_EQ(found.tessellation->faces, 12u) << file;
      EXPECT_NEAR(volume_of(found.mesh), 12, 1e-9) << file;
    }
  }
  fs::remove(there / "external_part.stp");
  {
    const CurrentFolder current(here);
    EXPECT_THAT(error_of([&] { (void)read(there / "external.step"); }),
                HasSubstr("external.step: refers to the part external_part.stp, which is not beside it"));
  }
  std::ofstream(there / "external_part.stp") << "ISO-10303-21;\nnothing\n";
  EXPECT_THAT(error_of([&] { (void)read(there / "external.step"); }), HasSubstr("external_part.stp"));
  // Not from elsewhere either.
  std::string text = contents(there / "external.step");
  for (std::size_t at = 0; (at = text.find("'external_part.stp'", at)) != std::string::npos; ++at)
    text.replace(at, 19, "'../here/external_part.stp'");
  std::ofstream(there / "external.step") << text;
  EXPECT_THAT(error_of([&] { (void)read(there / "external.step"); }),
              HasSubstr("parts are looked up beside the STEP file only"));
}

/// A file of the tests with other words in it.
std::string replaced(std::string text, const std::vector<std::pair<std::string, std::string>>& words) {
  for (const auto& [from, to] : words) {
    EXPECT_NE(text.find(from), std::string::npos) << from;
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
      text.replace(at, from.size(), to);
  }
  return text;
}

// Parts whose shapes are in files that are not STEP would be left out.
TEST(Cad, PartsInOtherFormatsAreRefused) {
  const TemporaryFolder folder;
  const std::string file = folder / "assembly.step", text = contents(cad_file("external.step"));
  const auto error = [&](const std::vector<std::pair<std::string, std::string>>& words) {
    std::ofstream(file) << replaced(text, words);
    return error_of([&] { (void)read_mesh_file(file); });
  };
  const std::pair<std::string, std::string> name{"external_part.stp", "part.prt"}, format{"STEP AP214", "NX"},
      representation{" REPRESENTATION('document format'", " SHAPE_REPRESENTATION('document format'"};
  EXPECT_THAT(error({name}), HasSubstr("refers to the part part.prt, which is not beside it"));
  EXPECT_THAT(error({name, format, representation}),
              HasSubstr("refers to the part part.prt, which is not STEP"));
  std::ofstream(folder / "part.prt") << "binary";
  EXPECT_THAT(error({name}), HasSubstr("refers to the part part.prt, which cannot be read as STEP"));
  EXPECT_THAT(error({name, format, representation}),
              HasSubstr("refers to the part part.prt, which is not STEP"));
  std::filesystem::copy(cad_file("two.step"), folder / "external_part.stp");
  EXPECT_THAT(error({}), HasSubstr("a part that has several shapes, of which only the first has a place"));
}

// A part with a shape of its own loses nothing without the files that document it.
TEST(Cad, DocumentsAreNoParts) {
  const TemporaryFolder folder;
  const std::string file = folder / "part.step", text = contents(cad_file("box.step"));
  const std::string document =
      "#9010=DOCUMENT_FILE('drawing.pdf','',$,#9011,'',$);\n#9011=DOCUMENT_TYPE('');\n"
      "#9012=APPLIED_DOCUMENT_REFERENCE(#9010,'',(#5));\n";
  const std::string format =
      "#9013=PROPERTY_DEFINITION('document property','',#9010);\n"
      "#9014=PROPERTY_DEFINITION_REPRESENTATION(#9013,#9015);\n"
      "#9015=SHAPE_REPRESENTATION('document format',(#9016),#9017);\n"
      "#9016=DESCRIPTIVE_REPRESENTATION_ITEM('data format','PDF');\n"
      "#9017=REPRESENTATION_CONTEXT('','document parameters');\n";
  const auto read = [&](const std::string& entities) {
    std::ofstream(file) << std::string(text).insert(text.rfind("ENDSEC;"), entities);
    const MeshFile found = read_mesh_file(file);
    EXPECT_EQ(found.tessellation->faces, 6u);
    return found.notes;
  };
  const auto is_noted = [](const std::string& name) {
    return ElementsAre("it refers to files that are not read, as no shape is missing without them: " + name);
  };
  EXPECT_THAT(read(document), is_noted("drawing.pdf"));
  EXPECT_THAT(read(document + format), is_noted("drawing.pdf"));
  std::ofstream(folder / "drawing.pdf") << "binary";
  EXPECT_THAT(read(document), is_noted("drawing.pdf"));
  // The same part as another file, which OpenCASCADE puts beside it.
  std::filesystem::copy(cad_file("box.step"), folder / "copy.stp");
  EXPECT_THAT(read(replaced(document, {{"drawing.pdf", "copy.stp"}})), is_noted("copy.stp"));
}

TEST(Cad, PartsMayReferToPartsBesideThem) {
  namespace fs = std::filesystem;
  const TemporaryFolder folder;
  const fs::path file = folder / "assembly.step", sub = folder / "sub";
  fs::create_directory(sub);
  const std::string text = contents(cad_file("external.step"));
  std::ofstream(file) << replaced(text, {{"'external_part.stp'", "'sub/inner.stp'"}});
  std::ofstream(sub / "inner.stp") << text;
  fs::copy(cad_file("external_part.stp"), folder / "external_part.stp");  // not that of the inner assembly
  EXPECT_THAT(error_of([&] { (void)read_mesh_file(file); }),
              HasSubstr("refers to the part external_part.stp, which is not beside it"));
  fs::rename(folder / "external_part.stp", sub / "external_part.stp");
  const MeshFile found = read_mesh_file(file);
  EXPECT_EQ(found.tessellation->faces, 24u);
  EXPECT_NEAR(volume_of(found.mesh), 18, 1e-9) << "two of the four parts coincide";
}

TEST(Cad, BoxIsExact) {
  const MeshFile file = read_mesh_file(cad_file("box.step"));
  EXPECT_EQ(file.mesh.triangles.size(), 12u);
  EXPECT_EQ(file.mesh.positions.size(), 8u);
  EXPECT_DOUBLE_EQ(volume_of(file.mesh), 6000);
  ASSERT_TRUE(file.tessellation);
  EXPECT_EQ(file.tessellation->largest_deviation, 0);
  EXPECT_EQ(file.tessellation->faces, 6u);
  EXPECT_EQ(file.tessellation->format, "STEP");
  EXPECT_EQ(names_of_kind(file, "face").names.size(), 6u);
  EXPECT_THAT(names_of_kind(file, "object").names, ElementsAre("box"));
}

// The arc over a chord with the angle a between its ends rises by r (1 − cos a/2).
TEST(Cad, DeviationOfACylinderIsThatOfItsPolygon) {
  for (const double deflection : {0.5, 0.05, 0.005}) {
    const MeshFile file =
        read_mesh_file(cad_file("cylinder.step"), {.tessellation = {.deflection = deflection, .angle = 1}});
    std::set<double> angles;
    for (const Vec3& p : file.mesh.positions) {
      EXPECT_NEAR(std::hypot(p[0], p[1]), 10, 1e-9);
      if (p[2] == 0) angles.insert(std::atan2(p[1], p[0]));
    }
    double widest = *angles.begin() + 2 * std::numbers::pi - *angles.rbegin();
    for (auto a = angles.begin(); std::next(a) != angles.end(); ++a)
      widest = std::max(widest, *std::next(a) - *a);
    EXPECT_NEAR(file.tessellation->largest_deviation, 10 * (1 - std::cos(widest / 2)), 1e-9);
    EXPECT_LE(file.tessellation->largest_deviation, deflection);
    EXPECT_EQ(file.tessellation->deflection, deflection);
    EXPECT_GT(file.tessellation->measured_points, angles.size());
  }
}

TEST(Cad, DefaultDeflectionFollowsTheSize) {
  const MeshFile file = read_mesh_file(cad_file("tube.step"));
  const double diagonal = std::sqrt(20. * 20 + 20. * 20 + 30. * 30);
  EXPECT_NEAR(file.tessellation->deflection, diagonal / 2000, 1e-4 * diagonal);
  EXPECT_LE(file.tessellation->largest_deviation, file.tessellation->deflection);
  EXPECT_GT(file.tessellation->largest_deviation, 0);
  const double exact = std::numbers::pi * (100 - 64) * 30;
  EXPECT_NEAR(volume_of(file.mesh), exact, 2 * std::numbers::pi * 18 * 30 * file.tessellation->deflection);
}

TEST(Cad, AssembliesAreConvertedToMillimetresAndNamed) {
  const MeshFile file = read_mesh_file(cad_file("assembly.step"));
  const MeshInfo info = inspect(file.mesh);
  EXPECT_EQ(info.components, 2u);
  EXPECT_TRUE(info.closed && info.oriented);
  EXPECT_NEAR(info.bounds.upper[0], 50.8, 1e-9);
  EXPECT_NEAR(info.bounds.upper[2], 10.5 * 25.4, 1e-9);
  EXPECT_EQ(file.tessellation->file_unit, "INCH");
  EXPECT_THAT(names_of_kind(file, "object").names, ElementsAre("plate", "plate (2)"));

  const FaceNames &faces = names_of_kind(file, "face"), &colors = names_of_kind(file, "color");
  EXPECT_EQ(file.tessellation->faces, 12u);
  std::size_t on_top = 0;
  for (std::size_t f = 0; f < file.mesh.triangles.size(); ++f) {
    double lowest = 1e9;
    for (const std::uint32_t v : file.mesh.triangles[f])
      lowest = std::min(lowest, std::fmod(file.mesh.positions[v][2] + 1e-6, 254));
    const bool top = lowest > 12;
    on_top += top;
    EXPECT_EQ(faces.names[faces.of_face[f]] == "datum A", top) << f;
    EXPECT_EQ(colors.names[colors.of_face[f]], top ? "#ff0000" : "#0000ff") << f;
  }
  EXPECT_EQ(on_top, 4u);
}

TEST(Cad, IgesHasTheSameTube) {
  const MeshFile step = read_mesh_file(cad_file("tube.step")), iges = read_mesh_file(cad_file("tube.igs"));
  EXPECT_EQ(iges.tessellation->format, "IGES");
  EXPECT_EQ(iges.tessellation->file_unit, "INCH");
  EXPECT_NEAR(volume_of(iges.mesh), volume_of(step.mesh), 1e-3 * volume_of(step.mesh));
}

// Surfaces that have no edges in common.
TEST(Cad, IgesSurfacesThatMeetAreJoined) {
  const MeshFile solid = read_mesh_file(cad_file("tube.igs")),
                 surfaces = read_mesh_file(cad_file("surfaces.igs"));
  EXPECT_EQ(surfaces.tessellation->faces, solid.tessellation->faces);
  EXPECT_TRUE(inspect(surfaces.mesh).closed);
  EXPECT_NEAR(std::abs(volume_of(surfaces.mesh)), volume_of(solid.mesh), 1e-3 * volume_of(solid.mesh));
}

TEST(Cad, FormatsAreRecognisedByTheirContent) {
  const TemporaryFolder folder;
  for (const auto& [name, format] : {std::pair("box.step", "STEP"), std::pair("tube.igs", "IGES")}) {
    const std::string file = folder / "part.txt";
    std::ofstream(file, std::ios::binary) << contents(cad_file(name));
    EXPECT_EQ(read_mesh_file(file).tessellation->format, format);
  }
}

TEST(Cad, FilesThatAreCutAreRefused) {
  const TemporaryFolder folder;
  for (const char* name : {"tube.step", "tube.igs"}) {
    const std::string whole = contents(cad_file(name)), file = folder / name;
    for (int part = 1; part < 12; ++part) {
      std::ofstream(file, std::ios::binary) << whole.substr(0, whole.size() * part / 12);
      EXPECT_THAT(error_of([&] { (void)read_mesh(file); }), HasSubstr("truncated")) << name << " " << part;
    }
  }
}

// The end is there, but not what comes before it.
TEST(Cad, DamagedFilesAreRefusedOrRead) {
  const TemporaryFolder folder;
  const std::string whole = contents(cad_file("tube.step")), file = folder / "damaged.step";
  const std::size_t data = whole.find("DATA;"), end = whole.find("ENDSEC;", data);
  for (int part = 0; part < 8; ++part) {
    const std::size_t cut = data + 5 + (end - data) * part / 8;
    std::ofstream(file, std::ios::binary) << whole.substr(0, cut) << whole.substr(end);
    try {
      EXPECT_FALSE(read_mesh(file).triangles.empty());
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr("damaged.step: "));
    }
  }
}

TEST(Cad, FilesWithoutFacesAreRefused) {
  EXPECT_THAT(error_of([] { (void)read_mesh(cad_file("line.step")); }), HasSubstr("line.step: has no faces"));
}

}  // namespace
}  // namespace sdm::test
