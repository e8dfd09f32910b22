"""What the commands print may end before they do, as with `head`."""

import os
import subprocess
import sys

import pytest


@pytest.mark.parametrize("command", [["scenarios"], ["no-such-command"]])
def test_output_into_a_closed_pipe_ends_quietly(command: list[str]) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run(
        [sys.executable, "-m", "higvf_console", *command],
        stdout=writing,
        stderr=subprocess.PIPE,
        text=True,
        check=False,
    )
    os.close(writing)
    assert "Traceback" not in done.stderr
    assert "Exception ignored" not in done.stderr
    assert done.returncode == (2 if command == ["no-such-command"] else 141)
