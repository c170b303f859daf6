import base64
import functools
import html
import os
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import _core
from ._closest_points import NONE
from ._core import DistanceStatistics, Error, Sites, Surface

Progress = Callable[[str, float], "bool | None"]


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


class DistanceMap:
    """The distance from every texel of a surface (O1) to sites (O2). Returned by map().

    Arrays have a row for each row of texels, row 0 at the top, and are read-only. Texels without a value, because no face
    owns them or nothing is within the maximum distance, hold NaN or NONE. Lengths are in the units of the meshes.
    """

    def __init__(self, core: "_core.Map") -> None:
        self._core = core

    @property
    def surface(self) -> Surface:
        """The surface on which distances are measured."""
        return self._core.surface

    @property
    def sites(self) -> Sites:
        """The sites that they are measured to."""
        return self._core.sites

    @functools.cached_property
    def distance(self) -> np.ndarray:
        """The length of ``vector``, (H, W) float32; negative inside O2 if the map is signed."""
        return self._core.distance

    @functools.cached_property
    def vector(self) -> np.ndarray:
        """From the texel's point to the closest point of O2, (H, W, 3) float32."""
        return self._core.vector

    @functools.cached_property
    def position(self) -> np.ndarray:
        """The surface point of each texel's centre, (H, W, 3) float64; NaN where no face owns the texel."""
        return _frozen(self._core.position())

    @functools.cached_property
    def normal(self) -> np.ndarray:
        """The unit normal of the face that owns each texel, (H, W, 3) float32; NaN where none does."""
        return _frozen(self._core.normal())

    @property
    def face(self) -> np.ndarray:
        """The face of O1 that owns each texel, (H, W) uint32, or NONE."""
        return self.surface.texel_faces

    @functools.cached_property
    def site(self) -> np.ndarray:
        """The closest vertex, edge or face of O2, (H, W) uint32, by ``site_type``; or NONE."""
        return self._core.site

    @functools.cached_property
    def site_type(self) -> np.ndarray:
        """The SiteType of each site, (H, W) uint8."""
        return self._core.site_type

    @functools.cached_property
    def valid(self) -> np.ndarray:
        """Whether a texel has a value, (H, W) bool."""
        return _frozen(self.site != NONE)

    @property
    def sign(self) -> str:
        """How inside and outside are distinguished: 'none' (unsigned distances), 'exact' or 'winding'."""
        return self._core.sign

    @property
    def sign_reason(self) -> str:
        """Why, in words."""
        return self._core.sign_reason

    @functools.cached_property
    def bounds(self) -> MapBounds:
        """Bounds on the distances of all points of the surface, not only of its texels.

        Cost: linear in texels, all cores. Raises Error if the surface or the sites have been refitted.

        >>> bounds = sdm.map(sphere, box, resolution=256).bounds
        >>> bounds.lower < bounds.upper
        True
        """
        return MapBounds(*self._core.bounds())

    def statistics(self) -> DistanceStatistics:
        """Returns statistics of the texels, weighted by their area on the surface.

        Cost: linear in texels, all cores. Raises Error if the surface has been refitted.
        """
        return self._core.statistics()

    def at_vertices(self, *, progress: "Progress | None" = None) -> np.ndarray:
        """Returns the distance at each vertex of the surface, (n,) float32, signed as the map; NaN where nothing is within
        the maximum distance.

        Cost: one search per vertex. Raises Error if the surface or the sites have been refitted; Cancelled.
        """
        return self._core.at_vertices(progress)

    def save(
        self,
        file: "str | os.PathLike",
        *,
        colormap: str = "automatic",
        range: "tuple[float, float] | None" = None,
        tolerance: "float | tuple[float, float] | None" = None,
        units: str = "",
        size: int = 2048,
        progress: "Progress | None" = None,
    ) -> None:
        """Writes the map, in the format of the file's extension.

        ===================  ======================================================================================
        .exr                 all values: distance.D, vector.X/Y/Z, site.id, site.type, face.id, coverage.A
        .png                 the distances in colours, with a legend
        .glb                 the surface with the distances as a texture, and as ``_DISTANCE`` for each vertex
        .ply .csv .npy .vtp  the distance of each vertex, in the order of the vertices; in .ply and .vtp with the faces
        ===================  ======================================================================================

        The options are those of the colours. colormap: 'automatic' (diverging if there are both signs, else viridis),
        'viridis', 'diverging' or 'paper2006'. range: of the colours; by default from the map. tolerance: bands, green
        within ±tolerance, or from the first to the second number. units: shown in the legend ('mm', ...); they scale a
        .glb to metres. size: the most pixels a side. The complete file appears, or none. Raises Error, naming the file and the fault.
        """
        name = os.fspath(file)
        if not isinstance(name, str):
            name = os.fsdecode(name)
        suffix = os.path.splitext(name)[1].lower()
        if suffix not in (".exr", ".png", ".glb", ".ply", ".csv", ".npy", ".vtp"):
            raise Error(f"{name}: a map is saved as .exr, .png, .glb, .ply, .csv, .npy or .vtp, not as '{suffix}'")
        self._core.write(
            suffix[1:],
            name,
            colormap=colormap,
            range=range,
            tolerance=tolerance,
            units=units,
            size=size,
            progress=progress,
        )

    def plot(self, ax: object = None, *, kind: str = "surface", cmap: "str | None" = None, units: str = "") -> Any:
        """Draws the map with matplotlib, which ``pip install sdm[viz]`` installs, and returns the axes.

        ax: axes to draw into, three-dimensional ones for a surface; None: of a new figure. kind: 'surface': O1, each face
        in the colour of the mean distance of its vertices; 'atlas': the texels. cmap: a colour map of matplotlib; by
        default diverging if there are both signs, else viridis. units: shown beside the colours.
        """
        from . import _plot

        return _plot.plot(self, ax, kind, cmap, units)

    def _repr_html_(self) -> str:
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "map.png")
            self.save(file, size=256)
            with open(file, "rb") as picture:
                data = base64.b64encode(picture.read()).decode()
        s = self.statistics()
        rows = {
            "distance": f"{s.min:.6g} to {s.max:.6g}",
            "mean, rms": f"{s.mean:.6g}, {s.rms:.6g}",
            "median, 95 %, 99 %": f"{s.p50:.6g}, {s.p95:.6g}, {s.p99:.6g}",
            "sign": f"{self.sign}: {self.sign_reason}",
            "texels": f"{s.texels} of {self.distance.shape[1]} × {self.distance.shape[0]}",
        }
        cells = "".join(f"<tr><th>{key}</th><td>{html.escape(value)}</td></tr>" for key, value in rows.items())
        return (
            '<div style="display: flex; gap: 1em; align-items: center">'
            f'<img alt="distances" src="data:image/png;base64,{data}"><table>{cells}</table></div>'
        )

    def __repr__(self) -> str:
        s = self.statistics()
        height, width = self.distance.shape
        return f"sdm.DistanceMap({width} × {height} texels, distance {s.min:.6g} to {s.max:.6g}, mean {s.mean:.6g})"


