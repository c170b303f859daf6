"""Closest points, signs and derivatives, by brute force and by finite differences."""

import numpy as np
import pytest

import meshes
import oracle
import sdm
import sdm._gradients

RANDOM = np.random.default_rng(7)
POINTS = RANDOM.uniform(-2, 2, (500, 3))
CASES = {"box": meshes.box(), "sphere": meshes.sphere(), "soup": meshes.soup(1)}


@pytest.fixture(params=CASES)
def mesh(request):
    return CASES[request.param]


def test_against_brute_force(mesh):
    vertices, faces = mesh
    distances, points = oracle.closest_points(vertices, faces, POINTS)
    found = sdm.closest_points(vertices, faces, POINTS)
    # The site is closest to within 1e-6 of the diagonal of the mesh and the points.
    np.testing.assert_allclose(found.distance, distances, rtol=0, atol=7e-6)
    reference = sdm.closest_points(vertices, faces, POINTS, engine="reference")
    np.testing.assert_allclose(reference.distance, distances, rtol=0, atol=1e-14)
    np.testing.assert_allclose(reference.point, points, atol=1e-7)
    np.testing.assert_allclose(np.linalg.norm(found.point - POINTS, axis=1), found.distance, atol=1e-14)


def test_gpu_equals_reference(mesh):
    try:
        found = sdm.closest_points(*mesh, POINTS, sign="automatic", engine="gpu")
    except sdm.Error as error:
        pytest.skip(str(error))
    reference = sdm.closest_points(*mesh, POINTS, sign="automatic", engine="reference")
    for name in ("distance", "point", "face"):
        np.testing.assert_array_equal(getattr(found, name), getattr(reference, name))


def test_faces_and_weights_give_the_point(mesh):
    vertices, faces = mesh
    found = sdm.closest_points(vertices, faces, POINTS)
    corners = vertices[faces[found.face]]
    np.testing.assert_allclose(np.einsum("nk,nkx->nx", found.barycentric, corners), found.point, atol=1e-14)
    assert (found.barycentric >= 0).all()
    np.testing.assert_allclose(found.barycentric.sum(axis=1), 1, atol=1e-14)


def test_sites(mesh):
    vertices, faces = mesh
    sites = sdm.Sites(mesh)
    found = sites.closest_points(POINTS)
    zeros = (found.barycentric == 0).sum(axis=1)
    for point, face, site, kind, zero in zip(found.point, found.face, found.site, found.site_type, zeros):
        if kind == sdm.SiteType.VERTEX:
            assert zero == 2 and site in faces[face]
            np.testing.assert_allclose(point, vertices[site], atol=1e-14)
        elif kind == sdm.SiteType.EDGE:
            assert zero >= 1 and set(sites.edges[site]) < set(faces[face])
        else:
            assert kind == sdm.SiteType.FACE and site == face


def test_nothing_within_the_maximum_distance():
    found = sdm.Sites(meshes.box()).closest_points([[5, 0, 0], [1.5, 0.5, 0.5]], max_distance=1, gradients=True)
    assert found.distance.tolist() == [np.inf, 0.5]
    assert found.face[0] == found.site[0] == sdm.NONE and found.site_type[0] == sdm.SiteType.NONE
    assert np.isnan(found.point[0]).all() and np.isnan(found.barycentric[0]).all()
    assert (found.gradient[0] == 0).all() and (found.vertex_gradients()[1][0] == 0).all()


@pytest.mark.parametrize("mesh", [meshes.box(), meshes.sphere()], ids=["box", "sphere"])
def test_signs(mesh):
    inside = oracle.winding_numbers(*mesh, POINTS) > 0.5
    sites = sdm.Sites(mesh)
    np.testing.assert_array_equal(sites.contains(POINTS), inside)
    np.testing.assert_array_equal(sites.contains(POINTS, sign="winding"), inside)
    unsigned = sites.closest_points(POINTS).distance
    np.testing.assert_array_equal(sites.signed_distance(POINTS), np.where(inside, -unsigned, unsigned))
    np.testing.assert_array_equal(sites.closest_points(POINTS, sign="automatic").distance, sites.signed_distance(POINTS))


