"""Objects are pickled and copied: the same values bit for bit, in this process and in another one."""

import copy
import enum
import gc
import os
import pickle
import struct
import subprocess
import sys
import tempfile
import weakref
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import meshes
import numpy as np
import pytest

import sdm


def again(value):
    """The object after a round trip; copies agree with it."""
    copied = copy.deepcopy(value)
    assert type(copied) is type(value)
    return pickle.loads(pickle.dumps(value))


@pytest.fixture
def pair():
    return sdm.Mesh(*meshes.sphere(steps=3)), sdm.Mesh(*meshes.box())


def test_meshes(pair):
    textured = sdm.Mesh(*pair[0])
    for mesh in (*pair, textured):
        found = again(mesh)
        assert np.array_equal(found.vertices, mesh.vertices) and np.array_equal(found.faces, mesh.faces)


def test_sites_keep_their_present_shape(pair):
    sites = sdm.Sites(pair[0])
    points = np.random.default_rng(1).uniform(-2, 2, (500, 3))
    sites.refit(pair[0].vertices * [1, 2, 3])
    found = again(sites)
    expected, answer = sites.closest_points(points), found.closest_points(points)
    assert np.array_equal(answer.distance, expected.distance)
    assert np.array_equal(answer.point, expected.point)


def test_edited_sites(pair):
    sites = sdm.Sites(pair[0])
    sites.edit(removed_faces=[0, 5, 7])
    points = np.random.default_rng(3).uniform(-2, 2, (500, 3))
    found = again(sites).closest_points(points)
    assert np.allclose(found.distance, sites.closest_points(points).distance, rtol=0, atol=1e-12)
    surface = sdm.Surface(pair[0], resolution=64)
    surface.edit(removed_faces=[0])
    with pytest.raises(sdm.Error, match="edited"):
        pickle.dumps(surface)


@pytest.mark.parametrize("options", [{}, {"atlas": "triangles"}, {"precision": 0.05}, {"max_stretch": 2, "gutter": 3}])
def test_surfaces_keep_layout_and_shape(pair, options):
    surface = sdm.Surface(pair[0], **({"resolution": 128} | options if "precision" not in options else options))
    for moved in (False, True):
        if moved:
            surface.refit(pair[0].vertices * [1, 2, 3])
        found = again(surface)
        assert np.array_equal(found.texel_faces, surface.texel_faces)
        assert np.array_equal(found.vertices, surface.vertices)
        assert found.covering_radius() == surface.covering_radius()
        assert (found.atlas, found.resolution, found.rows) == (surface.atlas, surface.resolution, surface.rows)


@pytest.mark.parametrize("options", [{}, {"max_distance": 0.5}, {"engine": "reference", "sign": "none"}, {"facing": 60}])
def test_maps_keep_every_value(pair, options):
    distance_map = sdm.map(*pair, resolution=128, **options)
    found = again(distance_map)
    for name in ("distance", "vector", "site", "site_type"):
        assert getattr(found, name).tobytes() == getattr(distance_map, name).tobytes()
    assert (found.sign, found.sign_reason, found.measured) == (distance_map.sign, distance_map.sign_reason, distance_map.measured)
    assert found.without_match == distance_map.without_match
    assert np.array_equal(found.at_vertices(), distance_map.at_vertices(), equal_nan=True)
    assert found.statistics().p95 == distance_map.statistics().p95
    if not options.get("facing"):
        assert found.bounds == distance_map.bounds


def test_other_maps(pair):
    for value in (sdm.thickness(pair[1], resolution=64), sdm.map(*pair, resolution=64, along=(0, 0, 1))):
        found = again(value)
        assert found.distance.tobytes() == value.distance.tobytes()
        assert np.array_equal(found.at_vertices(), value.at_vertices(), equal_nan=True)
        assert found.check(1).verdict == value.check(1).verdict


def test_a_map_and_its_sites_stay_one(pair):
    surface, sites = sdm.Surface(pair[0], resolution=64), sdm.Sites(pair[1])
    maps = pickle.loads(pickle.dumps([sdm.map(surface, sites), sdm.map(surface, sites), surface, sites]))
    assert maps[0].surface is maps[1].surface is maps[2]
    assert maps[0].sites is maps[3]


def test_shapes(pair):
    for options in ({}, {"resolution": 64}):
        shape = again(sdm.Shape(pair[0], **options))
        query = sdm.ProximityQuery(shape, pair[1])
        assert query.penetration_depth().value == sdm.ProximityQuery(*pair).penetration_depth().value


