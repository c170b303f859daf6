"""Batches of closest points: the same bits as calls for each item, whatever the form of meshes and points."""

import pickle

import hypothesis
import numpy as np
import pytest
from hypothesis import strategies

import meshes
import sdm

NAMES = ("distance", "point", "face", "barycentric", "site", "site_type", "gradient")
SHAPES = [meshes.box(), meshes.sphere(steps=1), meshes.sphere(steps=3, radius=0.5), meshes.soup(2, 7)]


def assert_same(item, expected):
    for name in NAMES:
        found, single = getattr(item, name), getattr(expected, name)
        assert (found is None) == (single is None)
        if single is not None:
            assert found.dtype == single.dtype and found.tobytes() == single.tobytes(), name
    if expected.gradient is not None:
        there = expected.site_type != sdm.SiteType.NONE
        corners, derivatives = item.vertex_gradients()
        where, values = expected.vertex_gradients()
        np.testing.assert_array_equal(corners[there], where[there])
        np.testing.assert_array_equal(derivatives, values)


@hypothesis.given(
    which=strategies.lists(strategies.integers(0, len(SHAPES) - 1), max_size=6),
    counts=strategies.lists(strategies.integers(0, 40), min_size=6, max_size=6),
    seed=strategies.integers(0, 2**32 - 1),
    max_distance=strategies.sampled_from([np.inf, 0.7]),
    gradients=strategies.booleans(),
)
def test_ragged_batches_equal_single_calls(which, counts, seed, max_distance, gradients):
    random = np.random.default_rng(seed)
    mesh_list = [(v + random.normal(0, 0.1, v.shape), f) for v, f in (SHAPES[k] for k in which)]
    points = [random.uniform(-2, 2, (n, 3)) for n in counts[: len(which)]]
    options = {"max_distance": max_distance, "gradients": gradients}
    batch = sdm.closest_points_batch(mesh_list, points, **options)
    assert len(batch) == len(which) and batch.offsets.tolist() == [0, *np.cumsum([len(p) for p in points])]
    assert len(batch.distance) == batch.offsets[-1]
    for item, mesh, p in zip(batch, mesh_list, points):
        assert_same(item, sdm.closest_points(*mesh, p, **options))


@hypothesis.given(
    count=strategies.integers(1, 9),
    n=strategies.integers(0, 30),
    seed=strategies.integers(0, 2**32 - 1),
    threads=strategies.sampled_from([1, 0]),
    sign=strategies.sampled_from(["none", "exact"]),
)
def test_stacks_equal_refits(count, n, seed, threads, sign):
    random = np.random.default_rng(seed)
    vertices, faces = meshes.sphere(steps=2)
    stack = vertices * random.uniform(0.5, 2, (count, 1, 3)) + random.normal(0, 1, (count, 1, 3))
    points = random.uniform(-2, 2, (count, n, 3))
    with sdm.thread_limit(threads):
        batch = sdm.closest_points_batch(stack, faces, points, gradients=True, sign=sign)
    assert batch.distance.shape == (count, n) and batch.point.shape == (count, n, 3)
    assert batch.vertex_gradients()[1].shape == (count, n, 3, 3)
    sites = sdm.Sites(stack[0], faces)
    for i in range(count):
        sites.refit(stack[i])
        assert_same(batch[i], sites.closest_points(points[i], gradients=True, sign=sign))


def test_forms_of_meshes_and_points():
    box, sphere = meshes.box(), meshes.sphere()
    points = np.random.default_rng(1).uniform(-2, 2, (2, 20, 3))
    expected = sdm.closest_points_batch([box, sphere], points)
    for form in (
        sdm.closest_points_batch((sdm.Sites(box), sdm.Mesh(*sphere)), list(points)),
        sdm.closest_points_batch([box[0], sphere[0]], [box[1], sphere[1]], points),
        sdm.closest_points_batch([box, sphere], points.tolist()),
    ):
        assert form.distance.tobytes() == expected.distance.tobytes()
    shared = sdm.closest_points_batch([box, sphere], points[0])
    assert shared.distance.shape == (2, 20)
    assert np.array_equal(shared[-1].distance, sdm.closest_points(*sphere, points[0]).distance)
    one = sdm.closest_points_batch([box], [[2, 0.5, 0.5]])
    assert one.distance.tolist() == [[1]]
    faces = np.stack([box[1], box[1]])
    twice = sdm.closest_points_batch(np.stack([box[0], 2 * box[0]]), faces, points.astype(np.float32))
    again = sdm.closest_points(2 * box[0], box[1], points[1].astype(np.float32))
    assert np.array_equal(twice[1].distance, again.distance)