def test_open_meshes_have_no_exact_sign():
    vertices, faces = meshes.sphere()
    sites = sdm.Sites(vertices, faces[1:])
    assert not sites.closed
    for query in (sites.signed_distance, sites.contains):
        with pytest.raises(sdm.Error, match="O2 is open"):
            query(POINTS)
    # By generalised winding numbers; points near the hole are left out.
    far = np.linalg.norm(POINTS - vertices[faces[0]].mean(axis=0), axis=1) > 0.5
    inside = oracle.winding_numbers(vertices, faces[1:], POINTS) > 0.5
    np.testing.assert_array_equal(sites.contains(POINTS, sign="winding")[far], inside[far])
    assert (sites.closest_points(POINTS, sign="automatic").distance >= 0).all()


def test_refit():
    vertices, faces = meshes.sphere()
    sites = sdm.Sites(vertices, faces)
    before = sites.closest_points(POINTS)
    old_vertices = sites.vertices
    moved = vertices * [1, 2, 0.5] + 0.25
    sites.refit(moved)
    expected = sdm.closest_points(moved, faces, POINTS)
    np.testing.assert_array_equal(sites.closest_points(POINTS).distance, expected.distance)
    np.testing.assert_array_equal(sites.vertices, moved)
    # Earlier results are those of the earlier shape, also where they are computed by the first access.
    np.testing.assert_array_equal(old_vertices, vertices)
    first = sdm.closest_points(vertices, faces, POINTS)
    np.testing.assert_array_equal(before.barycentric, first.barycentric)
    np.testing.assert_array_equal(before.point, first.point)
    for bad in (vertices[1:], vertices * np.nan, vertices[:, :2], "text"):
        with pytest.raises(sdm.Error):
            sites.refit(bad)
    np.testing.assert_array_equal(sites.vertices, moved)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 1e38])
def test_points_that_are_not_finite(bad):
    vertices, faces = meshes.box()
    for sites, sign in ((sdm.Sites(vertices, faces), "exact"), (sdm.Sites(vertices, faces[1:]), "winding")):
        for k in range(3):
            points = np.zeros((3, 3))
            points[1, k] = bad
            for call in (sites.closest_points, lambda p: sites.signed_distance(p, sign=sign),
                         lambda p: sites.contains(p, sign=sign)):  # fmt: skip
                for given in (points, points[1:2]):
                    with pytest.raises(sdm.Error, match="query point .* NaN or beyond 1e37"):
                        call(given)


@pytest.mark.parametrize("faces_left", [None, 1])
def test_signs_of_single_points_are_those_of_a_batch(faces_left):
    vertices, faces = meshes.sphere()
    sign = "exact" if faces_left is None else "winding"
    sites = sdm.Sites(vertices, faces[faces_left:])
    together = sites.signed_distance(POINTS, sign=sign)
    single = [sites.signed_distance(p[None], sign=sign)[0] for p in POINTS]
    np.testing.assert_allclose(single, together, rtol=0, atol=7e-6)
    assert ((np.array(single) < 0) == (together < 0)).all() and (together < 0).any()
    sites.refit(vertices + [5, 0, 0])
    np.testing.assert_allclose(sites.signed_distance(POINTS + [5, 0, 0], sign=sign), together, rtol=0, atol=7e-6)


def test_options_out_of_range():
    sites = sdm.Sites(meshes.box())
    for options in ({"sign": "inside"}, {"engine": "fast"}, {"engine": "gl"}, {"max_distance": 0}, {"max_distance": -1},
                    {"max_distance": np.nan}, {"progress": 3}):  # fmt: skip
        with pytest.raises(sdm.Error):
            sites.closest_points(POINTS, **options)
    with pytest.raises(sdm.Error, match="gradients=True"):
        sites.closest_points(POINTS).vertex_gradients()
    assert sites.closest_points(POINTS).gradient is None


