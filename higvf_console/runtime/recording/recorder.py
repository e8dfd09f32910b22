"""Writes a recording while a session runs."""

import dataclasses
import itertools
import json
import platform
import time
from collections.abc import Generator, Mapping
from contextlib import contextmanager, suppress
from importlib.metadata import version
from pathlib import Path
from typing import Any

from higvf_console.core.arguments import instance
from higvf_console.core.commands import LoadScenario, OperatorCommand
from higvf_console.core.errors import InputError
from higvf_console.core.reports import CalibrationReport
from higvf_console.core.state import Motion
from higvf_console.runtime.recording import command_fields, team_lines
from higvf_console.runtime.run import TrajectoryDigest
from higvf_console.scenario.scenario import Scenario
from higvf_console.team.state import TeamReport
from higvf_console.team.tracking import Rules

FORMAT = 1
NONE_MEASURED: Mapping[str, CalibrationReport] = {}
_FLUSH_EVERY = 1.0  # [s] of wall clock: what a crash can lose


class Recorder:
    """Writes a recording while a session runs."""

    def __init__(
        self,
        file: str | Path,
        scenario: Scenario,
        seed: int,
        calibrations: Mapping[str, CalibrationReport] = NONE_MEASURED,
        rules: Rules | None = None,
    ) -> None:
        """Opens the file and writes the header.

        Args:
            file: where to.
            scenario: what is run.
            seed: of its start positions.
            calibrations: in use, by input.
            rules: of the team that drives; None = the robots are integrated.

        Raises:
            InputError: the file holds something already, or cannot be written.
        """
        file = Path(instance("file", file, str, Path))
        instance("scenario", scenario, Scenario)
        try:
            if file.is_file() and file.stat().st_size > 0:
                raise InputError(
                    f"{file}: exists already, and is not overwritten: give a new name, such as {_free_name(file)},"
                    " or delete it first"
                )
            self._file = file.open("w", encoding="utf-8")
        except OSError as error:
            raise InputError(f"{file}: cannot be written: {error.strerror}") from error
        self._ticks = 0
        self._digest = TrajectoryDigest()
        self._mark_every = mark_every(scenario)
        self._flushed = time.monotonic()
        header: dict[str, Any] = {
            "recording": FORMAT,
            "scenario": scenario.name,
            "source": scenario.source,
            "seed": seed,
        }
        forms = scenario.params.forms.words()
        polygons = [chain.tolist() for chain in scenario.obstacles.polygons]
        measured = {name: report._asdict() for name, report in calibrations.items()}
        if rules is not None:
            header["team"] = team_lines.rules_written(rules)
        self._write({**header, "forms": forms, "versions": versions(), "calibrations": measured,
                     "text": scenario.text, "polygons": polygons})  # fmt: skip

    def command(self, command: OperatorCommand, scenario: Scenario | None = None) -> None:
        """A command was applied before the next tick.

        Args:
            command: what was applied.
            scenario: in force from then on; it keeps what the images of a loaded one came to.
        """
        if isinstance(command, LoadScenario) and scenario is not None:
            command = dataclasses.replace(command, polygons=scenario.obstacles.polygons)
        self._write({"tick": self._ticks, **command_fields.written(command)})

    def calibration(self, channel: str, report: CalibrationReport) -> None:
        """An input has a new calibration."""
        self._write({"tick": self._ticks, "calibration": channel, **report._asdict()})

    def team(self, report: TeamReport) -> None:
        """A team was heard before the next tick."""
        self._write({"tick": self._ticks, "team": team_lines.written(report)})

    def step(self, motion: Motion) -> None:
        """A tick was done."""
        self._ticks += 1
        self._digest.add(motion)
        if self._ticks % self._mark_every == 0:
            self._write({"mark": self._ticks, "digest": self._digest.hex()})

    def keep(self) -> None:
        """Hands what was written to the operating system, once each second of real time; call it at every beat."""
        if time.monotonic() - self._flushed > _FLUSH_EVERY:
            self._flushed = time.monotonic()
            with self._closed_if_it_fails():
                self._file.flush()

    def close(self) -> None:
        """Writes the end; may be called twice."""
        if not self._file.closed:
            self._write({"mark": self._ticks, "digest": self._digest.hex(), "end": True})
            self._file.close()

    def _write(self, line: dict[str, Any]) -> None:
        text = json.dumps(line) + "\n"
        with self._closed_if_it_fails():
            self._file.write(text)

    @contextmanager
    def _closed_if_it_fails(self) -> Generator[None]:
        """Closes the file after an error of the disk, so that no later call tries again."""
        try:
            yield
        except OSError:
            with suppress(OSError):
                self._file.close()
            raise


def versions() -> dict[str, str]:
    """Versions of what decides the last bit of a trajectory."""
    names = ("higvf-console", "numba", "numpy", "scipy")
    return {"python": platform.python_version(), **{name: version(name) for name in names}}


def mark_every(scenario: Scenario) -> int:
    """Ticks from one mark to the next."""
    return max(1, round(1.0 / scenario.params.safety.control_period))


def _free_name(file: Path) -> Path:
    """The first of run-2.jsonl, run-3.jsonl ... that does not exist yet."""
    names = (file.with_stem(f"{file.stem}-{number}") for number in itertools.count(2))
    return next(name for name in names if not name.exists())
