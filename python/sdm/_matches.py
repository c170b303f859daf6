import enum
import functools
from typing import Literal

import numpy as np
import numpy.typing as npt

from . import _core
from ._attributes import Normals, corner_normals
from ._closest_points import NONE
from ._core import Error, Sites, Surface, TexelMatches
from ._options import takes_options
from ._texels import Progress, Texels, read_only
from ._types import Engine


class MatchKind(enum.IntEnum):
    """How the point of O2 that belongs to a texel was found, or why there is none."""

    NONE = 0
    """No face of O1 owns the texel."""
    CLOSEST = 1
    """It is the closest point."""
    FACING = 2
    """It is the closest point of the faces that face as the sample does."""
    RAY = 3
    """It is the nearest hit along the normal of O1, of these faces."""
    TOO_FAR = 4
    """Unmatched: nothing is within the largest distance."""
    FACING_AWAY = 5
    """Unmatched: no face of O2 faces as the sample does."""


class Matches(Texels):
    """For every texel of a surface (O1), the point of O2 that belongs there. Returned by match().

    Its arrays have a row for each row of texels, row 0 at the top, and are read-only. The methods return what O2 has at the
    points, as textures of O1: a new array of float32, in the units of the meshes. Texels of a face without a point hold NaN;
    those of no face get values too with ``fill``, as of transfer(). They raise Error if the surface or the sites
    have been refitted or edited since, and Cancelled. Cost: linear in texels, all cores, unless stated otherwise.

    >>> matches = sdm.match(sphere, box, resolution=64)
    >>> bool(np.all(matches.matched == (matches.face != sdm.NONE)))
    True
    """

    _core: TexelMatches

    def __init__(self, core: TexelMatches) -> None:
        self._core = core

    def __repr__(self) -> str:
        return f"sdm.Matches({self.kind.shape[1]} × {self.kind.shape[0]} texels, {int(self.matched.sum())} matched)"

    @property
    def kind(self) -> "npt.NDArray[np.uint8]":
        """The MatchKind of each texel, (H, W) uint8."""
        return self._core.kind

    @property
    def face(self) -> "npt.NDArray[np.uint32]":
        """The face of O2 that the point is on, or NONE, (H, W) uint32."""
        return self._core.face

    @functools.cached_property
    def matched(self) -> "npt.NDArray[np.bool_]":
        """Whether a texel has a point, (H, W) bool."""
        return read_only(self.face != NONE)

    @functools.cached_property
    def barycentric(self) -> "npt.NDArray[np.float64]":
        """The weights of the corners of ``face``, (H, W, 3) float64, of single precision; NaN without a point."""
        uv = self._core.uv.astype(np.float64)
        weights = np.concatenate([np.maximum(0, 1 - uv.sum(axis=2, keepdims=True)), uv], axis=2)
        weights[~self.matched] = np.nan
        return read_only(weights)

    def normals(
        self, of: Normals = "smooth", *, fill: bool = True, progress: "Progress | None" = None
    ) -> "npt.NDArray[np.float32]":
        """Returns the normals of O2 at the points, of length 1, in the coordinates of the meshes, (H, W, 3).

        of: what O2's normals are: 'smooth', 'flat' (those of faces), the angle of creases of smooth_normals(), or an array,
        (n, 3) for its vertices or (m, 3, 3) for the corners of its faces, as of read_attributes(). Where a closed O2 is
        wound inwards, they are turned outwards. Raises Error for normals that do not fit O2.

        >>> matches = sdm.match(sphere, box, resolution=64)
        >>> bool(np.allclose(np.abs(matches.normals("flat")[matches.matched]).max(axis=1), 1))
        True
        """
        wanted = self._normals(of, "of", self.sites)
        return self._core.normals(wanted, fill, progress)

    def tangent_normals(
        self, of: Normals = "smooth", normals: Normals = "smooth", *, fill: bool = True, progress: "Progress | None" = None
    ) -> "npt.NDArray[np.float32]":
        """Returns the normals of O2 at the points in the tangent space of O1: x, y, z of length 1, (H, W, 3).

        of: as of normals(). normals: those of O1 that the model is drawn with, in the same forms. Its tangents are
        tangents(surface, normals). A normal map stores (x + 1) / 2 and so on. Also raises Error unless has_tangents().
        Cost: also that of tangents().
        """
        wanted = self._normals(of, "of", self.sites)
        return self._core.tangent_normals(wanted, self._normals(normals, "normals", self.surface), fill, progress)

    def displacements(
        self, normals: Normals = "smooth", *, fill: bool = True, progress: "Progress | None" = None
    ) -> "npt.NDArray[np.float32]":
        """Returns how far the points are along the normal of O1, (H, W); negative below its surface.

        normals: those of O1, as of tangent_normals(); interpolated and made of length 1. Of matches of kind RAY with the
        same normals, the point is that of the texel plus the displacement along the normal.

        >>> heights = sdm.match(sphere, sphere, method='ray', resolution=64).displacements()
        >>> bool(np.nanmax(np.abs(heights)) < 1e-6)
        True
        """
        return self._core.displacements(self._normals(normals, "normals", self.surface), fill, progress)

    def positions(self, *, fill: bool = True, progress: "Progress | None" = None) -> "npt.NDArray[np.float32]":
        """Returns the points, (H, W, 3)."""
        return self._core.positions(fill, progress)

    @takes_options("ambient_occlusion")
    def ambient_occlusion(
        self, rays: int = 64, *, fill: bool = True, progress: "Progress | None" = None, **options: object
    ) -> "npt.NDArray[np.float32]":
        """Returns how much of the hemisphere above each point is free of O2, (H, W): an estimate.

        rays: for each texel, 1 to 65536. Rays start 1e-6 of the diagonal of O2 above its face.
        {options}
        Raises Error for numbers out of range. Cost: ``rays`` rays a texel.
        """
        given = {"rays": rays, **options}
        _core.check_keywords("ambient_occlusion", given)
        return self._core.ambient_occlusion(given, fill, progress)

    @takes_options("TexelMatches.thickness")
    def thickness(
        self,
        method: Literal["ball", "ray"] = "ball",
        *,
        fill: bool = True,
        progress: "Progress | None" = None,
        **options: object,
    ) -> "npt.NDArray[np.float32]":
        """Returns the wall thickness of O2 at each point, (H, W); NaN where nothing ends it. 

        method: as of thickness().
        {options}

        Raises Error unless O2 is closed and orientable. Cost: a ray a texel; of balls, also a search.
        """
        given = {"method": method, **options}
        _core.check_keywords("TexelMatches.thickness", given)
        return self._core.thickness(given, fill, progress)

    @staticmethod
    def _normals(normals: Normals, name: str, of: "Surface | Sites") -> object:
        return corner_normals(normals, len(of.vertices), of.faces, name)


