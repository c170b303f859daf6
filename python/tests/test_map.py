"""Maps, their bounds and their files."""

import html
import json
import os
import pickle
import re
import struct
import subprocess
import sys

import numpy as np
import pytest

import meshes
import oracle
import sdm


@pytest.fixture(scope="module")
def distance_map():
    return sdm.map(meshes.sphere(), meshes.box(), resolution=256)


def rotation_and_shift():
    c, s = np.cos(0.5), np.sin(0.5)
    return np.array([[c, -s, 0, 0.5], [s, c, 0, -1], [0, 0, 1, 2], [0, 0, 0, 1]])


def test_closest_points_on_faces(distance_map):
    m = distance_map
    vertices, faces = meshes.box()
    face, (u, v) = m.closest_face[m.valid], m.closest_uv[m.valid].T
    corners = np.asarray(vertices)[np.asarray(faces)[face]]
    weights = np.stack((1 - u - v, u, v), axis=1)
    assert weights.min() > -1e-6
    closest = (weights[:, :, None] * corners).sum(axis=1)
    np.testing.assert_allclose(closest, m.position[m.valid] + m.vector[m.valid], atol=1e-5)
    assert (m.closest_face[~m.valid] == sdm.NONE).all() and np.isnan(m.closest_uv[~m.valid]).all()


def test_arrays_are_documented():
    for name in ("distance", "vector", "site", "site_type", "face", "position", "normal", "closest_face", "closest_uv"):
        assert "(H, W" in getattr(sdm.DistanceMap, name).__doc__, name


def test_arrays(distance_map):
    m = distance_map
    assert m.distance.shape == m.face.shape == m.site.shape == m.site_type.shape == m.valid.shape == (256, 256)
    assert m.vector.shape == m.position.shape == m.normal.shape == (256, 256, 3)
    types = {"distance": "f4", "vector": "f4", "position": "f8", "normal": "f4", "face": "u4", "site": "u4",
             "site_type": "u1", "valid": "?"}  # fmt: skip
    for name, dtype in types.items():
        array = getattr(m, name)
        assert array.dtype == np.dtype(dtype) and array.flags.c_contiguous and not array.flags.writeable, name
        assert getattr(m, name) is array or name == "face"
    np.testing.assert_array_equal(m.valid, m.face != sdm.NONE)
    np.testing.assert_array_equal(m.valid, np.isfinite(m.distance))
    assert m.sign == "exact" and m.sign_reason


def test_values(distance_map):
    m, (vertices, faces) = distance_map, meshes.sphere()
    where = np.flatnonzero(m.valid.ravel())[::37]
    position, vector = m.position.reshape(-1, 3)[where], m.vector.reshape(-1, 3)[where]
    distance, owner = m.distance.ravel()[where], m.face.ravel()[where]
    corners = vertices[faces[owner]]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    np.testing.assert_allclose(m.normal.reshape(-1, 3)[where], normal, atol=1e-6)
    np.testing.assert_allclose(((position - corners[:, 0]) * normal).sum(axis=1), 0, atol=1e-14)
    expected, _ = oracle.closest_points(*meshes.box(), position)
    inside = oracle.winding_numbers(*meshes.box(), position) > 0.5
    accuracy = m.bounds.accuracy
    np.testing.assert_allclose(distance, np.where(inside, -expected, expected), atol=accuracy)
    np.testing.assert_allclose(np.linalg.norm(vector, axis=1), expected, atol=accuracy)


@pytest.mark.parametrize("engine", ["reference", "gl", "gpu"])
def test_engines_agree(distance_map, engine):
    try:
        other = sdm.map(meshes.sphere(), meshes.box(), resolution=256, engine=engine)
    except sdm.Error as error:
        if engine == "reference":
            raise
        pytest.skip(str(error))
    np.testing.assert_array_equal(other.face, distance_map.face)
    np.testing.assert_allclose(other.distance, distance_map.distance, atol=other.bounds.accuracy + distance_map.bounds.accuracy)


@pytest.mark.parametrize("sign", ["automatic", "none"])
def test_bounds_hold_between_texels(sign):
    m = sdm.map(meshes.sphere(), meshes.box(), resolution=64, sign=sign)
    vertices, faces = meshes.sphere()
    weights = np.random.default_rng(1).dirichlet((1, 1, 1), size=(len(faces), 50))
    points = np.einsum("fnk,fkx->fnx", weights, vertices[faces]).reshape(-1, 3)
    sites = sdm.Sites(meshes.box())
    distances = sites.closest_points(points, sign=sign).distance
    assert m.bounds.lower <= distances.min() and distances.max() <= m.bounds.upper
    assert m.bounds.upper - distances.max() <= 2 * m.bounds.covering_radius
    assert m.bounds.covering_radius <= m.surface.covering_radius() * (1 + 1e-6)


