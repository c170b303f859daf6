from typing import Literal

from . import _core
from ._core import Error, Mesh, Surface
from ._distance_map import DistanceMap
from ._texels import Progress
from ._types import Atlas, Engine, Sign


def map(
    a: object,
    b: object,
    *,
    resolution: "int | tuple[int, int] | None" = None,
    precision: "float | None" = None,
    engine: Engine = "cpu",
    transform: object = None,
    sign: Sign = "automatic",
    along: "str | tuple[float, float, float] | None" = None,
    max_distance: float = float("inf"),
    facing: "float | None" = None,
    atlas: Atlas = "charts",
    max_stretch: float = 1.3,
    gutter: int = 1,
    progress: "Progress | None" = None,
) -> DistanceMap:
    """Computes the distance from every point of the surface of ``a`` (O1) to ``b`` (O2).

    a, b: meshes in any form (see Mesh). A Surface for ``a`` and a Sites for ``b`` are used as they are.
    resolution: texels per side, 1024 by default; with atlas='uv' also two integers, the texels per row and the rows.
    precision: instead, the largest distance from a point of the surface to the nearest texel's centre; not with facing or
    along, whose distances it does not bound. atlas, max_stretch, gutter: as of Surface.
    engine: 'cpu', 'gl' (on OpenGL) or 'reference' (simple and slow).
    transform: a 4 × 4 affine matrix that moves ``a`` first, for column vectors; a reflection also reverses the faces.
    sign: 'automatic': negative inside a closed, orientable ``b``, else unsigned; 'none'; 'exact'; 'winding': by generalised
    winding numbers for an open ``b``, an estimate of insideness; 'side': negative behind an open ``b``, on the side to which
    its normals do not point, an estimate, with no sign (>= 0) at its boundary.
    along: None: to the closest point. 'normal' or a direction: along the normal of each texel's face, or that direction,
    to both sides, to the nearest face of ``b`` that faces the same way; positive on the side to which its normal points.
    Normals of closed meshes are outward. Exact at the texels, and an estimate in between: such a map has no ``bounds`` or
    hausdorff(), check() judges the texels, and ``sign``, ``engine`` and ``facing`` must be the defaults.
    max_distance: > 0; texels farther away have no value.
    facing: an angle in degrees, above 0 and up to 180: distances are to the closest of the faces of ``b`` whose normal is
    within it (for 90: less than that) of the normal of the texel's face, with the sign of the side of that face. Normals of
    closed meshes are outward. Texels without such a face have no value. The map has no ``bounds`` and hausdorff(). check()
    searches the whole surface for symmetric tolerances, and a 'pass' is ``certified``; where other limits depend on the sign
    it is an estimate.
    progress: called as progress(step, fraction), on this thread; False cancels.

    The site is closest to within 1e-6 (cpu) or 2e-6 (gl) of the diagonal of both meshes, or to double rounding
    (reference); the distance is that to this site, stored in float32. Raises Error for meshes and options that cannot be
    used; Cancelled. Cost: the layout of the atlas, and one search per texel, all cores.

    >>> distance_map = sdm.map(sphere, box, resolution=256)
    >>> distance_map.statistics().max <= distance_map.bounds.upper
    True
    """
    if precision is not None and (facing is not None or along is not None):
        raise Error("precision does not apply to facing and along, whose distances nothing bounds between texels; use resolution")
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
    if along is not None:
        if sign != "automatic" or engine != "cpu" or facing is not None:
            raise Error("sign, engine and facing do not apply to a map with along")
        return DistanceMap(
            _core.compute_along(surface, sites, along=along, max_distance=max_distance, progress=progress)
        )
    return DistanceMap(
        _core.compute_map(
            surface, sites, engine=engine, sign=sign, max_distance=max_distance, facing=facing, progress=progress
        )
    )


