"""The meshes of bench/simplify: ten known ones of CGAL's data, as Debian packages them, and twenty made from a seed:
CAD-like solids, organic shapes, scans with noise and terrains, five of each."""

import tarfile

import igl
import manifold3d
import numpy as np

CGAL = "/usr/share/doc/libcgal-dev/data.tar.gz"
KNOWN = ("fandisk", "anchor_dense", "blade", "knot1", "femur", "retinal", "armadillo", "elephant", "rotor")
SEED = 59


def known(name: str):
    with tarfile.open(CGAL) as archive:
        member = archive.extractfile(f"data/meshes/{name}.off")
        assert member is not None
        words = member.read().split()
    vertices, faces = int(words[1]), int(words[2])
    points = np.array(words[4 : 4 + 3 * vertices], float).reshape(-1, 3)
    rows = np.array(words[4 + 3 * vertices : 4 + 3 * vertices + 4 * faces], int).reshape(-1, 4)
    assert (rows[:, 0] == 3).all()
    return points, rows[:, 1:]


def grid(rows: int, columns: int):
    """Triangles of a grid of points, row by row."""
    a = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    return np.concatenate([np.c_[a, a + 1, a + columns + 1], np.c_[a, a + columns + 1, a + columns]])


def uv_sphere():
    rings, sectors = 80, 160
    around, down = np.meshgrid(np.linspace(0, 2 * np.pi, sectors + 1), np.linspace(0, np.pi, rings + 1))
    points = np.stack([np.sin(down) * np.cos(around), np.sin(down) * np.sin(around), np.cos(down)], -1).reshape(-1, 3)
    return welded(points, grid(rings + 1, sectors + 1)[:, ::-1])


def welded(points, faces):
    _, first, number = np.unique(points.round(9), axis=0, return_index=True, return_inverse=True)
    faces = number.ravel()[faces]
    whole = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    return points[first], faces[whole]


def cad(random):
    """A plate with bosses, holes and pockets; its faces are divided as those of a fine tessellation are."""
    solid = manifold3d.Manifold.cube([10, 8, 2], True)
    for _ in range(12):
        at = [random.uniform(-4, 4), random.uniform(-3, 3), 0]
        radius, segments = random.uniform(0.3, 1.1), int(random.integers(24, 72))
        tool = manifold3d.Manifold.cylinder(random.uniform(1, 4), radius, radius * random.uniform(0.6, 1), segments, True)
        if random.random() < 0.3:
            tool = manifold3d.Manifold.cube([2 * radius, 3 * radius, 1.5], True).rotate([0, 0, random.uniform(0, 90)])
        if random.random() < 0.2:
            tool = manifold3d.Manifold.sphere(radius, segments)
        tool = tool.translate(at[:2] + [random.choice([-1, 1])])
        solid = solid + tool if random.random() < 0.5 else solid - tool
    solid = solid.refine_to_length(random.uniform(0.25, 0.4))
    mesh = solid.to_mesh()
    return welded(np.asarray(mesh.vert_properties, float)[:, :3], np.asarray(mesh.tri_verts, int))


def organic(random, steps: int = 56):
    """The surface of a sum of blobs along a branching walk."""
    centres, at = [], np.zeros(3)
    for _ in range(14):
        at = (centres[random.integers(len(centres))] if centres and random.random() < 0.3 else at) + random.normal(0, 0.5, 3)
        centres.append(at)
    centres = np.array(centres)
    radii = random.uniform(0.25, 0.5, len(centres))
    low, high = centres.min(0) - 1.3, centres.max(0) + 1.3
    size = np.maximum(16, (steps * (high - low) / (high - low).max()).astype(int))
    axes = [np.linspace(low[k], high[k], size[k]) for k in range(3)]
    z, y, x = np.meshgrid(axes[2], axes[1], axes[0], indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), z.ravel()], -1)
    value = sum(np.exp(-((points - c) ** 2).sum(1) / r**2) for c, r in zip(centres, radii))
    vertices, faces, *_ = igl.marching_cubes(0.35 - value, points, *(int(n) for n in size), 0.0)
    return welded(vertices, faces)


def scan(random):
    """A part of a bumpy sphere, as a range image would have it, with the noise of one."""
    rows, columns = (int(n) for n in random.integers(70, 110, 2))
    v, u = np.meshgrid(np.linspace(-1.1, 1.1, columns), np.linspace(-1.2, 1.2, rows))
    radius = np.ones_like(u)
    for _ in range(8):
        a, b = random.uniform(-6, 6, 2)
        radius += random.uniform(0.01, 0.06) * np.sin(a * u + b * v + random.uniform(0, 6))
    radius += random.normal(0, 10 ** random.uniform(-4, -2.7), u.shape)
    points = radius[..., None] * np.stack([np.cos(u) * np.cos(v), np.cos(u) * np.sin(v), np.sin(u)], -1)
    return points.reshape(-1, 3), grid(rows, columns)


def terrain(random):
    """A height field of fractal noise."""
    rows, columns = (int(n) for n in random.integers(70, 120, 2))
    frequency = np.hypot(np.fft.fftfreq(rows)[:, None], np.fft.fftfreq(columns)[None, :])
    frequency[0, 0] = 1
    spectrum = random.normal(size=(rows, columns)) + 1j * random.normal(size=(rows, columns))
    height = np.real(np.fft.ifft2(spectrum / frequency ** random.uniform(1.8, 2.8)))
    height *= random.uniform(4, 14) / np.abs(height).max()
    y, x = np.mgrid[0:rows, 0:columns]
    return np.stack([x, y, height], -1).reshape(-1, 3).astype(float), grid(rows, columns)


MADE = {"cad": cad, "organic": organic, "scan": scan, "terrain": terrain}
NAMES = [*KNOWN, "uv_sphere", *(f"{kind}{i}" for kind in MADE for i in range(5))]


def mesh(name: str):
    """Vertices and triangles of one of NAMES."""
    if name in KNOWN:
        return known(name)
    if name == "uv_sphere":
        return uv_sphere()
    kind, number = name[:-1], int(name[-1])
    return MADE[kind](np.random.default_rng([SEED, list(MADE).index(kind), number]))
