"""Rays, occlusion and times of contact, against brute force in NumPy."""

import numpy as np
import pytest

import meshes
import sdm


def brute_force_hits(vertices, faces, origins, directions):
    """The first hits by Möller & Trumbore: (t, face), each (n,); t is infinite without one."""
    a, b, c = (vertices[faces[:, k]][None] for k in range(3))
    o, d = origins[:, None], directions[:, None]
    normal = np.cross(d, c - a)
    determinant = ((b - a) * normal).sum(-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        u = ((o - a) * normal).sum(-1) / determinant
        across = np.cross(o - a, b - a)
        v = (d * across).sum(-1) / determinant
        t = ((c - a) * across).sum(-1) / determinant
    t = np.where((u >= 0) & (v >= 0) & (u + v <= 1) & (t >= 0), t, np.inf)
    return t.min(axis=1), t.argmin(axis=1)


@pytest.fixture(scope="module", params=["sphere", "soup"])
def mesh(request):
    return meshes.sphere() if request.param == "sphere" else meshes.soup(3, 60)


def rays(count=400, seed=0):
    random = np.random.default_rng(seed)
    return random.uniform(-2, 2, (count, 3)), random.normal(size=(count, 3))


def test_first_hits(mesh):
    origins, directions = rays()
    sites = sdm.Sites(mesh)
    hits = sites.first_hits(origins, directions)
    t, face = brute_force_hits(*mesh, origins, directions)
    assert len(hits) == len(t) and 20 < np.isfinite(t).sum() < len(t)
    np.testing.assert_allclose(hits.t, t, rtol=1e-9)
    missed = np.isinf(t)
    np.testing.assert_array_equal(hits.face, np.where(missed, sdm.NONE, face))
    assert np.isnan(hits.barycentric[missed]).all()
    points = np.einsum("nk,nkx->nx", hits.barycentric[~missed], mesh[0][mesh[1][hits.face[~missed]]])
    np.testing.assert_allclose(points, (origins + hits.t[:, None] * directions)[~missed], atol=1e-9)
    np.testing.assert_array_equal(sites.occluded(origins, directions), ~missed)


def test_limits_of_rays(mesh):
    origins, directions = rays()
    sites = sdm.Sites(mesh)
    t = sites.first_hits(origins, directions).t
    nearer = sites.first_hits(origins, directions, t_max=0.5)
    np.testing.assert_array_equal(nearer.t, np.where(t <= 0.5, t, np.inf))
    # Just after the first hit comes the next one, or none.
    after = sites.first_hits(origins, directions, t_min=np.where(np.isfinite(t), t * (1 + 1e-9), 0.0))
    assert (after.t[np.isfinite(t)] > t[np.isfinite(t)]).all()
    np.testing.assert_array_equal(sites.occluded(origins, directions, t_max=t.astype(np.longdouble)), np.isfinite(t))


def test_forms_of_rays():
    sites = sdm.Sites(meshes.box())
    origins, directions = [[2, 0, 0]], [[-1, 0, 0]]
    expected = sites.first_hits(np.array(origins, float), np.array(directions, float)).t
    for dtype in (np.float32, np.int8, np.uint8, np.float16):
        shifted = np.array(origins, dtype)
        np.testing.assert_array_equal(sites.first_hits(shifted, np.asfortranarray(directions)).t, expected)
    assert len(sites.first_hits(np.empty((0, 3)), np.empty((0, 3)))) == 0
    assert sites.occluded(np.empty((0, 3)), np.empty((0, 3)), t_max=np.empty(0)).shape == (0,)
    for bad in ({"directions": [[0, 0, 0]]}, {"directions": [[1, 0, 0]] * 2}, {"t_min": -1}, {"t_min": np.nan}, {"t_max": [1, 2]},
                {"t_max": "far"}, {"origins": [[np.nan, 0, 0]]}, {"t_max": np.zeros((1, 1))}):  # fmt: skip
        with pytest.raises(sdm.Error):
            sites.first_hits(**{"origins": origins, "directions": directions, **bad})
    with pytest.raises(sdm.Cancelled):
        sites.first_hits(*rays(100000), progress=lambda step, fraction: False)


def test_free_distances_and_ambient_occlusion():
    plane = ([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    lid = (np.array(plane[0]) * 100 + [0, 0, 0.5], plane[1])
    m = sdm.map(plane, lid, resolution=64)
    free = m.free_distances()
    assert (free[m.valid] <= 0.5).all() and (free[m.valid] > 0.49).all() and (free[~m.valid] == 0).all()
    covered = m.ambient_occlusion(64, seed=1)
    assert covered.shape == (64, 64) and covered.dtype == np.float32
    assert np.isnan(covered[~m.valid]).all() and np.nanmax(covered) < 0.05
    np.testing.assert_array_equal(covered, m.ambient_occlusion(64, seed=1))
    below = sdm.map(plane, (lid[0] - [0, 0, 1], lid[1]), resolution=64)
    assert np.nanmin(below.ambient_occlusion(16)) == 1
    assert np.nanmin(m.ambient_occlusion(16, max_distance=0.4)) == 1
    for options in ({"rays": 0}, {"max_distance": 0}):
        with pytest.raises(sdm.Error):
            m.ambient_occlusion(**options)


def shifted(x, y=0.0, z=0.0):
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


def test_time_of_contact():
    box = meshes.box()
    found = sdm.time_of_contact(box, (shifted(11), shifted(-9)), box, None, tolerance=1e-7)
    assert found.contact and found.time == pytest.approx(0.5, abs=1e-7) and found.separation <= 1e-7
    np.testing.assert_allclose(found.pose1, shifted(1), atol=1e-5)
    np.testing.assert_array_equal(found.pose2, np.eye(4))
    assert found.certainty == "exact"
    np.testing.assert_allclose(found.normal, [1, 0, 0], atol=1e-9)
    assert found.witness.shape == (2, 3) and found.witness.dtype == np.float64
    np.testing.assert_allclose(found.witness[0] - found.witness[1], found.separation * found.normal, atol=1e-12)
    for body, face in enumerate(found.faces):  # both contain their point, in a plane across x
        corners = np.array(box[0])[np.array(box[1])[face]] + (found.pose1, found.pose2)[body][:3, 3]
        np.testing.assert_allclose(corners[:, 0], found.witness[body][0], atol=1e-12)
    # Less than the unit of the time.
    bounded = sdm.time_of_contact(box, None, box, (shifted(1001.3, 0.1), shifted(-1370, 0.13)), tolerance=1e-14)
    assert bounded.contact and bounded.certainty == "bounded" and 1e-14 < bounded.separation < 1e-10
    # No contact is missed, however thin and fast; and none is found where they pass each other.
    thin = (np.array(box[0]) * [1e-6, 1, 1], box[1])
    assert sdm.time_of_contact(thin, (shifted(1000), shifted(-1000)), box, None, tolerance=1e-9).contact
    past = sdm.time_of_contact(box, (shifted(11, 1.5), shifted(-9, 1.5)), sdm.Shape(box), np.eye(4), tolerance=1e-3)
    assert not past.contact and past.time == 1
    assert sdm.time_of_contact(box, None, box, shifted(0.5), tolerance=1e-3).time == 0
    query = sdm.ProximityQuery(box, box)
    query.set_pose(0, found.pose1)
    assert query.separation().value == pytest.approx(found.separation, abs=1e-12)
    for motion, tolerance in ((None, 0), (None, np.nan), (np.zeros((3, 4, 4)), 1), (np.eye(3), 1), ((np.eye(4), np.eye(4) * 2), 1),
                              ((np.eye(4), np.diag([2, 2, 2, 1])), 1), ("text", 1)):  # fmt: skip
        with pytest.raises(sdm.Error):
            sdm.time_of_contact(box, motion, box, None, tolerance=tolerance)
