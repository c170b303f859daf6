"""Two bodies, many bodies, a mesh and itself."""

import pickle
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

import meshes
import sdm


def shift(*offset):
    pose = np.eye(4)
    pose[:3, 3] = offset
    return pose


def test_separation():
    query = sdm.ProximityQuery(meshes.box(), meshes.sphere(steps=3))
    query.set_pose(1, shift(4, 0.5, 0.5))
    np.testing.assert_array_equal(query.pose(1), shift(4, 0.5, 0.5))
    separation = query.separation()
    assert separation.certainty == "exact" and separation.value == pytest.approx(2, abs=1e-2)
    assert separation.lower <= float(separation) <= separation.upper
    assert np.linalg.norm(separation.witness[1] - separation.witness[0]) == pytest.approx(separation.value)
    assert query.colliding() is False
    assert query.penetration_depth().value == 0 and len(query.contacts()) == 0
    # The separation is that of the closest points of a dense sampling, from above.
    vertices = meshes.sphere(steps=3)[0] + [4, 0.5, 0.5]
    assert separation.value <= sdm.Sites(meshes.box()).closest_points(vertices).distance.min() + 1e-12


def test_contacts_and_depth():
    query = sdm.ProximityQuery(meshes.box(), meshes.box(), contact_margin=0.1, depth_precision=1e-3)
    query.set_pose(0, shift(0.1, 0.2, 0.75))
    assert query.colliding() is True and query.separation().value == 0
    depth = query.penetration_depth()
    assert depth.certainty == "bounded" and depth.lower <= depth.value <= depth.upper <= depth.lower + 1.1e-3
    assert repr(depth).startswith("sdm.BoundedLength(")
    contacts = query.contacts()
    n = len(contacts)
    assert n > 0 and contacts.bodies is None
    shapes = {"point1": (n, 3), "point2": (n, 3), "normal": (n, 3), "depth": (n,), "patch": (n,), "faces": (n, 2),
              "barycentric": (n, 2, 3), "id": (n,)}  # fmt: skip
    for name, shape in shapes.items():
        assert getattr(contacts, name).shape == shape
    assert contacts.faces.dtype == np.uint32 and contacts.id.dtype == np.uint64
    np.testing.assert_allclose(contacts.point1 + contacts.depth[:, None] * contacts.normal, contacts.point2, atol=1e-12)
    for side, (pose, points) in enumerate(((query.pose(0), contacts.point1), (query.pose(1), contacts.point2))):
        vertices, faces = meshes.box()
        corners = (vertices @ pose[:3, :3].T + pose[:3, 3])[faces[contacts.faces[:, side]]]
        np.testing.assert_allclose(np.einsum("nk,nkx->nx", contacts.barycentric[:, side], corners), points, atol=1e-12)


def test_separating_translation():
    query = sdm.ProximityQuery(meshes.box(), meshes.box())
    query.set_pose(0, shift(0.1, 0.2, 0.75))
    found = query.separating_translation()
    assert isinstance(found, sdm.SeparatingTranslation) and found.certainty == "exact"
    assert float(found) == found.value == found.upper == pytest.approx(0.25, abs=1e-9)
    assert found.lower == pytest.approx(0.25, abs=1e-9)
    np.testing.assert_allclose(found.translation, [0, 0, 0.25], atol=1e-9)
    assert repr(found).startswith("sdm.SeparatingTranslation(0.25")
    query.set_pose(0, shift(*found.translation) @ query.pose(0))
    assert not query.colliding() and query.separating_translation().value == 0
    # Of the deepest point, and of the bodies: a small box in the middle of a large one.
    vertices, faces = meshes.box()
    nested = sdm.ProximityQuery((0.2 * (vertices - 0.5), faces), (vertices - 0.5, faces))
    assert nested.penetration_depth().upper < 0.51 < nested.separating_translation().value == pytest.approx(0.6)


