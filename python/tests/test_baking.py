"""Textures of coarse meshes from detailed ones."""

import json
import struct
import zlib
from types import SimpleNamespace

import numpy as np
import pytest

import meshes
import sdm


def png(pixels):
    """A file of these pixels, by the format's definition."""
    height, width = pixels.shape[:2]
    rows = np.concatenate([np.zeros((height, 1), np.uint8), pixels.reshape(height, -1)], axis=1)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def linear(srgb):
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


@pytest.fixture(scope="module")
def square():
    """A unit square with texture coordinates, and a picture whose red grows to the right and green to the top."""
    vertices = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    mesh = sdm.Mesh(SimpleNamespace(vertices=vertices, triangles=faces, triangle_uvs=vertices[faces][:, :, :2].reshape(-1, 2)))
    x, y = np.meshgrid(np.arange(256), np.arange(256))
    return mesh, np.stack([x, 255 - y, np.full_like(x, 128)], -1).astype(np.uint8)


def test_a_texture_on_the_same_square_is_itself(square):
    mesh, picture = square
    baked = sdm.bake(mesh, mesh, texture=picture, resolution=256)
    assert baked.channels == ["base_color"] and baked.notes == []
    np.testing.assert_array_equal(baked.image("base_color"), picture)
    np.testing.assert_allclose(baked["base_color"], linear(picture / 255), atol=1e-5)
    assert baked["base_color"].dtype == np.float32 and baked.matched.all()
    np.testing.assert_allclose(baked.corner_uvs, mesh.corner_uvs, atol=1e-9)
    half = sdm.bake(mesh, mesh, texture=picture, resolution=128).image("base_color")
    means = linear(picture / 255.0).reshape(128, 2, 128, 2, 3).mean(axis=(1, 3))
    srgb = np.where(means <= 0.0031308, 12.92 * means, 1.055 * means ** (1 / 2.4) - 0.055)
    np.testing.assert_allclose(half, 255 * srgb, atol=1)


def test_texture_coordinates_as_arrays(square):
    mesh, picture = square
    bare = (mesh.vertices, mesh.faces)
    for uvs in (mesh.vertices[:, :2], mesh.corner_uvs):
        baked = sdm.bake(bare, mesh, texture=picture, uvs=uvs, resolution=256)
        np.testing.assert_array_equal(baked.image("base_color"), picture)
    grey = sdm.bake(bare, mesh, texture=picture[:, :, 0], uvs=mesh.corner_uvs, resolution=256).image("base_color")
    np.testing.assert_array_equal(grey, picture[:, :, [0, 0, 0]])


def test_colors_of_vertices(square):
    colors = np.tile(np.array([200, 100, 50, 255], np.uint8), (8, 1))
    for given in (colors, colors[:, :3], colors / 255):
        baked = sdm.bake(meshes.box(), meshes.box(), vertex_colors=given, resolution=64)
        assert (baked.image("base_color") == [200, 100, 50]).all()
    assert baked.notes == ["low: it has no UVs, so it got an atlas of charts"]
    assert baked.corner_uvs.shape == (12, 3, 2)


