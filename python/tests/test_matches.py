"""The points of O2 that belong to texels, and its geometry there."""

import copy
import pickle

import numpy as np
import pytest

import meshes
import sdm


def plate(thickness):
    return meshes.box((0, 0, 0), (2, 2, thickness))


def points(matches):
    mesh = matches.sites
    return np.einsum("hwk,hwkd->hwd", matches.barycentric, mesh.vertices[mesh.faces[np.where(matches.matched, matches.face, 0)]])


@pytest.fixture(scope="module")
def pair():
    return sdm.Surface(meshes.sphere(), resolution=64), sdm.Sites(sdm.Mesh(meshes.sphere()).transformed(np.diag([1.1, 1.05, 0.9, 1])))


def test_closest_matches_are_those_of_the_map(pair):
    matches, m = sdm.match(*pair, method="closest"), sdm.map(*pair)
    assert np.array_equal(matches.matched, m.valid)
    np.testing.assert_allclose(points(matches)[m.valid], (m.position + m.vector)[m.valid], atol=2e-6)
    assert set(np.unique(matches.kind)) == {sdm.MatchKind.NONE, sdm.MatchKind.CLOSEST}


@pytest.mark.parametrize("thickness", [0.001, 0.01, 0.04])
def test_thin_walls_are_read_on_the_right_side(thickness):
    """A plate onto one that is displaced by more than its thickness."""
    vertices, faces = plate(thickness)
    surface = sdm.Surface(vertices + [0, 0, 1.5 * thickness], faces, resolution=64)
    sites = sdm.Sites(vertices, faces)
    side = np.sign(np.cross(*(vertices[faces[:, k]] - vertices[faces[:, 0]] for k in (1, 2)))[:, 2])
    owned = surface.texel_faces != sdm.NONE
    wanted = np.where(owned, side[np.where(owned, surface.texel_faces, 0)], 0)
    skins = wanted != 0
    wrong = {}
    for method in ("closest", "facing", "ray"):
        found = sdm.match(surface, sites, method=method).transfer(side, "face", fill=False)
        wrong[method] = np.mean(found[skins] == -wanted[skins])
    assert wrong["facing"] == wrong["ray"] == 0
    assert wrong["closest"] > 0.2


def test_rays_stop_at_the_cage(pair):
    kinds = [sdm.match(*pair, method="ray", cage=cage).kind for cage in (0.01, 10)]
    assert (kinds[0] == sdm.MatchKind.FACING).sum() > 100 and not (kinds[1] == sdm.MatchKind.FACING).any()
    far = sdm.match(*pair, max_distance=0.02)
    assert (far.kind == sdm.MatchKind.TOO_FAR).any() and np.isnan(far.barycentric[far.kind == sdm.MatchKind.TOO_FAR]).all()
    turned = sdm.Sites([[-9, -9, 2], [9, -9, 2], [0, 9, 2]], [[0, 2, 1]])
    square = sdm.Surface([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], resolution=32)
    away = sdm.match(square, turned)
    assert set(np.unique(away.kind)) == {sdm.MatchKind.NONE, sdm.MatchKind.FACING_AWAY}


def test_displacements_lead_to_the_points(pair):
    matches = sdm.match(*pair, method="ray")
    m = sdm.map(*pair)
    normals = sdm.match(pair[0], sdm.Sites(meshes.sphere()), method="closest").normals(fill=False)
    ends = m.position + matches.displacements(fill=False)[..., None] * normals
    at = matches.kind == sdm.MatchKind.RAY
    assert at.sum() > 1000
    np.testing.assert_allclose(ends[at], matches.positions(fill=False)[at], atol=1e-5)
    np.testing.assert_allclose(points(matches)[at], matches.positions()[at], atol=1e-6)
    assert np.isfinite(matches.positions()).all() and np.isnan(matches.positions(fill=False)[~at]).all()


def test_normals_are_of_what_is_asked_for(pair):
    matches = sdm.match(*pair)
    vertices, faces = matches.sites.vertices, matches.sites.faces
    corners = vertices[faces]
    of_faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    of_faces /= np.linalg.norm(of_faces, axis=1, keepdims=True)
    at = matches.matched
    flat = matches.normals("flat", fill=False)
    np.testing.assert_allclose(flat[at], of_faces[matches.face[at]], atol=1e-6)
    smooth = matches.normals(fill=False)
    given = matches.normals(sdm.smooth_normals(matches.sites), fill=False)
    np.testing.assert_allclose(smooth[at], given[at], atol=1e-6)
    by_vertex = matches.normals(vertices / np.linalg.norm(vertices, axis=1, keepdims=True))
    assert by_vertex.shape == (64, 64, 3) and np.allclose(np.linalg.norm(by_vertex[at], axis=1), 1, atol=1e-6)
    np.testing.assert_allclose(matches.normals(0), matches.normals("flat"))


