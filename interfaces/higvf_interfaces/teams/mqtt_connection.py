"""A connection to an MQTT broker that never blocks its user: a thread of its own, bounded in what it takes and keeps.

Messages beyond what a team can mean are slowed down where they are read, so that the broker, not the console, holds or
drops them. What does not leave any more is not queued: a command that is sent late is worse than none. MQTT 5, whose
broker keeps messages that are too long, and retained ones, to itself.
"""

import logging
import secrets
import sys
import time
from collections.abc import Callable, Sequence
from threading import Event, Thread
from typing import TYPE_CHECKING, Any

from higvf_console.core.errors import InputError
from higvf_console.core.limiter import Limiter
from higvf_console.core.optional import optional
from higvf_interfaces.teams.mqtt_options import CONSOLE, Broker

if TYPE_CHECKING:
    import paho.mqtt.client as paho
    from paho.mqtt import enums, packettypes, properties, subscribeoptions
else:
    paho = optional("paho.mqtt.client", "robots")
    enums = optional("paho.mqtt.enums", "robots")
    packettypes = optional("paho.mqtt.packettypes", "robots")
    properties = optional("paho.mqtt.properties", "robots")
    subscribeoptions = optional("paho.mqtt.subscribeoptions", "robots")

_log = logging.getLogger(__name__)
LONGEST_PACKET = 4096  # that the broker may send [bytes]
WITHIN = 3.0  # a broker must answer at the start [s]
SILENT = 0.5  # after which a broker that does not return what it was sent is lost [s]
_ECHO_EVERY = 0.1  # [s]
_KEEPALIVE = 2  # after which an idle connection is tried [s]
_FREE = 200  # messages a second that are read at full speed, beside those of the robots
_PAUSE = 0.002  # after each further one [s]
_UNSENT = 32  # messages that wait to leave, at most, for each topic that is heard