@pytest.mark.parametrize("sign", ["automatic", "none"])
@pytest.mark.parametrize("center", [(50, 0, 0), (0, 0, 0), (0, 0, 3)])
def test_bounds_hold_beyond_the_maximum_distance(sign, center):
    """Of a sphere of radius 1 that is far outside, deep inside, or partly inside of a box."""
    box = meshes.box((-4, -4, -4), (4, 4, 4))
    m = sdm.map(meshes.sphere(center=center), box, resolution=64, sign=sign, max_distance=0.5)
    assert m.surface is not None and m.bounds.upper == np.inf
    truth = sdm.Sites(box).closest_points(meshes.sphere(center=center, steps=4)[0], sign=sign).distance
    assert m.bounds.lower <= truth.min() + 0.02  # the vertices of the finer sphere are outside of the other
    largest = m.hausdorff()
    assert largest.lower <= np.abs(truth).max() + 0.02 and largest.upper == np.inf


def test_bounds_of_estimated_signs_hold_for_absolute_distances():
    vertices, faces = meshes.box()
    m = sdm.map(meshes.sphere(radius=0.4, center=(0.5, 0.5, 0.9)), (vertices, faces[1:]), resolution=64, sign="winding")
    assert m.bounds.lower == -m.bounds.upper and np.nanmax(np.abs(m.distance)) <= m.bounds.upper


def test_statistics_and_vertices(distance_map):
    s = distance_map.statistics()
    values = distance_map.distance[distance_map.valid]
    assert s.texels == distance_map.valid.sum() and s.negative_texels == (values < 0).sum()
    assert (s.min, s.max) == (values.min(), values.max()) and s.min < s.p50 < s.p95 < s.p99 <= s.max
    assert "DistanceStatistics" in repr(s)
    vertices, _ = meshes.sphere()
    at_vertices = distance_map.at_vertices()
    expected = sdm.Sites(meshes.box()).signed_distance(vertices).astype(np.float32)
    np.testing.assert_array_equal(at_vertices, expected)


def test_faces_without_texels_count_in_statistics_and_have_no_place_in_arrays():
    mesh = sdm.Mesh(*meshes.sphere(steps=5))
    surface = sdm.Surface(mesh, resolution=32)
    coarse, fine = sdm.map(surface, meshes.box()), sdm.map(mesh, meshes.box(), resolution=512)
    faces = surface.texel_faces
    assert coarse.distance.shape == coarse.site.shape == faces.shape == (32, 32)
    assert (coarse.valid == (faces != sdm.NONE)).all()
    without = np.setdiff1d(np.arange(len(mesh.faces)), faces)
    assert len(without) > 1000
    assert coarse.statistics().texels == np.count_nonzero(faces != sdm.NONE) + len(without)
    for name in ("mean", "rms", "p95"):
        assert getattr(coarse.statistics(), name) == pytest.approx(getattr(fine.statistics(), name), abs=0.005)
    assert pickle.loads(pickle.dumps(coarse)).statistics().rms == coarse.statistics().rms


def test_prepared_surface_and_sites():
    surface, sites = sdm.Surface(meshes.sphere(), resolution=128), sdm.Sites(meshes.box())
    m = sdm.map(surface, sites)
    assert m.surface is surface and m.sites is sites
    np.testing.assert_array_equal(m.distance, sdm.map(meshes.sphere(), meshes.box(), resolution=128).distance)
    with pytest.raises(sdm.Error, match="has its resolution"):
        sdm.map(surface, sites, resolution=64)
    with pytest.raises(sdm.Error, match="cannot be transformed"):
        sdm.map(surface, sites, transform=np.eye(4))


def test_refitted_objects_make_a_map_stale():
    surface, sites = sdm.Surface(meshes.sphere(), resolution=64), sdm.Sites(meshes.box())
    m = sdm.map(surface, sites)
    kept = m.distance.copy()
    surface.refit(surface.vertices * 2)
    for stale in (lambda: m.position, lambda: m.normal, m.statistics, m.at_vertices, lambda: m.bounds, lambda: repr(m)):
        with pytest.raises(sdm.Error, match="refitted"):
            stale()
    np.testing.assert_array_equal(m.distance, kept)
    again = sdm.map(surface, sites)
    np.testing.assert_array_equal(again.face, m.face)
    sites.refit(sites.vertices + 1)
    with pytest.raises(sdm.Error, match="refitted"):
        again.at_vertices()
    again.statistics()


def test_transform():
    matrix = rotation_and_shift()
    vertices, faces = meshes.sphere()
    moved = sdm.map((vertices, faces), meshes.box(), resolution=128, transform=matrix)
    expected = vertices @ matrix[:3, :3].T + matrix[:3, 3]
    np.testing.assert_allclose(moved.surface.vertices, expected, atol=1e-14)
    np.testing.assert_allclose(sdm.Mesh(vertices, faces).transformed(matrix.astype(np.float32)).vertices, expected, atol=1e-6)
    # A reflection keeps the faces outwards.
    mirror = np.diag([-1, 1, 1, 1])
    assert (sdm.Mesh(vertices, faces).transformed(mirror).faces != faces).any()
    for bad in (np.eye(3), np.eye(4) * 2, np.full((4, 4), np.nan), "text", [[1, 2], [3, 4]]):
        with pytest.raises(sdm.Error):
            sdm.map((vertices, faces), meshes.box(), resolution=64, transform=bad)


