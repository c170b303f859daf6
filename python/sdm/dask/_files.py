"""Files that are either complete or not there, whenever a process is killed."""

import contextlib
import hashlib
import json
import os
import uuid
from collections.abc import Iterator
from pathlib import Path
from typing import Any


@contextlib.contextmanager
def replacing(file: "str | os.PathLike[str]") -> Iterator[Path]:
    """Yields a name to write to. The file has the name given to it after the block, if that does not raise."""
    file = Path(file)
    partial = file.with_name(f".{uuid.uuid4().hex}{file.suffix}")
    try:
        yield partial
        os.replace(partial, file)
    finally:
        with contextlib.suppress(FileNotFoundError):
            os.unlink(partial)


def write_json(file: "str | os.PathLike[str]", value: Any) -> None:
    with replacing(file) as partial:
        partial.write_text(json.dumps(value) + "\n", encoding="utf-8")


def read_json(file: "str | os.PathLike[str]") -> Any:
    """Returns None if there is no such file, or none that is complete."""
    try:
        return json.loads(Path(file).read_text(encoding="utf-8"))
    except (FileNotFoundError, ValueError):
        return None


def key_of(**parts: Any) -> str:
    """A name for what depends on nothing but these: strings, numbers, None, and lists and dictionaries of them."""
    return hashlib.blake2b(json.dumps(parts, sort_keys=True).encode(), digest_size=16).hexdigest()
