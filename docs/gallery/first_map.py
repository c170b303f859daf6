"""
A first map
===========

The distance from every point of one surface to another, as a picture and as numbers.
"""

# %%
# Two meshes of Debian's package ``glmark2-data``: a bunny, and a horse that stands next to it. Both are
# scaled to a length of 1.
import sdm

folder = "/usr/share/glmark2/models/"
bunny, horse = sdm.read(folder + "bunny.obj"), sdm.read(folder + "horse.3ds")
beside = sdm.fit_to_unit(horse)
beside[0, 3] += 0.8
distance_map = sdm.map(bunny, horse.transformed(beside), transform=sdm.fit_to_unit(bunny))

# %%
# The distances on the bunny:
distance_map.save_view("first_map.png")

# %%
# A map has a value for each texel of a texture that covers the bunny. In a notebook it shows this texture,
# and its numbers:
distance_map

# %%
# The values are arrays; texels that are not part of the bunny hold NaN. What lies between texels is
# bounded, too:
import numpy as np

bounds = distance_map.bounds
print("nearest texel ", np.nanmin(distance_map.distance), ", nearest point at least", bounds.lower)
print("farthest texel", np.nanmax(distance_map.distance), ", farthest point at most", bounds.upper)

# %%
# The closest point of the horse is known for each texel, and which vertex, edge or face of it that is:
i, j = np.unravel_index(np.nanargmin(distance_map.distance), distance_map.distance.shape)
print(distance_map.position[i, j], "+", distance_map.vector[i, j])
print(sdm.SiteType(distance_map.site_type[i, j]).name, distance_map.site[i, j])

# %%
# ``distance_map.save("map.exr")`` keeps all of this; ``.glb``, ``.ply`` and others are for other programs.
assert bounds.lower <= np.nanmin(distance_map.distance) <= np.nanmax(distance_map.distance) <= bounds.upper
