#!/usr/bin/env python3
"""The README's pipeline, `sdm simplify` and `sdm bake`, on ten models whose surfaces, colours and normals are known.

Makes them with the materials and layouts that artists have: poles, seams, charts, UVs that are mirrored or repeat,
several materials, colours of vertices, a normal texture. Simplifies each, bakes it onto the result, with one sample a
texel and with four, and compares every texel of the model that was written, but for those at folds, with the colour and
the normal of the surface beside it. Khronos' validator must have nothing to say about the files, but for what the
simplified mesh keeps of its input (ALLOWED).
  tests/textured_models.py SDM [--validator FOLDER SCRIPT] [--only NAME]
"""

import argparse
import json
import math
import struct
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

from materials import chunk

SIDE = 128  # texels
PIXELS = 256  # of a texture
# UVs without a texture, which are to be baked to, and a normal texture without tangents, which OBJ does not have.
ALLOWED = ("UNUSED_OBJECT at /meshes/0/primitives/0/attributes/TEXCOORD_0", "MESH_PRIMITIVE_GENERATED_TANGENT_SPACE")


def unit(v: tuple) -> tuple:
    length = math.sqrt(sum(x * x for x in v))
    return tuple(x / length for x in v)


def color(p: tuple) -> tuple:
    """Of a point of a surface: smooth, in sRGB, and the same on both sides of x = 0."""
    return (0.5 + 0.4 * math.cos(3 * p[0]), 0.5 + 0.4 * math.sin(2 * p[1] + 1), 0.5 + 0.4 * math.cos(2 * p[2]))


class Sphere:
    def point(self, s: float, t: float) -> tuple:
        a, b = 2 * math.pi * s, math.pi * t
        return (math.sin(b) * math.cos(a), math.sin(b) * math.sin(a), -math.cos(b))

    def nearest(self, p: tuple) -> tuple:
        """The point of the surface beside p, its normal, and the distance to a fold."""
        n = unit(p)
        return n, n, math.inf


class Torus:
    def point(self, s: float, t: float) -> tuple:
        a, b = 2 * math.pi * s, 2 * math.pi * t
        r = 1 + 0.4 * math.cos(b)
        return (r * math.cos(a), r * math.sin(a), 0.4 * math.sin(b))

    def nearest(self, p: tuple) -> tuple:
        ring = unit((p[0], p[1], 0))
        n = unit((p[0] - ring[0], p[1] - ring[1], p[2]))
        return tuple(ring[k] + 0.4 * n[k] for k in range(3)), n, math.inf


class Cylinder:
    def point(self, s: float, t: float) -> tuple:
        return (math.cos(2 * math.pi * s), math.sin(2 * math.pi * s), 2 * t - 1)

    def nearest(self, p: tuple) -> tuple:
        n = unit((p[0], p[1], 0))
        return (n[0], n[1], p[2]), n, math.inf


class Terrain:
    """A part of a sphere, seen from above."""

    def point(self, s: float, t: float) -> tuple:
        x, y = 1.2 * s - 0.6, 1.2 * t - 0.6
        return (x, y, math.sqrt(1 - x * x - y * y))

    nearest = Sphere.nearest


class Cube:
    FACES = [((0, 1, 2), 1), ((0, 1, 2), -1), ((1, 2, 0), 1), ((1, 2, 0), -1), ((2, 0, 1), 1), ((2, 0, 1), -1)]

    def nearest(self, p: tuple) -> tuple:
        k = max(range(3), key=lambda i: abs(p[i]))
        n = tuple(math.copysign(1.0, p[k]) if i == k else 0.0 for i in range(3))
        q = tuple(n[i] if i == k else max(-1.0, min(1.0, p[i])) for i in range(3))
        return q, n, min(1 - abs(q[i]) for i in range(3) if i != k)


def picture(paint) -> bytes:
    """A PNG of paint(u, v), in sRGB; the middle of a pixel is its place."""
    rows = b"".join(
        b"\0" + bytes(round(255 * c) for x in range(PIXELS) for c in paint((x + 0.5) / PIXELS, 1 - (y + 0.5) / PIXELS))
        for y in range(PIXELS))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", PIXELS, PIXELS, 8, 2, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(rows, 1)) + chunk(b"IEND", b""))


