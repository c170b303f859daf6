#!/usr/bin/env python3
"""Makes a textured asset of a generated mesh with a colour at each vertex: few triangles, a texture, one GLB file.

usage: textured_asset.py OUTPUT.glb

Generators of shapes return what shape() does: many triangles, and colours of vertices. No GPU is needed.
"""

import sys

import numpy as np

import sdm


def shape(rings=400, sides=120):
    """A knotted tube with grooves: vertices, faces, and red, green and blue of each vertex."""
    a, b = (g.ravel() for g in np.meshgrid(*(np.linspace(0, 2 * np.pi, n, endpoint=False) for n in (rings, sides)), indexing="ij"))
    centre = np.stack([np.sin(a) + 2 * np.sin(2 * a), np.cos(a) - 2 * np.cos(2 * a), -np.sin(3 * a)], axis=1)
    along = np.stack([np.cos(a) + 4 * np.cos(2 * a), -np.sin(a) + 4 * np.sin(2 * a), -3 * np.cos(3 * a)], axis=1)
    side = np.cross(along, [0, 0, 1])
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    up = np.cross(side, along / np.linalg.norm(along, axis=1, keepdims=True))
    groove = np.cos(8 * b + 20 * a)
    vertices = centre + (0.5 + 0.02 * groove)[:, None] * (np.cos(b)[:, None] * side + np.sin(b)[:, None] * up)
    here = np.arange(rings * sides).reshape(rings, sides)
    next_ring, next_side, both = (np.roll(here, shift, axis) for shift, axis in ((-1, 0), (-1, 1), ((-1, -1), (0, 1))))
    faces = np.concatenate([np.stack(t, axis=-1).reshape(-1, 3) for t in ((here, next_ring, both), (here, both, next_side))])
    colors = np.stack([0.5 + 0.5 * groove, 0.5 + 0.5 * np.sin(3 * a), np.full(len(a), 0.3)], axis=1)
    return vertices, faces, (255 * colors).astype(np.uint8)


def main(output, triangles=2000, resolution=1024):
    vertices, faces, colors = shape()
    coarse, deviation = sdm.simplify((vertices, faces), triangles=triangles)
    channels = ["base_color", "normal"] if sdm.has_tangents() else ["base_color"]
    baked = sdm.bake((vertices, faces), coarse, vertex_colors=colors, channels=channels, resolution=resolution, facing=90)
    baked.save(output, up="z")
    return coarse, deviation, baked


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__.strip().splitlines()[2])
    mesh, error, textures = main(sys.argv[1])
    print(f"{len(mesh.faces)} triangles, at most {error.upper:.3g} from the shape; {', '.join(textures.channels)}")
