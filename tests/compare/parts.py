"""The parts of files that are packed: what they hold is recorded, not how it was compressed, which may differ from run to run."""

import hashlib
import json
import struct
import zlib


def digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:16]


def png(data: bytes) -> dict:
    """Size, kind of pixels, and a hash of these with their filters."""
    width, height, bits, kind = struct.unpack_from(">IIBB", data, 16)
    packed, at = b"", 8
    while at < len(data):
        length, name = struct.unpack_from(">I4s", data, at)
        if name == b"IDAT":
            packed += data[at + 8:at + 8 + length]
        at += 12 + length
    return {"size": [width, height], "bits": bits, "kind": kind, "pixels": digest(zlib.decompress(packed))}


def unpacked(block: bytes) -> bytes:
    """What is in a block of an EXR file, which is not compressed where that saves nothing."""
    try:
        return zlib.decompress(block)
    except zlib.error:
        return block


def exr(data: bytes) -> dict:
    """The attributes of a file of one part, and a hash of its blocks of scanlines."""
    at, attributes = 8, {}
    while data[at]:
        name, kind = data[at:].split(b"\0", 2)[:2]
        at += len(name) + len(kind) + 2
        length, = struct.unpack_from("<I", data, at)
        attributes[name.decode()] = data[at + 4:at + 4 + length]
        at += 4 + length
    first, = struct.unpack_from("<Q", data, at + 1)
    hashed, at = hashlib.sha256(), first
    while at < len(data):
        row, length = struct.unpack_from("<iI", data, at)
        hashed.update(struct.pack("<i", row) + unpacked(data[at + 8:at + 8 + length]))
        at += 8 + length
    return {"attributes": {name: digest(value) for name, value in attributes.items()}, "values": hashed.hexdigest()[:16]}


def glb(data: bytes) -> tuple:
    """The JSON, and what each bufferView holds."""
    length, = struct.unpack_from("<I", data, 12)
    model, binary = json.loads(data[20:20 + length]), data[28 + length:]
    views = []
    for view in model.get("bufferViews", []):
        part = binary[view.get("byteOffset", 0):][:view["byteLength"]]
        views.append(png(part) if part.startswith(b"\x89PNG") else digest(part))
        if part.startswith(b"\x89PNG"):  # the others lie behind it
            model["bufferViews"] = model["buffers"] = "of packed sizes"
    return model, views


def npy(data: bytes) -> dict:
    length, = struct.unpack_from("<H", data, 8)
    return {"header": data[10:10 + length].decode().strip(), "values": digest(data[10 + length:])}


def base85(text: str) -> bytes:
    """The bytes of base85() in src/io/page/report/packed_arrays.h."""
    codes = [ord(c) - (36 if c > "<" else 35) for c in text.strip()]
    groups = (codes[i:i + 5] for i in range(0, len(codes), 5))
    return b"".join(struct.pack(">I", ((((a * 85 + b) * 85 + c) * 85 + d) * 85 + e)) for a, b, c, d, e in groups)


def arrays(index: dict, text: str) -> dict:
    """Those of a page, each with its count and a hash of the planes of its bytes."""
    data, at, found = base85(text), 0, {}
    for name, array in index.items():
        planes = b""
        for length in array["bytes"]:
            planes += zlib.decompress(data[at:at + length], -15) if length else b""
            at += length
        found[name] = {"count": array["count"], "planes": digest(planes)}
    return found