def test_separating_contacts():
    query = sdm.ProximityQuery(meshes.box(), meshes.box())
    query.set_pose(0, shift(0.1, 0.2, 0.75))
    contacts = query.separating_contacts()
    out = query.separating_translation()
    assert len(contacts) >= 4 and contacts.bodies is None
    np.testing.assert_allclose(contacts.normal, np.tile([0, 0, 1.0], (len(contacts), 1)), atol=1e-6)
    np.testing.assert_allclose(contacts.depth, 0.25, atol=1e-6)
    np.testing.assert_allclose(np.einsum("nk,nk->n", contacts.normal, contacts.point2 - contacts.point1), contacts.depth, atol=1e-9)
    assert (contacts.depth <= out.upper + 1e-9).all()
    few = query.separating_contacts(most_per_patch=2)
    assert set(few.id.tolist()) < set(contacts.id.tolist()) and np.bincount(few.patch).max() <= 2
    # In the same place there is a way out as well.
    query.set_pose(0, shift(0, 0, 0))
    assert query.separating_contacts().depth.max() == pytest.approx(1, abs=1e-6)
    with pytest.raises(sdm.Error, match="use 1 or more"):
        query.separating_contacts(most_per_patch=0)


def test_a_pose_is_a_matrix_or_seven_numbers():
    box = sdm.Mesh(*meshes.box())
    seven = [1.5, -0.25, 2, 2 * np.cos(0.4), 0, 2 * np.sin(0.4), 0]  # a quaternion of any length
    about_y = np.eye(4)
    about_y[[0, 0, 2, 2], [0, 2, 0, 2]] = np.cos(0.8), np.sin(0.8), -np.sin(0.8), np.cos(0.8)
    about_y[:3, 3] = seven[:3]
    query, poses, bodies = sdm.ProximityQuery(box, box), sdm.PoseQuery(box, box), sdm.MultiBodyQuery([box, box])
    for owner in (query, bodies):
        owner.set_pose(1, seven)
        np.testing.assert_allclose(owner.pose(1), about_y, atol=1e-15)
    poses.set_pose(0, seven)
    assert poses.separations([np.eye(4)])[0] == query.separation().value
    np.testing.assert_allclose(sdm.map(box, box, resolution=64, transform=seven).surface.vertices, sdm.Mesh(box).transformed(about_y).vertices, atol=1e-14)
    first, second = [-4, 0, 0, 1, 0, 0, 0], [4, 0, 0, 1, 0, 0, 0]
    by_numbers = sdm.time_of_contact(box, [first, second], box, seven, tolerance=1e-4)
    by_matrices = sdm.time_of_contact(box, [shift(*first[:3]), shift(*second[:3])], box, query.pose(1), tolerance=1e-4)
    assert by_numbers.time == by_matrices.time
    for bad in ([0] * 7, [0, 0, 0, np.nan, 0, 0, 0], [1, 2, 3], np.zeros((1, 7))):
        with pytest.raises(sdm.Error):
            query.set_pose(1, bad)
    with pytest.raises(sdm.Error, match=r"pose must have the shape \(4, 4\) or \(7,\), not \(3, 3\)"):
        query.set_pose(1, np.eye(3))


def test_refit_and_shared_shapes():
    vertices, faces = meshes.box()
    query = sdm.ProximityQuery((vertices, faces), (vertices + [3, 0, 0], faces))
    query.refit(o2=vertices + [2, 0, 0])
    assert query.separation().value == 1
    query.refit(vertices - [1, 0, 0])
    assert query.separation().value == 2
    shape = sdm.Shape(vertices, faces)
    shared = sdm.ProximityQuery(shape, shape)
    with pytest.raises(sdm.Error, match="share"):
        shared.refit(vertices)
    for bad in (lambda: query.refit(vertices[1:]), lambda: query.refit(vertices * np.nan), lambda: query.set_pose(2, np.eye(4)),
                lambda: query.set_pose(-1, np.eye(4)), lambda: query.pose(7), lambda: query.refit(np.empty((0, 3))), lambda: query.set_pose(0, np.diag([1, 2, 3, 1])),
                lambda: query.set_pose(0, np.eye(3)), lambda: sdm.ProximityQuery(shape, shape, contact_margin=-1),
                lambda: sdm.ProximityQuery(shape, 3)):  # fmt: skip
        with pytest.raises(sdm.Error):
            bad()


def test_stored_shapes(tmp_path):
    vertices, faces = meshes.sphere(radius=0.5)
    other = sdm.Shape(meshes.box())
    for resolution in (None, 64):
        built = sdm.Shape(vertices, faces, resolution=resolution)
        file = tmp_path / "ball.shape"
        built.save(file)
        loaded = sdm.Shape.load(str(file))
        assert repr(sdm.Shape.load(file, trusted=True)) == repr(loaded)
        file.unlink()
        assert loaded.faces.tolist() == built.faces.tolist() and repr(loaded) == repr(built)
        assert repr(pickle.loads(pickle.dumps(loaded))) == repr(built)
        for x in (0.2, 3):
            results = []
            for shape in (built, loaded):
                query = sdm.ProximityQuery(shape, other)
                query.set_pose(0, shift(x, 0.1, 0.2))
                results.append((query.separation().value, query.colliding(), query.contacts().depth.tolist()))
            assert results[0] == results[1]


