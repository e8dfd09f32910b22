"""The time for which a process was awake."""

from higvf_console.core.awake import NAP, AwakeClock


def test_time_runs_on_while_it_is_read_and_a_long_gap_counts_little() -> None:
    wall = [100.0]
    clock = AwakeClock(lambda: wall[0])
    for _ in range(20):
        wall[0] += 0.2
        clock.now()
    assert round(clock.now(), 9) == 4.0
    wall[0] += 30.0
    assert round(clock.now(), 9) == 4.0 + NAP
    wall[0] += 0.5
    assert round(clock.now(), 9) == 4.5 + NAP