def test_options():
    m = sdm.map(meshes.sphere(), meshes.box(), precision=0.05)
    assert m.bounds.covering_radius <= 0.05
    with pytest.raises(sdm.Error, match="precision excludes resolution"):
        sdm.map(meshes.sphere(), meshes.box(), precision=0.05, resolution=64)
    for options in ({"resolution": 8}, {"resolution": -1}, {"resolution": 2**40}, {"precision": -1}, {"precision": np.nan},
                    {"atlas": "uv"}, {"atlas": "other"}, {"engine": "other"}, {"sign": "other"}, {"max_distance": 0},
                    {"max_stretch": 0}, {"gutter": -1}):  # fmt: skip
        with pytest.raises(sdm.Error):
            sdm.map(meshes.sphere(), meshes.box(), **{"resolution": 64, **options} if "precision" not in options else options)
    near = sdm.map(meshes.sphere(), meshes.box(), resolution=64, max_distance=0.3)
    assert 0 < near.valid.sum() < (near.face != sdm.NONE).sum() and near.bounds.upper == np.inf
    assert sdm.map(meshes.sphere(), meshes.box(), resolution=64, atlas="triangles").surface.atlas == "triangles"


def test_progress_and_cancellation():
    steps = []
    sdm.map(meshes.sphere(), meshes.box(), resolution=64, progress=lambda step, fraction: steps.append((step, fraction)))
    assert {"map"} <= {step for step, _ in steps} and all(0 <= fraction <= 1 for _, fraction in steps)
    with pytest.raises(sdm.Cancelled):
        sdm.map(meshes.sphere(), meshes.box(), resolution=64, progress=lambda step, fraction: False)
    assert issubclass(sdm.Cancelled, sdm.Error) and issubclass(sdm.Error, ValueError)

    def fails(step, fraction):
        raise KeyError(step)

    with pytest.raises(KeyError):
        sdm.map(meshes.sphere(), meshes.box(), resolution=64, progress=fails)
    with pytest.raises(KeyError):
        sdm.closest_points(*meshes.box(), np.zeros((10, 3)), progress=fails)
    # A callback may use the objects that it waits for, but not change them.
    sites = sdm.Sites(meshes.box())
    errors = []

    def meddles(step, fraction):
        sites.closest_points([[0, 0, 0]])
        try:
            sites.refit(sites.vertices)
        except sdm.Error as error:
            errors.append(str(error))

    sites.closest_points(np.zeros((10, 3)), progress=meddles)
    assert errors and "in use" in errors[0]


def test_interrupts():
    # Sent by another thread while the computation runs; a search of all these points would take seconds.
    program = """
import os, signal, threading, time
import numpy as np, sdm
points = np.random.default_rng(0).uniform(-1, 1, (6_000_000, 3))
vertices = np.random.default_rng(1).uniform(-1, 1, (60_000, 3))
sites = sdm.Sites(vertices, np.arange(60_000).reshape(-1, 3))
threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
try:
    sites.closest_points(points)
    print("finished")
except KeyboardInterrupt:
    print("interrupted")
"""
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert result.stdout == "interrupted\n", result.stderr


def test_files(distance_map, tmp_path):
    for name, head in (("m.exr", b"v/1\x01"), ("m.png", b"\x89PNG"), ("m.glb", b"glTF"), ("M.PLY", b"ply\n")):
        distance_map.save(tmp_path / name)
        assert (tmp_path / name).read_bytes()[:4] == head
    assert sorted(p.name for p in tmp_path.iterdir()) == ["M.PLY", "m.exr", "m.glb", "m.png"]
    read = sdm.read(tmp_path / "M.PLY")
    np.testing.assert_array_equal(read.vertices, distance_map.surface.vertices)
    np.testing.assert_array_equal(read.faces, distance_map.surface.faces)
    at_vertices = distance_map.at_vertices()
    assert at_vertices[:1].tobytes() in (tmp_path / "M.PLY").read_bytes()
    for name in ("m.npy", "m.csv", "m.vtp"):
        distance_map.save(tmp_path / name)
    np.testing.assert_array_equal(np.load(tmp_path / "m.npy"), at_vertices)
    table = np.loadtxt(tmp_path / "m.csv", delimiter=",", skiprows=1)
    np.testing.assert_array_equal(table[:, 1:4], distance_map.surface.vertices)
    np.testing.assert_array_equal(table[:, 4].astype(np.float32), at_vertices)
    distance_map.save(str(tmp_path / "options.png"), colormap="viridis", range=(0, 1), units="mm", size=64)
    distance_map.save(tmp_path / "bands.png", tolerance=(-0.1, 0.2))
    width, height = struct.unpack(">II", (tmp_path / "options.png").read_bytes()[16:24])
    assert width > 64 and height >= 64
    for name in ("m.jpg", "m", "no such folder/m.png", "no such folder/m.ply", "no such folder/m.exr"):
        with pytest.raises(sdm.Error, match=name.split("/")[0]):
            distance_map.save(tmp_path / name)
    for options in ({"colormap": "jet"}, {"range": (1, 0)}, {"range": (0, np.nan)}, {"size": 0}, {"tolerance": -1}, {"tolerance": (1, 0)},
                    {"tolerance": (0, 1, 2)}):  # fmt: skip
        with pytest.raises(sdm.Error):
            distance_map.save(tmp_path / "bad.png", **options)
    assert not (tmp_path / "bad.png").exists()


