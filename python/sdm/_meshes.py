"""Meshes in the forms of other packages, recognised by their attributes. None of the packages is imported."""

import os
from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from ._arrays import numpy_of
from ._core import Error, Mesh, read

_FORMS = (
    "a mesh must be (vertices, faces), a path, or a mesh of sdm, trimesh, open3d, pyvista, vtk or meshio, not "
)


def _of_corners(uvs: Any, vertices: Any, faces: npt.NDArray[Any]) -> "npt.NDArray[Any] | None":
    """Texture coordinates of corners, from those of vertices."""
    if uvs is None or np.shape(uvs) != (len(vertices), 2) or len(faces) == 0:
        return None
    corners: npt.NDArray[Any] = numpy_of(uvs, "texture coordinates")[numpy_of(faces, "faces")]
    return corners


def _of_quads(points: Any, quads: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Two triangles of each quad, (q, 2, 3): by the diagonal from its first corner, or by the other one if the first lies
    outside, as in a quad with a corner that is turned inwards."""
    a, b, c, d = np.moveaxis(numpy_of(points, "vertices")[quads], 1, 0)
    folded = (np.cross(b - a, c - a) * np.cross(c - a, d - a)).sum(-1) < 0
    return np.where(folded[:, None, None], quads[:, [[0, 1, 3], [1, 2, 3]]], quads[:, [[0, 1, 2], [0, 2, 3]]])


def _trimesh(mesh: Any) -> tuple[Any, ...]:
    uvs = getattr(getattr(mesh, "visual", None), "uv", None)
    return mesh.vertices, mesh.faces, _of_corners(uvs, mesh.vertices, mesh.faces)


def _open3d_legacy(mesh: Any) -> tuple[Any, ...]:
    faces = numpy_of(mesh.triangles, "faces")
    uvs = numpy_of(getattr(mesh, "triangle_uvs", ()), "texture coordinates")
    return numpy_of(mesh.vertices, "vertices"), faces, uvs.reshape(-1, 3, 2) if len(uvs) == 3 * len(faces) > 0 else None


def _open3d_tensor(mesh: Any) -> tuple[Any, ...]:
    triangle = mesh.triangle
    uvs = triangle["texture_uvs"].cpu().numpy() if "texture_uvs" in triangle else None
    return mesh.vertex["positions"].cpu().numpy(), triangle["indices"].cpu().numpy(), uvs


def triangulated(mesh: Any) -> Any:
    """A mesh of pyvista all of whose faces are triangles."""

    def all_triangles(mesh: Any) -> bool:
        faces = numpy_of(mesh.faces, "faces")
        return len(faces) % 4 == 0 and bool((faces[::4] == 3).all())

    if not all_triangles(mesh):
        mesh = mesh.triangulate()
    if not all_triangles(mesh):
        raise Error("the mesh of pyvista has faces that are no polygons; extract its surface first")
    return mesh


def _pyvista(mesh: Any) -> tuple[Any, ...]:
    mesh = triangulated(mesh)
    faces = numpy_of(mesh.faces, "faces").reshape(-1, 4)[:, 1:]
    uvs = getattr(mesh, "active_texture_coordinates", None)
    return mesh.points, faces, _of_corners(uvs, mesh.points, faces)


def _meshio(mesh: Any) -> tuple[Any, ...]:
    triangles = []
    for block in mesh.cells:
        if block.type == "triangle":
            triangles.append(numpy_of(block.data, "faces"))
        elif block.type == "quad":
            triangles.append(_of_quads(mesh.points, numpy_of(block.data, "faces")).reshape(-1, 3))
        elif block.type not in ("vertex", "line"):
            raise Error(f"the mesh of meshio has cells of type '{block.type}'; only triangles and quads are surfaces")
    return mesh.points, np.concatenate(triangles) if triangles else np.empty((0, 3), np.uint32), None


def scene_parts(scene: Any) -> Iterator[tuple[Any, npt.NDArray[Any], npt.NDArray[Any]]]:
    """The geometries with faces at all places that the graph of a scene of trimesh has for them, with the vertices there and
    the faces, which a place that mirrors turns."""
    for node in scene.graph.nodes_geometry:
        place, name = scene.graph.get(node)
        geometry = scene.geometry[name]
        if not hasattr(geometry, "faces"):  # paths and point clouds
            continue
        matrix, positions = numpy_of(place, "transform"), numpy_of(geometry.vertices, "vertices")
        corners = numpy_of(geometry.faces, "faces")
        mirrors = np.linalg.det(matrix[:3, :3]) < 0
        yield geometry, positions @ matrix[:3, :3].T + matrix[:3, 3], corners[:, ::-1] if mirrors else corners


def _trimesh_scene(scene: Any) -> tuple[Any, ...]:
    """All parts, one after the other."""
    vertices, faces, count = [], [], 0
    for _, positions, corners in scene_parts(scene):
        vertices.append(positions)
        faces.append(corners + count)
        count += len(positions)
    if not faces:
        raise Error("the scene of trimesh has no triangles")
    return np.concatenate(vertices), np.concatenate(faces), None


def _vtk(data: Any) -> tuple[Any, ...]:
    if data.GetPoints() is None:
        raise Error("the data of vtk has no points")
    if data.GetStrips().GetNumberOfCells():
        raise Error("the data of vtk has triangle strips; triangulate it with vtkTriangleFilter first")
    polygons = data.GetPolys()
    ends = numpy_of(polygons.GetOffsetsArray(), "offsets")
    corners = numpy_of(polygons.GetConnectivityArray(), "faces")
    counts, begins = np.diff(ends), ends[:-1]
    if (counts > 4).any():
        raise Error("the data of vtk has polygons with five corners or more; triangulate it with vtkTriangleFilter first")
    points = numpy_of(data.GetPoints().GetData(), "vertices")
    three, four = np.flatnonzero(counts == 3), np.flatnonzero(counts == 4)
    quads = _of_quads(points, corners[begins[four, None] + [0, 1, 2, 3]]).reshape(-1, 3)
    order = np.argsort(np.concatenate([three, np.repeat(four, 2)]), kind="stable")
    faces = np.concatenate([corners[begins[three, None] + [0, 1, 2]], quads])[order]
    return points, faces, None


def parts(mesh: Any, faces: object) -> "Mesh | tuple[Any, ...]":
    """Returns a Mesh, or (vertices, faces, texture coordinates of corners or None)."""
    if faces is not None:
        return mesh, faces, None
    if isinstance(mesh, (str, os.PathLike)):
        return read(mesh)
    if isinstance(mesh, (tuple, list)) and len(mesh) == 2:
        return mesh[0], mesh[1], None
    if hasattr(mesh, "geometry") and hasattr(mesh, "graph"):
        return _trimesh_scene(mesh)
    if hasattr(mesh, "GetPolys") and not hasattr(mesh, "faces"):  # which pyvista adds
        return _vtk(mesh)
    if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):
        return _trimesh(mesh)
    if hasattr(mesh, "vertices") and hasattr(mesh, "triangles"):
        return _open3d_legacy(mesh)
    if hasattr(mesh, "vertex") and hasattr(mesh, "triangle"):
        return _open3d_tensor(mesh)
    if hasattr(mesh, "points") and hasattr(mesh, "faces"):
        return _pyvista(mesh)
    if hasattr(mesh, "points") and isinstance(getattr(mesh, "cells", None), list):
        return _meshio(mesh)
    raise Error(_FORMS + type(mesh).__name__)
