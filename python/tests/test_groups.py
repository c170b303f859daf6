"""Places, and verdicts on named groups."""

import pickle

import numpy as np
import pytest

import meshes
import sdm


def plate(folder):
    """A plate of two named halves."""
    file = folder / "plate.obj"
    file.write_text(
        "v 0 0 0\nv 5 0 0\nv 10 0 0\nv 0 10 0\nv 5 10 0\nv 10 10 0\ng left\nf 1 2 5 4\ng right\nf 2 3 6 5\n"
    )
    return file


def cloud(folder, floating):
    """Points of the plate with a bump on the left half, and floating ones."""
    random = np.random.default_rng(1)
    points = np.c_[random.uniform(0, 10, (20000, 2)), np.zeros(20000)]
    up = np.hypot(points[:, 0] - 2, points[:, 1] - 2)
    points[:, 2] = np.where(up < 0.8, 0.5 * (1 - up**2), 0)
    points = np.r_[points, random.uniform([0, 0, 4], [10, 10, 9], (floating, 3))]
    file = folder / "cloud.xyz"
    np.savetxt(file, points)
    return file


def test_names_of_a_file(tmp_path):
    (names,) = sdm.read_face_names(plate(tmp_path))
    assert (names.kind, names.names, names.of_face.tolist()) == ("group", ["left", "right"], [0, 0, 1, 1])
    with pytest.raises(sdm.Error, match="a name that there is not"):
        sdm.FaceNames("group", ["left"], [0, 1])


def test_groups_of_a_map(tmp_path):
    vertices, faces = meshes.sphere()
    vertices = np.array(vertices)
    top = vertices[np.asarray(faces)].mean(axis=1)[:, 2] > 0
    names = sdm.FaceNames("group", ["bottom", "top"], top.astype(np.uint32))
    moved = vertices + [0, 0, 0.25]
    m = sdm.map((moved, faces), (vertices, faces), resolution=128)
    verdicts = m.check_groups({"top": (-0.05, 0.3), "bottom": 0.1}, names)
    assert verdicts.verdict == "fail"
    assert [(g.group, g.verdict.verdict) for g in verdicts.groups] == [("top", "pass"), ("bottom", "fail")]
    assert verdicts.groups[0].highest == pytest.approx(0.25, abs=1e-3)
    assert verdicts.groups[0].verdict.certified
    assert verdicts.groups[0].faces + verdicts.groups[1].faces == len(faces)
    table = tmp_path / "table.csv"
    table.write_text("group,lower,upper\ntop,-0.05,0.3\n")
    assert m.check_groups(table, [names]).verdict == "pass"
    with pytest.raises(sdm.Error, match="has the name 'lid'.*its names are bottom, top"):
        m.check_groups({"lid": 1}, names)
    with pytest.raises(sdm.Error, match="of 3 faces"):
        m.check_groups({"a": 1}, sdm.FaceNames("group", ["a"], [0, 0, 0]))
    with pytest.raises(sdm.Error, match="empty"):
        m.check_groups({}, names)


def test_results_have_the_fields_of_reports():
    m = sdm.map(meshes.sphere(), meshes.box(), resolution=64)
    report, places = m.report(tolerance=0.2), m.places(0.2)
    for name, totals in {"large": places.large, "small": places.small}.items():
        keys = {"count": "count", "samples": "texels", "area": "area", "fraction": "area_fraction"}
        assert totals == {field: report["places"][name][key] for field, key in keys.items()}
    assert len(places.largest) == len(report["places"]["largest"]) > 0
    for place, row in zip(places.largest, report["places"]["largest"]):
        assert (place.face, place.samples, place.area, place.fraction) == tuple(
            row[key] for key in ("triangle", "texels", "area", "area_fraction")
        )
        assert place.point == tuple(row["point"]) and place.limits == (row["lower"], row["upper"])
        assert (place.sample is None) == (row["at"] == "vertex")
    verdict = m.check(0.2)
    for name in ("within", "certified", "margin", "exceeded_area_fraction", "reason"):
        assert getattr(verdict, name) == report["tolerance"][name], name
    assert verdict.verdict.upper() == report["tolerance"]["verdict"]


