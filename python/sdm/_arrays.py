"""Arrays that are not yet of the dtype and order of the library, and the messages for those that cannot be."""

from typing import Any

import numpy as np
import numpy.typing as npt

from ._core import Error


def _shape(shape: tuple[Any, ...]) -> str:
    return "(" + ", ".join(str(n) for n in shape) + ("," if len(shape) == 1 else "") + ")"


def _is_masked(array: Any) -> bool:
    if isinstance(array, np.ma.MaskedArray):
        return bool(np.ma.is_masked(array))
    return isinstance(array, (list, tuple)) and any(map(_is_masked, array))


def numpy_of(array: Any, name: str) -> npt.NDArray[Any]:
    """An array of any kind as NumPy's, without a copy where that is possible."""
    if _is_masked(array):  # NumPy would take the numbers behind the mask
        raise Error(f"{name} has masked values; leave their rows out, or give them values with filled()")
    try:
        if not isinstance(array, np.ndarray) and hasattr(array, "__dlpack__"):
            device = array.__dlpack_device__()[0]
            if device != 1:
                raise Error(f"{name} must be in the memory of the CPU; copy the array to the CPU first")
            try:
                return np.from_dlpack(array)
            except (BufferError, RuntimeError, TypeError):  # such as tensors that require gradients
                return np.asarray(array)
        numbers = np.asarray(array)
        if numbers.ndim == 0 and numbers.dtype.kind not in "biufc":  # None, text, a set, a generator
            raise Error(f"{name} must be an array of numbers, not {type(array).__name__}")
        return numbers
    except Error:
        raise
    except Exception as fault:
        if "inhomogeneous" in str(fault):
            raise Error(f"{name} must be an array of numbers, with as many in each row") from None
        raise Error(f"{name} must be an array of numbers ({fault})") from None


def _numbers(array: Any, name: str, kinds: str, what: str, shape: tuple[Any, ...]) -> npt.NDArray[Any]:
    numbers = numpy_of(array, name)
    fits = numbers.ndim == len(shape) and all(n in (m, None) for m, n in zip(numbers.shape, shape))
    if not fits:
        expected = _shape(tuple("n" if n is None else n for n in shape))
        raise Error(f"{name} must have the shape {expected}, not {_shape(numbers.shape)}")
    if numbers.dtype.kind not in kinds:
        raise Error(f"{name} must be {what}, not {numbers.dtype}")
    return numbers


def _floats(array: Any, name: str, shape: tuple[Any, ...]) -> npt.NDArray[Any]:
    numbers = _numbers(array, name, "fiu", "real numbers", shape)
    with np.errstate(over="ignore"):  # of longer floats: infinity, which the library rejects
        numbers = numbers.astype(np.float64, order="C", copy=False)
    return np.require(numbers, requirements=["C", "ALIGNED"])


def points(array: Any, name: str) -> npt.NDArray[Any]:
    return _floats(array, name, (None, 3))


def stack(array: Any, name: str) -> npt.NDArray[Any]:
    """B arrays of points."""
    return _floats(array, name, (None, None, 3))


def matrix(array: Any, name: str) -> npt.NDArray[Any]:
    return _floats(array, name, (4, 4))


def pose(array: Any, name: str) -> npt.NDArray[Any]:
    """A matrix, or a position and a quaternion."""
    numbers = numpy_of(array, name)
    if numbers.shape not in ((4, 4), (7,)):
        raise Error(f"{name} must have the shape (4, 4) or (7,), not {_shape(numbers.shape)}")
    return _floats(numbers, name, numbers.shape)


def motion(poses: Any, name: str) -> npt.NDArray[Any]:
    """The poses at the start and at the end: two of them, or one for both; None: the identity."""
    if poses is None:
        poses = np.eye(4)
    numbers = numpy_of(poses, name)
    if numbers.shape in ((4, 4), (7,)):
        numbers = np.stack((numbers, numbers))
    if numbers.shape not in ((2, 4, 4), (2, 7)):
        raise Error(f"{name} must have the shape (4, 4) or (7,), or be two of these, not {_shape(np.shape(poses))}")
    return _floats(numbers, name, numbers.shape)


def poses(array: Any, name: str) -> npt.NDArray[Any]:
    """Matrices, or positions and quaternions."""
    numbers = numpy_of(array, name)
    if numbers.shape == (0,):  # a list without poses
        return np.empty((0, 4, 4))
    rows = (None, 7) if numbers.ndim == 2 and numbers.shape[1] == 7 else (None, 4, 4)
    if rows == (None, 4, 4) and (numbers.ndim != 3 or numbers.shape[1:] != (4, 4)):
        raise Error(f"{name} must have the shape (n, 4, 4) or (n, 7), not {_shape(numbers.shape)}")
    return _floats(numbers, name, rows)


def lengths(array: Any, name: str, count: int) -> npt.NDArray[Any]:
    """One number for each of ``count`` items, from as many or from one for all."""
    numbers = numpy_of(array, name)
    if numbers.ndim == 0:
        numbers = np.broadcast_to(numbers, (count,))
    elif numbers.shape != (count,):
        raise Error(f"{name} must be one number or have the shape ({count},), not {_shape(numbers.shape)}")
    return _floats(numbers, name, (None,))


def corner_uvs(array: Any, name: str) -> npt.NDArray[Any]:
    return _floats(array, name, (None, 3, 2))


def indices(array: Any, name: str) -> npt.NDArray[Any]:
    if np.shape(array) == (0,):  # a list without numbers has no integers
        return np.empty(0, np.uint32)
    numbers = _numbers(array, name, "iu", "integers", (None,))
    outside = (numbers < 0) | (numbers > 0xFFFFFFFE)
    if outside.any():
        raise Error(f"{name} has the index {numbers[outside][0]}, which is out of range")
    return np.require(numbers.astype(np.uint32, copy=False), requirements=["C", "ALIGNED"])


def triangles(array: Any, name: str) -> npt.NDArray[Any]:
    numbers = _numbers(array, name, "iu", "integers", (None, 3))
    if numbers.size and numbers.dtype != np.uint32:
        outside = (numbers < 0) | (numbers > 0xFFFFFFFE)
        if outside.any():
            face, corner = np.argwhere(outside)[0]
            raise Error(f"index out of range: face {face} refers to vertex {numbers[face, corner]}")
    return np.require(numbers.astype(np.uint32, order="C", copy=False), requirements=["C", "ALIGNED"])
