"""A console without a page, in real time, as a program of its own: what is killed to see whether the robots stand.

    python -m higvf_console.lab.team.live SCENE TEAM [RECORDING]

It arms the team and draws, see `scenes`; it prints {"armed_at": s} on the machine's monotonic clock, and answers each
line of its input with a report. The end of the input ends it.
"""

import json
import sys
import time
from pathlib import Path
from threading import Event as Signal
from threading import Thread

from higvf_console.core.errors import HigvfError
from higvf_console.lab.team.scenes import Operator, scenes
from higvf_console.runtime.recording import Recorder
from higvf_console.runtime.session import Session
from higvf_console.runtime.teams import open_driver
from higvf_console.sim.warm_up import warm_up


def main(name: str, team: str, recording: str | None = None) -> None:
    """Runs a scene with a team, `--team TEAM`, until nothing more is to be read.

    Raises:
        HigvfError: no such scene, or the team cannot be used.
    """
    known = {scene.name: scene for scene in scenes()}
    if name not in known:
        raise HigvfError(f"no scene '{name}'; choose {', '.join(known)}")
    scene = known[name]
    setup = scene.scenario.setup(0)
    warm_up(setup.start, setup.world, setup.params)
    with open_driver(team, None, scene.scenario, setup, time.monotonic) as driver:
        recorder = None if recording is None else Recorder(Path(recording), scene.scenario, 0, rules=driver.rules)
        operator = Operator(scene)
        session = Session(scene.scenario, [operator], recorder=recorder, team=driver)
        operator.events = lambda: session.snapshot.events
        stopping = Signal()
        threads = [Thread(target=session.run, args=(stopping,)), Thread(target=_tell_armed, args=(operator, stopping))]
        for thread in threads:
            thread.start()
        for _ in sys.stdin:
            _tell(_report(session))
        stopping.set()
        for thread in threads:
            thread.join()
        session.close()


def _tell_armed(operator: Operator, stopping: Signal) -> None:
    while operator.armed_at is None and not stopping.wait(0.01):
        pass
    _tell({"armed_at": time.monotonic()})


def _tell(line: object) -> None:
    print(json.dumps(line), flush=True)


def _report(session: Session) -> dict[str, object]:
    now = session.snapshot
    return {
        "time_s": now.time,
        "ticks": session.ticks,
        "lost_s": now.lost_time,
        "infeasible_ticks": now.infeasible_ticks,
        "burning": int(now.state.motion.fire_burning.sum()),
        "arming": None if now.team is None else now.team.arming.value,
        "events": [event.text for event in now.events if event.kind == "team"],
    }


if __name__ == "__main__":
    main(*sys.argv[1:])
