from . import _core
from ._core import Mesh, Surface
from ._distance_map import DistanceMap
from ._options import takes_options
from ._texels import Progress
from ._types import Engine


@takes_options("map")
def map(
    a: object,
    b: object,
    *,
    engine: Engine = "cpu",
    transform: object = None,
    progress: "Progress | None" = None,
    **options: object,
) -> DistanceMap:
    """Computes the distance from every point of the surface of ``a`` (O1) to ``b`` (O2).

    a, b: meshes in any form (see Mesh). A Surface for ``a`` and a Sites for ``b`` are used as they are.
    {options}
    engine: 'cpu', 'gl' (on OpenGL), 'gpu' (compute shaders) or 'reference' (simple and slow).
    transform: a 4 × 4 affine matrix that moves ``a`` first, for column vectors; a reflection also reverses the faces.
    progress: called as progress(step, fraction), on this thread; False cancels.

    The site is closest to within 1e-6 (cpu) or 2e-6 (gl) of the diagonal of both meshes, or to double rounding
    (reference, gpu); the distance is that to this site, stored in float32. Raises Error for meshes and options that cannot be
    used; Cancelled. Cost: the layout of the atlas, and one search per texel, all cores.

    A map with ``facing`` has the sign of the side of the matched face, and no ``bounds`` and hausdorff(). Normals of closed
    meshes are outward. Texels without such a face have no value. check() searches the whole surface for symmetric tolerances,
    and a 'pass' is ``certified``; where other limits depend on the sign it is an estimate. A map with ``along`` is exact at
    the texels, and an estimate in between: it has no ``bounds`` or hausdorff(), and check() judges the texels.

    >>> distance_map = sdm.map(sphere, box, resolution=256)
    >>> distance_map.statistics().max <= distance_map.bounds.upper
    True
    """
    _core.check_keywords("map", {**options, "engine": engine})
    surface, sites = _core.prepare(a, b, options, transform=transform, progress=progress)
    return DistanceMap(_core.compute_map(surface, sites, options, engine=engine, progress=progress))


@takes_options("self_map")
def self_map(
    mesh: object,
    *,
    rest: object = None,
    progress: "Progress | None" = None,
    **options: object,
) -> DistanceMap:
    """Computes the distance from every point of a surface to the rest of it: gaps and folds. Of walls, see thickness().

    mesh: in any form (see Mesh); a Surface is used as it is.
    rest: the same mesh before it was deformed, which decides what is near along the surface; None: ``mesh``.
    {options}
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
    _core.check_keywords("self_map", options)
    part = mesh if isinstance(mesh, Surface) else Mesh(mesh)
    surface, sites = _core.prepare(part, part, options, progress=progress)
    at_rest = part if rest is None else rest
    return DistanceMap(_core.compute_self_map(surface, sites, at_rest, options, progress=progress))


@takes_options("thickness")
def thickness(
    mesh: object,
    *,
    progress: "Progress | None" = None,
    **options: object,
) -> DistanceMap:
    """Computes the wall thickness of a closed mesh at every texel of its surface.

    mesh: in any form (see Mesh); a Surface is used as it is.
    {options}
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
    _core.check_keywords("thickness", options)
    part = mesh if isinstance(mesh, Surface) else Mesh(mesh)
    surface, sites = _core.prepare(part, part, options, progress=progress)
    return DistanceMap(_core.compute_thickness(surface, sites, options, progress=progress))
