"""Closest points and distances with derivatives in PyTorch, which is not a dependency of the package: import this module.

Points are (..., n, 3), vertices (..., v, 3), faces (f, 3) integers; leading dimensions are batches, which are searched on all
cores. Tensors may have any real dtype, bfloat16 included, and be on any device; the search runs on the CPU, in double
precision. Results have the dtype and device of the points. A mesh that does not change may be a ``sdm.Sites``, in place of
vertices and faces: it is built once, and derivatives do not flow to it. ``sites``, of the same faces, are refitted to the
vertices at each call, which takes a fraction of building them.

Derivatives are exact wherever the result is differentiable; those of a distance are 0 where it is 0. torch.func.grad and
torch.vmap apply; forward mode does not. Second derivatives are right as well, and slower.
"""

from __future__ import annotations

from typing import Any, NamedTuple, Union

import numpy as np
import torch

from ._core import Sites
from ._torch_search import _arguments, _corner_positions, _differentiable, _Distance, _Query, _under_func
from ._types import Sign

__all__ = [
    "ClosestPoints",
    "Samples",
    "SurfaceLosses",
    "chamfer",
    "closest_points",
    "distance",
    "normal_consistency",
    "point_to_surface",
    "sample_surface",
    "surface_losses",
]

#: Vertices and faces, or Sites that do not change.
Surface = Union["tuple[torch.Tensor, torch.Tensor]", Sites]


class ClosestPoints(NamedTuple):
    """The closest points of a mesh to n points."""

    distance: torch.Tensor
    """(..., n): negative inside if signed; infinite where nothing is within max_distance."""
    point: torch.Tensor
    """(..., n, 3); NaN where there is none."""
    face: torch.Tensor
    """(..., n) int64: a face that contains the point; -1 where there is none."""
    barycentric: torch.Tensor
    """(..., n, 3): of the point in its face; NaN where there is none."""


def distance(
    points: torch.Tensor,
    vertices: torch.Tensor | Sites,
    faces: torch.Tensor | None = None,
    *,
    sites: Sites | None = None,
    sign: Sign = "none",
    max_distance: float = float("inf"),
) -> torch.Tensor:
    """Returns the distance of each point to a mesh, (..., n), of the dtype and device of ``points``.

    points, vertices, faces, sites: as the module describes. Derivatives flow to points and vertices. sign and max_distance
    are those of Sites.closest_points(); points farther away have an infinite distance, with the derivative 0. Raises
    sdm.Error as Sites does.
    """
    arguments = _arguments(points, vertices, faces, sites, sign, max_distance)
    of_one = arguments[1] is None or (arguments[1].dim() == 2 and arguments[2].dim() == 2)
    plain = of_one and not _under_func()
    found: torch.Tensor = _Distance.apply(*arguments) if plain else _Query.apply(*arguments)[0]
    return found


def closest_points(
    points: torch.Tensor,
    vertices: torch.Tensor | Sites,
    faces: torch.Tensor | None = None,
    *,
    sites: Sites | None = None,
    sign: Sign = "none",
    max_distance: float = float("inf"),
) -> ClosestPoints:
    """Returns the closest points of a mesh: distance, point, face and barycentric coordinates.

    The arguments are those of distance(). Derivatives flow from distance, point and barycentric to points and vertices.
    They are those of the site that was found: closest points jump where several are equally close. Raises sdm.Error as Sites
    does.
    """
    found, face, weights, _, corners, still = _Query.apply(*_arguments(points, vertices, faces, sites, sign, max_distance))
    positions = still if isinstance(vertices, Sites) else _corner_positions(vertices, corners).to(weights)
    barycentric = _differentiable(weights, points.to(weights), positions)
    point = (barycentric[..., None] * positions).sum(-2)
    none = (face < 0)[..., None]
    nan = torch.full_like(point, float("nan"))
    return ClosestPoints(
        found, torch.where(none, nan, point).to(found), face, torch.where(none, nan, barycentric).to(found)
    )


class Samples(NamedTuple):
    """Points of a surface that move with its vertices."""

    face: torch.Tensor
    """(..., n) int64."""
    barycentric: torch.Tensor
    """(..., n, 3)."""


def _parts(surface: Surface) -> tuple[torch.Tensor, torch.Tensor]:
    if isinstance(surface, Sites):
        return torch.from_numpy(np.array(surface.vertices)), torch.from_numpy(surface.faces.astype(np.int64))
    vertices, faces = surface
    return vertices, faces.long()


