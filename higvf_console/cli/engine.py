"""The engine ahead of a run: loaded from the cache, or compiled first, with progress on standard error."""
# ruff: noqa: PLC0415 (loads the compiler)

import subprocess
import sys
from time import perf_counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from higvf_console.world.setup import Setup
