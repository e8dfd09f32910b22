"""The team `mqtt`: robots behind an MQTT broker.

    higvf run robotarium --team mqtt=mqtt://127.0.0.1:1883:prefix=lab

Topics and messages are those of `mqtt_messages`, all with QoS 0 and never retained. A robot must stand by itself
when it has heard no command for `valid_s`; one that cannot has the relay for that (`higvf_interfaces.teams.relay`).

Two robots with one name are told where their messages have an `id`: then the link to that robot is broken until one of
them is silent. Without ids their poses alternate between two places, and the console refuses those that jump.
"""

import logging
import math
from collections.abc import Sequence
from threading import Lock

import numpy as np

from higvf_console.core.limiter import Limiter
from higvf_console.core.team import Drive, Heard, Poses, RobotLink, TeamSpec, standing
from higvf_interfaces.teams.mqtt_connection import Connection
from higvf_interfaces.teams.mqtt_messages import STOP, MessageError, ack_of, command_payload, pose_of
from higvf_interfaces.teams.mqtt_network import heard_robots
from higvf_interfaces.teams.mqtt_options import MqttOptions, settings_of
from higvf_interfaces.teams.sender_clock import SenderClock

_log = logging.getLogger(__name__)
SILENT = 3.0  # after which a robot that has confirmed commands, and does so no more, is lost [s]
TWO_SENDERS = 1.0  # within which messages with two ids come from two robots [s]
_MOST_SENDERS = 4  # that are remembered for each robot
_EARLY = 0.002  # by which a command may go before its turn [s]


class _Robot:
    """What was heard of one robot."""

    def __init__(self, delay: float) -> None:
        self.pose = (math.nan, math.nan, math.nan, math.nan)  # x, y [m], theta [rad], measured at [s]
        self.clock = SenderClock(delay)
        self.acknowledged, self.battery = -1, math.nan
        self.unanswered_since: float | None = None
        self.senders: dict[str, float] = {}
        self.refused, self.why = 0, ""


class MqttTeam:
    """Robots that hear commands by MQTT and tell their poses, if they know them, the same way."""

    name = "mqtt"
    options = MqttOptions

    def __init__(self, spec: TeamSpec) -> None:
        """Connects to the broker.

        Raises:
            InputError: address or options cannot be used, or no broker answers.
        """
        self._spec, self._settings = spec, settings_of(spec)
        broker, options, names = self._settings
        self._has_heading, self._lock, self._reports = spec.look_ahead > 0.0, Lock(), Limiter()
        self._robots = [_Robot(options.delay_s) for _ in names]
        self._commands = [f"{options.prefix}/{name}/cmd" for name in names]
        self._stop_topic = f"{options.prefix}/stop"
        self._topics = {
            f"{options.prefix}/{name}/{kind}": (robot, kind)
            for robot, name in enumerate(names)
            for kind in ("pose", "ack")
        }
        self._latest, self._sent_at, self._moving = 0, -math.inf, np.zeros(len(names), np.bool_)
        self._connection = Connection(
            broker, options.prefix, tuple(self._topics), self._hear, (self._stop_topic, STOP), 150.0 * len(names)
        )

    def poses(self, now: float) -> Poses:  # noqa: ARG002 (a pose has come or not)
        """The newest pose of each robot."""
        with self._lock:
            rows = np.array([robot.pose for robot in self._robots])
        return Poses(rows[:, 0:2].copy(), rows[:, 2].copy(), rows[:, 3].copy())

    def drive(self, command: Drive, now: float) -> None:
        """Publishes a command, at most as often as the option `rate_hz` says; one that stops a robot goes at once."""
        moving = (np.abs(command.velocity).sum(axis=1) + np.abs(command.forward) + np.abs(command.turn)) > 0.0
        stops = bool((self._moving & ~moving).any())
        if now - self._sent_at < 1.0 / self._settings.options.rate_hz - _EARLY and not stops:
            return
        self._sent_at, self._moving = now, moving
        self._publish(command, now)

    def stop(self, now: float) -> None:
        """Publishes the message that stops all, and a command to stand for each."""
        self._connection.say(self._stop_topic, STOP)
        self._moving = np.zeros(len(self._robots), np.bool_)
        self._publish(standing(len(self._robots), self._latest), now)

    def links(self, now: float) -> tuple[RobotLink, ...]:
        """All are broken when the broker is lost; one, when its robot is silent or two robots have its name."""
        trouble = self._connection.trouble(now)
        with self._lock:
            return tuple(_link(robot, trouble, now) for robot in self._robots)

    def close(self) -> None:
        """Disconnects; the last will is then not published, as robots have been stopped before."""
        self._connection.close()

    @staticmethod
    def heard(spec: TeamSpec, seconds: float) -> Sequence[Heard]:
        """The robots that speak below the prefix, whatever they are called."""
        return heard_robots(spec, seconds)

    def _publish(self, command: Drive, now: float) -> None:
        with self._lock:
            self._latest = max(self._latest, command.number)
            for robot in self._robots:
                if robot.unanswered_since is None:
                    robot.unanswered_since = now
        for robot, topic in enumerate(self._commands):
            self._connection.say(topic, command_payload(command, robot, has_heading=self._has_heading))

    def _hear(self, topic: str, payload: bytes, now: float) -> None:
        """Takes a message in; called on the thread of the connection."""
        if topic not in self._topics:
            return
        index, kind = self._topics[topic]
        robot, options = self._robots[index], self._settings.options
        try:
            if kind == "ack":
                ack = ack_of(payload, self._latest)
                with self._lock:
                    robot.acknowledged = max(robot.acknowledged, ack.n)
                    robot.battery = robot.battery if math.isnan(ack.battery) else ack.battery
                    robot.unanswered_since = None
                    _met(robot, ack.id, now)
                return
            pose = pose_of(payload, self._spec.arena, options.unit, options.angle, has_heading=self._has_heading)
            if options.stamp == "received":
                measured_at = now - options.delay_s
            elif math.isnan(pose.t):
                raise MessageError("t is missing, which the option stamp=sent needs")
            else:
                measured_at = robot.clock.time(pose.t, now)
            with self._lock:
                robot.pose = (pose.x, pose.y, pose.theta, measured_at)
                _met(robot, pose.id, now)
        except MessageError as error:
            with self._lock:
                robot.refused, robot.why = robot.refused + 1, str(error)
            if count := self._reports.due(topic, now):
                _log.warning("%s: %d messages refused, the last one: %s", topic, count, error)


def _met(robot: _Robot, sender: str, now: float) -> None:
    if sender and (sender in robot.senders or len(robot.senders) < _MOST_SENDERS):
        robot.senders[sender] = now
    for former in [name for name, at in robot.senders.items() if now - at > TWO_SENDERS]:
        del robot.senders[former]


def _link(robot: _Robot, trouble: str, now: float) -> RobotLink:
    senders = sorted(name for name, at in robot.senders.items() if now - at <= TWO_SENDERS)
    silent = 0.0 if robot.unanswered_since is None else now - robot.unanswered_since
    detail = trouble
    if not trouble and len(senders) > 1:
        detail = f"two robots have this name: {', '.join(senders)}"
    elif not trouble and robot.acknowledged >= 0 and silent > SILENT:
        detail = f"confirms no command for {silent:.0f} s"
    broken = bool(detail)
    if not broken and robot.refused:
        detail = f"{robot.refused} messages refused, the last one: {robot.why}"
    return RobotLink(robot.acknowledged, robot.battery, not broken, detail)