def test_stored_shapes_that_are_damaged(tmp_path):
    file = tmp_path / "box.shape"
    with pytest.raises(sdm.Error, match="box.shape: there is no such file"):
        sdm.Shape.load(file)
    sdm.Shape(meshes.box()).save(file)
    stored = file.read_bytes()
    for changed, fault in ((stored[:-64], "is incomplete"), (stored[:-70] + b"1" + stored[-69:], "is damaged"),
                           (stored[:8] + b"9" + stored[9:], "another version"), (b"", "is empty"), (b"solid", "not a stored shape")):  # fmt: skip
        file.write_bytes(changed)
        with pytest.raises(sdm.Error, match=f"box.shape: .*{fault}"):
            sdm.Shape.load(file)
    with pytest.raises(sdm.Error, match="cannot write"):
        sdm.Shape(meshes.box()).save(tmp_path / "none" / "box.shape")


def test_many_bodies():
    shape = sdm.Shape(meshes.box(), resolution=64)
    query = sdm.MultiBodyQuery([shape, shape, meshes.sphere(radius=0.5), shape])
    assert len(query) == 4
    query.set_poses([shift(0, 0, 0), shift(2, 0, 0), shift(4, 0.5, 0.5), shift(2.4, 0.5, 0)])
    pairs = query.separations(max_distance=1.2)
    assert pairs.bodies.tolist() == [[0, 1], [1, 2], [1, 3], [2, 3]]
    np.testing.assert_allclose(pairs.separation, [1, 0.5, 0, 0.1], atol=1e-2)
    assert pairs.colliding.tolist() == [False, False, True, False] and pairs.witness.shape == (4, 2, 3)
    single = sdm.ProximityQuery(shape, shape)
    single.set_pose(0, query.pose(1))
    single.set_pose(1, query.pose(3))
    assert query.colliding().tolist() == [[1, 3]]
    depths = query.penetration_depths()
    assert depths.bodies.tolist() == [[1, 3]] and depths.penetration_depth[0] == single.penetration_depth().value
    bounds = depths.penetration_depth_bounds
    assert (bounds[:, 0] <= depths.penetration_depth).all() and (depths.penetration_depth <= bounds[:, 1]).all()
    contacts = query.contacts()
    assert contacts.bodies.shape == (len(contacts), 2) and [1, 3] in contacts.bodies.tolist()

    query.exclude_pair(3, 1)
    assert len(query.colliding()) == len(query.contacts()) == 0
    query.include_pair(1, 3)
    query.set_filter(1, groups=4)
    query.set_filter(3, mask=3)
    assert len(query.colliding()) == 0
    query.set_filter(3, mask=4)
    assert query.colliding().tolist() == [[1, 3]] and query.separations(max_distance=1.2).bodies.tolist() == [[0, 1], [1, 2], [1, 3]]
    query.set_filter(1, fixed=True)
    query.set_filter(3, fixed=True)
    assert len(query.colliding()) == 0
    query.set_filter(1)
    query.set_filter(3)

    nearest = query.nearest_map(0, max_distance=1.2)
    assert nearest.distance.shape == nearest.body.shape == nearest.valid.shape == (64, 64)
    assert nearest.vector.shape == (64, 64, 3)
    assert set(np.unique(nearest.body)) == {1, sdm.NONE}
    np.testing.assert_array_equal(nearest.valid, np.isfinite(nearest.distance))
    assert np.nanmin(query.distances_at_vertices(0)) == 1

    for bad in (lambda: query.set_pose(4, np.eye(4)), lambda: query.set_poses([np.eye(4)]), lambda: query.nearest_map(2),
                lambda: query.nearest_map(9), lambda: query.refit(0, meshes.box()[0]), lambda: query.refit(2, [[0, 0, 0]]), lambda: query.refit(2, None), lambda: query.refit(2, np.empty((0, 3))),
                lambda: query.pose(-1),
                lambda: query.separations(max_distance=0), lambda: query.nearest_map(0, max_distance=-1), lambda: query.set_filter(4),
                lambda: query.exclude_pair(0, 0), lambda: query.include_pair(0, -1)):  # fmt: skip
        with pytest.raises(sdm.Error):
            bad()
    with pytest.raises(sdm.Error, match="body 1"):
        sdm.MultiBodyQuery([shape, (meshes.box()[0], meshes.box()[1] + 1)])
    empty = sdm.MultiBodyQuery([])
    assert len(empty) == 0 and empty.separations().bodies.shape == (0, 2) and len(empty.contacts()) == 0
    query.refit(2, meshes.sphere(radius=0.25)[0])
    assert query.separations(max_distance=1.2).separation[1] == pytest.approx(0.75, abs=1e-2)


