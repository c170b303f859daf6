"""Textures of coarse meshes from detailed ones."""

import json
import pickle
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

    mode = "P"

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


def test_materials_of_trimesh(square):
    """Factors, alpha and several materials, in the form that trimesh has them."""
    mesh, picture = square
    form = SimpleNamespace(vertices=mesh.vertices, faces=mesh.faces)
    glass = SimpleNamespace(baseColorTexture=Picture(picture), baseColorFactor=np.array([255, 51, 255, 128], np.uint8),
                            alphaMode="BLEND", metallicFactor=0.0, roughnessFactor=0.25, emissiveFactor=[1, 0.5, 0])  # fmt: skip
    plain = SimpleNamespace(image=None, diffuse=np.array([188, 0, 255, 255], np.uint8))
    form.visual = SimpleNamespace(kind="texture", uv=mesh.vertices[:, :2], material=SimpleNamespace(materials=[glass, plain]),
                                  face_materials=np.array([0, 1]))  # fmt: skip
    baked = sdm.bake(form, mesh, resolution=256)
    assert baked.channels == ["base_color", "metallic_roughness", "emissive"] and baked.material["alpha_mode"] == "BLEND"
    color = baked["base_color"]
    assert color.shape == (256, 256, 4)
    lower, upper = color[192, 240], color[64, 16]  # of faces 0 and 1
    expected = linear(picture[192, 240] / 255) * [1, 0.2, 1]
    np.testing.assert_allclose(lower, [*expected, 128 / 255], atol=1e-3)
    np.testing.assert_allclose(upper, [linear(188 / 255), 0, 1, 1], atol=1e-6)
    np.testing.assert_allclose(baked["metallic_roughness"][192, 240], [0.25, 0], atol=1e-6)
    np.testing.assert_allclose(baked["emissive"][192, 240], [1, 0.5, 0], atol=1e-6)


def test_colors_of_faces_and_alpha(square):
    mesh, _ = square
    colors = np.array([[255, 0, 0, 255], [0, 255, 0, 51]], np.uint8)
    form = SimpleNamespace(vertices=mesh.vertices, faces=mesh.faces, visual=SimpleNamespace(kind="face", face_colors=colors))
    for baked in (sdm.bake(form, mesh, resolution=64), sdm.bake(mesh, mesh, face_colors=colors, resolution=64)):
        image = baked.image("base_color")
        assert image[48, 60].tolist() == [255, 0, 0, 255] and image[16, 4].tolist() == [0, 255, 0, 51]
        assert baked.material["alpha_mode"] == "BLEND"
    opaque = sdm.bake(mesh, mesh, face_colors=colors[:, :3], resolution=64)
    assert opaque.image("base_color").shape == (64, 64, 3) and opaque.material["alpha_mode"] == "OPAQUE"


def test_scenes_of_trimesh_bring_their_looks(square):
    """Two squares beside each other, one with a picture, one with colours, which a mirror turns."""
    mesh, picture = square
    textured = SimpleNamespace(vertices=mesh.vertices, faces=mesh.faces)
    material = SimpleNamespace(image=Picture(picture), diffuse=[255, 255, 255, 255])
    textured.visual = SimpleNamespace(kind="texture", uv=mesh.vertices[:, :2], material=material)
    colored = SimpleNamespace(vertices=mesh.vertices, faces=mesh.faces)
    colored.visual = SimpleNamespace(kind="vertex", vertex_colors=np.tile(np.array([9, 99, 199, 255], np.uint8), (4, 1)))
    places = {"a": (np.eye(4), "textured"), "b": (np.diag([-1.0, 1, 1, 1]), "colored")}
    graph = SimpleNamespace(nodes_geometry=["a", "b"], get=places.get)
    scene = SimpleNamespace(graph=graph, geometry={"textured": textured, "colored": colored})
    wide = mesh.vertices * [2, 1, 1] - [1, 0, 0]
    low = SimpleNamespace(vertices=wide, triangles=mesh.faces, triangle_uvs=mesh.corner_uvs.reshape(-1, 2))
    image = sdm.bake(scene, low, resolution=512).image("base_color")
    assert (image[:, :254] == [9, 99, 199]).all()
    # At its borders the picture repeats.
    np.testing.assert_allclose(image[4:508:2, 258:510].astype(int), picture[2:254, 2:254].astype(int), atol=2)


