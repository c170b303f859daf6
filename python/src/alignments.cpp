// The alignment of two surfaces, or of points to a surface, and the doubts that it leaves.
#include <nanobind/stl/string.h>
#include <sdm/doubts.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "fields.h"
#include "options.h"
#include "signatures.h"
#include "sites_in_use.h"

namespace sdm::python {
namespace {

/// The options of a call. `pose`: or None.
AlignOptions align_options(const std::string& call, const nb::dict& given, nb::handle pose) {
  check_keywords(call, given);
  AlignOptions options;
  set_options(given, options);
  set_options(given, options.freedoms);
  if (!pose.is_none()) options.pose = transform(pose, "pose");
  return options;
}

/// The part of O2 that an alignment is fitted to.
void restrict(AlignOptions& options, nb::handle on_faces, nb::handle on_boxes, std::size_t faces) {
  if (!on_faces.is_none()) {
    options.region.faces.resize(faces);
    for (const std::uint32_t face : indices(on_faces, "on_faces")) {
      if (face >= faces) throw Error("on_faces has a number that is no face of O2");
      options.region.faces[face] = 1;
    }
  }
  if (on_boxes.is_none()) return;
  const Points corners(on_boxes, "on_boxes");
  if (corners.get().size() % 2 != 0) throw Error("on_boxes needs two corners for each box");
  for (std::size_t i = 0; i < corners.get().size(); i += 2)
    options.region.boxes.push_back({corners.get()[i], corners.get()[i + 1]});
}

void bind_freedom(nb::module_& module) {
  using F = DegreeOfFreedom;
  nb::class_<F> freedom(
      module, "DegreeOfFreedom", nb::is_weak_referenceable(),
      R"(A rigid motion of the aligned O1, and how well O2 determines it: a translation and a rotation
about an axis through the centre of O1, with |translation|² + |rotation|² = 1. A rotation of r moves O1 by r
divided by its radius of gyration, in radians.)");
  bind_fields(freedom).def("__repr__", [](const F& self) {
    return nb::str("sdm.DegreeOfFreedom(determined={:.3g}{})")
        .format(self.determined, self.free ? ", free" : "");
  });
}

void bind_alignment(nb::module_& module) {
  using A = Alignment;
  nb::class_<A> alignment(module, "Alignment", nb::is_weak_referenceable(),
                          "A rigid motion that aligns O1 to O2, and how good it is.");
  bind_fields(alignment)
      .def_prop_ro(
          "rms_before", [](const A& self) { return self.before.rms; },
          "The rms distance of samples of O1, as it was given, to O2, in units of the meshes.")
      .def_prop_ro(
          "rms", [](const A& self) { return self.after.rms; },
          "The rms distance of the aligned samples to O2.")
      .def_prop_ro(
          "trimmed_rms", [](const A& self) { return self.after.trimmed_rms; },
          "The same of the samples with the smallest distances, ``fraction_used`` of all.")
      .def("__repr__", [](const A& self) {
        return nb::str("sdm.Alignment(rms {:.6g}, before {:.6g}, {} iterations)")
            .format(self.after.rms, self.before.rms, self.iterations);
      });
}

constexpr const char* kWhere = "pose: object = None, on_faces: object = None, on_boxes: object = None, ";

void bind_align(nb::module_& module) {
  static const std::string documentation =
      R"(Finds the rotation and the translation that move the surface of O1 onto O2.

o1, o2: any form of a mesh (see Mesh); o2 also Sites.
)" + option_documentation("align") +
      R"(
pose: of a rotation and a translation, as of ProximityQuery.set_pose(); None: O1 as it is.
on_faces, on_boxes: the part of O2 that O1 is fitted to: (k,) numbers of faces, and (2 k, 3) corners of boxes, the
lower and the upper one of each; None: all of it. Samples are then those whose closest point is in that part.
progress: called as progress(step, fraction), on this thread; False cancels.

Point-to-plane steps of iterated closest points, in which outliers have no weight. Finds a local optimum: the
start should be within some 20° and 10 % of the size. Raises Error for an unusable mesh and for options out of
range.

>>> moved = sdm.Mesh(box).transformed([[1, 0, 0, 0.03], [0, 1, 0, 0.02], [0, 0, 1, -0.01], [0, 0, 0, 1]])
>>> alignment = sdm.align(moved, box)
>>> bool(np.abs(alignment.transform[:3, 3] + [0.03, 0.02, -0.01]).max() < 1e-9)
True)";
  static const std::string align_signature = std::string("def align(o1: object, o2: object, *, ") +
                                             option_signature("align") + kWhere + kProgress + "Alignment";
  module.def(
      "align",
      [](nb::handle o1, nb::handle o2, nb::handle pose, nb::handle on_faces, nb::handle on_boxes,
         nb::handle progress, const nb::kwargs& given) {
        AlignOptions options = align_options("align", given, pose);
        const Mesh mesh = mesh_of(o1, nb::none());
        SitesInUse to(o2);
        restrict(options, on_faces, on_boxes, to.get().mesh().triangles.size());
        Alignment result;
        run(progress, [&](const Progress& report) {
          options.progress = report;
          result = align(mesh, to.get(), options);
        });
        return result;
      },
      nb::arg("o1").none(), nb::arg("o2").none(), nb::kw_only(), nb::arg("pose") = nb::none(),
      nb::arg("on_faces") = nb::none(), nb::arg("on_boxes") = nb::none(), nb::arg("progress") = nb::none(),
      nb::arg("options"), nb::sig(align_signature.c_str()), documentation.c_str());
}

