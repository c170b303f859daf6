"""What a user of the wheel does, beside the files bunny.obj and horse.3ds: closest points, a map with its picture and its
page, which name the numbers that the calls return. Run by tests/long in a bare Debian."""

import importlib.metadata
from pathlib import Path

import numpy as np

import sdm

bunny, horse = sdm.read("bunny.obj"), sdm.read("horse.3ds")
beside = sdm.fit_to_unit(horse)
beside[0, 3] += 0.8
distance_map = sdm.map(bunny, horse.transformed(beside), transform=sdm.fit_to_unit(bunny), resolution=256)
statistics = distance_map.statistics()
assert 0 < statistics.min < statistics.mean < statistics.max < 2, statistics

sites = sdm.Sites(bunny)
closest = sites.closest_points(bunny.vertices)
assert closest.distance.max() < 1e-6 * np.ptp(bunny.vertices, axis=0).max(), closest.distance.max()
assert np.allclose(np.linalg.norm(closest.point - bunny.vertices, axis=1), closest.distance)

distance_map.save("distance.png")
distance_map.save("distance.html")
# Letters that not every font has: a bare system has none.
for name, units in (("micro.png", "µm"), ("umlaut.png", "äm")):
    distance_map.save(name, units=units)
assert Path("micro.png").read_bytes() != Path("umlaut.png").read_bytes(), "no letters in pictures"
assert Path("distance.png").read_bytes().startswith(b"\x89PNG")
assert "three.js" in Path("distance.html").read_text(encoding="utf-8")
assert distance_map.report()["distance"]["max"] == statistics.max, distance_map.report().keys()

distribution = importlib.metadata.distribution("surface-distance-maps")
assert distribution.version == sdm.__version__
licenses = {file.parts[-2] for file in distribution.files if "licenses" in file.parts and len(file.parts) > 3}
for package in ("libtbb12", "fonts-dejavu-core", "libopenexr-3-1-30", "libcairo2", "libeigen3-dev", "nanobind", "three"):
    assert package in licenses, (package, licenses)
print(f"surface-distance-maps {distribution.version} works: distance {statistics.min:.6g} to {statistics.max:.6g}")
