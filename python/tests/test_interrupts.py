"""Ctrl-C during calls that would go on for long, with and without progress."""

import subprocess
import sys

import pytest

PROGRAM = """
import os, signal, threading, time
import numpy as np, sdm

def ring(n):
    u, v = np.meshgrid(np.arange(n) * 2 * np.pi / n, np.arange(n) * 2 * np.pi / n, indexing="ij")
    r = 1 + 0.4 * np.cos(v)
    points = np.stack([r * np.cos(u), r * np.sin(u), 0.4 * np.sin(v)], -1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    a, b, c, d = (((i + di) % n * n + (j + dj) % n).ravel() for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)))
    return points, np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)])

def rings(count, n):
    points, faces = ring(n)
    moved = [points + 0.03 * k for k in range(count)]
    return np.concatenate(moved), np.concatenate([faces + k * len(points) for k in range(count)])

{prepare}
used = {{}}

def interrupt():
    used["before"] = time.process_time()
    os.kill(os.getpid(), signal.SIGINT)

try:
    threading.Timer({seconds}, interrupt).start()
    for _ in range(100):  # one alone may be ready first, on a fast machine
        {call}
    print("finished")
except KeyboardInterrupt:
    print("interrupted", "soon" if time.process_time() - used["before"] < 4 * max(1, os.cpu_count() / 4) else "late")
"""

CALLS = {
    "sites": ("mesh = rings(40, 60)", "sdm.Sites(mesh)"),
    "depth": (
        "query = sdm.ProximityQuery(rings(8, 60), (ring(60)[0] + 0.1, ring(60)[1]))",
        "query.penetration_depth()",
    ),
    "contacts": (
        "query = sdm.ProximityQuery(rings(8, 60), (ring(60)[0] + 0.1, ring(60)[1]), contact_margin=0.2)",
        "query.contacts()",
    ),
    "bodies": (
        "query = sdm.MultiBodyQuery([rings(8, 60), (ring(60)[0] + 0.1, ring(60)[1])])",
        "query.penetration_depths()",
    ),
    "batch": (
        "mesh, points = ring(60), np.random.default_rng(0).normal(size=(2000, 3))",
        "sdm.closest_points_batch([mesh] * 1000, points)",
    ),
    "covering_radius": (
        "surface = sdm.Surface(ring(100), resolution=1024)",
        "[surface.covering_radius() for _ in range(3000)]",
    ),
}


@pytest.mark.parametrize("name", CALLS)
def test_ctrl_c_ends_calls_without_progress(name):
    prepare, call = CALLS[name]
    program = PROGRAM.format(prepare=prepare, call=call, seconds=0.15)
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert result.stdout.strip() == "interrupted soon", result.stdout + result.stderr
