"""Arguments that are not what they look like: names with a NUL, numbers with a fraction, masks; and maps that are not square."""

import decimal
import fractions
import os
import struct

import numpy as np
import pytest

import meshes
import sdm

NUL_NAMES = ["a\0b.{}", "\0.{}", "a.{}\0", "a.{}\0.{}"]


@pytest.fixture(scope="module")
def small_map():
    return sdm.map(meshes.box(), meshes.sphere(), resolution=64)


def with_nul(folder, suffix):
    for name in NUL_NAMES:
        text = os.path.join(folder, name.format(suffix, suffix))
        yield from (text, text.encode())


@pytest.mark.parametrize("suffix", ["exr", "png", "glb", "html", "ply", "csv", "npy", "vtp"])
def test_maps_are_not_saved_to_names_with_a_nul(small_map, tmp_path, suffix):
    for name in with_nul(tmp_path, suffix):
        with pytest.raises(sdm.Error):
            small_map.save(name)
    assert list(tmp_path.iterdir()) == []


def test_files_with_a_nul_in_their_name_are_refused(tmp_path):
    mesh, cloud = tmp_path / "m.obj", tmp_path / "c.xyz"
    mesh.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
    cloud.write_text("0 0 0\n1 1 1\n")
    field = sdm.distance_field(meshes.box(), spacing=0.5)
    nul = str(mesh) + "\0x"
    for call in (
        lambda: sdm.read(nul),
        lambda: sdm.Mesh(nul),
        lambda: sdm.Surface(nul, resolution=64),
        lambda: sdm.map(nul, meshes.box(), resolution=64),
        lambda: sdm.read_points(str(cloud) + "\0x"),
        lambda: sdm.measure_points(str(cloud) + "\0x", meshes.box(), tmp_path / "p.ply"),
        lambda: sdm.measure_points(cloud, meshes.box(), str(tmp_path / "p.ply") + "\0"),
        lambda: sdm.scene("bunnies", mesh=nul),
        lambda: field.save(str(tmp_path / "f.npy") + "\0.vti"),
    ):
        with pytest.raises(sdm.Error, match="NUL"):
            call()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["c.xyz", "m.obj"]


def test_names_are_text_bytes_or_paths(tmp_path):
    mesh = tmp_path / "\u00fcber.obj"
    mesh.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    for name in (mesh, str(mesh), os.fsencode(mesh)):
        assert len(sdm.read(name).faces) == 1
    for name in (None, 3, 1.5):
        with pytest.raises(TypeError):
            sdm.read(name)


FLOATS = [32.5, 32.0, np.float32(32.5), np.float64(32), np.float16(32), fractions.Fraction(65, 2), decimal.Decimal(32),
          "32", np.array([32.0]), np.array([32, 64])]  # fmt: skip


@pytest.mark.parametrize("value", FLOATS, ids=repr)
def test_only_integers_are_integers(small_map, tmp_path, value):
    box, sphere = meshes.box(), meshes.sphere()
    query = sdm.MultiBodyQuery([box, sphere])
    for call in (
        lambda: sdm.Surface(box, resolution=value),
        lambda: sdm.Surface(box, resolution=64, gutter=value),
        lambda: sdm.Surface(box, resolution=(value, 64)),
        lambda: sdm.map(box, sphere, resolution=value),
        lambda: sdm.map(box, sphere, resolution=64, gutter=value),
        lambda: sdm.self_map(box, resolution=value),
        lambda: sdm.self_map(box, rings=value, resolution=64),
        lambda: sdm.Shape(box, resolution=value),
        lambda: sdm.SelfProximityQuery(box, rings=value),
        lambda: sdm.align(sphere, sphere, samples=value),
        lambda: sdm.align(sphere, sphere, max_iterations=value),
        lambda: sdm.make_scan("no such file", triangles=value),
        lambda: small_map.ambient_occlusion(value),
        lambda: small_map.ambient_occlusion(4, seed=value),
        lambda: small_map.save(tmp_path / "m.png", size=value),
        lambda: query.pose(value),
    ):
        with pytest.raises(TypeError):
            call()