void bind_align_points(nb::module_& module) {
  static const std::string align_points_signature =
      std::string("def align_points(points: object, o2: object, *, normals: object = None, ") +
      option_signature("align_points") + kWhere + kProgress + "Alignment";
  module.def(
      "align_points",
      [](nb::handle points, nb::handle o2, nb::handle normals, nb::handle pose, nb::handle on_faces,
         nb::handle on_boxes, nb::handle progress, const nb::kwargs& given) {
        AlignOptions options = align_options("align_points", given, pose);
        const Points p(points, "points");
        std::optional<Points> n;
        if (!normals.is_none()) n.emplace(normals, "normals");
        SitesInUse to(o2);
        restrict(options, on_faces, on_boxes, to.get().mesh().triangles.size());
        Alignment result;
        run(progress, [&](const Progress& report) {
          options.progress = report;
          result = align(p.get(), n ? n->get() : std::span<const Vec3>(), to.get(), options);
        });
        return result;
      },
      nb::arg("points").none(), nb::arg("o2").none(), nb::kw_only(), nb::arg("normals") = nb::none(),
      nb::arg("pose") = nb::none(), nb::arg("on_faces") = nb::none(), nb::arg("on_boxes") = nb::none(),
      nb::arg("progress") = nb::none(), nb::arg("options"), nb::sig(align_points_signature.c_str()),
      R"(Finds the rotation and the translation that move points onto O2; see align().

points: (n, 3) numbers, of which a pseudorandom subset is used if there are more than ``samples``.
normals: (n, 3) numbers of any length, or None: points whose normal differs from that of O2 by more than 60°
have no weight.

>>> points = sphere.vertices + [0.01, 0, 0]
>>> sdm.align_points(points, sphere).rms < 1e-6
True)");
}

void bind_align_321(nb::module_& module) {
  module.def(
      "align_321",
      [](nb::handle points, nb::handle places) {
        const Points from(points, "points"), to(places, "places");
        return matrix(align_321(from.get(), to.get()));
      },
      nb::arg("points").none(), nb::arg("places").none(),
      nb::sig("def align_321(points: object, places: object) -> numpy.typing.NDArray[numpy.float64]"),
      R"(Returns the motion of a 3-2-1 alignment, (4, 4) float64, for column vectors.

points, places: (6, 3) numbers, points of O1 and their places on O2.

The plane of the first three points, the primary ones, moves onto that of their places; the line of the next two
onto that of theirs, both as seen along the normal of the plane; and the last one comes as far along this line as
its place is. Raises Error for primary points on a line, and for secondary ones on a normal of the plane.

>>> places = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]])
>>> bool(np.abs(sdm.align_321(places + [1, 2, 3], places)[:3, 3] + [1, 2, 3]).max() < 1e-12)
True)");
}

void bind_doubts(nb::module_& module) {
  nb::class_<Doubt> type(module, "Doubt", nb::is_weak_referenceable(),
                         "Why it should not be trusted that all distances are within a tolerance.");
  bind_fields(type).def("__repr__", [](const Doubt& self) {
    return nb::str("sdm.Doubt({}: {})").format(name_of(self.reason), self.text);
  });
  static const std::string signature =
      "def alignment_doubts(o1: object, o2: object, alignment: Alignment, *, " + option_signature("align") +
      "pose: object = None) -> list[Doubt]";
  module.def(
      "alignment_doubts",
      [](nb::handle o1, nb::handle o2, const Alignment& alignment, nb::handle pose, const nb::kwargs& given) {
        const AlignOptions options = align_options("align", given, pose);
        const Mesh mesh = mesh_of(o1, nb::none());
        SitesInUse to(o2);
        std::vector<Doubt> doubts;
        run(nb::none(), [&](const Progress&) {
          doubts = doubts_of(alignment, find_other_unit(mesh, to.get(), alignment, options),
                             find_mirrored(mesh, to.get(), alignment));
        });
        nb::list result;
        for (Doubt& doubt : doubts) result.append(nb::cast(std::move(doubt)));
        return result;
      },
      nb::arg("o1").none(), nb::arg("o2").none(), nb::arg("alignment"), nb::kw_only(),
      nb::arg("pose") = nb::none(), nb::arg("options"), nb::sig(signature.c_str()),
      R"(Returns the doubts that an alignment leaves, for which the command withholds a PASS.

o1: as it was given to align(), which returned the alignment with these options.

They are that o1 fits far better 10, 25.4, 304.8 or 1000 times as large, or as small, or mirrored; that less than half of
its samples fit; and that the surfaces do not determine all freedoms. Errors as of align(). Cost: that of up to
8 alignments of 1024 samples.

>>> sdm.alignment_doubts(box, box, sdm.align(box, box))
[])");
}

}  // namespace

void bind_alignments(nb::module_& module) {
  bind_freedom(module);
  bind_alignment(module);
  bind_align(module);
  bind_align_points(module);
  bind_align_321(module);
  bind_doubts(module);
}

}  // namespace sdm::python
