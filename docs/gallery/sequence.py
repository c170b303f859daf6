"""
A deforming surface
===================

Distances over time of a sheet that waves above a sphere.
"""

# %%
# The sheet, as a function of time, and the sphere.
import matplotlib.pyplot as plt
import numpy as np

import sdm

count = 80
line = np.linspace(-1.5, 1.5, count)
x, y = np.meshgrid(line, line, indexing="ij")
i, j = np.meshgrid(np.arange(count - 1), np.arange(count - 1), indexing="ij")
a, b, c, d = (i * count + j, (i + 1) * count + j, i * count + j + 1, (i + 1) * count + j + 1)
faces = np.stack([a, b, c, b, d, c], axis=-1).reshape(-1, 3)


def sheet(time):
    height = 1.5 + 0.3 * np.sin(3 * x - 4 * time) * np.cos(2 * y + time)
    return np.stack([x, y, height], axis=-1).reshape(-1, 3)


line = np.linspace(0, np.pi, 60)
theta, phi = np.meshgrid(line, np.linspace(0, 2 * np.pi, 120), indexing="ij")
sphere = [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)]
i, j = np.meshgrid(np.arange(59), np.arange(119), indexing="ij")
a, b, c, d = (i * 120 + j, (i + 1) * 120 + j, i * 120 + j + 1, (i + 1) * 120 + j + 1)
sphere_faces = np.stack([a, b, c, b, d, c], axis=-1).reshape(-1, 3)
sites = sdm.Sites(np.stack(sphere, axis=-1).reshape(-1, 3), sphere_faces)

# %%
# The atlas of the sheet is made once: ``refit`` moves its vertices, and a texel stays the same point of
# the material.
surface = sdm.Surface(sheet(0), faces, resolution=256)
times = np.linspace(0, 2 * np.pi, 48)
frames = []
for time in times:
    surface.refit(sheet(time))
    last = sdm.map(surface, sites)
    frames.append(last.distance)
frames = np.array(frames)
last.save_view("sequence.png", up="z")

# %%
# The distances over time: the smallest, the mean and the largest of each frame.
plt.figure(figsize=(6, 3))
for function, name in ((np.nanmin, "smallest"), (np.nanmean, "mean"), (np.nanmax, "largest")):
    plt.plot(times, function(frames, axis=(1, 2)), label=name)
plt.xlabel("time")
plt.ylabel("distance")
plt.legend(loc="center right")
plt.tight_layout()

# %%
# How near each point of the sheet ever came. The same texel of all frames is the same point, so this is a
# minimum along an axis.
nearest = np.full(surface.texel_faces.shape, np.nan)
owned = surface.texel_faces != sdm.NONE
nearest[owned] = frames[:, owned].min(axis=0)
fig, axes = plt.subplots(1, 2, figsize=(8, 3.5))
for ax, values in zip(axes, (frames[0], nearest)):
    picture = ax.imshow(values, cmap="viridis", vmin=0, vmax=np.nanmax(frames[0]))
    ax.set_axis_off()
axes[0].set_title("distance in the first frame")
axes[1].set_title("smallest distance of all frames")
fig.colorbar(picture, ax=axes, shrink=0.8)

assert (nearest[owned] <= frames[0][owned]).all()