def test_pictures_need_no_fonts_of_the_machine(tmp_path):
    """Nor a configuration of fontconfig, which warns without one."""
    program = """
import sys
sys.path.insert(0, sys.argv[1])
import meshes, sdm
sdm.map(meshes.sphere(), meshes.box(), resolution=32).save(sys.argv[2], units=sys.argv[3], size=64)
"""
    pictures = []
    for units, fonts in (("µm", {}), ("µm", {"FONTCONFIG_FILE": "/nonexistent", "FONTCONFIG_PATH": "/nonexistent"}), ("äm", {})):
        file = tmp_path / f"{len(pictures)}.png"
        command = [sys.executable, "-c", program, os.path.dirname(meshes.__file__), str(file), units]
        result = subprocess.run(command, env={**os.environ, **fonts}, capture_output=True, text=True, timeout=300)
        assert result.returncode == 0 and result.stderr == "", result.stderr
        pictures.append(file.read_bytes())
    assert pictures[0] == pictures[1] != pictures[2]


def page_data(page, key):
    """What a page contains as JSON."""
    return json.loads(re.search(f'<script type="application/json" id="{key}">(.*?)</script>', page, re.DOTALL)[1])


needs_pages = pytest.mark.skipif(not sdm._core.can_write_html(), reason="built without pages")


@needs_pages
def test_pages(distance_map, tmp_path):
    distance_map.save(tmp_path / "m.HTML", tolerance=(-0.1, 2), units="mm", up="z")
    page = (tmp_path / "m.HTML").read_text(encoding="utf-8")
    report = page_data(page, "report")
    assert report == json.loads(json.dumps(distance_map.report(tolerance=(-0.1, 2), units="mm")))
    assert report["units"] == "mm" and report["tolerance"]["verdict"] == "FAIL" and page_data(page, "page")["up"] == "z"
    with pytest.raises(sdm.Error, match="up is 'x': it must be y or z"):
        distance_map.save(tmp_path / "n.html", up="x")
    with pytest.raises(sdm.Error, match="no such folder"):
        distance_map.save(tmp_path / "no such folder" / "n.html")
    assert not (tmp_path / "n.html").exists()


def test_notebooks(distance_map):
    text = distance_map._repr_html_()
    assert "data:image/png;base64," in text and "exact" in text
    if sdm._core.can_write_html():
        page = html.unescape(re.search('srcdoc="(.*?)"', text, re.DOTALL)[1])
        assert page_data(page, "page")["map"] == {"width": 256, "height": 256, "step": 1}
        assert len(text) < 1_000_000  # most of it is the viewer
    assert repr(distance_map).startswith("sdm.DistanceMap(256 × 256 texels, distance ")


@needs_pages
def test_notebooks_show_less_of_large_maps():
    m = sdm.map(meshes.sphere(steps=7), meshes.box(), resolution=2048)
    text = m._repr_html_()
    page = page_data(html.unescape(re.search('srcdoc="(.*?)"', text, re.DOTALL)[1]), "page")
    assert page["map"]["step"] == 8 and page["model"]["triangles_of_mesh"] == 8 * 4**7
    assert len(text) < 3_000_000


def test_hausdorff(distance_map):
    truth = sdm.hausdorff(meshes.sphere(), meshes.box(), one_sided=True, precision=1e-9)
    sampled = distance_map.hausdorff()
    assert sampled.lower <= truth.value <= sampled.upper <= sampled.lower + 0.05 and sampled.certainty == "bounded"
    np.testing.assert_allclose(np.linalg.norm(sampled.witness[1] - sampled.witness[0]), sampled.value, rtol=1e-6)
    searched = distance_map.hausdorff(1e-7)
    assert searched.lower - 1e-7 <= truth.value <= searched.upper <= searched.lower + 1e-7
    assert sdm.map(meshes.sphere(), meshes.box(), resolution=64, max_distance=0.3).hausdorff().upper == np.inf
    with pytest.raises(sdm.Error):
        distance_map.hausdorff(-1)


