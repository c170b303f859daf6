"""Distance fields, point clouds in files, and scenes."""

import os

import numpy as np
import pytest

import meshes
import oracle
import sdm


def grid_points(field):
    nz, ny, nx = field.distance.shape
    k, j, i = np.meshgrid(np.arange(nz), np.arange(ny), np.arange(nx), indexing="ij")
    indices = np.stack([i, j, k, np.ones_like(i)], axis=-1).reshape(-1, 4)
    return (indices @ field.transform.T)[:, :3]


def test_values_of_fields():
    mesh = meshes.sphere()
    field = sdm.distance_field(mesh, shape=(7, 9, 11), sites=True)
    assert field.distance.shape == field.site.shape == field.site_type.shape == (7, 9, 11)
    assert field.distance.dtype == np.float32 and not field.distance.flags.writeable
    points = grid_points(field)
    np.testing.assert_allclose(points[0], field.origin)
    np.testing.assert_allclose(points[-1], field.origin + field.spacing * [10, 8, 6])
    expected, _ = oracle.closest_points(*mesh, points)
    inside = oracle.winding_numbers(*mesh, points) > 0.5
    np.testing.assert_allclose(field.distance.ravel(), np.where(inside, -expected, expected), atol=field.accuracy)
    assert field.sign == "exact" and field.sign_reason


def test_samples_of_fields():
    field = sdm.distance_field(meshes.box(), spacing=0.1)
    points = np.random.default_rng(0).uniform(-1, 2, (500, 3))
    found = field.sample(points)
    truth = sdm.Sites(meshes.box()).signed_distance(points)
    rounding = 1e-15  # of the truth itself
    assert (found.lower <= truth + rounding).all() and (truth <= found.upper + rounding).all() and len(found) == 500
    known = np.isfinite(found.value)
    assert 0 < known.sum() < 500
    assert np.abs(found.value - truth)[known].max() <= field.interpolation_error


def test_bands_bounds_and_margins(tmp_path):
    sites = sdm.Sites(meshes.box())
    field = sdm.distance_field(sites, spacing=0.25, max_distance=0.3)
    assert field.max_distance == 0.3 and 0 < field.beyond_max_distance == np.isnan(field.distance).sum() and field.site is None
    assert field.distance.shape == sdm.distance_field(sites, spacing=0.25, margin=0.3).distance.shape
    bounded = sdm.distance_field(sites, shape=(1, 2, 3), bounds=[[0, 0, 0], [1, 1, 1]])
    np.testing.assert_array_equal(bounded.origin, [0, 0, 0.5])
    np.testing.assert_array_equal(bounded.spacing[:2], [0.5, 1])
    for name in ("f.npy", "f.vti", "f.vdb"):
        field.save(tmp_path / name)
    np.testing.assert_array_equal(np.load(tmp_path / "f.npy"), field.distance.transpose(2, 1, 0))
    with pytest.raises(sdm.Error, match="f.txt"):
        field.save(tmp_path / "f.txt")


@pytest.mark.parametrize("options", [
    {}, {"spacing": 0.1, "shape": (2, 2, 2)}, {"spacing": 0}, {"spacing": np.nan}, {"spacing": 1e-9}, {"shape": (2, 2)},
    {"shape": (0, 2, 2)}, {"shape": (2, 2, 2.5)}, {"shape": (2**21, 2, 2)}, {"spacing": 0.1, "bounds": [[1, 1, 1], [0, 0, 0]]},
    {"spacing": 0.1, "bounds": [[0, 0, 0]]}, {"spacing": 0.1, "margin": -1}, {"spacing": 0.1, "margin": np.inf},
    {"spacing": 0.1, "max_distance": 0}, {"spacing": 0.1, "sign": "other"},
    {"spacing": 0.1, "bounds": [[0, 0, 0], [1, 1, 1]], "margin": 1},
])  # fmt: skip
def test_bad_options_of_fields(options):
    with pytest.raises(sdm.Error):
        sdm.distance_field(meshes.box(), **options)


def test_bad_meshes_and_cancelling_of_fields():
    with pytest.raises(sdm.Error, match="index out of range"):
        sdm.distance_field(([[0, 0, 0]], [[0, 1, 2]]), spacing=1)
    with pytest.raises(sdm.Cancelled):
        sdm.distance_field(meshes.sphere(), shape=(50, 50, 50), progress=lambda step, fraction: False)