@pytest.mark.parametrize("kind", [int, np.int8, np.uint8, np.int64, np.uint64])
def test_integers_of_numpy_are_integers(kind):
    box = meshes.box()
    assert sdm.Surface(box, resolution=kind(32), gutter=kind(2)).resolution == 32
    assert sdm.map(box, box, resolution=np.array(kind(32))).distance.shape == (32, 32)
    for value in (-1, 2**40, 2**80):
        with pytest.raises(sdm.Error, match="resolution"):
            sdm.Surface(box, resolution=value)


@pytest.mark.parametrize("value", ["0.1", None, [0.1], 1j])
def test_text_is_no_number(small_map, value):
    if value is not None:
        with pytest.raises(TypeError):
            sdm.Surface(meshes.box(), precision=value)
    if not isinstance(value, list):
        with pytest.raises(TypeError):
            small_map.check(value)


@pytest.mark.parametrize("value", [None, "abc", b"abc", {}, {1, 2}, (row for row in [[0, 0, 0]])], ids=lambda v: type(v).__name__)
def test_what_is_no_array_is_named(value):
    sites = sdm.Sites(*meshes.box())
    for call in (sites.closest_points, sites.contains, sites.refit):
        with pytest.raises(sdm.Error, match=f"must be an array of numbers, not {type(value).__name__}$"):
            call(value)


def test_rows_of_different_lengths_are_named_in_one_sentence():
    vertices, faces = meshes.box()
    for call in (
        lambda: sdm.Sites(vertices, faces).closest_points([[0, 0, 0], [1, 2]]),
        lambda: sdm.Sites(vertices, [[0, 1, 2], [0, 1]]),
    ):
        with pytest.raises(sdm.Error, match="must be an array of numbers, with as many in each row$"):
            call()


def test_integers_out_of_range_have_a_range():
    with pytest.raises(sdm.Error, match="triangles is 0: it must be a whole number of at least 1$"):
        sdm.simplify(meshes.sphere(), triangles=0)


def masked(array, kind=float):
    array = np.ma.array(array, kind)
    array[1] = np.ma.masked
    return array


def test_masked_values_are_refused():
    vertices, faces = meshes.box()
    sites, query = sdm.Sites(vertices, faces), sdm.ProximityQuery(meshes.box(), meshes.sphere())
    surface = sdm.Surface(vertices, faces, resolution=64)
    pose = masked(np.eye(4))
    uvs = np.zeros((len(faces), 3, 2))
    for call in (
        lambda: sdm.Mesh(masked(vertices), faces),
        lambda: sdm.Mesh(masked(vertices, np.float32), faces),
        lambda: sdm.Mesh(list(masked(vertices)), faces),
        lambda: sdm.Mesh(vertices, masked(faces, np.uint32)),
        lambda: sdm.Mesh(vertices, masked(faces, np.int64)),
        lambda: sdm.map((masked(vertices), faces), meshes.box(), resolution=64),
        lambda: sites.closest_points(masked(vertices)),
        lambda: sdm.closest_points(vertices, faces, masked(vertices)),
        lambda: sites.refit(masked(vertices)),
        lambda: surface.refit(masked(vertices)),
        lambda: sites.edit(removed_faces=masked([0, 1], np.uint32)),
        lambda: query.refit(masked(vertices), None),
        lambda: query.set_pose(0, pose),
        lambda: sdm.map(meshes.box(), meshes.sphere(), resolution=64, transform=pose),
        lambda: sdm.align_points(masked(vertices), meshes.box()),
    ):
        with pytest.raises(sdm.Error, match="masked"):
            call()
    np.testing.assert_array_equal(sites.vertices, vertices)
    whole = np.ma.array(vertices)  # without a masked value
    np.testing.assert_array_equal(sdm.Mesh(whole, np.ma.array(faces)).vertices, vertices)
    np.testing.assert_array_equal(sites.closest_points(whole).distance, 0)

    class WithUvs:
        def __init__(self, corners):
            self.vertices, self.triangles, self.triangle_uvs = vertices, faces, corners

    with pytest.raises(sdm.Error, match="masked"):
        sdm.Mesh(WithUvs(masked(uvs.reshape(-1, 2))))


