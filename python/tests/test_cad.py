"""CAD files, which only builds with SDM_BUILD_CAD read."""

import os
import pickle

import numpy as np
import pytest

import sdm

FILES = os.environ.get("SDM_CAD_FILES")
pytestmark = pytest.mark.skipif(not FILES, reason="sdm was built without CAD files")


def test_parts_are_read_with_a_deflection():
    coarse = sdm.read(f"{FILES}/cylinder.step", deflection=0.1)
    fine = sdm.read(f"{FILES}/cylinder.step", deflection=0.001)
    assert len(fine.faces) > len(coarse.faces)
    for mesh in (coarse, fine):
        radii = np.hypot(mesh.vertices[:, 0], mesh.vertices[:, 1])
        np.testing.assert_allclose(radii, 10, atol=1e-9)


def test_parts_are_meshes_by_their_path():
    distances = sdm.Sites(f"{FILES}/box.step").closest_points([[0, 0, 0], [5, 10, 40]]).distance
    np.testing.assert_allclose(distances, [0, 10])


def test_a_deflection_must_be_positive():
    with pytest.raises(sdm.Error, match="deflection is 0: it must be a number greater than 0"):
        sdm.read(f"{FILES}/box.step", deflection=0)


def test_tolerances_hold_for_the_surface(tmp_path):
    # A ball of radius 10, whose triangles are more than 0.03 inside of it by default.
    coarse, fine = sdm.read(f"{FILES}/sphere.step"), sdm.read(f"{FILES}/sphere.step", deflection=0.006)
    assert 0 < fine.deviation < coarse.deviation
    assert sdm.Mesh(coarse).deviation == pickle.loads(pickle.dumps(coarse)).deviation == coarse.deviation
    np.testing.assert_allclose(coarse.transformed(np.diag([2, 2, 2, 1])).deviation, 2 * coarse.deviation)
    assert sdm.convex_hull(coarse).deviation == sdm.weld(coarse)[0].deviation == coarse.deviation
    simple, added = sdm.simplify(coarse, triangles=500)
    assert simple.deviation == coarse.deviation + added.upper
    vertices, faces = sdm.read(f"{FILES}/sphere.step", deflection=0.003)
    assert sdm.Mesh((vertices, faces)).deviation == 0
    place = coarse.vertices[coarse.faces[len(coarse.faces) // 2]].sum(axis=0)
    dented = vertices.copy()
    dented[np.argmax(dented @ place)] *= 0.991
    assert sdm.map((vertices, faces), fine, resolution=64).check(0.06).verdict == "pass"
    assert sdm.map((dented, faces), fine, resolution=64).check(0.06).verdict == "fail"
    undecided = sdm.map((dented, faces), sdm.Sites(coarse), resolution=64)
    assert undecided.check(0.06).verdict == "not decided" and undecided.check(0.06).reason == "guard band"
    assert pickle.loads(pickle.dumps(undecided)).check(0.06).reason == "guard band"
    report = undecided.report(tolerance=0.06)
    assert report["tolerance"]["verdict"] == "NOT DECIDED" and report["evidence"]["guard"] == coarse.deviation
    all_faces = sdm.FaceNames("group", ["all"], np.zeros(len(faces), np.uint32))
    assert undecided.check_groups({"all": 0.06}, all_faces).verdict == "not decided"
    on_cad = sdm.map(coarse, (dented, faces), resolution=64)
    assert on_cad.check(0.06).verdict == "not decided"
    cloud = tmp_path / "cloud.xyz"
    np.savetxt(cloud, dented, fmt="%.17g")
    for o2, verdict in ((coarse, "not decided"), (fine, "fail")):
        names = sdm.FaceNames("group", ["all"], np.zeros(len(o2.faces), np.uint32))
        groups = sdm.measure_points(cloud, o2, tmp_path / "out.ply", tolerance_table={"all": 0.06}, names=names).groups
        assert groups.verdict == verdict


def test_a_crash_of_opencascade_is_an_error(tmp_path):
    with open(f"{FILES}/box.step", encoding="latin-1") as part:
        text = part.read().replace("FACE_BOUND", "FACE_BUNND")
    bad = tmp_path / "bad.step"
    bad.write_text(text, encoding="latin-1")
    sdm.Sites(f"{FILES}/box.step").closest_points(np.zeros((1000, 3)))  # has started threads
    with pytest.raises(sdm.Error, match="bad.step: OpenCASCADE cannot read it; it is damaged"):
        sdm.read(bad)
    assert len(sdm.read(f"{FILES}/box.step").faces) == 12