def _frozen(array: np.ndarray) -> np.ndarray:
    array.flags.writeable = False
    return array


def map(
    a: object,
    b: object,
    *,
    resolution: "int | None" = None,
    precision: "float | None" = None,
    engine: str = "cpu",
    transform: object = None,
    sign: str = "automatic",
    max_distance: float = float("inf"),
    atlas: str = "charts",
    max_stretch: float = 1.3,
    gutter: int = 1,
    progress: "Progress | None" = None,
) -> DistanceMap:
    """Computes the distance from every point of the surface of ``a`` (O1) to ``b`` (O2).

    a, b: meshes in any form (see Mesh). A Surface for ``a`` and a Sites for ``b`` are used as they are.
    resolution: texels per side, 1024 by default. precision: instead, the largest distance from a point of the surface to
    the nearest texel's centre. atlas, max_stretch, gutter: as of Surface.
    engine: 'cpu', 'gl' (on OpenGL) or 'reference' (simple and slow).
    transform: a 4 × 4 affine matrix that moves ``a`` first, for column vectors; a reflection also reverses the faces.
    sign: 'automatic': negative inside a closed, orientable ``b``, else unsigned; 'none'; 'exact'; 'winding': by generalised
    winding numbers for an open ``b``, an estimate of insideness.
    max_distance: > 0; texels farther away have no value.
    progress: called as progress(step, fraction), on this thread; False cancels.

    The site is closest to within 1e-6 (cpu) or 2e-6 (gl) of the diagonal of both meshes, or to double rounding
    (reference); the distance is that to this site, stored in float32. Raises Error for meshes and options that cannot be
    used; Cancelled. Cost: the layout of the atlas, and one search per texel, all cores.

    >>> distance_map = sdm.map(sphere, box, resolution=256)
    >>> distance_map.statistics().max <= distance_map.bounds.upper
    True
    """
    surface, sites = _core.prepare(
        a,
        b,
        transform=transform,
        resolution=resolution,
        precision=precision,
        atlas=atlas,
        max_stretch=max_stretch,
        gutter=gutter,
        progress=progress,
    )
    return DistanceMap(
        _core.compute_map(surface, sites, engine=engine, sign=sign, max_distance=max_distance, progress=progress)
    )
