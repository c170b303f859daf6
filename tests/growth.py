#!/usr/bin/env python3
"""Growth of time and memory on small inputs that are hard for their size.

Runs commands on families of generated inputs of the sizes n, 2n and 4n, and prints a Markdown table of processor
seconds and peak memory:
  tests/growth.py SDM [--only TEXT] [--update]
--only restricts it to rows that contain the text; --update puts the table into docs/reliability.md. Fails where a
command does, unless it refuses a picture of too many pixels.
"""

import argparse
import json
import math
import os
import random
import struct
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "reliability.md"
BEGIN, END = "<!-- growth: written by tests/growth.py --update -->\n\n", "\n<!-- end of growth -->\n"


def ply(path: Path, vertices: list, faces: list) -> Path:
    text = ("ply\nformat binary_little_endian 1.0\n"
            f"element vertex {len(vertices)}\nproperty double x\nproperty double y\nproperty double z\n"
            f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
    path.write_bytes(text.encode() + b"".join(struct.pack("<3d", *v) for v in vertices)
                     + b"".join(struct.pack("<B3i", 3, *f) for f in faces))
    return path


BOX_FACES = [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4),
             (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6), (1, 3, 5), (3, 7, 5)]


def boxes(path: Path, bounds: list, tilt: tuple = (0, 0)) -> Path:
    def tilted(x: float, y: float, z: float) -> tuple:
        a, b = tilt
        x, y = x * math.cos(a) - y * math.sin(a), x * math.sin(a) + y * math.cos(a)
        return x, y * math.cos(b) - z * math.sin(b), y * math.sin(b) + z * math.cos(b)

    vertices, faces = [], []
    for lo, hi in bounds:
        faces += [tuple(len(vertices) + k for k in face) for face in BOX_FACES]
        vertices += [tilted(*((hi if i >> k & 1 else lo)[k] for k in range(3))) for i in range(8)]
    return ply(path, vertices, faces)


def torus(folder: Path) -> Path:
    """What others are compared with: 512 faces."""
    n, m, vertices, faces = 32, 8, [], []
    for i in range(n):
        for j in range(m):
            u, v = 2 * math.pi * i / n, 2 * math.pi * j / m
            vertices.append(((1 + 0.3 * math.cos(v)) * math.cos(u), (1 + 0.3 * math.cos(v)) * math.sin(u), 0.3 * math.sin(v)))
            a, b, c, d = i * m + j, (i + 1) % n * m + j, (i + 1) % n * m + (j + 1) % m, i * m + (j + 1) % m
            faces += [(a, b, c), (a, c, d)]
    return ply(folder / "torus.ply", vertices, faces)


def direction(rng: random.Random) -> tuple:
    while True:
        v = [rng.uniform(-1, 1) for _ in range(3)]
        length = math.sqrt(sum(x * x for x in v))
        if 0.1 < length < 1:
            return tuple(x / length for x in v)


def needles(folder: Path, n: int) -> Path:
    """Closed needles of four faces each, which all begin at one place."""
    rng = random.Random(1)
    vertices, faces = [], []
    for _ in range(n // 4):
        k = len(vertices)
        vertices += [tuple(0.002 * x for x in direction(rng)) for _ in range(3)] + [direction(rng)]
        a, b, c, d = vertices[-4:]
        u, v, w = ([q[i] - a[i] for i in range(3)] for q in (b, c, d))
        volume = sum(u[i] * (v[i - 2] * w[i - 1] - v[i - 1] * w[i - 2]) for i in range(3))
        i, j = (k + 1, k + 2) if volume > 0 else (k + 2, k + 1)
        faces += [(k, j, i), (k, i, k + 3), (i, j, k + 3), (k, k + 3, j)]
    return ply(folder / "needles.ply", vertices, faces)


def polygon(folder: Path, n: int) -> Path:
    """One planar polygon of n random corners."""
    rng = random.Random(2)
    path = folder / "polygon.obj"
    path.write_text("".join(f"v {rng.random():.5f} {rng.random():.5f} 0\n" for _ in range(n))
                    + "f " + " ".join(str(i + 1) for i in range(n)) + "\n")
    return path


def assembly(folder: Path, n: int) -> Path:
    """A tilted pile of planks of random lengths, each on and beside others: they touch, and share no corners."""
    rng = random.Random(5)
    side = round((n / 12) ** (1 / 3))
    bounds = []
    for z in range(side):
        for x in range(side):
            y = rng.random()
            for _ in range(side):
                length = rng.uniform(0.5, 1.5)
                bounds.append(((x + 0.37 * (z % 3), y, z), (x + 0.37 * (z % 3) + 1, y + length, z + 1)))
                y += length + 0.001
    return boxes(folder / "assembly.ply", bounds, tilt=(0.4, 0.7))


def duplicates(folder: Path, n: int) -> Path:
    """One face, n times."""
    return ply(folder / "duplicates.ply", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)] * n)


def on_edge(folder: Path, n: int) -> Path:
    """Faces around one edge."""
    vertices = [(0, 0, 0), (0, 0, 1)]
    vertices += [(math.cos(2 * math.pi * i / n), math.sin(2 * math.pi * i / n), 0.5) for i in range(n)]
    return ply(folder / "edge.ply", vertices, [(0, 1, i + 2) for i in range(n)])


def nested(folder: Path, n: int) -> Path:
    """Boxes, each in the next."""
    count = n // 12
    return boxes(folder / "nested.ply", [((-i,) * 3, (i,) * 3) for i in range(1, count + 1)])


def fan(folder: Path, n: int) -> Path:
    """A disc of faces that meet in its centre."""
    vertices = [(0, 0, 0.1)]
    vertices += [(math.cos(2 * math.pi * i / n), math.sin(2 * math.pi * i / n), 0) for i in range(n)]
    return ply(folder / "fan.ply", vertices, [(0, i + 1, (i + 1) % n + 1) for i in range(n)])