def test_tolerances(distance_map):
    largest = float(np.nanmax(np.abs(distance_map.at_vertices())))
    passed = distance_map.check(largest + 0.1)
    assert passed.verdict == "pass" and passed.within and passed.certified and passed.exceeded_area_fraction == 0
    assert passed.largest == pytest.approx(largest, rel=1e-6) and passed.tolerance == (-largest - 0.1, largest + 0.1)
    failed = distance_map.check((-0.2, 0.3))
    assert failed.verdict == "fail" and failed.above_area_fraction > 0 and failed.below_area_fraction > 0
    coarse = sdm.map(meshes.sphere(), meshes.box(), resolution=64).check(largest + 0.02)
    assert coarse.verdict == "pass" and coarse.certified and coarse.witness is None and coarse.undecided_by is None
    open_ = distance_map.check(largest - 1e-7)
    assert open_.verdict == "not decided" and 0 <= open_.undecided_by < 1e-5
    unsigned = sdm.map(meshes.sphere(), meshes.box(), resolution=64, sign="none")
    for tolerance in ((-0.1, 0.2), -1, (1, 0), (1, 2, 3), np.nan):
        with pytest.raises(sdm.Error):
            unsigned.check(tolerance)
    with pytest.raises(TypeError):
        unsigned.check("text")


def test_coverage():
    box = meshes.box()
    everything = sdm.coverage(box, box, 0.1)
    assert everything.value == everything.lower == everything.upper == 1 and everything.reach == 0.1
    some = sdm.coverage(box, meshes.box((0, 0, 0), (1, 1, 0.5)), 0.05)
    assert 0 < some.lower <= some.value <= some.upper < 1
    # All faces have the same area.
    assert some.of_face.shape == (12,) and some.of_face.mean() == pytest.approx(some.value, abs=1e-6)
    assert set(some.of_face) > {0, 1}
    with pytest.raises(sdm.Error):
        sdm.coverage(box, box, 0)


def test_doubts():
    part = meshes.box((0, 0, 0), (100, 60, 30))
    assert sdm.alignment_doubts(part, part, sdm.align(part, part)) == []
    in_metres = (0.001 * part[0], part[1])
    doubts = sdm.alignment_doubts(in_metres, part, sdm.align(in_metres, part))
    assert doubts[0].reason == "other unit" and "--transform-o1 scale:1000," in doubts[0].remedy
    assert "1000 times as large" in doubts[0].text


def test_self_maps():
    plate = meshes.box((0, 0, 0), (10, 10, 0.5))
    m = sdm.self_map(plate, resolution=128, max_distance=2)
    # The top and the bottom are far from each other along the surface, and 0.5 apart.
    up = m.valid & (np.abs(m.normal[..., 2]) > 0.9)
    middle = up & (np.abs(m.position[..., :2] - 5) < 4).all(axis=-1)
    assert middle.any()
    np.testing.assert_allclose(m.distance[middle], 0.5, atol=1e-6)
    np.testing.assert_allclose(np.abs(m.vector[middle][:, 2]), 0.5, atol=1e-6)
    assert m.sign == "none" and m.statistics().min >= 0
    exact = sdm.SelfProximityQuery(plate, max_distance=2).separation().value
    assert exact <= m.statistics().min + 1e-6
    assert m.at_vertices().shape == (8,)
    for no_bounds in (lambda: m.bounds, m.hausdorff, lambda: m.check(1), m.free_distances, m.ambient_occlusion):
        with pytest.raises(sdm.Error, match="jump between faces"):
            no_bounds()


def test_exclusion_of_self_maps(tmp_path):
    sphere = meshes.sphere(steps=3)
    rings = sdm.self_map(sphere, resolution=128)
    geodesic = sdm.self_map(sphere, resolution=128, geodesic=1.0)
    assert geodesic.statistics().min > rings.statistics().max  # the straight lines of arcs of at least 1
    assert geodesic.statistics().min >= 2 * np.sin(0.5) - 0.05
    everything = sdm.self_map(sphere, resolution=64, geodesic=10)
    assert json.dumps(everything.report(), allow_nan=False) and everything._repr_html_()
    assert not everything.valid.any() and np.isposinf(everything.distance[everything.face != sdm.NONE]).all()
    # What is near is decided at rest: a folded sheet excludes as the flat one does.
    flat = ([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0]], [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]])
    folded = sdm.Surface(flat, resolution=64)
    folded.refit([[0, 0, 0], [1, 0, 0], [0, 0, 0.1], [0, 1, 0], [1, 1, 0], [0, 1, 0.1]])
    assert not sdm.self_map(folded, rest=flat, geodesic=3).valid.any()
    for name, head in (("s.exr", b"v/1\x01"), ("s.png", b"\x89PNG"), ("s.glb", b"glTF"), ("s.ply", b"ply\n")):
        geodesic.save(tmp_path / name)
        assert (tmp_path / name).read_bytes()[:4] == head
    if sdm._core.can_write_html():
        geodesic.save(tmp_path / "s.html")
        assert "mesh" in page_data((tmp_path / "s.html").read_text(), "report")
    for options in ({"rings": 0}, {"geodesic": 0}, {"max_distance": 0}, {"rest": meshes.box()}, {"rings": -1}):
        with pytest.raises((sdm.Error, TypeError)):
            sdm.self_map(sphere, resolution=64, **options)
    with pytest.raises(sdm.Cancelled):
        sdm.self_map(sphere, resolution=64, progress=lambda step, fraction: False)


