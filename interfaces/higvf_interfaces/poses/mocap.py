"""The source of poses `mocap`: rigid bodies of a motion capture system, by the package `motioncapture`.

    higvf run epucks --team mqtt=mqtt://127.0.0.1 --poses mocap=192.168.1.5:system=optitrack,names=anna+bob

Tested with a module that stands in for `motioncapture`, never with a motion capture system: there was none. Try yours
with `higvf check-team ... --poses mocap=...` first, and compare the places that it shows with a tape measure.
"""

import logging
import math
import time
from threading import Event, Lock, Thread
from typing import TYPE_CHECKING, Any, NamedTuple
from typing import Annotated as A  # noqa: N817 (a table needs narrow columns)

import numpy as np

from higvf_console.core.arguments import one_of
from higvf_console.core.errors import InputError
from higvf_console.core.optional import optional
from higvf_console.core.quantity import Quantity as Q  # noqa: N817
from higvf_console.core.team import Poses, TeamSpec, options_of

if TYPE_CHECKING:
    motioncapture: Any
else:
    motioncapture = optional("motioncapture", "mocap")

_log = logging.getLogger(__name__)
SYSTEMS = ("optitrack", "vicon", "qualisys", "vrpn")
WITHIN = 3.0  # a system must answer at the start [s]


class MocapOptions(NamedTuple):
    """What its options mean."""

    system: A[str, "optitrack, vicon, qualisys or vrpn."] = "optitrack"
    names: A[str, "Names of the rigid bodies, robot by robot, joined by +; none = 1, 2, 3 and so on."] = ""
    up: A[str, "Axis of the system that points up: z or y."] = "z"
    x_m: A[float, Q("m", -1e3, 1e3, "", "Where the system's origin is in the arena.")] = 0.0
    y_m: A[float, Q("m", -1e3, 1e3, "", "Likewise.")] = 0.0
    turn_deg: A[float, Q("deg", -360.0, 360.0, "", "From the arena's x axis to the system's.")] = 0.0
    delay_s: A[float, Q("s", 0.0, 1.0, "", "Age of a pose when it arrives.")] = 0.0


class MocapPoses:
    """The newest pose of each rigid body, read on a thread of its own."""

    name = "mocap"
    options = MocapOptions

    def __init__(self, spec: TeamSpec) -> None:
        """Connects.

        Raises:
            InputError: address or options cannot be used, or no system answers.
        """
        self._options = options = options_of(spec, MocapOptions)
        place = f"--poses mocap={spec.address}"
        one_of(f"{place}: system", options.system, SYSTEMS, InputError)
        one_of(f"{place}: up", options.up, ("z", "y"), InputError)
        if not spec.address:
            raise InputError(f"{place}: give the host of the system, e.g. --poses mocap=192.168.1.5")
        names = options.names.split("+") if options.names else [str(robot + 1) for robot in range(spec.robots)]
        if len(names) != spec.robots or len(set(names)) != spec.robots:
            raise InputError(f"{place}: names: give {spec.robots} different names, one for each robot of the scenario")
        self._robots = {name: robot for robot, name in enumerate(names)}
        self._rows, self._lock = np.full((spec.robots, 4), np.nan), Lock()  # x, y [m], heading [rad], measured at [s]
        self._opened, self._ended, self._failure = Event(), Event(), ""
        connect = motioncapture.connect  # an extra that is missing is told here, not on the thread
        self._thread = Thread(target=self._read, args=(connect, spec.address), name="mocap", daemon=True)
        self._thread.start()
        if not self._opened.wait(WITHIN) or self._failure:
            raise InputError(f"{place}: {self._failure or f'no {options.system} system answers within {WITHIN:g} s'}")

    def poses(self, now: float) -> Poses:  # noqa: ARG002 (a pose has come or not)
        """The newest pose of each robot."""
        with self._lock:
            rows = self._rows.copy()
        return Poses(rows[:, 0:2], rows[:, 2], rows[:, 3])

    def close(self) -> None:
        """Ends reading; a thread that waits for a frame ends with the next one."""
        self._ended.set()
        self._thread.join(0.5)

    def _read(self, connect: Any, host: str) -> None:
        try:
            system = connect(self._options.system, {"hostname": host})  # may wait for ever
            self._opened.set()
            while not self._ended.is_set():
                system.waitForNextFrame()
                now = time.monotonic() - self._options.delay_s
                for name, body in dict(system.rigidBodies).items():
                    if name in self._robots:
                        with self._lock:
                            self._rows[self._robots[name]] = (*placed(body, self._options), now)
        except Exception as error:  # whatever the library raises: the poses grow old, and the team is stopped
            _log.error("motion capture at %s has failed", host, exc_info=error)
            self._failure = f"{type(error).__name__}: {error}"
            self._opened.set()


def placed(body: Any, options: MocapOptions) -> tuple[float, float, float]:
    """Place [m] and heading [rad] of a rigid body in the arena; NaN where the system has lost it."""
    x, y, z = (float(value) for value in body.position)
    rotation = body.rotation
    w, i, j, k = (float(value) for value in (rotation.w, rotation.x, rotation.y, rotation.z))
    if options.up == "y":
        y, j, k = -z, -k, j
    turn = math.radians(options.turn_deg)
    yaw = math.atan2(2.0 * (w * k + i * j), 1.0 - 2.0 * (j * j + k * k))
    return (
        options.x_m + x * math.cos(turn) - y * math.sin(turn),
        options.y_m + x * math.sin(turn) + y * math.cos(turn),
        math.remainder(yaw + turn, math.tau),
    )