def stacked(folder: Path, n: int) -> Path:
    """Squares in one plane, each moved by little."""
    rng = random.Random(3)
    vertices, faces = [], []
    for _ in range(n // 2):
        k = len(vertices)
        x, y = 0.1 * rng.random(), 0.1 * rng.random()
        vertices += [(x, y, 0), (x + 1, y, 0), (x + 1, y + 1, 0), (x, y + 1, 0)]
        faces += [(k, k + 1, k + 2), (k, k + 2, k + 3)]
    return ply(folder / "stacked.ply", vertices, faces)


def png(width: int, height: int) -> bytes:
    """All black."""
    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    packed = zlib.compressobj(9)
    data = b"".join(packed.compress(bytes(1 + 3 * width)) for _ in range(height)) + packed.flush()
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
            + chunk(b"IDAT", data) + chunk(b"IEND", b""))


def textured(path: Path, images: int, picture: bytes) -> Path:
    """A GLB of one face for each of several images, which are all stored in one bufferView."""
    data = (struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0) + struct.pack("<6f", 0, 0, 1, 0, 0, 1)
            + picture + bytes(-len(picture) % 4))
    numbers = range(images)
    model = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": i} for i in numbers]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": i}}} for i in numbers],
        "textures": [{"source": i} for i in numbers],
        "images": [{"bufferView": 2, "mimeType": "image/png"} for _ in numbers],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0],
                       "max": [1, 1, 0]}, {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 36},
                        {"buffer": 0, "byteOffset": 36, "byteLength": 24},
                        {"buffer": 0, "byteOffset": 60, "byteLength": len(picture)}],
        "buffers": [{"byteLength": len(data)}]}
    text = json.dumps(model).encode()
    text += b" " * (-len(text) % 4)
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(data))
                     + struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data)
    return path


def one_picture(folder: Path, n: int) -> Path:
    """n images that are one bufferView of 1024 x 1024 pixels."""
    return textured(folder / "images.glb", n, png(1024, 1024))


def large_picture(folder: Path, n: int) -> Path:
    """One picture of n x n black pixels."""
    return textured(folder / "picture.glb", 1, png(n, n))


INFO, BODIES, SELF, METRICS, BAKE = "info", "bodies", "self", "metrics", "bake"

# Family, n, commands.
FAMILIES = [
    (needles, 200, [INFO, METRICS, SELF]),
    (needles, 50, [BODIES]),
    (polygon, 1000, [INFO, BODIES, SELF]),
    (polygon, 250, [METRICS]),
    (assembly, 3000, [INFO, METRICS]),
    (duplicates, 400, [INFO, BODIES, SELF]),
    (duplicates, 100, [METRICS]),
    (on_edge, 400, [INFO, BODIES, SELF]),
    (on_edge, 100, [METRICS]),
    (nested, 400, [INFO, BODIES, SELF, METRICS]),
    (fan, 2000, [INFO, BODIES, SELF]),
    (fan, 500, [METRICS]),
    (stacked, 400, [INFO, BODIES, SELF]),
    (stacked, 100, [METRICS]),
    (one_picture, 40, [BAKE]),
    (large_picture, 4096, [BAKE]),
]


def arguments(command: str, mesh: Path, other: Path, out: Path) -> list:
    return {INFO: [mesh], METRICS: [mesh, other], BODIES: [mesh, mesh],
            SELF: [mesh, "-o", out, "--resolution", "256", "--write", "exr"],
            BAKE: [mesh, other, "-o", out, "--resolution", "32"]}[command]


def measured(sdm: Path, call: list) -> str:
    """Processor seconds and peak memory; where the input is refused, that instead."""
    with tempfile.TemporaryFile() as log:
        process = subprocess.Popen([sdm, *call], stdout=log, stderr=log)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        log.seek(0)
        text = log.read().decode()
    if process.returncode == 1 and "too many" in text:
        return "refused"
    if process.returncode != 0:
        sys.exit(f"{' '.join(map(str, call))}\nended with {process.returncode}: {text}")
    return f"{usage.ru_utime + usage.ru_stime:.1f} s, {usage.ru_maxrss / 1024:.0f} MB"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sdm", type=Path)
    parser.add_argument("--only", default="")
    parser.add_argument("--update", action="store_true")
    options = parser.parse_args()
    table = ["| family | command | n | at n | at 2 n | at 4 n |", "| --- | --- | ---: | ---: | ---: | ---: |"]
    print("\n".join(table))
    for family, n, commands in FAMILIES:
        for command in commands:
            name = family.__name__.replace("_", " ")
            if options.only not in f"{name} {command}":
                continue
            cells = []
            for size in (n, 2 * n, 4 * n):
                with tempfile.TemporaryDirectory() as folder:
                    mesh, other = family(Path(folder), size), torus(Path(folder))
                    cells.append(measured(options.sdm, [command, *arguments(command, mesh, other, Path(folder) / "out")]))
            table.append(f"| {name} | `{command}` | {n} | " + " | ".join(cells) + " |")
            print(table[-1], flush=True)
    if options.update:
        text = PAGE.read_text(encoding="utf-8")
        commit = subprocess.run(["git", "rev-parse", "--short=8", "HEAD"], cwd=ROOT, capture_output=True, text=True,
                                check=True).stdout.strip()
        before, after = text.partition(BEGIN)[0], text.partition(END)[2]
        PAGE.write_text(f"{before}{BEGIN}Of commit {commit}:\n\n" + "\n".join(table) + f"\n{END}{after}", encoding="utf-8")


if __name__ == "__main__":
    main()
