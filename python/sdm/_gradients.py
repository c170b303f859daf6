"""The chain rule of distances, on arrays of NumPy or of PyTorch.

``gradient`` (..., 3) has the derivatives of distances by their points, ``weights`` (..., 3) the barycentric coordinates of the
closest points, ``upstream`` (...) the derivatives of a function by the distances.
"""

from typing import Any


def of_points(gradient: Any, upstream: Any) -> Any:
    """Returns the derivatives by the points, (..., 3)."""
    return upstream[..., None] * gradient


def of_corners(gradient: Any, weights: Any, upstream: Any) -> Any:
    """Returns the derivatives by the corners of the closest faces, (..., 3, 3): a closest point moves with its face."""
    return -weights[..., :, None] * of_points(gradient, upstream)[..., None, :]