@pytest.mark.skipif(not sdm.has_tangents(), reason="without MikkTSpace")
def test_tangent_space_normals_are_read_as_a_renderer_does(pair):
    surface, sites = pair
    matches = sdm.match(surface, sites, method="ray")
    normals, frame = sdm.smooth_normals(meshes.sphere()), sdm.tangents(surface)
    x, y, z = np.moveaxis(matches.tangent_normals(fill=False)[matches.matched], 1, 0)[..., None]
    owner = surface.texel_faces[matches.matched]
    row, column = np.nonzero(matches.matched)
    # Weights of the corners from the areas in the atlas.
    a, b, c = np.moveaxis(surface.uvs[owner], 1, 0)
    p = np.column_stack([column + 0.5, row + 0.5])

    def area(u, v, w):
        return (v[:, 0] - u[:, 0]) * (w[:, 1] - u[:, 1]) - (v[:, 1] - u[:, 1]) * (w[:, 0] - u[:, 0])

    weights = np.column_stack([area(p, b, c), area(a, p, c), area(a, b, p)]) / area(a, b, c)[:, None]
    n = np.einsum("ik,ikd->id", weights, normals[owner])
    t = np.einsum("ik,ikd->id", weights, frame[owner][:, :, :3])
    read = x * t + y * (frame[owner][:, 0, 3:] * np.cross(n, t)) + z * n
    read /= np.linalg.norm(read, axis=1, keepdims=True)
    np.testing.assert_allclose(read, matches.normals(fill=False)[matches.matched], atol=1e-5)
    assert set(np.unique(frame[..., 3])) <= {-1, 1}
    np.testing.assert_allclose(np.linalg.norm(frame[..., :3], axis=-1), 1, atol=1e-6)


def test_walls_of_the_other_mesh():
    vertices, faces = plate(0.2)
    matches = sdm.match(sdm.Mesh(vertices * [0.5, 0.5, 1.5], faces), (vertices, faces), resolution=64)
    up = np.abs(matches.normals("flat", fill=False)[..., 2]) > 0.9
    for method in ("ball", "ray"):
        np.testing.assert_allclose(matches.thickness(method, fill=False)[up], 0.2, atol=1e-6)
    assert (matches.ambient_occlusion(16, fill=False)[matches.matched] == 1).all()  # nothing is above a convex body
    with pytest.raises(sdm.Error):
        matches.ambient_occlusion(0)
    with pytest.raises(sdm.Error):
        matches.thickness("width")


def test_matches_are_kept(pair):
    matches = sdm.match(*pair, method="ray", cage=0.05)
    for again in (copy.copy(matches), copy.deepcopy(matches), pickle.loads(pickle.dumps(matches))):
        for name in ("kind", "face", "barycentric"):
            assert getattr(again, name).tobytes() == getattr(matches, name).tobytes()
        assert np.array_equal(again.positions(), matches.positions())
    for name in ("kind", "face", "barycentric", "matched"):
        assert not getattr(matches, name).flags.writeable


def test_what_does_not_fit_is_refused(pair):
    for options in (
        {"method": "nearest"}, {"facing": 0}, {"facing": 181}, {"method": "ray", "cage": 0}, {"max_distance": 0},
        {"normals": "rough"}, {"normals": np.zeros((3, 3))}, {"normals": -1.0},
    ):  # fmt: skip
        with pytest.raises(sdm.Error):
            sdm.match(*pair, **options)
    with pytest.raises(TypeError, match="facing is True"):
        sdm.match(*pair, facing=True)
    with pytest.raises(TypeError, match="unknown option cages; did you mean cage"):
        sdm.match(*pair, cages=1)
    matches = sdm.match(*pair)
    for normals in ("rough", np.zeros((2, 3)), np.full((len(pair[1].vertices), 3), np.inf), [["a"]], None):
        with pytest.raises(sdm.Error):
            matches.normals(normals)
    with pytest.raises(sdm.Error):
        matches.transfer(np.zeros(3))


def test_matches_of_a_former_shape_are_refused():
    surface, sites = sdm.Surface(meshes.box(), resolution=32), sdm.Sites(meshes.sphere())
    matches = sdm.match(surface, sites)
    kinds = matches.kind.copy()
    sites.refit(sites.vertices * 2)
    for call in (matches.positions, matches.normals, matches.displacements, lambda: pickle.dumps(matches)):
        with pytest.raises(sdm.Error, match="match again"):
            call()
    assert np.array_equal(matches.kind, kinds)
    assert issubclass(sdm.Cancelled, Exception)
    with pytest.raises(sdm.Cancelled):
        sdm.match(surface, sites, progress=lambda step, fraction: False)
