"""The Hausdorff distance of two surfaces, and alignment."""

import threading

import numpy as np
import pytest

import meshes
import sdm


def rotation(angle, axis):
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    k = np.cross(np.eye(3), axis)
    return np.eye(3) + np.sin(angle) * k.T + (1 - np.cos(angle)) * (k @ k)


def rigid(angle, axis, offset):
    pose = np.eye(4)
    pose[:3, :3] = rotation(angle, axis)
    pose[:3, 3] = offset
    return pose


def lumpy():
    """A closed surface without symmetries."""
    vertices, faces = meshes.sphere(steps=4)
    x, y, z = vertices.T
    return vertices * (1 + 0.3 * x + 0.2 * y * z + 0.1 * np.sin(5 * x + 3 * z))[:, None] * [1, 1.3, 1.7], faces


def test_hausdorff_of_boxes():
    # The farthest points of the larger box are its corners, and those of the smaller one are inside.
    small, large = meshes.box(), meshes.box((-1, -1, -1), (2, 2, 2))
    both = sdm.hausdorff(small, large)
    assert both.lower <= np.sqrt(3) <= both.upper <= both.lower + 1e-5
    assert sdm.hausdorff(large, small).value == pytest.approx(both.value)
    np.testing.assert_allclose(np.linalg.norm(both.witness[1] - both.witness[0]), both.value)
    assert both.witness[0].min() >= 0 and both.witness[0].max() <= 1  # on the first mesh, whichever is farther
    inner = sdm.hausdorff(small, large, one_sided=True)
    assert inner.lower <= 1 <= inner.upper  # a face of the small box to that of the large one
    assert sdm.hausdorff(sdm.Sites(large), sdm.Sites(small), one_sided=True).value == pytest.approx(np.sqrt(3))


def test_hausdorff_to_faces_that_face_the_same_way():
    plate = meshes.box((0, 0, 0), (10, 10, 1))
    dent = np.array([[1, 1, 0.21], [9, 1, 0.21], [9, 9, 0.21], [1, 9, 0.21]]), [[0, 1, 2], [0, 2, 3]]
    assert sdm.hausdorff(dent, plate, one_sided=True).value == pytest.approx(0.21)
    assert sdm.hausdorff(dent, plate, one_sided=True, facing=90).value == pytest.approx(0.79)
    with pytest.warns(RuntimeWarning, match="10 faces of b are left out"):
        assert sdm.hausdorff(dent, plate, facing=45).value > 0.79
    with pytest.raises(sdm.Error, match="facing is 0: it must be a number of degrees greater than 0 and at most 180"):
        sdm.hausdorff(dent, plate, facing=0)


@pytest.mark.parametrize("seed", range(5))
def test_hausdorff_bounds_hold_for_soups(seed):
    a, b = meshes.soup(seed), meshes.soup(seed + 100)
    distance = sdm.hausdorff(a, b, precision=1e-4, one_sided=True)
    assert distance.lower <= distance.value <= distance.upper <= distance.lower + 1e-4
    weights = np.random.default_rng(seed).dirichlet((1, 1, 1), (len(a[1]), 200))
    samples = np.einsum("fsk,fkx->fsx", weights, a[0][a[1]]).reshape(-1, 3)
    sampled = sdm.Sites(b).closest_points(np.vstack([samples, a[0]])).distance.max()
    assert sampled <= distance.upper
    assert sdm.closest_points(*b, [distance.witness[0]]).distance[0] == pytest.approx(distance.value)
    # Not above the other direction's larger one.
    assert distance.lower <= sdm.hausdorff(a, b, precision=1e-4).upper


def test_hausdorff_errors():
    with pytest.raises(sdm.Error, match="precision"):
        sdm.hausdorff(meshes.box(), meshes.box(), precision=-1)
    with pytest.raises(sdm.Error):
        sdm.hausdorff(([[0, 0, 0]], np.zeros((0, 3), int)), meshes.box())
    with pytest.raises(sdm.Cancelled):
        sdm.hausdorff(lumpy(), meshes.soup(1, 2000), precision=1e-9, progress=lambda step, fraction: False)


@pytest.mark.parametrize("target", [lumpy, lambda: sdm.Sites(lumpy())])
def test_align_finds_the_pose_of_a_copy(target):
    vertices, faces = lumpy()
    pose = rigid(0.1, (1, 2, 3), (0.05, -0.04, 0.03))
    alignment = sdm.align((vertices @ pose[:3, :3].T + pose[:3, 3], faces), target())
    np.testing.assert_allclose(alignment.transform @ pose, np.eye(4), atol=1e-9)
    np.testing.assert_allclose(alignment.transform[:3, :3] @ alignment.transform[:3, :3].T, np.eye(3), atol=1e-12)
    assert alignment.converged and alignment.rms < 1e-9 < 0.01 < alignment.rms_before
    assert alignment.samples > 0 and alignment.iterations > 0 and 0 < alignment.fraction_used <= 1
    assert len(alignment.freedoms) == 6 and not any(freedom.free for freedom in alignment.freedoms)
    for freedom in alignment.freedoms:
        length = np.hypot(np.linalg.norm(freedom.translation), np.linalg.norm(freedom.rotation))
        assert length == pytest.approx(1) and freedom.determined > 0.02
        assert freedom.axis_point.shape == (3,) if np.linalg.norm(freedom.rotation) > 0 else freedom.axis_point is None
    # From the pose itself nothing is left to do.
    again = sdm.align((vertices @ pose[:3, :3].T + pose[:3, 3], faces), lumpy(), pose=np.linalg.inv(pose))
    np.testing.assert_allclose(again.transform @ pose, np.eye(4), atol=1e-9)


