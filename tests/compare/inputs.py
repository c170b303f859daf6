"""The files that the cases read: small meshes, clouds and tables, the same in each run."""

import json
import math
import random
import struct
import zlib
from pathlib import Path

Mesh = tuple  # vertices, a list of three numbers each; faces, a list of three indices each


def ball(n: int = 10, radius: float = 1, centre: tuple = (0, 0, 0)) -> Mesh:
    """A closed grid of 4 n (n - 1) faces."""
    vertices, faces = [(0, 0, radius)], []
    for i in range(1, n):
        for j in range(2 * n):
            a, b = math.pi * i / n, math.pi * j / n
            vertices.append((radius * math.sin(a) * math.cos(b), radius * math.sin(a) * math.sin(b), radius * math.cos(a)))
    vertices.append((0, 0, -radius))
    last = len(vertices) - 1
    for j in range(2 * n):
        def at(i: int, j: int) -> int:
            return 1 + (i - 1) * 2 * n + j % (2 * n)
        faces += [(0, at(1, j), at(1, j + 1)), (last, at(n - 1, j + 1), at(n - 1, j))]
        for i in range(1, n - 1):
            faces += [(at(i, j), at(i + 1, j), at(i + 1, j + 1)), (at(i, j), at(i + 1, j + 1), at(i, j + 1))]
    return [tuple(c + d for c, d in zip(centre, v)) for v in vertices], faces


def grid(n: int, size: float, height) -> Mesh:
    """An open square of 2 n² faces, which face up."""
    vertices = [(size * i / n, size * j / n, height(size * i / n, size * j / n)) for i in range(n + 1) for j in range(n + 1)]
    faces = []
    for i in range(n):
        for j in range(n):
            a, b = i * (n + 1) + j, (i + 1) * (n + 1) + j
            faces += [(a, b, b + 1), (a, b + 1, a + 1)]
    return vertices, faces


def plate(n: int, size: float, top, bottom) -> Mesh:
    """A closed plate between two heights."""
    upper, faces = grid(n, size, top)
    lower, _ = grid(n, size, bottom)
    count = len(upper)
    rim = ([i * (n + 1) for i in range(n)] + [n * (n + 1) + j for j in range(n)] + [i * (n + 1) + n for i in range(n, 0, -1)]
           + list(range(n, 0, -1)))
    faces = faces + [(a + count, c + count, b + count) for a, b, c in faces]
    for a, b in zip(rim, rim[1:] + rim[:1]):
        faces += [(b, a, a + count), (b, a + count, b + count)]
    return upper + lower, faces


def box(low: tuple = (0, 0, 0), high: tuple = (1, 1, 1)) -> Mesh:
    """Two faces each of the bottom, the top, the front, the back, the left and the right side."""
    vertices = [tuple((high if i >> k & 1 else low)[k] for k in range(3)) for i in range(8)]
    return vertices, [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4),
                      (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6), (1, 3, 5), (3, 7, 5)]


def joined(*meshes: Mesh) -> Mesh:
    vertices, faces = [], []
    for v, f in meshes:
        faces += [tuple(len(vertices) + k for k in face) for face in f]
        vertices += v
    return vertices, faces


def moved(mesh: Mesh, by: tuple = (0, 0, 0), turn: float = 0, scale: float = 1) -> Mesh:
    """Turned about z, in radians, scaled, then moved."""
    c, s = scale * math.cos(turn), scale * math.sin(turn)
    return [(c * x - s * y + by[0], s * x + c * y + by[1], scale * z + by[2]) for x, y, z in mesh[0]], mesh[1]


def noisy(mesh: Mesh, sigma: float) -> Mesh:
    rng = random.Random(1)
    return [tuple(x + rng.gauss(0, sigma) for x in v) for v in mesh[0]], mesh[1]


def part(mesh: Mesh, keep) -> Mesh:
    """The faces all of whose corners are kept."""
    return mesh[0], [f for f in mesh[1] if all(keep(*mesh[0][k]) for k in f)]