def test_many_moving_bodies():
    shape = sdm.Shape(meshes.box())  # of side 1
    query = sdm.MultiBodyQuery([shape] * 4)
    starts = np.array([shift(5 * i, 0, 0) for i in range(4)])
    ends = starts.copy()
    ends[0, 0, 3] = 20
    ends[2, 1, 3] = 3
    found = query.time_of_contact(starts, ends, tolerance=1e-6)
    assert found.bodies.tolist() == [[0, 1], [0, 3]] and len(found) == 2  # the third has moved away
    np.testing.assert_allclose(found.time, [4 / 20, 14 / 20], atol=1e-6)
    np.testing.assert_allclose(found.normal, [[-1, 0, 0]] * 2, atol=1e-6)
    assert (found.separation <= 1e-6).all() and not found.bounded.any()
    apart = found.witness[:, 0] - found.witness[:, 1]
    np.testing.assert_allclose(np.linalg.norm(apart, axis=1), found.separation, atol=1e-12)
    assert found.faces.dtype == np.uint32 and found.faces.shape == (2, 2) and found.faces.max() < 12
    single = sdm.time_of_contact(shape, (starts[0], ends[0]), shape, (starts[1], ends[1]), tolerance=1e-6)
    assert found.time[0] == single.time and found.witness[0].tolist() == single.witness.tolist()

    poses = query.poses_at(starts, ends, single.time)
    assert (poses[0] == single.pose1).all() and (poses[1] == single.pose2).all() and poses.shape == (4, 4, 4)

    assert query.time_of_contact(starts, ends, tolerance=1e-6, until=0.5).bodies.tolist() == [[0, 1]]
    assert query.time_of_contact(starts, ends, tolerance=1e-6, earliest_only=True).bodies.tolist() == [[0, 1]]
    query.exclude_pair(0, 1)
    assert query.time_of_contact(starts, ends, tolerance=1e-6, earliest_only=True).bodies.tolist() == [[0, 3]]
    rows = np.zeros((4, 7))
    rows[:, 3] = 1
    inside = query.time_of_contact(rows, rows, tolerance=1e-6)  # in the same place
    assert len(inside) == 5 and inside.time.tolist() == [0] * 5 and np.isnan(inside.normal).all()
    for bad in (lambda: query.time_of_contact(starts[:3], ends[:3], tolerance=1e-6), lambda: query.time_of_contact(starts, ends[:3], tolerance=1e-6),
                lambda: query.time_of_contact(starts, ends, tolerance=0), lambda: query.time_of_contact(starts, ends, tolerance=1, until=2),
                lambda: query.time_of_contact(starts, None, tolerance=1)):  # fmt: skip
        with pytest.raises(sdm.Error):
            bad()
    scaled = ends * [[1], [1], [1], [1]] @ np.diag([2, 2, 2, 1])
    with pytest.raises(sdm.Error, match="body 0: the scale"):
        query.time_of_contact(starts, scaled, tolerance=1)


def test_internal_edges():
    tile, (vertices, faces) = sdm.Shape(meshes.box()), meshes.box()  # of side 1
    for ignore in (False, True):
        query = sdm.MultiBodyQuery([tile, tile, (vertices / 2, faces)], contact_margin=0.02, ignore_internal_edges=ignore)
        for fixed in (0, 1):
            query.set_filter(fixed, fixed=True)
        query.set_poses([shift(0, 0, 0), shift(1, 0, 0), shift(0.51, 0.3, 0.95)])  # 0.05 deep, 0.01 into the second tile
        slanted = np.abs(query.contacts().normal[:, 2]) < 0.99
        assert slanted.any() != ignore and not slanted.all()