def test_align_by_principal_axes():
    vertices, faces = lumpy()
    pose = rigid(2.5, (3, -1, 2), (4, 5, -6))
    alignment = sdm.align((vertices @ pose[:3, :3].T + pose[:3, 3], faces), lumpy(), start="principal_axes")
    np.testing.assert_allclose(alignment.transform @ pose, np.eye(4), atol=1e-8)


def test_align_points():
    vertices, faces = lumpy()
    pose = rigid(0.05, (0, 1, 1), (0.02, 0.03, 0))
    points = (vertices @ pose[:3, :3].T + pose[:3, 3]).astype(np.float32)
    alignment = sdm.align_points(points, (vertices, faces))
    np.testing.assert_allclose(alignment.transform @ pose, np.eye(4), atol=1e-5)
    normals = points - pose[:3, 3]  # a rough guess suffices
    with_normals = sdm.align_points(points, (vertices, faces), normals=normals, samples=500)
    np.testing.assert_allclose(with_normals.transform @ pose, np.eye(4), atol=1e-4)


def test_align_locks_freedoms():
    vertices, faces = lumpy()
    pose = rigid(0.1, (0, 0, 1), (0.05, -0.04, 0))
    moved = (vertices @ pose[:3, :3].T + pose[:3, 3], faces)
    alignment = sdm.align(moved, (vertices, faces), free="xy,rz")
    np.testing.assert_allclose(alignment.transform @ pose, np.eye(4), atol=1e-9)
    assert [f.locked for f in alignment.freedoms] == [False] * 3 + [True] * 3
    along_x = sdm.align_points(moved[0], (vertices, faces), free="x").transform
    np.testing.assert_allclose(along_x[:, :3], np.eye(4)[:, :3], atol=1e-12)
    assert along_x[1, 3] == along_x[2, 3] == 0
    about = sdm.align(moved, (vertices, faces), free="rz", about=(1, 0, 5)).transform
    np.testing.assert_allclose(about @ [1, 0, 5, 1], [1, 0, 5, 1], atol=1e-12)
    with pytest.raises(sdm.Error, match="free is 'xw': it must be a list of x, y, z"):
        sdm.align(moved, (vertices, faces), free="xw")
    with pytest.raises(sdm.Error, match="about is .*: it must be three numbers"):
        sdm.align(moved, (vertices, faces), free="x", about=[0, 0])


def test_align_on_a_region():
    vertices, faces = lumpy()
    pose = rigid(0.03, (1, 2, 3), (0.02, -0.01, 0.01))
    bent = vertices + np.where(vertices[:, :1] < 0, [[0, 0, 0.05]], 0) * vertices[:, :1] ** 2
    moved = (bent @ pose[:3, :3].T + pose[:3, 3], faces)
    right = sdm.align(moved, (vertices, faces), on_boxes=[[0.05, -9, -9], [9, 9, 9]])
    chosen = np.nonzero((vertices[faces][:, :, 0] > 0.05).all(axis=1))[0]
    by_faces = sdm.align(moved, (vertices, faces), on_faces=chosen)
    for alignment in (right, by_faces):
        np.testing.assert_allclose(alignment.transform @ pose, np.eye(4), atol=1e-6)
        assert alignment.samples < 32768 and alignment.fraction_fitting > 0.9
    with pytest.raises(sdm.Error, match="no face of O2"):
        sdm.align(moved, (vertices, faces), on_faces=[len(faces)])
    with pytest.raises(sdm.Error, match="two corners"):
        sdm.align(moved, (vertices, faces), on_boxes=[[0, 0, 0]])


def test_align_321():
    places = np.array([[0, 0, 0], [4, 0, 0], [0, 3, 0], [0, 0, 1], [4, 0, 1], [0, 2, 2.0]])
    pose = rigid(1.1, (1, 2, 3), (5, 6, 7))
    found = sdm.align_321(places @ pose[:3, :3].T + pose[:3, 3], places)
    np.testing.assert_allclose(found @ pose, np.eye(4), atol=1e-12)
    with pytest.raises(sdm.Error, match="six points"):
        sdm.align_321(places[:5], places)


def test_align_doubts_a_mirrored_part():
    vertices, faces = lumpy()
    vertices = np.asarray(vertices) * [1, 0.7, 0.5] + 0.2 * np.asarray(vertices)[:, [1, 2, 0]] ** 2
    mirrored = vertices * [-1, 1, 1]
    alignment = sdm.align((mirrored, faces), (vertices, faces))
    reasons = [d.reason for d in sdm.alignment_doubts((mirrored, faces), (vertices, faces), alignment)]
    assert "mirrored" in reasons


def test_align_errors():
    with pytest.raises(sdm.Error, match="start is 'centres': it must be automatic, pose or principal_axes"):
        sdm.align(meshes.box(), meshes.box(), start="centres")
    with pytest.raises(sdm.Error):
        sdm.align(meshes.box(), meshes.box(), pose=np.diag([2, 1, 1, 1]))
    with pytest.raises(sdm.Error):
        sdm.align(meshes.box(), meshes.box(), samples=1)
    with pytest.raises(sdm.Error):
        sdm.align_points(np.zeros((0, 3)), meshes.box())
    with pytest.raises(sdm.Error):
        sdm.align_points(np.zeros((10, 3)), meshes.box(), normals=np.zeros((9, 3)))
    with pytest.raises(sdm.Cancelled):
        sdm.align(lumpy(), lumpy(), progress=lambda step, fraction: False)


def test_sites_serve_several_threads():
    sites = sdm.Sites(lumpy())
    distances = []

    def measure():
        distances.append(sdm.hausdorff(meshes.box(), sites, precision=1e-4).value)

    threads = [threading.Thread(target=measure) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(distances) == 4 and len(set(distances)) == 1
