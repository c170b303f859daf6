"""The memory of many small calls levels off."""

import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = """
import sys
sys.path.insert(0, sys.argv[1])
import meshes, sdm

def used():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1])

box, sphere = meshes.box(), meshes.sphere(steps=1)
go_on = lambda step, fraction: True
def call():
    {call}
for _ in range(300):
    call()
before = used()
for _ in range({calls}):
    call()
print(used() / before)
"""


# Regression: each call had a thread of its own, of which oneTBB kept some kilobytes: 1.6 times the memory after 4000 calls.
@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="needs /proc")
@pytest.mark.parametrize(
    "call", ["sdm.closest_points(*box, [[0, 0, 3]], progress=go_on)", "sdm.map(box, sphere, resolution=16)"]
)
def test_memory_levels_off(call):
    calls = 4000 if "closest" in call else 2000
    program = PROGRAM.format(call=call, calls=calls)
    folder = str(Path(__file__).parent)
    result = subprocess.run([sys.executable, "-c", program, folder], capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    assert float(result.stdout) < 1.3
