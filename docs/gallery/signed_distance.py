"""
Signed distances in a slice
===========================

Distances from any points to a mesh, negative inside, drawn over a plane.
"""

# %%
# A trefoil: a tube around a knot.
import matplotlib.pyplot as plt
import numpy as np

import sdm


def tube(curve, radius, sides):
    """A closed tube around a closed curve, (n, 3)."""
    tangent = np.roll(curve, -1, axis=0) - np.roll(curve, 1, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    side = np.cross(tangent, [0, 0, 1])
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    up = np.cross(side, tangent)
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = np.cos(angle)[:, None] * side[:, None] + np.sin(angle)[:, None] * up[:, None]
    vertices = (curve[:, None] + radius * ring).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(len(curve)), np.arange(sides), indexing="ij")
    a, b = i * sides + j, i * sides + (j + 1) % sides
    c, d = ((k + sides) % len(vertices) for k in (a, b))
    faces = np.stack([a, b, c, b, d, c], axis=-1).reshape(-1, 3)
    return sdm.Mesh(vertices, faces)


t = 2 * np.pi * np.arange(400) / 400
curve = [np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -np.sin(3 * t)]
knot = tube(np.stack(curve, axis=1), 0.45, 40)

# %%
# The points of a slice. Signs are exact for closed meshes, also where these intersect themselves;
# an open mesh has no inside, and raises ``sdm.Error``.
x, y = np.meshgrid(np.linspace(-4, 4, 500), np.linspace(-4, 4, 500))
points = np.stack([x, y, np.full_like(x, 0.3)], axis=-1).reshape(-1, 3)
sites = sdm.Sites(knot)
distance = sites.signed_distance(points).reshape(x.shape)
print("inside:", f"{sites.contains(points).mean():.2%}", "of the points")

# %%
plt.figure(figsize=(6, 5))
limit = np.abs(distance).max()
plt.contourf(x, y, distance, levels=40, cmap="RdBu_r", vmin=-limit, vmax=limit)
plt.colorbar(label="signed distance")
plt.contour(x, y, distance, levels=[0], colors="black")
plt.gca().set_aspect("equal")

# %%
# Closest points, of every 25th point along both axes. Lines end above and below the slice, too.
some = points.reshape(500, 500, 3)[::25, ::25].reshape(-1, 3)
closest = sites.closest_points(some)
plt.figure(figsize=(6, 5))
plt.contour(x, y, distance, levels=[0], colors="black")
plt.plot(*np.stack([some, closest.point])[..., :2].transpose(2, 0, 1), color="tab:blue", linewidth=0.8)
plt.gca().set_aspect("equal")

assert np.allclose(np.abs(distance)[::25, ::25].ravel(), closest.distance)