def test_empty_batches():
    for batch in (sdm.closest_points_batch([], []), sdm.closest_points_batch([], np.empty((0, 5, 3))),
                  sdm.closest_points_batch(np.empty((0, 4, 3)), meshes.box()[1], np.empty((0, 5, 3)))):  # fmt: skip
        assert len(batch) == 0 and list(batch) == [] and batch.offsets.tolist() == [0]


def test_shapes_without_items_and_ragged_lists():
    assert sdm.closest_points_batch([], np.empty((0, 5, 3))).distance.shape == (0, 5)
    assert sdm.closest_points_batch([], np.zeros((7, 3))).point.shape == (0, 7, 3)
    box, sphere = meshes.box(), meshes.sphere()
    expected = sdm.closest_points(*sphere, [[0, 0, 3], [0, 0, 2]]).distance
    for points in ([[], [[0, 0, 3], [0, 0, 2]]], [(), np.array([[0, 0, 3], [0, 0, 2.0]])]):
        batch = sdm.closest_points_batch([box, sphere], points)
        assert batch.offsets.tolist() == [0, 0, 2] and np.array_equal(batch[1].distance, expected)
    assert sdm.closest_points_batch([box, sphere], [[], []]).distance.shape == (0,)
    lists = [box[0].tolist(), sphere[0].tolist()], [box[1].tolist(), sphere[1].tolist()]
    batch = sdm.closest_points_batch(*lists, [[[0, 0, 3]], [[0, 0, 3], [0, 0, 2]]])
    assert np.array_equal(batch[1].distance, expected)
    for ragged in ([[0, 0, 1], [0, 0]], [[[0, 0, 1]], [[0, 0, 1], [0, 0]]]):
        with pytest.raises(sdm.Error, match="points.* must be an array of numbers"):
            sdm.closest_points_batch([box, sphere], ragged)


def test_sites_may_be_given_several_times():
    sites = sdm.Sites(meshes.box())
    batch = sdm.closest_points_batch([sites] * 40, [[2, 0.5, 0.5]])
    assert (batch.distance == 1).all()
    sites.refit(2 * meshes.box()[0])  # nothing is in use any more
    assert sites.closest_points([[3, 0.5, 0.5]]).distance == 1


def test_errors_name_the_item():
    box = meshes.box()
    points = np.zeros((2, 1, 3))
    for bad, match in (
        (lambda: sdm.closest_points_batch([box, (box[0], box[1] + 5)], points), "item 1"),
        (lambda: sdm.closest_points_batch([box, box], [points[0], [[np.nan, 0, 0]]]), "item 1.*NaN"),
        (lambda: sdm.closest_points_batch([box, (box[0], box[1][1:])], points, sign="exact"), "item 1.*open"),
        (lambda: sdm.closest_points_batch(np.stack([box[0], box[0] * np.nan]), box[1], points), "item 1"),
        (lambda: sdm.closest_points_batch([box[0], box[0][1:]], box[1], points), "item 1"),
        (lambda: sdm.closest_points_batch([box, box], points[:1]), "points of 1 items, but 2 meshes"),
        (lambda: sdm.closest_points_batch([box[0]], [box[1], box[1]], points), "faces of 2 items"),
        (lambda: sdm.closest_points_batch(box[0], box[1], points), "3 dimensions"),
        (lambda: sdm.closest_points_batch([box, box], [points[0], [0, 0, 0]]), r"points\[1\]"),
        (lambda: sdm.closest_points_batch(box[0], points), "list of meshes"),
    ):
        with pytest.raises(sdm.Error, match=match):
            bad()
    with pytest.raises(sdm.Error, match="gradients=True"):
        sdm.closest_points_batch([box, box], points).vertex_gradients()


def test_progress_and_cancellation():
    box = meshes.box()
    points = np.zeros((50, 10, 3))
    seen = []
    sdm.closest_points_batch([box] * 50, points, progress=lambda step, fraction: seen.append(fraction))
    assert seen == sorted(seen) and seen[-1] == 1
    with pytest.raises(sdm.Cancelled):
        sdm.closest_points_batch([box] * 50, points, progress=lambda step, fraction: False)


def test_batches_travel():
    batch = sdm.closest_points_batch([meshes.box()], np.zeros((1, 4, 3)), gradients=True)
    again = pickle.loads(pickle.dumps(batch))
    assert_again = [np.array_equal(getattr(again, name), getattr(batch, name)) for name in (*NAMES, "offsets")]
    assert all(assert_again) and repr(again) == repr(batch) == "sdm.ClosestPointsBatch(1 items, 4 points)"