@takes_options("match")
def match(
    a: object,
    b: object,
    *,
    normals: Normals = "smooth",
    engine: Engine = "cpu",
    progress: "Progress | None" = None,
    **options: object,
) -> Matches:
    """Finds, for each texel of the surface of ``a`` (O1), the point of ``b`` (O2) that belongs there, also on thin walls.

    a, b: meshes in any form (see Mesh). A Surface for ``a`` and a Sites for ``b`` are used as they are.
    {options}
    normals: of method 'ray', those of ``a``: 'smooth', 'flat', the angle of creases of smooth_normals(), or an array, (n, 3)
    for vertices or (m, 3, 3) for corners of faces, as of read_attributes(). Rays along 'smooth' ones leave no gaps.
    engine: as of map().
    progress: called as progress(step, fraction), on this thread; False cancels.

    Closest points have the precision of map(). Of method 'closest', they may lie on the other skin of a thin wall. A ray goes
    to either side; where it hits no allowed face, the match is as of 'facing'. Normals of closed meshes are outward. Which
    rays meet which faces is exact: faces that face another way are passed, and no other hit is lost beside them. Raises Error
    for meshes, options and normals that cannot be used; Cancelled. Cost: that of map(); of 'ray', two rays for each texel.

    >>> matches = sdm.match(sphere, box, method='ray', cage=2, resolution=64)
    >>> bool((matches.kind == sdm.MatchKind.RAY).any())
    True
    """
    _core.check_keywords("match", options)
    surface, sites = _core.prepare(a, b, options, progress=progress)
    of_corners = corner_normals(normals, len(surface.vertices), surface.faces, "normals")
    return Matches(_core.match_texels(surface, sites, options, normals=of_corners, engine=engine, progress=progress))


def tangents(surface: Surface, normals: Normals = "smooth") -> "npt.NDArray[np.float32]":
    """Returns the tangents of a surface in its atlas, by MikkTSpace, as the TANGENT of glTF: (faces, 3, 4) float32.

    normals: at the corners of its faces, those that the model is drawn with: 'smooth', 'flat', the angle of creases of
    smooth_normals(), or an array, (n, 3) for vertices or (m, 3, 3) for corners. The tangent has length 1, towards the right
    of the texture; the bitangent, towards its upper side, is w · cross(normal, tangent). NaN for removed faces. Raises Error
    for normals that do not fit, and unless has_tangents(). Cost: O(n log n), one core.

    >>> if sdm.has_tangents(): assert sdm.tangents(sdm.Surface(sphere, resolution=64)).shape == (len(sphere.faces), 3, 4)
    """
    return _core.corner_tangents(surface, corner_normals(normals, len(surface.vertices), surface.faces, "normals"))
