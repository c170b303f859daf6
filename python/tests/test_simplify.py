"""Fewer triangles, with a certified deviation."""

import meshes
import numpy as np
import pytest

import sdm


def test_limits_are_kept():
    given = sdm.Mesh(meshes.sphere(steps=4))
    coarse, deviation = sdm.simplify(given, triangles=100)
    assert 1 <= len(coarse.faces) <= 100
    assert deviation.certainty == "bounded" and 0 < deviation.lower <= deviation.upper
    truth = sdm.hausdorff(given, coarse)
    assert truth.lower <= deviation.upper and deviation.lower <= truth.upper
    finer, kept = sdm.simplify(given, max_deviation=deviation.lower / 2, keep_vertices=True)
    assert kept.upper <= deviation.lower / 2 and len(finer.faces) > len(coarse.faces)
    free, free_deviation = sdm.simplify(given, max_deviation=deviation.lower / 2)
    assert free_deviation.upper <= deviation.lower / 2 and len(free.faces) < len(finer.faces)
    known = {tuple(p) for p in given.vertices}
    assert all(tuple(p) in known for p in finer.vertices)


def test_soups_are_welded_and_the_input_is_kept():
    vertices, faces = meshes.sphere()
    soup = np.asarray(vertices)[np.asarray(faces)].reshape(-1, 3)
    coarse, deviation = sdm.simplify((soup, np.arange(len(soup)).reshape(-1, 3)), triangles=60)
    assert len(coarse.faces) <= 60 and deviation.upper < 1
    with pytest.warns(RuntimeWarning, match="the mesh itself"):
        same, zero = sdm.simplify(meshes.sphere(), max_deviation=1e-9)
    assert len(same.faces) == len(faces) and zero.upper == 0


def test_levels_of_detail():
    given = sdm.Mesh(meshes.sphere(steps=4))
    one, deviation = sdm.simplify(given, triangles=200)
    levels = sdm.simplify(given, triangles=200, lods=2)
    assert len(levels) == 3 and levels[0][1].upper == deviation.upper
    np.testing.assert_array_equal(levels[0][0].faces, one.faces)
    for number, (mesh, bounds) in enumerate(levels):
        assert 0 < len(mesh.faces) <= 200 // 2**number
        truth = sdm.hausdorff(given, mesh)
        assert truth.lower <= bounds.upper and bounds.lower <= truth.upper
    limit = levels[0][1].upper
    for number, (mesh, bounds) in enumerate(sdm.simplify(given, max_deviation=limit, lods=2)):
        assert bounds.upper <= limit * 2**number
    assert len(sdm.simplify(given, triangles=200, lods=0)) == 1
    with pytest.raises(sdm.Error, match="lods"):
        sdm.simplify(given, triangles=200, lods=-1)


def test_result_is_saved(tmp_path):
    coarse, _ = sdm.simplify(meshes.sphere(), triangles=100)
    for name in ("low.ply", "low.obj", "low.glb", "low.stl"):
        coarse.save(tmp_path / name)
        assert len(sdm.read(tmp_path / name).faces) == len(coarse.faces)
    with pytest.raises(sdm.Error, match="extension"):
        coarse.save(tmp_path / "low.xyz")


def test_errors():
    with pytest.raises(sdm.Error, match="needs max_deviation or triangles"):
        sdm.simplify(meshes.box())
    with pytest.raises(sdm.Error, match="max_deviation excludes triangles"):
        sdm.simplify(meshes.box(), max_deviation=1, triangles=2)
    for limit in (0, -1, np.nan):
        with pytest.raises(sdm.Error, match="greater than 0"):
            sdm.simplify(meshes.box(), max_deviation=limit)
    with pytest.raises(sdm.Error, match="triangles"):
        sdm.simplify(meshes.box(), triangles=0)
    with pytest.raises(TypeError):
        sdm.simplify(meshes.box(), triangles=1.5)
    with pytest.raises(sdm.Cancelled):
        sdm.simplify(meshes.sphere(), triangles=50, progress=lambda step, fraction: False)


def test_what_a_file_has_besides_is_kept(tmp_path):
    vertices, faces = (np.asarray(array) for array in meshes.sphere(steps=4))
    lines = ["mtllib ball.mtl"]
    for point in vertices:
        lines.append("v {} {} {} {} {} {}".format(*point, *(0.5 + point / 2 / np.abs(vertices).max())))
    below = vertices[faces][:, :, 2].mean(axis=1) < 0
    for name, of_name in (("red", faces[below]), ("blue", faces[~below])):
        lines += [f"usemtl {name}"] + ["f {} {} {}".format(*(1 + face)) for face in of_name]
    (tmp_path / "ball.obj").write_text("\n".join(lines))
    (tmp_path / "ball.mtl").write_text("newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\nPm 1\n")
    coarse, _ = sdm.simplify(tmp_path / "ball.obj", triangles=200)
    colors = coarse.attributes["color"]
    assert colors.shape == (len(coarse.faces), 3, 3)
    assert sdm.Mesh((vertices, faces)).attributes == {}
    for name in ("low.glb", "low.obj"):
        coarse.save(tmp_path / name)
        np.testing.assert_allclose(
            np.sort(sdm.read_attributes(tmp_path / name)["color"][..., :3].ravel()), np.sort(colors.ravel()), atol=1e-5
        )
    written = (tmp_path / "low.obj").read_text()
    assert written.count("usemtl red") >= 1 and written.count("usemtl blue") >= 1
    assert "Kd 1 0 0" in (tmp_path / "low.mtl").read_text()
    # The border between the materials stays: both have about half of the faces.
    assert 60 < written.split("usemtl blue")[0].count("\nf ") < 140
