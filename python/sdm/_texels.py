"""What a DistanceMap and Matches have in common: a point of O2 for the texels of O1."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, Union

import numpy as np
import numpy.typing as npt

from ._attributes import transferred
from ._core import Map, Sites, Surface, TexelMatches

Progress = Callable[[str, float], Union[bool, None]]


class Texels:
    _core: Map | TexelMatches

    def __reduce__(self) -> tuple[type, tuple[object]]:
        return type(self), (self._core,)

    @property
    def surface(self) -> Surface:
        """The surface of the texels (O1)."""
        return self._core.surface

    @property
    def sites(self) -> Sites:
        """The sites of the other mesh (O2)."""
        return self._core.sites

    def transfer(
        self,
        values: npt.ArrayLike,
        domain: Literal["vertex", "face", "corner"] = "vertex",
        *,
        fill: bool = True,
        progress: Progress | None = None,
    ) -> npt.NDArray[np.float32]:
        """Returns what O2 has at the point of each texel, such as its colours: (H, W, ...) float32. The point is the closest
        one, or the one that matches.

        values: real numbers, a row for each vertex of O2, each face, or each corner of each face, then of shape
        (faces, 3, ...); further axes are components. domain: 'vertex', 'face' or 'corner', what the rows are of. Values of
        vertices and corners are linear within faces. fill: whether the texels of no face get values too: beside charts
        those of the nearest texel, elsewhere smooth ones, so that a texture can be filtered. Texels of a face without a
        point hold NaN. Colours are to be given in linear light.

        On an edge or a vertex, the face is any of those around it, or with ``facing`` one that faces the sample. Raises
        Error if the surface or the sites have been refitted, and for an array of another shape; Cancelled. Cost: linear in
        texels, all cores.

        >>> m = sdm.map(sphere, box, resolution=64)
        >>> heights = m.transfer(sdm.Mesh(box).vertices[:, 2])
        >>> heights.shape, bool(np.all(np.abs(heights) <= 1.0001))
        ((64, 64), True)
        """
        return transferred(self._core.transfer, values, domain, fill, progress)


def read_only(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """The array itself, which can no longer be written to."""
    array.flags.writeable = False
    return array
