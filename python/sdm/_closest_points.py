import enum
from collections.abc import Callable

from ._core import ClosestPoints, Sites
from ._types import Engine, Sign

#: The index that represents "no face" and "no site" in arrays of uint32.
NONE = 0xFFFFFFFF


class SiteType(enum.IntEnum):
    """The kinds of sites: the vertices, edges and faces of a mesh."""

    VERTEX = 0
    EDGE = 1
    FACE = 2
    NONE = 255


def closest_points(
    vertices: object,
    faces: object,
    points: object = None,
    *,
    max_distance: float = float("inf"),
    sign: Sign = "none",
    gradients: bool = False,
    engine: Engine = "cpu",
    progress: "Callable[[str, float], bool | None] | None" = None,
) -> ClosestPoints:
    """Returns the closest point of a mesh to each of n points.

    Called as ``closest_points(vertices, faces, points)``, or as ``closest_points(mesh, points)`` with any form of a mesh
    (see Mesh). To search several times, build a Sites once. The options are those of Sites.closest_points().

    >>> closest = sdm.closest_points([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], [[0.25, 0.25, 2]])
    >>> closest.distance, closest.barycentric
    (array([2.]), array([[0.5 , 0.25, 0.25]]))
    """
    sites = Sites(vertices, faces) if points is not None else Sites(vertices)
    return sites.closest_points(
        faces if points is None else points,
        max_distance=max_distance,
        sign=sign,
        gradients=gradients,
        engine=engine,
        progress=progress,
    )
