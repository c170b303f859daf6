"""The search behind sdm.torch, and its derivatives."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import numpy.typing as npt
import torch

from . import _gradients
from ._batches import closest_points_batch
from ._closest_points import NONE
from ._core import Error, Sites
from ._types import Sign


@dataclasses.dataclass(frozen=True)
class _Options:  # no tuple, which torch.func would take apart
    sites: Sites | None
    sign: Sign
    max_distance: float


def _array(tensor: torch.Tensor) -> npt.NDArray[Any]:
    array: npt.NDArray[Any] = tensor.detach().to("cpu", torch.float64).contiguous().numpy()
    return array


def _indices(tensor: torch.Tensor) -> npt.NDArray[Any]:
    if tensor.is_floating_point():
        raise Error(f"the faces must be integers, not {tensor.dtype}")
    array: npt.NDArray[Any] = tensor.detach().cpu().contiguous().numpy()
    return array


def _sites_of(vertices: torch.Tensor | None, faces: torch.Tensor | None, options: _Options) -> Any:
    """The Sites of one mesh: those that do not change, or new or refitted ones."""
    sites = options.sites
    if vertices is None or faces is None:
        return sites
    if sites is None:
        return Sites(_array(vertices), _indices(faces))
    if not np.array_equal(sites.vertices, _array(vertices)):
        sites.refit(_array(vertices))
    return sites


def _found(points: torch.Tensor, vertices: torch.Tensor | None, faces: torch.Tensor | None, options: _Options) -> Any:
    """What the search of one mesh, or of a batch of them, finds."""
    query: dict[str, Any] = {"sign": options.sign, "max_distance": options.max_distance, "gradients": True}
    p = _array(points)
    if vertices is None or faces is None or (vertices.dim() == 2 and faces.dim() == 2):
        return _sites_of(vertices, faces, options).closest_points(p.reshape(-1, 3), **query)
    shapes, shared = _array(vertices), _indices(faces)
    if shared.ndim > 2:
        shared = shared.reshape(-1, *shared.shape[-2:])
    return closest_points_batch(shapes.reshape(-1, *shapes.shape[-2:]), shared, p.reshape(-1, *p.shape[-2:]), **query)


def _tensors(found: Any, points: torch.Tensor, sites: Sites | None) -> tuple[torch.Tensor, ...]:
    """(face, barycentric, gradient, corners, positions) of what was found; positions: of corners of Sites that do not
    change, else empty."""
    shape, real = points.shape[:-1], torch.float32 if points.device.type == "mps" else torch.float64
    corners, _ = found.vertex_gradients()
    positions = np.empty((len(found), 0)) if sites is None else sites.vertices[corners]
    face = np.where(found.face == NONE, -1, found.face.astype(np.int64))
    weights = np.where(np.isnan(found.barycentric), 0.0, found.barycentric)
    return (
        torch.from_numpy(face).to(points.device).reshape(shape),
        torch.from_numpy(weights).to(points.device, real).reshape(*shape, 3),
        torch.from_numpy(np.ascontiguousarray(found.gradient)).to(points.device, real).reshape(*shape, 3),
        torch.from_numpy(corners.astype(np.int64)).to(points.device).reshape(*shape, 3),
        torch.from_numpy(positions).to(points.device, real).reshape(*shape, *positions.shape[1:]),
    )


def _distances(found: Any, points: torch.Tensor) -> torch.Tensor:
    return torch.from_numpy(np.ascontiguousarray(found.distance)).to(points).reshape(points.shape[:-1])


def _pull_back(
    points: Any, vertices: Any, tensors: tuple[torch.Tensor, ...], upstream: torch.Tensor, needed: Any
) -> tuple[Any, ...]:
    """The derivatives by the points and the vertices, from those by the distances, by tensors that have derivatives."""
    weights, gradient, corners, positions = tensors
    if torch.is_grad_enabled():  # derivatives of this may be needed
        if vertices is not None:
            positions = _corner_positions(vertices, corners).to(weights)
        gradient, weights = _moving(points.to(weights), positions, weights, gradient)
    # Points beyond the maximum distance have the derivative 0, whatever a function makes of their infinite distance.
    upstream = torch.where((gradient != 0).any(-1), upstream.to(gradient.dtype), 0)
    of_points = of_vertices = None
    if needed[0]:
        of_points = _gradients.of_points(gradient, upstream).to(points.dtype)
    if needed[1]:
        parts = _gradients.of_corners(gradient, weights, upstream)
        shape = vertices.shape
        if len(shape) > 2:  # one vertex after the other, over the batch
            items = torch.arange(shape[:-2].numel(), device=corners.device).reshape(*shape[:-2], 1, 1)
            corners = corners + shape[-2] * items
        zeros = torch.zeros(shape.numel() // 3, 3, dtype=parts.dtype, device=parts.device)
        sums = zeros.index_add(0, corners.reshape(-1), parts.reshape(-1, 3))
        of_vertices = sums.reshape(shape).to(vertices.dtype)
    return of_points, of_vertices, None, None


class _Distance(torch.autograd.Function):
    """Distances to one mesh, outside of torch.func: what was found stays in the library, which applies the chain rule."""

    @staticmethod
    def forward(ctx: Any, points: torch.Tensor, vertices: Any, faces: Any, options: _Options) -> torch.Tensor:
        ctx.found, ctx.still = _found(points, vertices, faces, options), options.sites if vertices is None else None
        ctx.save_for_backward(points, vertices)
        return _distances(ctx.found, points)

    @staticmethod
    def backward(ctx: Any, upstream: torch.Tensor) -> tuple[Any, ...]:
        points, vertices = ctx.saved_tensors
        values = None
        if not torch.is_grad_enabled() and not _under_func():
            try:
                values = _array(upstream)
            except RuntimeError:  # a batch, of torch.autograd.grad(is_grads_batched=True)
                pass
        if values is None:
            tensors = _tensors(ctx.found, points, ctx.still)[1:]
            return _pull_back(points, vertices, tensors, upstream, ctx.needs_input_grad)
        count = len(vertices) if ctx.needs_input_grad[1] else 0
        of_points, of_vertices = ctx.found._pull_back(values.reshape(-1), count)
        return (
            torch.from_numpy(of_points).to(points).reshape(points.shape) if ctx.needs_input_grad[0] else None,
            torch.from_numpy(of_vertices).to(vertices) if ctx.needs_input_grad[1] else None,
            None,
            None,
        )


def _under_func() -> bool:
    """Whether tensors may stand for others, as under torch.func and torch.vmap."""
    return getattr(torch._C, "_are_functorch_transforms_active", lambda: True)()


class _Query(torch.autograd.Function):
    """(distance, face, barycentric, gradient, corners, positions). Only the distance has derivatives.

    Vertices have two dimensions, or the batch of the points; so do faces.
    """

    @staticmethod
    def forward(points: torch.Tensor, vertices: Any, faces: Any, options: _Options) -> tuple[torch.Tensor, ...]:
        found = _found(points, vertices, faces, options)
        still = options.sites if vertices is None else None
        return _distances(found, points), *_tensors(found, points, still)

    @staticmethod
    def setup_context(ctx: Any, inputs: Any, output: Any) -> None:
        points, vertices, _, _ = inputs
        ctx.mark_non_differentiable(*output[1:])
        ctx.save_for_backward(points, vertices, *output[2:])

    @staticmethod
    def backward(ctx: Any, upstream: torch.Tensor, *_: Any) -> tuple[Any, ...]:
        points, vertices, *tensors = ctx.saved_tensors
        return _pull_back(points, vertices, tuple(tensors), upstream, ctx.needs_input_grad)

    @staticmethod
    def vmap(info: Any, in_dims: Any, points: Any, vertices: Any, faces: Any, options: _Options) -> tuple[Any, Any]:
        tensors = [
            t if t is None or dim is None else t.movedim(dim, 0)
            for t, dim in zip((points, vertices, faces), in_dims)
        ]
        points, vertices, faces = tensors
        if in_dims[0] is None:
            points = points.expand(info.batch_size, *points.shape)
        batch = points.shape[:-2]
        if in_dims[1] is not None or in_dims[2] is not None:
            vertices = _with_batch(vertices, in_dims[1] is not None, batch)
            if in_dims[2] is not None or faces.dim() > 2:
                faces = _with_batch(faces, in_dims[2] is not None, batch)
        elif vertices is not None and vertices.dim() > 2:
            vertices = _with_batch(vertices, False, batch)
            faces = faces if faces.dim() == 2 else _with_batch(faces, False, batch)
        return _Query.apply(points, vertices, faces, options), (0, 0, 0, 0, 0, 0)


def _broadcast(*shapes: torch.Size) -> torch.Size:
    return torch.Size(np.broadcast_shapes(*shapes))


def _with_batch(rows: torch.Tensor, has_first: bool, batch: torch.Size) -> torch.Tensor:
    """Rows (..., k, 3) for each item of a batch, of whose dimensions they may have the first one, or the others."""
    missing = len(batch) - (rows.dim() - 2)
    first = rows.shape[:1] if has_first else torch.Size()
    return rows.reshape(*first, *([1] * missing), *rows.shape[len(first) :]).expand(*batch, *rows.shape[-2:])


def _arguments(points: torch.Tensor, mesh: Any, faces: Any, sites: Any, sign: Sign, max_distance: float) -> tuple[Any, ...]:
    """Those of _Query.apply()."""
    if isinstance(mesh, Sites):
        if faces is not None or sites is not None:
            raise Error("Sites have faces of their own; leave out faces and sites")
        return points, None, None, _Options(mesh, sign, max_distance)
    if faces is None:
        raise Error("vertices need faces")
    if mesh.dim() > 2 or faces.dim() > 2:
        if sites is not None:
            raise Error("sites are of one mesh; leave them out for a batch of vertices")
        batch = _broadcast(points.shape[:-2], mesh.shape[:-2], faces.shape[:-2])
        points = points.expand(*batch, *points.shape[-2:])
        mesh = mesh.expand(*batch, *mesh.shape[-2:])
        faces = faces if faces.dim() == 2 else faces.expand(*batch, *faces.shape[-2:])
    return points, mesh, faces, _Options(sites, sign, max_distance)


def _corner_positions(vertices: torch.Tensor, corners: torch.Tensor) -> torch.Tensor:
    """The positions (..., n, 3, 3) of vertices (..., n, 3)."""
    if vertices.dim() == 2:
        return vertices[corners]
    batch = _broadcast(vertices.shape[:-2], corners.shape[:-2])
    rows = corners.expand(*batch, *corners.shape[-2:]).reshape(*batch, -1, 1)
    positions = vertices.expand(*batch, *vertices.shape[-2:]).gather(-2, rows.expand(*rows.shape[:-1], 3))
    return positions.reshape(*batch, -1, 3, 3)


def _differentiable(weights: torch.Tensor, points: torch.Tensor, corners: torch.Tensor) -> torch.Tensor:
    """The weights with their derivatives by points and corners: those of the projection onto the vertex, the edge or the
    plane that the corners with a weight span."""
    order = weights.argsort(dim=-1, descending=True, stable=True)
    w = weights.gather(-1, order)
    a, b, c = corners.gather(-2, order[..., None].expand(corners.shape)).unbind(-2)
    ab, ac, ap = b - a, c - a, points - a
    one = torch.ones_like(w[..., 0])
    aa, bb, mixed = (ab * ab).sum(-1), (ac * ac).sum(-1), (ab * ac).sum(-1)
    along_ab, along_ac = (ab * ap).sum(-1), (ac * ap).sum(-1)
    area = aa * bb - mixed * mixed
    on_edge, in_face = (w[..., 1] > 0) & (aa > 0), (w[..., 2] > 0) & (area > 0)
    edge = torch.where(on_edge, along_ab / torch.where(on_edge, aa, one), 0 * one)
    inverse = 1 / torch.where(in_face, area, one)
    u = torch.where(in_face, (bb * along_ab - mixed * along_ac) * inverse, edge)
    v = torch.where(in_face, (aa * along_ac - mixed * along_ab) * inverse, 0 * one)
    moved = torch.stack([1 - u - v, u, v], dim=-1).gather(-1, order.argsort(dim=-1))
    return weights + (moved - moved.detach())  # the weights of the search, bit for bit


def _moving(points: Any, positions: Any, weights: Any, gradient: Any) -> tuple[torch.Tensor, torch.Tensor]:
    """The gradient and the weights with their derivatives by points and the positions of corners."""
    weights = _differentiable(weights, points, positions)
    offset = points - (weights[..., None] * positions).sum(-2)
    there = (gradient != 0).any(-1, keepdim=True)
    side = (gradient * offset.detach()).sum(-1, keepdim=True).sign()
    length = torch.where(there, offset.square().sum(-1, keepdim=True), 1).sqrt()
    unit = torch.where(there, side * offset / length, 0)
    return gradient + (unit - unit.detach()), weights
