"""Meshes in the forms of other packages: as their attributes are documented, and as installed packages have them."""

from types import SimpleNamespace

import numpy as np
import pytest

import meshes
import sdm

VERTICES, FACES = meshes.box()
UVS = np.random.default_rng(0).uniform(size=(len(VERTICES), 2))


class Tensor:
    def __init__(self, array):
        self.array = array

    def cpu(self):
        return self

    def numpy(self):
        return self.array


def flat(faces):
    return np.concatenate([[len(face), *face] for face in faces])


def block(kind, data):
    return SimpleNamespace(type=kind, data=data)


FORMS = {
    "tuple": (VERTICES, FACES),
    "lists": [VERTICES.tolist(), FACES.tolist()],
    "trimesh": SimpleNamespace(vertices=VERTICES, faces=FACES),
    "open3d": SimpleNamespace(vertices=VERTICES, triangles=FACES, triangle_uvs=[]),
    "open3d.t": SimpleNamespace(vertex={"positions": Tensor(VERTICES.astype(np.float32))},
                                triangle={"indices": Tensor(FACES)}),
    "pyvista": SimpleNamespace(points=VERTICES, faces=flat(FACES)),
    "pyvista with quads": SimpleNamespace(points=VERTICES, faces=flat([[0, 1, 3, 2]]),
                                          triangulate=lambda: SimpleNamespace(points=VERTICES, faces=flat(FACES))),
    "meshio": SimpleNamespace(points=VERTICES, cells=[block("line", [[0, 1]]), block("triangle", FACES)]),
    "sdm.Mesh": sdm.Mesh(VERTICES, FACES),
    "sdm.Sites": sdm.Sites(VERTICES, FACES),
    "sdm.Surface": sdm.Surface(VERTICES, FACES, resolution=32),
}  # fmt: skip


@pytest.mark.parametrize("form", FORMS)
def test_forms(form):
    mesh = sdm.Mesh(FORMS[form])
    np.testing.assert_array_equal(mesh.vertices, VERTICES)
    np.testing.assert_array_equal(mesh.faces, FACES)
    assert sdm.closest_points(FORMS[form], [[2, 0.5, 0.5]]).distance == 1


def test_quads_of_meshio():
    quads = SimpleNamespace(points=VERTICES, cells=[block("quad", np.array([[0, 1, 3, 2], [4, 6, 7, 5]]))])
    np.testing.assert_array_equal(sdm.Mesh(quads).faces, [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5]])


def test_quads_with_a_corner_that_is_turned_inwards():
    points = np.array([[0, 0, 0], [3, 1, 0], [0, 3, 0], [1, 1, 0.0]])  # an arrow head, inwards at the last one
    for turn in range(4):
        quad = np.roll([0, 1, 2, 3], turn)
        mesh = sdm.Mesh(SimpleNamespace(points=points, cells=[block("quad", quad[None])]))
        a, b, c = np.moveaxis(points[mesh.faces], 1, 0)
        areas = np.cross(b - a, c - a)[:, 2]
        assert (areas > 0).all() and areas.sum() == 6  # twice that of the quad


def test_texture_coordinates():
    expected = UVS[FACES]
    forms = [
        SimpleNamespace(vertices=VERTICES, faces=FACES, visual=SimpleNamespace(uv=UVS)),
        SimpleNamespace(vertices=VERTICES, triangles=FACES, triangle_uvs=expected.reshape(-1, 2)),
        SimpleNamespace(vertex={"positions": Tensor(VERTICES)},
                        triangle={"indices": Tensor(FACES), "texture_uvs": Tensor(expected)}),
        SimpleNamespace(points=VERTICES, faces=flat(FACES), active_texture_coordinates=UVS),
    ]  # fmt: skip
    for form in forms:
        np.testing.assert_array_equal(sdm.Mesh(form).corner_uvs, expected)
    assert sdm.Mesh(VERTICES, FACES).corner_uvs is None


@pytest.mark.parametrize("form", [
    3, None, object(), (1, 2, 3), VERTICES, {"vertices": VERTICES}, SimpleNamespace(vertices=VERTICES),
    SimpleNamespace(points=VERTICES, cells=[block("tetra", [[0, 1, 2, 3]])]),
    SimpleNamespace(points=VERTICES, cells=[block("line", [[0, 1]])]),
    SimpleNamespace(points=VERTICES, faces=[2, 0, 1], triangulate=lambda: SimpleNamespace(points=VERTICES, faces=[2, 0, 1])),
])  # fmt: skip
def test_what_is_no_mesh(form):
    with pytest.raises(sdm.Error):
        sdm.Mesh(form)


def test_files(tmp_path):
    path = tmp_path / "a name with ü.ply"
    sdm.map((VERTICES, FACES), (VERTICES, FACES), resolution=32).save(path)
    for name in (path, str(path)):
        np.testing.assert_array_equal(sdm.read(name).vertices, VERTICES)
        np.testing.assert_array_equal(sdm.Mesh(name).faces, FACES)
    (tmp_path / "bad.ply").write_text("ply\nnot really")
    with pytest.raises(sdm.Error, match="bad.ply"):
        sdm.read(tmp_path / "bad.ply")
    with pytest.raises(TypeError):
        sdm.read(3)


def test_trimesh():
    trimesh = pytest.importorskip("trimesh")
    box = trimesh.creation.box()
    np.testing.assert_array_equal(sdm.Mesh(box).vertices, box.vertices)
    np.testing.assert_array_equal(sdm.Mesh(box).faces, box.faces)


def test_open3d():
    open3d = pytest.importorskip("open3d")
    legacy = open3d.geometry.TriangleMesh.create_box()
    tensor = open3d.t.geometry.TriangleMesh.from_legacy(legacy)
    for mesh in (legacy, tensor):
        np.testing.assert_array_equal(sdm.Mesh(mesh).vertices, np.asarray(legacy.vertices))
        np.testing.assert_array_equal(sdm.Mesh(mesh).faces, np.asarray(legacy.triangles))


def test_pyvista():
    pyvista = pytest.importorskip("pyvista")
    for mesh in (pyvista.Cube(), pyvista.Sphere()):
        assert len(sdm.Mesh(mesh).faces) == mesh.triangulate().n_cells


def test_meshio():
    meshio = pytest.importorskip("meshio")
    mesh = sdm.Mesh(meshio.Mesh(VERTICES, [("triangle", FACES)]))
    np.testing.assert_array_equal(mesh.faces, FACES)