def differences(function, x, step=1e-6):
    """Central differences of a function of an array, shape (*values, *x)."""
    columns = []
    for index in np.ndindex(x.shape):
        sides = []
        for sign in (1, -1):
            moved = x.copy()
            moved[index] += sign * step
            sides.append(function(moved))
        columns.append((sides[0] - sides[1]) / (2 * step))
    return np.stack(columns, axis=-1).reshape(*columns[0].shape, *x.shape)


@pytest.mark.parametrize("sign", ["none", "exact"])
def test_derivatives_by_finite_differences(sign):
    vertices, faces = meshes.box()
    vertices = vertices + np.random.default_rng(3).normal(0, 0.05, vertices.shape)
    points = np.random.default_rng(4).uniform(-0.7, 1.7, (40, 3))

    def distance(p, v):
        return sdm.closest_points(v, faces, p, sign=sign, engine="reference").distance

    found = sdm.closest_points(vertices, faces, points, sign=sign, gradients=True, engine="reference")
    by_points = differences(lambda p: distance(p, vertices), points)
    expected = np.zeros_like(by_points)
    expected[np.arange(len(points)), np.arange(len(points))] = found.gradient
    np.testing.assert_allclose(by_points, expected, atol=1e-7)
    np.testing.assert_allclose(np.linalg.norm(found.gradient, axis=1), 1, atol=1e-12)

    by_vertices = differences(lambda v: distance(points, v), vertices)
    where, derivatives = found.vertex_gradients()
    expected = np.zeros_like(by_vertices)
    for i, (corners, values) in enumerate(zip(where, derivatives)):
        for corner, value in zip(corners, values):
            expected[i, corner] += value
    np.testing.assert_allclose(by_vertices, expected, atol=1e-7)

    # The chain rule of sdm.torch, without torch.
    upstream = np.random.default_rng(5).normal(size=len(points))
    np.testing.assert_allclose(sdm._gradients.of_points(found.gradient, upstream),
                               np.einsum("n,npx->px", upstream, by_points), atol=1e-6)  # fmt: skip
    of_vertices = np.zeros_like(vertices)
    np.add.at(of_vertices, where, sdm._gradients.of_corners(found.gradient, found.barycentric, upstream))
    np.testing.assert_allclose(of_vertices, np.einsum("n,nvx->vx", upstream, by_vertices), atol=1e-6)
    of_points, in_one_pass = found._pull_back(upstream, len(vertices))
    np.testing.assert_allclose(of_points, sdm._gradients.of_points(found.gradient, upstream), atol=1e-14)
    np.testing.assert_allclose(in_one_pass, of_vertices, atol=1e-13)


def test_derivatives_are_0_on_the_surface():
    vertices, faces = meshes.box()
    found = sdm.closest_points(vertices, faces, [[1, 0.5, 0.25]], gradients=True)
    assert found.distance[0] == 0 and (found.gradient == 0).all()


@pytest.mark.parametrize("shift", [3.0, 0.7, 0.0])
def test_signs_of_many_and_of_few_points_agree(shift):
    """Of many points, the sides of all faces are found at once; of few, of single ones, or by winding numbers. Apart,
    intersecting and coincident solids."""
    vertices, faces = meshes.sphere(steps=5)
    mesh = np.concatenate([vertices, vertices + [shift, 0, 0]]), np.concatenate([faces, faces + len(vertices)])
    random = np.random.default_rng(7)
    corners = mesh[0][mesh[1][random.integers(len(mesh[1]), size=20_000)]]
    on_faces = np.einsum("nk,nkx->nx", random.dirichlet((1, 1, 1), len(corners)), corners)
    points = on_faces + random.normal(0, 0.02, on_faces.shape)
    many = sdm.Sites(*mesh).contains(points)
    few = [sdm.Sites(*mesh).contains(part) for part in np.array_split(points, 20)]
    assert np.array_equal(many, np.concatenate(few))
    centres = np.array([[0, 0, 0], [shift, 0, 0]])
    inner, outer = (np.linalg.norm(points[:, None] - centres, axis=2).min(axis=1) < radius for radius in (0.995, 1.0))
    assert many[inner].all() and not many[~outer].any()
