"""sdm.dask in one process: tables, parts and statistics against sdm.map, and against NumPy."""

import doctest
import inspect
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import meshes
import sdm

dask = pytest.importorskip("dask")
pytest.importorskip("pyarrow")
import sdm.dask
from sdm.dask import _cohort, _meshes, _pairs, _split


@pytest.fixture(autouse=True)
def in_this_thread():
    with dask.config.set(scheduler="sync"):
        yield


def save(path, mesh):
    vertices, faces = mesh
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in np.asarray(vertices).tolist()]
    path.write_text("\n".join(lines + [f"f {a} {b} {c}" for a, b, c in np.asarray(faces) + 1]) + "\n")
    return path


# ---- Documentation

@pytest.mark.parametrize("name", [*sdm.dask.__all__, "CohortStatistics.quantile", "CohortStatistics.save", "Parts.open",
                                  "Parts.mesh", "Parts.numbers", "PartsMap.load", "PartsMap.save"])  # fmt: skip
def test_docstrings(name, tmp_path):
    value = sdm.dask
    for part in name.split("."):
        value = getattr(value, part)
    text = inspect.getdoc(value)
    assert text
    names = {"sdm": sdm, "np": np, "box": sdm.Mesh(meshes.box()), "sphere": sdm.Mesh(meshes.sphere()), "folder": tmp_path}
    test = doctest.DocTestParser().get_doctest(text, names, name, None, 0)
    assert doctest.DocTestRunner().run(test).failed == 0


def test_page(tmp_path, monkeypatch):
    """The blocks of docs/many-machines.md, with scans and a part: the first one as a script, the others one after the other."""
    page = (Path(__file__).resolve().parents[2] / "docs" / "many-machines.md").read_text(encoding="utf-8")
    script, *blocks = re.findall(r"^```python\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scans").mkdir()
    vertices, faces = meshes.sphere(steps=4)
    stretched = vertices * [1, 2, 3]  # an ellipsoid, which fits in one pose
    corners = (stretched[faces]).reshape(-1, 3, 3)
    (tmp_path / "part.stl").write_text("solid part\n" + "".join(
        "facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {x!r} {y!r} {z!r}\n" for x, y, z in face)
        + "endloop\nendfacet\n" for face in corners.tolist()) + "endsolid part\n")  # fmt: skip
    for k, dent in enumerate((0, 0.2)):
        scan = stretched * (1 - dent * (vertices[:, :1] > 0.9)) + [0.02, 0, 0.01]
        sdm.map((scan, faces), meshes.box(), resolution=64).save(f"scans/{k}.ply")
    Path("scans/2.ply").write_text("ply")

    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=300)
    assert run.returncode == 0, run.stderr
    assert re.search(r"0\.ply +PASS .*\n.*1\.ply +FAIL .*\n.*2\.ply", run.stdout), run.stdout
    assert len(list(Path("out/maps").glob("*.png"))) == 2
    names = {}
    for block in blocks:
        exec(compile(block, "docs/many-machines.md", "exec"), names)


# ---- Many pairs

@pytest.fixture
def scans(tmp_path):
    """Three spheres and a part; their paths."""
    (tmp_path / "scans").mkdir()
    files = [save(tmp_path / "scans" / f"{k}.obj", meshes.sphere(radius=1 + 0.1 * k)) for k in range(3)]
    return files, save(tmp_path / "part.obj", meshes.box())


