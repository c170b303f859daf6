"""
Moving bodies
=============

Separation and penetration depth of two bodies, one of which passes through the other.
"""

# %%
# Two rings. One is threaded through the other, and driven through its wall.
import matplotlib.pyplot as plt
import numpy as np

import sdm

# sphinx_gallery_thumbnail_number = 3


def ring(radius, thickness, around=96, across=48):
    u, v = (2 * np.pi * np.arange(n) / n for n in (around, across))
    u, v = np.meshgrid(u, v, indexing="ij")
    r = radius + thickness * np.cos(v)
    vertices = np.stack([r * np.cos(u), r * np.sin(u), thickness * np.sin(v)], axis=-1)
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    next_i, next_j = (i + 1) % around, (j + 1) % across
    a, b, c, d = (i * across + j, next_i * across + j, i * across + next_j, next_i * across + next_j)
    return sdm.Mesh(vertices.reshape(-1, 3), np.stack([a, b, c, b, d, c], axis=-1).reshape(-1, 3))


one, other = ring(1.0, 0.25), ring(1.0, 0.25)
query = sdm.ProximityQuery(one, other)

# %%
# A pose is a 4 × 4 matrix; moving a body costs nothing. The second ring is upright and moves along x.
upright = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]], float)
places = np.linspace(0.4, 2.8, 61)
separation, depth = [], []
for x in places:
    pose = upright.copy()
    pose[0, 3] = x
    query.set_pose(1, pose)
    separation.append(query.separation())
    depth.append(query.penetration_depth())

# %%
# Separations are exact. Depths are bounded; the band shows how closely, and is too narrow to see.
plt.figure(figsize=(7, 3.5))
plt.plot(places, [s.value for s in separation], label="separation")
plt.plot(places, [d.value for d in depth], label="penetration depth")
lower, upper = [d.lower for d in depth], [d.upper for d in depth]
plt.fill_between(places, lower, upper, color="tab:orange", alpha=0.4)
plt.xlabel("place of the second ring")
plt.legend()
plt.tight_layout()
deepest = int(np.argmax([d.value for d in depth]))
print("a separation:", separation[-1])
print("a depth:", depth[deepest])

# %%
# Where the rings begin to touch, seen along the axis of the first one: points of it in contact, and the
# directions in which it is pushed away.
pose = upright.copy()
pose[0, 3] = 1.56
query.set_pose(1, pose)
contacts = query.contacts()
x, y = contacts.point1[:, :2].T
plt.figure(figsize=(5, 4))
plt.quiver(x, y, *contacts.normal[:, :2].T, contacts.depth, cmap="viridis", width=0.004)
plt.colorbar(label="depth")
plt.xlim(x.min() - 0.1, x.max() + 0.1)
plt.ylim(y.min() - 0.1, y.max() + 0.1)
print(len(contacts.depth), "contacts in", len(np.unique(contacts.patch)), "patch(es)")

# %%
# In the middle of the hole, they are as far apart as they get:
pose[0, 3] = 1.0
query.set_pose(1, pose)
print(query.separation(), query.colliding())

# %%
# What both see of each other there: two maps, in one picture.
upright_ring = other.transformed(pose)
there, back = sdm.map(one, upright_ring), sdm.map(upright_ring, one)
there.save_view("moving_bodies.png", (0.5, 0.6, 1), other=back)

assert all((s.value == 0) == (d.value > 0) for s, d in zip(separation, depth))
