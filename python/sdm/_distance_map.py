import functools
import json
import os
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._closest_points import NONE
from ._core import (
    BoundedLength,
    DistanceStatistics,
    Error,
    FaceNames,
    GroupVerdicts,
    Map,
    MapChannels,
    Places,
    ToleranceVerdict,
)
from ._options import takes_options
from ._texels import Progress, Texels, read_only


@dataclass(frozen=True)
class MapBounds:
    """Bounds on the distances of all points of a surface, from those at its texels."""

    lower: float
    """No point of the surface has a distance below this."""
    upper: float
    """No point of the surface has a distance above this; infinite if texels are beyond the maximum distance."""
    covering_radius: float
    """No point of the surface is farther from the nearest texel's centre; distances differ by no more from it."""
    accuracy: float
    """Upper bound on the error of the distance at a texel, of the engine and of rounding to float32."""


class DistanceMap(MapChannels, Texels):
    """The distance from every texel of a surface (O1) to sites (O2). Returned by map(), self_map() and thickness().

    Its arrays are the channels of the map, with a row for each row of texels, row 0 at the top, and read-only. Texels without
    a value, because no face owns them or nothing is within the maximum distance, hold NaN or NONE. Lengths are in the units
    of the meshes. What ``site_type`` holds is a SiteType.

    Notebooks show the surface in 3D, its picture and its numbers.
    """

    _core: Map

    def __init__(self, core: Map) -> None:
        super().__init__(core)
        self._core = core

    @functools.cached_property
    def valid(self) -> "npt.NDArray[np.bool_]":
        """Whether a texel has a value, (H, W) bool."""
        return read_only(self.site != NONE)

    @functools.cached_property
    def closest_barycentric(self) -> "npt.NDArray[np.float64]":
        """Where the closest point is on ``closest_face``: the weights of its corners, (H, W, 3) float64, of the precision of
        ``closest_uv``; NaN without a value."""
        uv = self.closest_uv.astype(np.float64)
        return read_only(np.concatenate([1 - uv.sum(axis=2, keepdims=True), uv], axis=2))

    @property
    def sign(self) -> str:
        """How inside and outside are distinguished: 'none' (unsigned distances), 'exact', 'winding' or 'side'."""
        return self._core.sign

    @property
    def sign_reason(self) -> str:
        """Why, in words."""
        return self._core.sign_reason

    @property
    def measured(self) -> str:
        """What the distances are to, in words, such as
        'distance to the closest of the faces that face the same way, within 90°'."""
        return self._core.measured

    @functools.cached_property
    def bounds(self) -> MapBounds:
        """Bounds on the distances of all points of the surface, not only of its texels.

        Cost: linear in texels, all cores. Raises Error if the surface or the sites have been refitted, and for a map of a
        surface to itself or to faces that face it.

        >>> bounds = sdm.map(sphere, box, resolution=256).bounds
        >>> bounds.lower < bounds.upper
        True
        """
        return MapBounds(*self._core.bounds())

    @property
    def without_match(self) -> int:
        """How many texels have no value, as no face of the other mesh on their line faces the same way."""
        return self._core.without_match

    def statistics(self) -> DistanceStatistics:
        """Returns statistics of the texels, weighted by their area on the surface.

        Cost: linear in texels, all cores. Raises Error if the surface has been refitted.
        """
        return self._core.statistics()

    def hausdorff(self, precision: "float | None" = None, *, progress: "Progress | None" = None) -> BoundedLength:
        """Returns the largest absolute distance of all points of the surface, with bounds: the one-sided Hausdorff distance.

        precision: None: bounds from the texels, which are about a texel's size apart; otherwise by branch and bound on the
        triangles, so that they are at most this far apart, in units of the meshes.
        The witness is a point of the surface and its closest point. Raises Error as ``bounds`` does, and for a precision
        that is not positive; Cancelled.

        >>> distance = sdm.map(sphere, box, resolution=64).hausdorff()
        >>> distance.lower <= sdm.hausdorff(sphere, box, one_sided=True).value <= distance.upper
        True
        """
        return self._core.hausdorff(precision, progress)

    def check(
        self,
        tolerance: "float | tuple[float, float]",
        *,
        uncertainty: float = 0,
        fail_area: "float | None" = None,
        fail_share: "float | None" = None,
        progress: "Progress | None" = None,
    ) -> ToleranceVerdict:
        """Returns whether the distances of all points of the surface are within a tolerance.

        tolerance: ±tolerance, in units of the meshes, or the least and the most distance. uncertainty: the expanded
        uncertainty (k = 2) of the measurement, which the verdict keeps away from the limits as by ISO 14253-1.
        fail_area: only a connected place of at least this area, in squared units, makes a 'fail', where otherwise one point
        does; fail_share: the same, as a share of the area of the surface. Raises Error as ``bounds`` does,
        for a tolerance that differs by the sign if the map is unsigned, and for both of fail_area and fail_share; Cancelled. Cost: one search per vertex.

        >>> sdm.map(sphere, box, resolution=64).check(2).verdict
        'pass'
        """
        return self._core.check(tolerance, uncertainty, fail_area, fail_share, progress)

    def check_groups(
        self,
        tolerance_table: "str | os.PathLike[str] | dict[str, float | tuple[float | None, float | None]]",
        names: "FaceNames | list[FaceNames]",
        *,
        uncertainty: float = 0,
        progress: "Progress | None" = None,
    ) -> GroupVerdicts:
        """Returns whether the distances of all points of named groups of the surface are within tolerances of their own.

        tolerance_table: a dict of tolerances, as of check(), by name, where None in place of one of two numbers is no limit
        on that side; or a file with a row group,lower,upper for each, as of ``sdm map --tolerance-table``. names: of the
        faces of the surface, as of read_face_names(). uncertainty: as of check(). Raises Error as check() does, and for a name that no face has;
        Cancelled. Cost: linear in texels for all groups together, and a proof for each.

        >>> halves = sdm.FaceNames('group', ['all'], np.zeros(len(sphere.faces), np.uint32))
        >>> sdm.map(sphere, box, resolution=64).check_groups({'all': 2}, halves).verdict
        'pass'
        """
        return self._core.check_groups(tolerance_table, names, uncertainty, progress)

    def places(
        self,
        tolerance: "float | tuple[float, float] | None" = None,
        *,
        names: "FaceNames | list[FaceNames] | None" = None,
        tolerance_table: "str | os.PathLike[str] | dict[str, float | tuple[float | None, float | None]] | None" = None,
        progress: "Progress | None" = None,
    ) -> Places:
        """Returns where the map deviates most: connected regions out of the tolerance, and not single points.

        tolerance: as of check(); without one, or where nothing is out of it, regions at or beyond the 99th percentile of the
        absolute distance. names: of the faces of the surface, for the groups of places. tolerance_table: as of
        check_groups(): the faces of its groups are judged by it too. Regions without a value, where a tolerance asks for
        one, have the distance NaN and are listed after the others. Regions below 1e-5 of the area, or four texels, are
        small: they are listed last, and counted. Raises Error as ``statistics`` does; Cancelled. Cost: linear, and one
        search per vertex.

        >>> sdm.map(sphere, box, resolution=64).places().by_tolerance
        False
        """
        return self._core.places(tolerance, names, tolerance_table, progress)

    def free_distances(self) -> "npt.NDArray[np.float64]":
        """Returns, for each texel, a radius within which there is no point of O2, (H, W) float64; 0 without a value.

        The t_min of rays of length 1 that start at the texel: the distance less what the engine may be off. Raises Error as
        ``bounds`` does.
        """
        return self._core.free_distances()

    @takes_options("ambient_occlusion")
    def ambient_occlusion(self, rays: int = 64, *, progress: "Progress | None" = None, **options: object) -> "npt.NDArray[np.float32]":
        """Returns, for each texel, how much of the hemisphere above it is free of O2, (H, W) float32: an estimate.

        1: all of it; NaN where no face owns the texel. Rays start at the texel, to the side of the face's normal, with a
        density proportional to the cosine of the angle to it. O1 does not occlude itself.
        rays: for each texel, 1 to 65536.
        {options}
        Raises Error as ``bounds`` does; Cancelled. Cost: ``rays`` rays per texel, all cores.

        >>> bool(np.nanmin(sdm.map(box, sphere, resolution=64).ambient_occlusion(16)) < 1)
        True
        """
        given = {"rays": rays, **options}
        _core.check_keywords("ambient_occlusion", given)
        return self._core.ambient_occlusion(given, progress)

    @takes_options("report")
    def report(self, *, progress: "Progress | None" = None, **options: object) -> "dict[str, Any]":
        """Returns the numbers of the map with the keys of the command's report.json, for json.dump().

        {options}
        None stands for what has no value, such as the times of what other calls did. Raises Error if the surface or the sites
        have been refitted; Cancelled. Cost: one search per vertex.

        >>> report = sdm.map(sphere, box, resolution=64).report(tolerance=2)
        >>> report["tolerance"]["verdict"], report["atlas"]["resolution"]
        ('PASS', 64)
        """
        _core.check_keywords("report", options)
        report: "dict[str, Any]" = json.loads(self._core.report(self.at_vertices(progress=progress), options))
        return report

    def at_vertices(self, *, progress: "Progress | None" = None) -> "npt.NDArray[np.float32]":
        """Returns the distance at each vertex of the surface, (n,) float32, signed as the map; NaN where nothing is within
        the maximum distance.

        Cost: one search per vertex. Raises Error if the surface or the sites have been refitted; Cancelled.
        """
        return self._core.at_vertices(progress)

    @takes_options("save")
    def save(self, file: "str | os.PathLike[str]", *, progress: "Progress | None" = None, **options: object) -> None:
        """Writes the map, in the format of the file's extension.

        ===================  ======================================================================================
        .exr                 distance, vector, site, site_type and face of all texels, a channel for each component
        .png                 the distances in colours, with a legend
        .glb                 the surface with the distances as a texture, and as ``_DISTANCE`` for each vertex
        .html                a page that shows the surface in 3D, the numbers of report() and a histogram, without a network
        .ply .csv .npy .vtp  the distance of each vertex, in the order of the vertices; in .ply and .vtp with the faces
        ===================  ======================================================================================

        {options}
        A .exr has the units, what the distances are to, and their sign as attributes.
        The complete file appears, or none. Raises Error, naming the file and the fault.
        """
        _core.check_keywords("save", options)
        name = os.fsdecode(file)
        suffix = os.path.splitext(name)[1].lower()
        if suffix not in (".exr", ".png", ".glb", ".html", ".ply", ".csv", ".npy", ".vtp"):
            raise Error(f"{name}: a map is saved as .exr, .png, .glb, .html, .ply, .csv, .npy or .vtp, not as '{suffix}'")
        if suffix == ".html":
            at_vertices = self.at_vertices(progress=progress)
            self._core.write_page(name, at_vertices, self._core.report(at_vertices, options), up=options.get("up") or "y")
            return
        self._core.write(suffix[1:], name, options, progress=progress)

    @takes_options("save")
    def save_view(
        self,
        file: "str | os.PathLike[str]",
        towards: "tuple[float, float, float]" = (0.7, 0.5, 1.0),
        *,
        other: "DistanceMap | None" = None,
        size: int = 1200,
        legend: bool = True,
        **options: object,
    ) -> None:
        """Writes a picture of the surface in the colours of the distances, as PNG.

        towards: from the surface to the viewer: right, up, front. O2 is pale beside it, or coloured as well, at the same
        scale, with other: the map from O2. size: the pixels of the width, 86 to 8192, of which the height is three quarters;
        legend: beside the view.
        {options}
        Raises Error, naming the fault.
        """
        _core.check_keywords("save", options)
        name = os.fsdecode(file)
        if not name.lower().endswith(".png"):
            raise Error(f"{name}: a view is saved as .png")
        if other is not None and not isinstance(other, DistanceMap):
            raise Error("other must be a DistanceMap, from O2")
        self._core.write_view(
            name,
            self.at_vertices(),
            towards,
            None if other is None else other.at_vertices(),
            options,
            size=size,
            legend=legend,
        )

    def plot(self, ax: object = None, *, kind: str = "surface", cmap: "str | None" = None, units: str = "") -> Any:
        """Draws the map with matplotlib, which ``pip install 'surface-distance-maps[viz]'`` installs, and returns the axes.

        ax: axes to draw into, three-dimensional ones for a surface; None: of a new figure. kind: 'surface': O1, each face
        in the colour of the mean distance of its vertices; 'atlas': the texels. cmap: a colour map of matplotlib; by
        default as in save(). units: shown beside the colours.
        """
        from . import _plot

        return _plot.plot(self, ax, kind, cmap, units)

    def _repr_html_(self) -> str:
        from . import _notebook

        return _notebook.html_of(self)

    def __repr__(self) -> str:
        s = self.statistics()
        height, width = self.distance.shape
        return f"sdm.DistanceMap({width} × {height} texels, distance {s.min:.6g} to {s.max:.6g}, mean {s.mean:.6g})"
