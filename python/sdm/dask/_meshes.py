"""Meshes as tasks carry them: a path, or arrays; with a digest of their content."""

import contextlib
import functools
import hashlib
import json
import os
import threading
from collections import OrderedDict
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
import numpy.typing as npt

import sdm

def portable(mesh: Any) -> Any:
    """Returns a mesh as tasks receive it: its absolute path, (vertices, faces, texture coordinates or None), or the error
    that says why it is none. Files are not opened."""
    if isinstance(mesh, (str, os.PathLike)):
        return os.path.abspath(os.fsdecode(mesh))
    try:
        mesh = sdm.Mesh(mesh)
    except sdm.Error as error:
        return error
    uvs = mesh.corner_uvs
    return np.array(mesh.vertices), np.array(mesh.faces), None if uvs is None else np.array(uvs)


def name_of(mesh: Any, otherwise: str) -> str:
    return os.fsdecode(mesh) if isinstance(mesh, (str, os.PathLike)) else otherwise


def load(mesh: Any) -> Any:
    """Returns a mesh that sdm accepts. Raises sdm.Error."""
    if isinstance(mesh, sdm.Error):
        raise mesh
    if isinstance(mesh, str):
        return sdm.read(mesh)
    vertices, faces, uvs = mesh
    if uvs is None:
        return sdm.Mesh(vertices, faces)
    return sdm.Mesh(_WithTexture(vertices, faces, uvs))


class _WithTexture:
    """Recognised as a mesh of open3d, whose texture coordinates are those of corners."""

    def __init__(self, vertices: npt.NDArray[Any], triangles: npt.NDArray[Any], uvs: npt.NDArray[Any]) -> None:
        self.vertices, self.triangles, self.triangle_uvs = vertices, triangles, uvs.reshape(-1, 2)


def digest(mesh: Any) -> str:
    """Returns a digest of the content of a mesh. Raises OSError for a file that cannot be read, and sdm.Error."""
    if isinstance(mesh, sdm.Error):
        raise mesh
    if isinstance(mesh, str):
        return str(digest_of_files(mesh)[0])
    return digest_of_arrays(mesh)


def digest_of_files(path: str) -> tuple[Any, ...]:
    """Returns (digest, state): the state differs after any of the files has been written to."""
    files = [path, *_buffers(path)]
    state = tuple((file, status.st_mtime_ns, status.st_size, status.st_ino) for file in files for status in [os.stat(file)])
    return _digest_in_state(state), state


@functools.lru_cache(maxsize=4096)
def _digest_in_state(state: tuple[Any, ...]) -> str:
    total = hashlib.blake2b(digest_size=16)
    for file, *_ in state:
        with open(file, "rb") as opened:
            while block := opened.read(1 << 20):
                total.update(block)
        total.update(Path(file).suffix.lower().encode())  # the format may depend on it
    return total.hexdigest()


def _buffers(path: str) -> list[Any]:
    """The other files that hold the content of a glTF file."""
    if Path(path).suffix.lower() != ".gltf":
        return []
    try:
        buffers = json.loads(Path(path).read_bytes()).get("buffers", [])
        names = [buffer.get("uri", "data:") for buffer in buffers]
    except (ValueError, AttributeError, TypeError):
        return []  # what sdm.read() has to say about it comes later
    files = [os.path.join(os.path.dirname(path), unquote(name)) for name in names if not name.startswith("data:")]
    return [file for file in files if os.path.isfile(file)]


def digest_of_arrays(arrays: Any) -> str:
    total = hashlib.blake2b(digest_size=16)
    for array in arrays:
        if array is not None:
            total.update(f"{array.dtype.str}{array.shape}".encode())
            total.update(np.ascontiguousarray(array).data)
    return total.hexdigest()


@contextlib.contextmanager
def naming(name: str) -> Iterator[None]:
    """Errors of the block name the mesh."""
    try:
        yield
    except sdm.Error as error:
        text = str(error)
        raise sdm.Error(text if name in text else f"{name}: {text}") from None


class Cache:
    """The values used last, of all threads of a process. Making one excludes other threads that want the same."""

    def __init__(self, size: int) -> None:
        self.size = size
        self._entries: OrderedDict[Any, Any] = OrderedDict()
        self._lock = threading.Lock()

    def get(self, key: Any, make: Callable[[], Any]) -> Any:
        with self._lock:
            entry = self._entries.setdefault(key, [threading.Lock(), None])
            self._entries.move_to_end(key)
            while len(self._entries) > self.size:
                self._entries.popitem(last=False)
        with entry[0]:
            if entry[1] is None:
                entry[1] = make()
            return entry[1]