def test_scenes_without_looks_and_wrong_materials_are_refused(square):
    mesh, picture = square
    form = SimpleNamespace(vertices=mesh.vertices, faces=mesh.faces, visual=SimpleNamespace(kind=None))
    graph = SimpleNamespace(nodes_geometry=["a"], get={"a": (np.eye(4), "form")}.get)
    with pytest.raises(sdm.Error, match="nothing to bake"):
        sdm.bake(SimpleNamespace(graph=graph, geometry={"form": form}), mesh, resolution=64)
    empty = SimpleNamespace(nodes_geometry=[], get={}.get)
    with pytest.raises(sdm.Error, match="the scene of trimesh has no triangles"):
        sdm.bake(SimpleNamespace(graph=empty, geometry={}), mesh, resolution=64)
    red = SimpleNamespace(image=None, diffuse=[255, 0, 0, 255])
    several = SimpleNamespace(materials=[red, red])
    form.visual = SimpleNamespace(kind="texture", uv=mesh.vertices[:, :2], material=several, face_materials=[0, 1])
    assert sdm.bake(form, mesh, resolution=64).image("base_color")[48, 60].tolist() == [255, 0, 0]
    form.visual.face_materials = [0, -1]
    with pytest.raises(sdm.Error, match="face_materials of trimesh must be from 0 to 1"):
        sdm.bake(form, mesh, resolution=64)
    red.diffuse = [2.5, 0, 0]
    with pytest.raises(sdm.Error, match="from 0 to 1"):
        sdm.bake(form, mesh, resolution=64)


class Data(dict):
    """As the arrays of points or cells of pyvista."""

    active_scalars_name = None


def test_meshes_of_pyvista_bring_their_colors(square):
    mesh, _ = square
    faces = np.insert(mesh.faces, 0, 3, axis=1).ravel()
    colors = np.tile(np.array([10, 200, 30], np.uint8), (4, 1))
    other = np.tile(np.array([1, 2, 3], np.uint8), (4, 1))
    for points, cells, active, expected in (
        ({"RGB": colors, "normals": other}, {}, None, [10, 200, 30]),
        ({"paint": other, "RGB": colors}, {}, "paint", [1, 2, 3]),
        ({"Normals": other.astype(float)}, {"colors": colors[:2]}, None, [10, 200, 30]),
    ):
        form = SimpleNamespace(points=mesh.vertices, faces=faces, point_data=Data(points), cell_data=Data(cells))
        form.point_data.active_scalars_name = active
        assert (sdm.bake(form, mesh, resolution=64).image("base_color") == expected).all()
    form = SimpleNamespace(points=mesh.vertices, faces=faces, point_data=Data(), cell_data=Data(temperature=np.zeros(2)))
    with pytest.raises(sdm.Error, match="neither materials nor colours"):
        sdm.bake(form, mesh, resolution=64)


def test_trimesh_there_and_back(square):
    trimesh = pytest.importorskip("trimesh")
    image_of = pytest.importorskip("PIL.Image").fromarray
    mesh, picture = square
    material = trimesh.visual.material.PBRMaterial(
        baseColorTexture=image_of(picture), metallicFactor=0.25, roughnessFactor=0.5, emissiveFactor=[0, 0, 0]
    )
    visual = trimesh.visual.TextureVisuals(uv=mesh.vertices[:, :2], material=material)
    high = trimesh.Trimesh(mesh.vertices, mesh.faces, visual=visual, process=False)
    for given in (high, trimesh.Scene([high])):
        baked = sdm.bake(given, mesh, resolution=256)
        np.testing.assert_array_equal(baked.image("base_color"), picture)
        low = baked.to_trimesh()
        np.testing.assert_allclose(low.triangles, mesh.vertices[mesh.faces])
        np.testing.assert_array_equal(np.asarray(low.visual.material.baseColorTexture), picture)
        assert low.visual.material.metallicFactor == 0.25 and low.visual.material.roughnessFactor == 0.5
        np.testing.assert_array_equal(sdm.bake(low, mesh, resolution=256).image("base_color"), picture)
    box = trimesh.creation.box()
    box.visual.face_colors = np.tile([10, 20, 30, 255], (12, 1))
    assert (sdm.bake(box, box, resolution=64).image("base_color") == [10, 20, 30]).all()
    box.visual = trimesh.visual.ColorVisuals(box, vertex_colors=np.tile([30, 20, 10, 255], (8, 1)))
    baked = sdm.bake(box, box, resolution=64)
    assert (baked.image("base_color") == [30, 20, 10]).all()
    assert baked.to_trimesh().area == pytest.approx(6)  # on an atlas: vertices are divided
    assert len(baked.to_trimesh().export(file_type="glb")) > 1000