class Model:
    """A mesh by its corners: points, normals and UVs of faces, and the material of each."""

    def __init__(self, shape) -> None:
        self.shape = shape
        self.points: list = []
        self.uvs: list = []
        self.faces: list = []  # corners as (point, uv), and a material
        self.materials = {"m": ["map_Kd m.png"]}
        self.pictures: dict = {}
        self.colors = False
        self.flat = False  # the colour is that of the outermost circle of a torus
        self.bend = None  # of a normal texture: the normal's part along increasing u

    def grid(self, n: int, m: int, uv=lambda s, t: (s, t), material=lambda s, t: "m") -> "Model":
        """Of a surface by two parameters; rows of the same point are one vertex."""
        known: dict = {}

        def corner(i: int, j: int) -> tuple:
            p = self.shape.point(i / n, j / m)
            key = tuple(round(x, 9) + 0.0 for x in p)
            if key not in known:
                known[key] = len(self.points)
                self.points.append(p)
            self.uvs.append(uv(i / n, j / m))
            return known[key], len(self.uvs) - 1

        for j in range(m):
            for i in range(n):
                a, b, c, d = corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)
                for face in ((a, b, c), (a, c, d)):
                    if len({v for v, _ in face}) == 3:
                        self.faces.append((face, material((i + 0.5) / n, (j + 0.5) / m)))
        return self

    def write(self, folder: Path) -> Path:
        lines = ["mtllib m.mtl\n"]
        for p in self.points:
            extra = " %.6f %.6f %.6f" % color(p) if self.colors else ""
            lines.append("v %.9f %.9f %.9f%s\n" % (*p, extra))
        lines += ["vt %.9f %.9f\n" % uv for uv in self.uvs]
        normals: dict = {}
        body, last = [], None
        for face, material in self.faces:
            if material != last:
                body.append(f"usemtl {material}\n")
                last = material
            middle = tuple(sum(self.points[v][k] for v, _ in face) / 3 for k in range(3))
            words = []
            for v, t in face:
                p, folds = self.points[v], isinstance(self.shape, Cube)
                if folds:  # of the side of a fold that the face is on
                    p = tuple(0.999 * a + 0.001 * b for a, b in zip(p, middle))
                n = self.shape.nearest(p)[1]
                number = normals.setdefault(n if folds else v, (len(normals) + 1, n))[0]
                words.append(f"{v + 1}/{t + 1}/{number}")
            body.append("f " + " ".join(words) + "\n")
        lines += ["vn %.9f %.9f %.9f\n" % n for _, n in normals.values()]
        (folder / "high.obj").write_text("".join(lines + body))
        library = [line for name, text in self.materials.items() for line in (f"newmtl {name}", *text)]
        (folder / "m.mtl").write_text("\n".join(library) + "\n")
        for name, data in self.pictures.items():
            (folder / name).write_bytes(data)
        return folder / "high.obj"


def sphere_like(shape, n: int, m: int, **options) -> Model:
    model = Model(shape).grid(n, m, **options)
    model.pictures["m.png"] = picture(lambda u, v: color(shape.point(u, v)))
    return model