def test_a_box_slides_over_tiles_on_separating_contacts():
    box = (meshes.box()[0] * [1.2, 1.2, 0.6], meshes.box()[1])
    query = sdm.MultiBodyQuery([meshes.box()] * 6 + [box], contact_margin=0.02, ignore_internal_edges=True)
    for tile in range(6):
        query.set_filter(tile, fixed=True)
        query.set_pose(tile, shift(tile, 0, 0))
    place, velocity, step = np.array([0.3, 0.1, 0.996]), np.array([3.0, 0, 0]), 1 / 240  # 0.004 deep
    for _ in range(320):  # four tiles
        velocity[2] -= 9.81 * step
        query.set_pose(6, shift(*place))
        contacts = query.separating_contacts()
        assert len(contacts) and np.all(contacts.bodies[:, 1] == 6)
        for _ in range(20):  # without friction; the box does not turn, and is O2
            for normal, depth in zip(contacts.normal, contacts.depth):
                velocity += max(0, min(depth, 0) / step + normal @ velocity) * -normal
        place += step * velocity
    assert abs(velocity[0] - 3) < 1e-9 and abs(velocity[2]) < 1e-9
    found = query.separating_translations()
    assert len(found) and np.allclose(found.translation, [0, 0, -0.004], atol=1e-6)  # of the tiles
    assert np.allclose(found.length, 0.004, atol=1e-6) and np.all(found.length_bounds[:, 0] <= found.length)
    assert len(query.separating_contacts(most_per_patch=1)) < len(query.separating_contacts())
    with pytest.raises(sdm.Error, match="0 contacts"):
        query.separating_contacts(most_per_patch=0)
    assert repr(found) == f"sdm.SeparatingTranslations({len(found)})"


def test_internal_edges_of_two():
    x, y = np.meshgrid(np.arange(5.0), np.arange(5.0), indexing="ij")
    vertices = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)
    corner = (np.arange(4)[:, None] * 5 + np.arange(4)).ravel()
    floor = (vertices, np.concatenate([np.stack([corner, corner + 5, corner + 6], 1), np.stack([corner, corner + 6, corner + 1], 1)]))
    for ignore in (False, True):
        query = sdm.ProximityQuery(meshes.box(), floor, contact_margin=0.02, ignore_internal_edges=ignore)
        query.set_pose(0, shift(1.98, 1.3, -0.05))
        slanted = np.abs(query.contacts().normal[:, 2]) < 0.99
        assert slanted.any() != ignore and not slanted.all()


def test_compounds():
    box = sdm.Shape(meshes.box())
    dumbbell = sdm.Compound([box, meshes.box(), box], [[0, 0, 0, 1, 0, 0, 0], [3, 0, 0, 1, 0, 0, 0], [6, 0, 0, 1, 0, 0, 0]])
    assert len(dumbbell) == 3
    query = sdm.MultiBodyQuery([box, dumbbell, box], contact_margin=0.1)
    query.set_poses(np.stack([shift(2.95, 0.2, 0), shift(0, 0, 0), shift(5, 0, 1.5)]))
    found = query.separations()
    assert found.bodies.tolist() == [[0, 1], [0, 2], [1, 2]]
    assert found.parts[[0, 2]].tolist() == [[0, 1], [2, 0]]
    assert found.colliding.tolist() == [True, False, False]
    parts = [sdm.ProximityQuery(box, box) for _ in range(3)]
    for i, part in enumerate(parts):
        part.set_pose(0, shift(3 * i, 0, 0))
        part.set_pose(1, shift(5, 0, 1.5))
    assert found.separation[2] == min(part.separation().value for part in parts)
    assert query.colliding().tolist() == [[0, 1]] and query.colliding_parts().tolist() == [[0, 1]]
    depths = query.penetration_depths()
    assert depths.parts.tolist() == [[0, 1]]
    contacts = query.contacts()
    assert len(contacts) > 0 and (contacts.parts == [0, 1]).all()
    starts = np.stack([shift(-4, 0, 0), shift(0, 0, 0), shift(20, 0, 0)])
    ends = np.stack([shift(-1.5, 0, 0), shift(0, 0, 0), shift(20, 0, 0)])
    ends[0, 0, 3] = 0
    first = query.time_of_contact(starts, ends, tolerance=1e-6)
    assert first.bodies.tolist() == [[0, 1]] and first.parts.tolist() == [[0, 0]]
    np.testing.assert_allclose(first.time, 0.75, atol=1e-5)
    assert len(query.distances_at_vertices(1)) == 24
    with pytest.raises(sdm.Error, match="compound"):
        query.refit(1, meshes.box()[0])
    for bad in (lambda: sdm.Compound([]), lambda: sdm.Compound([box], np.tile(np.eye(4), (2, 1, 1)))):
        with pytest.raises(sdm.Error):
            bad()