def test_pyvista_there_and_back(square):
    pyvista = pytest.importorskip("pyvista")
    mesh, picture = square
    high = pyvista.PolyData(mesh.vertices, np.insert(mesh.faces, 0, 3, axis=1).ravel())
    high.active_texture_coordinates = mesh.vertices[:, :2]
    baked = sdm.bake(high, mesh, texture=pyvista.Texture(picture), resolution=256)
    np.testing.assert_array_equal(baked.image("base_color"), picture)
    low, texture = baked.to_pyvista()
    np.testing.assert_array_equal(sdm.bake(low, mesh, texture=texture, resolution=256).image("base_color"), picture)
    cube = pyvista.Cube()  # of squares
    cube.cell_data["RGB"] = np.tile(np.array([10, 20, 30], np.uint8), (6, 1))
    assert (sdm.bake(cube, cube, resolution=64).image("base_color") == [10, 20, 30]).all()
    ball = pyvista.Sphere()
    ball.point_data["RGBA"] = np.tile(np.array([10, 20, 30, 255], np.uint8), (ball.n_points, 1))
    assert (sdm.bake(ball, ball, resolution=64).image("base_color") == [10, 20, 30]).all()


def test_matching():
    """Two plates, 0.02 apart, back to back, in two colours; the coarse one, off by more than that."""
    x, y = np.meshgrid(np.linspace(-1, 1, 9), np.linspace(-1, 1, 9))
    grid = np.arange(81).reshape(9, 9)
    a, b, c, d = (g.ravel() for g in (grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]))
    up = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    plate = np.stack([x.ravel(), y.ravel(), np.zeros(81)], axis=1)
    high = (np.concatenate([plate + [0, 0, 0.01], plate - [0, 0, 0.01]]), np.concatenate([up, up[:, ::-1] + 81]))
    colors = np.repeat(np.array([[255, 0, 0], [0, 0, 255]], np.uint8), 81, axis=0)
    low = (plate - [0, 0, 0.05], up)  # below both, facing up

    def share_of_red(**options):
        baked = sdm.bake(high, low, vertex_colors=colors, resolution=64, **options)
        kinds = set(np.unique(baked.kind[baked.matched == 1]))
        return (baked.image("base_color")[baked.matched == 1, 0] == 255).mean(), kinds

    assert share_of_red() == (0, {sdm.MatchKind.CLOSEST}) == share_of_red(match="closest")
    assert share_of_red(facing=60) == (1, {sdm.MatchKind.FACING}) == share_of_red(match="facing")
    assert share_of_red(match="ray") == (1, {sdm.MatchKind.RAY}) == share_of_red(match="ray", cage=0.1, facing=45)
    assert share_of_red(match="ray", cage=0.03) == (1, {sdm.MatchKind.FACING})
    for options, fault in (({"match": "nearest"}, "match is 'nearest': it must be closest, facing or ray"), ({"cage": 1}, "cage applies to"),
                           ({"match": "closest", "facing": 90}, "facing does not apply"), ({"match": "ray", "cage": -1}, "cage"),
                           ({"channels": []}, "channels is .*: it must be one or more of")):  # fmt: skip
        with pytest.raises(sdm.Error, match=fault):
            share_of_red(**options)


@pytest.mark.skipif(not sdm.has_tangents(), reason="without MikkTSpace")
def test_normals(tmp_path):
    high, low = meshes.sphere(steps=5), meshes.sphere(steps=2)
    baked = sdm.bake(high, low, channels=["normal"], match="ray", resolution=256)
    assert baked.channels == ["normal"] and baked.notes == ["low: it has no UVs, so it got an atlas of charts"]
    matches = sdm.match(sdm.Mesh(low), sdm.Mesh(high), method="ray", resolution=256)
    expected = matches.tangent_normals(of="smooth", normals=40.0, fill=False)
    known = np.isfinite(expected[..., 0])
    np.testing.assert_allclose(baked["normal"][known], expected[known], atol=1e-6)
    np.testing.assert_allclose(baked.image("normal")[known] / 255, (expected[known] + 1) / 2, atol=0.51 / 255)
    baked.save(tmp_path / "ball.glb")
    data = (tmp_path / "ball.glb").read_bytes()
    model = json.loads(data[20 : 20 + struct.unpack("<I", data[12:16])[0]])
    again = pickle.loads(pickle.dumps(baked))
    np.testing.assert_array_equal(again["normal"], baked["normal"])
    np.testing.assert_array_equal(again.kind, baked.kind)
    again.save(tmp_path / "again.glb")
    assert (tmp_path / "again.glb").read_bytes() == data
    assert "TANGENT" in model["meshes"][0]["primitives"][0]["attributes"] and "normalTexture" in model["materials"][0]
    colored = sdm.bake(high, low, vertex_colors=np.full((len(high[0]), 3), 0.5), channels=["normal", "base_color"], resolution=64)
    assert colored.channels == ["base_color", "normal"]


