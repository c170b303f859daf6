"""One pair, run once: stdout, report.json, the page, the picture and Python agree on every number, verdict and colour."""

import json
import math
import os
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

import sdm

pytestmark = pytest.mark.skipif(
    "SDM_REPORT_PACKAGES" not in os.environ or "SDM_COMMAND" not in os.environ,
    reason="needs the command, and the browser of the tests of the page",
)
RESOLUTION = 256
BUMP = 0.03
CHECK_PAGE = Path(__file__).resolve().parents[2] / "tests" / "report" / "check_page.cjs"


def plain(text):
    """Without the typography of the page."""
    return text.translate({0x2212: "-", 0xA0: " ", 0x202F: " "})


def write_box(file, bump):
    """A box of 2 × 2 × 1, each side n × n squares, with waves, and the upper one with a bump; its groups are `top` and `sides`."""
    n = 12
    u, v = (x.ravel() for x in np.meshgrid(np.linspace(-1, 1, n + 1), np.linspace(-1, 1, n + 1)))
    first = [(i, j) for j in range(n) for i in range(n)]
    squares = [(j * (n + 1) + i, j * (n + 1) + i + 1, (j + 1) * (n + 1) + i + 1, (j + 1) * (n + 1) + i) for i, j in first]
    lines, count = [], 0
    for axis in range(3):
        for side in (-1, 1):
            points = np.insert(np.column_stack([u, v] if side * (-1) ** axis > 0 else [v, u]), axis, side, axis=1)
            points[:, 2] *= 0.5
            points[:, axis] += 0.2 * bump * np.sin(5 * u) * np.cos(4 * v) * (1 - u**2) * (1 - v**2)
            top = axis == 2 and side == 1
            if top:
                points[:, 2] += bump * np.maximum(0, 1 - 9 * ((points[:, 0] - 0.3) ** 2 + points[:, 1] ** 2)) ** 2
            lines += [f"v {float(x)!r} {float(y)!r} {float(z)!r}" for x, y, z in points]
            lines.append("g top" if top else "g sides")
            for a, b, c, d in squares:
                lines += [f"f {a + count + 1} {b + count + 1} {c + count + 1}", f"f {a + count + 1} {c + count + 1} {d + count + 1}"]
            count += len(points)
    file.write_text("\n".join(lines) + "\n")
    return 2 * n * n  # faces a side, those of the top last


def placement():
    """Turns by a degree or so, and moves."""
    c, s = np.cos(0.02), np.sin(0.02)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    return np.block([[turn, np.array([[0.02], [0.01], [-0.01]])], [np.zeros((1, 3)), np.ones((1, 1))]])


class Told:
    """What each of the five says."""

    def __init__(self, folder, tolerance, expected):
        self.expected = expected
        o1, o2, table, self.out = folder / "o1.obj", folder / "o2.obj", folder / "table.csv", folder / "out"
        self.tolerance = tolerance
        self.faces_a_side = write_box(o1, BUMP)
        write_box(o2, 0)
        np.savetxt(folder / "placement.txt", placement(), fmt="%.17g")
        self.table, self.names = table, sdm.read_face_names(o1)
        table.write_text("group,lower,upper\ntop,-0.02,0.02\nsides,-0.02,0.02\n")
        command = [os.environ["SDM_COMMAND"], "map", o1, o2, "-o", self.out, "--resolution", str(RESOLUTION), "--align",
                   "--transform-o1", f"matrix:{folder / 'placement.txt'}",
                   f"--tolerance={tolerance[0]}:{tolerance[1]}", "--tolerance-table", table, "--units", "mm"]  # fmt: skip
        run = subprocess.run(command, capture_output=True, text=True)
        self.code, self.stdout = run.returncode, run.stdout
        assert self.code in (0, 3, 4, 5), run.stderr
        self.json = json.loads((self.out / "report.json").read_text())
        page = (self.out / "report.html").read_text(encoding="utf-8")
        self.in_page = json.loads(re.search('id="report">(.*?)</script>', page, re.DOTALL)[1])
        subprocess.run(["node", CHECK_PAGE, "tells", self.out / "report.html", folder / "told.json"],
                       cwd=os.environ["SDM_REPORT_PACKAGES"], check=True)  # fmt: skip
        self.page = json.loads((folder / "told.json").read_text())
        steps = np.array(self.json["alignment"]["matrix"])
        self.placed, self.o2 = sdm.read(o1).transformed(placement()), sdm.read(o2)
        self.map = sdm.map(self.placed, self.o2, transform=steps, resolution=RESOLUTION)
        self.python = json.loads(json.dumps(self.map.report(tolerance=tolerance, units="mm")))


VERDICTS = {"within": "PASS", "exceeded": "FAIL", "one side": "FAIL", "open": "NOT DECIDED"}


