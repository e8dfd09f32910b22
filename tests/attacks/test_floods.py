"""Floods of a page that steers: STOP of another page is first, and no tick is late."""

import base64
import itertools
import statistics
import threading
import time
from collections.abc import Callable, Generator, Iterable
from contextlib import contextmanager

import pytest

from higvf_console.core.commands import Freeze, LoadScenario, Pick
from higvf_console.runtime.background import scheduling
from higvf_console.ui.page.message_table import PIECE_BYTES
from tests.attacks.conftest import HONEST
from tests.attacks.raw_page import Login, RawPage, joined, said, strokes
from tests.attacks.watch import Watch, memory_mb, moves
from tests.browser import wait_until
from tests.consoles import Running

MOST_TICKS = 2  # from STOP received to the team stopped
LONGEST_TICK = 2.0  # work of a tick, in control periods
MOST_MB = 60.0  # that an attack may leave behind
ATTACKERS = 3  # pages that flood, and come again when they are cut off
ROUNDS = 12  # STOPs while they do, at most
ENOUGH_S = 5.0  # after which no further round begins: a reset waits behind the flood
numbers = itertools.count(1_000_000)


def keys(count: int, *names: str) -> bytes:
    return joined(said("key", name=name, number=0) for _ in range(count // len(names)) for name in names)


def huge_strokes(count: int, points: int) -> bytes:
    packets = points // 1000
    return joined(
        joined(
            [
                strokes(packets, 999, number=number),
                said("stroke", id=number, sequence=packets, phase="end", points=[], group=False),
            ]
        )
        for number in range(count)
    )


def clicks(count: int) -> bytes:
    places = ((100.0 + 11 * (n % 90), 100.0 + 7 * (n % 70)) for n in range(count))
    return joined([said("tool", name="robot")] + [said("click", point=place, group=False) for place in places])


def scenario(megabytes: int) -> bytes:
    """A file of circles, in the pieces in which a page sends it."""
    line = b"  - {kind: circle, centre: [123.456, 234.567], radius: 1.25}\n"
    content = b"version: 1\nobstacles:\n" + line * (megabytes * 1_000_000 // len(line))
    pieces = [content[start : start + PIECE_BYTES] for start in range(0, len(content), PIECE_BYTES)]
    about = {"kind": "scenario", "name": "flood.yaml", "size": len(content), "parts": len(pieces)}
    return joined(
        said("file", **about, part=part, content=base64.b64encode(piece).decode()) for part, piece in enumerate(pieces)
    )


# These come again and again; the heavy ones come once, after which the world is put back.
FLOODS: dict[str, Callable[[], bytes]] = {
    "10 000 strokes a second": lambda: joined(strokes(10_000, number=number) for number in range(2)),
    "pick flood": lambda: keys(20_000, "pick_1", "pick_2", "pick_3"),
    "undo flood": lambda: keys(20_000, "undo", "redo"),
    "three strokes of 199 000 points": lambda: huge_strokes(3, 199_000),
}
HEAVY: dict[str, Callable[[], bytes]] = {
    "3 000 clicks that add a robot": lambda: clicks(3000),
    "a scenario of 15 MB": lambda: scenario(15),
    "100 001 STOPs": lambda: joined(said("key", name="stop", number=number) for number in range(1, 100_002)),
}


@contextmanager
def flooding(frames: bytes, running: Running, login: Login) -> Generator[None]:
    """Meanwhile pages take control and flood; each that is cut off comes again."""
    stopping = threading.Event()

    def attack(number: int) -> None:
        while not stopping.is_set():
            with RawPage(running.url, login) as page:
                page.hello(f"the attacker, page {number}")
                page.send(said("control", act="take", page=""), frames)

    attackers = [threading.Thread(target=attack, args=(number,)) for number in range(ATTACKERS)]
    for attacker in attackers:
        attacker.start()
    try:
        yield
    finally:
        stopping.set()
        for attacker in attackers:
            attacker.join()


@pytest.fixture(scope="module", autouse=True)
def _after_a_first_flood(running: Running, login: Login) -> None:
    """What a process does once, such as loading modules and filling lists that are bounded, is no attack's work."""
    with flooding(FLOODS["10 000 strokes a second"](), running, login):
        time.sleep(ENOUGH_S)
    put_back(running)
    scheduling.keep_loaded()  # a collection in a tick must not look at what the attackers hold in this process


class Measured:
    """What STOPs under a flood came to."""

    def __init__(self, running: Running, honest: RawPage, watch: Watch) -> None:
        self._running, self._honest, self._watch = running, honest, watch
        self._ticks: list[int] = []
        self._periods: list[float] = []
        self._longest, self._before = 0.0, memory_mb()

    def stop(self) -> None:
        """The honest page presses STOP."""
        watch = self._watch
        watch.clear()
        sent = time.perf_counter()
        self._honest.stop(next(numbers))
        wait_until(lambda: watch.stop_done is not None)
        self._ticks.append(watch.ticks_to_stop)
        self._periods.append((watch.stopped_at - sent) / watch.period)
        self._longest = max(self._longest, watch.longest)

    def judge(self, figure: Callable[[str], None]) -> None:
        """Notes the figures, and compares with the limits those that do not depend on the machine."""
        left = memory_mb() - self._before
        figure(f"{len(self._ticks)} STOPs: stand {max(self._ticks)} ticks after they came")
        figure(f"{statistics.median(self._periods):.1f} periods after they were sent, worst {max(self._periods):.1f}")
        figure(f"longest tick {self._longest:.1f} periods")
        figure(f"{max(0.0, left):.0f} MB")
        assert max(self._ticks) <= MOST_TICKS
        assert self._longest <= LONGEST_TICK
        assert left < MOST_MB
        assert self._running.session.error is None


def set_in_motion(running: Running) -> None:
    """Waits until a tick has moved the team; it asks again, since a flood may drop or undo what was asked for."""
    known = running.session.ticks

    def advances() -> bool:
        running.push(Freeze(False))
        return moves(running) and running.session.ticks > known

    wait_until(advances)


@pytest.mark.parametrize("flood", FLOODS)
def test_stop_of_another_page_under(
    flood: str, running: Running, honest: RawPage, watch: Watch, login: Login, figure: Callable[[str], None]
) -> None:
    frames, measured = FLOODS[flood](), Measured(running, honest, watch)
    enough = time.monotonic() + ENOUGH_S
    with flooding(frames, running, login):
        for turn in range(ROUNDS):
            if turn and time.monotonic() > enough:
                break
            set_in_motion(running)
            measured.stop()
    measured.judge(figure)


@pytest.mark.parametrize("flood", HEAVY)
def test_stop_of_another_page_in_the_middle_of(
    flood: str, running: Running, honest: RawPage, watch: Watch, login: Login, figure: Callable[[str], None]
) -> None:
    frames, measured = HEAVY[flood](), Measured(running, honest, watch)
    half = len(frames) // 2
    set_in_motion(running)
    with RawPage(running.url, login) as attacker:
        attacker.hello("the attacker, a page that steers")
        attacker.send(said("control", act="take", page=""), frames[:half])
        measured.stop()
        attacker.send(frames[half:])
    wait_until(lambda: list(identities(running)) == [HONEST])  # all that was sent has been read
    put_back(running)
    measured.judge(figure)


def identities(running: Running) -> Iterable[str]:
    """Of the pages that are connected."""
    return running.console._roles._identities.values()  # pyright: ignore[reportPrivateUsage]


def put_back(running: Running) -> None:
    """Loads the scenario again, behind all that waits."""
    scenario = running.session.scenario
    running.push(LoadScenario(text=scenario.text, name="again.yaml"))
    wait_until(lambda: running.session.scenario is not scenario)


def test_a_stop_behind_a_flood_of_its_own_page(
    running: Running, honest: RawPage, watch: Watch, login: Login, figure: Callable[[str], None]
) -> None:
    with RawPage(running.url, login) as page:
        page.hello("a page that draws too fast")
        page.send(strokes(2000))
        page.stop(next(numbers))
        wait_until(lambda: watch.stop_done is not None)
        assert not page.closed.is_set()
    figure(f"stopped {watch.ticks_to_stop} ticks after STOP")
    assert watch.ticks_to_stop <= MOST_TICKS
    assert not honest.closed.is_set()


def test_a_page_that_floods_is_cut_off_and_the_honest_one_steers_on(
    running: Running, honest: RawPage, watch: Watch, login: Login, figure: Callable[[str], None]
) -> None:
    with RawPage(running.url, login) as attacker:
        attacker.send(strokes(20_000))
        assert attacker.closed.wait(60.0)
        assert attacker.close_code == 1008
    honest.send(said("control", act="take", page=""))
    honest.send(said("key", name="pick_2", number=0))
    wait_until(lambda: running.state.intent.influenced == 1)
    assert running.given(Pick)
    figure(f"cut off with code {attacker.close_code}")
    figure(f"longest tick {watch.longest:.1f} periods")
    assert watch.longest <= LONGEST_TICK
