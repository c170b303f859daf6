"""
How good is a simplified mesh?
==============================

The Hausdorff distance of a mesh and coarser versions of it, with bounds that hold for every point.
"""

# %%
# A surface in spherical coordinates, with as many triangles as asked for.
import matplotlib.pyplot as plt
import numpy as np

import sdm

# sphinx_gallery_thumbnail_number = 2


def blob(count):
    """A closed mesh of about 4 count² faces."""
    angles = np.pi * np.arange(2 * count) / count
    theta, phi = np.meshgrid(angles[1:count], angles, indexing="ij")
    radius = 1 + 0.15 * np.sin(5 * theta) * np.cos(4 * phi) * np.sin(theta) ** 2
    x, y, z = np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)
    rings = radius[..., None] * np.stack([x, y, z], axis=-1)
    vertices = np.vstack([[[0, 0, 1]], rings.reshape(-1, 3), [[0, 0, -1]]])
    k = np.arange(2 * count)
    following = (k + 1) % (2 * count)
    faces = [np.stack([0 * k, 1 + k, 1 + following], axis=1)]
    for row in range(count - 2):
        a, b = 1 + row * 2 * count + k, 1 + row * 2 * count + following
        c, d = a + 2 * count, b + 2 * count
        faces += [np.stack([a, c, b], axis=1), np.stack([b, c, d], axis=1)]
    last = 1 + (count - 2) * 2 * count
    faces += [np.stack([last + k, 0 * k + len(vertices) - 1, last + following], axis=1)]
    return sdm.Mesh(vertices, np.vstack(faces))


original = blob(100)
sites = sdm.Sites(original)
print(len(original.faces), "faces")

# %%
# Nothing is sampled: the distance lies between ``lower`` and ``upper``. The usual estimate, from the
# vertices alone, is far too small, as these lie almost on the original.
counts = [6, 8, 12, 16, 24, 32, 48]
rows = []
for count in counts:
    coarse = blob(count)
    distance = sdm.hausdorff(coarse, sites, precision=1e-4)
    lower, upper = distance.lower, distance.upper
    at_vertices = sites.closest_points(coarse.vertices).distance.max()
    rows.append((len(coarse.faces), distance.value, lower, upper, at_vertices))
    print(f"{len(coarse.faces):5} faces: {lower:.5f} to {upper:.5f}, at vertices {at_vertices:.5f}")

# %%
faces, value, lower, upper, at_vertices = np.array(rows).T
plt.figure(figsize=(6, 4))
plt.loglog(faces, value, "o-", label="Hausdorff distance, certified")
plt.loglog(faces, at_vertices, "s--", label="largest distance of a vertex")
plt.xlabel("faces")
plt.ylabel("distance")
plt.legend(loc="upper right")
plt.tight_layout()

# %%
# Where a coarse mesh is farthest from the original: the witness is a pair of points, one on each.
worst = sdm.hausdorff(blob(12), sites)
print(worst)
print("from", worst.witness[0], "to", worst.witness[1])

# %%
# Its map shows why vertices say so little. Distances are largest in the middle of faces, inside the
# original (blue) where it is convex and outside (red) in its hollows.
sdm.map(blob(12), sites, precision=0.01).save_view("hausdorff.png")

assert (lower <= value).all() and (value <= upper).all() and (at_vertices <= upper).all()
