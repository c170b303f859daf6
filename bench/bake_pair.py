"""The meshes and the picture of bench/bake: a bumpy ball of cube faces, fine and coarse, whose points are known.

Each of the six faces of a cube is a grid of n × n cells of two triangles, whose vertices are moved to the ball. On a
texture, the faces are rectangles with gaps, in three columns and two rows; those of the fine mesh are in another order,
so that a texel's place in one texture is not its place in the other.
"""

import json
import struct
from pathlib import Path

import numpy as np

GAP = 1 / 128  # of the texture, around each face of the cube
HIGH_ORDER, LOW_ORDER = [4, 2, 0, 5, 3, 1], [0, 1, 2, 3, 4, 5]


def on_cube(face: int, s, t):
    """Points of a face of the cube [-1, 1]³, so that (s, t) are counter-clockwise from outside; equal on shared edges."""
    axis, sign = face // 2, 1 - 2 * (face % 2)
    a, b = (s, t) if sign > 0 else (t, s)
    columns = [None, None, None]
    columns[axis] = np.full(np.shape(s), float(sign))
    columns[(axis + 1) % 3], columns[(axis + 2) % 3] = a, b
    return np.stack(columns, axis=-1)


def on_ball(points):
    """Bumps of several sizes."""
    p = points / np.linalg.norm(points, axis=-1, keepdims=True)
    x, y, z = np.moveaxis(p, -1, 0)
    radius = (1 + 0.12 * np.sin(3 * x + 1) * np.cos(4 * y) + 0.04 * np.sin(11 * y + 2) * np.cos(9 * z)
              + 0.008 * np.sin(40 * z + 3) * np.cos(37 * x) + 0.002 * np.sin(90 * x + 1) * np.sin(97 * y))
    return p * radius[..., None]


def rectangle(place: int):
    """The lower left corner and the size, in texture coordinates, of a place."""
    column, row = place % 3, place // 3
    return np.array([column / 3 + GAP, row / 2 + GAP]), np.array([1 / 3 - 2 * GAP, 1 / 2 - 2 * GAP])


def grid_mesh(n: int, order: list):
    """Vertices, a copy for each face of the cube, their texture coordinates, and faces."""
    steps = np.linspace(-1, 1, n + 1)
    steps[0], steps[-1] = -1, 1
    s, t = (g.ravel() for g in np.meshgrid(steps, steps))
    i, j = (g.ravel() for g in np.meshgrid(np.arange(n), np.arange(n)))
    corner = j * (n + 1) + i
    faces = np.stack([corner, corner + 1, corner + n + 2, corner, corner + n + 2, corner + n + 1], axis=1).reshape(-1, 3)
    vertices, uvs, triangles = [], [], []
    for face in range(6):
        origin, size = rectangle(order.index(face))
        triangles.append(faces + len(s) * face)
        vertices.append(on_ball(on_cube(face, s, t)))
        uvs.append(origin + (np.stack([s, t], axis=1) + 1) / 2 * size)
    return np.concatenate(vertices), np.concatenate(uvs), np.concatenate(triangles)


def texel_points(vertices, n: int, resolution: int, columns, rows, order: list):
    """The points of a grid mesh at places of its texture, in texels from its upper left; NaN outside of faces."""
    u, v = columns / resolution, 1 - rows / resolution
    points = np.full((len(u), 3), np.nan)
    for face in range(6):
        origin, size = rectangle(order.index(face))
        s, t = (u - origin[0]) / size[0] * n, (v - origin[1]) / size[1] * n
        inside = (s >= 0) & (s <= n) & (t >= 0) & (t <= n)
        i, j = np.minimum(s[inside], n - 1).astype(int), np.minimum(t[inside], n - 1).astype(int)
        a, b = s[inside] - i, t[inside] - j
        first = face * (n + 1) ** 2 + j * (n + 1) + i
        lower = (a >= b)[:, None]  # the triangle below the diagonal
        p, right, upper, far = (vertices[first + k] for k in (0, 1, n + 1, n + 2))
        points[inside] = np.where(lower, p + (a - b)[:, None] * (right - p) + b[:, None] * (far - p),
                                  p + (b - a)[:, None] * (upper - p) + a[:, None] * (far - p))
    return points


def color_of(points):
    """sRGB from 0 to 1, of directions: details of many sizes, down to a few pixels of the texture."""
    x, y, z = np.moveaxis(points / np.linalg.norm(points, axis=-1, keepdims=True), -1, 0)
    waves = [np.sin(7 * x + 2 * y) + np.sin(61 * z + 5 * x), np.sin(5 * y - 3 * z) + np.sin(67 * x * y + 1),
             np.sin(9 * z + x) + np.sin(151 * y + 3 * z)]
    fine = np.sin(300 * x) * np.sin(310 * y) * np.sin(290 * z)
    return np.clip(0.5 + 0.17 * np.stack(waves, axis=-1) + 0.1 * fine[..., None], 0, 1)


def picture(size: int, order: list):
    """The texture of the fine mesh, rows from the top, uint8. Gaps continue the faces."""
    pixels = np.zeros((size, size, 3), np.uint8)
    for place in range(6):
        column, row = place % 3, place // 3
        xs = np.arange(round(column * size / 3), round((column + 1) * size / 3))
        ys = np.arange(size - round((row + 1) * size / 2), size - round(row * size / 2))
        origin, extent = rectangle(place)
        s = ((xs + 0.5) / size - origin[0]) / extent[0] * 2 - 1
        for part in np.array_split(ys, max(1, len(ys) // 128)):
            t = ((1 - (part + 0.5) / size) - origin[1]) / extent[1] * 2 - 1
            grid = np.meshgrid(s, t)
            colors = color_of(on_cube(order[place], *grid))
            pixels[part[0] : part[-1] + 1, xs[0] : xs[-1] + 1] = np.rint(255 * colors)
    return pixels


def write_glb(file: Path, vertices, uvs, faces, png: bytes = b"") -> None:
    """Positions in float; a material with the picture, if there is one."""
    parts = [np.ascontiguousarray(vertices, np.float32).tobytes(),
             np.ascontiguousarray(np.column_stack([uvs[:, 0], 1 - uvs[:, 1]]), np.float32).tobytes(),
             np.ascontiguousarray(faces, np.uint32).tobytes(), png]
    views, offset = [], 0
    for part in parts:
        views.append({"buffer": 0, "byteOffset": offset, "byteLength": len(part)})
        offset += len(part) + -len(part) % 4
    primitive = {"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2}
    low, high = (f(np.asarray(vertices, np.float32), axis=0).tolist() for f in (np.min, np.max))
    model = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
             "meshes": [{"primitives": [primitive]}], "buffers": [{"byteLength": offset}],
             "bufferViews": views if png else views[:3],
             "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(vertices), "type": "VEC3", "min": low, "max": high},
                           {"bufferView": 1, "componentType": 5126, "count": len(uvs), "type": "VEC2"},
                           {"bufferView": 2, "componentType": 5125, "count": 3 * len(faces), "type": "SCALAR"}]}
    if png:
        primitive["material"] = 0
        model |= {"materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0}}],
                  "textures": [{"source": 0, "sampler": 0}], "images": [{"mimeType": "image/png", "bufferView": 3}],
                  "samplers": [{"wrapS": 33071, "wrapT": 33071}]}
    text = json.dumps(model).encode()
    text += b" " * (-len(text) % 4)
    with open(file, "wb") as out:
        out.write(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + offset))
        out.write(struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", offset, b"BIN\0"))
        for part in parts:
            out.write(part + b"\0" * (-len(part) % 4))