def test_places_of_a_map():
    vertices, faces = meshes.sphere()
    vertices = np.array(vertices)
    top = vertices[np.asarray(faces)].mean(axis=1)[:, 2] > 0
    names = sdm.FaceNames("group", ["bottom", "top"], top.astype(np.uint32))
    m = sdm.map((vertices + [0, 0, 0.25], faces), (vertices, faces), resolution=128)
    places = m.places(0.2, names=names)
    assert places.by_tolerance and places.limits == (-0.2, 0.2)
    assert places.count == 2 and [p.group for p in places.largest[:2]] in (["top", "bottom"], ["bottom", "top"])
    assert places.fraction == pytest.approx(m.check(0.2).exceeded_area_fraction - places.small_fraction, abs=1e-6)
    assert abs(places.largest[0].point[2] - 0.25) > 0.8
    far = m.places()
    assert not far.by_tolerance
    assert far.limits[1] == pytest.approx(m.statistics().p99_abs)
    of_top = m.places(names=names, tolerance_table={"top": (None, 0.2)})
    assert of_top.by_tolerance and of_top.limits == (-np.inf, np.inf)
    assert {p.group for p in of_top.largest} == {"top"} and of_top.largest[0].limits == (-np.inf, 0.2)
    assert m.check_groups({"top": (None, 0.3), "bottom": (-0.3, None)}, names).verdict == "pass"
    for call in (m.check, m.places):
        for wrong in ("x", (1, "x"), (1, 2, 3), (0.1,), (), [None, None], {}):
            fault = sdm.Error if wrong in ((1, 2, 3), (0.1,), ()) else TypeError
            with pytest.raises(fault, match="it must be a number of at least 0, or two, LO:HI, the smaller one first"):
                call(wrong)


def test_points_of_clouds_have_the_side_that_they_have(tmp_path):
    plane = [[-5, -5, 0], [5, -5, 0], [5, 5, 0], [-5, 5, 0]], [[0, 1, 2], [0, 2, 3]]
    names = sdm.FaceNames("group", ["all"], np.zeros(2, np.uint32))
    on, behind, front, beside = [0, 0, 0], [1, 0, -0.05], [1, 0, 0.05], [5, 0, -0.05]

    def verdict(points, limits):
        np.savetxt(tmp_path / "cloud.xyz", points, fmt="%.17g")
        options = dict(sign="side", tolerance=limits, tolerance_table={"all": limits}, names=names)
        return sdm.measure_points(tmp_path / "cloud.xyz", plane, tmp_path / "out.ply", **options).groups.verdict

    assert verdict([on, on], (-0.1, 0.02)) == "pass"
    assert verdict([on, behind], (-0.1, 0.02)) == "pass"
    assert verdict([on, behind], (-0.04, 0.02)) == "fail"
    assert verdict([on, front], (-0.1, 0.02)) == "fail"
    assert verdict([on, behind, beside], (-0.1, 0.02)) == "not decided"  # at the boundary, where there is no side
    assert verdict([on, behind, beside], (-0.1, 0.06)) == "pass"