def _normals(corners: torch.Tensor) -> torch.Tensor:
    """The normals (..., 3) of faces with these corners, twice their area long."""
    a, b, c = corners.unbind(-2)
    normals: torch.Tensor = torch.linalg.cross(b - a, c - a)
    return normals


def sample_surface(surface: Surface, count: int, *, generator: torch.Generator | None = None) -> Samples:
    """Returns random points of a surface, uniformly by area: ``count`` of each item of a batch of vertices."""
    vertices, faces = _parts(surface)
    areas = _normals(_corner_positions(vertices.detach().double(), faces)).norm(dim=-1)
    face = torch.multinomial(areas.reshape(-1, areas.shape[-1]), count, replacement=True, generator=generator)
    face = face.reshape(*areas.shape[:-1], count)
    u, v = torch.rand(2, *face.shape, dtype=torch.float64, device=areas.device, generator=generator)
    root = u.sqrt()
    return Samples(face, torch.stack([1 - root, root * (1 - v), root * v], dim=-1))


class SurfaceLosses(NamedTuple):
    """What surface_losses() returns."""

    chamfer: torch.Tensor
    """The mean of (squared) distances from a to b, and that from b to a, added."""
    normals: torch.Tensor
    """The mean of 1 - |cos| of the angle to the normal of the closest face, from a to b and from b to a, added."""


def _one_way(a: Surface, b: Surface, samples: Samples, b_sites: Sites | None, squared: bool) -> Any:
    vertices, faces = _parts(a)
    corners = _corner_positions(vertices, faces[samples.face])
    points = (samples.barycentric.to(corners)[..., None] * corners).sum(-2)
    mesh, mesh_faces = (b, None) if isinstance(b, Sites) else b
    far, _, _, _, closest, still = _Query.apply(
        *_arguments(points, mesh, mesh_faces, b_sites, "none", float("inf"))
    )
    there = _normals((still if isinstance(mesh, Sites) else _corner_positions(mesh, closest)).to(corners))
    cosine = torch.nn.functional.cosine_similarity(_normals(corners), there, dim=-1, eps=1e-30)
    return (far.square() if squared else far).mean(), (1 - cosine.abs()).mean()


def surface_losses(
    a: Surface,
    b: Surface,
    *,
    samples: int | tuple[Samples, Samples] = 10_000,
    squared: bool = True,
    sites: tuple[Sites | None, Sites | None] = (None, None),
    generator: torch.Generator | None = None,
) -> SurfaceLosses:
    """Returns losses of two surfaces in both directions, by one search in each.

    a, b: (vertices, faces), or Sites that do not change. samples: of each surface, drawn uniformly by area, or those of
    both from sample_surface(), which move with the vertices. squared: the squares of distances. sites: of the faces of a
    and of b, refitted in place of being built. Sampled distances are those to all points of the other surface and not to its
    samples, so that the loss of equal surfaces is 0. Derivatives flow to the vertices. Raises sdm.Error as Sites does.
    """
    if isinstance(samples, int):
        samples = (sample_surface(a, samples, generator=generator), sample_surface(b, samples, generator=generator))
    forth = _one_way(a, b, samples[0], sites[1], squared)
    back = _one_way(b, a, samples[1], sites[0], squared)
    return SurfaceLosses(forth[0] + back[0], forth[1] + back[1])


def chamfer(a: Surface, b: Surface, **options: Any) -> torch.Tensor:
    """Returns the symmetric point-to-surface (chamfer) loss of two surfaces: surface_losses().chamfer."""
    return surface_losses(a, b, **options).chamfer


def normal_consistency(a: Surface, b: Surface, **options: Any) -> torch.Tensor:
    """Returns how much the normals of two surfaces differ where these are closest: surface_losses().normals.

    Where normals are piecewise constant its derivatives are those of the faces that were found.
    """
    return surface_losses(a, b, **options).normals


def point_to_surface(
    points: torch.Tensor,
    vertices: torch.Tensor | Sites,
    faces: torch.Tensor | None = None,
    *,
    sites: Sites | None = None,
    squared: bool = True,
) -> torch.Tensor:
    """Returns the mean of the (squared) distances of points to a mesh. The arguments are those of distance()."""
    far = distance(points, vertices, faces, sites=sites)
    return (far.square() if squared else far).mean()