def test_plots(distance_map):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    for kind in ("surface", "atlas"):
        ax = distance_map.plot(kind=kind, units="mm")
        ax.figure.canvas.draw()
        assert [a.get_ylabel() for a in ax.figure.axes[1:]] == ["distance [mm]"]
    with pytest.raises(sdm.Error, match="kind"):
        distance_map.plot(kind="other")
    matplotlib.pyplot.close("all")


def test_plots_the_short_side_of_zero_in_red():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    # A ball that is 0.1 deep in a block.
    balls, block = meshes.sphere(center=(0, 0, 1.9), steps=4), meshes.box((-4, -4, -2), (4, 4, 1))
    found = sdm.map(balls, block, resolution=128)
    name, low, high, colours = found._core.colors()
    assert (name, low, high) == ("sequential", -0.2, 2.0)
    picture = found.plot(kind="atlas").images[0]
    assert (picture.norm.vmin, picture.norm.vmax) == (low, high)
    # The colours are those of src/core/rules.h: of no value, of the lower end and of the upper one.
    assert colours[-1].tolist() == [128, 130, 134]
    for at, expected in ((0.0, [130, 0, 20]), (1.0, [253, 231, 37])):
        assert 255 * np.array(picture.cmap(at)[:3]) == pytest.approx(expected, abs=2)
    for value in (-0.09, -0.02):
        red, green, blue, _ = picture.cmap(picture.norm(value))
        assert red > 0.5 and red > 0.25 + max(green, blue)
    np.testing.assert_allclose(picture.cmap(picture.norm(0.001)), matplotlib.colormaps["viridis"](0.0), atol=0.02)
    np.testing.assert_allclose(picture.cmap(picture.norm(2.0)), matplotlib.colormaps["viridis"](1.0), atol=0.02)
    matplotlib.pyplot.close("all")


def test_facing_finds_the_skin_that_faces_the_texel():
    plate = np.array([[x, y, z] for z in (-0.5, 0.0) for y in (-5, 5) for x in (-5, 5)], float)
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    faces = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    dented = np.array([[0, 0, -0.4], [1, 0, -0.4], [0, 1, -0.4]], float), [[0, 1, 2]]
    plain = sdm.map(dented, (plate, faces), resolution=16)
    facing = sdm.map(dented, (plate, faces), resolution=16, facing=90)
    assert plain.statistics().max_abs == pytest.approx(0.1) and plain.measured == "distance to the closest point"
    assert facing.statistics().min == pytest.approx(-0.4) and facing.measured == "distance to the closest of the faces that face the same way, within 90°"
    assert facing.without_match == 0 and facing.check(0.3).verdict == "fail"
    passed, sided = facing.check(0.5), facing.check((-0.5, 0.1))
    assert passed.verdict == sided.verdict == "pass" and passed.certified and not sided.certified
    names = sdm.FaceNames("group", ["dent"], np.zeros(1, np.uint32))
    assert facing.check_groups({"dent": 0.5}, names).groups[0].verdict.certified
    report = facing.report(tolerance=0.5)["tolerance"]
    assert report["certified"] and report["text"] == "every point of the surface is within ±0.5"
    assert facing.report(tolerance=0.5)["measured"]["kind"] == "facing"
    for refused in (lambda: facing.bounds, facing.hausdorff, facing.free_distances):
        with pytest.raises(sdm.Error):
            refused()
    with pytest.raises(sdm.Error):
        sdm.map(dented, (plate, faces), resolution=16, facing=200)
    for other in ({"facing": 90}, {"along": "normal"}):
        with pytest.raises(sdm.Error, match="precision excludes (facing|along): nothing bounds"):
            sdm.map(dented, (plate, faces), precision=0.1, **other)


def test_side_of_an_open_mesh_is_a_sign():
    ground = np.array([[-5, -5, 0], [5, -5, 0], [5, 5, 0], [-5, 5, 0]], float), [[0, 1, 2], [0, 2, 3]]
    below = np.array([[0, 0, -0.4], [1, 0, -0.4], [0, 1, -0.4]], float), [[0, 1, 2]]
    settled = sdm.map(below, ground, resolution=16, sign="side")
    assert settled.sign == "side" and settled.statistics().max == pytest.approx(-0.4)


