"""Distances with derivatives in PyTorch, which is not a dependency of the package: import this module to use it.

The derivatives are exact wherever the distance is differentiable, and 0 where it is 0. Second derivatives are not computed.
"""

import torch

from . import _gradients
from ._core import Sites

__all__ = ["PointMeshDistance", "distance"]


class PointMeshDistance(torch.autograd.Function):
    """The function behind distance()."""

    @staticmethod
    def forward(ctx, points, vertices, faces, sign, max_distance):
        sites = Sites(vertices.detach().cpu().numpy(), faces.detach().cpu().numpy())
        closest = sites.closest_points(
            points.detach().cpu().numpy(), sign=sign, max_distance=max_distance, gradients=True
        )
        ctx.closest = closest
        ctx.points, ctx.vertices = points.new_empty(0), vertices.new_empty(0)  # their dtypes and devices
        ctx.vertex_count = len(vertices)
        return torch.from_numpy(closest.distance).to(points)

    @staticmethod
    @torch.autograd.function.once_differentiable
    def backward(ctx, upstream):
        upstream = upstream.detach().cpu().double().numpy()
        of_points = of_vertices = None
        if ctx.needs_input_grad[0]:
            of_points = torch.from_numpy(_gradients.of_points(ctx.closest, upstream)).to(ctx.points)
        if ctx.needs_input_grad[1]:
            gradient = _gradients.of_vertices(ctx.closest, upstream, ctx.vertex_count)
            of_vertices = torch.from_numpy(gradient).to(ctx.vertices)
        return of_points, of_vertices, None, None, None


def distance(
    points: torch.Tensor,
    vertices: torch.Tensor,
    faces: torch.Tensor,
    *,
    sign: str = "none",
    max_distance: float = float("inf"),
) -> torch.Tensor:
    """Returns the distance of each of n points to a mesh, (n,), of the dtype and device of ``points``.

    points: (n, 3). vertices: (v, 3). faces: (f, 3) integers. Derivatives flow to points and vertices. sign and max_distance
    are those of Sites.closest_points(); points farther away have an infinite distance, with the derivative 0. The
    computation runs on the CPU, in double precision. Raises sdm.Error as Sites does.
    """
    return PointMeshDistance.apply(points, vertices, faces, sign, max_distance)
