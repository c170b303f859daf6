"""Arrays of any dtype, order and layout, and those that are none."""

import ctypes

import hypothesis.extra.numpy as arrays
import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given

import meshes
import sdm

POINTS = np.array([[2, 0, 0], [0, 3, 1], [1, 1, 5], [-2, -1, 0]])
FLOATS = [np.float16, np.float32, np.float64, np.longdouble]
INTEGERS = [np.int8, np.uint8, np.int16, np.uint16, np.int32, np.uint32, np.int64, np.uint64]


@pytest.fixture(scope="module")
def sites():
    return sdm.Sites(meshes.box())


def layouts(array):
    """The same numbers in other memory layouts."""
    padded = np.zeros((2 * len(array), array.shape[1] + 2), array.dtype)
    padded[::2, 1:-1] = array
    frozen = array.copy()
    frozen.flags.writeable = False
    record = np.zeros(len(array), [("tag", "u1"), ("row", array.dtype, array.shape[1])])
    record["row"] = array
    swapped = array.astype(array.dtype.newbyteorder())
    return {
        "C": np.ascontiguousarray(array),
        "F": np.asfortranarray(array),
        "strided": padded[::2, 1:-1],
        "reversed": np.ascontiguousarray(array[::-1, ::-1])[::-1, ::-1],
        "read-only": frozen,
        "unaligned": record["row"],
        "swapped": swapped,
        "broadcast": np.broadcast_to(array, array.shape),
        "list": array.tolist(),
    }


@pytest.mark.parametrize("dtype", FLOATS + [d for d in INTEGERS if np.issubdtype(d, np.signedinteger)])
def test_points_of_any_dtype_and_layout(sites, dtype):
    expected = sites.closest_points(POINTS.astype(np.float64))
    for name, points in layouts(POINTS.astype(dtype)).items():
        found = sites.closest_points(points)
        np.testing.assert_array_equal(found.distance, expected.distance, err_msg=name)
        np.testing.assert_array_equal(found.point, expected.point, err_msg=name)


@pytest.mark.parametrize("dtype", INTEGERS)
def test_faces_of_any_dtype_and_layout(dtype):
    vertices, faces = meshes.box()
    for name, layout in layouts(faces.astype(dtype)).items():
        np.testing.assert_array_equal(sdm.Mesh(vertices, layout).faces, faces, err_msg=name)


@pytest.mark.parametrize("dtype", FLOATS)
def test_vertices_of_any_dtype_and_layout(dtype):
    vertices, faces = meshes.box()
    for name, layout in layouts(vertices.astype(dtype)).items():
        np.testing.assert_array_equal(sdm.Mesh(layout, faces).vertices, vertices, err_msg=name)


class Exporter:
    """An array that can only be reached through DLPack."""

    def __init__(self, array, device=1):
        self.array, self.device = array, device

    def __dlpack__(self, **kwargs):
        return self.array.__dlpack__()

    def __dlpack_device__(self):
        return (self.device, 0)


@pytest.mark.parametrize("dtype", [np.float32, np.float64, np.int64])
def test_dlpack(sites, dtype):
    expected = sites.closest_points(POINTS).distance
    np.testing.assert_array_equal(sites.closest_points(Exporter(POINTS.astype(dtype))).distance, expected)


def test_dlpack_of_another_device(sites):
    with pytest.raises(sdm.Error, match="copy the array to the CPU"):
        sites.closest_points(Exporter(POINTS.astype(np.float32), device=2))


def test_buffers(sites):
    buffer = (ctypes.c_double * 6)(2, 0, 0, 0, 3, 1)
    points = np.ctypeslib.as_array(buffer).reshape(2, 3)
    np.testing.assert_array_equal(sites.closest_points(memoryview(points)).distance,
                                  sites.closest_points(POINTS[:2]).distance)


def test_no_points(sites):
    found = sites.closest_points(np.empty((0, 3)), gradients=True)
    assert len(found) == 0
    assert found.distance.shape == found.face.shape == found.site.shape == (0,)
    assert found.point.shape == found.barycentric.shape == found.gradient.shape == (0, 3)
    assert [a.shape for a in found.vertex_gradients()] == [(0, 3), (0, 3, 3)]
    assert sites.contains(np.empty((0, 3), np.float32)).shape == (0,)
    assert sites.signed_distance(np.empty((0, 3))).shape == (0,)


@pytest.mark.parametrize("points", [
    np.zeros(3), np.zeros((1, 2)), np.zeros((1, 4)), np.zeros((1, 1, 3)), np.zeros(()), 7, "text", None, [], [[1, 2], [3]],
    np.zeros((2, 3), complex), np.zeros((2, 3), bool), np.full((2, 3), "x"), np.full((2, 3), None), object(),
    [[np.nan, 0, 0]], [[np.inf, 0, 0]], [[1e38, 0, 0]], np.full((1, 3), np.longdouble("1e400")),
    np.zeros((1, 3), "M8[s]"), {1: 2}, [["a", "b", "c"]],
])  # fmt: skip
def test_bad_points(sites, points):
    with pytest.raises(sdm.Error):
        sites.closest_points(points)


