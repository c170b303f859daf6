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
