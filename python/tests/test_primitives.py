"""Primitive shapes and margins, against closed forms."""

import math
import pickle

import numpy
import pytest
import sdm


def moved(x: float, y: float, z: float) -> numpy.ndarray:
    pose = numpy.eye(4)
    pose[:3, 3] = x, y, z
    return pose


def query(o1: sdm.Shape, o2: sdm.Shape, x: float, y: float, z: float) -> sdm.ProximityQuery:
    found = sdm.ProximityQuery(o1, o2)
    found.set_pose(0, moved(x, y, z))
    return found


def test_distances_in_closed_form() -> None:
    sphere, box = sdm.Shape.sphere(0.5), sdm.Shape.box([2, 2, 2])
    assert float(query(sphere, sdm.Shape.sphere(1), 3, 4, 0).separation()) == pytest.approx(3.5)
    assert float(query(sphere, box, 2, 2, 2).separation()) == pytest.approx(math.sqrt(3) - 0.5)
    assert float(query(sphere, sdm.Shape.capsule(0.25, 2), 2, 0, 1).separation()) == pytest.approx(1.25)
    assert float(query(sphere, sdm.Shape.cylinder(1, 2), 4, 0, 0).separation()) == pytest.approx(2.5)
    assert float(query(sphere, sdm.Shape.half_space([0, 0, 2], 1), 0, 0, 3).separation()) == pytest.approx(1.5)
    assert float(query(sphere, box.with_margin(0.25), 4, 0, 0).separation()) == pytest.approx(2.25)


def test_four_contacts_of_a_resting_box() -> None:
    resting = query(sdm.Shape.box([1, 2, 1]), sdm.Shape.half_space([0, 0, 1]), 0, 0, 0.49)
    contacts = resting.contacts()
    assert len(contacts.depth) == 4
    assert contacts.depth == pytest.approx([0.01] * 4)


def test_have_no_faces() -> None:
    sphere = sdm.Shape.sphere(2)
    assert not sphere.has_mesh
    assert sphere.margin == 2
    assert sphere.convex
    assert "without faces" in repr(sphere)
    with pytest.raises(sdm.Error, match="no mesh"):
        _ = sphere.faces


@pytest.mark.parametrize(
    "shape",
    [
        sdm.Shape.sphere(0.7),
        sdm.Shape.capsule(0.3, 1.1),
        sdm.Shape.cylinder(0.4, 0.9).with_margin(0.1).with_margin(0.03),
        sdm.Shape.half_space([0.3, -0.2, 1], 0.25).with_margin(0.1),
        sdm.Shape.box([1, 2, 3]).with_margin(0.2),
    ],
    ids=["sphere", "capsule", "cylinder", "half-space", "box"],
)
def test_are_pickled(shape: sdm.Shape) -> None:
    again = pickle.loads(pickle.dumps(shape))
    assert (again.has_mesh, again.margin, repr(again)) == (shape.has_mesh, shape.margin, repr(shape))
    assert pickle.dumps(again) == pickle.dumps(shape)
    for x in (0.2, 1.5, 4):
        first, second = (query(s, sdm.Shape.box([1, 1, 1]), x, 0.1, 0.2) for s in (shape, again))
        assert float(first.separation()) == float(second.separation())
        assert first.colliding() == second.colliding()
    damaged = list(shape.__getstate__())
    damaged[2] = damaged[2][:-1] + b"\x07" if damaged[2] else b"\x07"
    with pytest.raises(sdm.Error):
        sdm.Shape.__new__(sdm.Shape).__setstate__(tuple(damaged[:3]))


@pytest.mark.parametrize("size", [0, -1, math.nan, math.inf])
def test_refuse_sizes_that_are_none(size: float) -> None:
    for make in (
        lambda: sdm.Shape.sphere(size),
        lambda: sdm.Shape.capsule(1, size),
        lambda: sdm.Shape.cylinder(size, 1),
        lambda: sdm.Shape.box([1, size, 1]),
        lambda: sdm.Shape.sphere(1).with_margin(size),
    ):
        with pytest.raises(sdm.Error):
            make()
    with pytest.raises(sdm.Error, match="normal"):
        sdm.Shape.half_space([0, 0, 0])