def test_rows_are_those_of_single_maps(scans, tmp_path):
    files, part = scans
    pairs = [(file, part) for file in files]
    table = sdm.dask.map_pairs(pairs, tmp_path / "out", resolution=64, save=(".exr", ".npy"), rows_per_partition=2)
    assert table.npartitions == 2
    table = table.compute()
    assert table["o1"].tolist() == [str(file) for file in files] and (table["error"] == "").all()
    assert table.index.tolist() == [0, 1, 2]
    for row, (o1, o2) in zip(table.itertuples(), pairs):
        m = sdm.map(o1, o2, resolution=64)
        statistics = m.statistics()
        for name in ("min", "max", "mean", "rms", "p50", "p99", "texels", "negative_area_fraction"):
            assert getattr(row, name) == getattr(statistics, name), name
        assert (row.lower, row.upper) == (m.bounds.lower, m.bounds.upper)
        assert row.sign == m.sign and row.resolution == 64 and row.verdict == ""
        m.save(tmp_path / "alone.exr")
        with open(row.exr, "rb") as saved:
            assert saved.read() == (tmp_path / "alone.exr").read_bytes()
        np.testing.assert_array_equal(np.load(row.npy), m.at_vertices())


def test_a_table_is_written_as_parquet(scans, tmp_path):
    files, part = scans
    table = sdm.dask.map_pairs([(f, part) for f in files] + [("none.stl", part)], tmp_path / "out", resolution=64, save="",
                               rows_per_partition=2)  # fmt: skip
    table.to_parquet(tmp_path / "table.parquet")
    import dask.dataframe

    read = dask.dataframe.read_parquet(tmp_path / "table.parquet").compute()
    expected = table.compute()
    assert list(read.columns) == list(expected.columns)
    for column in expected:
        assert read[column].tolist() == expected[column].tolist() or expected[column].isna().any(), column
    np.testing.assert_array_equal(read["mean"], expected["mean"])


