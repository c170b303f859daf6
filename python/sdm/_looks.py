"""What meshes of other packages look like, as the compiled part takes it, and textured meshes for them."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ._arrays import numpy_of
from ._core import Error
from ._meshes import scene_parts, triangulated

if TYPE_CHECKING:
    from ._core import Baked

#: The textures of a material here, and in trimesh.
_TEXTURES = {
    "base_color_texture": "baseColorTexture",
    "metallic_roughness_texture": "metallicRoughnessTexture",
    "occlusion_texture": "occlusionTexture",
    "emissive_texture": "emissiveTexture",
}
#: The names under which arrays of pyvista are colours.
_COLOR_NAMES = ("rgba", "rgb", "colors", "color")


class Appearance:
    """Colours, materials and pictures of a mesh, with its texture coordinates."""

    def __init__(self) -> None:
        self.materials: list[dict[str, Any]] = []
        self.pictures: list[npt.NDArray[Any]] = []
        self.face_materials: "npt.NDArray[np.uint32] | None" = None
        self.uvs: "npt.NDArray[np.float64] | None" = None
        self._colors: "tuple[npt.NDArray[np.float32], str] | None" = None
        self._numbers: dict[int, tuple[int, Any]] = {}  # of pictures, by the identity of what they were made from

    def set_colors(self, colors: Any, domain: str) -> None:
        """In sRGB, of uint8 or uint16, or from 0 to 1; a fourth column is alpha."""
        name = f"{domain}_colors"
        array = numpy_of(colors, name)
        if array.ndim != 2 or array.shape[1] not in (3, 4):
            raise Error(f"{name} must have the shape (n, 3) or (n, 4), not {array.shape}")
        scale = np.iinfo(array.dtype).max if array.dtype in (np.uint8, np.uint16) else 1
        srgb = np.ascontiguousarray(array / scale, np.float32)
        if not ((srgb >= 0) & (srgb <= 1)).all():
            raise Error(f"{name} must be uint8, uint16, or numbers from 0 to 1")
        self._colors = (srgb, domain)

    def add_material(self, **given: Any) -> None:
        """Factors as glTF has them, and numbers of pictures. diffuse: a colour in sRGB, in place of that of base_color."""
        self.materials.append(
            {
                "base_color": (1.0, 1.0, 1.0, 1.0),
                "metallic": 0.0,
                "roughness": 1.0,
                "emissive": (0.0, 0.0, 0.0),
                "alpha_mode": "OPAQUE",
                "alpha_cutoff": 0.5,
                **given,
            }
        )

    def add_picture(self, picture: Any) -> int:
        """The number of a picture: pixels, or an object of Pillow or pyvista."""
        if id(picture) not in self._numbers:
            self._numbers[id(picture)] = (len(self.pictures), picture)  # kept: of what is freed, another may have the identity
            self.pictures.append(_pixels(picture))
        return self._numbers[id(picture)][0]

    def compiled(self) -> dict[str, object]:
        """The dictionary that the compiled part reads."""
        if self._colors is not None and self._colors[0].shape[1] == 4 and (self._colors[0][:, 3] < 1).any():
            if not self.materials:
                self.add_material()
            for material in self.materials:
                material["alpha_mode"] = "BLEND" if material["alpha_mode"] == "OPAQUE" else material["alpha_mode"]
        result: dict[str, object] = {"materials": self.materials, "pictures": self.pictures}
        if self._colors is not None:
            result["colors"], result["domain"] = self._colors
        if self.face_materials is not None:
            result["face_materials"] = np.ascontiguousarray(self.face_materials, np.uint32)
        if self.uvs is not None:
            result["uvs"] = np.ascontiguousarray(self.uvs, np.float64)
        return result


def _pixels(picture: Any) -> npt.NDArray[Any]:
    if hasattr(picture, "convert"):  # of Pillow
        mode, info = getattr(picture, "mode", "RGB"), getattr(picture, "info", {})
        picture = picture.convert("RGBA" if mode in ("RGBA", "LA", "PA") or "transparency" in info else "RGB")
    elif hasattr(picture, "to_array"):  # of pyvista
        picture = picture.to_array()
    pixels = np.asarray(picture)
    if pixels.dtype != np.uint8 or pixels.ndim not in (2, 3):
        raise Error("texture must be a picture of uint8 numbers, of shape (height, width) or (height, width, 1 to 4)")
    return np.ascontiguousarray(pixels if pixels.ndim == 3 else pixels[:, :, None])


def _factors(values: Any, otherwise: tuple[float, ...]) -> tuple[float, ...]:
    """Numbers of trimesh: from 0 to 1, or of bytes, which may be integers of other types."""
    if values is None:
        return otherwise
    array = np.asarray(values)
    are_bytes = array.dtype == np.uint8 or (np.issubdtype(array.dtype, np.integer) and (array > 1).any())
    scaled = array / 255 if are_bytes else array.astype(float)
    if not ((scaled >= 0) & (scaled <= 1)).all():
        raise Error("colours of materials must be numbers from 0 to 1, or integers from 0 to 255")
    numbers = scaled.tolist()
    return tuple((numbers + list(otherwise[len(numbers) :]))[: len(otherwise)])


def _add_trimesh_material(material: Any, look: Appearance) -> None:
    if material is None:
        look.add_material()
        return
    if not hasattr(material, "baseColorTexture"):  # a SimpleMaterial, as of OBJ: sRGB, in place of which a picture is
        image = getattr(material, "image", None)
        color = _factors(getattr(material, "diffuse", None), (1.0, 1.0, 1.0, 1.0))
        surface = {"diffuse": color[:3]} if image is None else {"base_color_texture": look.add_picture(image)}
        look.add_material(base_color=(1.0, 1.0, 1.0, color[3]), alpha_mode="BLEND" if color[3] < 1 else "OPAQUE", **surface)
        return

    def of(name: str, otherwise: Any) -> Any:
        value = getattr(material, name, None)
        return otherwise if value is None else value

    pictures = {name: of(theirs, None) for name, theirs in _TEXTURES.items()}
    look.add_material(
        base_color=_factors(of("baseColorFactor", None), (1.0, 1.0, 1.0, 1.0)),
        metallic=float(of("metallicFactor", 1.0)),
        roughness=float(of("roughnessFactor", 1.0)),
        emissive=_factors(of("emissiveFactor", None), (0.0, 0.0, 0.0)),
        alpha_mode=of("alphaMode", "OPAQUE"),
        alpha_cutoff=float(of("alphaCutoff", 0.5)),
        **{name: look.add_picture(picture) for name, picture in pictures.items() if picture is not None},
    )


def _add_trimesh_materials(visual: Any, faces: int, look: Appearance) -> npt.NDArray[np.uint32]:
    """Adds the materials of a TextureVisuals. Returns that of each face."""
    first = len(look.materials)
    material = getattr(visual, "material", None)
    several = getattr(material, "materials", None)
    for item in several if several is not None else [material]:
        _add_trimesh_material(item, look)
    numbers = getattr(visual, "face_materials", None) if several is not None else None
    if numbers is None:
        return np.full(faces, first, np.uint32)
    added = len(look.materials) - first
    of_faces = np.asarray(numbers, np.int64)
    if ((of_faces < 0) | (of_faces >= added)).any():
        raise Error(f"face_materials of trimesh must be from 0 to {added - 1}")
    return (of_faces + first).astype(np.uint32)


def _trimesh_look(mesh: Any) -> Appearance:
    look = Appearance()
    visual = getattr(mesh, "visual", None)
    kind = getattr(visual, "kind", None)
    if kind in ("vertex", "face"):
        look.set_colors(getattr(visual, f"{kind}_colors"), kind)
    elif kind == "texture":
        look.face_materials = _add_trimesh_materials(visual, len(mesh.faces), look)
    return look


def _trimesh_scene_look(scene: Any) -> Appearance:
    """The looks of all geometries, each at the corners of its faces."""
    look, uvs, colors, materials, kinds = Appearance(), [], [], [], set()
    for geometry, _, corners in scene_parts(scene):
        visual = getattr(geometry, "visual", None)
        kind, count = getattr(visual, "kind", None), len(corners)
        kinds.add(kind)
        own = np.full((count, 3, 2), np.nan)
        color = np.full((count, 3, 4), 255, np.uint8)
        if kind == "texture":
            materials.append(_add_trimesh_materials(visual, count, look))
            uv = getattr(visual, "uv", None)
            if uv is not None and np.shape(uv) == (len(geometry.vertices), 2):
                own = numpy_of(uv, "texture coordinates")[corners]
        else:
            materials.append(np.full(count, len(look.materials), np.uint32))
            look.add_material()
        if kind == "vertex":
            color = numpy_of(visual.vertex_colors, "vertex_colors")[corners]  # type: ignore[union-attr]
        elif kind == "face":
            color[:] = numpy_of(visual.face_colors, "face_colors")[:, None]  # type: ignore[union-attr]
        uvs.append(own)
        colors.append(color)
    if not kinds & {"texture", "vertex", "face"}:
        return Appearance()
    look.face_materials = np.concatenate(materials)
    look.uvs = np.concatenate(uvs)
    if kinds & {"vertex", "face"}:
        look.set_colors(np.concatenate(colors).reshape(-1, 4), "corner")
    return look


def _pyvista_colors(mesh: Any) -> Iterator[tuple[npt.NDArray[Any], str]]:
    """Arrays of bytes with three or four components, active ones first, then those whose names are those of colours."""
    found = []
    for domain, data in (("vertex", mesh.point_data), ("face", mesh.cell_data)):
        active = getattr(data, "active_scalars_name", None)
        for name in data.keys():
            array = np.asarray(data[name])
            is_color = array.dtype == np.uint8 and array.ndim == 2 and array.shape[1] in (3, 4)
            if is_color and (name == active or name.lower() in _COLOR_NAMES):
                found.append((name != active, name.lower(), array, domain))
    for _, _, array, domain in sorted(found, key=lambda item: item[:2]):
        yield array, domain


def _pyvista_look(mesh: Any) -> Appearance:
    look = Appearance()
    for colors, domain in _pyvista_colors(mesh):
        look.set_colors(colors, domain)
        break
    return look


def look_of(mesh: Any) -> tuple[Any, Appearance]:
    """A mesh whose faces are triangles, and what it looks like."""
    if hasattr(mesh, "geometry") and hasattr(mesh, "graph"):
        return mesh, _trimesh_scene_look(mesh)
    if hasattr(mesh, "points") and hasattr(mesh, "faces") and hasattr(mesh, "point_data"):
        mesh = triangulated(mesh)
        return mesh, _pyvista_look(mesh)
    return mesh, _trimesh_look(mesh)


def _with_one_uv_a_vertex(baked: "Baked") -> tuple[Any, Any, Any]:
    """Vertices, faces and texture coordinates; a vertex with several of these is several."""
    mesh = baked.mesh
    corners = np.column_stack([mesh.faces.reshape(-1), baked.corner_uvs.reshape(-1, 2)])
    rows, numbers = np.unique(corners, axis=0, return_inverse=True)
    return mesh.vertices[rows[:, 0].astype(np.int64)], numbers.reshape(-1, 3), rows[:, 1:]


def to_trimesh(baked: "Baked") -> Any:
    from PIL import Image
    from trimesh import Trimesh
    from trimesh.visual import TextureVisuals
    from trimesh.visual.material import PBRMaterial

    vertices, faces, uvs = _with_one_uv_a_vertex(baked)

    def picture(channel: str) -> Any:
        if channel not in baked.channels:
            return None
        pixels = baked.image(channel)
        return Image.fromarray(pixels[:, :, 0] if pixels.shape[2] == 1 else pixels)

    factors = baked.material
    material = PBRMaterial(
        baseColorFactor=None if "base_color" in baked.channels else np.array(factors["base_color"]),
        metallicFactor=1.0 if "metallic_roughness" in baked.channels else factors["metallic"],
        roughnessFactor=1.0 if "metallic_roughness" in baked.channels else factors["roughness"],
        emissiveFactor=np.ones(3) if "emissive" in baked.channels else np.array(factors["emissive"]),
        alphaMode=factors["alpha_mode"],
        alphaCutoff=factors["alpha_cutoff"],
        baseColorTexture=picture("base_color"),
        metallicRoughnessTexture=picture("metallic_roughness"),
        occlusionTexture=picture("occlusion" if "occlusion" in baked.channels else "ambient_occlusion"),
        emissiveTexture=picture("emissive"),
        normalTexture=picture("normal"),
    )
    return Trimesh(vertices, faces, visual=TextureVisuals(uv=uvs, material=material), process=False)


def to_pyvista(baked: "Baked") -> Any:
    import pyvista

    vertices, faces, uvs = _with_one_uv_a_vertex(baked)
    mesh = pyvista.PolyData(vertices, np.column_stack([np.full(len(faces), 3), faces]).ravel())
    mesh.active_texture_coordinates = uvs
    texture = pyvista.Texture(baked.image("base_color")) if "base_color" in baked.channels else None
    return mesh, texture
