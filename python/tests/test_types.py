"""The types that are declared: arrays have the dtype of the stub, words are those of the library, and mypy --strict is content."""

import re
import subprocess
import sys
import typing
from pathlib import Path

import numpy as np
import pytest

import meshes
import sdm
from sdm import _types

ROOT = Path(__file__).resolve().parents[2]
STUB = (Path(sdm.__file__).parent / "_core.pyi").read_text(encoding="utf-8")


def declared(name):
    """The dtypes of the array properties of a class of the stub, and whether they may be None."""
    body = re.search(rf"^class {name}[(:].*?(?=^\S|\Z)", STUB, re.MULTILINE | re.DOTALL)
    found = re.findall(r"def (\w+)\(self\) -> (?:numpy\.typing\.)?NDArray\[numpy\.(\w+)\]( \| None)?", body[0]) if body else []
    return {member: (np.dtype(kind.rstrip("_")), bool(none)) for member, kind, none in found}


def test_arrays_have_the_declared_dtype():
    box, sphere = meshes.box(), meshes.sphere()
    distance_map = sdm.map(sphere, box, resolution=32)
    sites, query = sdm.Sites(box), sdm.ProximityQuery(sphere, box, contact_margin=0.1)
    bodies = sdm.MultiBodyQuery([sdm.Shape(box, resolution=32), sphere])
    field = sdm.distance_field(box, spacing=0.5, sites=True)
    objects = [sdm.Mesh(*box), sites, sdm.Surface(box, resolution=32), sites.closest_points([[0, 0, 3]], gradients=True),
               sites.first_hits([[0.5, 0.5, 3]], [[0, 0, -1]]), query.contacts(), query.separating_translation(), field,
               field.sample([[0.5, 0.5, 0.5]]), bodies.separations(), bodies.penetration_depths(), bodies.separating_translations(),
               bodies.nearest_map(0),
               sdm.align(sphere, sphere), sdm.time_of_contact(box, None, box, None, tolerance=1e-3),
               sdm.FaceNames("group", ["a"], np.zeros(12, np.uint32))]  # fmt: skip
    count = 0
    for value, name in [*((v, type(v).__name__) for v in objects), (distance_map, "MapChannels")]:
        for member, (dtype, may_be_none) in declared(name).items():
            array = getattr(value, member)
            if callable(array):
                array = array()
            assert (array is None and may_be_none) or array.dtype == dtype, f"{name}.{member}"
            count += 1
    assert count > 50
    assert sites.contains([[0, 0, 3]]).dtype == bool and sites.signed_distance([[0, 0, 3]]).dtype == float
    assert distance_map.at_vertices().dtype == np.float32


@pytest.mark.parametrize("name, call", [
    ("Sign", lambda word: sdm.Sites(meshes.box()).closest_points([[0, 0, 3]], sign=word)),
    ("Engine", lambda word: sdm.map(meshes.box(), meshes.box(), resolution=32, engine=word)),
])  # fmt: skip
def test_words_are_those_of_the_library(name, call):
    with pytest.raises(sdm.Error) as fault:
        call("nothing")
    words = typing.get_args(getattr(_types, name))
    for word in words:
        assert re.search(rf"\b{word}\b", str(fault.value)) or name == "Engine" and word not in sdm.engines(), word
    declared_words = ", ".join(f"'{word}'" for word in words)
    assert f"Literal[{declared_words}]" in STUB


def test_results_have_declared_words():
    distance_map = sdm.map(meshes.sphere(), meshes.box(), resolution=32)
    for tolerance in (0.01, 100):
        assert distance_map.check(tolerance).verdict in typing.get_args(_types.Verdict)
    assert distance_map.hausdorff().certainty in typing.get_args(_types.Certainty)


USER = """
import numpy as np
import numpy.typing as npt
import sdm

box = sdm.Mesh(np.zeros((3, 3)), np.array([[0, 1, 2]]))
distance_map = sdm.map(box, box, resolution=64, sign="none")
distances: npt.NDArray[np.float32] = distance_map.distance
closest = sdm.Sites(box).closest_points([[0.0, 0.0, 1.0]], sign="automatic")
exact: npt.NDArray[np.float64] = closest.distance
faces: npt.NDArray[np.uint32] = closest.face
batch = sdm.closest_points_batch([box], [[[0, 0, 1]]])
offsets: npt.NDArray[np.int64] = batch.offsets
baked = sdm.bake(box, box, channels=["position", "face"], samples=4)
positions: npt.NDArray[np.float32] = baked["position"]
ids: npt.NDArray[np.uint32] = baked["face"]
shares: npt.NDArray[np.float32] = baked.coverage
print(distance_map.check(1).verdict == "pass", sdm.hausdorff(box, box).value, distances, exact, faces, offsets)
print(sdm.surface_metrics(box, box)["assd"].value, distance_map.report()["sign"])
distance_map.save("x.png", colormap="viridis")
"""


def test_mypy_is_content(tmp_path):
    (tmp_path / "user.py").write_text(USER)
    environment = {"MYPYPATH": str(Path(sdm.__file__).parents[1]), "PATH": "/usr/bin:/bin"}
    command = [sys.executable, "-m", "mypy", "--config-file", ROOT / "pyproject.toml", "--strict"]
    for rest in (["-p", "sdm"], [tmp_path / "user.py"]):
        result = subprocess.run([*command, *rest], capture_output=True, text=True, cwd=tmp_path, env=environment)
        assert result.returncode == 0, result.stdout + result.stderr
    (tmp_path / "user.py").write_text("import sdm\nsdm.map('a.obj', 'b.obj', sign='inside')\n")
    result = subprocess.run([*command, tmp_path / "user.py"], capture_output=True, text=True, cwd=tmp_path, env=environment)
    assert "arg-type" in result.stdout