def test_thickness_of_walls():
    plate = meshes.box((0, 0, 0), (10, 10, 0.5))
    for method in ("ball", "ray"):
        m = sdm.thickness(plate, method=method, resolution=128)
        up = m.valid & (np.abs(m.normal[..., 2]) > 0.9)
        np.testing.assert_allclose(m.distance[up], 0.5, atol=1e-6)
        np.testing.assert_allclose(m.at_vertices(), 0.5, atol=1e-6)
        assert m.sign == "none" and m.measured.startswith("wall thickness, the ")
        assert m.report()["measured"]["kind"] == "thickness"
        passed, failed = m.check((0.4, 20)), m.check((0.6, 20))
        assert (passed.verdict, passed.certified, failed.verdict) == ("pass", False, "fail")
        assert m.report(tolerance=(0.4, 20))["evidence"]["samples_only"] is True
        for no_bounds in (lambda m=m: m.bounds, m.hausdorff, m.free_distances, m.ambient_occlusion):
            with pytest.raises(sdm.Error, match="jumps between faces"):
                no_bounds()
    with pytest.raises(sdm.Error, match="open"):
        sdm.thickness((plate[0], plate[1][1:]), resolution=64)
    for wrong in ({"method": "sphere"}, {"angle": 0}, {"angle": 180}):
        with pytest.raises(sdm.Error, match=next(iter(wrong))):
            sdm.thickness(plate, resolution=64, **wrong)


def test_distances_along_lines():
    vertices, faces = meshes.box((0, 0, 0), (10, 10, 1))
    # A dent of 0.79 in a sheet 1 thick: the other skin is nearer.
    dent = (np.array([[1, 1, 0.21], [9, 1, 0.21], [9, 9, 0.21], [1, 9, 0.21]]), [[0, 1, 2], [0, 2, 3]])
    for along in ("normal", (0, 0, 2), np.array([0, 0, -1.0])):
        m = sdm.map(dent, (vertices, faces), along=along, resolution=64)
        np.testing.assert_allclose(m.distance[m.valid], -0.79, atol=1e-6)
        np.testing.assert_allclose(m.at_vertices(), -0.79, atol=1e-6)
        assert m.without_match == 0 and m.report()["measured"]["kind"] == "along"
        passed = m.check(0.8)
        assert (passed.verdict, passed.certified, m.check(0.6).verdict) == ("pass", False, "fail")
        for no_bounds in (lambda m=m: m.bounds, m.hausdorff, m.free_distances, m.ambient_occlusion):
            with pytest.raises(sdm.Error, match="jump between faces"):
                no_bounds()
    for wrong in ("up", (1, 2), (0, 0, 0), 3):
        with pytest.raises(sdm.Error, match="along|direction"):
            sdm.map(dent, (vertices, faces), along=wrong, resolution=64)
    with pytest.raises(sdm.Error, match="along excludes sign none"):
        sdm.map(dent, (vertices, faces), along="normal", sign="none", resolution=64)


def test_views(tmp_path):
    """The near ends of two cubes side by side, and the far ones, in the colours of their distances."""
    import matplotlib.pyplot as plt

    cube, other = meshes.box((-1, -1, -1), (1, 1, 1)), meshes.box((3, -1, -1), (5, 1, 1))
    there, back = sdm.map(cube, other, resolution=128), sdm.map(other, cube, resolution=128)
    there.save_view(tmp_path / "both.png", (0, 0, 1), other=back, range=(1, 5), size=400, legend=False)
    picture = plt.imread(tmp_path / "both.png")
    assert picture.shape[:2] == (300, 400)
    # Viridis: far is yellow, near is purple.
    yellow = picture[150, :, 1] - picture[150, :, 2]
    assert yellow[40] > yellow[120] and yellow[360] > yellow[280]
    there.save_view(tmp_path / "pale.png", (0, 0, 1), size=400, legend=False)
    assert np.ptp(plt.imread(tmp_path / "pale.png")[150, 300, :3]) < 0.1
    another = sdm.map(meshes.sphere(), cube, resolution=64)
    for options in ({"towards": (0, 0, 0)}, {"size": 80}, {"up": "x"}, {"other": another}, {"other": 5}, {"towards": 5}, {"towards": (0, 1)}):
        with pytest.raises(sdm.Error):
            there.save_view(tmp_path / "no.png", **options)
    there.save_view(tmp_path / "least.png", size=86, legend=False)
    assert plt.imread(tmp_path / "least.png").shape[:2] == (64, 86)
    for wrong in (100.5, True, "90"):
        with pytest.raises(TypeError, match="size must be an integer|facing is .*: it must be a number of degrees"):
            there.save_view(tmp_path / "no.png", size=wrong) if wrong == 100.5 else sdm.map(cube, other, facing=wrong)
    with pytest.raises(sdm.Error, match="no.jpg"):
        there.save_view(tmp_path / "no.jpg")
    assert not (tmp_path / "no.png").exists()


def keys_of(report, at=""):
    if isinstance(report, dict):
        for key, value in report.items():
            yield f"{at}.{key}"
            yield from keys_of(value, f"{at}.{key}")
    elif isinstance(report, list) and report:
        yield from keys_of(report[0], f"{at}[]")


