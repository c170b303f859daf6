#!/usr/bin/env python3
"""Makes the pictures of the front page, and of docs/baking.md: make_images.py MESHES, the folder of CGAL's data/meshes; with `sdm` and
`chromium-headless-shell` on the path, after a build of the tests, whose packages drive the browser."""

import contextlib
import functools
import http.server
import runpy
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

import numpy as np

import sdm

FOLDER = Path(__file__).resolve().parent
MESHES = Path(sys.argv[1]).absolute()
PACKAGES = FOLDER.parent.parent / "build" / "dev" / "dev_packages"


def placed(mesh: sdm.Mesh, scale: float, shift: tuple[float, float, float], turn: float = 0) -> sdm.Mesh:
    """The mesh on the ground, its middle over the origin, turned about the vertical axis and then shifted."""
    fit = sdm.fit_to_unit(mesh)
    matrix = np.diag([scale, scale, scale, 1.0]) @ fit
    mesh = mesh.transformed(matrix)
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    centre = np.eye(4)
    centre[:3, 3] = -(low + high) / 2
    centre[1, 3] = -low[1]
    c, s = np.cos(turn), np.sin(turn)
    rotation = np.array([[c, 0, s, shift[0]], [0, 1, 0, shift[1]], [-s, 0, c, shift[2]], [0, 0, 0, 1]])
    return mesh.transformed(rotation @ centre)


def bunny_and_armadillo() -> None:
    bunny = placed(sdm.read("/usr/share/glmark2/models/bunny.obj"), 1, (0, 0, 0))
    armadillo = placed(sdm.read(MESHES / "armadillo.off"), 1.35, (0.86, 0, 0), np.pi)
    there, back = (sdm.map(*pair, resolution=2048) for pair in ((bunny, armadillo), (armadillo, bunny)))
    there.save_view(FOLDER / "bunny-and-armadillo.png", (0.1, 0.1, 1), other=back, range=(0, 1), size=1440)


def python_card() -> None:
    """A sheet with a wave above a sphere."""
    line = np.linspace(-1.5, 1.5, 161)
    x, y = np.meshgrid(line, line, indexing="ij")
    z = 0.95 + 0.22 * np.sin(4 * x) * np.cos(3 * y)
    i, j = np.meshgrid(np.arange(160), np.arange(160), indexing="ij")
    a = (161 * i + j).ravel()
    faces = np.concatenate([np.stack([a, a + 161, a + 162], 1), np.stack([a, a + 162, a + 1], 1)])
    sheet = sdm.Mesh(np.stack([x.ravel(), z.ravel(), y.ravel()], 1), faces[:, ::-1])
    phi, theta = np.meshgrid(np.linspace(0, 2 * np.pi, 129), np.linspace(0, np.pi, 65), indexing="ij")
    ball = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)], -1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(128), np.arange(64), indexing="ij")
    a = (65 * i + j).ravel()
    round_faces = np.concatenate([np.stack([a, a + 65, a + 66], 1), np.stack([a, a + 66, a + 1], 1)])
    sdm.map(sheet, sdm.Mesh(0.72 * ball, round_faces)).save_view(FOLDER / "card-python.png", (0.6, 0.55, 1), size=640, legend=False)


def proximity_card() -> None:
    """Two rings, linked."""
    u, v = np.meshgrid(2 * np.pi * np.arange(192) / 192, 2 * np.pi * np.arange(96) / 96, indexing="ij")
    r = 1 + 0.22 * np.cos(v)
    vertices = np.stack([r * np.cos(u), r * np.sin(u), 0.22 * np.sin(v)], -1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(192), np.arange(96), indexing="ij")
    corner = lambda di, dj: ((i + di) % 192 * 96 + (j + dj) % 96).ravel()
    faces = np.concatenate([np.stack([corner(0, 0), corner(1, 0), corner(1, 1)], 1),
                            np.stack([corner(0, 0), corner(1, 1), corner(0, 1)], 1)])  # fmt: skip
    one = sdm.Mesh(vertices, faces)
    other = sdm.Mesh(vertices[:, [0, 2, 1]] * [1, 1, -1] + [0.75, 0, 0], faces)
    there, back = sdm.map(one, other), sdm.map(other, one)
    there.save_view(FOLDER / "card-proximity.png", (0.5, 0.6, 1), other=back, size=640, legend=False)


