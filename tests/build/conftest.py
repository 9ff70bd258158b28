"""What compilers do for users is what the tests of them see."""

import pytest


@pytest.fixture(autouse=True)
def _as_for_users(optimized):
    """Compilers optimise as much as they can."""