def test_separating_translations():
    query = sdm.ProximityQuery(meshes.box(), meshes.box())
    query.set_pose(0, [[1, 0, 0, 0.75], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    expected = query.separating_translation()
    found = again(expected)
    assert (found.value, found.certainty, found.lower, found.upper) == (
        expected.value, expected.certainty, expected.lower, expected.upper)  # fmt: skip
    assert np.array_equal(found.translation, expected.translation)


def test_maps_to_the_nearest_body(pair):
    mapped, box = sdm.Shape(pair[0], resolution=64), sdm.Shape(pair[1])
    for other in (box, sdm.Compound([box, box], [[3, 0, 0, 1, 0, 0, 0], [-3, 0, 0, 1, 0, 0, 0]])):
        expected = sdm.MultiBodyQuery([mapped, other]).nearest_map(0)
        found = again(expected)
        for name in ("distance", "vector", "site", "site_type", "body", "valid"):
            assert getattr(found, name).tobytes() == getattr(expected, name).tobytes()
        if other is box:
            assert found.part is None
        else:
            assert np.array_equal(found.part, expected.part) and set(np.unique(found.part)) == {0, 1, sdm.NONE}
    state = expected.__getstate__()
    for i, wrong in ((1, state[1][:-4]), (2, b"1234"), (0, (0, *state[0][1:]))):
        made = type(expected).__new__(type(expected))
        with pytest.raises(sdm.Error, match="damaged"):
            made.__setstate__((*state[:i], wrong, *state[i + 1 :]))


def test_numbers(pair):
    distance_map = sdm.map(*pair, resolution=64)
    statistics, distance = distance_map.statistics(), distance_map.hausdorff(1e-6)
    assert repr(again(statistics)) == repr(statistics)
    names = [name for name in dir(statistics) if not name.startswith("_")]
    assert [getattr(again(statistics), name) for name in names] == [getattr(statistics, name) for name in names]
    found = again(distance)
    assert (found.value, found.lower, found.upper) == (distance.value, distance.lower, distance.upper)
    assert np.array_equal(found.witness, distance.witness)


@pytest.mark.parametrize("options", [{}, {"gradients": True, "sign": "exact"}, {"max_distance": 0.1}])
def test_closest_points(pair, options):
    points = np.random.default_rng(5).uniform(-2, 2, (300, 3))
    closest = sdm.closest_points(pair[0], points, **options)
    found = again(again(closest))  # also without the sites
    assert len(found) == len(closest) and repr(found) == repr(closest)
    for name in ("distance", "point", "face", "barycentric", "site", "site_type"):
        assert getattr(found, name).tobytes() == getattr(closest, name).tobytes()
    if options.get("gradients"):
        assert np.array_equal(found.gradient, closest.gradient)
        for a, b in zip(found.vertex_gradients(), closest.vertex_gradients()):
            assert np.array_equal(a, b)
    else:
        assert found.gradient is None
        with pytest.raises(sdm.Error, match="gradients=True"):
            found.vertex_gradients()


@pytest.mark.parametrize("options", [{}, {"max_distance": 0.3, "sites": True, "sign": "none"}])
def test_fields(pair, options):
    field = sdm.distance_field(pair[0], spacing=0.25, **options)
    found = again(field)
    for name in ("distance", "transform", "accuracy", "sign", "sign_reason", "site", "site_type"):
        assert np.array_equal(getattr(found, name), getattr(field, name), equal_nan=name == "distance")
    points = np.random.default_rng(5).uniform(-0.9, 0.9, (50, 3))
    for name in ("value", "lower", "upper"):
        assert getattr(found.sample(points), name).tobytes() == getattr(field.sample(points), name).tobytes()


def test_names_of_faces():
    names = sdm.FaceNames("group", ["top", "side"], np.array([0, 1, 0, 1], np.uint32))
    found = again(names)
    assert (found.kind, found.names) == (names.kind, names.names)
    assert np.array_equal(found.of_face, names.of_face)


def test_what_cannot_be_stored_says_so(pair):
    surface = sdm.Surface(pair[0], resolution=64)
    distance_map = sdm.map(surface, pair[1])
    surface.refit(pair[0].vertices * 2)
    with pytest.raises(sdm.Error, match="refitted"):
        pickle.dumps(distance_map)
    with pytest.raises(sdm.Error, match="compute it again"):
        pickle.dumps(sdm.self_map(pair[0], resolution=64))


def test_damaged_pickles_are_refused(pair):
    state = sdm.Mesh(*pair[1]).__getstate__()
    mesh = sdm.Mesh.__new__(sdm.Mesh)
    with pytest.raises(sdm.Error, match="damaged"):
        mesh.__setstate__((state[0][:-1], *state[1:]))
    with pytest.raises(sdm.Error):
        mesh.__setstate__((state[0][:24], *state[1:]))  # one vertex, many faces


# Regression: the items of a state were used without a check, which ended the process.
def test_states_of_another_length_or_type_are_refused(pair):
    distance_map = sdm.map(*pair, resolution=64)
    for value in (sdm.Mesh(*pair[1]), sdm.Sites(pair[1]), sdm.Surface(pair[1], resolution=64), sdm.Shape(pair[1]),
                  distance_map._core, distance_map.statistics(), distance_map.hausdorff(),
                  sdm.closest_points(pair[1], [[0, 0, 3]]), sdm.distance_field(pair[1], spacing=0.5),
                  sdm.FaceNames("group", ["a"], np.zeros(12, np.uint32))):  # fmt: skip
        state = value.__getstate__()
        for wrong in ((), state[:-1], (*state, None), tuple(None for _ in state)):
            made = type(value).__new__(type(value))
            with pytest.raises((sdm.Error, TypeError)):
                made.__setstate__(wrong)
    surface, sites, rule, values, ms = distance_map._core.__getstate__()
    for i, wrong in ((4, b"\x09" * len(values[4])), (9, b"\x01"), (1, values[1][:-4]), (5, ("none",)), (6, (77, "", None))):
        made = type(distance_map._core).__new__(type(distance_map._core))
        with pytest.raises(sdm.Error, match="damaged"):
            made.__setstate__((surface, sites, rule, (*values[:i], wrong, *values[i + 1 :]), ms))


def distance_of(sites, points):
    return sites.closest_points(points).distance


@pytest.mark.parametrize("method", ["spawn", "forkserver"])
def test_other_processes(pair, method):
    sites = sdm.Sites(pair[0])
    points = np.random.default_rng(2).uniform(-2, 2, (100, 3))
    with ProcessPoolExecutor(1, mp_context=get_context(method)) as pool:
        assert np.array_equal(pool.submit(distance_of, sites, points).result(), distance_of(sites, points))


class Dataset:
    """As torch.utils.data.Dataset: workers get a copy, and items go back."""

    def __init__(self, sites, surface):
        self.sites, self.surface = sites, surface

    def __getitem__(self, i):
        points = np.random.default_rng(i).uniform(-2, 2, (20, 3))
        return i, self.sites.closest_points(points), sdm.map(self.surface, self.sites)


def item_of(dataset, i):
    return dataset[i]


@pytest.mark.parametrize("method", ["spawn", "forkserver"])
def test_data_loaders(pair, method):
    dataset = Dataset(sdm.Sites(pair[0]), sdm.Surface(pair[1], resolution=32))
    with ProcessPoolExecutor(2, mp_context=get_context(method)) as pool:
        for i, closest, distance_map in pool.map(item_of, [dataset] * 4, range(4)):
            expected = dataset[i]
            assert closest.distance.tobytes() == expected[1].distance.tobytes()
            assert distance_map.distance.tobytes() == expected[2].distance.tobytes()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
def test_forks_compute():
    """A child has none of the threads of its parent, and starts its own."""
    program = """
import os, sys
sys.path.insert(0, sys.argv[1])
import meshes, sdm
def work():
    return sdm.map(meshes.sphere(), meshes.box(), resolution=32, progress=lambda step, fraction: True).distance.tobytes()
with sdm.thread_limit(1):  # oneTBB has its threads in the parent only
    expected = work()
    child = os.fork()
    if child == 0:
        os._exit(0 if work() == expected else 3)
    print(os.waitpid(child, 0)[1])
"""
    tests = os.path.dirname(meshes.__file__)
    result = subprocess.run([sys.executable, "-c", program, tests], capture_output=True, text=True, timeout=300)
    assert result.stdout.strip() == "0", result.stdout + result.stderr


def test_joblib(pair):
    joblib = pytest.importorskip("joblib")
    dataset = Dataset(sdm.Sites(pair[0]), sdm.Surface(pair[1], resolution=32))
    found = joblib.Parallel(2)(joblib.delayed(item_of)(dataset, i) for i in range(4))
    assert all(closest.distance.tobytes() == dataset[i][1].distance.tobytes() for i, closest, _ in found)


def public_objects(pair):
    """An object of each public class, at least."""
    mesh, box = sdm.Mesh(pair[0]), sdm.Mesh(pair[1])
    yield from (mesh, sdm.Sites(mesh), sdm.Surface(mesh, resolution=64), sdm.Shape(mesh), sdm.Compound([mesh, sdm.Shape(box)]))
    distance_map = sdm.map(sdm.Surface(mesh, resolution=32), sdm.Sites(box))
    halves = sdm.FaceNames("group", ["a", "b"], np.arange(len(mesh.faces), dtype=np.uint32) % 2)
    places, groups = distance_map.places(names=halves), distance_map.check_groups({"a": 0.1, "b": 2}, halves)
    yield from (distance_map, distance_map.bounds, distance_map.statistics(), distance_map.hausdorff(), distance_map.check(2))
    yield from (distance_map.check(0.1), halves, places, places.largest[0], groups, groups.groups[0])
    yield from (sdm.match(mesh, box, resolution=32), sdm.MatchKind.RAY, sdm.SiteType.EDGE)
    yield sdm.bake(mesh, box, vertex_colors=np.abs(mesh.vertices) / 9, resolution=32)
    yield sdm.bake(mesh, box, channels=["position", "face"], samples=4, resolution=32)
    field, closest = sdm.distance_field(mesh, spacing=0.5), sdm.closest_points(mesh, [[0, 0, 3]])
    batch = sdm.closest_points_batch([mesh], [[[0, 0, 3]]])
    yield from (closest, batch, batch[0], field, field.sample([[0, 0, 0.1]]))
    yield sdm.Sites(mesh).first_hits([[0, 0, 3], [9, 9, 9]], [[0, 0, -1], [0, 0, 1]])
    query, bodies = sdm.ProximityQuery(*pair, contact_margin=0.1), sdm.MultiBodyQuery(list(pair), contact_margin=0.1)
    yield from (query, bodies, sdm.PoseQuery(*pair), sdm.SelfProximityQuery(mesh), sdm.scene("letters"), sdm.thread_limit(1))
    yield from (query.contacts(), bodies.contacts(), query.separating_translation(), query.penetration_depth())
    yield from (bodies.separations(), bodies.penetration_depths(), bodies.separating_translations(), nearest_map(pair))
    there, back = np.eye(4), np.eye(4)
    there[0, 3], back[0, 3] = 5, -5
    yield sdm.time_of_contact(mesh, (there, back), box, None, tolerance=1e-6)
    yield bodies.time_of_contact([there, np.eye(4)], [back, np.eye(4)], tolerance=1e-6)
    metres, millimetres = mesh, (mesh.vertices * 1000, mesh.faces)
    alignment = sdm.align(metres, millimetres)
    yield from (alignment, alignment.freedoms[0], sdm.alignment_doubts(metres, millimetres, alignment)[0])
    metrics = sdm.surface_metrics(mesh, box, precision=0.1)
    yield from (metrics, metrics["hd"], sdm.coverage(box, mesh, 0.5), sdm.weld(box)[1], sdm.remove_islands(box, faces=1)[1])
    yield from (sdm.scene("letters").bodies[0], sdm.make_scan(box, triangles=500))
    yield from (sdm.Error("a fault"), sdm.Cancelled("cancelled"))
    with tempfile.TemporaryDirectory() as folder:
        cloud = os.path.join(folder, "points.xyz")
        np.savetxt(cloud, mesh.vertices * 1.1)
        distances = sdm.measure_points(cloud, box, os.path.join(folder, "out.ply"), tolerance=0.1, island_points=2,
                                       tolerance_table={"all": 1}, names=sdm.FaceNames("group", ["all"], np.zeros(12, np.uint32)))  # fmt: skip
        yield from (distances, distances.max)


def nearest_map(pair):
    return sdm.MultiBodyQuery([sdm.Shape(pair[0], resolution=32), pair[1]]).nearest_map(0)


#: What pickle and copy refuse: objects that compute, and are no values.
NOT_STORED = (sdm.ProximityQuery, sdm.MultiBodyQuery, sdm.PoseQuery, sdm.SelfProximityQuery, sdm.Scene, sdm.thread_limit)


def assert_equal(a, b, name):
    """Equal in all public properties, bit for bit."""
    assert type(a) is type(b), name
    if isinstance(a, np.ndarray):
        assert a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes(), name
    elif isinstance(a, dict):
        assert_equal(list(a.items()), list(b.items()), name)
    elif isinstance(a, (list, tuple)):
        assert len(a) == len(b), name
        for i, (x, y) in enumerate(zip(a, b)):
            assert_equal(x, y, f"{name}[{i}]")
    elif type(a).__module__ != "sdm" or isinstance(a, (enum.Enum, BaseException)):
        assert repr(a) == repr(b), name  # also NaN
    else:
        assert repr(a) == repr(b), name
        for key in dir(a):
            if key.startswith("_") or callable(value := getattr(a, key)):
                continue
            assert_equal(value, getattr(b, key), f"{name}.{key}")


def test_every_class_is_stored_or_refuses(pair):
    classes = {value for name in sdm.__all__ if isinstance(value := getattr(sdm, name), type)}
    for value in public_objects(pair):
        name = type(value).__name__
        classes.discard(type(value))
        if isinstance(value, NOT_STORED):
            for refused in (pickle.dumps, copy.copy, copy.deepcopy):
                with pytest.raises(TypeError, match=f"^an? {name} cannot be pickled or copied; "):
                    refused(value)
            continue
        for protocol in (2, pickle.HIGHEST_PROTOCOL):
            assert_equal(value, pickle.loads(pickle.dumps(value, protocol)), name)
        assert_equal(value, copy.deepcopy(value), name)
    assert not classes, "without an object in public_objects()"


def test_compounds_keep_their_shapes(pair):
    shape = sdm.Shape(pair[1])
    poses = np.array([np.eye(4)] * 2)
    poses[1, 0, 3] = 3
    expected = sdm.Compound([shape, shape], poses)
    found, again_shape = pickle.loads(pickle.dumps((expected, shape)))
    answers = [sdm.MultiBodyQuery([c, pair[0]]).separations() for c in (expected, found)]
    assert_equal(answers[0], answers[1], "separations")
    state = expected.__getstate__()
    assert state[0][0] is state[0][1] is shape and len(found) == 2


# Regression: a picture of roughness and metallic was made of one number for each texel, and read beyond the last one.
def test_stored_channels_have_their_components(pair):
    baked = sdm.bake(pair[0], pair[1], vertex_colors=np.abs(pair[0].vertices) / 9, resolution=32)
    (state,) = baked.__getstate__()
    head, texels = "<BIQQ", 32 * 32  # number of the channel, texels of a row, components, numbers
    before, found, after = state.partition(struct.pack(head, 0, 32, 3, 3 * texels))
    assert found
    made = type(baked).__new__(type(baked))
    for channel, components in ((0, 1), (1, 1), (1, 3), (2, 3), (3, 1), (0, 5)):
        values = np.zeros(components * texels, np.float32).tobytes()
        wrong = before + struct.pack(head, channel, 32, components, components * texels) + values + after[12 * texels :]
        with pytest.raises(sdm.Error, match="damaged"):
            made.__setstate__((wrong,))


def test_damaged_values_are_refused(pair):
    distance_map = sdm.map(sdm.Surface(pair[0], resolution=32), sdm.Sites(pair[1]))
    for value in (distance_map.check(2), distance_map.places(), distance_map.hausdorff(), sdm.align(*pair),
                  sdm.ProximityQuery(*pair, contact_margin=1).contacts(),
                  sdm.bake(pair[0], pair[1], vertex_colors=np.abs(pair[0].vertices) / 9, resolution=32),
                  sdm.bake(pair[0], pair[1], channels=["position", "face"], samples=4, resolution=32)):  # fmt: skip
        (state,) = value.__getstate__()
        made = type(value).__new__(type(value))
        for wrong in (state[:-1], state + b"\0", b"", state[: len(state) // 2]):
            with pytest.raises(sdm.Error, match="damaged"):
                made.__setstate__((wrong,))
        for at in range(0, min(len(state), 400)):  # each byte: another value, or an error
            try:
                made.__setstate__((state[:at] + b"\xff" + state[at + 1 :],))
            except sdm.Error:
                continue
            repr(made)
            made = type(value).__new__(type(value))


def test_weak_references(pair):
    values = [value for value in public_objects(pair) if not isinstance(value, enum.Enum)]
    references = [weakref.ref(value) for value in values]
    assert all(reference() is value for reference, value in zip(references, values))
    del values
    gc.collect()
    assert [type(reference()).__name__ for reference in references if reference() is not None] == []
