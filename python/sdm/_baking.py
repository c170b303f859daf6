"""Textures of coarse meshes from detailed ones."""

import os
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._arrays import numpy_of
from ._core import Baked, Error, Mesh
from ._looks import Appearance, look_of
from ._options import takes_options


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


@takes_options("bake")
def bake(
    high: Any,
    low: Any,
    *,
    vertex_colors: Any = None,
    face_colors: Any = None,
    texture: Any = None,
    uvs: Any = None,
    progress: "Callable[[str, float], bool | None] | None" = None,
    **options: object,
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
    {options}

    Shapes of arrays: ``Baked[channel]``; ``Baked.material_names`` has the names of materials by their numbers.
    ``resolution`` times the root of ``samples`` is 32768 at most. For thin walls, pass facing=90.

    Raises Error if ``high`` has nothing to bake, and if no texel has a point. Time and memory are those of a texture with
    as many texels as there are samples.

    >>> colors = np.zeros((len(sdm.Mesh(box).vertices), 3)) + [1, 0.5, 0]
    >>> baked = sdm.bake(box, box, vertex_colors=colors, resolution=64)
    >>> baked.channels, baked.image("base_color")[0, 0]
    (['base_color'], array([255, 128,   0], dtype=uint8))
    >>> outer = (1.5 * sphere.vertices, sphere.faces)
    >>> heights = sdm.bake(outer, sphere, channels=["displacement"], match="ray", resolution=64, samples=4)["displacement"]
    >>> heights.shape, bool(np.nanmin(heights) > 0.4 and np.nanmax(heights) < 0.6)
    ((64, 64), True)
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
        options,
        progress,
    )
