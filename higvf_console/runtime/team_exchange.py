"""Between a run and the robots of its team: in each beat they are heard, stopped if asked, and told what to do."""

from higvf_console.runtime.journal import Journal
from higvf_console.runtime.run import Run
from higvf_console.team.driver import TeamDriver


class TeamExchange:
    """One beat is `hear`, the operator's commands, `stop_if_asked`, the control period, `answer`."""

    def __init__(self, driver: TeamDriver | None, run: Run, journal: Journal) -> None:
        """Exchanges nothing yet, and never anything without a driver."""
        self._driver, self._run, self._journal = driver, run, journal
        self._stands = False

    def hear(self) -> None:
        """Takes in where the robots are, and writes it down."""
        if self._driver is not None:
            report = self._driver.report()
            self._journal.team(self._run.time, report)
            self._journal.add(self._run.hear(report))

    def stop_if_asked(self) -> None:
        """Stops the robots before anything is computed, once, where a STOP has come; zeros follow in each beat."""
        stands = self._run.state.intent.stopped
        if stands and not self._stands:
            self.stop()
        self._stands = stands

    def stop(self) -> None:
        """Stops the robots by the fastest way that there is."""
        if self._driver is not None:
            self._driver.stop()

    def answer(self) -> None:
        """Sends what the robots shall do."""
        if self._driver is not None:
            self._driver.send(self._run.command())

    def close(self) -> None:
        """Stops the robots, and closes the team."""
        if self._driver is not None:
            self._driver.close()
