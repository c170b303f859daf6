"""Textures of coarse meshes from detailed ones."""

import os
from collections.abc import Callable, Sequence
from types import SimpleNamespace
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from . import _core
from ._arrays import numpy_of
from ._core import Baked, Error, Mesh


def _linear(colors: Any) -> npt.NDArray[Any]:
    """Red, green and blue in linear light, of uint8 or of numbers from 0 to 1, in sRGB."""
    array = numpy_of(colors, "vertex_colors")
    if array.ndim != 2 or array.shape[1] not in (3, 4):
        raise Error(f"vertex_colors must have the shape (vertices, 3) or (vertices, 4), not {array.shape}")
    scale = np.iinfo(array.dtype).max if array.dtype in (np.uint8, np.uint16) else 1
    srgb = array[:, :3].astype(np.float64) / scale
    if not ((srgb >= 0) & (srgb <= 1)).all():
        raise Error("vertex_colors must be uint8, uint16, or numbers from 0 to 1")
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    return np.ascontiguousarray(linear, np.float32)


def _pixels(texture: Any) -> npt.NDArray[Any]:
    pixels = np.asarray(texture)
    if pixels.dtype != np.uint8 or pixels.ndim not in (2, 3):
        raise Error("texture must be a picture of uint8 numbers, of shape (height, width) or (height, width, 1 to 4)")
    return np.ascontiguousarray(pixels if pixels.ndim == 3 else pixels[:, :, None])


def _with_uvs(mesh: Any, uvs: Any) -> Any:
    """The mesh with texture coordinates of its vertices, (n, 2), or of the corners of its faces, (m, 3, 2)."""
    vertices, faces = Mesh(mesh)
    corners = numpy_of(uvs, "uvs")
    if corners.shape == (len(vertices), 2):
        corners = corners[faces]
    if corners.shape != (len(faces), 3, 2):
        raise Error(f"uvs must have the shape (vertices, 2) or (faces, 3, 2), not {corners.shape}")
    return SimpleNamespace(vertices=vertices, triangles=faces, triangle_uvs=corners.reshape(-1, 2))


def _visual(mesh: Any) -> tuple[Any, Any]:
    """The colours of vertices, and the texture, that a mesh of trimesh has."""
    visual = getattr(mesh, "visual", None)
    kind = getattr(visual, "kind", None)
    if kind == "vertex":
        return visual.vertex_colors, None  # type: ignore[union-attr]
    if kind != "texture":
        return None, None
    material = getattr(visual, "material", None)
    image = getattr(material, "baseColorTexture", None) or getattr(material, "image", None)
    return None, None if image is None else np.asarray(image.convert("RGB"))


def bake(
    high: Any,
    low: Any,
    *,
    vertex_colors: Any = None,
    texture: Any = None,
    uvs: Any = None,
    channels: "Sequence[str] | None" = None,
    resolution: int = 1024,
    atlas: "Literal['charts', 'triangles', 'uv'] | None" = None,
    max_distance: float = np.inf,
    facing: "float | None" = None,
    progress: "Callable[[str, float], bool | None] | None" = None,
) -> Baked:
    """Bakes the materials, textures and colours of a detailed mesh into textures of a coarse one.

    Each texel of ``low`` gets what ``high`` has at the closest point; textures are averaged in linear light over what
    the texel covers of them. Texels of no face, or without a point, are filled from others.

    high: a path of glTF, GLB, OBJ or PLY, with its materials and colours; or any mesh, with one of the next two. Meshes
        of trimesh bring their own.
    vertex_colors: red, green and blue of each vertex in sRGB, uint8 or from 0 to 1; a fourth column is ignored.
    texture: a picture, (height, width, 1 to 4) uint8, on the texture coordinates of the mesh, or on ``uvs``.
    uvs: of the vertices, (n, 2), or of the corners of the faces, (m, 3, 2), with (0, 0) at the lower left.
    low: the mesh that gets the textures: on its texture coordinates if they can be used, otherwise on an atlas
        (``Baked.corner_uvs``).
    channels: of 'base_color', 'metallic_roughness', 'occlusion' and 'emissive'; by default base_color, and others that
        differ between points of ``high``.
    atlas: insists on a layout, as of ``map()``.
    max_distance, facing: which points count, as of ``map()``. For thin walls, pass facing=90.

    Raises Error if ``high`` has nothing to bake, and if no texel has a point.

    >>> colors = np.zeros((len(sdm.Mesh(box).vertices), 3)) + [1, 0.5, 0]
    >>> baked = sdm.bake(box, box, vertex_colors=colors, resolution=64)
    >>> baked.channels, baked.image("base_color")[0, 0]
    (['base_color'], array([255, 128,   0], dtype=uint8))
    """
    is_path = isinstance(high, (str, bytes, os.PathLike))
    if is_path and not (vertex_colors is None and texture is None and uvs is None):
        raise Error("vertex_colors, texture and uvs belong to a mesh that is given as arrays, not to a file")
    if not is_path and vertex_colors is None and texture is None:
        vertex_colors, texture = _visual(high)
    if uvs is not None:
        high = _with_uvs(high, uvs)
    return _core.bake(
        high if is_path else None,
        None if is_path else high,
        low,
        None if vertex_colors is None else _linear(vertex_colors),
        None if texture is None else _pixels(texture),
        None if channels is None else list(channels),
        resolution,
        atlas,
        max_distance,
        facing,
        progress,
    )
