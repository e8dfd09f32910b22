"""Floods of a page that steers: STOP of another page is first, and no tick is late."""

import base64
import itertools
import time
from collections.abc import Callable

import pytest

from higvf_console.core.commands import Freeze, Pick
from higvf_console.ui.page.message_table import PIECE_BYTES
from tests.attacks.raw_page import Login, RawPage, joined, said, strokes
from tests.attacks.watch import Watch, memory_mb, moves
from tests.browser import wait_until
from tests.consoles import Running

MOST_TICKS = 2  # from STOP received to the team stopped
LONGEST_TICK = 2.0  # work of a tick, in control periods
MOST_MB = 60.0  # that an attack may leave behind
ROUNDS = 8  # of each flood, each with a STOP in its middle
ATTACKER = "the attacker, a page that steers"
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


FLOODS: dict[str, Callable[[], bytes]] = {
    "10 000 strokes a second": lambda: joined(strokes(10_000, number=number) for number in range(2)),
    "pick flood": lambda: keys(20_000, "pick_1", "pick_2", "pick_3"),
    "undo flood": lambda: keys(20_000, "undo", "redo"),
    "3 000 clicks that add a robot": lambda: clicks(3000),
    "three strokes of 199 000 points": lambda: huge_strokes(3, 199_000),
    "a scenario of 15 MB": lambda: scenario(15),
    "100 001 STOPs": lambda: joined(said("key", name="stop", number=number) for number in range(1, 100_002)),
}


@pytest.mark.parametrize("flood", FLOODS)
def test_stop_of_another_page_under(
    flood: str, running: Running, honest: RawPage, watch: Watch, login: Login, figure: Callable[[str], None]
) -> None:
    frames, before = FLOODS[flood](), memory_mb()
    ticks: list[int] = []
    periods: list[float] = []
    longest = 0.0
    for _ in range(ROUNDS):
        wait_until(lambda: moves(running))
        watch.clear()
        sent = stop_in_the_middle(frames, running, honest, watch, login)
        ticks.append(watch.ticks_to_stop)
        periods.append((watch.stopped_at - sent) / watch.period)
        longest = max(longest, watch.longest)
    figure(f"{ROUNDS} STOPs: stand {max(ticks)} ticks after they came")
    figure(f"p99 {max(periods):.1f} periods after they were sent")
    figure(f"longest tick {longest:.1f} periods")
    figure(f"{max(0.0, memory_mb() - before):.0f} MB")
    assert max(ticks) <= MOST_TICKS
    assert longest <= LONGEST_TICK
    assert memory_mb() - before < MOST_MB
    assert running.session.error is None


def stop_in_the_middle(frames: bytes, running: Running, honest: RawPage, watch: Watch, login: Login) -> float:
    """A page that steers floods, and the honest one presses STOP meanwhile; returns when [s, `time.perf_counter`]."""
    roles = running.console._roles  # pyright: ignore[reportPrivateUsage]
    with RawPage(running.url, login) as attacker:
        attacker.hello(ATTACKER)
        attacker.send(said("control", act="take", page=""))
        wait_until(lambda: roles._control.holder == ATTACKER)  # pyright: ignore[reportPrivateUsage]
        running.push(Freeze(False))
        half = len(frames) // 2
        attacker.send(frames[:half])
        sent = time.perf_counter()
        honest.stop(next(numbers))
        attacker.send(frames[half:])
        wait_until(lambda: watch.stop_done is not None)
    return sent


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
    assert watch.longest <= LONGEST_TICK
