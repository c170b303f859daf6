"""Meshes of the tests: arrays (vertices, faces)."""

import itertools

import numpy as np


def box(low=(0, 0, 0), high=(1, 1, 1)):
    """A closed box of 12 faces that face outwards."""
    low, high = np.asarray(low, float), np.asarray(high, float)
    corners = np.array(list(itertools.product((0, 1), repeat=3)), float)
    faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
             [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]  # fmt: skip
    return low + corners * (high - low), np.array(faces)


def sphere(center=(0, 0, 0), radius=1.0, steps=2):
    """An octahedron, each face divided into four `steps` times, projected onto a sphere."""
    vertices = [v for axis in np.eye(3) for v in (axis, -axis)]
    faces = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    for _ in range(steps):
        middles = {}

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                m = vertices[a] + vertices[b]
                middles[key] = len(vertices)
                vertices.append(m / np.linalg.norm(m))
            return middles[key]

        divided = []
        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            divided += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        faces = divided
    return np.asarray(center) + radius * np.array(vertices), np.array(faces)


def soup(seed, faces=40):
    """Triangles in all directions that intersect each other."""
    random = np.random.default_rng(seed)
    centers = random.uniform(-1, 1, (faces, 1, 3))
    vertices = (centers + random.normal(0, 0.3, (faces, 3, 3))).reshape(-1, 3)
    return vertices, np.arange(3 * faces).reshape(-1, 3)