def texel_centres(resolution):
    """x and y of the texels of the unit square."""
    centres = (np.arange(resolution) + 0.5) / resolution
    return np.meshgrid(centres, centres[::-1])


GEOMETRY = ["object_normal", "displacement", "position", "ambient_occlusion", "face"]


def test_the_shape_of_a_plate_above_a_plate(square):
    """A plate with the height 0.25 + 0.5 x above a square."""
    mesh, _ = square
    high = (mesh.vertices + mesh.vertices[:, :1] * [0, 0, 0.5] + [0, 0, 0.25], mesh.faces)
    baked = sdm.bake(high, mesh, channels=[*GEOMETRY[::-1]], match="ray", resolution=64)
    assert baked.channels == GEOMETRY and baked.matched.all() and (baked.coverage == 1).all()
    assert repr(baked) == "sdm.Baked(object_normal, displacement, position, ambient_occlusion, face, 64 x 64)"
    x, y = texel_centres(64)
    height = 0.25 + 0.5 * x
    np.testing.assert_allclose(baked["displacement"], height, atol=1e-6)
    np.testing.assert_allclose(baked["position"], np.stack([x, y, height], -1), atol=1e-6)
    np.testing.assert_allclose(baked["object_normal"], np.broadcast_to([-0.2**0.5, 0, 0.8**0.5], (64, 64, 3)), atol=1e-6)
    assert (baked["ambient_occlusion"] == 1).all()
    off = x != y
    np.testing.assert_array_equal(baked["face"][off], (y > x)[off])
    for channel in GEOMETRY:
        assert baked[channel].dtype == (np.uint32 if channel == "face" else np.float32)
    np.testing.assert_allclose(baked.image("object_normal")[..., 0], 127.5 - 127.5 * 0.2**0.5, atol=0.51)
    with pytest.raises(sdm.Error, match="'displacement' is no picture"):
        baked.image("displacement")


def test_texels_without_a_point_have_no_shape(square):
    mesh, _ = square
    high = (mesh.vertices + mesh.vertices[:, :1] * [0, 0, 0.5] + [0, 0, 0.25], mesh.faces)
    baked = sdm.bake(high, mesh, channels=GEOMETRY, max_distance=0.4, resolution=64)
    found = baked.matched == 1
    assert 0.2 < found.mean() < 0.8 and (baked.kind[~found] == sdm.MatchKind.TOO_FAR).all()
    for channel in GEOMETRY[:-1]:
        assert (np.isfinite(baked[channel]) == (found if baked[channel].ndim == 2 else found[..., None])).all()
    np.testing.assert_array_equal(baked["face"] == sdm.NONE, ~found)
    assert (baked.image("ambient_occlusion") == 255).all()  # pictures have no gaps


def test_the_shape_is_that_of_matches():
    high, low = meshes.sphere(radius=1.1, steps=4), meshes.sphere(steps=2)
    baked = sdm.bake(high, low, channels=[*GEOMETRY, "thickness"], facing=60, occlusion_rays=16, resolution=128)
    matches = sdm.match(low, high, facing=60, resolution=128)
    expected = {
        "object_normal": matches.normals(fill=False),
        "displacement": matches.displacements(fill=False),
        "position": matches.positions(fill=False),
        "ambient_occlusion": matches.ambient_occlusion(16, fill=False),
        "face": matches.face,
        "thickness": matches.thickness(fill=False),
    }
    for channel, values in expected.items():
        np.testing.assert_array_equal(baked[channel], values, err_msg=channel)


def under_a_rectangle(x, y, height):
    """The share of light that the unit square at a height keeps from points below it, by the form factor of its corners."""

    def corner(a, b):
        a, b = a / height, b / height
        p, q = np.sqrt(1 + a * a), np.sqrt(1 + b * b)
        return (a / p * np.arctan(b / p) + b / q * np.arctan(a / q)) / (2 * np.pi)

    return corner(x, y) + corner(1 - x, y) + corner(x, 1 - y) + corner(1 - x, 1 - y)