def test_files(tmp_path, square):
    mesh, picture = square
    (tmp_path / "picture.png").write_bytes(png(picture))
    (tmp_path / "high.mtl").write_text("newmtl m\nPr 0.5\nmap_Kd picture.png\nmap_Ke none.png\n")
    lines = ["mtllib high.mtl", "usemtl m"]
    lines += ["v {} {} {}".format(*v) for v in mesh.vertices]
    lines += [f"vt {u} {v}" for u, v in mesh.corner_uvs.reshape(-1, 2)]
    lines += [" ".join(["f", *(f"{v + 1}/{3 * i + k + 1}" for k, v in enumerate(f))]) for i, f in enumerate(mesh.faces)]
    (tmp_path / "high.obj").write_text("\n".join(lines))
    baked = sdm.bake(tmp_path / "high.obj", mesh, resolution=256)
    np.testing.assert_array_equal(baked.image("base_color"), picture)
    assert len(baked.notes) == 1 and "none.png" in baked.notes[0]
    both = sdm.bake(tmp_path / "high.obj", mesh, channels=["metallic_roughness", "occlusion"], resolution=32)
    assert both.channels == ["metallic_roughness", "occlusion"]
    np.testing.assert_allclose(both["metallic_roughness"][..., 0], 0.5)
    assert both.image("occlusion").shape == (32, 32, 1)

    baked.save(tmp_path / "low.glb")
    data = (tmp_path / "low.glb").read_bytes()
    size = struct.unpack("<I", data[12:16])[0]
    model = json.loads(data[20 : 20 + size])
    assert model["materials"][0]["pbrMetallicRoughness"]["roughnessFactor"] == 0.5
    again = sdm.bake(tmp_path / "low.glb", mesh, resolution=256)
    np.testing.assert_array_equal(again.image("base_color"), picture)


class Picture:
    """As of Pillow."""

    def __init__(self, pixels):
        self.pixels = pixels

    def convert(self, mode):
        assert mode == "RGB"
        return self.pixels


def test_meshes_of_trimesh_bring_their_looks(square):
    mesh, picture = square
    colors = np.tile(np.array([10, 20, 30, 255], np.uint8), (4, 1))
    form = SimpleNamespace(vertices=mesh.vertices, faces=mesh.faces)
    form.visual = SimpleNamespace(kind="vertex", vertex_colors=colors)
    assert (sdm.bake(form, mesh, resolution=64).image("base_color") == [10, 20, 30]).all()
    for material in (SimpleNamespace(image=Picture(picture)), SimpleNamespace(baseColorTexture=Picture(picture))):
        form.visual = SimpleNamespace(kind="texture", uv=mesh.vertices[:, :2], material=material)
        np.testing.assert_array_equal(sdm.bake(form, mesh, resolution=256).image("base_color"), picture)


def test_what_cannot_be_baked_is_an_error(tmp_path, square):
    mesh, picture = square
    with pytest.raises(sdm.Error, match="neither materials nor colours"):
        sdm.bake(mesh, mesh)
    with pytest.raises(sdm.Error, match="close enough"):
        sdm.bake(mesh, mesh.transformed(np.eye(4) + 9 * np.eye(4, k=3)), texture=picture, max_distance=0.5)
    with pytest.raises(sdm.Error, match="a row for each of 4 vertices, not 3"):
        sdm.bake(mesh, mesh, vertex_colors=np.zeros((3, 3)))
    with pytest.raises(sdm.Error, match="from 0 to 1"):
        sdm.bake(mesh, mesh, vertex_colors=np.full((4, 3), 200.0))
    with pytest.raises(sdm.Error, match="needs a mesh with texture coordinates"):
        sdm.bake(meshes.box(), mesh, texture=picture)
    with pytest.raises(sdm.Error, match=r"\(vertices, 2\) or \(faces, 3, 2\), not \(3, 2\)"):
        sdm.bake(meshes.box(), mesh, texture=picture, uvs=np.zeros((3, 2)))
    with pytest.raises(sdm.Error, match="not to a file"):
        sdm.bake(tmp_path / "none.obj", mesh, texture=picture)
    with pytest.raises(sdm.Error, match="uint8"):
        sdm.bake(mesh, mesh, texture=picture / 255)
    with pytest.raises(sdm.Error, match="not 'gloss'"):
        sdm.bake(mesh, mesh, texture=picture, channels=["gloss"])
    with pytest.raises(sdm.Error, match="no channel 'emissive'"):
        sdm.bake(mesh, mesh, texture=picture, resolution=32).image("emissive")
    with pytest.raises(sdm.Error, match="none.obj"):
        sdm.bake(tmp_path / "none.obj", mesh)
