"""The cases of the paper, run once for all tests of the lab."""

import pytest

from higvf_console.lab.reproduce.registry import choose
from higvf_console.lab.reproduce.results import Results, run_cases


@pytest.fixture(scope="session")
def reproduction() -> Results:
    """The findings of all cases."""
    return run_cases(choose([]))
