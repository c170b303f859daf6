"""What O2 has at the closest points of texels."""

import numpy as np
import pytest

import meshes
import sdm


@pytest.fixture(scope="module")
def distance_map():
    return sdm.map(meshes.sphere(), meshes.box((0, 0, 0), (0.8, 0.6, 0.4)), resolution=128)


def test_positions_are_the_closest_points(distance_map):
    m = distance_map
    vertices = sdm.Mesh(meshes.box((0, 0, 0), (0.8, 0.6, 0.4))).vertices
    found = m.transfer(vertices)
    assert found.shape == (128, 128, 3) and found.dtype == np.float32 and np.isfinite(found).all()
    np.testing.assert_allclose(found[m.valid], (m.position + m.vector)[m.valid], atol=1e-6)
    bare = m.transfer(vertices, fill=False)
    np.testing.assert_array_equal(bare[m.valid], found[m.valid])
    assert np.isnan(bare[~m.valid]).all()


def test_domains_and_shapes(distance_map):
    m = distance_map
    mesh = sdm.Mesh(meshes.box((0, 0, 0), (0.8, 0.6, 0.4)))
    by_vertex = m.transfer(mesh.vertices)
    by_corner = m.transfer(mesh.vertices[mesh.faces], "corner")
    np.testing.assert_array_equal(by_corner, by_vertex)
    numbers = m.transfer(np.arange(len(mesh.faces)), domain="face", fill=False)
    assert numbers.shape == (128, 128)
    on_faces = m.valid & (m.site_type == 2)
    np.testing.assert_array_equal(numbers[on_faces], m.site[on_faces])
    matrices = m.transfer(np.ones((len(mesh.vertices), 2, 4), np.uint8))
    assert matrices.shape == (128, 128, 2, 4) and np.allclose(matrices, 1)


def test_what_has_no_distance_has_no_value():
    m = sdm.map(meshes.sphere(), meshes.box(), resolution=64, max_distance=0.3)
    values = m.transfer(np.zeros(8))
    owned = m.face != sdm.NONE
    assert (owned & ~m.valid).any()
    np.testing.assert_array_equal(np.isnan(values), owned & ~m.valid)


@pytest.mark.parametrize(
    ("values", "domain", "fault", "message"),
    [
        (np.zeros(7), "vertex", sdm.Error, "for each of 8 vertices has 8 values, not 7"),
        (np.zeros((12, 2)), "corner", sdm.Error, r"shape \(faces, 3, ...\), not \(12, 2\)"),
        (np.zeros(8), "edge", sdm.Error, "domain must be 'vertex', 'face' or 'corner', not 'edge'"),
        (np.float64(1), "vertex", sdm.Error, "shape"),
        (np.zeros((8, 0)), "vertex", sdm.Error, "at least one component"),
        (np.array(["a"] * 8), "vertex", TypeError, "real numbers"),
        (np.ma.masked_array(np.zeros(8), mask=[1] + 7 * [0]), "vertex", TypeError, "without a mask"),
        (np.zeros(8, complex), "vertex", TypeError, "real numbers"),
    ],
)
def test_refuses(distance_map, values, domain, fault, message):
    with pytest.raises(fault, match=message):
        distance_map.transfer(values, domain)


def test_is_refused_for_another_shape():
    surface = sdm.Surface(meshes.sphere(), resolution=64)
    m = sdm.map(surface, sdm.Sites(meshes.box()))
    surface.refit(np.asarray(meshes.sphere()[0]) * 2)
    with pytest.raises(sdm.Error, match="refitted"):
        m.transfer(np.zeros(8))


def write_ply(path, vertices, faces, colors):
    rows = "\n".join(" ".join(map(str, [*v, *c])) for v, c in zip(vertices, colors, strict=True))
    polygons = "\n".join(" ".join(map(str, [3, *f])) for f in faces)
    names = "".join(f"property double {n}\n" for n in "xyz") + "".join(
        f"property uchar {n}\n" for n in ("red", "green", "blue")
    )
    path.write_text(
        f"ply\nformat ascii 1.0\nelement vertex {len(vertices)}\n{names}element face {len(faces)}\n"
        f"property list uchar int vertex_indices\nend_header\n{rows}\n{polygons}\n"
    )


def test_colours_of_a_file_are_transferred(tmp_path):
    vertices, faces = meshes.box()
    colors = (255 * np.asarray(vertices)).astype(int)  # red along x, and so on: linear only at its ends
    file = tmp_path / "box.ply"
    write_ply(file, vertices, faces, colors)
    attributes = sdm.read_attributes(file)
    assert list(attributes) == ["color"]
    color = attributes["color"]
    mesh = sdm.read(file)
    assert color.shape == (len(mesh.faces), 3, 3) and color.dtype == np.float32
    np.testing.assert_array_equal(color, mesh.vertices[mesh.faces])
    m = sdm.map(meshes.sphere(), mesh, resolution=64)
    found = m.transfer(color, "corner")
    np.testing.assert_allclose(found[m.valid], np.clip((m.position + m.vector)[m.valid], 0, 1), atol=1e-5)


def test_arrays_of_a_file_keep_apart(tmp_path):
    names = b"".join(b"property float " + name + b"\n" for name in (b"x", b"y", b"z", b"q\xff", b"q\xfe"))
    (tmp_path / "a.ply").write_bytes(
        b"ply\nformat ascii 1.0\nelement vertex 3\n" + names + b"element face 1\n"
        b"property list uchar int vertex_indices\nend_header\n0 0 0 1 4\n1 0 0 2 5\n0 1 0 3 6\n3 0 1 2\n"
    )
    attributes = sdm.read_attributes(tmp_path / "a.ply")
    assert {name: values.tolist() for name, values in attributes.items()} == {"q\ufffd": [[1, 2, 3]], "q\ufffd_2": [[4, 5, 6]]}


def test_files_without_attributes_have_none(tmp_path):
    (tmp_path / "a.off").write_text("OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    assert sdm.read_attributes(tmp_path / "a.off") == {}
    with pytest.raises(sdm.Error, match="b.ply"):
        sdm.read_attributes(tmp_path / "b.ply")