def test_bad_inputs_are_rows(scans, tmp_path):
    files, part = scans
    vertices, faces = meshes.sphere()
    bad = vertices.copy()
    bad[3, 1] = np.nan
    for name, content in (("empty.ply", b""), ("garbage.stl", os.urandom(500)), ("cut.obj", b"v 0 0 0\nf 1 2 3\n"),
                          ("flat.obj", b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"), ("broken.gltf", b"{\"buffers\": 3}")):  # fmt: skip
        (tmp_path / name).write_bytes(content)
    (tmp_path / "folder.ply").mkdir()
    pairs = [(tmp_path / name, part) for name in ("no such file.ply", "empty.ply", "garbage.stl", "cut.obj", "flat.obj",
                                                  "broken.gltf", "folder.ply")]  # fmt: skip
    pairs += [(files[0], tmp_path / "empty.ply"), ((bad, faces), part), ((vertices, faces + 99), part), (3, part),
              (files[0], part, np.eye(3)), (files[0], part, np.full((4, 4), np.nan)), (files[0], part, "no matrix")]  # fmt: skip
    table = sdm.dask.map_pairs([*pairs, (files[0], part)], tmp_path / "out", resolution=64).compute()
    assert (table["error"][:-1] != "").all() and table["error"].iloc[-1] == ""
    assert table["mean"][:-1].isna().all() and (table["exr"][:-1] == "").all()
    for name, error in zip((p[0] for p in pairs[:7]), table["error"]):
        assert str(name) in error
    assert "empty.ply" in table["error"][7] and "pair 8, O1" in table["error"][8] and "NaN" in table["error"][8]
    assert len(list((tmp_path / "out" / "records").iterdir())) == 1
    with pytest.raises(sdm.Error, match="pair 1 must be"):
        sdm.dask.map_pairs([pairs[0], files[0]], tmp_path / "out")
    with pytest.raises(sdm.Error, match="not as '.jpg'"):
        sdm.dask.map_pairs(pairs, tmp_path / "out", save=".jpg")
    with pytest.raises(sdm.Error, match="tolerance"):
        sdm.dask.map_pairs(pairs, tmp_path / "out", tolerance=(1, -1))
    assert len(sdm.dask.map_pairs([], tmp_path / "out").compute()) == 0


def test_what_is_done_is_not_done_again(scans, tmp_path, monkeypatch):
    files, part = scans
    computed = []
    original = _pairs._computed
    monkeypatch.setattr(_pairs, "_computed", lambda names, *rest: computed.append(names[0]) or original(names, *rest))

    def run(**options):
        computed.clear()
        return sdm.dask.map_pairs([(f, part) for f in files], tmp_path / "out", **{"resolution": 64, **options}).compute()

    first = run()
    assert len(computed) == 3
    again = run(threads=2, rows_per_partition=1)  # neither changes results
    assert not computed and again.equals(first)
    assert len(run(resolution=32)) == 3 and len(computed) == 3
    assert len(run(tolerance=1)) == 3 and len(computed) == 3

    (tmp_path / "moved").mkdir()
    os.rename(files[1], tmp_path / "moved" / "1.obj")  # the content counts, not the place
    files[1] = tmp_path / "moved" / "1.obj"
    run()
    assert not computed
    save(files[1], meshes.sphere(radius=3))
    changed = run()
    assert computed == [str(files[1])] and changed["max"][1] > first["max"][1]
    os.unlink(first["exr"][0])  # a map that was removed
    run()
    assert computed == [str(files[0])] and os.path.exists(first["exr"][0])
    record = next((tmp_path / "out" / "records").iterdir())
    record.write_text(record.read_text()[:20])  # a damaged record
    run(), run(resolution=32), run(tolerance=1)
    assert not [f for f in (tmp_path / "out").rglob("*") if f.name.startswith(".")]


def test_errors_are_tried_again(scans, tmp_path):
    _, part = scans
    late = tmp_path / "late.obj"
    assert sdm.dask.map_pairs([(late, part)], tmp_path / "out", resolution=64).compute()["error"][0]
    save(late, meshes.sphere())
    assert not sdm.dask.map_pairs([(late, part)], tmp_path / "out", resolution=64).compute()["error"][0]


def test_a_pair_that_kills_workers_is_a_row(scans, tmp_path, monkeypatch):
    files, part = scans
    table = sdm.dask.map_pairs([(files[0], part)], tmp_path / "out", resolution=64)

    class Killed(BaseException):
        pass

    def killed(*_):
        raise Killed

    monkeypatch.setattr(_pairs, "_computed", killed)
    for _ in range(3):
        with pytest.raises(Killed):
            table.compute()
    assert "was killed 3 times" in table.compute()["error"][0]
    monkeypatch.undo()
    with dask.config.set(scheduler="sync"):
        table = sdm.dask.map_pairs([(files[0], part)], tmp_path / "out", resolution=64)  # another call tries again
        assert table.compute()["error"][0] == ""


def test_a_file_that_changes_meanwhile_is_an_error(scans, tmp_path, monkeypatch):
    files, part = scans
    original = sdm.read

    def read(file):
        mesh = original(file)
        save(files[0], meshes.sphere(radius=2))
        return mesh

    monkeypatch.setattr(sdm, "read", read)
    assert "was changed" in sdm.dask.map_pairs([(files[0], part)], tmp_path / "out", resolution=64).compute()["error"][0]


def test_transforms_and_alignment(scans, tmp_path):
    _, part = scans
    shift = np.eye(4)
    shift[:3, 3] = 0.05, 0.02, -0.03
    o1 = sdm.Mesh(meshes.box())
    options = {"resolution": 64, "save": ""}
    moved = sdm.dask.map_pairs([(o1, part, shift)], tmp_path / "out", **options).compute()
    assert moved["max_abs"][0] == sdm.map(o1, part, resolution=64, transform=shift).statistics().max_abs
    assert sdm.dask.map_pairs([(o1, part, shift)], tmp_path / "out", align=True, **options).compute()["max_abs"][0] < 1e-6


@pytest.mark.skipif("SDM_COMMAND" not in os.environ, reason="the command is not built")
def test_verdicts_are_those_of_the_command(tmp_path):
    o1, o2 = save(tmp_path / "o1.obj", meshes.sphere(radius=0.5, center=(0.5, 0.5, 0.5))), save(tmp_path / "o2.obj", meshes.box())
    m = sdm.map(o1, o2, resolution=64)
    largest = np.abs(m.at_vertices()).max()
    tolerances = [largest * 2, largest * 1.001, largest * 0.9, (-1.0, 0.001), (-0.01, 1.0)]
    found = [sdm.dask.map_pairs([(o1, o2)], tmp_path / "out", resolution=64, tolerance=t, save="").compute()["verdict"][0]
             for t in tolerances]  # fmt: skip
    for tolerance, verdict in zip(tolerances, found):
        text = "{}:{}".format(*tolerance) if isinstance(tolerance, tuple) else str(tolerance)
        command = [os.environ["SDM_COMMAND"], "map", o1, o2, "-o", tmp_path / "cli", "--resolution", "64",
                   f"--tolerance={text}", "--write", "none", "--quiet"]  # fmt: skip
        run = subprocess.run(command, capture_output=True, text=True)
        assert run.returncode in (0, 3, 5), run.stderr
        report = json.loads((tmp_path / "cli" / "report.json").read_text())
        assert report["tolerance"]["verdict"] == verdict
    # The fourth pass is one by signs, within limits that are wider than the box.
    assert set(found) == {"PASS", "FAIL", "DOUBTFUL"}


def test_digests_follow_the_content(tmp_path):
    first, second = tmp_path / "a.obj", tmp_path / "b.obj"
    for file in (first, second):
        save(file, meshes.box())
    assert _meshes.digest(str(first)) == _meshes.digest(str(second))
    save(second, meshes.box(high=(1, 1, 1.5)))
    assert _meshes.digest(str(first)) != _meshes.digest(str(second))
    (tmp_path / "x.bin").write_bytes(b"1234")
    (tmp_path / "x.gltf").write_text(json.dumps({"buffers": [{"uri": "x.bin", "byteLength": 4}]}))
    before = _meshes.digest(str(tmp_path / "x.gltf"))
    (tmp_path / "x.bin").write_bytes(b"12345")
    assert _meshes.digest(str(tmp_path / "x.gltf")) != before


# ---- Parts

def clustered():
    """Most faces in a corner of a thousandth of the size; duplicates; faces without an area; a vertex that no face uses."""
    vertices, faces = meshes.sphere(steps=3)
    small, large = meshes.sphere(steps=4, radius=1e-3, center=(2, 0, 0)), meshes.soup(5)
    result = [vertices, small[0], large[0], [[9, 9, 9], [3, 3, 3], [4, 4, 4], [5, 5, 5]]]
    offsets = np.cumsum([0, *map(len, result)])
    faces = [faces, small[1] + offsets[1], large[1] + offsets[2], np.roll(faces[:7], 1, axis=1), faces[3:5, ::-1],
             [[offsets[3] + 1, offsets[3] + 2, offsets[3] + 3], [0, 0, 5], [7, 7, 7]]]  # fmt: skip
    return np.concatenate(result), np.concatenate(faces)


@pytest.mark.parametrize("faces_per_part", [1, 10, 100, 10**6])
def test_parts_are_a_partition(faces_per_part, tmp_path, monkeypatch):
    monkeypatch.setattr(_split, "_CHUNK", 100)
    monkeypatch.setattr(_split, "_EDGES_AT_A_TIME", 500)
    vertices, faces = clustered() if faces_per_part > 1 else meshes.sphere()
    parts = sdm.dask.split((vertices, faces), tmp_path, faces_per_part=faces_per_part)
    sites = sdm.Sites(vertices, faces)
    seen = np.concatenate([parts.numbers(k)[2] for k in range(len(parts))])
    np.testing.assert_array_equal(np.sort(seen), np.arange(len(faces)))
    assert (parts.vertices, parts.edges, parts.faces) == (len(vertices), len(sites.edges), len(faces))
    assert (parts.part_faces <= max(faces_per_part, 5)).all() and len(parts) <= 6 * len(faces) / faces_per_part + 1
    for k in range(len(parts)):
        of_vertices, of_edges, of_faces = parts.numbers(k)
        own = sdm.Sites(parts.mesh(k))
        np.testing.assert_array_equal(own.vertices, vertices[of_vertices])
        np.testing.assert_array_equal(of_vertices[own.faces], faces[of_faces])
        np.testing.assert_array_equal(of_vertices[own.edges], sites.edges[of_edges])
        assert (parts.low[k] == own.vertices.min(axis=0)).all() and (parts.high[k] == own.vertices.max(axis=0)).all()
    assert sorted(f.name for f in tmp_path.iterdir())[-1] == "parts.json" and len(list(tmp_path.iterdir())) == len(parts) + 1


def test_parts_of_arrays_in_files(tmp_path):
    vertices, faces = meshes.sphere(steps=3)
    np.save(tmp_path / "v.npy", vertices.astype(np.float32))
    np.save(tmp_path / "f.npy", faces.astype(np.int32))
    parts = sdm.dask.split(tmp_path / "v.npy", tmp_path / "parts", faces=tmp_path / "f.npy", faces_per_part=100)
    expected = sdm.dask.split((vertices.astype(np.float32), faces), tmp_path / "same", faces_per_part=100)
    assert parts.key == expected.key and len(parts) == len(expected)
    before = os.stat(tmp_path / "parts" / "part-000000.npz").st_mtime_ns
    assert sdm.dask.split((vertices.astype(np.float32), faces), tmp_path / "parts", faces_per_part=100).key == parts.key
    assert os.stat(tmp_path / "parts" / "part-000000.npz").st_mtime_ns == before
    with pytest.raises(sdm.Error, match="another mesh"):
        sdm.dask.split(meshes.box(), tmp_path / "parts")


def test_files_of_the_user_are_not_removed(tmp_path):
    vertices, faces = meshes.sphere()
    work = tmp_path / "incomplete"
    work.mkdir()
    for name, mesh in (("f-0", work / "f-0"), ("notes.txt", vertices)):
        with open(work / name, "wb") as opened:
            np.save(opened, vertices)
        with pytest.raises(sdm.Error, match=name):
            sdm.dask.split(mesh, tmp_path, faces=faces)
        assert [file.name for file in work.iterdir()] == [name]
        (work / name).unlink()
    (work / "f-0").write_text("left by a killed process")
    sdm.dask.split(vertices, tmp_path, faces=faces)
    assert not work.exists()


def test_meshes_that_cannot_be_divided(tmp_path):
    vertices, faces = meshes.sphere()
    bad = vertices.copy()
    bad[4, 0] = np.inf
    for mesh, of, message in (
        ((vertices, faces[:0]), None, "no triangles"), (vertices, faces + 50, "refers to vertex"),
        (bad, faces, "vertex 4"), (vertices[:, :2], faces, "n × 3"), (vertices, faces.astype(float), "integers"),
        (np.zeros_like(vertices), faces, "degenerate"), (tmp_path / "none.npy", faces, "none.npy"), (vertices, -faces, "refers"),
    ):  # fmt: skip
        with pytest.raises(sdm.Error, match=message):
            sdm.dask.split(mesh, tmp_path / "parts", faces=of)
    with pytest.raises(sdm.Error, match="parts.json"):
        sdm.dask.Parts.open(tmp_path / "parts")


@pytest.mark.parametrize("mesh", [meshes.sphere(steps=3, center=(0.2, 0, 0)), meshes.box(), meshes.soup(3), clustered()])
@pytest.mark.parametrize("faces_per_part", [8, 150])
def test_maps_to_parts_are_bit_identical(mesh, faces_per_part, tmp_path):
    whole = sdm.map(meshes.sphere(), mesh, resolution=64, sign="none", engine="reference")
    parts = sdm.dask.split(mesh, tmp_path / "parts", faces_per_part=faces_per_part)
    result = sdm.dask.map_parts(meshes.sphere(), parts, tmp_path / "tiles", resolution=64, samples_per_tile=100).compute()
    for name in ("distance", "vector", "site", "site_type", "face"):
        np.testing.assert_array_equal(getattr(result, name), getattr(whole, name), strict=False, err_msg=name)
    cpu = sdm.map(meshes.sphere(), mesh, resolution=64, sign="none")
    np.testing.assert_allclose(result.distance, cpu.distance, atol=2 * cpu.bounds.accuracy)
    assert result.tiles > 5 and result.visits <= result.tiles * len(parts)


def test_parts_out_of_reach_are_not_visited(tmp_path):
    near, far = meshes.sphere(steps=2, center=(3, 0, 0)), meshes.sphere(steps=4, center=(30, 0, 0))
    mesh = np.concatenate([near[0], far[0]]), np.concatenate([near[1], far[1] + len(near[0])])
    parts = sdm.dask.split(mesh, tmp_path / "parts", faces_per_part=100)
    result = sdm.dask.map_parts(meshes.sphere(), parts, tmp_path / "tiles", resolution=64, samples_per_tile=500).compute()
    near_parts = int((parts.low[:, 0] < 10).sum())
    assert len(parts) > 10 * near_parts / 4 and 0 < result.visits <= result.tiles * near_parts
    within = sdm.dask.map_parts(meshes.sphere(), parts, tmp_path / "tiles", resolution=64, max_distance=2.5).compute()
    whole = sdm.map(meshes.sphere(), mesh, resolution=64, sign="none", engine="reference", max_distance=2.5)
    np.testing.assert_array_equal(within.distance, whole.distance)
    np.testing.assert_array_equal(within.site, whole.site)
    assert 0 < np.isfinite(within.distance).sum() < np.isfinite(result.distance).sum()


def test_tiles_are_not_computed_again(tmp_path, monkeypatch):
    from sdm.dask import _map_parts

    parts = sdm.dask.split(meshes.box(), tmp_path / "parts", faces_per_part=4)
    surface = sdm.Surface(meshes.sphere(), resolution=64)
    first = sdm.dask.map_parts(surface, parts, tmp_path / "tiles", samples_per_tile=300).compute()
    monkeypatch.setattr(_map_parts, "closest_in_parts", None)
    again = sdm.dask.map_parts(surface, parts, tmp_path / "tiles", samples_per_tile=300).compute()
    np.testing.assert_array_equal(again.distance, first.distance)
    assert again.visits == first.visits
    with pytest.raises(TypeError):
        sdm.dask.map_parts(surface, parts, tmp_path / "tiles", samples_per_tile=301).compute()


def test_both_meshes_in_parts(tmp_path):
    o1 = sdm.dask.split(meshes.sphere(steps=3), tmp_path / "o1", faces_per_part=200)
    o2 = sdm.dask.split(meshes.soup(8, faces=300), tmp_path / "o2", faces_per_part=50)
    maps = sdm.dask.map_parts(o1, o2, tmp_path / "tiles", resolution=64).compute()
    assert len(maps) == len(o1) > 1
    for part, file in enumerate(maps):
        result = sdm.dask.PartsMap.load(file)
        whole = sdm.map(o1.mesh(part), meshes.soup(8, faces=300), resolution=64, sign="none", engine="reference")
        np.testing.assert_array_equal(result.distance, whole.distance)
        np.testing.assert_array_equal(result.site, whole.site)


# ---- Cohorts

def copies_of(mesh, count, seed=0):
    random = np.random.default_rng(seed)
    return [mesh[0] * random.uniform(0.8, 1.2) + random.normal(0, 0.02, mesh[0].shape) for _ in range(count)]


def test_cohort_statistics_are_those_of_numpy(tmp_path):
    sphere, box = meshes.sphere(), meshes.box()
    copies = copies_of(sphere, 21)
    np.save(tmp_path / "one.npy", copies[5])
    np.save(tmp_path / "all.npy", np.stack(copies))
    given = [*copies[:5], tmp_path / "one.npy", *((tmp_path / "all.npy", k) for k in range(6, 21))]
    options = {"range": (-0.3, 0.9), "bins": 40, "resolution": 64}
    found = sdm.dask.cohort_statistics(sphere, given, box, copies_per_task=2, **options).compute()
    surface, sites, distances = sdm.Surface(sphere, resolution=64), sdm.Sites(box), []
    for copy in copies:
        surface.refit(copy)
        distances.append(sdm.map(surface, sites).distance)
    distances = np.stack(distances).astype(np.float64)
    owned = surface.texel_faces != sdm.NONE
    assert (found.count == np.where(owned, 21, 0)).all() and not found.errors
    np.testing.assert_allclose(found.mean, distances.mean(axis=0), rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(found.variance, distances.var(axis=0, ddof=1), rtol=1e-9, atol=1e-15)
    np.testing.assert_array_equal(found.min, distances.min(axis=0))
    np.testing.assert_array_equal(found.max, distances.max(axis=0))
    assert (found.bins.sum(axis=0) == found.count).all() and found.bins[0].sum() + found.bins[-1].sum() > 0
    for q in (0, 0.1, 0.5, 0.77, 1):
        lower, upper = (bound[owned] for bound in found.quantile(q))
        exact = np.quantile(distances[:, owned], q, axis=0, method="inverted_cdf")
        assert (lower <= exact).all() and (exact <= upper).all()
        inside = (exact > found.low) & (exact <= found.high)
        assert inside.any() and (upper - lower)[inside].max() <= found.bin_width
    assert np.isnan(found.quantile(0.5)[0][~owned]).all()
    found.save(tmp_path / "statistics.npz")
    np.testing.assert_array_equal(np.load(tmp_path / "statistics.npz")["mean"], found.mean)


def test_cohorts_are_the_same_whatever_runs_them():
    sphere = meshes.sphere()
    copies = copies_of(sphere, 40)
    work = sdm.dask.cohort_statistics(sphere, copies, meshes.box(), range=(-1, 1), bins=8, resolution=32, copies_per_task=1)
    first = work.compute()
    _cohort._surfaces._entries.clear()
    with dask.config.set(scheduler="threads", num_workers=4):
        second = work.compute()
    for name in ("count", "mean", "variance", "min", "max", "bins"):
        np.testing.assert_array_equal(getattr(first, name), getattr(second, name))


def test_copies_that_cannot_be_used(tmp_path):
    sphere = meshes.sphere()
    good = copies_of(sphere, 4)
    bad = good[0].copy()
    bad[2] = np.nan
    copies = [good[0], bad, good[1], good[2][:-1], tmp_path / "none.npy", good[2], (tmp_path / "none.npy", 3), good[3]]
    options = {"range": (-1, 1), "resolution": 32, "copies_per_task": 2}
    found = sdm.dask.cohort_statistics(sphere, copies, meshes.box(), **options).compute()
    assert list(found.errors) == [1, 3, 4, 6] and "none.npy" in found.errors[4] and "NaN" in found.errors[1]
    assert found.count.max() == 4
    with pytest.raises(sdm.Error, match="copy 0"):
        sdm.dask.cohort_statistics(sphere, [bad], meshes.box(), **options).compute()
    boxes = [meshes.box(high=(1, 1, k + 1)) for k in range(4)]
    several = sdm.dask.cohort_statistics(sphere, good, boxes, **options).compute()
    assert several.count.max() == 4
    for arguments in ({"range": (1, 0)}, {"bins": 0}, {"copies_per_task": 0}):
        with pytest.raises(sdm.Error):
            sdm.dask.cohort_statistics(sphere, good, meshes.box(), **{**options, **arguments})
    with pytest.raises(sdm.Error, match="4 copies, but 1"):
        sdm.dask.cohort_statistics(sphere, good, [meshes.box()], **options)