def test_clouds(tmp_path):
    names = sdm.read_face_names(plate(tmp_path))
    o2 = sdm.read(plate(tmp_path))
    options = dict(sign="side", tolerance=0.6, tolerance_table={"left": 0.1, "right": 0.1}, names=names)
    found = sdm.measure_points(cloud(tmp_path, 50), o2, tmp_path / "out.ply", island_points=10, **options)
    assert found.islands[1] == 50
    assert found.statistics().texels == 20000
    assert found.groups.verdict == "fail"
    left, right = found.groups.groups
    assert (left.verdict.verdict, right.verdict.verdict) == ("fail", "pass")
    assert left.points + right.points == 20000
    assert found.places.by_tolerance and {p.group for p in found.places.largest} == {"left"}
    assert found.places.largest[0].limits == (-0.1, 0.1)
    assert (found.groups.beyond_max_distance, found.groups.without_match) == (0, 0)
    options.update(max_distance=1, tolerance_table={"left": 0.6, "right": 0.6})
    found = sdm.measure_points(tmp_path / "cloud.xyz", o2, tmp_path / "out.ply", **options)
    assert [g.verdict.verdict for g in found.groups.groups] == ["pass", "pass"]
    assert (found.groups.verdict, found.groups.beyond_max_distance) == ("fail", 50)
    found = sdm.measure_points(tmp_path / "cloud.xyz", o2, tmp_path / "out.ply", sign="side", tolerance=0.1, names=names)
    assert found.islands is None and found.groups is None
    assert found.places.by_tolerance and found.places.count == 1 and found.places.small_count > 30
    assert found.places.largest[0].group == "left"
    with pytest.raises(sdm.Error, match="has the name 'lid'"):
        sdm.measure_points(tmp_path / "cloud.xyz", o2, tmp_path / "out.ply", tolerance_table={"lid": 1}, names=names)


@pytest.mark.parametrize("distance", [0.3, 0.8, 0.95, 1.05, 1.2, 3])
@pytest.mark.parametrize("uncertainty", [0, 0.02, 0.1, 0.25])
def test_verdicts_keep_the_uncertainty_from_the_limits(tmp_path, distance, uncertainty):
    # Two parallel squares: the distance is known.
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], float)
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    o1, o2 = (0.5 * corners, faces), (corners + [0, 0, distance], faces)
    expected = "pass" if distance < 1 - uncertainty else "fail" if distance > 1 + uncertainty else "not decided"
    rule = "ISO 14253-1" if uncertainty else "simple acceptance"
    m = sdm.map(o1, o2, resolution=16)
    verdict = m.check(1, uncertainty=uncertainty)
    assert (verdict.verdict, verdict.decision_rule) == (expected, rule)
    assert pickle.loads(pickle.dumps(verdict)).decision_rule == rule
    groups = m.check_groups({"all": 1}, sdm.FaceNames("group", ["all"], [0, 0]), uncertainty=uncertainty)
    assert groups.verdict == expected
    # The square is one place, of area 1, that is out for certain or may be.
    by_places = m.check(1, uncertainty=uncertainty, fail_area=0.9)
    assert by_places.verdict == expected
    assert m.check(1, uncertainty=uncertainty, fail_share=1).verdict == expected
    large = m.check(1, uncertainty=uncertainty, fail_area=1.1)
    assert large.verdict == "pass" and large.certified == (expected == "pass")
    if expected != "pass":
        assert large.by_places == pytest.approx((1.1, float(expected == "fail"), 1), rel=0.02)
        assert pickle.loads(pickle.dumps(large)).by_places == large.by_places
    with pytest.raises(sdm.Error, match="fail_area excludes fail_share"):
        m.check(1, fail_area=1, fail_share=0.1)
    report = m.report(tolerance=1, uncertainty=uncertainty)
    assert (report["tolerance"]["verdict"].lower(), report["tolerance"]["decision_rule"]) == (expected, rule)
    assert report["evidence"]["uncertainty"] == report["evidence"]["guard"] == uncertainty
    np.savetxt(tmp_path / "cloud.xyz", o1[0])
    cloud = sdm.measure_points(
        tmp_path / "cloud.xyz",
        o2,
        tmp_path / "out.ply",
        tolerance_table={"all": 1},
        names=sdm.FaceNames("group", ["all"], [0, 0]),
        uncertainty=uncertainty,
    )
    assert cloud.groups.verdict == expected


@pytest.mark.parametrize("uncertainty", [-0.1, float("nan"), float("inf")])
def test_an_uncertainty_is_a_number_of_at_least_0(uncertainty):
    m = sdm.map(meshes.sphere(), meshes.box(), resolution=16)
    with pytest.raises(sdm.Error, match="uncertainty"):
        m.check(1, uncertainty=uncertainty)
    with pytest.raises(sdm.Error, match="uncertainty"):
        m.report(tolerance=1, uncertainty=uncertainty)
