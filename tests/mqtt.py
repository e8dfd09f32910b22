"""A real MQTT broker for tests, and robots behind it that are emulated."""

import json
import math
import os
import shutil
import socket
import subprocess
import time
from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager
from pathlib import Path
from threading import Event, Lock, Thread
from typing import Any, TypeVar

import paho.mqtt.client as paho
import pytest
from paho.mqtt.enums import CallbackAPIVersion

from tests.browser import wait_until

Value = TypeVar("Value")
NO_MOSQUITTO = "no mosquitto: install the package 'mosquitto'"


def soon(value: Callable[[], Value]) -> Value:
    """The first true answer, which must come within 20 s."""
    return wait_until(value, 20.0)


class Broker:
    """Mosquitto on a port of the loopback; it may be ended and started again."""

    def __init__(self, folder: Path, *settings: str) -> None:
        self.program = shutil.which("mosquitto") or shutil.which("mosquitto", path="/usr/sbin")
        if self.program is None:
            (pytest.fail if os.environ.get("HIGVF_REQUIRE_BROWSER") == "1" else pytest.skip)(NO_MOSQUITTO)
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port: int = free.getsockname()[1]
        self.file = folder / f"mosquitto-{self.port}.conf"
        lines = (f"listener {self.port} 127.0.0.1", *(settings or ("allow_anonymous true",)))
        self.file.write_text("\n".join([*lines, "user root", "persistence false", ""]), encoding="utf-8")
        self.start()

    @property
    def address(self) -> str:
        return f"mqtt://127.0.0.1:{self.port}"

    def start(self) -> None:
        assert self.program is not None
        self.process = subprocess.Popen(
            [self.program, "-c", self.file], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        with socket.socket() as probe:
            wait_until(lambda: self.process.poll() is not None or probe.connect_ex(("127.0.0.1", self.port)) == 0, 20.0)
        assert self.process.poll() is None, "mosquitto ended at once"

    def kill(self) -> None:
        self.process.kill()
        self.process.wait()


@contextmanager
def mosquitto(folder: Path, *settings: str) -> Generator[Broker]:
    """A broker on a free port, with these lines of configuration; anonymous users may use it without any."""
    broker = Broker(folder, *settings)
    try:
        yield broker
    finally:
        broker.kill()


class Client:
    """Whoever else is there: notes what it hears, publishes what it is told to."""

    def __init__(self, broker: Broker, *topics: str, will: tuple[str, bytes] | None = None) -> None:
        self.heard: list[tuple[str, bytes]] = []
        self.ready = Event()
        self.client = paho.Client(CallbackAPIVersion.VERSION2)
        self.client.reconnect_delay_set(1, 1)
        self._topics = topics
        self.client.on_connect, self.client.on_message = self._connected, self._on_message
        self.client.on_subscribe = self._subscribed
        if will is not None:
            self.client.will_set(*will)
        self.client.connect("127.0.0.1", broker.port, keepalive=5)
        self.client.loop_start()
        assert self.ready.wait(20.0)

    def _connected(self, client: paho.Client, *_: Any) -> None:
        client.subscribe([(topic, 0) for topic in (*self._topics, "nothing")])

    def _subscribed(self, *_: Any) -> None:
        self.ready.set()

    def _on_message(self, _client: Any, _data: Any, message: paho.MQTTMessage) -> None:
        self.hear(message.topic, bytes(message.payload))

    def hear(self, topic: str, payload: bytes) -> None:
        self.heard.append((topic, payload))

    def say(self, topic: str, payload: object, *, retain: bool = False) -> None:
        raw = payload if isinstance(payload, bytes) else json.dumps(payload).encode()
        self.client.publish(topic, raw, retain=retain)

    def of(self, topic: str) -> list[Any]:
        """What was heard on a topic, as JSON."""
        return [json.loads(payload) for heard, payload in list(self.heard) if heard == topic]

    def close(self) -> None:
        self.client.disconnect()
        self.client.loop_stop()


class Robots(Client):
    """N robots with two wheels each, and a watchdog of their own unless told otherwise."""

    def __init__(
        self, broker: Broker, start: Sequence[tuple[float, float]], prefix: str = "robots", *, watchdog: bool = True,
        obeys: bool = True, confirms: bool = True, clock: float = 0.0,
    ) -> None:  # fmt: skip
        self.prefix, self.watchdog, self.obeys, self.confirms, self.clock = prefix, watchdog, obeys, confirms, clock
        self.places = [[x, y, 0.0] for x, y in start]
        self.told = [(0.0, 0.0, -math.inf)] * len(start)  # v, w, until
        self.stops = 0
        self._lock, self._ended = Lock(), Event()
        super().__init__(broker, f"{prefix}/+/cmd", f"{prefix}/stop")
        self._driving = Thread(target=self._drive, daemon=True)
        self._driving.start()

    def hear(self, topic: str, payload: bytes) -> None:
        if topic.endswith("/stop"):
            self.stops += 1
            with self._lock:
                if self.obeys:
                    self.told = [(0.0, 0.0, -math.inf)] * len(self.told)
            return
        robot, command = int(topic.split("/")[-2]) - 1, json.loads(payload)
        until = time.monotonic() + command["valid_s"] if self.watchdog else math.inf
        with self._lock:
            if self.obeys or command["v"] or command["w"]:
                self.told[robot] = (command["v"], command["w"], until if self.obeys else math.inf)
        if self.confirms:
            self.say(f"{self.prefix}/{robot + 1}/ack", {"n": command["n"], "battery": 0.8})

    def _drive(self) -> None:
        before = time.monotonic()
        while not self._ended.wait(0.02):
            now = time.monotonic()
            with self._lock:
                for place, (v, w, until) in zip(self.places, self.told, strict=True):
                    step = max(min(now, until) - before, 0.0)
                    place[0] += v * math.cos(place[2]) * step
                    place[1] += v * math.sin(place[2]) * step
                    place[2] = math.remainder(place[2] + w * step, math.tau)
            before = now
            for robot, (x, y, theta) in enumerate(self.places):
                self.say(f"{self.prefix}/{robot + 1}/pose", {"x": x, "y": y, "theta": theta, "t": now + self.clock})

    def close(self) -> None:
        self._ended.set()
        self._driving.join()
        super().close()
