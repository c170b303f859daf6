#include "scene.h"

#include "common_options.h"
#include "option_checks.h"
#include "output_folder.h"
#include "progress_line.h"
#include "scene_scan.h"

#include <fmt/format.h>
#include <sdm/error.h>
#include <sdm/execution.h>
#include <sdm/mesh_files.h>

#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scenes/scene.h"

namespace {

namespace fs = std::filesystem;
using sdm::scenes::Scene;
using sdm::scenes::SceneKind;

const std::map<std::string, SceneKind> kKinds{
    {"letters", SceneKind::letters}, {"bunnies", SceneKind::bunnies}, {"figure", SceneKind::figure},
    {"crowd", SceneKind::crowd},     {"cloth", SceneKind::cloth},     {"tear", SceneKind::tear}};

constexpr const char* kScan = "scan";  // no sequence

struct SceneCommand : RunOptions {
  std::string kind, format = "npy";
  fs::path out, mesh;
  int frames = 150;
  std::size_t triangles = 80000;
};

/// Writes the frames of a body.
class Recorder {
 public:
  Recorder(const Scene::Body& body, const fs::path& folder, bool numbered) : folder_(folder / body.name) {
    if (!body.moves) {
      sequence_ = body.name + ".ply";
      sdm::write_mesh(folder / sequence_, body.mesh);
    } else if (numbered || body.tears) {
      sequence_ = body.name;
      fs::create_directory(folder_);  // fails once the staging folder is gone
      numbered_ = true;
    } else {
      sequence_ = body.name + ".ply+" + body.name + ".npy";
      sdm::write_mesh(folder / (body.name + ".ply"), body.mesh);
      writer_ =
          std::make_unique<sdm::SequenceWriter>(folder / (body.name + ".npy"), body.mesh.positions.size());
    }
  }

  void add(const sdm::Mesh& mesh, int frame) {
    if (writer_) writer_->add(mesh.positions);
    if (!numbered_) return;
    sdm::write_mesh(folder_ / fmt::format("{:05}.ply", frame), mesh);
  }
  void commit() {
    if (writer_) writer_->commit();
  }
  /// The input of MeshSequence, relative to the folder of the scene.
  [[nodiscard]] const std::string& sequence() const { return sequence_; }

 private:
  fs::path folder_;
  std::string sequence_;
  std::unique_ptr<sdm::SequenceWriter> writer_;
  bool numbered_ = false;
};

nlohmann::ordered_json describe(const SceneCommand& command, const Scene& scene,
                                const std::vector<Recorder>& recorders) {
  nlohmann::ordered_json bodies = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < recorders.size(); ++i) {
    const Scene::Body& body = scene.bodies()[i];
    bodies.push_back({{"name", body.name},
                      {"sequence", recorders[i].sequence()},
                      {"moves", body.moves},
                      {"tears", body.tears},
                      {"vertices", body.mesh.positions.size()},
                      {"triangles", body.mesh.triangles.size()}});
  }
  return {{"scene", command.kind},
          {"frames", command.frames},
          {"time_step", scene.time_step()},
          {"bodies", bodies}};
}

void run(const SceneCommand& command) {
  limit_threads(command.threads);
  if (command.kind == kScan)
    return write_made_scan(command.mesh, command.triangles, command.out, command.quiet);
  OutputFolder out(command.out, {.command = "scene", .planned = {"scene.json"}});
  ProgressLine progress(command.quiet);
  const sdm::Progress report = progress.callback();
  nlohmann::ordered_json description;
  out.fill([&] {
    progress.step("meshes");
    Scene scene(kKinds.at(command.kind), {.mesh = command.mesh});
    std::vector<Recorder> recorders;
    for (const Scene::Body& body : scene.bodies())
      recorders.emplace_back(body, out.staging(), command.format == "ply");
    for (int frame = 0; frame < command.frames; ++frame) {
      if (frame > 0) scene.advance();
      for (std::size_t i = 0; i < recorders.size(); ++i) recorders[i].add(scene.bodies()[i].mesh, frame);
      if (!report("frames", (frame + 1.0) / command.frames)) throw sdm::Cancelled();
    }
    for (Recorder& recorder : recorders) recorder.commit();
    description = describe(command, scene, recorders);
    write_text(out.staging() / "scene.json", description.dump(2) + '\n');
  });
  if (command.quiet) return;
  std::cout << command.frames << " frames of " << description["time_step"].get<double>() << " s in "
            << command.out.string() << "/, described by scene.json:\n";
  for (const auto& body : description["bodies"])
    std::cout << "  " << body["sequence"].get<std::string>() << "  " << body["triangles"] << " triangles"
              << (body["moves"].get<bool>() ? "\n" : ", at rest\n");
}

}  // namespace

void add_scene_command(CLI::App& app) {
  CLI::App* scene = app.add_subcommand("scene", "Generate a deforming scene like those of the paper");
  const auto command = std::make_shared<SceneCommand>();
  const std::vector<std::string> names{"letters", "bunnies", "figure", "crowd", "cloth", "tear", kScan};
  scene
      ->add_option(
          "SCENE", command->kind,
          "colliding letters, colliding bunnies, a figure walking in a box, a crowd, a falling cloth, a "
          "cloth that a ball tears, or a made scan of a part, which is no sequence")
      ->required()
      ->check(CLI::IsMember(names))
      ->type_name(fmt::format("{}", fmt::join(names, "|")));
  add_output_option(*scene, command->out);
  scene->add_option("--frames", command->frames, "Number of frames, at 60 per second")
      ->transform(whole_number(1, 100000))
      ->type_name("N")
      ->capture_default_str();
  scene
      ->add_option("--format", command->format,
                   "Moving bodies: NAME.ply and NAME.npy, or NAME/00000.ply and so on, as always for those "
                   "that tear")
      ->check(CLI::IsMember({"npy", "ply"}).description(""))
      ->type_name("npy|ply")
      ->capture_default_str();
  scene
      ->add_option("--mesh", command->mesh,
                   "bunnies: the mesh to simplify, instead of the one of Debian's glmark2-data; scan: the "
                   "part, a closed mesh with a flat place")
      ->type_name("FILE");
  scene->add_option("--triangles", command->triangles, "scan: about how many, before 30 % are cut away")
      ->transform(whole_number(100, 100000000))
      ->type_name("N")
      ->capture_default_str();
  add_run_options(*scene, *command);
  scene->footer(
      "The files are sequences for `sdm sequence`; scan writes part.ply, scan.ply and scan.xyz. They are "
      "bit-identical on every run.\n\n"
      "Example:\n  sdm scene letters -o letters");
  scene->callback([scene, command] {
    const bool scan = command->kind == kScan;
    if (scene->count("--mesh") > 0 && command->kind != "bunnies" && !scan)
      throw CLI::ValidationError("--mesh", "requires the scene bunnies or scan");
    if (scan && command->mesh.empty())
      throw CLI::ValidationError("scene scan needs --mesh FILE, the part: a closed mesh with a flat place");
    if (scene->count("--triangles") > 0 && !scan)
      throw CLI::ValidationError("--triangles", "requires the scene scan");
    for (const char* option : {"--frames", "--format"})
      if (scan && scene->count(option) > 0)
        throw CLI::ValidationError(option, "the scene scan is no sequence");
    run(*command);
  });
}
