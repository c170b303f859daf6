"""
A first map
===========

The distance from every point of one surface to another, as a picture and as numbers.
"""

import sdm

# %%
# Two meshes of Debian's package ``glmark2-data``: a bunny, and a horse that stands next to it. Both are scaled to a
# length of 1.
folder = "/usr/share/glmark2/models/"
bunny, horse = sdm.read(folder + "bunny.obj"), sdm.read(folder + "horse.3ds")
beside = sdm.fit_to_unit(horse)
beside[0, 3] += 0.8
distance_map = sdm.map(bunny, horse.transformed(beside), transform=sdm.fit_to_unit(bunny))
distance_map

# %%
# On the bunny itself:
distance_map.plot().view_init(vertical_axis="y")
