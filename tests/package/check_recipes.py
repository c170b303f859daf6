#!/usr/bin/env python3
"""check_recipes.py SOURCE_DIR: checks the recipes in packaging/ against each other and against the build.

They have the version of the file VERSION, name options and presets that exist, and depend on what Debian's packages of the
library and the command in debian-packages.txt are called elsewhere.
"""

import json
import re
import subprocess
import sys
from pathlib import Path

import yaml

# conda-forge's packages for Debian's; None: not needed there, or part of the compiler's.
CONDA = {
    "cmake": "cmake", "ninja-build": "ninja", "g++": None, "pkg-config": "pkg-config", "libtbb-dev": "tbb-devel",
    "libhwy-dev": "libhwy", "libboost-dev": "libboost-headers", "libeigen3-dev": "eigen", "libxxhash-dev": "xxhash",
    "libepoxy-dev": "epoxy", "glslang-tools": "glslang", "libegl1": "libegl", "libgl1": "libgl", "libgl1-mesa-dri": None,
    "libopenexr-dev": "openexr", "libpng-dev": "libpng", "libjpeg62-turbo-dev": "libjpeg-turbo", "libwebp-dev": "libwebp",
    "libisal-dev": "isa-l", "liblzf-dev": "liblzf",
    "libcairo2-dev": "cairo", "libfreetype-dev": "freetype", "fonts-dejavu-core": None, "libfmt-dev": "fmt", "libtinygltf-dev": "tinygltf",
    "nlohmann-json3-dev": "nlohmann_json", "libcli11-dev": "cli11", "nodejs": "nodejs", "libmeshoptimizer-dev": "meshoptimizer",
    "glmark2-data": None, "mesa-vulkan-drivers": None,
}  # fmt: skip
# vcpkg's ports for those that sdm::sdm needs.
VCPKG = {"libtbb-dev": "tbb", "libhwy-dev": "highway", "libmeshoptimizer-dev": "meshoptimizer", "libboost-dev": "boost-multiprecision", "libeigen3-dev": "eigen3",
         "libxxhash-dev": "xxhash", "libepoxy-dev": "libepoxy"}  # fmt: skip

faults = []


def expect(condition: bool, fault: str) -> None:
    if not condition:
        faults.append(fault)


def packages_of_the_command(source: Path) -> list[str]:
    text = (source / "debian-packages.txt").read_text().partition("\n## Tests")[0]
    return [line for line in text.splitlines() if line and not line.startswith("#")]


def check_options(source: Path, name: str, text: str) -> None:
    known = set(re.findall(r"^option\((SDM_\w+)", (source / "CMakeLists.txt").read_text(), re.MULTILINE))
    for option in re.findall(r"\b(SDM_[A-Z_]+)\b", text):
        expect(option in known, f"{name}: there is no option {option}")


def check_vcpkg(source: Path, version: str) -> None:
    folder = source / "packaging/vcpkg/ports/sdm"
    port = json.loads((folder / "vcpkg.json").read_text())
    expect(port["version"] == version, f"vcpkg.json has version {port['version']}, VERSION {version}")
    expect(set(port["default-features"]) <= set(port["features"]), "vcpkg.json: a default feature does not exist")
    wanted = [*port["dependencies"], *(name for feature in port["features"].values() for name in feature["dependencies"])]
    names = {name if isinstance(name, str) else name["name"] for name in wanted}
    for name in set(VCPKG.values()) - names:
        faults.append(f"vcpkg.json: {name} is missing")
    for name in names - set(VCPKG.values()) - {"vcpkg-cmake", "vcpkg-cmake-config"}:
        faults.append(f"vcpkg.json: {name} is not needed")
    check_options(source, "portfile.cmake", (folder / "portfile.cmake").read_text())


def check_conda(source: Path, version: str) -> None:
    path = source / "packaging/conda/recipe.yaml"
    recipe = yaml.safe_load(path.read_text())
    expect(str(recipe["context"]["version"]) == version, f"recipe.yaml has another version than {version}")
    required = recipe["requirements"]
    names = {entry.split()[0] for part in ("build", "host", "run") for entry in required[part] if "{{" not in entry}
    for package in packages_of_the_command(source):
        expect(package in CONDA, f"check_recipes.py: add {package} of debian-packages.txt to CONDA")
        wanted = CONDA.get(package)
        expect(wanted is None or wanted in names, f"recipe.yaml: {wanted} is missing")
    for name in names - {f"{n}{suffix}" for n in CONDA.values() if n for suffix in ("", "-devel")}:
        faults.append(f"recipe.yaml: {name} is not needed")
    check_options(source, "recipe.yaml", path.read_text())
    expect((path.parent / recipe["source"]["path"] / "VERSION").exists(), "recipe.yaml: the source is another folder")
    expect((source / recipe["about"]["license_file"]).exists(), "recipe.yaml: no licence")


def check_container(source: Path) -> None:
    text = re.sub(r"\\\n", " ", (source / "packaging/Containerfile").read_text())
    presets = {p["name"] for p in json.loads((source / "CMakePresets.json").read_text())["configurePresets"]}
    stages = set()
    for line in text.splitlines():
        if not line or line.startswith("#"):
            continue
        instruction, _, rest = line.partition(" ")
        expect(instruction in ("FROM", "COPY", "WORKDIR", "RUN", "ENTRYPOINT", "CMD"), f"Containerfile: {instruction}?")
        if instruction == "FROM":
            stages |= set(re.findall(r" AS (\w+)", line))
        elif instruction == "COPY":
            expect(set(re.findall(r"--from=(\w+)", rest)) <= stages, f"Containerfile: no such stage: {line}")
        elif instruction == "RUN":
            parsed = subprocess.run(["sh", "-n", "-c", rest])
            expect(parsed.returncode == 0, f"Containerfile: {rest}")
            expect(set(re.findall(r"--preset (\w+)", rest)) <= presets, f"Containerfile: no such preset: {rest}")
        elif instruction in ("ENTRYPOINT", "CMD"):
            json.loads(rest)


def main() -> None:
    source = Path(sys.argv[1])
    version = (source / "VERSION").read_text().strip()
    check_vcpkg(source, version)
    check_conda(source, version)
    check_container(source)
    if faults:
        sys.exit("\n".join(faults))


main()
