"""Which robots an MQTT broker shows, for `higvf teams mqtt=mqtt://HOST`."""

import math
import time
from collections.abc import Sequence

from higvf_console.core.team import Heard, TeamSpec
from higvf_interfaces.teams.mqtt_connection import Connection
from higvf_interfaces.teams.mqtt_messages import AckMessage, MessageError, PoseMessage, ack_of, pose_of
from higvf_interfaces.teams.mqtt_options import MqttOptions, settings_of

MOST = 1000  # robots that are listed
_ANY_NUMBER = 2**63


class _Speaker:
    """What was heard of one name."""

    def __init__(self) -> None:
        self.poses, self.acks, self.refused = 0, 0, 0
        self.why = ""
        self.senders: set[str] = set()
        self.pose: PoseMessage | None = None
        self.battery = math.nan

    def hear(self, message: PoseMessage | AckMessage) -> None:
        """Counts a message."""
        if message.id and len(self.senders) < MOST:
            self.senders.add(message.id)
        if isinstance(message, PoseMessage):
            self.poses, self.pose = self.poses + 1, message
        else:
            self.acks += 1
            self.battery = self.battery if math.isnan(message.battery) else message.battery

    def detail(self, seconds: float) -> str:
        """What was heard in so many seconds."""
        parts = ["no poses"]
        if self.pose is not None:
            stamps = "" if math.isnan(self.pose.t) else ", stamped"
            parts = [
                f"{self.poses / seconds:.0f} poses/s{stamps}, the last at ({self.pose.x:.2f}, {self.pose.y:.2f}) m"
            ]
        parts += [f"{self.acks} confirmations"] * (self.acks > 0)
        parts += [f"battery {self.battery:.0%}"] * (not math.isnan(self.battery))
        parts += [f"two robots have this name: {', '.join(sorted(self.senders))}"] * (len(self.senders) > 1)
        parts += [f"{self.refused} messages refused: {self.why}"] * (self.refused > 0)
        return "; ".join(parts)


def heard_robots(spec: TeamSpec, seconds: float) -> Sequence[Heard]:
    """Listens below the prefix, and sends nothing.

    Args:
        spec: address and options; its robots do not matter.
        seconds: to listen.

    Raises:
        InputError: address or options cannot be used, or no broker answers.
    """
    count = len(spec.options.get("names", "").split("+"))
    settings = settings_of(TeamSpec(spec.name, spec.address, spec.options, robots=count, arena=spec.arena))
    prefix, options = f"{settings.options.prefix}/", settings.options
    speakers: dict[str, _Speaker] = {}

    def hear(topic: str, payload: bytes, _now: float) -> None:
        name, _, kind = topic.removeprefix(prefix).partition("/")
        if name not in speakers and len(speakers) >= MOST:
            return
        speaker = speakers.setdefault(name, _Speaker())
        try:
            speaker.hear(_message(payload, kind, spec, options))
        except MessageError as error:
            speaker.refused, speaker.why = speaker.refused + 1, str(error)

    connection = Connection(
        settings.broker, options.prefix, [f"{prefix}+/pose", f"{prefix}+/ack"], hear, rate=100.0 * MOST
    )
    try:
        time.sleep(seconds)
    finally:
        connection.close()
    return [
        Heard(name, speakers[name].detail(seconds)) for name in sorted(speakers, key=lambda name: (len(name), name))
    ]


def _message(payload: bytes, kind: str, spec: TeamSpec, options: MqttOptions) -> PoseMessage | AckMessage:
    if kind == "ack":
        return ack_of(payload, _ANY_NUMBER)
    return pose_of(payload, spec.arena, options.unit, options.angle, has_heading=False)