def grid_with_uvs(n=6):
    """A square of n × n cells with texture coordinates, in the form of open3d."""

    class Textured:
        pass

    mesh = Textured()
    x, y = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1), indexing="ij")
    flat = np.stack([x.ravel(), y.ravel()], axis=1)
    mesh.vertices = np.column_stack([2 * flat[:, 0], flat[:, 1], 0.1 * flat[:, 0] ** 2])
    corner = lambda i, j: i * (n + 1) + j  # noqa: E731
    mesh.triangles = np.array(
        [t for i in range(n) for j in range(n)
         for t in ((corner(i, j), corner(i + 1, j), corner(i + 1, j + 1)), (corner(i, j), corner(i + 1, j + 1), corner(i, j + 1)))]
    )  # fmt: skip
    mesh.triangle_uvs = (0.05 + 0.9 * flat)[mesh.triangles.ravel()]
    return mesh


def check_every_use(distance_map, rows, columns, folder):
    """Every call that takes or returns an array of texels."""
    m = distance_map
    for array in (m.distance, m.face, m.site, m.site_type, m.valid, m.free_distances(), m.ambient_occlusion(2)):
        assert array.shape == (rows, columns)
    for array in (m.vector, m.position, m.normal):
        assert array.shape == (rows, columns, 3)
    assert m.surface.texel_faces.shape == (rows, columns) == (m.surface.rows, m.surface.resolution)
    # The values belong to their texels: distances are those of the positions.
    texels = np.argwhere(m.valid)
    found = m.sites.closest_points(m.position[m.valid])
    np.testing.assert_allclose(np.abs(m.distance[m.valid]), found.distance, rtol=1e-5, atol=1e-6)
    assert texels[:, 0].max() < rows and texels[:, 1].max() < columns
    assert m.report()["atlas"]["resolution"] == columns and m.report()["atlas"]["rows"] == rows
    assert f"{columns} × {rows}" in repr(m) and f"{columns} × {rows}" in repr(m.surface)
    assert f"{columns} × {rows}" in m._repr_html_()
    assert m.bounds.lower <= m.statistics().min and m.check(100).verdict == "pass"
    assert m.hausdorff().upper >= m.statistics().max_abs
    for suffix in ("exr", "png", "glb", "ply", "csv", "npy", "vtp") + (("html",) if sdm._core.can_write_html() else ()):
        m.save(folder / f"m.{suffix}")
        assert (folder / f"m.{suffix}").stat().st_size > 0
    width, height = struct.unpack(">II", (folder / "m.png").read_bytes()[16:24])
    assert width > columns and height >= rows
    header = (folder / "m.exr").read_bytes()[:4000]
    window = header.index(b"dataWindow\0box2i\0") + 17 + 4
    assert struct.unpack("<4i", header[window : window + 16]) == (0, 0, columns - 1, rows - 1)
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    for kind in ("surface", "atlas"):
        m.plot(kind=kind).figure.canvas.draw()
    matplotlib.pyplot.close("all")


@pytest.mark.parametrize("columns, rows", [(96, 32), (32, 80), (48, 48)])
def test_maps_that_are_not_square(tmp_path, columns, rows):
    mesh = grid_with_uvs()
    m = sdm.map(mesh, meshes.sphere((1, 0.5, 1), 0.4), resolution=(columns, np.int64(rows)), atlas="uv")
    check_every_use(m, rows, columns, tmp_path)
    np.testing.assert_array_equal(
        sdm.map(sdm.Surface(mesh, resolution=[columns, rows], atlas="uv"), m.sites).distance, m.distance
    )


def test_maps_that_edits_have_made_taller(tmp_path):
    vertices, faces = meshes.box()
    surface = sdm.Surface(vertices, faces, resolution=32)
    shift = np.array([0, 0, 3.0])
    while surface.rows == 32:  # copies of the box, until they need more rows
        first = len(surface.vertices)
        surface.edit(added_vertices=vertices + shift, added_faces=faces + first)
        shift[2] += 3
    check_every_use(sdm.map(surface, meshes.sphere()), surface.rows, 32, tmp_path)


def test_sizes_that_no_map_has():
    box = meshes.box()
    with pytest.raises(sdm.Error, match="square"):
        sdm.Surface(box, resolution=(64, 32))
    assert sdm.Surface(box, resolution=(64, 64)).resolution == 64
    for size in ((64,), (64, 32, 16), []):
        with pytest.raises(sdm.Error, match="resolution"):
            sdm.Surface(box, resolution=size)
    for size in ((64, -1), (8, 64), (64, 10**6)):
        with pytest.raises(sdm.Error):
            sdm.map(grid_with_uvs(), box, resolution=size, atlas="uv")
