"""Measures that compare two surfaces."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from . import _core
from ._arrays import numpy_of
from ._core import Error
from ._options import takes_options
from ._types import Certainty


@dataclasses.dataclass(frozen=True)
class BoundedNumber:
    """A number with its bounds. ``float()`` of it is the value."""

    value: float
    lower: float
    """lower ≤ truth, unless an estimate."""
    upper: float
    """truth ≤ upper, unless an estimate."""
    certainty: Certainty
    """'exact': but for rounding; 'bounded': the true value lies between the bounds; 'estimate'."""
    confidence: float | None
    """Of an estimate with bounds: the probability, at least, with which the true value lies between them."""

    def __float__(self) -> float:
        return self.value

    def __repr__(self) -> str:
        if self.certainty != "bounded" and self.confidence is None:
            return f"sdm.BoundedNumber({self.value:.9g}, {self.certainty})"
        how = "" if self.confidence is None else f", {self.certainty}, {100 * self.confidence:g} %"
        return f"sdm.BoundedNumber({self.value:.9g}{how}, in [{self.lower:.9g}, {self.upper:.9g}])"


class SurfaceMetrics(Mapping[str, BoundedNumber]):
    """What surface_metrics() returns: a mapping from the names of measures to numbers with bounds."""

    def __init__(
        self,
        both: Mapping[str, BoundedNumber],
        a_to_b: dict[str, BoundedNumber],
        b_to_a: dict[str, BoundedNumber],
        areas: tuple[float, float],
        points: tuple[int, int],
    ) -> None:
        self._both = dict(both)
        self.a_to_b: dict[str, BoundedNumber] = a_to_b
        """From a to b: 'hd', 'hdP', 'mean', 'rms' and, for each tolerance, 'within(T)'."""
        self.b_to_a: dict[str, BoundedNumber] = b_to_a
        """The same from b to a."""
        self.areas: tuple[float, float] = areas
        """Those of a and b."""
        self.points: tuple[int, int] = points
        """The random points of a and b that estimates are from; none if not asked for."""

    def __getitem__(self, name: str) -> BoundedNumber:
        return self._both[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._both)

    def __len__(self) -> int:
        return len(self._both)

    def __repr__(self) -> str:
        return f"sdm.SurfaceMetrics({', '.join(f'{name}={n.value:.6g}' for name, n in self.items())})"


def mask_surface(mask: object, spacing: float | Sequence[float] = 1.0) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.uint32]]:
    """Returns the surface of a segmentation, the faces between voxels inside and outside: vertices (n, 3) float64 and
    faces (m, 3) uint32.

    mask: a boolean array of three dimensions, or one of numbers, where all but 0 is inside.
    spacing: of voxels, along each axis of the array or the same along all.

    The centre of voxel [i, j, k] is the point (i, j, k) times the spacing, and the surface is half a voxel away: each
    face is two triangles, with the normal outward, and shares its vertices. Without a voxel inside there are no faces. Raises
    Error for an array of other dimensions, or a spacing that is not positive. Cost: linear in voxels.

    >>> vertices, faces = sdm.mask_surface([[[True]]])
    >>> vertices.shape, faces.shape
    ((8, 3), (12, 3))
    """
    inside = numpy_of(mask, "the mask")
    if inside.ndim != 3 or inside.dtype.kind not in "biuf":
        raise Error("a mask must be an array of numbers or booleans with three dimensions")
    try:
        steps = np.broadcast_to(np.asarray(spacing, dtype=np.float64), (3,))
    except (TypeError, ValueError):
        raise Error("the spacing must be a number, or three") from None
    if not (np.isfinite(steps).all() and (steps > 0).all()):
        raise Error("the spacing must be greater than 0")
    padded = np.pad(inside != 0, 1)
    corners = []  # of quads, counted from the lower corner of the padded array
    for axis in range(3):
        u, v = np.eye(3, dtype=np.int64)[[(axis + 1) % 3, (axis + 2) % 3]]
        change = np.diff(padded.astype(np.int8), axis=axis)
        for sign, first, second in ((-1, u, v), (1, v, u)):  # leaving along the axis, and entering
            at = np.argwhere(change == sign)
            at[:, axis] += 1
            corners.append(np.stack([at, at + first, at + first + second, at + second], axis=1))
    quads = np.concatenate(corners)
    shape = tuple(n + 1 for n in padded.shape)
    places = np.ravel_multi_index(list(quads.reshape(-1, 3).T), shape)
    index, quad = np.unique(places, return_inverse=True)
    lattice = np.stack(np.unravel_index(index, shape), axis=1)
    quad = quad.reshape(-1, 4)
    faces = np.concatenate([quad[:, [0, 1, 2]], quad[:, [0, 2, 3]]])
    return (lattice - 1.5) * steps, faces.astype(np.uint32)


def _or_none_if_empty(mesh: object) -> object:
    """A mesh, or None for vertices and faces of which there are none."""
    return None if isinstance(mesh, tuple) and len(mesh) == 2 and np.size(mesh[1]) == 0 else mesh


@takes_options("surface_metrics")
def surface_metrics(
    a: object,
    b: object,
    *,
    progress: Callable[[str, float], bool | None] | None = None,
    **options: object,
) -> SurfaceMetrics:
    """Compares two surfaces by the measures that papers and benchmarks report, with certified bounds.

    a, b: any form of a mesh (see Mesh), also without faces as a pair of arrays, or Sites. b is the truth for 'precision(T)' and 'recall(T)'.
    {options}
    progress: called as progress(step, fraction), on this thread; False cancels.

    'hd' is the Hausdorff distance, 'hd95' the larger of both 95th percentiles, 'assd' the average symmetric surface
    distance, 'masd' the mean of both average distances, 'rmsd' the root mean square, 'chamfer_l1' and 'chamfer_l2' the
    sums of both means of distances and of their squares; 'normal_consistency' is an estimate. All points of the surfaces
    count by area; none is sampled, unless `estimate` is given, and lower ≤ truth ≤ upper. If both meshes have no faces,
    distances are 0 and fractions 1; if one has none, distances are infinite and fractions 0. Raises Error for an unusable mesh and options out of range.

    >>> metrics = sdm.surface_metrics(box, sphere, tolerances=[0.1])
    >>> metrics["hd95"].lower <= metrics["hd95"].value <= metrics["hd"].upper
    True
    >>> float(sdm.surface_metrics(box, box)["assd"])
    0.0
    """
    _core.check_keywords("surface_metrics", options)
    both, forth, back, areas, points = _core.surface_metrics(_or_none_if_empty(a), _or_none_if_empty(b), options, progress)
    numbers = [{name: BoundedNumber(*n) for name, n in part.items()} for part in (both, forth, back)]
    return SurfaceMetrics(numbers[0], numbers[1], numbers[2], areas, points)