def test_ambient_occlusion_under_a_ceiling(tmp_path, square):
    mesh, picture = square
    high = (np.concatenate([mesh.vertices, mesh.vertices + [0, 0, 0.5]]), np.concatenate([mesh.faces, mesh.faces + 4]))
    options = {"channels": ["ambient_occlusion"], "resolution": 32}
    baked = sdm.bake(high, mesh, **options, occlusion_rays=1024)
    expected = 1 - under_a_rectangle(*texel_centres(32), 0.5)
    assert expected.min() < 0.6 and expected.max() > 0.7
    np.testing.assert_allclose(baked["ambient_occlusion"], expected, atol=5 * 0.5 / 32)  # five deviations of 1024 rays
    assert (sdm.bake(high, mesh, **options, occlusion_distance=0.45)["ambient_occlusion"] == 1).all()

    image = baked.image("ambient_occlusion")
    np.testing.assert_allclose(image[..., 0] / 255, baked["ambient_occlusion"], atol=0.51 / 255)
    baked.save(tmp_path / "low.glb")
    again = sdm.bake(tmp_path / "low.glb", mesh, channels=["occlusion"], resolution=32)
    np.testing.assert_allclose(again["occlusion"], image / 255, atol=1e-5)
    both = sdm.bake(mesh, mesh, texture=picture, channels=["ambient_occlusion", "occlusion"], resolution=32)
    assert both.channels == ["occlusion", "ambient_occlusion"]
    both.save(tmp_path / "both.glb")
    assert (tmp_path / "both.glb").read_bytes().count(b"\x89PNG") == 1


def test_thickness_of_a_wedge(square):
    """A slab whose lower side rises: the ball between two planes. Its sides, at right angles, do not stop balls."""
    mesh, _ = square
    vertices, faces = meshes.box(high=(1, 1, 0.3))
    vertices[:, 2] = np.where(vertices[:, 2] == 0, 0.15 * vertices[:, 0], 0.3)
    up = np.eye(4)
    up[2, 3] = 0.3
    baked = sdm.bake((vertices, faces), mesh.transformed(up), channels=["thickness"], resolution=64)
    x, _ = texel_centres(64)
    cosine = 1 / np.hypot(1, 0.15)
    expected = 2 * (0.3 - 0.15 * x) * cosine / (1 + cosine)
    inner = np.s_[:, 4:-4]  # beyond them, the ball touches an edge
    np.testing.assert_allclose(baked["thickness"][inner], expected[inner], atol=1e-6)
    with pytest.raises(sdm.Error, match="a mesh that is open has no thickness"):
        sdm.bake(mesh, mesh, channels=["thickness"], resolution=64)


def test_materials_as_numbers(tmp_path, square):
    mesh, _ = square
    (tmp_path / "high.mtl").write_text("newmtl wood\nKd 1 0 0\nnewmtl steel\nKd 0 0 1\n")
    lines = ["mtllib high.mtl", *("v {} {} {}".format(*v) for v in mesh.vertices)]
    lines += ["usemtl steel", "f 1 2 3", "usemtl wood", "f 1 3 4"]
    (tmp_path / "high.obj").write_text("\n".join(lines))
    baked = sdm.bake(tmp_path / "high.obj", mesh, channels=["material"], resolution=64)
    x, y = texel_centres(64)
    names = np.array(baked.material_names)
    assert sorted(names) == ["steel", "wood"]
    np.testing.assert_array_equal(names[baked["material"]][x != y], np.where(y > x, "wood", "steel")[x != y])
    with pytest.raises(sdm.Error, match="no materials"):
        sdm.bake(mesh, mesh, channels=["material"])


