"""
Inspecting a scan
=================

A scan of a part is turned and shifted onto the part, compared with it, and judged by a tolerance.
"""

# %%
# The part is turned on a lathe: a profile of radii and heights, revolved about an axis. Lengths are in
# mm.
import matplotlib.pyplot as plt
import numpy as np

import sdm


def revolve(profile, count):
    """A closed mesh of a profile, (n, 2), whose first and last points are on the axis."""
    angles = 2 * np.pi * np.arange(count) / count
    circle = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    rings = [r * circle + [0, 0, z] for r, z in profile[1:-1]]
    vertices = np.vstack([[[0, 0, profile[0][1]]], *rings, [[0, 0, profile[-1][1]]]])
    k, next_k = np.arange(count), (np.arange(count) + 1) % count
    faces = [np.stack([0 * k, 1 + next_k, 1 + k], axis=1)]
    for ring in range(len(rings) - 1):
        a, b, c, d = (1 + ring * count + i for i in (k, next_k, count + k, count + next_k))
        faces += [np.stack([a, b, c], axis=1), np.stack([b, d, c], axis=1)]
    last = 1 + (len(rings) - 1) * count
    faces += [np.stack([last + k, last + next_k, 0 * k + len(vertices) - 1], axis=1)]
    return sdm.Mesh(vertices, np.vstack(faces))


def fine(corners, step):
    """The points of a polyline, at most a step apart."""
    parts = []
    for a, b in zip(corners, corners[1:]):
        parts += [np.linspace(a, b, max(1, int(np.hypot(*(b - a)) / step)), endpoint=False)]
    return np.vstack([*parts, corners[-1:]])


profile = [[0, 0], [30, 0], [30, 8], [14, 8], [12, 10], [12, 34], [9, 40], [0, 40]]
part = revolve(fine(np.array(profile, float), 1.0), 180)

# %%
# A scan of it, of which the answers are known: noise of 0.02 mm, a dent 0.3 mm deep, one side missing,
# and a place of its own.
random = np.random.default_rng(1)
vertices, faces = np.array(part.vertices), part.faces
dent = np.array([12, 0, 22.0])
depth = 0.3 * np.exp(-np.sum((vertices - dent) ** 2, axis=1) / 3**2)
vertices[:, 0] -= depth
vertices += random.normal(0, 0.02, vertices.shape)
seen = vertices[:, 0] > -8
faces = faces[seen[faces].all(axis=1)]
turn = np.radians(2)
move = np.eye(4)
move[:2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
move[:3, 3] = 0.8, -0.5, 0.4
scan = sdm.Mesh(vertices, faces).transformed(move)

# %%
# Alignment finds the place again. Turning about the axis cannot be seen on a part like this:
# ``freedoms`` says how well each motion is determined, and which one is free.
alignment = sdm.align(scan, part)
print(f"rms distance {alignment.rms_before:.4f} -> {alignment.rms:.4f} mm")
for freedom in alignment.freedoms:
    print(freedom)

# %%
# The comparison. Distances are negative where the scan is inside the part.
tolerance = 0.15
distance_map = sdm.map(scan, part, transform=alignment.transform, precision=0.25)
statistics, bounds = distance_map.statistics(), distance_map.bounds
print(f"from {statistics.min:.3f} to {statistics.max:.3f} mm")
print(f"95 % of the area within {statistics.p95_abs:.3f} mm")
print("no point is below", round(bounds.lower, 3), "or above", round(bounds.upper, 3))

# %%
# The verdict: the part passes if no point can be out of tolerance, and fails if some point surely is.
if -tolerance <= bounds.lower and bounds.upper <= tolerance:
    verdict = "PASS"
elif statistics.min < -tolerance or statistics.max > tolerance:
    verdict = "FAIL"
else:
    verdict = "NOT DECIDED: a smaller precision= will"
print(verdict)

# %%
# Where it fails:
distance_map.save_view("inspection.png", (1, 0.4, 0.3), tolerance=tolerance, units="mm", up="z")

# %%
# How the distances are distributed. The bars are noise; the tail on the left is the dent.
values = distance_map.distance[distance_map.valid]
plt.figure(figsize=(6, 2.8))
plt.hist(values, bins=120, range=(-0.35, 0.35), log=True, color="0.4")
plt.axvspan(-tolerance, tolerance, color="tab:green", alpha=0.15)
plt.xlabel("distance [mm]")
plt.ylabel("texels")
plt.tight_layout()

assert verdict == "FAIL" and abs(statistics.min + 0.3) < 0.1 and alignment.rms < 0.05