@pytest.fixture(scope="module", params=VERDICTS)
def told(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("house")
    tolerances = {"within": (-0.1, 0.1), "exceeded": (-0.025, 0.025), "one side": (-0.05, 0.01)}
    if request.param != "open":
        return Told(folder, tolerances[request.param], VERDICTS[request.param])
    # By less than the accuracy.
    write_box(folder / "o1.obj", BUMP), write_box(folder / "o2.obj", 0)
    o1, o2 = sdm.read(folder / "o1.obj").transformed(placement()), sdm.read(folder / "o2.obj")
    found = sdm.map(o1, o2, transform=sdm.align(o1, o2).transform, resolution=64)
    return Told(folder, (-0.1, round(float(found.at_vertices().max()) - 1e-7, 9)), VERDICTS["open"])


def limits_text(lower, upper, digits=5):
    if lower == -upper:
        return f"±{rounded(upper, digits):g} mm"
    return f"{rounded(lower, digits):g} to {rounded(upper, digits):g} mm"


def rounded(value, digits):
    return float(f"{value:.{digits}g}")


def stated(told, value):
    """A distance with the decimals of the page: one more than the error bound leaves certain, of 3 to 5 digits; with three
    digits where these decimals would round it to zero."""
    largest = max(abs(told.json["extremes"][end]["distance"]) for end in ("min", "max"))
    first = math.floor(math.log10(largest))
    decimals = 1 - math.floor(math.log10(told.json["error_bound"]))
    return float(f"{value:.{max(0, min(max(decimals, 2 - first), 4 - first))}f}") or rounded(value, 3)


def first_number(text):
    return float(re.search(r"[-+]?\d[\d.]*(e-?\d+)?", plain(text))[0])


def test_verdicts(told):
    json_verdicts = [told.json["tolerance"]["verdict"], told.json["group_tolerances"]["verdict"]]
    assert json_verdicts == [told.expected, "FAIL"]
    worst = max(json_verdicts, key=["PASS", "DOUBTFUL", "NOT DECIDED", "FAIL"].index)
    assert told.code == {"PASS": 0, "FAIL": 3, "NOT DECIDED": 4, "DOUBTFUL": 5}[worst]
    assert f"  tolerance {json_verdicts[0]}: " in told.stdout and f"  groups    {json_verdicts[1]}\n" in told.stdout
    assert told.page["verdict"].split(maxsplit=1)[1] == worst
    assert plain(told.page["what-if"]).startswith(f"With {limits_text(*told.tolerance)}: {json_verdicts[0]}. ")
    assert told.map.check(told.tolerance).verdict.upper() == json_verdicts[0]
    assert told.python["tolerance"] == told.json["tolerance"]
    outside = 100 * told.json["tolerance"]["exceeded_area_fraction"]
    what_if = plain(told.page["what-if"])
    if json_verdicts[0] == "FAIL":
        assert first_number(what_if.split("About")[1]) == pytest.approx(outside, abs=0.005)
    else:
        assert outside == 0 and what_if.endswith(". No sample is out of it.")


def test_groups(told):
    lines = told.stdout[told.stdout.index("  groups ") :].splitlines()[1:]
    group_of_face = np.arange(6 * told.faces_a_side) // told.faces_a_side == 5
    at_vertices, accuracy = told.map.at_vertices(), told.json["accuracy"]
    for group, line, row in zip(told.json["group_tolerances"]["groups"], lines, told.page["groups"], strict=False):
        name, verdict, kind, limits, least, most, outside, proof = map(plain, row)
        assert (name, kind, verdict) == (group["group"], group["kind"], group["verdict"])
        assert (limits, proof) == ("±0.02 mm", "proven") and group["certified"]
        measured = [group["lowest"], group["highest"]]
        shown = [0 if abs(x) <= accuracy else stated(told, x) for x in measured]
        assert [first_number(least), first_number(most)] == shown
        share = 100 * group["exceeded_area_fraction"]
        assert first_number(outside) == pytest.approx(share, rel=5e-3)
        words = f"            {name} ({kind}): {verdict}, ±0.02 mm, measured {measured[0]:.5g} to {measured[1]:.5g} mm"
        assert line == words + (f", {share:.5g} % of its area is out" if verdict == "FAIL" else "")
        # Python has no verdicts on groups, but their numbers.
        mine = group_of_face if name == "top" else ~group_of_face
        vertices = np.unique(told.map.surface.faces[mine])
        values = np.concatenate([told.map.distance[told.map.valid & mine[np.minimum(told.map.face, len(mine) - 1)]], at_vertices[vertices]])
        assert np.float32(measured) == pytest.approx(np.float32([values.min(), values.max()]), abs=0)


def test_numbers(told):
    assert told.in_page == told.json
    d, extremes, units = told.json["distance"], told.json["extremes"], told.json["units"]
    line = "min {:.5g}   mean {:.5g}   max {:.5g} {}".format(extremes["min"]["distance"], d["mean"], extremes["max"]["distance"], units)
    assert f"  distance  {line}\n" in told.stdout
    assert "mean |d| {:.5g}   rms {:.5g}   σ {:.5g} {}\n".format(d["mean_abs"], d["rms"], d["stddev"], units) in told.stdout
    assert "|d| up to {:.5g}, 99 % up to {:.5g} {}\n".format(d["p95_abs"], d["p99_abs"], units) in told.stdout
    assert "at most {:.5g} {} between".format(told.json["error_bound"], units) in told.stdout
    assert f"  aligned   {told.json['alignment']['text']}\n" in told.stdout
    rows = {label: value for label, value, _ in told.page["numbers"]}
    for label, value in [("Mean", d["mean"]), ("Mean of the absolute distance", d["mean_abs"]), ("Root mean square", d["rms"]),
                         ("Standard deviation", d["stddev"]), ("Median", d["p50"]), ("95 % of the area is closer than", d["p95_abs"]),
                         ("99 % of the area is closer than", d["p99_abs"]), ("Largest (most outside)", extremes["max"]["distance"]),
                         ("Smallest (most inside)", extremes["min"]["distance"])]:  # fmt: skip
        expected = 0 if "(" in label and abs(value) <= told.json["accuracy"] else stated(told, value)
        assert first_number(rows[label]) == expected and rows[label].endswith("\u00a0mm"), label
    assert int(plain(rows["Measured points"]).replace(" ", "")) == told.json["texels_with_value"] == told.map.statistics().texels
    alignment = told.json["alignment"]
    stated_alignment = plain(told.page["inputs-table"]).split("Alignment: ")[1]
    assert stated_alignment.startswith(alignment["text"].split(";")[0].replace("O1", "the part"))
    sizes = [alignment[when][key] for key in ("trimmed_rms", "rms") for when in ("before", "after")]
    shown = re.search(r"from (\S+) to (\S+) mm for the samples that fit, and from (\S+) to (\S+) mm for all", stated_alignment)
    assert [first_number(x) for x in shown.groups()] == [rounded(x, 3) for x in sizes]
    largest = max(extremes["max"]["distance"], -extremes["min"]["distance"])
    assert abs(first_number(told.page["worst"][0][1])) == stated(told, largest)
    told.json["colors"].pop("by_group", None)  # of a table of tolerances, which report() has not
    for key, value in told.python.items():
        if key not in ("o1", "o2", "time_ms", "groups", "places"):
            assert value == told.json[key], key
    assert set(told.json) - set(told.python) == {"alignment", "group_tolerances"}


def test_places(told):
    places, in_command = told.map.places(told.tolerance, names=told.names, tolerance_table=told.table), told.json["places"]
    assert (places.count, places.fraction) == (in_command["large"]["count"], in_command["large"]["area_fraction"])
    assert places.by_tolerance == (in_command["limits_from"] == "tolerance")
    assert len(places.largest) == len(in_command["largest"])
    for place, expected in zip(places.largest, in_command["largest"]):
        assert (place.distance, place.area, place.group) == (expected["distance"], expected["area"], expected["group"] or "")
        np.testing.assert_array_equal(place.point, expected["point"])


def test_alignment(told):
    np.testing.assert_array_equal(sdm.align(told.placed, told.o2).transform, told.json["alignment"]["matrix"])


def test_colours(told):
    import matplotlib.image

    scale, colors = told.page["scale"], told.json["colors"]
    assert (scale["mode"], [scale["lo"], scale["hi"]]) == (colors["map"], colors["range"])
    assert (scale["lower"], scale["upper"]) == told.tolerance
    legend = " ".join(plain(told.page["legend"]).split())
    assert legend.startswith("distance in mm"), "the limits of the table are those of all faces, so that it has numbers"
    there = told.page["map"]
    distance = np.array(there["distance"], float).reshape(there["height"], there["width"])
    np.testing.assert_array_equal(distance.astype(np.float32), told.map.distance)
    shown = np.array([c or (0, 0, 0) for c in there["colors"]]).reshape(*distance.shape, 3)
    owned = np.array([c is not None for c in there["colors"]]).reshape(distance.shape)
    # The picture of the command has the bands of each group; that of Python, which has no table, has one scale.
    told.map.save(told.out / "python.png", tolerance=told.tolerance, units="mm")
    picture = np.rint(255 * matplotlib.image.imread(told.out / "python.png")).astype(int)[: distance.shape[0], : distance.shape[1], :3]
    np.testing.assert_array_equal(owned, told.map.valid)
    assert np.abs(picture[owned] - shown[owned]).max() <= 1, "but for rounding to whole numbers"
    assert len(np.unique(picture[owned], axis=0)) > (1 if told.tolerance[1] < BUMP else 0)