def test_clouds(tmp_path):
    random = np.random.default_rng(0)
    points = random.uniform(-1, 2, (2000, 3))
    np.savetxt(tmp_path / "cloud.xyz", points, fmt="%.17g")
    read, normals = sdm.read_points(tmp_path / "cloud.xyz")
    np.testing.assert_array_equal(read, points)
    assert normals is None
    sites = sdm.Sites(meshes.box())
    found = sdm.measure_points(tmp_path / "cloud.xyz", sites, tmp_path / "out.ply", tolerance=0.5)
    truth = sites.signed_distance(points)
    assert found.points == 2000 and found.invalid == found.beyond_max_distance == 0 and found.sign == "exact"
    assert found.min.index == truth.argmin() and found.max.index == truth.argmax()
    np.testing.assert_allclose([found.min.distance, found.max.distance], [truth.min(), truth.max()], atol=1e-6)
    np.testing.assert_allclose(found.min.point, points[truth.argmin()])
    assert found.beyond_tolerance == (np.abs(truth) > 0.5).sum()
    s = found.statistics()
    assert s.texels == 2000 and s.mean == pytest.approx(truth.mean(), abs=1e-6)
    written, _ = sdm.read_points(tmp_path / "out.ply")
    np.testing.assert_array_equal(written, points)
    lines = sdm.measure_points(tmp_path / "cloud.xyz", sites, tmp_path / "out.ply", along=(0, 0, 1))
    assert lines.measured.startswith("distance along the direction (0 0 1)") and lines.sign == "side"
    for refused in ({"along": "normal"}, {"along": (0, 0, 1), "facing": 90}, {"along": "up"}):
        with pytest.raises(sdm.Error):
            sdm.measure_points(tmp_path / "cloud.xyz", sites, tmp_path / "bad.ply", **refused)
    # Moved onto the box, by a matrix.
    matrix = np.diag([1e-9, 1e-9, 1e-9, 1])
    near = sdm.measure_points(tmp_path / "cloud.xyz", meshes.box(), tmp_path / "out.ply", transform=matrix, sign="none")
    assert near.max.distance < 1e-7
    with pytest.raises(sdm.Error, match="differs by the sign"):
        sdm.measure_points(tmp_path / "cloud.xyz", sites, tmp_path / "bad.ply", sign="none", tolerance=(-0.1, 0.2))
    assert found.format == "text" and found.text == {
        "separator": "blank",
        "decimal": "point",
        "columns": ["x", "y", "z"],
        "header_line": None,
    }
    # A text that leaves open what its columns are.
    rows = "".join(f"{i};{x};{z};{y}\n" for i, (x, y, z) in enumerate(points)).replace(".", ",")
    (tmp_path / "cloud.csv").write_text(rows)
    with pytest.raises(sdm.Error, match="--columns"):
        sdm.read_points(tmp_path / "cloud.csv")
    dialect = dict(columns=["id", "x", "z", "y"], separator="semicolon", decimal="comma")
    read, _ = sdm.read_points(tmp_path / "cloud.csv", **dialect)
    np.testing.assert_array_equal(read, points)
    same = sdm.measure_points(tmp_path / "cloud.csv", sites, tmp_path / "out.ply", **dialect)
    assert same.max.distance == found.max.distance and same.text["columns"] == ["_", "x", "z", "y"]
    for wrong in (dict(columns=["x", "y"]), dict(separator=","), dict(decimal=".")):
        with pytest.raises(sdm.Error):
            sdm.read_points(tmp_path / "cloud.csv", **wrong)
    (tmp_path / "text.xyz").write_text("no points")
    for name in ("text.xyz", "missing.ply"):
        with pytest.raises(sdm.Error, match=name):
            sdm.read_points(tmp_path / name)
        with pytest.raises(sdm.Error, match=name):
            sdm.measure_points(tmp_path / name, sites, tmp_path / "bad.ply")
    assert not (tmp_path / "bad.ply").exists()


def test_points_are_not_written_over_an_input(tmp_path):
    cloud, part, table = tmp_path / "cloud.xyz", tmp_path / "part.ply", tmp_path / "table.csv"
    cloud.write_text("0 0 0\n1 2 3\n")
    sdm.Mesh(*meshes.box()).save(part)
    table.write_text("group,lower,upper\ntop,-1,1\n")
    (tmp_path / "link.ply").symlink_to(part)
    os.link(cloud, tmp_path / "other.ply")
    before = {file: file.read_bytes() for file in tmp_path.iterdir()}
    for output, named in (("cloud.xyz", cloud), ("other.ply", cloud), ("part.ply", part), ("link.ply", part), ("table.csv", table)):
        with pytest.raises(sdm.Error, match=f"cannot write .*{output}: it is the input .*{named.name}"):
            sdm.measure_points(cloud, part, tmp_path / output, tolerance_table=table)
    assert {file: file.read_bytes() for file in tmp_path.iterdir()} == before


def test_scenes():
    with pytest.raises(sdm.Error, match="scene must be one of"):
        sdm.scene("other")
    scene = sdm.scene("letters")
    assert scene.time_step > 0 and all(body.moves and not body.tears for body in scene.bodies)
    again = sdm.scene("letters")
    for _ in range(3):
        scene.advance()
        again.advance()
    for body, same in zip(scene.bodies, again.bodies):
        np.testing.assert_array_equal(body.mesh.vertices, same.mesh.vertices)


def test_made_scans():
    scan = sdm.make_scan(meshes.box(), triangles=4000, noise=0)
    vertices = scan.mesh.vertices
    back = np.linalg.inv(scan.transform)
    distances = sdm.Sites(meshes.box()).signed_distance(vertices @ back[:3, :3].T + back[:3, 3])
    # Without noise, the scan lies on the part but for the dent, which is inwards.
    assert distances.max() < 1e-9 and -scan.dent_depth - 1e-9 <= distances.min() < -0.5 * scan.dent_depth
    assert 0 < scan.missing < 0.5 and scan.size == pytest.approx(np.sqrt(3))
    with pytest.raises(sdm.Error, match="flat place"):
        sdm.make_scan(meshes.box(), dent=0.4)
