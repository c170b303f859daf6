"""Ctrl-C during calls that would go on for long, with and without progress."""

import subprocess
import sys
from pathlib import Path

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


# A handler of signals that takes longer than the work: the object is finished when the exception is raised.
LATE = """
import mmap, pickle, signal, time
import numpy as np, sdm

n = 300
i, j = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
points = np.stack([i, j, np.sin(i * 0.1)], -1).reshape(-1, 3).astype(float)
a = (i * n + j)[:-1, :-1].ravel()
faces = np.concatenate([np.stack([a, a + n, a + n + 1], -1), np.stack([a, a + n + 1, a + 1], -1)])
stored = pickle.dumps(sdm.Shape(points, faces))

def used():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1])

def late(*_):
    global interrupted
    interrupted += 1
    time.sleep(1.5)
    raise KeyboardInterrupt

signal.signal(signal.SIGALRM, late)
call = {call}
call()
interrupted, before = 0, used()
for _ in range(3):
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.02)
        call()
        signal.setitimer(signal.ITIMER_REAL, 0)
    except KeyboardInterrupt:
        pass
shape = 480 * len(faces)  # bytes, about
print(interrupted, mmap.PAGESIZE * (used() - before) / shape)
"""


# Regression: nothing destroyed the object, of which each such call left one.
@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="needs /proc")
@pytest.mark.parametrize("call", ["lambda: pickle.loads(stored)", "lambda: sdm.Shape(points, faces)"])
def test_late_signals_leave_no_object(call):
    result = subprocess.run([sys.executable, "-c", LATE.format(call=call)], capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    interrupted, shapes = result.stdout.split()
    assert int(interrupted) == 3 and float(shapes) < 1.5


@pytest.mark.parametrize("name", CALLS)
def test_ctrl_c_ends_calls_without_progress(name):
    prepare, call = CALLS[name]
    program = PROGRAM.format(prepare=prepare, call=call, seconds=0.15)
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert result.stdout.strip() == "interrupted soon", result.stdout + result.stderr
