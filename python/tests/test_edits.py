"""Edits of topology: against objects that are built anew, and for what earlier results keep."""

import gc

import numpy as np
import pytest

import meshes
import sdm

POINTS = np.random.default_rng(0).uniform(-1.5, 1.5, (300, 3))


def torn(mesh):
    """Removes some faces of a sphere, gives it a lid, and moves a vertex. Returns the edit, and vertices and faces after."""
    vertices, faces = mesh
    vertices, faces = np.array(vertices, float), np.array(faces)
    count = len(vertices)
    edit = {
        "removed_faces": [3, 5],
        "reconnected_faces": ([7], [[faces[7][0], faces[7][1], count]]),
        "moved_vertices": (np.array([2], np.uint8), np.array([[0, 1.5, 0]], np.float32)),
        "added_vertices": [[0, 0, 2], [0, 0.5, 2]],
        "added_faces": [[0, count, count + 1]],
    }
    after = np.vstack([vertices, edit["added_vertices"]])
    after[2] = [0, 1.5, 0]
    present = np.delete(faces, [3, 5, 7], axis=0)
    present = np.vstack([present, [faces[7][0], faces[7][1], count], [0, count, count + 1]])
    return edit, after, present


@pytest.mark.parametrize("keep", [False, True])
def test_edited_sites_are_those_of_the_new_mesh(keep):
    mesh = meshes.sphere()
    sites = sdm.Sites(mesh)
    kept = (sites.faces, sites.edges, sites.closest_points(POINTS, gradients=True)) if keep else None
    edit, vertices, faces = torn(mesh)
    sites.edit(**edit)
    gc.collect()
    expected = sdm.Sites(vertices, faces)
    found, truth = sites.closest_points(POINTS, sign="winding"), expected.closest_points(POINTS, sign="winding")
    np.testing.assert_allclose(found.distance, truth.distance, atol=1e-12)
    np.testing.assert_array_equal(sites.edges, expected.edges)
    np.testing.assert_array_equal(sites.vertices, vertices)
    assert len(sites.faces) == len(mesh[1]) + 1 and not sites.closed
    np.testing.assert_array_equal(sites.faces[3], np.repeat(mesh[1][3][0], 3))
    assert kept is None or len(kept[0]) == len(mesh[1])


def test_earlier_results_do_not_change():
    mesh = meshes.sphere()
    sites = sdm.Sites(mesh)
    expected = sdm.Sites(mesh).closest_points(POINTS, gradients=True)
    found, faces, edges = sites.closest_points(POINTS, gradients=True), sites.faces, sites.edges
    old_edges = edges.copy()
    for i in range(3):
        sites.edit(added_vertices=np.zeros((1, 3)), removed_faces=[i])
        sites.refit(sites.vertices * 2)
    np.testing.assert_array_equal(faces, mesh[1])
    np.testing.assert_array_equal(edges, old_edges)
    np.testing.assert_array_equal(found.barycentric, expected.barycentric)
    for ours, theirs in zip(found.vertex_gradients(), expected.vertex_gradients()):
        np.testing.assert_array_equal(ours, theirs)
    del sites
    gc.collect()
    np.testing.assert_array_equal(faces, mesh[1])
    np.testing.assert_array_equal(found.face, expected.face)


def test_edited_surfaces_keep_their_texels():
    mesh = meshes.sphere()
    surface, target = sdm.Surface(mesh, resolution=128), sdm.Sites(meshes.box())
    before = sdm.map(surface, target)
    owners, faces = before.face, surface.faces
    other = sdm.map(surface, target)
    edit, vertices, _ = torn(mesh)
    surface.edit(**{**edit, "moved_vertices": None})
    after = sdm.map(surface, target)
    assert after.distance.shape == (surface.rows, 128) and len(surface.faces) == len(faces) + 1
    changed = np.isin(owners, (3, 5, 7, sdm.NONE))
    np.testing.assert_array_equal(after.distance[:128][~changed], before.distance[~changed])
    assert not np.isin(after.face, (3, 5)).any() and (after.face == len(faces)).any()
    np.testing.assert_array_equal(before.face, owners)  # kept, as it was read before the edit
    for stale in (lambda: other.face, lambda: other.position, other.statistics):
        with pytest.raises(sdm.Error, match="edited"):
            stale()


@pytest.mark.parametrize("edit", [
    {"removed_faces": [128]}, {"removed_faces": [1, 1]}, {"removed_faces": [-1]}, {"removed_faces": [[1]]}, {"removed_faces": [1.5]},
    {"removed_faces": np.arange(128)}, {"moved_vertices": ([0], [[np.nan, 0, 0]])}, {"moved_vertices": ([0], [])},
    {"moved_vertices": ([99], [[0, 0, 0]])}, {"moved_vertices": 3}, {"moved_vertices": ([0, 1], [[0, 0, 0]])},
    {"reconnected_faces": ([0], [[1, 1, 1]])}, {"reconnected_faces": ([0], [[0, 1, 99]])}, {"added_faces": [[0, 1, 99]]},
    {"added_vertices": [[0, 0]]}, {"added_faces": [[0, 1, 2]], "added_corner_uvs": np.zeros((1, 3, 2))},
])  # fmt: skip
@pytest.mark.parametrize("make", [sdm.Sites, lambda mesh: sdm.Surface(mesh, resolution=64)])
def test_bad_edits_change_nothing(make, edit):
    mesh = meshes.sphere()
    edited = make(mesh)
    faces = edited.faces
    with pytest.raises(sdm.Error):
        edited.edit(**edit)
    np.testing.assert_array_equal(edited.faces, mesh[1])
    np.testing.assert_array_equal(edited.vertices, mesh[0])
    np.testing.assert_array_equal(faces, mesh[1])
    edited.edit()
    edited.edit(removed_faces=[], added_faces=np.empty((0, 3), int))
    np.testing.assert_array_equal(edited.faces, mesh[1])
