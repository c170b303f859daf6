"""The programs of python/examples."""

import importlib.util
from pathlib import Path

import numpy as np

import meshes
import sdm

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"


def load(name):
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_fit_to_scan(tmp_path):
    vertices, faces = meshes.sphere(steps=4)
    lumpy = vertices * (1 + 0.3 * vertices[:, :1]) * [1, 1.3, 1.7] + 5
    noise = np.random.default_rng(0).normal(0, 0.003, lumpy.shape)
    scan = sdm.Mesh(lumpy + noise, np.delete(faces, np.s_[:20], axis=0))  # with a hole
    example = load("fit_to_scan")
    lines = []
    fitted = example.fit(scan, levels=4, steps=10, samples=4000, log=lines.append)
    assert len(lines) == 3 and len(fitted[1]) == 8 * 4**4
    sites = sdm.Sites(fitted)
    assert sites.closed and sites.orientable
    # Both ways, without the noise and the hole: the mesh is as close to the surface as its triangles allow.
    truth = sdm.Sites(lumpy, faces)
    assert np.sqrt(np.mean(sites.closest_points(lumpy).distance ** 2)) < 0.03
    assert np.sqrt(np.mean(truth.closest_points(fitted[0]).distance ** 2)) < 0.03

    sdm.map(scan, scan, resolution=64).save(tmp_path / "scan.ply")
    example.fit, fit = lambda mesh: fit(mesh, levels=3, steps=4, samples=500, log=lines.append), example.fit
    example.main(str(tmp_path / "scan.ply"), str(tmp_path / "fitted.ply"))
    assert len(sdm.read(tmp_path / "fitted.ply").faces) == 8 * 4**3


def test_nut_on_bolt():
    lines = []
    advances = load("nut_on_bolt").main(turns=1, log=lines.append)
    np.testing.assert_allclose(advances, 1, atol=4e-4)  # of the pitch
    assert len(lines) == 1


def test_pile():
    example = load("pile")
    sites = sdm.Sites(*example.ring())
    assert sites.closed and sites.contains([[0.5, 0, 0]]).all() and not sites.contains([[0, 0, 0]]).any()
    lines = []
    energy, deepest = example.main(rings=30, log=lines.append)
    assert energy < 1e-3 and deepest < example.TUBE / 6, lines


def test_textured_asset(tmp_path):
    example = load("textured_asset")
    coarse, deviation, baked = example.main(tmp_path / "asset.glb", triangles=1500, resolution=256)
    vertices, faces, colors = example.shape()
    sites = sdm.Sites(vertices, faces)
    assert sites.closed and sites.orientable and len(faces) == 96_000
    assert len(coarse.faces) <= 1500 and 0 < deviation.upper < 0.1
    assert baked.matched.any() and "base_color" in baked.channels
    # The model has the colour of the shape at the middle of its faces.
    corners = coarse.vertices[coarse.faces].mean(axis=1)
    uv = baked.corner_uvs.mean(axis=1) * 256
    texels = baked.image("base_color")[255 - uv[:, 1].astype(int), uv[:, 0].astype(int)]
    found = sites.closest_points(corners)
    expected = (found.barycentric[:, :, None] * colors[faces[found.face]]).sum(axis=1)
    error = np.abs(texels - expected)
    assert np.mean(error[:, 1] < 12) > 0.98 and error[:, 0].mean() < 35  # the grooves are a few texels wide
    assert (texels[:, 2] == 76).all()
    model = sdm.bake(tmp_path / "asset.glb", coarse, resolution=64)  # which is read again
    assert model.image("base_color").std() > 20