def test_many_poses():
    gripper, part = sdm.Shape(meshes.box()), sdm.Shape(meshes.sphere(radius=0.5))
    random = np.random.default_rng(4)
    rows = np.concatenate([random.uniform(-1.2, 1.2, (60, 3)), random.normal(size=(60, 4))], axis=1)
    query = sdm.PoseQuery(gripper, [part, meshes.box()])
    query.set_pose(1, shift(2, 0, 0))
    w, x, y, z = (rows[:, 3:] / np.linalg.norm(rows[:, 3:], axis=1, keepdims=True)).T
    matrices = np.tile(np.eye(4), (60, 1, 1))
    matrices[:, :3, 0] = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)], axis=1)
    matrices[:, :3, 1] = np.stack([2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)], axis=1)
    matrices[:, :3, 2] = np.stack([2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)], axis=1)
    matrices[:, :3, 3] = rows[:, :3]
    np.testing.assert_allclose(query.separations(rows), query.separations(matrices), atol=1e-12)

    pairs = [sdm.ProximityQuery(gripper, part), sdm.ProximityQuery(gripper, meshes.box())]
    pairs[1].set_pose(1, shift(2, 0, 0))
    hits, separations, depths = query.colliding(matrices), query.separations(matrices, max_distance=0.5), query.penetration_depths(matrices)
    assert hits.shape == (60,) and hits.dtype == bool and 5 < hits.sum() < 55 and depths.shape == (60, 2)
    for i, matrix in enumerate(matrices):
        for pair in pairs:
            pair.set_pose(0, matrix)
        assert hits[i] == any(pair.colliding() for pair in pairs)
        least = min(pair.separation().value for pair in pairs)
        assert separations[i] == (least if least <= 0.5 else np.inf)
        found = [pair.penetration_depth() for pair in pairs]
        assert depths[i].tolist() == [max(d.lower for d in found), max(d.upper for d in found)]
    alone = sdm.PoseQuery(gripper, part)
    assert alone.colliding(matrices.astype(np.float32)[::2]).shape == (30,)
    assert alone.colliding([]).shape == (0,) and alone.colliding(list(matrices[:2])).shape == (2,)
    for bad in (lambda: query.colliding(np.zeros((2, 7))), lambda: query.colliding(np.eye(4)), lambda: query.colliding(np.zeros((2, 6))),
                lambda: query.colliding(2 * [np.diag([1, 2, 1, 1])]), lambda: query.separations(rows, max_distance=0), lambda: query.set_pose(2, np.eye(4)),
                lambda: query.set_pose(-1, np.eye(4)), lambda: sdm.PoseQuery(gripper, part, depth_precision=-1)):  # fmt: skip
        with pytest.raises(sdm.Error):
            bad()
    with pytest.raises(sdm.Error, match="pose 1: "):
        query.colliding([np.eye(4), np.diag([1, 2, 1, 1])])

    world = sdm.MultiBodyQuery([gripper, part])
    world.set_poses(rows[:2])
    np.testing.assert_allclose(world.pose(1), matrices[1], atol=1e-15)


def test_an_edited_body():
    vertices, faces = meshes.box()
    query = sdm.ProximityQuery((vertices, faces), (vertices, faces))
    query.set_pose(1, shift(3, 0, 0))
    query.edit(1, moved_vertices=(np.arange(len(vertices)), vertices * [2, 1, 1] - [1, 0, 0]))
    anew = sdm.ProximityQuery((vertices, faces), (vertices * [2, 1, 1] - [1, 0, 0], faces))
    anew.set_pose(1, shift(3, 0, 0))
    assert query.separation().value == anew.separation().value != 2
    shape = sdm.Shape(vertices, faces)
    shared = sdm.ProximityQuery(shape, shape)
    for bad in (lambda: query.edit(2, removed_faces=[0]), lambda: query.edit(0, removed_faces=[99]), lambda: shared.edit(0, removed_faces=[0])):
        with pytest.raises(sdm.Error):
            bad()
    assert query.separation().value == anew.separation().value


