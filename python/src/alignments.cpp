// The alignment of two surfaces, or of points to a surface, and the doubts that it leaves.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <sdm/doubts.h>
#include <sdm/fit_check.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "fields.h"
#include "signatures.h"
#include "sites_in_use.h"

namespace sdm::python {
namespace {

AlignFreedoms freedoms_of(const std::string& text) {
  if (const auto freedoms = parse_freedoms(text)) return *freedoms;
  throw Error("'" + text + "' is not a list of x, y, z, rx, ry and rz, such as 'xyz,rz'");
}

AlignOptions align_options(const char* start, nb::handle pose, std::size_t samples, int max_iterations) {
  AlignOptions options{.samples = samples, .max_iterations = max_iterations};
  const std::string_view name = start;
  if (name == "principal_axes")
    options.start = AlignStart::principal_axes;
  else if (name == "pose")
    options.start = AlignStart::pose;
  else if (name != "automatic")
    throw Error("there is no start " + std::string(name) + "; use 'automatic', 'pose' or 'principal_axes'");
  if (!pose.is_none()) options.pose = transform(pose, "pose");
  return options;
}

/// What an alignment may move, and what it is fitted to.
void restrict(AlignOptions& options, nb::handle free, nb::handle about, nb::handle on_faces,
              nb::handle on_boxes, std::size_t faces) {
  if (!free.is_none()) options.freedoms = freedoms_of(nb::cast<std::string>(free));
  if (!about.is_none()) {
    const Points point(nb::module_::import_("numpy").attr("atleast_2d")(about), "about");
    if (point.get().size() != 1) throw Error("about needs three numbers");
    options.freedoms.about = point.get()[0];
  }
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

void bind_align(nb::module_& module) {
  static const std::string align_signature =
      std::string(
          "def align(o1: object, o2: object, *, start: str = 'automatic', pose: object = None, "
          "samples: int = 32768, max_iterations: int = 100, free: str | None = None, about: object = None, "
          "on_faces: object = None, on_boxes: object = None, ") +
      kProgress + "Alignment";
  module.def(
      "align",
      [](nb::handle o1, nb::handle o2, const char* start, nb::handle pose, std::size_t samples,
         int max_iterations, nb::handle free, nb::handle about, nb::handle on_faces, nb::handle on_boxes,
         nb::handle progress) {
        AlignOptions options = align_options(start, pose, samples, max_iterations);
        const Mesh mesh = mesh_of(o1, nb::none());
        SitesInUse to(o2);
        restrict(options, free, about, on_faces, on_boxes, to.get().mesh().triangles.size());
        Alignment result;
        run(progress, [&](const Progress& report) {
          options.progress = report;
          result = align(mesh, to.get(), options);
        });
        return result;
      },
      nb::arg("o1").none(), nb::arg("o2").none(), nb::kw_only(), nb::arg("start") = "automatic",
      nb::arg("pose") = nb::none(), nb::arg("samples") = 32768, nb::arg("max_iterations") = 100,
      nb::arg("free") = nb::none(), nb::arg("about") = nb::none(), nb::arg("on_faces") = nb::none(),
      nb::arg("on_boxes") = nb::none(), nb::arg("progress") = nb::none(), nb::sig(align_signature.c_str()),
      R"(Finds the rotation and the translation that move the surface of O1 onto O2.

o1, o2: any form of a mesh (see Mesh); o2 also Sites.
start: 'pose', at ``pose``; 'principal_axes', where centres and principal axes of both agree, which needs
most of the surface of O1; or 'automatic', at ``pose`` and, if that leads to a poor fit, also at the axes.
pose: of a rotation and a translation, as of ProximityQuery.set_pose(); None: O1 as it is.
samples: of the surface of O1, at least 64. max_iterations: per level of refinement.
free: the motions that may be used, such as 'xyz,rz': translations along x, y and z and a rotation about z, with
the axes of O2's coordinates through ``about``, three numbers (None: the origin); None: all. Others are locked.
on_faces, on_boxes: the part of O2 that O1 is fitted to: (k,) numbers of faces, and (2 k, 3) corners of boxes, the
lower and the upper one of each; None: all of it. Samples are then those whose closest point is in that part.
progress: called as progress(step, fraction), on this thread; False cancels.

Point-to-plane steps of iterated closest points, in which outliers have no weight. Finds a local optimum: the
start should be within some 20° and 10 % of the size. Raises Error for an unusable mesh and for options out of
range.

>>> moved = sdm.Mesh(box).transformed([[1, 0, 0, 0.03], [0, 1, 0, 0.02], [0, 0, 1, -0.01], [0, 0, 0, 1]])
>>> alignment = sdm.align(moved, box)
>>> bool(np.abs(alignment.transform[:3, 3] + [0.03, 0.02, -0.01]).max() < 1e-9)
True)");
}

void bind_align_points(nb::module_& module) {
  static const std::string align_points_signature =
      std::string(
          "def align_points(points: object, o2: object, *, normals: object = None, start: str = "
          "'automatic', pose: object = None, samples: int = 32768, max_iterations: int = 100, free: str | "
          "None = "
          "None, about: object = None, on_faces: object = None, on_boxes: object = None, ") +
      kProgress + "Alignment";
  module.def(
      "align_points",
      [](nb::handle points, nb::handle o2, nb::handle normals, const char* start, nb::handle pose,
         std::size_t samples, int max_iterations, nb::handle free, nb::handle about, nb::handle on_faces,
         nb::handle on_boxes, nb::handle progress) {
        AlignOptions options = align_options(start, pose, samples, max_iterations);
        const Points p(points, "points");
        std::optional<Points> n;
        if (!normals.is_none()) n.emplace(normals, "normals");
        SitesInUse to(o2);
        restrict(options, free, about, on_faces, on_boxes, to.get().mesh().triangles.size());
        Alignment result;
        run(progress, [&](const Progress& report) {
          options.progress = report;
          result = align(p.get(), n ? n->get() : std::span<const Vec3>(), to.get(), options);
        });
        return result;
      },
      nb::arg("points").none(), nb::arg("o2").none(), nb::kw_only(), nb::arg("normals") = nb::none(),
      nb::arg("start") = "automatic", nb::arg("pose") = nb::none(), nb::arg("samples") = 32768,
      nb::arg("max_iterations") = 100, nb::arg("free") = nb::none(), nb::arg("about") = nb::none(),
      nb::arg("on_faces") = nb::none(), nb::arg("on_boxes") = nb::none(), nb::arg("progress") = nb::none(),
      nb::sig(align_points_signature.c_str()),
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
  module.def(
      "alignment_doubts",
      [](nb::handle o1, nb::handle o2, const Alignment& alignment, const char* start, nb::handle pose) {
        const AlignOptions options =
            align_options(start, pose, AlignOptions{}.samples, AlignOptions{}.max_iterations);
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
      nb::arg("start") = "automatic", nb::arg("pose") = nb::none(),
      nb::sig(
          "def alignment_doubts(o1: object, o2: object, alignment: Alignment, *, start: str = 'automatic', "
          "pose: object = None) -> list[Doubt]"),
      R"(Returns the doubts that an alignment leaves, for which the command withholds a PASS.

o1: as it was given to align(), which returned the alignment with these ``start`` and ``pose``.

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
