#!/usr/bin/env python3
"""Random materials of OBJ and glTF against what they mean.

Makes a row of squares, each with a material, texture coordinates and pictures at random, bakes it onto a plain strip,
and compares the colour of each square, and the notes, with those that this script works out by itself from the
formats: a colour that a file names is baked, or a note says that it is left out.
  tests/materials.py SDM [--cases N] [--first SEED]
"""

import base64
import json
import math
import random
import struct
import subprocess
import tempfile
import zlib
from pathlib import Path

import random_cases

SIDE = 16  # texels of a square
PIXELS = 4  # of a picture, along each side; the left half has one colour, the right half another


def chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(left: tuple, right: tuple) -> bytes:
    row = b"\0" + (bytes(left) * (PIXELS // 2)) + (bytes(right) * (PIXELS // 2))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", PIXELS, PIXELS, 8, 2, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(row * PIXELS)) + chunk(b"IEND", b""))


def pixels(path: Path) -> list:
    """The rows of a PNG of 8 bits without interlacing, each a list of pixels."""
    data, at, packed = path.read_bytes(), 8, b""
    width = height = channels = 0
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, depth, color = struct.unpack(">IIBB", body[:10])
            assert depth == 8
            channels = {0: 1, 2: 3, 4: 2, 6: 4}[color]
        elif kind == b"IDAT":
            packed += body
        at += size + 12
    raw, before, rows = zlib.decompress(packed), bytes(width * channels), []
    for y in range(height):
        begin = y * (width * channels + 1)
        kind, line = raw[begin], bytearray(raw[begin + 1:begin + 1 + width * channels])
        for i in range(len(line)):
            a, b = line[i - channels] if i >= channels else 0, before[i]
            c = before[i - channels] if i >= channels else 0
            nearest = min((a, b, c), key=lambda value: abs(a + b - c - value))
            line[i] = line[i] + (0, a, b, (a + b) // 2, nearest)[kind] & 255
        rows.append([tuple(line[x * channels:(x + 1) * channels]) for x in range(width)])
        before = bytes(line)
    return rows


def linear(srgb: float) -> float:
    return srgb / 12.92 if srgb <= 0.04045 else ((srgb + 0.055) / 1.055) ** 2.4


def srgb(light: float) -> float:
    return light * 12.92 if light <= 0.0031308 else 1.055 * light ** (1 / 2.4) - 0.055


def metal_color(diffuse: tuple, specular: list) -> tuple:
    """The base colour of KHR_materials_pbrSpecularGlossiness: metal m solves
    m² r + m (brightness of diffuse (1 - max) / (1 - r) + brightness of specular - 2 r) + r - brightness of specular = 0
    with r = 0.04, what others reflect."""
    r, rest = 0.04, 1 - max(specular)
    bright = [math.sqrt(0.299 * c[0] ** 2 + 0.587 * c[1] ** 2 + 0.114 * c[2] ** 2) for c in (diffuse, specular)]
    b, c = bright[0] * rest / (1 - r) + bright[1] - 2 * r, r - bright[1]
    m = 0.0 if bright[1] < r else min(1.0, max(0.0, (math.sqrt(b * b - 4 * r * c) - b) / (2 * r)))
    scattered = [d * rest / (1 - r) / max(1 - m, 1e-6) for d in diffuse]
    reflected = [(s - r * (1 - m)) / max(m, 1e-6) for s in specular]
    return tuple(min(1.0, max(0.0, a + m * m * (e - a))) for a, e in zip(scattered, reflected))


class Picture:
    def __init__(self, dice: random.Random) -> None:
        self.halves = [tuple(dice.randrange(256) for _ in range(3)) for _ in range(2)]

    def bytes(self) -> bytes:
        return png(*self.halves)

    def light(self, u: float, clamp: bool) -> tuple:
        """At the middle of a pixel, or halfway between two; in linear light."""
        def column(x: int) -> tuple:
            x = min(max(x, 0), PIXELS - 1) if clamp else x % PIXELS
            return tuple(linear(c / 255) for c in self.halves[x >= PIXELS // 2])

        x = u * PIXELS - 0.5
        share = x - math.floor(x)
        return tuple((1 - share) * a + share * b for a, b in zip(column(math.floor(x)), column(math.floor(x) + 1)))


def coordinate(dice: random.Random) -> float:
    """In the middle of a pixel, or on the right edge."""
    return 1.0 if dice.random() < 0.2 else (dice.randrange(PIXELS) + 0.5) / PIXELS


def first_of(names: list) -> list:
    """What notes have of many names."""
    return names[:3] + ([f"and {len(names) - 3} more"] if len(names) > 3 else [])


class Case:
    """The files of HIGH, and what is expected of it."""

    def __init__(self, folder: Path, dice: random.Random) -> None:
        self.folder, self.dice = folder, dice
        self.squares = dice.randrange(2, 7)
        self.light: list = []  # of each square, in linear light
        self.opacity: list = []  # likewise
        self.notes: list = []  # a set of texts that one note has, each
        self.refused = None  # a text of the error
        self.file = folder

    def expect(self, *texts: str) -> None:
        if set(texts) not in self.notes:
            self.notes.append(set(texts))


class Obj(Case):
    def __init__(self, folder: Path, dice: random.Random) -> None:
        super().__init__(folder, dice)
        self.file = folder / "high.obj"
        self.materials: dict = {}
        self.replaced: list = []  # materials whose Kd a picture replaces
        self.unread: dict = {}
        (folder / "t.png").write_bytes((picture := Picture(dice)).bytes())
        self.picture = picture
        libraries = [f"{'abc'[k]}{dice.choice(['', ' b', '_x'])}.mtl" for k in range(dice.randrange(1, 4))]
        for k, library in enumerate(libraries):
            (folder / library).write_text("".join(self.material(f"m{k}{i}") for i in range(dice.randrange(1, 4))))
        lost = dice.random() < 0.25
        if lost:
            libraries.insert(dice.randrange(len(libraries) + 1), "gone.mtl")
            self.expect("the materials of gone.mtl are left out")
        # Names with blanks stand alone on their lines.
        if any(" " in library for library in libraries) or dice.random() < 0.5:
            lines = [f"mtllib {library}\n" for library in libraries]
        else:
            lines = [f"mtllib {' '.join(libraries)}\n"]
        self.write("".join(lines), lost)

    def material(self, name: str) -> str:
        dice, statements = self.dice, []
        m = {"color": (1.0, 1.0, 1.0), "use": None, "opacity": 1.0}
        color = tuple(dice.choice([0, 1, round(dice.random(), 3)]) for _ in range(3))
        if (has_color := dice.random() < 0.7):
            statements.append("Kd " + " ".join(map(str, color)))
            m["color"] = tuple(map(linear, color))
        kind = dice.choice(["none", "none", "picture", "picture", "gone", "outside"])
        if kind == "picture":
            scale, offset, clamp = dice.choice([1, 2, 0.5]), dice.choice([0, 0.25]), dice.random() < 0.3
            place = ("" if scale == 1 else f"-s {scale} 1 1 ") + ("" if offset == 0 else f"-o {offset} 0 ")
            statements.append("map_Kd " + place + ("-clamp on " if clamp else "") + dice.choice(["t.png", "./t.png"]))
            m["color"], m["use"] = (1.0, 1.0, 1.0), (scale, offset, clamp)
            if has_color and color != (1, 1, 1):
                self.replaced.append(name)
        elif kind == "gone":
            statements.append("map_Kd gone.png")
            self.unread.setdefault("map_Kd", []).append((name, "gone.png"))
        elif kind == "outside":
            statements.append("map_Kd ../outside.png")
            self.unread.setdefault("map_Kd", []).append((name, "is refused"))
        for unread in ("map_d", "map_Pr", "map_Pm", "bump", "disp"):
            if dice.random() < 0.1:
                statements.append(f"{unread} t.png")
                self.unread.setdefault(unread, []).append((name, unread))
        if dice.random() < 0.2:
            m["opacity"] = round(dice.random(), 2)
            statements.append(dice.choice([f"d {m['opacity']}", f"Tr {1 - m['opacity']:.2f}"]))
        statements += [line for line in ("Ns 10", "illum 2", "Pr 0.5", "Ks 1 1 1") if dice.random() < 0.3]
        dice.shuffle(statements)
        self.materials[name] = m
        return f"newmtl {name}\n" + "".join(f"{dice.choice(['', chr(9)])}{line}\n" for line in statements)

    def write(self, head: str, lost: bool) -> None:
        dice, text, uvs, unknown = self.dice, [head], 0, []
        bare: dict = {}
        for i in range(self.squares):
            text.append("".join(f"v {x} {y} 0\n" for x, y in ((i, 0), (i + 1, 0), (i + 1, 1), (i, 1))))
            name = dice.choice([*self.materials, *self.materials, None if i == 0 else "same", "nobody"])
            if name == "same":
                name = self.names[-1]
            elif name is not None:
                text.append(f"usemtl {name}\n")
            self.names = [*getattr(self, "names", []), name]
            m = self.materials.get(name, {"color": (1.0, 1.0, 1.0), "use": None, "opacity": 1.0})
            if name == "nobody":
                unknown.append(name)
            u = coordinate(dice) if dice.random() < 0.75 else None
            corners = [str(4 * i + k + 1) for k in range(4)]
            light = m["color"]
            if u is not None:
                target = u
                if m["use"] is not None:
                    scale, offset, clamp = m["use"]
                    u = (target - offset) / scale
                    light = self.picture.light(target, clamp)
                text.append(f"vt {u} 0.375\n")
                uvs += 1
                corners = [f"{c}/{uvs}" for c in corners]
            elif m["use"] is not None:
                bare[name] = bare.get(name, 0) + 2
            self.light.append(light)
            self.opacity.append(m["opacity"])
            text.append(f"f {' '.join(corners)}\n")
        self.file.write_text("".join(text))
        for name, count in bare.items():
            self.expect(f"textures of {name} are left out on {count} faces without texture coordinates")
        if unknown and not lost:
            self.expect("no MTL file has the material nobody")
        if self.replaced:
            self.expect("Kd of ", "the picture of map_Kd replaces it", *first_of(self.replaced))
        for statement, uses in self.unread.items():
            for fault in {fault for _, fault in uses}:
                self.expect(f"{statement} of ", fault, *first_of([name for name, other in uses if other == fault]))


class Gltf(Case):
    def __init__(self, folder: Path, dice: random.Random) -> None:
        super().__init__(folder, dice)
        self.file = folder / "high.gltf"
        self.data, self.views, self.accessors = b"", [], []
        self.pictures = [Picture(dice) for _ in range(2)]
        (folder / "own.png").write_bytes(self.pictures[0].bytes())
        embedded = "data:image/png;base64," + base64.b64encode(self.pictures[1].bytes()).decode()
        self.textures: list = []  # a picture, or a text of the note in its place
        images = [{"uri": "own.png"}, {"uri": embedded}, {"uri": "gone.png"}]
        textures = []
        for _ in range(dice.randrange(1, 5)):
            image = dice.randrange(3)
            kind = dice.choice(["image", "image", "image", "basis", "none"])
            clamp = dice.random() < 0.3
            texture = {"sampler": 0} if clamp else {}
            if kind == "image":
                textures.append({"source": image, **texture})
                self.textures.append((self.pictures[image], clamp) if image < 2 else "gone.png")
            elif kind == "basis":
                textures.append({"extensions": {"KHR_texture_basisu": {"source": image}}})
                self.textures.append("KHR_texture_basisu")
            else:
                textures.append(texture)
                self.textures.append("it has no picture")
        self.left_out: dict = {}  # by the fault: the uses
        self.glossy: dict = {}
        self.materials: list = []
        materials = [self.material(f"m{i}") for i in range(dice.randrange(1, 5))]
        primitives = self.primitives()
        gltf = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                "meshes": [{"primitives": primitives}], "materials": materials, "textures": textures, "images": images,
                "samplers": [{"wrapS": 33071}], "bufferViews": self.views, "accessors": self.accessors,
                "buffers": [{"byteLength": len(self.data),
                             "uri": "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()}]}
        self.file.write_text(json.dumps(gltf))
        for (texture, fault), uses in self.left_out.items():
            self.expect(f"the {texture} of", fault, *first_of(uses))
        for unread, uses in self.glossy.items():
            self.expect(unread, "KHR_materials_pbrSpecularGlossiness", *first_of(uses))

    def use(self, name: str, material: str) -> tuple:
        """A texture of a material as JSON, and as (picture, clamp, set, transform), None where it is left out."""
        dice, index = self.dice, self.dice.randrange(len(self.textures) + (self.dice.random() < 0.1))
        info: dict = {"index": index}
        uv_set = dice.choice([0, 0, 0, 1, 2])
        if uv_set or dice.random() < 0.3:
            info["texCoord"] = uv_set
        transform = (1, 1, 0, 0, 0)
        if dice.random() < 0.4:
            transform = (dice.choice([1, 2, 0.5]), dice.choice([1, 0.5]), dice.choice([0, 0, math.pi / 2]),
                         dice.choice([0, 0.25]), dice.choice([0, 0.5]))
            extension = {"scale": transform[:2], "rotation": transform[2], "offset": transform[3:]}
            if dice.random() < 0.3:
                extension["texCoord"] = uv_set = dice.choice([0, 1])
            info["extensions"] = {"KHR_texture_transform": extension}
        if index >= len(self.textures):
            fault = f"item {index} of textures is referred to but does not exist"
        elif isinstance(self.textures[index], str):
            fault = self.textures[index]
        else:
            return info, (*self.textures[index], uv_set, transform)
        self.left_out.setdefault((name, fault), []).append(material)
        return info, None

    def material(self, name: str) -> dict:
        dice, item = self.dice, {"name": name}
        factor = [round(dice.random(), 3) for _ in range(3)] + [dice.choice([1, 1, round(dice.random(), 2)])]
        if (is_blended := dice.random() < 0.3):
            item["alphaMode"] = "BLEND"
        core, glossy = dice.choice([(True, False), (True, False), (False, True), (True, True), (False, False)])
        m = {"name": name, "factor": (1.0, 1.0, 1.0), "use": None, "opacity": 1.0}

        def surface(color: str, texture: str, read: bool) -> dict:
            surface = {}
            if dice.random() < 0.6:
                surface[color] = factor
                if read:
                    m["factor"] = tuple(factor[:3])
                    m["opacity"] = factor[3] if is_blended else 1.0
            if dice.random() < 0.6:
                if read:
                    surface[texture], m["use"] = self.use(texture, name)
                else:
                    surface[texture] = {"index": 0}
            return surface

        if core:
            item["pbrMetallicRoughness"] = surface("baseColorFactor", "baseColorTexture", True)
        if glossy:
            extension = surface("diffuseFactor", "diffuseTexture", not core)
            if (picture := dice.random() < 0.3):
                extension["specularGlossinessTexture"] = {"index": 0}
            item["extensions"] = {"KHR_materials_pbrSpecularGlossiness": extension}
            if "diffuseTexture" not in extension and not picture:
                extension["specularFactor"] = specular = [round(dice.random() ** 2, 3) for _ in range(3)]
                if not core:
                    m["factor"] = metal_color(m["factor"], specular)
            elif not core:
                unread = "the picture of specular colour and glossiness of" if picture else "the specular colour of"
                self.glossy.setdefault(unread, []).append(name)
        self.materials.append(m)
        return item

    def accessor(self, rows: list) -> int:
        packed = b"".join(struct.pack(f"<{len(row)}f", *row) for row in rows)
        self.views.append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(packed)})
        self.data += packed
        accessor = {"bufferView": len(self.views) - 1, "componentType": 5126, "count": len(rows),
                    "type": {2: "VEC2", 3: "VEC3"}[len(rows[0])]}
        if len(rows[0]) == 3:
            accessor |= {"min": [min(column) for column in zip(*rows)], "max": [max(column) for column in zip(*rows)]}
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def primitives(self) -> list:
        dice, all_of, bare = self.dice, [], {}
        for i in range(self.squares):
            corners = [(i, 0), (i + 1, 0), (i + 1, 1), (i, 0), (i + 1, 1), (i, 1)]
            primitive: dict = {"attributes": {"POSITION": self.accessor([(x, y, 0.0) for x, y in corners])}}
            number = dice.randrange(-1, len(self.materials))
            m = {"factor": (1.0, 1.0, 1.0), "use": None, "name": "", "opacity": 1.0}
            if number >= 0:
                primitive["material"], m = number, self.materials[number]
            used = m["use"][2] if m["use"] else 0
            light = m["factor"]
            for uv_set in range(2 if dice.random() < 0.5 else 1):
                if uv_set == 0 and dice.random() < 0.2:
                    break
                u, v = coordinate(dice), (dice.randrange(PIXELS) + 0.5) / PIXELS
                if uv_set == used and m["use"]:
                    picture, clamp, _, (sx, sy, angle, ox, oy) = m["use"]
                    c, s, x, y = math.cos(angle), math.sin(angle), u - ox, v - oy
                    texel = picture.light(u, clamp)
                    u, v = (c * x - s * y) / sx, (s * x + c * y) / sy  # what the transform leads to the texel
                    light = tuple(a * b for a, b in zip(m["factor"], texel))
                primitive["attributes"][f"TEXCOORD_{uv_set}"] = self.accessor([(u, v)] * 6)
            if m["use"] and f"TEXCOORD_{used}" not in primitive["attributes"]:
                bare[m["name"], used] = bare.get((m["name"], used), 0) + 2
            self.light.append(light)
            self.opacity.append(m["opacity"])
            all_of.append(primitive)
        for (name, uv_set), count in bare.items():
            self.expect(f"textures of {name} are left out on {count} faces without texture coordinates"
                        + (f" of set {uv_set}" if uv_set else ""))
        return all_of


def strip(path: Path, squares: int, edge: bool) -> Path:
    """LOW: one rectangle that fills its texture, and perhaps a face beside it whose corners are all at u = 1."""
    text = f"v 0 0 0\nv {squares} 0 0\nv {squares} 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n"
    if edge:
        text += f"v {squares} 0.5 0\nf 2/2 3/3 5/2\n"
    path.write_text(text)
    return path


MAY_BE = "all texture coordinates are the same"


def check(sdm: Path, seed: int) -> str:
    """What is wrong, or nothing."""
    dice = random.Random(seed)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "in").mkdir()
        case = (Obj if dice.random() < 0.5 else Gltf)(folder / "in", dice)
        low = strip(folder / "low.obj", case.squares, dice.random() < 0.3)
        call = [sdm, "bake", case.file, low, "-o", folder / "out", "--channels", "base_color", "--atlas",
                "uv" if dice.random() < 0.5 else "auto", "--resolution", f"{SIDE * case.squares}x{SIDE}", "--no-page", "--json"]
        run = subprocess.run(call, capture_output=True, text=True, check=False)
        if run.returncode != 0:
            return f"ended with {run.returncode}: {run.stderr}"
        notes = json.loads(run.stdout)["notes"]
        for note in notes:
            if MAY_BE not in note and not any(all(text in note for text in texts) for texts in case.notes):
                return f"has the note '{note}', but none is expected but {case.notes}"
        for texts in case.notes:
            if not any(all(text in note for text in texts) for note in notes):
                return f"lacks a note of {texts}: {notes}"
        image = pixels(folder / "out" / "base_color.png")
        for i, (light, opacity) in enumerate(zip(case.light, case.opacity)):
            found = image[SIDE // 2][SIDE * i + SIDE // 2]
            expected = [*(255 * srgb(c) for c in light), 255 * opacity]
            if any(abs(a - b) > 1 for a, b in zip([*found, 255][:4], expected)):
                return f"square {i} is {found}, not {[round(c) for c in expected]}"
    return ""


if __name__ == "__main__":
    random_cases.run("cases of materials", __doc__, check)
