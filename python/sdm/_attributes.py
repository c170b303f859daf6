"""Values at the vertices, faces and corners of meshes, as the compiled part takes them."""

from collections.abc import Callable
from typing import Any, Literal, Union

import numpy as np
import numpy.typing as npt

from ._arrays import numpy_of
from ._core import Error

#: Normals of a mesh: smooth ones, those of faces, smooth ones up to an angle, or an array.
Normals = Union[Literal["smooth", "flat"], float, npt.ArrayLike]


def transferred(
    transfer: "Callable[[npt.NDArray[np.float32], str, bool, object], npt.NDArray[np.float32]]",
    values: npt.ArrayLike,
    domain: str,
    fill: bool,
    progress: object,
) -> "npt.NDArray[np.float32]":
    """The result of a compiled transfer(), with the further axes of the values."""
    array = np.asarray(values)
    if np.ma.isMaskedArray(values) or array.dtype.kind not in "biuf":
        raise TypeError(f"values must be an array of real numbers, without a mask, not {array.dtype}")
    axes = 2 if domain == "corner" else 1
    if array.ndim < axes or (domain == "corner" and array.shape[1] != 3):
        raise Error(
            f"values of domain '{domain}' have the shape {'(faces, 3, ...)' if axes == 2 else '(rows, ...)'}, not {array.shape}"
        )
    components = array.shape[axes:]
    rows = np.ascontiguousarray(array, np.float32).reshape(int(np.prod(array.shape[:axes])), -1 if array.size else 0)
    filled = transfer(rows, domain, fill, progress)
    return filled.reshape(*filled.shape[:2], *components)


def corner_normals(normals: Normals, vertices: int, faces: "npt.NDArray[np.uint32]", name: str) -> "float | npt.NDArray[Any]":
    """Normals as the compiled part takes them: the angle of creases, or a vector for each corner."""
    if isinstance(normals, str):
        if normals not in ("smooth", "flat"):
            raise Error(f"{name} must be 'smooth', 'flat', an angle in degrees or an array, not '{normals}'")
        return 180.0 if normals == "smooth" else 0.0
    if isinstance(normals, (int, float, np.integer, np.floating)) and not isinstance(normals, bool):
        return float(normals)
    array = numpy_of(normals, name)
    if array.dtype.kind not in "iuf" or array.shape not in ((vertices, 3), (len(faces), 3, 3)):
        raise Error(
            f"{name} must be real numbers of the shape ({vertices}, 3), for the vertices, or ({len(faces)}, 3, 3), for the "
            f"corners of faces, not {array.dtype} of the shape {array.shape}"
        )
    if array.ndim == 2:
        known = np.asarray((faces < len(array)).all(axis=1))  # removed faces have no vertices
        array = np.where(known[:, None, None], array[np.where(known[:, None], faces, 0)], np.nan)
    return np.ascontiguousarray(array, np.float32)