def soup(n: int) -> Mesh:
    rng = random.Random(2)
    vertices = []
    for _ in range(n):
        centre = [rng.uniform(-1, 1) for _ in range(3)]
        vertices += [tuple(x + rng.gauss(0, 0.3) for x in centre) for _ in range(3)]
    return vertices, [(3 * i, 3 * i + 1, 3 * i + 2) for i in range(n)]


def apart(mesh: Mesh) -> Mesh:
    """Each face with corners of its own, moved by little."""
    rng = random.Random(3)
    vertices = [tuple(x + rng.uniform(-1e-6, 1e-6) for x in mesh[0][k]) for f in mesh[1] for k in f]
    return vertices, [(3 * i, 3 * i + 1, 3 * i + 2) for i in range(len(mesh[1]))]


def meshes() -> dict:
    """Those that Python has as arrays, too."""
    def bump(x: float, y: float) -> float:
        return 0.3 * math.exp(-((x - 5) ** 2 + (y - 5) ** 2))

    flat = plate(10, 10, lambda x, y: 0.5, lambda x, y: 0)
    return {
        "ball": ball(),
        "larger": ball(10, 1.05),
        "beside": ball(8, 1, (1.5, 0, 0)),
        "apart": ball(8, 1, (2.5, 0, 0)),
        "inverted": (ball()[0], [(a, c, b) for a, b, c in ball()[1]]),
        "box": box(),
        "box2": moved(box(), (0.02, 0.01, -0.01)),
        "box_inch": moved(box(), scale=1 / 25.4),
        "boxes": joined(box(), box((3, 0, 0), (4, 1, 1)), box((0.5, 0.5, 0.5), (1.5, 1.5, 1.5))),
        "plate": flat,
        "dented": plate(10, 10, lambda x, y: 0.5 - bump(x, y), lambda x, y: 0),
        "bent": plate(10, 10, lambda x, y: 0.5 + 0.004 * x * y, lambda x, y: 0.004 * x * y),
        "ground": grid(10, 10, lambda x, y: 0.2 * math.sin(x) * math.cos(y)),
        "ground2": grid(12, 10, lambda x, y: 0.2 * math.sin(x) * math.cos(y) + bump(x, y)),
        "scan": part(noisy(moved(flat, (0.3, -0.2, 0.1), 0.05), 0.01), lambda x, y, z: x < 8),
        "soup": soup(40),
        "unwelded": apart(box()),
        "specks": joined(ball(), box((3, 3, 3), (3.1, 3.1, 3.1)), box((-3, 0, 0), (-2.9, 0.1, 0.1))),
        "half": part(ball(12), lambda x, y, z: z > -0.1),
        "needle": ([(0, 0, 0), (1, 0, 0), (0.5, 1e-9, 0), (0, 0, 1)], [(0, 1, 2), (0, 1, 3), (0, 0, 3)]),
    }


