"""The messages of the team `mqtt`: what a robot is told, and what it tells.

PREFIX/ROBOT/cmd   {"v": 0.1, "w": 0.5, "n": 17, "valid_s": 0.3}     robots with a heading [m/s, rad/s]
                   {"vx": 0.1, "vy": 0, "n": 17, "valid_s": 0.3}     robots that move any way [m/s]
PREFIX/ROBOT/pose  {"x": 1.2, "y": 0.4, "theta": 0.7, "t": 12.5}     in the frame of the arena; t, id are optional
PREFIX/ROBOT/ack   {"n": 17, "battery": 0.8}                         battery, id are optional
PREFIX/stop        {"stop": true}                                    for all robots; last will of the console
"""

import json
import math
from typing import Any, NamedTuple, cast

from higvf_console.core.quantity import shown
from higvf_console.core.team import Drive
from higvf_console.core.viewport import Arena
from higvf_interfaces.teams.mqtt_options import UNITS

LONGEST = 1024  # payload that is looked at [bytes]
STOP = b'{"stop": true}'
_LONGEST_ID = 64
_GREATEST = 1e12


class MessageError(ValueError):
    """A message is not what its topic says."""


class PoseMessage(NamedTuple):
    """Where a robot says that it is; NaN where it says so.

    Attributes:
        x: [m].
        y: [m].
        theta: counter-clockwise from the x axis [rad]; NaN = unknown.
        t: when it was measured, on a clock of its own [s]; NaN = not told.
        id: of the sender; "" = not told.
    """

    x: float
    y: float
    theta: float
    t: float
    id: str


class AckMessage(NamedTuple):
    """What a robot confirms.

    Attributes:
        n: number of the command.
        battery: charge in [0, 1]; NaN = not told.
        id: of the sender; "" = not told.
    """

    n: int
    battery: float
    id: str


def command_payload(command: Drive, robot: int, *, has_heading: bool) -> bytes:
    """What a robot (from 0) is told."""
    if has_heading:
        motion = {"v": round(float(command.forward[robot]), 6), "w": round(float(command.turn[robot]), 6)}
    else:
        x, y = command.velocity[robot]
        motion = {"vx": round(float(x), 6), "vy": round(float(y), 6)}
    return json.dumps({**motion, "n": command.number, "valid_s": command.valid_for}).encode()


def pose_of(payload: bytes, arena: Arena, unit: str = "m", angle: str = "rad", *, has_heading: bool) -> PoseMessage:
    """The pose in a message.

    Args:
        payload: JSON.
        arena: outside of which, by more than its size, a pose is in another unit or frame.
        unit: of x and y, one of `UNITS`.
        angle: of theta, "rad" or "deg".
        has_heading: whether theta must be there.

    Raises:
        MessageError: it holds no pose, or one in another unit or frame.
    """
    values = _object(payload)
    x, y = (_number(values, key) * UNITS[unit] for key in ("x", "y"))
    size = max(arena.x_max - arena.x_min, arena.y_max - arena.y_min)
    outside = max(arena.x_min - x, x - arena.x_max, arena.y_min - y, y - arena.y_max)
    if outside > size:
        raise MessageError(f"({x:g}, {y:g}) m is {outside:.3g} m outside of the arena: another unit or frame")
    theta = math.nan
    if has_heading or "theta" in values:
        theta, turn = _number(values, "theta"), 360.0 if angle == "deg" else math.tau
        if abs(theta) > turn * 1.001:
            raise MessageError(f"theta: {theta:g} is more than a turn in {angle}")
        theta = math.radians(theta) if angle == "deg" else theta
    t = _number(values, "t") if "t" in values else math.nan
    return PoseMessage(x, y, theta, t, _sender(values))


def ack_of(payload: bytes, latest: int) -> AckMessage:
    """The confirmation in a message.

    Raises:
        MessageError: it holds none, or confirms what was not sent; `latest` is the number of the latest command.
    """
    values = _object(payload)
    number = values.get("n")
    if isinstance(number, bool) or not isinstance(number, int) or not 0 <= number <= latest:
        raise MessageError(f"n: {shown(number)} is not the number of a command, 0 to {latest}")
    battery = _number(values, "battery") if values.get("battery") is not None else math.nan
    if not (math.isnan(battery) or 0.0 <= battery <= 1.0):
        raise MessageError(f"battery: {battery:g} is not a share from 0 to 1")
    return AckMessage(number, battery, _sender(values))


def _object(payload: bytes) -> dict[str, Any]:
    if len(payload) > LONGEST:
        raise MessageError(f"{len(payload)} bytes; at most {LONGEST}")
    try:
        values: Any = json.loads(payload)
    except (ValueError, RecursionError) as problem:
        raise MessageError(f"{shown(payload)} is not JSON") from problem
    if not isinstance(values, dict):
        raise MessageError(f"{shown(payload)} is not an object, {{...}}")
    return cast(dict[str, Any], values)


def _number(values: dict[str, Any], key: str) -> float:
    """A number; NaN and infinity pass as NaN, for the console to refuse and report."""
    value = values.get(key)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise MessageError(f"{key}: {shown(value)} is not a number")
    if isinstance(value, float) and not math.isfinite(value):
        return math.nan
    if abs(value) > _GREATEST:
        raise MessageError(f"{key}: {shown(value)} is too large")
    return float(value)


def _sender(values: dict[str, Any]) -> str:
    sender = values.get("id", "")
    if not isinstance(sender, str | int) or len(str(sender)) > _LONGEST_ID:
        raise MessageError(f"id: {shown(sender)} is not a short text")
    return str(sender)
