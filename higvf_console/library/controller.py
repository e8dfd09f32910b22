"""The method for robots of one's own: measured positions in, safe velocities out, once a control period."""

from numpy.typing import ArrayLike

from higvf_console.control.parameters import Parameters
from higvf_console.core.arguments import instance, whole
from higvf_console.core.arrays import FARTHEST, Floats, floats, given_bools, given_floats
from higvf_console.core.errors import ArgumentError
from higvf_console.core.state import NO_PATH, Path, PathKind, SimState, Trace
from higvf_console.library.filtering import controlled_points, given_headings
from higvf_console.library.records import given_path, given_state
from higvf_console.library.stepping import given_setup
from higvf_console.operator.path_commands import follow
from higvf_console.runtime.compiling import announce
from higvf_console.sim import simulation
from higvf_console.world.setup import Setup


class Controller:
    """HI-GVF with its safety filter, [2]-[28], for a team whose positions come from outside.

    The controller keeps what the method remembers from one period to the next: shared intentions, progress along the
    path, the agreed circulation round obstacles, targets, and its own model of the fires.

    Attributes:
        setup: world, parameters and start.
    """

    def __init__(self, setup: Setup) -> None:
        """Starts with nothing remembered.

        Args:
            setup: from `make_setup`, or a scenario's `setup`.

        Raises:
            ArgumentError: world, parameters and start do not fit each other.
        """
        self.setup = given_setup(setup)
        self._params = _measured(self.setup.params)
        self._state, self._trace = self.setup.start, None

    @property
    def state(self) -> SimState:
        """What the controller remembers, with the positions that it expects one control period on."""
        return self._state

    @property
    def trace(self) -> Trace | None:
        """Why the last velocities are what they are; None before the first `step`."""
        return self._trace

    def reset(self) -> None:
        """Forgets everything."""
        self._state, self._trace = self.setup.start, None

    def step(
        self,
        positions: ArrayLike | SimState,
        path: Path | None = None,
        *,
        headings: ArrayLike | None = None,
        influenced: int | None = None,
        paused: bool = False,
        fire_radius: ArrayLike | None = None,
        fire_burning: ArrayLike | None = None,
    ) -> Floats:
        """Safe velocities for the coming control period, of length `safety.control_period`.

        Args:
            positions: (N, 2) measured centres of the robots [m]; or a whole state, which replaces what is remembered.
            path: the human's desired path; the same path goes on where it was, another one begins, None ends it.
                With a state, None keeps the state's path.
            headings: (N,) of unicycles, or one for all [rad]; not needed where `robots.look_ahead` is 0.
            influenced: index of the robot that receives the human intention; None = unchanged.
            paused: whether robots hold, and yield to what moves.
            fire_radius: (M,) measured [m]; None = the model's.
            fire_burning: (M,) measured; None = the model's.

        Returns:
            (N, 2) [m/s]; of unicycles those of the point `look_ahead` in front, see `unicycle_commands`.

        Raises:
            ArgumentError: an argument has another shape or type, or holds NaN or infinite values.
        """
        state = self._given(positions, headings, fire_radius, fire_burning)
        robots = len(state.motion.position)
        leader = state.intent.influenced
        if influenced is not None:
            leader = whole("influenced", influenced, 0, max(robots - 1, 0))
        holds = bool(instance("paused", paused, bool))
        state = state._replace(intent=state.intent._replace(influenced=leader, paused=holds))
        if path is not None or not isinstance(positions, SimState):
            state = _led(state, NO_PATH if path is None else given_path(path))
        announce()
        self._state, self._trace = simulation.advance(state, self.setup.world, self._params)
        return self._state.motion.velocity.copy()

    def _given(self, positions: object, headings: object, radius: object, burning: object) -> SimState:
        """The state from which to step, with what was measured."""
        if isinstance(positions, SimState):
            return given_state(positions, self.setup.world, "positions")
        motion = self._state.motion
        robots, fires = len(motion.position), len(motion.fire_radius)
        why = f"the setup has {robots} robots"
        centres = given_floats("positions", positions, (robots, 2), most=FARTHEST, why=why)
        points = controlled_points(centres, headings, self.setup.params)  # pyright: ignore[reportArgumentType]
        motion = motion._replace(position=points)
        if headings is not None:
            motion = motion._replace(heading=given_headings(headings, robots))
        if radius is not None:
            found = given_floats("fire_radius", radius, (fires,), most=FARTHEST, why=f"the setup has {fires} fires")
            motion = motion._replace(fire_radius=found)
        if burning is not None:
            found = given_bools("fire_burning", burning, (fires,), why=f"the setup has {fires} fires")
            motion = motion._replace(fire_burning=found)
        return self._state._replace(motion=motion)


def _measured(params: Parameters) -> Parameters:
    """Parameters for positions that were measured already: clearances grow by their error, and none is added."""
    error, safety = params.robots.position_noise, params.safety
    return params._replace(
        robots=params.robots._replace(position_noise=0.0),
        safety=safety._replace(
            robot_clearance=safety.robot_clearance + 2.0 * error, obstacle_clearance=safety.obstacle_clearance + error
        ),
    )


def _led(state: SimState, path: Path) -> SimState:
    """The state with that path in force; one that is in force already goes on where it is."""
    if _same(state.intent.path, path):
        return state
    if path.kind != PathKind.NONE and not len(state.motion.position):
        raise ArgumentError("path is given to a team without robots; expected None")
    return follow(state, path)


def _same(one: Path, other: Path) -> bool:
    arrays = floats(one.shape), floats(other.shape), one.spline, other.spline
    plain = [field for field in Path._fields if field not in ("shape", "spline")]
    return one is other or (
        all(getattr(one, field) == getattr(other, field) for field in plain)
        and arrays[0].tobytes() == arrays[1].tobytes()
        and arrays[2].tobytes() == arrays[3].tobytes()
    )