def ply(mesh: Mesh, colors: bool = False) -> bytes:
    vertices, faces = mesh
    color = "property uchar red\nproperty uchar green\nproperty uchar blue\n" if colors else ""
    head = ("ply\nformat binary_little_endian 1.0\n"
            f"element vertex {len(vertices)}\nproperty double x\nproperty double y\nproperty double z\n{color}"
            f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
    rows = (struct.pack("<3d", *v) + (bytes(int(127.5 + 127 * max(-1, min(1, x))) for x in v) if colors else b"") for v in vertices)
    return head.encode() + b"".join(rows) + b"".join(struct.pack("<B3i", 3, *f) for f in faces)


def stl(mesh: Mesh) -> bytes:
    return bytes(80) + struct.pack("<I", len(mesh[1])) + b"".join(
        struct.pack("<12fH", 0, 0, 0, *(x for k in f for x in mesh[0][k]), 0) for f in mesh[1])


def off(mesh: Mesh) -> str:
    rows = [" ".join(map(repr, v)) for v in mesh[0]] + [" ".join(map(str, (3, *f))) for f in mesh[1]]
    return f"OFF\n{len(mesh[0])} {len(mesh[1])} 0\n" + "\n".join(rows) + "\n"


SIDES = ["bottom", "top", "front", "back", "left", "right"]


def named_box(tile: int = 0, whole: bool = False) -> str:
    """A box in OBJ with groups and materials; with `tile`, its right side's texture is in the tile beside the first one; with
    `whole`, each side has all of the texture."""
    vertices, faces = box()
    lines = ["mtllib named.mtl", "o crate"] + [f"v {x} {y} {z}" for x, y, z in vertices]
    for side in range(6):
        for face in faces[2 * side:2 * side + 2]:
            for k in face:
                uv = [vertices[k][a] for a in range(3) if a != (2, 1, 0)[side // 2]]
                u, v = uv if whole else (0.05 + 0.3 * (side % 3) + 0.25 * uv[0], 0.05 + 0.5 * (side // 3) + 0.4 * uv[1])
                lines.append(f"vt {u + (tile if side == 5 else 0)} {v}")
    for side, name in enumerate(SIDES):
        lines += [f"g {name}", f"usemtl {'red' if side % 2 else 'blue'}"]
        for number in (2 * side, 2 * side + 1):
            lines.append("f " + " ".join(f"{k + 1}/{3 * number + c + 1}" for c, k in enumerate(faces[number])))
    return "\n".join(lines) + "\n"


def picture(n: int) -> bytes:
    """A chequered PNG of n x n pixels."""
    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    rows = b"".join(b"\0" + bytes(c for x in range(n) for c in ((255, 40, 8 * y % 256) if (x // 4 + y // 4) % 2 else (20, 8 * x % 256, 200)))
                    for y in range(n))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", n, n, 8, 2, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def glb(mesh: Mesh, moves: tuple = ()) -> bytes:
    """With a texture, and an animation by morph targets if the vertices move."""
    vertices, faces = mesh
    blocks = [b"".join(struct.pack("<3f", *v) for v in vertices),
              b"".join(struct.pack("<2f", 0.5 + x / 4, 0.5 + y / 4) for x, y, _ in vertices),
              b"".join(struct.pack("<3I", *f) for f in faces), picture(32)]
    accessors = [{"bufferView": 0, "componentType": 5126, "count": len(vertices), "type": "VEC3",
                  "min": [min(v[k] for v in vertices) for k in range(3)], "max": [max(v[k] for v in vertices) for k in range(3)]},
                 {"bufferView": 1, "componentType": 5126, "count": len(vertices), "type": "VEC2"},
                 {"bufferView": 2, "componentType": 5125, "count": 3 * len(faces), "type": "SCALAR"}]
    primitive = {"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}
    model = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "name": "thing"}],
             "materials": [{"name": "chequered", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "roughnessFactor": 0.6}}],
             "textures": [{"source": 0}], "images": [{"bufferView": 3, "mimeType": "image/png"}]}
    if moves:
        blocks += [b"".join(struct.pack("<3f", *m) for m in moves), struct.pack("<4f", 0, 0.5, 1, 1.5), struct.pack("<4f", 0, 1, 0.5, 0)]
        accessors += [{"bufferView": 4, "componentType": 5126, "count": len(moves), "type": "VEC3", "min": [-9] * 3, "max": [9] * 3},
                      {"bufferView": 5, "componentType": 5126, "count": 4, "type": "SCALAR", "min": [0], "max": [1.5]},
                      {"bufferView": 6, "componentType": 5126, "count": 4, "type": "SCALAR"}]
        primitive["targets"] = [{"POSITION": 3}]
        model["animations"] = [{"samplers": [{"input": 4, "output": 5}], "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}]}]
    views, data = [], b""
    for block in blocks:
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(block)})
        data += block + bytes(-len(block) % 4)
    model |= {"meshes": [{"name": "thing", "primitives": [primitive]}], "accessors": accessors, "bufferViews": views,
              "buffers": [{"byteLength": len(data)}]}
    text = json.dumps(model).encode()
    text += b" " * (-len(text) % 4)
    return (struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(data)) + struct.pack("<I4s", len(text), b"JSON") + text
            + struct.pack("<I4s", len(data), b"BIN\0") + data)


def npy(frames: list) -> bytes:
    """Positions of shape (frames, vertices, 3)."""
    head = repr({"descr": "<f8", "fortran_order": False, "shape": (len(frames), len(frames[0]), 3)}).encode()
    head += b" " * (-(len(head) + 11) % 64) + b"\n"
    return b"\x93NUMPY\1\0" + struct.pack("<H", len(head)) + head + b"".join(struct.pack("<3d", *v) for f in frames for v in f)


def texts(made: dict) -> dict:
    """The files of text: clouds, tables, poses, and files that are wrong."""
    cloud = [tuple(1.01 * x for x in v) for v in ball(6)[0]]
    identity = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"
    return {
        "cloud.xyz": "".join(f"{x} {y} {z} {x} {y} {z}\n" for x, y, z in cloud),
        "cloud.csv": "x,y,z\n" + "".join(f"{x},{y},{z}\n" for x, y, z in cloud),
        "comma.csv": "id;x;y;z\n" + "".join(f"{i};{x};{y};{z}\n".replace(".", ",") for i, (x, y, z) in enumerate(cloud)),
        "odd.csv": "1,2,3\n4,x,6\n",
        "named.obj": named_box(),
        "tiles.obj": named_box(tile=1),
        "overlap.obj": named_box(whole=True),
        "named.mtl": "newmtl red\nKd 0.8 0.1 0.1\nnewmtl blue\nKd 0.1 0.1 0.8\nNs 20\n",
        "ball.off": off(made["ball"]),
        "table.csv": "group,lower,upper\ntop,-0.1,0.1\nright,,0.05\nleft,-0.001,0.001\n",
        "table.json": json.dumps([{"group": "top", "lower": -0.1, "upper": 0.1}, {"group": "red", "upper": 0.3}]),
        "table_semicolon.csv": "group;lower;upper\ntop;-0,1;0,1\n",
        "table_unknown.csv": "group,lower,upper\nlid,-0.1,0.1\n",
        "matrix.txt": "1 0 0 0.1\n0 1 0 0.2\n0 0 1 0.3\n0 0 0 1\n",
        "mirror.txt": identity.replace("1", "-1", 1),
        "flat.txt": identity.replace("1", "0", 1),
        "six.txt": "0.02 0.01 -0.01  0 0 0\n1.02 0.01 -0.01  1 0 0\n0.02 1.01 -0.01  0 1 0\n"
                   "0.02 0.01 0.99  0 0 1\n1.02 0.01 0.99  1 0 1\n0.02 1.01 0.99  0 1 1\n",
        "poses.txt": "0 0 0 1 0 0 0\n0.9 0.1 0 1 0 0 0\n3 0 0 0.9 0.1 0.2 0\n",
        "index.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n",
        "nan.obj": "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
        "empty.obj": "",
        "no_area.obj": "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n",
        "unknown.xyzzy": "this is no mesh\n",
        "required.gltf": '{"asset": {"version": "2.0"}, "extensionsRequired": ["EXT_nothing"]}',
    }


def write_inputs(folder: Path) -> None:
    made = meshes()
    folder.mkdir()
    for name, mesh in made.items():
        (folder / f"{name}.ply").write_bytes(ply(mesh))
    for name, text in texts(made).items():
        (folder / name).write_text(text, encoding="utf-8")
    (folder / "colors.ply").write_bytes(ply(ball(), colors=True))
    (folder / "ball.stl").write_bytes(stl(made["ball"]))
    (folder / "textured.glb").write_bytes(glb(made["ball"]))
    (folder / "animated.glb").write_bytes(glb(made["ball"], tuple((0.5, 0, 0.2 * z) for _, _, z in made["ball"][0])))
    (folder / "cut.ply").write_bytes(ply(made["ball"])[:2000])
    frames = [moved(made["ball"], (0.3 * t, 0, 0.1 * t))[0] for t in range(4)]
    (folder / "motion.npy").write_bytes(npy(frames))
    (folder / "walk").mkdir()
    (folder / "tear").mkdir()
    for t, frame in enumerate(frames):
        (folder / "walk" / f"{t:04}.ply").write_bytes(ply((frame, made["ball"][1])))
        (folder / "tear" / f"{t:04}.ply").write_bytes(ply((frame, made["ball"][1][:len(made["ball"][1]) - 8 * t])))