@pytest.mark.parametrize(("vertices", "faces", "message"), [
    (meshes.box()[0], meshes.box()[1] + 1, "vertex 8 of 8"),
    (meshes.box()[0], meshes.box()[1] - 1, "vertex -1"),
    (meshes.box()[0], meshes.box()[1] + 2**40, "index out of range"),
    (meshes.box()[0], np.full((1, 3), 0xFFFFFFFF, np.uint32), "index out of range"),
    (meshes.box()[0], np.full((1, 3), 2**64 - 1, np.uint64), "index out of range"),
    (meshes.box()[0], meshes.box()[1].astype(float), "integers"),
    (meshes.box()[0], meshes.box()[1][:, :2], "shape"),
    (meshes.box()[0], np.empty((0, 3), int), "no triangles"),
    (np.empty((0, 3)), meshes.box()[1], "index out of range"),
    (meshes.box()[0][:, :2], meshes.box()[1], "shape"),
    (meshes.box()[0] * np.nan, meshes.box()[1], "NaN"),
    (meshes.box()[0] * 1e38, meshes.box()[1], "1e37"),
    (meshes.box()[0] * 0, meshes.box()[1], "degenerate"),
    (meshes.box()[0], None, "must be"),
    ("no such file", None, "no such file"),
])  # fmt: skip
@pytest.mark.parametrize("build", [
    sdm.Mesh, sdm.Sites, sdm.Surface, sdm.Shape,
    lambda *mesh: sdm.closest_points(*mesh, [[0, 0, 0]]) if mesh[1] is not None else sdm.Sites(mesh[0]),
    lambda *mesh: sdm.map(mesh if mesh[1] is not None else mesh[0], meshes.box(), resolution=32),
    lambda *mesh: sdm.map(meshes.box(), mesh if mesh[1] is not None else mesh[0], resolution=32),
    lambda *mesh: sdm.SelfProximityQuery(mesh if mesh[1] is not None else mesh[0]),
])  # fmt: skip
def test_bad_meshes(build, vertices, faces, message):
    with pytest.raises(sdm.Error, match=message):
        build(vertices, faces)


@given(arrays.arrays(
    dtype=st.sampled_from([np.float32, np.float64, np.int32, np.int64, np.uint8, bool, complex]),
    shape=arrays.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=4)))  # fmt: skip
def test_any_array_gives_a_result_or_an_error(array):
    sites = sdm.Sites(meshes.box())
    try:
        found = sites.closest_points(array)
    except sdm.Error as error:
        assert str(error)
        return
    assert array.ndim == 2 and array.shape[1] == 3
    assert np.isfinite(found.distance).all() and found.distance.shape == (len(array),)


@given(arrays.arrays(dtype=st.sampled_from([np.float32, np.float64]), shape=st.tuples(st.integers(0, 5), st.just(3))),
       arrays.arrays(dtype=st.sampled_from([np.int8, np.int64, np.uint32]), shape=st.tuples(st.integers(0, 4), st.just(3)),
                     elements=st.integers(0, 5)))  # fmt: skip
def test_any_mesh_gives_a_result_or_an_error(vertices, faces):
    try:
        found = sdm.closest_points(vertices, faces, [[0.5, 0.25, 0.125]])
    except sdm.Error as error:
        assert str(error)
        return
    weights = found.barycentric[0]
    assert (weights >= 0).all() and weights.sum() == pytest.approx(1)
    corners = vertices[faces[found.face[0]]].astype(float)
    np.testing.assert_allclose(weights @ corners, found.point[0], atol=1e-6 * max(1, np.abs(vertices).max()))


def test_results_are_independent_of_inputs(sites):
    points = POINTS.astype(np.float64)
    found = sites.closest_points(points, gradients=True)
    expected = sites.closest_points(points.copy(), gradients=True)
    points[:] = 100
    np.testing.assert_array_equal(found.distance, expected.distance)
    np.testing.assert_array_equal(found.gradient, expected.gradient)


def test_arrays_outlive_their_objects():
    closest = sdm.closest_points(*meshes.sphere(), POINTS)
    face, point = closest.face, closest.point
    vertices, faces = sdm.Mesh(meshes.sphere())
    texel_faces = sdm.Surface(meshes.sphere(), resolution=64).texel_faces
    distance = sdm.map(meshes.sphere(), meshes.box(), resolution=64).distance
    copies = [a.copy() for a in (face, point, vertices, faces, texel_faces, distance)]
    del closest
    for _ in range(3):
        sdm.map(meshes.sphere(steps=3), meshes.box(), resolution=128)
    for array, copy in zip((face, point, vertices, faces, texel_faces, distance), copies):
        np.testing.assert_array_equal(array, copy)
    with pytest.raises(ValueError, match="read-only"):
        distance[0, 0] = 1




