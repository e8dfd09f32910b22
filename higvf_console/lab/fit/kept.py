"""Trials of a search in a file, one JSON line each, so that an interrupted search can go on: `higvf fit --keep FILE`.

A search is a function of its runs and its seed, and a trial is a function of its sample. A search that is started again
therefore comes to the same samples, and finds the trials of the first part in the file.
"""

import json
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Generic, NamedTuple, Protocol, TypeVar

from higvf_console.core.errors import HigvfError
from higvf_console.lab.fit.space import NAMES, Sample


class Tried(Protocol):
    """What a search needs of a trial."""

    @property
    def sample(self) -> Sample:
        """The sample, on the grid."""
        ...

    @property
    def objective(self) -> float:
        """What the search minimises."""
        ...


AnyTrial = TypeVar("AnyTrial", bound=Tried)


class TrialForm(NamedTuple, Generic[AnyTrial]):
    """How the trials of a fit are written.

    Attributes:
        columns: the value of `--columns`.
        read: makes a trial of the JSON values of its fields.
    """

    columns: str
    read: Callable[[Sequence[Any]], AnyTrial]


class KeptTrials(Generic[AnyTrial]):
    """The trials that have been made, by sample; in memory, and in a file if there is one."""

    def __init__(
        self, form: TrialForm[AnyTrial], file: Path | None, again: Callable[[Sample], AnyTrial]
    ) -> None:  # fmt: skip
        """Reads the trials in the file, if it exists; a last line that was cut off is removed.

        Args:
            form: of the trials.
            file: of earlier and new trials; None = none.
            again: makes a trial; the first one in the file is made again, as a check.

        Raises:
            HigvfError: the file cannot be read, or its trials are not those of this fit and this engine.
        """
        self._form, self._file = form, file
        self._known: dict[Sample, AnyTrial] = {}
        if file is not None:
            self._open(file, again)

    def trials(
        self, samples: Sequence[Sample], run: Callable[[Sequence[Sample]], Sequence[AnyTrial]]
    ) -> list[AnyTrial]:
        """The trials of samples; `run` makes those that are not there, and they are written to the file."""
        made = run([sample for sample in samples if sample not in self._known])
        self._known.update((trial.sample, trial) for trial in made)
        if self._file is not None:
            self._append("".join(json.dumps(trial) + "\n" for trial in made))
        return [self._known[sample] for sample in samples]

    def least(self) -> float:
        """The smallest objective so far; inf without trials."""
        return min((trial.objective for trial in self._known.values()), default=math.inf)

    def _open(self, file: Path, again: Callable[[Sample], AnyTrial]) -> None:
        head = {"higvf_fit_trials": 1, "columns": self._form.columns, "parameters": list(NAMES)}
        try:
            text = file.read_text(encoding="utf-8") if file.exists() else ""
        except (OSError, UnicodeDecodeError) as error:
            raise HigvfError(f"--keep {file}: {getattr(error, 'strerror', None) or 'not a text file'}") from error
        whole = text[: text.rfind("\n") + 1]
        try:
            found = [json.loads(line) for line in whole.splitlines()]
            if text and (not found or "higvf_fit_trials" not in found[0]):
                raise ValueError
            if found and found[0] != head:
                raise HigvfError(
                    f"--keep {file}: its trials are of another fit; give another file for --columns {head['columns']}"
                )
            trials = [self._form.read(fields) for fields in found[1:]]
        except (ValueError, TypeError, IndexError) as error:
            raise HigvfError(f"--keep {file}: this is not a file of trials that `higvf fit` wrote") from error
        if trials and again(trials[0].sample) != trials[0]:
            raise HigvfError(f"--keep {file}: the engine has changed since its trials were made; give another file")
        if not found:
            self._append(json.dumps(head) + "\n")
        elif whole != text:
            file.write_text(whole, encoding="utf-8")
        self._known = {trial.sample: trial for trial in trials}

    def _append(self, text: str) -> None:
        assert self._file is not None
        try:
            with self._file.open("a", encoding="utf-8") as file:
                file.write(text)
        except OSError as error:
            raise HigvfError(f"--keep {self._file}: {error.strerror}") from error
