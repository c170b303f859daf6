"""
Moving bodies
=============

Separation and penetration depth of two bodies, one of which passes through the other.
"""

# %%
# Two rings. One is threaded through the other, without touching it, and then driven through its wall.
import matplotlib.pyplot as plt
import numpy as np

import sdm


def ring(radius, thickness, around=96, across=48):
    u, v = np.meshgrid(2 * np.pi * np.arange(around) / around, 2 * np.pi * np.arange(across) / across, indexing="ij")
    r = radius + thickness * np.cos(v)
    vertices = np.stack([r * np.cos(u), r * np.sin(u), thickness * np.sin(v)], axis=-1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    index = [(i + di) % around * across + (j + dj) % across for di, dj in ((0, 0), (1, 0), (0, 1), (1, 1))]
    a, b, c, d = index
    return sdm.Mesh(vertices, np.concatenate([np.stack([a, b, c], axis=-1), np.stack([b, d, c], axis=-1)]).reshape(-1, 3))


query = sdm.ProximityQuery(ring(1.0, 0.25), ring(1.0, 0.25))

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
plt.fill_between(places, [d.lower for d in depth], [d.upper for d in depth], color="tab:orange", alpha=0.4)
plt.xlabel("place of the second ring")
plt.legend()
plt.tight_layout()
deepest = int(np.argmax([d.value for d in depth]))
print("a separation:", separation[-1])
print("a depth:", depth[deepest], "between", depth[deepest].lower, "and", depth[deepest].upper)

# %%
# The deepest place, seen along the axis of the first ring: contact points, and the directions that push the bodies
# apart.
pose = upright.copy()
pose[0, 3] = places[deepest]
query.set_pose(1, pose)
contacts = query.contacts()
plt.figure(figsize=(5, 4))
plt.scatter(*contacts.point1[:, :2].T, c=contacts.depth, cmap="viridis", s=12)
plt.colorbar(label="depth")
plt.quiver(*contacts.point1[:, :2].T, *contacts.normal[:, :2].T, width=0.003, color="0.5")
plt.gca().set_aspect("equal")
print(len(contacts.depth), "contacts in", len(np.unique(contacts.patch)), "patch(es)")

# %%
# No position of the two rings touches while the second is threaded through the middle of the first:
query.set_pose(1, upright + np.array([[0, 0, 0, 1.0], [0] * 4, [0] * 4, [0] * 4]))
print(query.separation(), bool(query.colliding()))

assert all((s.value == 0) == (d.value > 0) for s, d in zip(separation, depth))