def mean_of_squares(values, found, side):
    """Of the texels that are found among side · side, NaN where there are none."""
    rows, columns, components = values.shape
    shape = (rows // side, side, columns // side, side, components)
    weights = np.broadcast_to(found[..., None], values.shape).reshape(shape)
    with np.errstate(invalid="ignore"):
        return np.where(weights, values.reshape(shape), 0).sum(axis=(1, 3), dtype=float) / weights.sum(axis=(1, 3))


def test_samples_are_texels_of_a_finer_texture(square):
    """Onto a triangle, in whose texture are texels that it owns in part."""
    vertices, faces = meshes.sphere(center=(0.4, 0.4, -0.8), steps=4)
    colors = np.random.default_rng(1).integers(0, 256, (len(vertices), 3), np.uint8)
    corners = np.array([[0, 0, 0], [0.9, 0.1, 0], [0.2, 0.8, 0]])
    low = SimpleNamespace(vertices=corners, triangles=np.array([[0, 1, 2]]), triangle_uvs=corners[:, :2])
    channels = ["base_color", "object_normal", "displacement", "position", "face"]
    options = {"vertex_colors": colors, "channels": channels, "max_distance": 0.15}
    fine = sdm.bake((vertices, faces), low, resolution=128, **options)
    baked = sdm.bake((vertices, faces), low, resolution=32, samples=16, **options)
    found = fine.matched == 1
    share = found.reshape(32, 4, 32, 4).mean(axis=(1, 3))
    np.testing.assert_allclose(baked.coverage, share)
    np.testing.assert_array_equal(baked.matched, share > 0)
    assert ((share > 0) & (share < 1)).sum() > 30 and (share == 1).sum() > 30
    own = share > 0
    for channel in channels[:-1]:
        expected = mean_of_squares(fine[channel].reshape(128, 128, -1), found, 4)
        if channel == "object_normal":
            expected /= np.linalg.norm(expected, axis=2, keepdims=True)
        values = baked[channel].reshape(32, 32, -1)
        np.testing.assert_allclose(values[own], expected[own], atol=2e-6, err_msg=channel)
        assert np.isfinite(values[~own]).all() == (channel == "base_color")
    of_texels = fine["face"].reshape(32, 4, 32, 4).swapaxes(1, 2).reshape(32, 32, 16)
    for row, column in np.argwhere(own):
        numbers, counts = np.unique(of_texels[row, column][of_texels[row, column] != sdm.NONE], return_counts=True)
        assert baked["face"][row, column] == numbers[counts.argmax()]
    assert (baked["face"][~own] == sdm.NONE).all()
    assert set(np.unique(baked.kind)) == {sdm.MatchKind.NONE, sdm.MatchKind.CLOSEST, sdm.MatchKind.TOO_FAR}
    assert (baked.kind[own] == sdm.MatchKind.CLOSEST).all()
    np.testing.assert_allclose(baked.corner_uvs[0], corners[:, :2], atol=1e-9)


def test_samples_that_cannot_be(square):
    mesh, _ = square
    options = {"channels": ["face"]}
    for samples in (0, -1, 5, 81):
        with pytest.raises(sdm.Error, match=f"samples is {samples}: it must be a whole number from 1 to 64 that is a square"):
            sdm.bake(mesh, mesh, samples=samples, **options)
    with pytest.raises(sdm.Error, match="64 samples a texel are more than 32768 along a side"):
        sdm.bake(mesh, mesh, resolution=8192, samples=64, **options)
    with pytest.raises(sdm.Error, match="resolution is 8: it must be a whole number from 16"):
        sdm.bake(mesh, mesh, resolution=8, samples=4, **options)
    with pytest.raises(sdm.Error, match="rays"):
        sdm.bake(mesh, mesh, channels=["ambient_occlusion"], occlusion_rays=0)


def test_bakes_of_shapes_are_kept(tmp_path):
    high, low = meshes.sphere(radius=1.1, steps=3), meshes.sphere(steps=2)
    colors = np.full((len(high[0]), 3), 0.5)
    channels = ["base_color", *GEOMETRY, "thickness", *(["normal"] if sdm.has_tangents() else [])]
    baked = sdm.bake(high, low, vertex_colors=colors, channels=channels, samples=4, gutter=3, resolution=128)
    again = pickle.loads(pickle.dumps(baked))
    assert again.channels == baked.channels and set(baked.channels) == set(channels)
    for channel in channels:
        assert again[channel].dtype == baked[channel].dtype
        np.testing.assert_array_equal(again[channel], baked[channel])
    np.testing.assert_array_equal(again.coverage, baked.coverage)
    baked.save(tmp_path / "a.glb"), again.save(tmp_path / "b.glb")
    assert (tmp_path / "a.glb").read_bytes() == (tmp_path / "b.glb").read_bytes()


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
    with pytest.raises(sdm.Error, match="channels is .*gloss.*: it must be one or more of base_color"):
        sdm.bake(mesh, mesh, texture=picture, channels=["gloss"])
    with pytest.raises(sdm.Error, match="no channel 'emissive'"):
        sdm.bake(mesh, mesh, texture=picture, resolution=32).image("emissive")
    with pytest.raises(sdm.Error, match="none.obj"):
        sdm.bake(tmp_path / "none.obj", mesh)
