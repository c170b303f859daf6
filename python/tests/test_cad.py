"""CAD files, which only builds with SDM_BUILD_CAD read."""

import os

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
    with pytest.raises(sdm.Error, match="must be positive"):
        sdm.read(f"{FILES}/box.step", deflection=0)


def test_a_crash_of_opencascade_is_an_error(tmp_path):
    with open(f"{FILES}/box.step", encoding="latin-1") as part:
        text = part.read().replace("FACE_BOUND", "FACE_BUNND")
    bad = tmp_path / "bad.step"
    bad.write_text(text, encoding="latin-1")
    sdm.Sites(f"{FILES}/box.step").closest_points(np.zeros((1000, 3)))  # has started threads
    with pytest.raises(sdm.Error, match="bad.step: OpenCASCADE cannot read it; it is damaged"):
        sdm.read(bad)
    assert len(sdm.read(f"{FILES}/box.step").faces) == 12
