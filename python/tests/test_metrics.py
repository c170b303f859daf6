"""Measures that compare two surfaces."""

import math
import pickle

import meshes
import numpy
import pytest

import sdm


def test_names_and_bounds():
    metrics = sdm.surface_metrics(meshes.box(), meshes.sphere(), tolerances=[0.1], percentiles=[50, 95])
    assert list(metrics) == [
        "hd", "hd50", "hd95", "assd", "masd", "rmsd", "chamfer_l1", "chamfer_l2",
        "nsd(0.1)", "precision(0.1)", "recall(0.1)", "f_score(0.1)", "normal_consistency",
    ]  # fmt: skip
    for number in metrics.values():
        assert number.lower <= number.value <= number.upper
    assert metrics["hd50"].value < metrics["hd95"].value < metrics["hd"].value
    assert metrics["hd"].value == pytest.approx(sdm.hausdorff(meshes.box(), meshes.sphere()).value)
    assert metrics["normal_consistency"].certainty == "estimate"
    mean = metrics.a_to_b["mean"].value, metrics.b_to_a["mean"].value
    assert metrics["masd"].value == pytest.approx(sum(mean) / 2)
    assert metrics["assd"].value == pytest.approx(numpy.average(mean, weights=metrics.areas))
    assert metrics.a_to_b["within(0.1)"] == metrics["precision(0.1)"]
    assert pickle.loads(pickle.dumps(metrics)) == metrics


def test_estimates():
    options = {"tolerances": [0.1], "precision": 0.003}
    metrics = sdm.surface_metrics(meshes.box(), meshes.sphere(), estimate=True, **options)
    certified = sdm.surface_metrics(meshes.box(), meshes.sphere(), **options)
    assert certified["hd95"].confidence is None and certified.points == (0, 0)
    for name in ("hd95", "assd", "rmsd", "chamfer_l2", "nsd(0.1)", "f_score(0.1)"):
        number = metrics[name]
        assert number.certainty == "estimate" and number.confidence == 0.99
        assert number.lower <= certified[name].upper and certified[name].lower <= number.upper
        assert number.lower <= number.value <= number.upper
    assert metrics["hd"].certainty != "estimate" and metrics["hd"].confidence is None
    assert metrics["normal_consistency"].confidence is None
    assert metrics.a_to_b["mean"].confidence == 0.99 and min(metrics.points) >= 65536
    assert "estimate, 99 %" in repr(metrics["hd95"])


# The mean of distances to a plane, which sampling only estimates.
def test_parallel_squares():
    square = numpy.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]], dtype=float)
    faces = [[0, 1, 2], [0, 2, 3]]
    metrics = sdm.surface_metrics((square, faces), (square + [0, 0, 0.5], faces), tolerances=0.6)
    for name in ("hd", "hd95", "assd", "masd", "rmsd"):
        assert metrics[name].value == pytest.approx(0.5, abs=1e-5)
    assert metrics["chamfer_l2"].value == pytest.approx(0.5, abs=1e-5)
    assert metrics["nsd(0.6)"].value == 1


def test_masks():
    ball = numpy.linalg.norm(numpy.indices((24, 24, 24)) - 11.5, axis=0) < 9
    moved = numpy.roll(ball, 2, axis=0)
    metrics = sdm.surface_metrics(sdm.mask_surface(ball, 0.5), sdm.mask_surface(moved, 0.5), tolerances=[1])
    assert metrics["hd"].value == pytest.approx(1)
    assert 0 < metrics["assd"].value < 1
    assert metrics["nsd(1)"].value == 1, "distances that are equal to the tolerance are within it"
    vertices, faces = sdm.mask_surface(numpy.ones((2, 3, 4)), [1, 2, 3])
    assert vertices.min(axis=0).tolist() == [-0.5, -1, -1.5]
    assert vertices.max(axis=0).tolist() == [1.5, 5, 10.5]
    corners = vertices[faces]
    volume = numpy.einsum("ij,ij->i", corners[:, 0], numpy.cross(corners[:, 1], corners[:, 2])).sum() / 6
    assert volume == pytest.approx(2 * 6 * 12), "closed, with outward normals"


def test_empty_masks():
    none, some = (sdm.mask_surface(numpy.full((3, 3, 3), value)) for value in (False, True))
    both = sdm.surface_metrics(none, none, tolerances=[1])
    assert (both["hd"].value, both["nsd(1)"].value) == (0, 1)
    one = sdm.surface_metrics(some, none, tolerances=[1])
    assert (one["assd"].value, one["nsd(1)"].value, one["f_score(1)"].value) == (math.inf, 0, 0)


@pytest.mark.parametrize(
    "options, reason",
    [
        ({"percentiles": [100]}, "percentile"),
        ({"tolerances": [-1]}, "tolerance"),
        ({"tolerances": ["near"]}, "tolerances is .*: it must be numbers of at least 0"),
        ({"precision": 0}, "precision"),
    ],
)
def test_options_out_of_range(options, reason):
    with pytest.raises((sdm.Error, TypeError), match=reason):
        sdm.surface_metrics(meshes.box(), meshes.sphere(), **options)


@pytest.mark.parametrize("mask, spacing", [(numpy.ones((2, 2)), 1), (numpy.ones((2, 2, 2)), 0), (numpy.ones((2, 2, 2)), [1, 2])])
def test_masks_out_of_range(mask, spacing):
    with pytest.raises(sdm.Error):
        sdm.mask_surface(mask, spacing)


def test_progress_cancels():
    with pytest.raises(sdm.Cancelled):
        sdm.surface_metrics(meshes.sphere(), meshes.box(), progress=lambda step, fraction: False)
