"""sdm.dask on processes of their own: workers that are killed, run out of memory or are slow change no result."""

import contextlib
import os
import signal
import threading
import time

import numpy as np
import pytest

import meshes
import sdm

dask = pytest.importorskip("dask")
distributed = pytest.importorskip("distributed")
import sdm.dask
from test_dask import copies_of, save

MEMORY = 700_000_000


@pytest.fixture(scope="module")
def client():
    settings = {
        "distributed.worker.memory.terminate": 0.95, "distributed.worker.memory.spill": False,
        "distributed.worker.memory.target": False, "distributed.worker.memory.pause": False,
        "distributed.scheduler.allowed-failures": 20, "distributed.admin.tick.limit": "60s",
        "distributed.deploy.lost-worker-timeout": "1h",  # by default, the cluster drops a worker that restarts in more than 15 s
        "distributed.scheduler.worker-saturation": float("inf"),  # queued tasks deadlock before 2024.6.1: dask/distributed#8702
    }  # fmt: skip
    with dask.config.set(settings), distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, host="127.0.0.1", dashboard_address=None, memory_limit=MEMORY,
        silence_logs=50,
    ) as cluster, distributed.Client(cluster) as client:  # fmt: skip
        yield client


def processes(client):
    """Numbers of the processes of workers that are up: a nanny gives up when its worker ends while it starts."""
    nannies = [nanny for nanny in client.cluster.workers.values() if nanny.process]
    pids = [nanny.pid for nanny in nannies if nanny.process.status == distributed.core.Status.running]
    return [pid for pid in pids if pid]


def wait_for_two_workers(client):
    deadline = time.monotonic() + 120
    while len(processes(client)) < 2:
        assert time.monotonic() < deadline
        time.sleep(0.05)
    client.wait_for_workers(2, timeout=30)


class Killer(threading.Thread):
    """Kills a worker each time that another few files have appeared in a folder."""

    def __init__(self, client, folder, every, times):
        super().__init__()
        self.client, self.folder, self.every, self.times, self.killed = client, folder, every, times, 0
        self.done = threading.Event()

    def run(self):
        while self.killed < self.times and not self.done.is_set():
            if self.folder.exists() and len(list(self.folder.iterdir())) >= self.every * (self.killed + 1):
                workers = processes(self.client)
                if workers:
                    with contextlib.suppress(ProcessLookupError):  # of a worker that is just ending
                        os.kill(workers[self.killed % len(workers)], signal.SIGKILL)
                        self.killed += 1
            time.sleep(0.005)

    def __enter__(self):
        self.start()
        return self

    def __exit__(self, *_):
        self.done.set()
        self.join()


def pairs_of(folder, count):
    """Spheres of many sizes and a box; every ninth file is no mesh."""
    part = save(folder / "part.obj", meshes.box())
    files = [save(folder / f"{k}.obj", meshes.sphere(radius=0.5 + k / 20, steps=3)) for k in range(count)]
    for file in files[4::9]:
        file.write_text("no mesh")
    return [(file, part) for file in files]


def assert_same(table, expected):
    """All but the time that it took, and where the maps are; those are compared byte by byte."""
    columns = [c for c in expected if c not in ("seconds", "exr")]
    for column in columns:
        np.testing.assert_array_equal(table[column].to_numpy(), expected[column].to_numpy(), err_msg=column)
    for one, other in zip(table["exr"], expected["exr"]):
        assert bool(one) == bool(other)
        if one:
            with open(one, "rb") as a, open(other, "rb") as b:
                assert a.read() == b.read()


@pytest.fixture(scope="module")
def expected(tmp_path_factory):
    folder = tmp_path_factory.mktemp("expected")
    pairs = pairs_of(folder, 30)
    with dask.config.set(scheduler="sync"):
        return pairs, sdm.dask.map_pairs(pairs, folder / "out", resolution=256).compute()


def test_workers_that_are_killed(client, expected, tmp_path):
    pairs, table = expected
    with Killer(client, tmp_path / "records", every=6, times=3) as killer:
        found = sdm.dask.map_pairs(pairs, tmp_path, resolution=256).compute()
    assert killer.killed == 3
    assert_same(found, table)
    wait_for_two_workers(client)


def take_memory():
    """More than the worker may use, once the first pairs are done."""

    def grow():
        time.sleep(0.2)
        kept = []
        while True:
            if 32_000_000 * len(kept) < 1.2 * MEMORY:
                kept.append(np.ones(4_000_000))
            time.sleep(0.005)

    threading.Thread(target=grow, daemon=True).start()
    return os.getpid()


def test_a_worker_out_of_memory(client, expected, tmp_path):
    pairs, table = expected
    wait_for_two_workers(client)
    address = list(client.scheduler_info()["workers"])[0]
    pid = client.run(take_memory, workers=[address])[address]
    found = sdm.dask.map_pairs(pairs, tmp_path, resolution=256).compute()
    deadline = time.monotonic() + 30
    while os.path.exists(f"/proc/{pid}") and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not os.path.exists(f"/proc/{pid}")  # the nanny has killed it
    assert_same(found, table)
    wait_for_two_workers(client)


def slow_down():
    from sdm.dask import _pairs

    original = _pairs._computed
    _pairs._computed = lambda *arguments: time.sleep(0.5) or original(*arguments)
    _pairs._computed.original = original


def speed_up():
    from sdm.dask import _pairs

    _pairs._computed = _pairs._computed.original


def test_a_slow_worker(client, expected, tmp_path):
    pairs, table = expected
    wait_for_two_workers(client)
    slow = [list(client.scheduler_info()["workers"])[0]]
    client.run(slow_down, workers=slow)
    found = sdm.dask.map_pairs(pairs, tmp_path, resolution=256).compute()
    client.run(speed_up, workers=slow)
    assert_same(found, table)


def test_parts_and_killed_workers(client, tmp_path):
    mesh = meshes.soup(3, faces=600)
    parts = sdm.dask.split(mesh, tmp_path / "parts", faces_per_part=60)
    with Killer(client, tmp_path / "tiles", every=15, times=2) as killer:
        result = sdm.dask.map_parts(meshes.sphere(), parts, tmp_path / "tiles", resolution=256, samples_per_tile=500).compute()
    assert killer.killed == 2
    whole = sdm.map(meshes.sphere(), mesh, resolution=256, sign="none", engine="reference")
    for name in ("distance", "vector", "site", "site_type", "face"):
        np.testing.assert_array_equal(getattr(result, name), getattr(whole, name), err_msg=name)
    wait_for_two_workers(client)


def test_cohorts_and_killed_workers(client, tmp_path):
    sphere = meshes.sphere()
    work = sdm.dask.cohort_statistics(sphere, copies_of(sphere, 60), meshes.box(), range=(-1, 1), bins=16, resolution=128,
                                      copies_per_task=2)  # fmt: skip
    with dask.config.set(scheduler="sync"):
        alone = work.compute()
    wait_for_two_workers(client)
    future = client.compute(work)
    time.sleep(0.1)
    os.kill(processes(client)[0], signal.SIGKILL)
    found = future.result()
    for name in ("count", "mean", "variance", "min", "max", "bins"):
        np.testing.assert_array_equal(getattr(found, name), getattr(alone, name), err_msg=name)
