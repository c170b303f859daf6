// Scenes: meshes that move, and made scans, for examples and measurements.
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <sdm/error.h>

#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "objects.h"
#include "scenes/made_scan.h"
#include "scenes/scene.h"
#include "values.h"

namespace sdm::python {
namespace {

using scenes::MadeScan;
using scenes::SceneKind;

struct PyScene {
  scenes::Scene scene;
  Access access;
};

struct PySceneBody {
  std::string name;
  bool moves = false, tears = false;
  nb::object mesh;
};

}  // namespace

template <>
inline constexpr auto kMembers<PySceneBody> =
    std::tuple{&PySceneBody::name, &PySceneBody::moves, &PySceneBody::tears};
template <>
inline constexpr auto kMembers<MadeScan> =
    std::tuple{&MadeScan::mesh,       &MadeScan::placement,   &MadeScan::size,  &MadeScan::dent_place,
               &MadeScan::dent_depth, &MadeScan::dent_radius, &MadeScan::noise, &MadeScan::missing};

namespace {

SceneKind kind_of(const std::string& name) {
  constexpr std::pair<const char*, SceneKind> kKinds[] = {
      {"letters", SceneKind::letters}, {"bunnies", SceneKind::bunnies}, {"figure", SceneKind::figure},
      {"crowd", SceneKind::crowd},     {"cloth", SceneKind::cloth},     {"tear", SceneKind::tear}};
  for (const auto& [known, kind] : kKinds)
    if (name == known) return kind;
  throw Error("scene must be one of letters, bunnies, figure, crowd, cloth, tear, not '" + name + "'");
}

std::vector<PySceneBody> bodies_of(const PyScene& self) {
  const auto lock = self.access.use();
  std::vector<PySceneBody> result;
  for (const scenes::Scene::Body& body : self.scene.bodies())
    result.push_back(
        {body.name, body.moves, body.tears, nb::cast(new PyMesh{body.mesh}, nb::rv_policy::take_ownership)});
  return result;
}

void bind_scene(nb::module_& module) {
  using B = PySceneBody;
  nb::class_<B>(module, "SceneBody", nb::is_weak_referenceable(), "A body of a scene, in one frame.")
      .def_prop_ro(
          "name", [](const B& self) { return nb::str(self.name.c_str()); }, nb::sig("def name(self) -> str"),
          "Of the body.")
      .def_ro("moves", &B::moves, "Whether its vertices move.")
      .def_ro("tears", &B::tears, "Whether its topology changes.")
      .def_prop_ro(
          "mesh", [](const B& self) { return self.mesh; }, nb::sig("def mesh(self) -> Mesh"),
          "Its mesh in the frame.")
      .def("__repr__", [](const B& self) {
        return nb::str("sdm.SceneBody('{}', {!r})").format(self.name.c_str(), self.mesh);
      });
  bind_state<B>(
      2, [](const B& self) { return nb::make_tuple(bytes_of(self), self.mesh); },
      [](B* self, const nb::tuple& from) {
        B body = value_of<B>(from[0]);
        body.mesh = from[1];
        (void)nb::cast<const PyMesh&>(body.mesh);
        new (self) B(std::move(body));
      });
  using S = PyScene;
  nb::class_<S>(module, "Scene", nb::is_weak_referenceable(),
                R"(A simulation of bodies that move and deform, frame by frame. Returned by scene().

Lengths are in metres, z is up. The frames are bit-identical in every run.)")
      .def_prop_ro("bodies", &bodies_of, nb::sig("def bodies(self) -> list[SceneBody]"),
                   "The bodies in the current frame; later frames do not change them.")
      .def_prop_ro(
          "time_step", [](const S& self) { return self.scene.time_step(); }, "Seconds between frames.")
      .def(
          "advance",
          [](S& self) {
            const auto lock = self.access.change();
            run(nb::none(), [&](const Progress&) { self.scene.advance(); });
          },
          "Advances to the next frame. Cost: about 10 ms; 100 ms for the cloth.")
      .def("__repr__",
           [](const S& self) { return nb::str("sdm.Scene({} bodies)").format(self.scene.bodies().size()); });
  bind_no_state<S>("a Scene cannot be pickled or copied; pickle its bodies, or make another one");
  module.def(
      "scene",
      [](const std::string& name, nb::handle mesh) {
        const SceneKind kind = kind_of(name);
        scenes::SceneOptions options;
        if (!mesh.is_none()) options.mesh = path_of(mesh);
        PyScene* result = nullptr;
        run(nb::none(), [&](const Progress&) { result = new PyScene{scenes::Scene(kind, options), {}}; });
        return result;
      },
      nb::rv_policy::take_ownership, nb::arg("name"), nb::kw_only(), nb::arg("mesh") = nb::none(),
      nb::sig("def scene(name: str, *, mesh: str | os.PathLike[str] | None = None) -> Scene"),
      R"(Makes a deforming scene like those of the paper.

name: 'letters': soft letters E and G that collide; 'bunnies': two soft bunnies that do the same; 'figure': a
human figure that walks in a box; 'crowd': 100 agents that cross a ground and each other; 'cloth': a cloth that
falls over a ball; 'tear': a cloth that a falling ball tears through.
mesh: for bunnies, the file of the mesh to use; None: the bunny of Debian's glmark2-data. Raises Error for
another name, or a mesh that cannot be read.

>>> letters = sdm.scene('letters')
>>> [body.name for body in letters.bodies]
['E', 'G']
>>> before = letters.bodies[0].mesh.vertices
>>> letters.advance()
>>> bool((letters.bodies[0].mesh.vertices != before).any())
True)");
}

}  // namespace

void bind_scenes(nb::module_& module) {
  bind_scene(module);
  using M = MadeScan;
  nb::class_<M>(module, "MadeScan", nb::is_weak_referenceable(),
                "A made scan of a part, with what inspection has to find.")
      .def_prop_ro(
          "mesh", [](const M& self) { return new PyMesh{self.mesh}; }, nb::rv_policy::take_ownership,
          nb::sig("def mesh(self) -> Mesh"), "The scan: an open mesh.")
      .def_prop_ro(
          "transform", [](const M& self) { return matrix(self.placement); },
          nb::sig("def transform(self) -> numpy.typing.NDArray[numpy.float64]"),
          "From the part to the scan, (4, 4) float64.")
      .def_ro("size", &M::size, "The diagonal of the part's bounding box.")
      .def_prop_ro(
          "dent_place", [](const M& self) { return vector_of(self.dent_place); },
          nb::sig("def dent_place(self) -> numpy.typing.NDArray[numpy.float64]"),
          "The middle of the dent, on the surface of the part, (3,) float64.")
      .def_ro("dent_depth", &M::dent_depth, "The depth of the dent.")
      .def_ro("dent_radius", &M::dent_radius, "Its radius.")
      .def_ro("noise", &M::noise, "The standard deviation of the vertices along their normals.")
      .def_ro("missing", &M::missing, "The fraction of the area that is missing.")
      .def("__repr__", [](const M& self) {
        return nb::str("sdm.MadeScan({} faces, dent {:.6g} deep)")
            .format(self.mesh.triangles.size(), self.dent_depth);
      });
  bind_value<M>([](const M& scan) { validate(scan.mesh); });
  module.def(
      "make_scan",
      [](nb::handle part, std::size_t triangles, double noise, double dent, double tilt, double shift,
         double missing) {
        Mesh mesh = mesh_of(part, nb::none());
        M result;
        run(nb::none(), [&](const Progress&) {
          validate(mesh);
          result = scenes::make_scan(mesh, {.triangles = triangles,
                                            .noise = noise,
                                            .dent = dent,
                                            .tilt = tilt,
                                            .shift = shift,
                                            .missing = missing});
        });
        return result;
      },
      nb::arg("part").none(), nb::kw_only(), nb::arg("triangles") = 80000, nb::arg("noise") = 0.0005,
      nb::arg("dent") = 0.01, nb::arg("tilt") = 2.0, nb::arg("shift") = 0.02, nb::arg("missing") = 0.3,
      nb::sig("def make_scan(part: object, *, triangles: int = 80000, noise: float = 0.0005, dent: float = "
              "0.01, tilt: float = 2.0, shift: float = 0.02, missing: float = 0.3) -> MadeScan"),
      R"(Makes a scan of a part: refined, dented where it is flat, noisy, with one end cut away, tilted and
shifted. For examples and tests; the same in every run.

part: any form of a mesh (see Mesh). triangles: about how many, before some are cut away.
noise, dent (its depth), shift: as fractions of the diagonal of the part's box. tilt: in degrees.
missing: the fraction of the area that is cut away. Raises Error for an unusable mesh, or one without a flat
place for the dent.

>>> scan = sdm.make_scan(box, triangles=2000)
>>> round(scan.dent_depth, 4), len(scan.mesh.faces) < 2500
(0.0173, True))");
}

}  // namespace sdm::python
