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