def test_self_proximity():
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    vertices = np.concatenate([square, square + [0, 0, 0.1]])
    faces = np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]])
    query = sdm.SelfProximityQuery((vertices, faces))
    separation = query.separation()
    assert separation.certainty == "exact" and separation.value == pytest.approx(0.1)
    query.refit(vertices * [1, 1, 2])
    assert query.separation().value == pytest.approx(0.2)
    contacts = query.contacts(0.3)
    assert len(contacts) > 0 and (contacts.depth >= -0.3).all()
    assert sdm.SelfProximityQuery(meshes.box(), geodesic=10.0).separation() is None
    for bad in (lambda: query.contacts(-1), lambda: query.contacts(np.nan), lambda: query.refit(vertices[1:]),
                lambda: sdm.SelfProximityQuery((vertices, faces), rings=0),
                lambda: sdm.SelfProximityQuery((vertices, faces), geodesic=-1.0)):  # fmt: skip
        with pytest.raises(sdm.Error):
            bad()


def test_threads():
    """Threads may search the same sites; a refit beside them succeeds or raises an error."""
    sites = sdm.Sites(meshes.sphere(steps=4))
    points = np.random.default_rng(0).uniform(-1, 1, (20_000, 3))
    expected = sites.closest_points(points).distance
    vertices, failures, done = sites.vertices, [], threading.Event()

    def search():
        for _ in range(5):
            try:
                if not (sites.closest_points(points).distance == expected).all():
                    failures.append("another result")
            except sdm.Error as error:
                if "being changed" not in str(error):
                    failures.append(str(error))
        done.set()

    threads = [threading.Thread(target=search) for _ in range(3)]
    for thread in threads:
        thread.start()
    while not done.is_set():
        try:
            sites.refit(vertices)
        except sdm.Error as error:
            assert "in use" in str(error)
        done.wait(0.001)
    for thread in threads:
        thread.join()
    assert not failures


def test_nothing_leaks():
    """nanobind counts its objects when Python exits."""
    program = """
import sys
import sdm, sdm._core
sys.path.insert(0, sys.argv[1])
import meshes
sdm._core.set_leak_warnings(True)

def use():
    sites = sdm.Sites(meshes.box())
    found = sites.closest_points([[2, 0, 0]], gradients=True)
    arrays = [found.distance, found.barycentric, found.vertex_gradients(), sites.vertices, sites.edges]
    m = sdm.map(meshes.sphere(), sites, resolution=64, progress=lambda step, fraction: None)
    arrays += [m.distance, m.position, m.valid, m.face, m.at_vertices(), m.bounds, m.statistics()]
    shape = sdm.Shape(meshes.box(), resolution=64)
    query = sdm.MultiBodyQuery([shape, shape], contact_margin=1)
    arrays += [query.separations().separation, query.penetration_depths().bodies, query.contacts().point1, query.nearest_map(0).distance]
    for wrong in (lambda: sdm.Sites(3), lambda: sdm.map(1, 2), lambda: sites.closest_points(3)):
        try:
            wrong()
        except sdm.Error:
            pass
    try:
        sdm.map(meshes.sphere(), sites, resolution=64, progress=lambda step, fraction: False)
    except sdm.Cancelled:
        pass
    return arrays

use()
"""
    result = subprocess.run([sys.executable, "-c", program, str(Path(__file__).parent)], capture_output=True, text=True)
    assert (result.returncode, result.stderr) == (0, "")


def test_objects_that_are_not_built():
    for kind in (sdm.Sites, sdm.Surface, sdm.Mesh, sdm.Shape, sdm.MultiBodyQuery):
        with pytest.raises(TypeError), pytest.warns(RuntimeWarning, match="uninitialized"):
            repr(kind.__new__(kind))
    sites = sdm.Sites(meshes.box())
    with pytest.raises(TypeError), pytest.warns(RuntimeWarning, match="already-initialized"):
        sites.__init__(meshes.sphere())


def test_thread_limit():
    with sdm.thread_limit(1):
        one = sdm.map(meshes.sphere(), meshes.box(), resolution=64)
    np.testing.assert_array_equal(one.distance, sdm.map(meshes.sphere(), meshes.box(), resolution=64).distance)
