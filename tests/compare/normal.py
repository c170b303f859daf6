"""What of a result is recorded: numbers and texts without times, versions, paths and dates, and files by their parts."""

import csv
import io
import json
import re
import struct
import zlib
from pathlib import Path

import parts
from parts import digest

# Keys whose values differ from run to run, with the number of threads, or from commit to commit without a meaning.
LEFT_OUT = {"time_ms", "working_bytes", "version", "date", "generator"}
# Texts up to so many characters are recorded as they are.
LONGEST = 4000
# A list of files with their sizes and checksums: the files are recorded themselves.
LIST_OF_FILES = ".sdm-files.json"
# What reading a file raises that is damaged or of another format. ValueError: also of JSON and of text.
UNREADABLE = (ValueError, KeyError, IndexError, TypeError, struct.error, zlib.error)
# Files of `sdm sequence` that show or contain times.
WITH_TIMES = ("plot.png", "resume.state")


class Normal:
    """folder: in which the results were made. paths: others that texts may name, and what stands for them."""

    def __init__(self, folder: Path, paths: dict) -> None:
        self.folder = folder
        self.paths = sorted({f"{folder}/": "", str(folder): ".", **paths}.items(), key=lambda item: -len(item[0]))

    def text(self, text: str) -> str:
        for path, name in self.paths:
            text = text.replace(path, name)
        text = re.sub(r"\b\d+(\.\d+)?(e[-+]?\d+)? (ms|s|seconds)\b", r"# \3", text)
        text = re.sub(r"(?<=\(median\): ).*", "#", text)
        return re.sub(r"\b0x[0-9a-f]{6,}\b", "0x#", text)

    def value(self, value: object) -> object:
        """Of JSON. Strings that hold a page are replaced by its parts, and {"written": name} by those of the file."""
        if isinstance(value, dict):
            if value.keys() == {"written"}:
                return self.file(self.folder / value["written"])
            return {key: self.value(v) for key, v in value.items() if key not in LEFT_OUT}
        if isinstance(value, list):
            return [self.value(v) for v in value]
        if isinstance(value, str):
            return self.page(value) if value.startswith("<!DOCTYPE html") else self.long(self.text(value))
        return value

    def long(self, text: str) -> object:
        return text if len(text) <= LONGEST else {"characters": len(text), "hash": digest(text.encode())}

    def output(self, text: str) -> object:
        """Of stdout or stderr: JSON, JSON lines, or the lines of a text."""
        for pieces in ([text], text.splitlines()):
            try:
                values = [self.value(json.loads(piece)) for piece in pieces]
                if values and all(isinstance(value, (dict, list)) for value in values):
                    return values[0] if len(values) == 1 else values
            except ValueError:
                pass
        return self.text(text).splitlines()

    def page(self, text: str) -> dict:
        """The data of a page, and a hash of its program and style."""
        found: dict = {}

        def taken(match: "re.Match") -> str:
            kind, name, content = match.groups()
            found[name] = json.loads(content) if kind == "application/json" else content
            return ""

        rest = re.sub(r'<script type="(application/json|text/plain)" id="([^"]*)">(.*?)</script>', taken, text, flags=re.DOTALL)
        try:
            if "arrays" in found:
                found["arrays"] = parts.arrays(found["page"].pop("arrays"), found["arrays"])
            for name, picture in found.get("page", {}).get("pictures", {}).items():
                found["page"]["pictures"][name] = parts.png(parts.base85(picture["text"])[:picture["bytes"]])
        except UNREADABLE as error:
            found["unreadable"] = str(error)
        return {"data": self.value(found), "program": digest(self.text(rest).encode())}

    def file(self, path: Path) -> object:
        """The parts of a file; of one that is not as its name says, a hash."""
        data = path.read_bytes()
        try:
            return self.parts_of_file(path, data)
        except UNREADABLE as error:
            return {"bytes": len(data), "hash": digest(data), "unreadable": str(error)}

    def parts_of_file(self, path: Path, data: bytes) -> object:
        suffix = path.suffix
        if path.name in WITH_TIMES:
            return "has times"
        if suffix == ".json":
            return self.value(json.loads(data))
        if suffix == ".jsonl":
            return [self.value(json.loads(line)) for line in data.decode().splitlines()]
        if suffix == ".html":
            return self.page(data.decode())
        if suffix == ".csv":
            rows = list(csv.reader(io.StringIO(data.decode())))
            kept = [k for k, name in enumerate(rows[0]) if not name.endswith("_ms")] if rows else []
            return self.long("\n".join(",".join(row[k] for k in kept) for row in rows))
        if suffix == ".glb":
            model, views = parts.glb(data)
            return {"json": self.value(model), "views": views}
        if suffix in (".npy", ".png", ".exr"):
            return getattr(parts, suffix[1:])(data)
        if suffix in (".obj", ".ply", ".vtp", ".vti"):
            head = data[:data.find(b"end_header")] if suffix == ".ply" else b""
            return {"header": head.decode().splitlines(), "hash": digest(data)}
        return {"bytes": len(data), "hash": digest(data)}

    def files(self) -> dict:
        return {str(path.relative_to(self.folder)): self.file(path) for path in sorted(self.folder.rglob("*"))
                if path.is_file() and path.name != LIST_OF_FILES}