def inspection_card() -> None:
    """The part of the gallery."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        names = runpy.run_path(str(FOLDER.parent / "gallery/inspection.py"))
    names["distance_map"].save_view(
        FOLDER / "card-inspection.png", (1, 0.4, 0.3), tolerance=names["tolerance"], units="mm", up="z", size=640,
        legend=False)  # fmt: skip


def picture_of_page(address: str, picture: str, width: int = 1280, height: int = 800) -> None:
    """What a browser shows of a page."""
    subprocess.run(["node", FOLDER / "picture_of_page.cjs", address, FOLDER / picture, str(width), str(height)], cwd=PACKAGES, check=True)


@contextlib.contextmanager
def served(folder: str):
    """The address of a server of the files in a folder, for pages that look into others."""
    handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=folder)
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_address[1]}"
        server.shutdown()


# Shows what is in the canvas of a baked page, three times: the detailed mesh, the coarse one, and its triangles.
THREE_VIEWS = """<!doctype html>
<style>body { margin: 0; display: flex } iframe { border: 0; width: 440px; height: 340px }</style>
<iframe src="asset/report.html"></iframe><iframe src="asset/report.html"></iframe><iframe src="asset/report.html"></iframe>
<script>
  const show = (page, i) => {
    const style = page.createElement('style');
    style.textContent = `#view { position: fixed !important; inset: 0; z-index: 9; width: 440px !important; height: 340px !important;
      border: 0; border-radius: 0; background: white } #view > :not(canvas) { display: none }`;
    page.head.append(style);
    const split = page.getElementById('split');
    split.value = i === 0 ? 0 : 1000;
    split.dispatchEvent(new Event('input'));
    if (i === 2) page.getElementById('edges').click();
  };
  const whenReady = (frame, i) =>
    new Promise((resolve) => {
      const look = () => frame.contentDocument.documentElement.dataset.ready === undefined ? setTimeout(look, 50)
        : resolve(show(frame.contentDocument, i));
      look();
    });
  addEventListener('load', () => Promise.all([...document.querySelectorAll('iframe')].map(whenReady))
    .then(() => document.documentElement.dataset.ready = ''));
</script>
"""


def baked_asteroid() -> None:
    """The meshes of docs/baking.md."""
    models = "/usr/share/glmark2/models/asteroid"
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        subprocess.run(["sdm", "map", f"{models}-high.3ds", f"{models}-low.3ds", "-o", "painted", "--write", "glb"], check=True)
        subprocess.run(["sdm", "bake", "painted/model.glb", f"{models}-low.3ds", "-o", "asset"], check=True)
        Path("views.html").write_text(THREE_VIEWS)
        with served(folder) as address:
            picture_of_page(f"{address}/views.html", "baking.png", 1320, 340)


def painted_armadillo(file: str) -> None:
    """A mesh with colours at its vertices, as scanners write it: bands along the height, and patches."""
    mesh = sdm.read(MESHES / "armadillo.off")
    fit = sdm.fit_to_unit(mesh)
    at = mesh.transformed(fit).vertices
    bands = 0.5 + 0.5 * np.sin(26 * at[:, 1])
    patches = np.sin(9 * at[:, 0] + 2) * np.sin(9 * at[:, 1]) * np.sin(9 * at[:, 2] + 1) > 0
    clay, leaf, bone = np.array([176, 92, 58]), np.array([84, 120, 66]), np.array([226, 208, 170])
    colors = np.where(patches[:, None], clay, leaf) * (1 - 0.45 * bands[:, None]) + bone * 0.45 * bands[:, None]
    turned = mesh.vertices * [-1, 1, -1]  # its front to the viewer
    rows = [f"{x:.7g} {y:.7g} {z:.7g} {r} {g} {b}" for (x, y, z), (r, g, b) in zip(turned, colors.astype(int), strict=True)]
    faces = [f"3 {a} {b} {c}" for a, b, c in mesh.faces]
    Path(file).write_text("\n".join(
        ["ply", "format ascii 1.0", f"element vertex {len(rows)}", "property float x", "property float y", "property float z",
         "property uchar red", "property uchar green", "property uchar blue", f"element face {len(faces)}",
         "property list uchar int vertex_indices", "end_header", *rows, *faces, ""]))  # fmt: skip


def baked_page() -> None:
    """A scan, and what is made of it: the second example of README.md, with normals."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        painted_armadillo("scan.ply")
        subprocess.run(["sdm", "simplify", "scan.ply", "--max-deviation", "1.5", "--units", "mm", "-o", "low.glb"], check=True)
        subprocess.run(
            ["sdm", "bake", "scan.ply", "low.glb", "-o", "asset", "--channels", "base_color,normal", "--match", "ray", "--cage", "3",
             "--units", "mm", "--gutter", "4"], check=True)  # fmt: skip
        picture_of_page(Path("asset/report.html").absolute().as_uri(), "baked-page.png")


def report_page() -> None:
    """The report of docs/inspection.md, as a browser shows it."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        subprocess.run(["sdm", "scene", "scan", "--mesh", str(MESHES / "fandisk.off"), "-o", "made"], check=True)
        subprocess.run(
            ["sdm", "map", "made/scan.ply", "made/part.ply", "--align", "--tolerance", "0.01", "--units", "cm", "--up", "z",
             "--write", "html", "-o", "out"])  # fmt: skip
        picture_of_page(Path("out/report.html").absolute().as_uri(), "report.png")


bunny_and_armadillo()
report_page()
baked_page()
baked_asteroid()
inspection_card()
python_card()
proximity_card()