def self_map(
    mesh: object,
    *,
    rest: object = None,
    rings: int = 1,
    geodesic: "float | None" = None,
    max_distance: float = float("inf"),
    resolution: "int | tuple[int, int] | None" = None,
    precision: "float | None" = None,
    atlas: Atlas = "charts",
    max_stretch: float = 1.3,
    gutter: int = 1,
    progress: "Progress | None" = None,
) -> DistanceMap:
    """Computes the distance from every point of a surface to the rest of it: gaps and folds. Of walls, see thickness().

    mesh: in any form (see Mesh); a Surface is used as it is.
    rest: the same mesh before it was deformed, which decides what is near along the surface; None: ``mesh``.
    rings: a face excludes itself and this many rings of faces around it, connected by shared vertices; ≥ 1.
    geodesic: instead of rings, exclude everything closer than this along the surface, conservatively.
    max_distance: > 0; anything farther is ignored. Lengths are in units of the mesh.
    resolution, precision, atlas, max_stretch, gutter: as of Surface.
    progress: called as progress(step, fraction), on this thread; False cancels.

    Returns a DistanceMap of unsigned distances, exact but for rounding. Texels with nothing in range hold an infinite
    distance and the site NONE. Distances jump between faces, as these exclude different ones: the map has no ``bounds``,
    hausdorff() or check(). Raises Error for a mesh and options that cannot be used; Cancelled. Cost: a search per texel that
    skips what is excluded, all cores.

    >>> plate = sdm.Mesh(box).transformed(np.diag([10, 10, 0.5, 1]))
    >>> thickness = sdm.self_map(plate, resolution=64, max_distance=1)
    >>> float(np.nanmin(thickness.distance))
    0.5
    """
    if not isinstance(mesh, Surface):
        mesh = Mesh(mesh)
    surface, sites = _core.prepare(
        mesh,
        mesh,
        resolution=resolution,
        precision=precision,
        atlas=atlas,
        max_stretch=max_stretch,
        gutter=gutter,
        progress=progress,
    )
    return DistanceMap(
        _core.compute_self_map(
            surface,
            sites,
            mesh if rest is None else rest,
            rings=rings,
            geodesic=geodesic,
            max_distance=max_distance,
            progress=progress,
        )
    )


def thickness(
    mesh: object,
    *,
    method: "Literal['ball', 'ray']" = "ball",
    angle: float = 90.0,
    resolution: "int | tuple[int, int] | None" = None,
    atlas: Atlas = "charts",
    max_stretch: float = 1.3,
    gutter: int = 1,
    progress: "Progress | None" = None,
) -> DistanceMap:
    """Computes the wall thickness of a closed mesh at every texel of its surface.

    mesh: in any form (see Mesh); a Surface is used as it is.
    method: 'ball': the diameter of the largest ball in the part that touches at the texel; 'ray': the length of the ray
    along the inward normal of the texel's face until it leaves the part.
    angle: in degrees, between 0 and 180; the ball is stopped only by faces whose normal turns by more than this from that of
    the texel's face, and where the ray ends. The ray does not depend on it.
    resolution, atlas, max_stretch, gutter: as of Surface.
    progress: called as progress(step, fraction), on this thread; False cancels.

    Returns a DistanceMap: ``distance`` is the thickness, in units of the mesh, exact at the texels; ``vector`` leads to the
    point that stops the ball or the ray, on the face ``site``. Nothing bounds the values in between: the map has no
    ``bounds`` or hausdorff(), and check() judges the texels, so that a 'pass' is not ``certified``. Raises Error for a mesh
    that is open and options that cannot be used; Cancelled. Cost: a ray and a search for each texel, all cores.

    >>> plate = sdm.Mesh(box).transformed(np.diag([10, 10, 0.5, 1]))
    >>> walls = sdm.thickness(plate, resolution=64)
    >>> float(np.nanmin(walls.distance)), walls.check((0.4, 20)).verdict
    (0.5, 'pass')
    """
    if not isinstance(mesh, Surface):
        mesh = Mesh(mesh)
    surface, sites = _core.prepare(
        mesh,
        mesh,
        resolution=resolution,
        atlas=atlas,
        max_stretch=max_stretch,
        gutter=gutter,
        progress=progress,
    )
    return DistanceMap(_core.compute_thickness(surface, sites, method=method, angle=angle, progress=progress))
