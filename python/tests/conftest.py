import sys
from pathlib import Path

import hypothesis
import pytest

sys.path.insert(0, str(Path(__file__).parent))
import meshes

# The same examples in every run; no time limit, as other tests run at the same time.
hypothesis.settings.register_profile("tests", derandomize=True, deadline=None, max_examples=50, database=None)
hypothesis.settings.load_profile("tests")


@pytest.fixture(scope="session")
def box():
    return meshes.box()


@pytest.fixture(scope="session")
def sphere():
    return meshes.sphere()


@pytest.fixture
def map_in_file(tmp_path):
    """Saves a mesh as PLY and returns its path."""
    import sdm

    def save(mesh, name="mesh.ply"):
        path = tmp_path / name
        sdm.map(mesh, mesh, resolution=64).save(path)
        return path

    return save
