"""Meshes as other packages have them. The packages are not needed: their objects are recognised by their attributes."""

from types import SimpleNamespace

import numpy as np
import pytest

import meshes
import sdm


class Scene:
    """As trimesh.Scene: geometries, and nodes that place them."""

    def __init__(self, geometry, nodes):
        self.geometry = geometry
        self.graph = SimpleNamespace(nodes_geometry=list(nodes), get=nodes.__getitem__)


def test_scenes_are_joined():
    box, sphere = meshes.box(), meshes.sphere()
    geometry = {"box": SimpleNamespace(vertices=box[0], faces=box[1]), "ball": SimpleNamespace(vertices=sphere[0], faces=sphere[1]),
                "path": SimpleNamespace(vertices=np.zeros((2, 3)), entities=[])}  # fmt: skip
    turned = np.array([[0, -1, 0, 5], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])
    mirrored = np.diag([-1.0, 1, 1, 1])
    nodes = {"first": (np.eye(4), "box"), "second": (turned, "box"), "third": (mirrored, "ball"), "line": (np.eye(4), "path")}
    mesh = sdm.Mesh(Scene(geometry, nodes))
    assert len(mesh.vertices) == 2 * 8 + len(sphere[0]) and len(mesh.faces) == 2 * 12 + len(sphere[1])
    np.testing.assert_allclose(mesh.vertices[8:16], box[0] @ turned[:3, :3].T + [5, 0, 0])
    sites = sdm.Sites(mesh)
    assert sites.closed and sites.contains([[4.5, 0.5, 0.5], [-0.5, -0.5, 0.1], [9, 9, 9]]).tolist() == [True, True, False]
    # A reflection reverses the faces, so that normals remain outward.
    a, b, c = (mesh.vertices[mesh.faces[24:, k]] for k in range(3))
    assert (np.einsum("nx,nx->n", np.cross(b - a, c - a), a + b + c) > 0).all()
    with pytest.raises(sdm.Error, match="no triangles"):
        sdm.Mesh(Scene({}, {}))


class Cells:
    """As vtkCellArray."""

    def __init__(self, offsets, connectivity):
        self.offsets, self.connectivity = np.asarray(offsets), np.asarray(connectivity)

    def GetOffsetsArray(self):
        return self.offsets

    def GetConnectivityArray(self):
        return self.connectivity

    def GetNumberOfCells(self):
        return len(self.offsets) - 1


def poly_data(points, polygons, strips=None):
    data = SimpleNamespace(GetData=lambda: points)
    none = Cells([0], [])
    return SimpleNamespace(GetPoints=lambda: data, GetPolys=lambda: polygons, GetStrips=lambda: strips or none)


def test_poly_data_of_vtk():
    vertices, faces = meshes.sphere()
    mesh = sdm.Mesh(poly_data(vertices.astype(np.float32), Cells(np.arange(0, 3 * len(faces) + 1, 3), faces.ravel())))
    assert np.array_equal(mesh.faces, faces) and np.allclose(mesh.vertices, vertices, atol=1e-6)
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0.0]])
    both = sdm.Mesh(poly_data(square, Cells([0, 4, 7], [0, 1, 2, 3, 1, 4, 2])))
    assert both.faces.tolist() == [[0, 1, 2], [0, 2, 3], [1, 4, 2]]
    arrow = np.array([[0, 0, 0], [3, 1, 0], [0, 3, 0], [1, 1, 0.0]])
    assert sdm.Mesh(poly_data(arrow, Cells([0, 4], range(4)))).faces.tolist() == [[0, 1, 3], [1, 2, 3]]
    concave = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [1, 0.5, 0.0], [0, 2, 0]])
    with pytest.raises(sdm.Error, match="five corners or more"):
        sdm.Mesh(poly_data(concave, Cells([0, 5], range(5))))
    with pytest.raises(sdm.Error, match="strips"):
        sdm.Mesh(poly_data(square, Cells([0], []), Cells([0, 4], [0, 1, 3, 2])))


def test_real_packages():
    trimesh = pytest.importorskip("trimesh")
    scene = trimesh.Scene([trimesh.creation.box(), trimesh.creation.icosphere()])
    assert len(sdm.Mesh(scene).faces) == 12 + 1280
    vtk = pytest.importorskip("vtk")
    source = vtk.vtkSphereSource()
    source.Update()
    assert len(sdm.Mesh(source.GetOutput()).faces) == source.GetOutput().GetNumberOfCells()
