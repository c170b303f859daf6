"""Closest points of many meshes in one call."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _arrays, _core
from ._core import Error
from ._types import Sign


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class BatchItem:
    """The closest points of one mesh of a batch: views of the arrays of the batch, with those of ClosestPoints."""

    distance: npt.NDArray[np.float64]
    """float64, in units of the mesh; negative inside if signed. Infinite where nothing is within max_distance."""
    point: npt.NDArray[np.float64]
    """(..., 3) float64; NaN where there is none."""
    face: npt.NDArray[np.uint32]
    """uint32: a face of the item's mesh that contains the closest point; NONE where there is none."""
    barycentric: npt.NDArray[np.float64]
    """(..., 3) float64: of the closest point in its face; NaN where there is none."""
    site: npt.NDArray[np.uint32]
    """uint32: the closest vertex, edge or face of the item's mesh, by site_type."""
    site_type: npt.NDArray[np.uint8]
    """uint8: a SiteType."""
    corners: npt.NDArray[np.uint32]
    """(..., 3) uint32: the vertices of ``face``; 0 where there is none."""
    gradient: npt.NDArray[np.float64] | None
    """(..., 3) float64, if gradients were requested: the derivative of the distance by the query point."""

    def vertex_gradients(self) -> tuple[npt.NDArray[np.uint32], npt.NDArray[np.float64]]:
        """Returns (vertices, derivatives), (..., 3) uint32 and (..., 3, 3) float64, as ClosestPoints.vertex_gradients().

        Raises Error if gradients were not requested.
        """
        if self.gradient is None:
            raise Error("the derivatives are not there; call closest_points_batch() with gradients=True")
        weights = np.where(np.isnan(self.barycentric), 0.0, self.barycentric)
        return self.corners, -weights[..., :, None] * self.gradient[..., None, :]

    def __len__(self) -> int:
        return len(self.distance)

    def __repr__(self) -> str:
        return f"sdm.BatchItem({len(self)} points)"


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class ClosestPointsBatch(BatchItem):
    """What closest_points_batch() returns: the closest points of B items.

    Its arrays are (B, n, ...) if all items have n points that were given as one array, and otherwise packed, with the rows
    of item i from offsets[i] to offsets[i + 1]. batch[i] has the arrays of one item. Objects can be pickled and copied.
    """

    offsets: npt.NDArray[np.int64]
    """(B + 1,) int64: the first row of each item in packed arrays, and the number of all."""

    def _arrays_of(self, i: int) -> dict[str, Any]:
        stacked = self.distance.ndim == 2
        rows = i if stacked else slice(self.offsets[i], self.offsets[i + 1])
        arrays = {field.name: getattr(self, field.name) for field in dataclasses.fields(BatchItem)}
        return {name: None if array is None else array[rows] for name, array in arrays.items()}

    def __getitem__(self, i: int) -> BatchItem:
        i = range(len(self))[i]
        return BatchItem(**self._arrays_of(i))

    def __iter__(self) -> Iterator[BatchItem]:
        return (self[i] for i in range(len(self)))

    def __len__(self) -> int:
        return len(self.offsets) - 1

    def __repr__(self) -> str:
        return f"sdm.ClosestPointsBatch({len(self)} items, {self.offsets[-1]} points)"


def _items(arrays: object, name: str) -> tuple[list[Any], int | None]:
    """The arrays of all items, and the rows of each if they are parts of one array."""
    if isinstance(arrays, (list, tuple)):
        return [np.empty((0, 3)) if isinstance(a, (list, tuple)) and len(a) == 0 else a for a in arrays], None
    array = _arrays.numpy_of(arrays, name)
    if array.ndim != 3:
        raise Error(f"{name} must be a list of arrays or an array with 3 dimensions, not {array.ndim}")
    stack = _arrays.stack(array, name)
    return list(stack), stack.shape[1]


def _dimensions(array: object) -> int:
    """Those of an array, or of lists in lists, whose lengths may differ; by the first that is not empty."""
    if isinstance(array, (list, tuple)):
        return 1 + next((_dimensions(a) for a in array if not isinstance(a, (list, tuple)) or a), 0)
    return int(getattr(array, "ndim", 0))


def closest_points_batch(
    vertices: object,
    faces: object,
    points: object = None,
    *,
    max_distance: float = float("inf"),
    sign: Sign = "none",
    gradients: bool = False,
    progress: Callable[[str, float], bool | None] | None = None,
) -> ClosestPointsBatch:
    """Returns the closest points of many meshes to points of their own, on all cores, in one call.

    Called as ``closest_points_batch(meshes, points)``, where meshes is a list of any forms of a mesh (see Mesh) or of Sites,
    which are used as they are; or as ``closest_points_batch(vertices, faces, points)``, where vertices is an array
    (B, v, 3) or a list of B arrays, and faces are the (f, 3) of all items, or a list of B arrays.
    points: an array (B, n, 3); a list of B arrays of any lengths; or (n, 3), the same for all. max_distance, sign,
    gradients: as of Sites.closest_points(). progress: called as progress(step, fraction), on this thread; False cancels.

    Meshes that share faces are refitted and not built, for each thread once: the result of item i is that of
    ``sites = Sites(vertices[0], faces); sites.refit(vertices[i])``, bit for bit, and otherwise that of
    ``closest_points(meshes[i], points[i])``, on any number of cores. At most one Sites for each thread is in memory.
    Raises Error, naming the item, as closest_points() does; Cancelled.

    >>> batch = sdm.closest_points_batch([box, sphere], [[[2, 0.5, 0.5]], [[0, 0, 3], [0, 0, 2]]])
    >>> batch.distance, batch.offsets
    (array([1., 2., 1.]), array([0, 1, 3]))
    >>> batch[1].distance
    array([2., 1.])
    """
    if points is None:
        if not isinstance(vertices, (list, tuple)):
            raise Error("meshes must be a list of meshes; an array of vertices needs faces")
        meshes, shared, points = list(vertices), None, faces
    else:
        meshes, _ = _items(vertices, "vertices")
        shared = faces
        if _dimensions(faces) == 3 or isinstance(faces, (list, tuple)) and not meshes:
            per_item, shared = list(faces), None  # type: ignore[call-overload]
            if len(per_item) != len(meshes):
                raise Error(f"there are faces of {len(per_item)} items, but vertices of {len(meshes)}")
            meshes = list(zip(meshes, per_item))
    rows: int | None
    if _dimensions(points) == 2:
        given = _arrays.points(points, "points")
        items, rows = [given] * len(meshes), len(given)
    else:
        items, rows = _items(points, "points")
    if len(items) != len(meshes):
        raise Error(f"there are points of {len(items)} items, but {len(meshes)} meshes")
    found = _core.closest_points_batch(
        meshes, shared, items, max_distance=max_distance, sign=sign, gradients=gradients, progress=progress
    )
    counts = [len(item) for item in items]
    offsets = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
    if rows is not None:
        shape = (len(meshes), rows)
        found = tuple(None if a is None else a.reshape(shape + a.shape[1:]) for a in found)
    names = (field.name for field in dataclasses.fields(BatchItem))
    return ClosestPointsBatch(**dict(zip(names, found)), offsets=offsets)