LAYOUTS = {
    "C": np.ascontiguousarray,
    "F": np.asfortranarray,
    "strided": lambda a: np.repeat(np.repeat(a, 2, axis=0), 3, axis=-1)[::2, ..., ::3],
    "reversed": lambda a: np.ascontiguousarray(a[::-1])[::-1],
    "swapped": lambda a: a.astype(a.dtype.newbyteorder()),
    "read-only": lambda a: np.frombuffer(a.tobytes(), a.dtype).reshape(a.shape),
    "unaligned": lambda a: np.frombuffer(b"x" + a.tobytes(), np.uint8)[1:].view(a.dtype).reshape(a.shape),
    "dlpack": Exporter,
    "list": lambda a: a.tolist(),
}


def calls():
    """Every call that takes an array of points or indices: from the array to what must not depend on its form."""
    vertices, faces = meshes.sphere()
    sites, surface = sdm.Sites(vertices, faces), sdm.Surface(vertices, faces, resolution=32)
    field = sdm.distance_field(sites, shape=(4, 4, 4))
    points = {
        "closest_points": lambda p: sites.closest_points(p).point,
        "signed_distance": lambda p: sites.signed_distance(p),
        "contains": lambda p: sites.contains(p),
        "origins": lambda p: sites.first_hits(p, np.ones(np.shape(POINTS))).t,
        "directions": lambda p: sites.first_hits(np.zeros(np.shape(POINTS)), p).t,
        "occluded": lambda p: sites.occluded(p, np.ones(np.shape(POINTS))),
        "sample": lambda p: field.sample(p).value,
        "align_points": lambda p: sdm.align_points(p, sites, samples=64).transform,
        "bounds": lambda p: sdm.distance_field(sites, shape=(2, 2, 2), bounds=p).distance,
    }
    moved = {
        "refit": lambda v: sites.refit(v) or sites.vertices,
        "refit of surfaces": lambda v: surface.refit(v) or surface.vertices,
        "shapes": lambda v: sdm.Shape(v, faces).faces,
        "self": lambda v: sdm.SelfProximityQuery((v, faces)).separation().value,
    }
    return points, moved


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("dtype", [np.float16, np.float32, np.float64, np.int8, np.int16, np.int64])
def test_every_call_takes_any_form(layout, dtype):
    points, moved = calls()
    corners = np.array([[-1, -2, -1], [1, 2, 3]])
    for name, call in points.items():
        given_points = corners if name == "bounds" else POINTS
        expected = call(given_points.astype(np.float64))
        np.testing.assert_array_equal(call(LAYOUTS[layout](given_points.astype(dtype))), expected, err_msg=name)
    vertices = np.round(meshes.sphere()[0] * 4).astype(np.float64)
    for name, call in moved.items():
        np.testing.assert_array_equal(call(LAYOUTS[layout](vertices.astype(dtype))), call(vertices), err_msg=name)


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("dtype", [np.uint8, np.int16, np.uint32, np.int64, np.uint64])
def test_edits_take_any_form(layout, dtype):
    form = LAYOUTS[layout]
    sites, expected = sdm.Sites(meshes.sphere()), sdm.Sites(meshes.sphere())
    corners = np.array([[1, 2, 3], [4, 5, 6]])
    one = np.array([7, 9])
    indices = one if layout == "strided" else form(one.astype(dtype))
    sites.edit(added_faces=form(corners.astype(dtype)), removed_faces=indices, reconnected_faces=([0], form(corners[:1].astype(dtype))))
    expected.edit(added_faces=corners, removed_faces=one, reconnected_faces=([0], corners[:1]))
    np.testing.assert_array_equal(sites.faces, expected.faces)


@given(data=st.data())
def test_slices_of_any_array(data):
    """Views of larger arrays, whatever their strides: the numbers are those of a copy."""
    dtype = data.draw(st.sampled_from([np.float16, np.float32, np.float64, np.int16, np.uint8]))
    whole = data.draw(arrays.arrays(dtype, (6, 3, 4, 3), elements=st.integers(0, 9)))
    order = data.draw(st.permutations(range(4)))
    view = whole.transpose(order)
    index = [data.draw(st.slices(n)) if i < 2 else data.draw(st.integers(0, n - 1)) for i, n in enumerate(view.shape)]
    view = view[tuple(index)]
    sites = sdm.Sites(meshes.box())
    if view.shape[1] != 3:
        with pytest.raises(sdm.Error, match="shape"):
            sites.closest_points(view)
        return
    found = sites.closest_points(view)
    np.testing.assert_array_equal(found.distance, sites.closest_points(view.astype(np.float64).copy()).distance)
