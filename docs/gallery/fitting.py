"""
Fitting a mesh to points
========================

Derivatives of distances move a mesh onto a scan.
"""

# %%
# A scan of an unknown shape: points with noise.
import matplotlib.pyplot as plt
import numpy as np

import sdm

# sphinx_gallery_thumbnail_number = 2

random = np.random.default_rng(3)
directions = random.normal(size=(6000, 3))
directions /= np.linalg.norm(directions, axis=1, keepdims=True)
x, y, z = directions.T
radius = 1 + 0.25 * np.exp(-8 * ((x - 0.7) ** 2 + (y - 0.5) ** 2))
radius += 0.15 * np.cos(4 * np.arctan2(y, x)) * (1 - z**2)
scan = radius[:, None] * directions + random.normal(0, 0.005, directions.shape)

# %%
# The mesh starts as a sphere: an icosahedron, each face divided into four, four times.
golden = (1 + 5**0.5) / 2
vertices = np.array([[s * 1, t * golden, 0] for s in (-1, 1) for t in (-1, 1)], float)
vertices = np.vstack([vertices, np.roll(vertices, 1, axis=1), np.roll(vertices, 2, axis=1)])
distances = np.linalg.norm(vertices[:, None] - vertices, axis=2)
faces = [
    (i, j, k) if np.linalg.det(vertices[[i, j, k]]) > 0 else (i, k, j)
    for i in range(12) for j in range(i) for k in range(j)
    if max(distances[i, j], distances[j, k], distances[k, i]) < 2.1
]  # fmt: skip
faces = np.array(faces)
for _ in range(4):
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    edges, inverse = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
    a, b, c = faces.T
    ab, bc, ca = len(vertices) + inverse.reshape(3, -1)
    vertices = np.vstack([vertices, vertices[edges].mean(axis=1)])
    faces = np.stack([a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca], axis=1).reshape(-1, 3)
vertices /= np.linalg.norm(vertices, axis=1, keepdims=True)
print(len(vertices), "vertices,", len(faces), "faces")

# %%
# Gradient descent on the sum of squared distances of the points. ``vertex_gradients()`` has the
# derivatives of each distance by the three corners of the closest face. Each step is divided by the
# weight that a vertex has received, and smoothed along the edges.
edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
edges = np.unique(np.sort(edges, axis=1), axis=0)
degree = np.bincount(edges.ravel(), minlength=len(vertices))[:, None]
sites = sdm.Sites(vertices, faces)
history = []
for step in range(80):
    closest = sites.closest_points(scan, gradients=True)
    history.append(np.sqrt(np.mean(closest.distance**2)))
    corners, derivatives = closest.vertex_gradients()
    slope, weight = np.zeros_like(vertices), np.full((len(vertices), 1), 1e-3)
    np.add.at(slope, corners, closest.distance[:, None, None] * derivatives)
    np.add.at(weight, corners, closest.barycentric[..., None])
    move = -slope / weight
    for _ in range(2):
        neighbours = np.zeros_like(move)
        np.add.at(neighbours, edges[:, 0], move[edges[:, 1]])
        np.add.at(neighbours, edges[:, 1], move[edges[:, 0]])
        move = 0.5 * move + 0.5 * neighbours / degree
    vertices = vertices + 0.7 * move
    sites.refit(vertices)

# %%
plt.figure(figsize=(6, 3))
plt.semilogy(history)
plt.xlabel("step")
plt.ylabel("rms distance of the points")
plt.tight_layout()
print(f"rms distance {history[0]:.4f} -> {history[-1]:.4f}; the noise is 0.005")

# %%
# The fitted mesh, with its distance from the sphere that it was:
sphere = vertices / np.linalg.norm(vertices, axis=1, keepdims=True)
sdm.map(sdm.Mesh(vertices, faces), (sphere, faces), precision=0.03).save_view("fitting.png")

assert history[-1] < 0.01 < history[0]