@pytest.mark.skipif("SDM_COMMAND" not in os.environ, reason="the command is not built")
@pytest.mark.parametrize("tolerance", [None, 0.3, 5.0])
def test_reports_have_the_keys_of_the_command(tmp_path, tolerance):
    for name, mesh in {"a": meshes.sphere(), "b": meshes.box()}.items():
        rows = [f"v {x!r} {y!r} {z!r}" for x, y, z in mesh[0].tolist()] + ["f %d %d %d" % tuple(f + 1) for f in mesh[1]]
        (tmp_path / f"{name}.obj").write_text("\n".join(rows))
    files = [tmp_path / "a.obj", tmp_path / "b.obj"]
    options = [] if tolerance is None else [f"--tolerance={tolerance}"]
    command = [os.environ["SDM_COMMAND"], "map", *files, "-o", tmp_path / "out", "--resolution", "64", "--write", "none", "--quiet"]
    assert subprocess.run([*command, *options]).returncode in (0, 3)
    written = json.loads((tmp_path / "out" / "report.json").read_text())
    report = sdm.map(*map(sdm.read, files), resolution=64).report(tolerance=tolerance)
    assert list(keys_of(report)) == list(keys_of(written))
    for key in written.keys() - {"o1", "o2", "time_ms"}:
        assert report[key] == written[key], key


def exr_texts(file):
    """The string attributes of an OpenEXR file: each is its name, its type, the number of its bytes, and these."""
    content, texts, at = file.read_bytes(), {}, 8
    while content[at]:
        name, kind = content[at : at + 512].split(b"\0")[:2]
        at += len(name) + len(kind) + 2
        size = int.from_bytes(content[at : at + 4], "little")
        if kind == b"string":
            texts[name.decode()] = content[at + 4 : at + 4 + size].decode()
        at += 4 + size
    return texts


@pytest.mark.skipif("SDM_COMMAND" not in os.environ, reason="the command is not built")
@pytest.mark.parametrize(
    "line, call, kind",
    [
        (["map", "a.obj", "b.obj"], lambda a, b: sdm.map(a, b, resolution=64), None),
        (["map", "a.obj", "b.obj", "--facing=60"], lambda a, b: sdm.map(a, b, resolution=64, facing=60), "60°"),
        (["self", "a.obj"], lambda a, b: sdm.self_map(a, resolution=64), "not excluded"),
        (["thickness", "a.obj"], lambda a, b: sdm.thickness(a, resolution=64), "thickness"),
    ],
)
def test_exr_has_the_attributes_of_the_command(tmp_path, line, call, kind):
    for name, mesh in {"a": meshes.sphere(), "b": meshes.box()}.items():
        rows = [f"v {x!r} {y!r} {z!r}" for x, y, z in mesh[0].tolist()] + ["f %d %d %d" % tuple(f + 1) for f in mesh[1]]
        (tmp_path / f"{name}.obj").write_text("\n".join(rows))
    options = ["-o", "out", "--resolution", "64", "--write", "exr", "--units", "mm", "--quiet"]
    subprocess.run([os.environ["SDM_COMMAND"], *line, *options], cwd=tmp_path, check=True)
    written = exr_texts(tmp_path / "out" / "map.exr")
    call(sdm.read(tmp_path / "a.obj"), sdm.read(tmp_path / "b.obj")).save(tmp_path / "map.exr", units="mm")
    saved = exr_texts(tmp_path / "map.exr")
    # Meshes in Python have no names of files.
    roles = {"a.obj": "O1", "b.obj": "O2"}
    for key in ("measuredOn", "distanceTo"):
        assert saved.pop(key) == roles[written.pop(key)]
    assert saved == written
    assert saved["units"] == "mm" and saved["sign"] and saved["signReason"]
    assert (kind is None) == ("measured" not in saved) and (kind or "") in saved.get("measured", "")


@pytest.mark.parametrize("options", [{}, {"atlas": "triangles"}, {"max_stretch": 3}])
def test_places_of_texels(options):
    """The weights of texels and those of closest points are of the points that they stand for; texels are where uvs say."""
    mesh = meshes.sphere(steps=3)
    m = sdm.map(mesh, meshes.box(), resolution=64, **options)
    owned = m.face != sdm.NONE
    weights = m.barycentric[owned]
    assert (weights >= 0).all() and np.isnan(m.barycentric[~owned]).all()
    corners = m.surface.vertices[m.surface.faces[m.face[owned]]]
    np.testing.assert_allclose(np.einsum("nk,nkx->nx", weights, corners), m.position[owned], atol=1e-12)
    places = np.einsum("nk,nkx->nx", weights, m.surface.uvs[m.face[owned]])
    y, x = np.nonzero(owned)
    np.testing.assert_allclose(places, np.stack([x, y], axis=1) + 0.5, atol=1e-6)
    assert m.surface.uvs.shape == (len(mesh[1]), 3, 2)

    box = m.sites
    closest = np.einsum("nk,nkx->nx", m.closest_barycentric[m.valid], box.vertices[box.faces[m.closest_face[m.valid]]])
    np.testing.assert_allclose(closest, m.position[m.valid] + m.vector[m.valid], atol=1e-6)
    assert np.isnan(m.closest_barycentric[~m.valid]).all()