def cube() -> Model:
    model, n = Model(Cube()), 12
    known: dict = {}
    for f, ((k, a, b), sign) in enumerate(Cube.FACES):
        left, low = (f % 3) / 3, (f // 3) / 2

        def corner(i: int, j: int) -> tuple:
            p = [0.0] * 3
            p[k], p[a], p[b] = sign, 2 * i / n - 1, 2 * j / n - 1
            key = tuple(p)
            if key not in known:
                known[key] = len(model.points)
                model.points.append(key)
            model.uvs.append((left + (0.05 + 0.9 * i / n) / 3, low + (0.05 + 0.9 * j / n) / 2))
            return known[key], len(model.uvs) - 1

        for j in range(n):
            for i in range(n):
                q = corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)
                for face in ((q[0], q[1], q[2]), (q[0], q[2], q[3])):
                    model.faces.append((face if sign > 0 else face[::-1], "m"))

    def paint(u: float, v: float) -> tuple:
        f = min(2, int(3 * u)) + 3 * min(1, int(2 * v))
        (k, a, b), sign = Cube.FACES[f]
        p = [0.0] * 3
        p[k], p[a], p[b] = sign, 2 * (3 * u - f % 3 - 0.05) / 0.9 - 1, 2 * (2 * v - f // 3 - 0.05) / 0.9 - 1
        return color(tuple(p))

    model.pictures["m.png"] = picture(paint)
    return model


def mirrored() -> Model:
    """Both halves, x > 0 and x < 0, have the same UVs."""
    shape = Sphere()
    model = Model(shape).grid(64, 32, uv=lambda s, t: (abs(((s + 0.25) % 1.0 if s < 1 else 0.25) * 2 - 1), t))
    model.pictures["m.png"] = picture(lambda u, v: color(shape.point((u + 1) / 2 - 0.25, v)))
    return model


def repeated() -> Model:
    """The texture repeats three times around; the colour does, too."""
    model = sphere_like(Torus(), 96, 32, uv=lambda s, t: (s, 3 * t))
    model.pictures["m.png"] = picture(lambda u, v: color(Torus().point(u, 0)))
    model.flat = True
    return model


def several() -> Model:
    model = sphere_like(Sphere(), 64, 32, material=lambda s, t: "m" if t < 0.5 else "n")
    model.materials["n"] = ["Pm 1", "Pr 0.25", "map_Kd m.png"]
    return model


def colored() -> Model:
    model = Model(Sphere()).grid(160, 80)
    model.colors, model.materials = True, {"m": ["Kd 1 1 1"]}
    return model


def bent() -> Model:
    model = sphere_like(Cylinder(), 96, 24)
    model.bend = 0.3
    z = math.sqrt(1 - model.bend ** 2)
    model.pictures["n.png"] = picture(lambda u, v: ((1 + model.bend) / 2, 0.5, (1 + z) / 2))
    model.materials["m"].append("norm n.png")
    return model


MODELS = {
    "sphere": lambda: sphere_like(Sphere(), 64, 32),
    "torus": lambda: sphere_like(Torus(), 96, 48),
    "cube": cube,
    "cylinder": lambda: sphere_like(Cylinder(), 96, 24),
    "terrain": lambda: sphere_like(Terrain(), 48, 48),
    "mirrored": mirrored,
    "repeated": repeated,
    "several materials": several,
    "colours of vertices": colored,
    "normal texture": bent,
}


def read_png(path: Path) -> tuple:
    """Width, height and rows of numbers, from 0 to 1, of 8 or 16 bits."""
    data, at, packed = path.read_bytes(), 8, b""
    width = height = channels = depth = 0
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, depth, kind_of = struct.unpack(">IIBB", body[:10])
            channels = {0: 1, 2: 3, 4: 2, 6: 4}[kind_of]
        elif kind == b"IDAT":
            packed += body
        at += size + 12
    step = channels * depth // 8
    raw, before, rows = zlib.decompress(packed), bytes(width * step), []
    for y in range(height):
        begin = y * (width * step + 1)
        kind, line = raw[begin], bytearray(raw[begin + 1:begin + 1 + width * step])
        for i in range(len(line)):
            a, b = line[i - step] if i >= step else 0, before[i]
            c = before[i - step] if i >= step else 0
            nearest = min((a, b, c), key=lambda value: abs(a + b - c - value))
            line[i] = line[i] + (0, a, b, (a + b) // 2, nearest)[kind] & 255
        numbers = struct.unpack(f">{width * channels}H", line) if depth == 16 else line
        values = [number / (2 ** depth - 1) for number in numbers]
        rows.append([tuple(values[i:i + channels]) for i in range(0, len(values), channels)])
        before = bytes(line)
    return width, height, rows


def triangles_of(path: Path) -> list:
    """The corners of the triangles of a GLB, as (position, uv)."""
    data = path.read_bytes()
    size = struct.unpack_from("<I", data, 12)[0]
    gltf, binary = json.loads(data[20:20 + size]), data[28 + size:]

    def read(index: int) -> list:
        accessor = gltf["accessors"][index]
        view = gltf["bufferViews"][accessor["bufferView"]]
        count = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        kind, bytes_of = {5121: ("B", 1), 5123: ("H", 2), 5125: ("I", 4), 5126: ("f", 4)}[accessor["componentType"]]
        stride = view.get("byteStride", count * bytes_of)
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        return [struct.unpack_from(f"<{count}{kind}", binary, start + i * stride) for i in range(accessor["count"])]

    triangles = []
    for mesh in gltf["meshes"]:
        for primitive in mesh["primitives"]:
            points, uvs = read(primitive["attributes"]["POSITION"]), read(primitive["attributes"]["TEXCOORD_0"])
            at = [i for i, in read(primitive["indices"])]
            triangles += [[(points[k], uvs[k]) for k in at[i:i + 3]] for i in range(0, len(at), 3)]
    return triangles


def texels_of(triangles: list):
    """The texels whose centres triangles contain, with their points: (x, y, point)."""
    for corners in triangles:
        t = [(SIDE * uv[0], SIDE * uv[1]) for _, uv in corners]
        area = (t[1][0] - t[0][0]) * (t[2][1] - t[0][1]) - (t[1][1] - t[0][1]) * (t[2][0] - t[0][0])
        if abs(area) < 1e-9:
            continue
        for y in range(max(0, int(min(v for _, v in t))), min(SIDE, int(max(v for _, v in t)) + 1)):
            for x in range(max(0, int(min(u for u, _ in t))), min(SIDE, int(max(u for u, _ in t)) + 1)):
                w = []
                for k in range(3):
                    (bu, bv), (cu, cv) = t[(k + 1) % 3], t[(k + 2) % 3]
                    w.append(((bu - x - 0.5) * (cv - y - 0.5) - (bv - y - 0.5) * (cu - x - 0.5)) / area)
                if min(w) >= 0:
                    yield x, y, tuple(sum(w[k] * corners[k][0][i] for k in range(3)) for i in range(3))


def check(sdm: Path, name: str, samples: int, validator: list) -> str:
    """What is wrong with a model, or ""; prints what was measured."""
    model = MODELS[name]()
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        high = model.write(folder)

        def run(*command: object) -> None:
            subprocess.run([str(c) for c in command], check=True, capture_output=True, text=True, cwd=folder)

        run(sdm, "simplify", high, "--max-deviation", "0.01", "-o", "low.glb")
        channels = "base_color,object_normal,normal"
        run(sdm, "bake", high, "low.glb", "-o", "asset", "--channels", channels, "--resolution", SIDE,
            "--samples", samples)
        report = json.loads((folder / "asset/report.json").read_text())
        colors, normals = (read_png(folder / "asset" / f"{c}.png")[2] for c in ("base_color", "object_normal"))
        levels, angles, wrong, count = 0.0, 0.0, 0, 0
        for x, y, p in texels_of(triangles_of(folder / "asset/baked.glb")):
            q, n, fold = model.shape.nearest(p)
            if fold < 0.03:  # beside a fold, the closest point may be on either side
                continue
            if model.flat:
                ring = unit((q[0], q[1], 0))
                q = tuple(1.4 * c for c in ring)
            if model.bend is not None:
                along = unit((-q[1], q[0], 0))
                n = tuple(model.bend * a + math.sqrt(1 - model.bend ** 2) * b for a, b in zip(along, n))
            baked = unit(tuple(2 * c - 1 for c in normals[y][x]))
            angle = math.degrees(math.acos(max(-1.0, min(1.0, sum(a * b for a, b in zip(baked, n))))))
            levels += sum(abs(255 * (a - b)) for a, b in zip(colors[y][x], color(q))) / 3
            angles += angle
            wrong += angle > 10
            count += 1
        faces = report["low"]["triangles"]
        kind = report["atlas"]["kind"]
        print(f"{name}, {samples} samples: {len(model.faces)} -> {faces} faces, atlas {kind}, {count} texels, "
              f"colour {levels / count:.2f} levels, normals {angles / count:.3f} degrees, {wrong} off by over 10",
              flush=True)
        if validator:
            run_in, script = validator
            glbs = [folder / "low.glb", folder / "asset/baked.glb"]
            said = subprocess.run(["node", script, *glbs], cwd=run_in, capture_output=True, text=True)
            of_low, of_baked = said.stdout.split("low.glb: ")[1].split(f"{glbs[1]}: ")
            lines = of_low.splitlines()[1:] + of_baked.splitlines()[1:]
            if messages := [line for line in lines if not line.strip().startswith(ALLOWED)]:
                return "the validator says:\n" + "\n".join(messages)
            if not of_baked.startswith("0 messages"):
                return f"the validator says of baked.glb: {of_baked}"
        if count < SIDE:
            return f"only {count} texels"
        uses_uvs = name not in ("mirrored", "repeated")
        if (kind == "uv") != uses_uvs:
            return f"has an atlas of kind {kind}: {report['notes']}"
        if levels / count > 1 or angles / count > 0.3 or wrong > 0:
            return "is not as the surface is"
    return ""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sdm", type=Path)
    parser.add_argument("--validator", nargs=2, metavar=("FOLDER", "SCRIPT"))
    parser.add_argument("--only", choices=MODELS)
    options = parser.parse_args()
    faults = [f"{name}, {samples} samples: {fault}" for name in ([options.only] if options.only else MODELS)
              for samples in (1, 4) if (fault := check(options.sdm, name, samples, options.validator))]
    if faults:
        sys.exit("\n".join(faults))


if __name__ == "__main__":
    main()
