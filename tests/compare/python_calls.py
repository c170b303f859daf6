"""Evaluates the expressions of python_cases.py with the package sdm on the path, and prints a line of JSON for each: its text and what
it is. Run by compare.py, with the folder of the inputs and a text that the names of cases contain."""

import dataclasses
import enum
import hashlib
import json
import sys
import warnings

import numpy as np

import sdm
from inputs import meshes
from python_cases import CALLS

# Objects in objects are described to this depth.
DEEPEST = 4


def array(values: np.ndarray) -> object:
    """Small ones whole; of others what explains a difference, and a hash."""
    found = {"dtype": str(values.dtype), "shape": list(values.shape)}
    if values.size <= 16:
        return found | {"values": values.tolist()}
    found["hash"] = hashlib.sha256(np.ascontiguousarray(values).tobytes()).hexdigest()[:16]
    if values.dtype.kind in "fiub":
        finite = values[np.isfinite(values)].astype(np.float64)
        found["finite"] = int(finite.size)
        if finite.size:
            found |= {"least": float(finite.min()), "largest": float(finite.max()), "mean": float(finite.mean())}
    return found


def described(value: object, depth: int = 0) -> object:
    """Of objects: their class, their text, and all attributes that are no methods."""
    if isinstance(value, enum.Enum):
        return value.name
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray):
        return array(value)
    if isinstance(value, (list, tuple)):
        return [described(v, depth) for v in value]
    found = {"class": type(value).__name__}
    if depth == DEEPEST:
        return found
    if hasattr(value, "keys"):
        found |= {str(key): described(value[key], depth + 1) for key in value.keys()}
        if isinstance(value, dict):
            del found["class"]
            return found
    if type(value).__repr__ is not object.__repr__ and not dataclasses.is_dataclass(value):
        found["repr"] = repr(value)
    for name in dir(value):
        if not name.startswith("_"):
            attribute = attempted(lambda name=name: getattr(value, name))
            if not callable(attribute):
                found[name] = described(attribute, depth + 1)
    return found


def attempted(call) -> object:
    """What a call returns; or its error."""
    try:
        return call()
    except Exception as error:
        # After the first line, nanobind lists all arguments there are.
        message = str(error).partition("\n")[0] if isinstance(error, TypeError) else str(error)
        return {"error": type(error).__name__, "message": message}


def written(file: str, call) -> dict:
    """A file that a call writes, which compare.py reads."""
    call(file)
    return {"written": file}


def main() -> None:
    folder, only = sys.argv[1:3]
    arrays = {name: (np.array(v, float), np.array(f, np.uint32)) for name, (v, f) in meshes().items()}
    for text in CALLS:
        if only not in text:
            continue
        names = {"sdm": sdm, "np": np, "M": arrays, "F": folder + "/", "written": written, **arrays}
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always")
            value = described(attempted(lambda text=text, names=names: eval(text, names)))
        print(json.dumps([text, {"value": value} | ({"warnings": [str(w.message) for w in warned]} if warned else {})]), flush=True)


if __name__ == "__main__":
    main()
