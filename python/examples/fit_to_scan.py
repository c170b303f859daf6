#!/usr/bin/env python3
"""Fits a closed mesh to a scan of a closed surface, by the derivatives of the distances between them.

usage: fit_to_scan.py SCAN OUTPUT.ply [PICTURE.png]

The scan may be noisy, and may have holes. A sphere around it follows the derivatives of

    Σ d(p, mesh)² over points p of the scan  +  Σ d(v, scan)² over the vertices v of the mesh,

with steps that are smoothed over the mesh, first with few triangles, then with more. OUTPUT has the distance of each
vertex to the scan: it is large where the mesh spans a narrow gap, as between two ears, from which it is not pulled away.
"""

import sys

import numpy as np

import sdm


def octahedron():
    faces = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    return np.array([v for axis in np.eye(3) for v in (axis, -axis)]), np.array(faces)


def divided(vertices, faces):
    """Divides each face into four."""
    edges = sdm.Sites(vertices, faces).edges
    keys = edges[:, 0].astype(np.int64) * len(vertices) + edges[:, 1]

    def middle(a, b):
        return len(vertices) + np.searchsorted(keys, np.minimum(a, b) * len(vertices) + np.maximum(a, b))

    a, b, c = faces.T
    ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
    corners = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return np.vstack([vertices, vertices[edges].mean(axis=1)]), np.vstack([np.stack(t, axis=1) for t in corners])


def smoothed(values, edges, rounds):
    """Repeatedly replaces the values of vertices by the means of them and their neighbours."""
    degree = 1 + np.bincount(edges.ravel(), minlength=len(values))
    for _ in range(rounds):
        total = values.copy()
        for axis in range(values.shape[1]):
            for here, there in (edges.T, edges.T[::-1]):
                total[:, axis] += np.bincount(here, values[there, axis], minlength=len(values))
        values = total / degree[:, None]
    return values


def step(vertices, faces, scan, points, rounds):
    """A Gauss-Newton step with a diagonal matrix, smoothed. Returns the vertices, and the rms distances before it."""
    from_scan = sdm.closest_points(vertices, faces, points, gradients=True)
    from_mesh = scan.closest_points(vertices, gradients=True)
    # A vertex moves along −Σ d ∂d, divided by Σ |∂d|²: ∂d are the derivatives of distances by its position.
    corners, derivatives = from_scan.vertex_gradients()
    move = -from_mesh.distance[:, None] * from_mesh.gradient
    weight = np.ones(len(vertices))
    np.add.at(move, corners, -from_scan.distance[:, None, None] * derivatives)
    np.add.at(weight, corners, from_scan.barycentric**2)
    change = smoothed(np.column_stack([move, weight]), sdm.Sites(vertices, faces).edges.astype(np.int64), rounds)
    rms = [np.sqrt(np.mean(closest.distance**2)) for closest in (from_scan, from_mesh)]
    return vertices + change[:, :3] / change[:, 3:], rms


def fit(scan_mesh, levels=5, steps=12, samples=20000, log=print):
    """Returns the vertices and faces of the fitted mesh, of 8 · 4^levels faces."""
    scan = sdm.Sites(scan_mesh)
    corners = scan.vertices[scan.faces]
    random = np.random.default_rng(0)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    chosen = corners[random.choice(len(corners), samples, p=area / area.sum())]
    points = np.einsum("nk,nkx->nx", random.dirichlet((1, 1, 1), samples), chosen)

    low, high = scan.vertices.min(axis=0), scan.vertices.max(axis=0)
    vertices, faces = octahedron()
    for _ in range(2):
        vertices, faces = divided(vertices, faces)
        vertices /= np.linalg.norm(vertices, axis=1, keepdims=True)
    vertices = (low + high) / 2 + vertices * np.linalg.norm(high - low) / 2
    for level in range(2, levels + 1):
        for i in range(steps):
            vertices, (from_scan, from_mesh) = step(vertices, faces, scan, points, rounds=max(1, 6 - i // 2))
        size = np.linalg.norm(high - low)
        log(f"{len(faces):6} faces: rms {from_scan / size:.2e} of the size from the scan, {from_mesh / size:.2e} to it")
        if level < levels:
            vertices, faces = divided(vertices, faces)
    return vertices, faces


def main(scan_file, output, picture=None):
    scan = sdm.read(scan_file)
    fitted = fit(scan)
    distances = sdm.map(fitted, scan, sign="none", resolution=512)
    distances.save(output)
    if picture:
        distances.plot().view_init(vertical_axis="y")
        import matplotlib.pyplot as plt

        plt.savefig(picture, dpi=150)


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__.strip().splitlines()[2])
    main(*sys.argv[1:])
