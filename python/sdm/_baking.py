"""Textures of coarse meshes from detailed ones."""

import os
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._arrays import numpy_of
from ._core import Baked, Error, Mesh
from ._looks import Appearance, look_of
from ._types import Atlas, MatchMethod


def _corner_uvs(mesh: Any, uvs: Any) -> npt.NDArray[Any]:
    """Texture coordinates of the corners of faces, (m, 3, 2), from those or from those of vertices, (n, 2)."""
    vertices, faces = Mesh(mesh)
    corners = numpy_of(uvs, "uvs")
    if corners.shape == (len(vertices), 2):
        corners = corners[faces]
    if corners.shape != (len(faces), 3, 2):
        raise Error(f"uvs must have the shape (vertices, 2) or (faces, 3, 2), not {corners.shape}")
    return corners


def _appearance(mesh: Any, vertex_colors: Any, face_colors: Any, texture: Any, uvs: Any) -> tuple[Any, Appearance]:
    """What a mesh looks like: as the arguments state, otherwise as the object of another package does."""
    if vertex_colors is not None and face_colors is not None:
        raise Error("a mesh has vertex_colors or face_colors, not both")
    own, look = look_of(mesh)
    if vertex_colors is not None or face_colors is not None or texture is not None:
        look = Appearance()
    if vertex_colors is not None:
        look.set_colors(vertex_colors, "vertex")
    if face_colors is not None:
        look.set_colors(face_colors, "face")
    if texture is not None:
        look.add_material(base_color_texture=look.add_picture(texture))
    if uvs is not None:
        look.uvs = _corner_uvs(own, uvs)
    return own, look


def bake(
    high: Any,
    low: Any,
    *,
    vertex_colors: Any = None,
    face_colors: Any = None,
    texture: Any = None,
    uvs: Any = None,
    channels: "Sequence[str] | None" = None,
    resolution: int = 1024,
    atlas: "Atlas | None" = None,
    gutter: int = 1,
    match: "MatchMethod | None" = None,
    facing: "float | None" = None,
    cage: "float | None" = None,
    max_distance: float = np.inf,
    progress: "Callable[[str, float], bool | None] | None" = None,
) -> Baked:
    """Bakes the materials, textures and colours of a detailed mesh into textures of a coarse one.

    Each texel of ``low`` gets what ``high`` has at the closest point; textures are averaged in linear light over what
    the texel covers of them. Texels of no face, or without a point, are filled from others.

    high: a path of glTF, GLB, OBJ or PLY, with its materials and colours; or any mesh, with one of the next three. Meshes
        and scenes of trimesh bring their materials, textures and colours; meshes of pyvista their colours, of uint8: the
        active array of points or cells, or one that is named RGB, RGBA or colors.
    vertex_colors, face_colors: red, green and blue in sRGB, uint8, uint16 or from 0 to 1; a fourth column is alpha.
    texture: a picture, (height, width, 1 to 4) uint8, or one of Pillow or pyvista, on the texture coordinates of the mesh,
        or on ``uvs``.
    uvs: of the vertices, (n, 2), or of the corners of the faces, (m, 3, 2), with (0, 0) at the lower left; NaN at the
        corners of faces without texture.
    low: the mesh that gets the textures: on its texture coordinates if they can be used, otherwise on an atlas
        (``Baked.corner_uvs``).
    channels: of 'base_color', 'metallic_roughness', 'occlusion', 'emissive', and 'normal', the shape of ``high`` in the
        tangent space of ``low``; by default base_color, and others, but not normal, that differ between points of ``high``.
    resolution: texels a side. atlas: insists on a layout, as of ``map()``. gutter: free texels around charts.
    match: 'closest', 'facing' or 'ray', as of ``match()``: the closest point, the closest one on faces that face as the
        texel does, or the nearest hit of these along the normal of ``low``. By default closest, or facing if ``facing`` is
        given. For thin walls, pass facing=90.
    facing: of 'facing' and 'ray', the largest angle in degrees between the normals; by default 90.
    cage: of 'ray', how far along the normal hits are searched for, to either side.
    max_distance: points farther away do not count.

    Raises Error if ``high`` has nothing to bake, and if no texel has a point.

    >>> colors = np.zeros((len(sdm.Mesh(box).vertices), 3)) + [1, 0.5, 0]
    >>> baked = sdm.bake(box, box, vertex_colors=colors, resolution=64)
    >>> baked.channels, baked.image("base_color")[0, 0]
    (['base_color'], array([255, 128,   0], dtype=uint8))
    """
    is_path = isinstance(high, (str, bytes, os.PathLike))
    if is_path and any(given is not None for given in (vertex_colors, face_colors, texture, uvs)):
        raise Error("colours, texture and uvs belong to a mesh that is given as arrays, not to a file")
    mesh, look = (None, Appearance()) if is_path else _appearance(high, vertex_colors, face_colors, texture, uvs)
    return _core.bake(
        high if is_path else None,
        mesh,
        look.compiled(),
        low,
        None if channels is None else list(channels),
        resolution,
        atlas,
        gutter,
        match,
        facing,
        cage,
        max_distance,
        progress,
    )