class Connection:
    """Connected until closed; a lost connection is taken up again by itself."""

    def __init__(
        self, broker: Broker, prefix: str, topics: Sequence[str], hear: Callable[[str, bytes, float], None],
        will: tuple[str, bytes] | None = None, rate: float = 0.0,
    ) -> None:  # fmt: skip
        """Connects.

        Args:
            broker: where.
            prefix: below which this console has a topic of its own, to hear itself.
            topics: to hear.
            hear: called with topic, payload and time of arrival [s, monotonic], on the thread of the connection.
            will: topic and payload that the broker publishes when this console is gone.
            rate: messages a second to be expected on `topics`.

        Raises:
            InputError: no broker answers, or it refuses.
        """
        self._place, self._hear, self._topics = broker.place, hear, tuple(topics)
        name = f"higvf-{secrets.token_hex(6)}"
        self._echo = f"{prefix}/{CONSOLE}/{name}"
        self._connected, self._trouble, self._answered = False, "", Event()
        self._asked_at = 0.0  # when an echo was asked for [s]
        self._asked: float | None = None  # since when one is owed [s]
        self._said, self._left = 0, 0  # messages given to the thread, and sent by it; each is written by one thread
        self._most_waiting = _UNSENT * (len(topics) + 1)
        self._allowance, self._counted_at, self._rate = 0.0, 0.0, rate + _FREE
        self._reports = Limiter()
        self._client = self._made(name, broker, will)
        try:
            self._client.connect_async(
                broker.host, broker.port, keepalive=_KEEPALIVE, clean_start=True, properties=_small_packets()
            )
            self._client.loop_start()
        except (ValueError, OSError) as problem:
            raise InputError(f"{self._place}: {problem}") from problem
        if not self._answered.wait(WITHIN) or not self._connected:
            reason = self._trouble or f"no answer within {WITHIN:g} s"
            self.close()
            raise InputError(f"{self._place}: no connection to a broker: {reason}")

    def trouble(self, now: float) -> str:
        """Why the broker cannot be talked to; "" = it can. Asks it for a sign of life.

        Args:
            now: monotonic time [s].
        """
        if not self._connected:
            return f"broker {self._place} is lost{': ' if self._trouble else ''}{self._trouble}"
        if now - self._asked_at >= _ECHO_EVERY:
            self._asked_at = now
            if self._asked is None:
                self._asked = now
            self.say(self._echo, b"")
        if self._asked is not None and now - self._asked > SILENT:
            return f"broker {self._place} has been silent for {now - self._asked:.1f} s"
        return ""

    def say(self, topic: str, payload: bytes) -> bool:
        """Sends a message, and returns at once; False = it cannot leave, and is forgotten."""
        if not self._connected or self._said - self._left >= self._most_waiting:
            return False
        sent = self._client.publish(topic, payload, qos=0).rc == paho.MQTT_ERR_SUCCESS
        self._said += sent
        return sent

    def close(self) -> None:
        """Disconnects, within a second; what was said before still leaves, if it can."""
        end = time.monotonic() + 0.3
        while self._connected and self._said > self._left and time.monotonic() < end:
            time.sleep(0.005)
        self._client.disconnect()
        stopping = Thread(target=self._client.loop_stop, name="mqtt closing", daemon=True)  # may wait for a connection
        stopping.start()
        stopping.join(0.6)

    def _made(self, name: str, broker: Broker, will: tuple[str, bytes] | None) -> "paho.Client":
        client = paho.Client(enums.CallbackAPIVersion.VERSION2, name, protocol=paho.MQTTv5)
        client.connect_timeout = WITHIN
        client.reconnect_delay_set(1, 2)
        client.suppress_exceptions = True
        client.on_connect, client.on_disconnect = self._on_connect, self._on_disconnect
        client.on_subscribe = self._on_subscribe
        client.on_connect_fail, client.on_message, client.on_publish = self._on_fail, self._on_message, self._on_publish
        if will is not None:
            client.will_set(will[0], will[1], qos=0, retain=False)
        if broker.username:
            client.username_pw_set(broker.username, broker.password)
        if broker.tls:
            try:
                client.tls_set(ca_certs=broker.ca or None)  # pyright: ignore[reportUnknownMemberType] (half typed)
            except (OSError, ValueError) as problem:
                raise InputError(f"{self._place}: ca={broker.ca}: no certificates can be read ({problem})") from problem
        return client

    def _on_connect(self, client: "paho.Client", _data: Any, _flags: Any, reason: Any, _properties: Any) -> None:
        if reason.is_failure:
            self._trouble = str(reason).lower()
        else:
            options = subscribeoptions.SubscribeOptions(qos=0, retainHandling=2)
            client.subscribe([(topic, options) for topic in (*self._topics, self._echo)])
            return
        self._answered.set()

    def _on_subscribe(self, _client: Any, _data: Any, _mid: int, reasons: Any, _properties: Any) -> None:
        """From now on messages come."""
        refused = [
            topic for topic, reason in zip((*self._topics, self._echo), reasons, strict=True) if reason.is_failure
        ]
        if refused:
            self._trouble = f"it does not let this account hear {refused[0]}"
        else:
            self._left, self._asked, self._trouble = self._said, None, ""  # what waited is forgotten
            self._connected = True
        self._answered.set()

    def _on_disconnect(self, _client: Any, _data: Any, flags: Any, reason: Any, _properties: Any) -> None:
        self._connected = False
        if flags.is_disconnect_packet_from_server:
            self._trouble = self._trouble or str(reason).lower()

    def _on_fail(self, _client: Any, _data: Any) -> None:
        self._trouble = str(sys.exception() or "it cannot be reached")
        self._answered.set()

    def _on_publish(self, _client: Any, _data: Any, _mid: int, _reason: Any, _properties: Any) -> None:
        self._left += 1

    def _on_message(self, _client: Any, _data: Any, message: "paho.MQTTMessage") -> None:
        now = time.monotonic()
        self._asked = None
        self._allowance = min(self._allowance + (now - self._counted_at) * self._rate, self._rate)
        self._counted_at = now
        if message.topic != self._echo and not message.retain:
            try:
                self._hear(message.topic, bytes(message.payload), now)
            except Exception as error:  # the thread lives on, whatever a message does
                if count := self._reports.due(type(error), now):
                    _log.error("%s: %d messages could not be heard", self._place, count, exc_info=error)
        self._allowance -= 1.0
        if self._allowance < 0.0:
            self._allowance = 0.0
            if count := self._reports.due("flood", now):
                _log.warning("%s: more than %d messages a second; slowed down (%d)", self._place, self._rate, count)
            time.sleep(_PAUSE)


def _small_packets() -> "properties.Properties":
    wanted = properties.Properties(packettypes.PacketTypes.CONNECT)
    wanted.MaximumPacketSize = LONGEST_PACKET
    return wanted
