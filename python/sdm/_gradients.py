"""The chain rule of distances, on NumPy arrays."""

import numpy as np

from ._core import ClosestPoints


def of_points(closest: ClosestPoints, upstream: np.ndarray) -> np.ndarray:
    """Returns ∂L/∂points, (n, 3), from ∂L/∂distance, (n,)."""
    return upstream[:, None] * closest.gradient


def of_vertices(closest: ClosestPoints, upstream: np.ndarray, count: int) -> np.ndarray:
    """Returns ∂L/∂vertices, (count, 3), from ∂L/∂distance, (n,)."""
    vertices, derivatives = closest.vertex_gradients()
    result = np.empty((count, 3))
    for axis in range(3):
        weights = (upstream[:, None] * derivatives[:, :, axis]).ravel()
        result[:, axis] = np.bincount(vertices.ravel(), weights=weights, minlength=count)
    return result
