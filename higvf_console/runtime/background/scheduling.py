"""How the console shares the machine: control goes before other programs, what only looks ahead goes after control.

Linux keeps this figure for each thread, and a new thread has that of the one that starts it. Elsewhere, and for users
who may not ask for more, all stays as it is: control is then late when other programs take all cores.
"""

import gc
import os
import sys
from contextlib import suppress

USUAL, URGENT = 0, -10  # niceness of a thread: the lower, the sooner it has a core


def go_first() -> None:
    """Lets this thread, and those that it starts from now on, go before other programs if the system allows it."""
    _change(USUAL, URGENT)


def stand_back() -> None:
    """Takes that back for this thread: it has no deadline."""
    _change(URGENT, USUAL)


def keep_loaded() -> None:
    """Keeps what is loaded by now out of garbage collections: a full one would hold up a control period by 0.15 s."""
    gc.collect()
    gc.freeze()


def _change(before: int, after: int) -> None:
    """Leaves a thread alone that somebody else has given another niceness."""
    if sys.platform == "linux" and os.getpriority(os.PRIO_PROCESS, 0) == before:  # 0 is the thread that calls
        with suppress(PermissionError):
            os.setpriority(os.PRIO_PROCESS, 0, after)
