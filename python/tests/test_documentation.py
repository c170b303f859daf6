"""Docstrings: every public name has one, and their examples run. The code of docs/python.md runs, too."""

import doctest
import inspect
import os
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import meshes
import sdm

ROOT = Path(__file__).resolve().parents[2]
MESHES = Path("/usr/share/glmark2/models")


def public_objects():
    yield "sdm", sdm
    for name in sdm.__all__:
        if name == "NONE":
            continue
        value = getattr(sdm, name)
        yield f"sdm.{name}", value
        if inspect.isclass(value) and not issubclass(value, (Exception, int)):
            for member in dir(value):
                if not member.startswith("_"):
                    yield f"sdm.{name}.{member}", getattr(value, member)


# Fields whose names say it all.
PLAIN = re.compile(r"sdm\.(DistanceStatistics|BoundedLength|SiteType)\.\w+|sdm.MapBounds\.\w+")


@pytest.mark.parametrize("name", [name for name, _ in public_objects()])
def test_docstrings(name):
    value = dict(public_objects())[name]
    text = inspect.getdoc(value)
    assert PLAIN.fullmatch(name) or text, f"{name} has no docstring"
    names = {"sdm": sdm, "np": np, "box": sdm.Mesh(meshes.box()), "sphere": sdm.Mesh(meshes.sphere())}
    test = doctest.DocTestParser().get_doctest(text or "", names, name, None, 0)
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.IGNORE_EXCEPTION_DETAIL)
    assert runner.run(test).failed == 0, name


def blocks(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    return re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


def test_page(tmp_path, monkeypatch):
    """The blocks of the page, one after the other, in a folder with the meshes that they name."""
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    for name in ("bunny.obj", "horse.3ds"):
        shutil.copy(MESHES / name, tmp_path)
    monkeypatch.chdir(tmp_path)
    page = "docs/python.md"
    found = blocks(page)
    assert found
    names = {}
    for block in found:
        if "import torch" in block and not has_torch():
            continue
        exec(compile(block, page, "exec"), names)
    assert (tmp_path / "distance.png").stat().st_size > 10_000


def test_matching_page(tmp_path, monkeypatch):
    shutil.copy(MESHES / "bunny.obj", tmp_path)
    monkeypatch.chdir(tmp_path)
    names = {}
    for block in blocks("docs/matching.md"):
        exec(compile(block, "docs/matching.md", "exec"), names)
    assert names["displacements"].shape == (256, 256) and np.nanmin(names["displacements"]) < 0


def test_robotics_page():
    names = {}
    for block in blocks("docs/robotics.md"):
        exec(compile(block, "docs/robotics.md", "exec"), names)
    assert names["hits"]


@pytest.mark.skipif("SDM_COMMAND" not in os.environ, reason="the command is not built")
def test_the_picture_is_that_of_the_command(tmp_path):
    """The first program of docs/python.md and ./demo draw the same picture."""
    bunny, horse = MESHES / "bunny.obj", MESHES / "horse.3ds"
    options = ["--transform-o1", "fit", "--transform-o2", "fit,translate:0.8:0:0", "--write", "png", "--quiet"]
    subprocess.run([os.environ["SDM_COMMAND"], "map", bunny, horse, "-o", tmp_path / "out", *options], check=True)
    beside = sdm.fit_to_unit(horse)
    beside[0, 3] += 0.8
    distance_map = sdm.map(bunny, sdm.read(horse).transformed(beside), transform=sdm.fit_to_unit(bunny))
    distance_map.save(tmp_path / "distance.png")
    assert (tmp_path / "distance.png").read_bytes() == (tmp_path / "out" / "atlas_distance.png").read_bytes()


def has_torch():
    try:
        import torch  # noqa: F401
    except ImportError:
        return False
    return True


def test_types_are_shipped():
    folder = Path(sdm.__file__).parent
    assert (folder / "py.typed").exists()
    stub = (folder / "_core.pyi").read_text(encoding="utf-8")
    compile(stub, "_core.pyi", "exec")
    for name, value in vars(sdm._core).items():
        if not name.startswith("_"):
            declared = "class {}" if inspect.isclass(value) else "def {}(" if callable(value) else "{}:"
            assert declared.format(name) in stub, f"{name} is not in the stub"


def test_version():
    assert sdm.__version__ == (ROOT / "VERSION").read_text().strip()
