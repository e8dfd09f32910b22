"""Replayed gaze moves the cursor, and draws only while the clutch is closed."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from higvf_console.core.commands import Cursor, OperatorCommand, StrokeBegin, StrokeCancel, StrokeEnd, StrokePoints
from higvf_console.core.errors import InputError
from higvf_console.core.interface import ChannelState, InputSpec, OperatorContext
from higvf_console.core.viewport import Viewport, fit
from higvf_interfaces.gaze.interface import GazeReplay, open_gaze

ContextAt = Callable[..., OperatorContext]
Write = Callable[..., str]
RATE = 100
REST = 0.4  # of the eye on each target [s]


def rests(*targets: tuple[float, float] | None, start: float = 0.0) -> str:
    """A plain table of an eye that rests on each target in turn; None = closed."""
    rows = [
        f"{start + k * REST + i / RATE:.3f}," + (f"{target[0]},{target[1]}" if target else ",")
        for k, target in enumerate(targets)
        for i in range(round(REST * RATE))
    ]
    return "time,x,y\n" + "\n".join(rows) + "\n"


FIVE = ((200, 200), (400, 300), (600, 300), (800, 400), (1000, 500))


def opened(file: str, **options: str) -> GazeReplay:
    return open_gaze(InputSpec("gaze", file, options={"frame": "arena", **options}))


def play(
    gaze: GazeReplay, at: ContextAt, until: float, held: Callable[[float], bool] = lambda _: False, start: float = 0.0
) -> list[OperatorCommand]:
    times = np.arange(round((until - start) / 0.02) + 1) * 0.02 + start
    return [c for time in times for c in gaze.poll(at(float(time), clutch=held(float(time))))]


def strokes(commands: Sequence[OperatorCommand]) -> list[OperatorCommand]:
    return [command for command in commands if not isinstance(command, Cursor)]


def drawn(commands: Sequence[OperatorCommand]) -> list[list[float]]:
    return [point.tolist() for c in commands if isinstance(c, StrokePoints) for point in c.points]


def test_the_cursor_follows_gaze_on_the_session_clock(write: Write, at: ContextAt) -> None:
    gaze = opened(write(rests((200, 200), (900, 500))))
    early, late = gaze.poll(at(0.2))[-1], gaze.poll(at(0.6))[-1]
    assert isinstance(early, Cursor)
    assert isinstance(late, Cursor)
    np.testing.assert_allclose(early.point, [200, 200])
    np.testing.assert_allclose(late.point, [900, 500])
    assert (late.time, late.source, late.operator) == (0.6, "gaze", "operator")


def test_one_poll_gives_at_most_one_cursor_and_none_without_new_samples(write: Write, at: ContextAt) -> None:
    gaze = opened(write(rests((200, 200), (900, 500))))
    assert len(gaze.poll(at(0.5))) == 1
    assert gaze.poll(at(0.5)) == []


def test_the_loss_of_the_cursor_is_sent_once(write: Write, at: ContextAt) -> None:
    commands = play(opened(write(rests((200, 200), None, (900, 500)))), at, 2.0)
    lost = [c.time for c in commands if isinstance(c, Cursor) and np.isnan(c.point).all()]
    assert lost == pytest.approx([0.4, 1.2], abs=0.021), "in the gap, and behind the end"


def test_gaze_never_draws_without_the_clutch(write: Write, at: ContextAt) -> None:
    assert strokes(play(opened(write(rests(*FIVE))), at, 3.0)) == []


def test_under_the_clutch_fixations_draw_a_stroke_that_grows_live(write: Write, at: ContextAt) -> None:
    gaze = opened(write(rests(*FIVE)))
    commands = strokes(play(gaze, at, 3.0, held=lambda time: time < 1.9))
    assert isinstance(commands[0], StrokeBegin)
    assert isinstance(commands[-1], StrokeEnd)
    np.testing.assert_allclose(drawn(commands), FIVE, atol=1e-6)
    grown_at = [command.time for command in commands if isinstance(command, StrokePoints)]
    assert grown_at[:4] == pytest.approx([0.4, 0.8, 1.2, 1.6], abs=0.05)
    assert commands[-1].time == pytest.approx(1.9)


def test_a_fixation_in_progress_when_the_clutch_opens_is_the_last_point(write: Write, at: ContextAt) -> None:
    commands = play(opened(write(rests(*FIVE))), at, 3.0, held=lambda time: time < 1.35)
    np.testing.assert_allclose(drawn(commands), FIVE[:4], atol=1e-6)


def test_a_fixation_in_progress_when_the_clutch_closes_is_the_first_point(write: Write, at: ContextAt) -> None:
    commands = play(opened(write(rests(*FIVE))), at, 3.0, held=lambda time: 0.6 < time < 1.9)
    np.testing.assert_allclose(drawn(commands), FIVE[1:], atol=1e-6)


def test_a_stroke_of_two_fixations_is_cancelled_with_the_reason_in_the_status(write: Write, at: ContextAt) -> None:
    gaze = opened(write(rests(*FIVE)))
    commands = strokes(play(gaze, at, 1.2, held=lambda time: time < 0.6))
    assert isinstance(commands[-1], StrokeCancel)
    assert "last stroke: 2 fixations, dropped" in gaze.health(1.2).detail


def test_smoothing_is_half_a_degree_on_the_ground(write: Write, at: ContextAt) -> None:
    file = write(rests(*FIVE))
    commands = play(opened(file, screen="1920x1080", px_per_deg="38"), at, 3.0, held=lambda time: time < 1.9)
    end = commands[-1] if isinstance(commands[-1], StrokeEnd) else strokes(commands)[-1]
    assert isinstance(end, StrokeEnd)
    assert end.smoothing == pytest.approx(0.5 * 38 * 700 / 1080)


def test_a_stroke_waits_for_confirm_with_commit_confirm(write: Write, at: ContextAt) -> None:
    def waits(**options: str) -> bool:
        commands = strokes(play(opened(write(rests(*FIVE)), **options), at, 3.0, held=lambda time: time < 1.9))
        assert isinstance(commands[-1], StrokeEnd)
        return commands[-1].preview

    assert waits(commit="confirm")
    assert not waits()


def test_a_loss_of_gaze_ends_the_stroke_until_the_clutch_opens(write: Write, at: ContextAt) -> None:
    eyes = (*FIVE, None, None, None, None, None, *FIVE)
    gaze = opened(write(rests(*eyes)))
    commands = strokes(play(gaze, at, 8.0, held=lambda time: time < 5.9 and not 5.0 < time < 5.1))
    kinds = [type(command).__name__ for command in commands if not isinstance(command, StrokePoints)]
    times = [command.time for command in commands if not isinstance(command, StrokePoints)]
    assert kinds == ["StrokeBegin", "StrokeEnd", "StrokeBegin", "StrokeEnd"]
    assert times == pytest.approx([0.0, 2.0 + 1.5, 5.1, 5.9], abs=0.05)


def test_a_clutch_closed_while_gaze_is_lost_waits_for_gaze(write: Write, at: ContextAt) -> None:
    gaze = opened(write(rests((200, 200), None, None, None, None, None, None, *FIVE)))
    commands = strokes(play(gaze, at, 5.0, held=lambda time: 2.4 < time < 4.7))
    assert [type(c).__name__ for c in commands if not isinstance(c, StrokePoints)] == ["StrokeBegin", "StrokeEnd"]
    np.testing.assert_allclose(drawn(commands), FIVE, atol=1e-6)


def test_paused_draws_while_the_team_is_paused(write: Write, at: ContextAt) -> None:
    gaze = opened(write(rests(*FIVE)), clutch="paused")
    commands = [c for k in range(100) for c in gaze.poll(at(k * 0.02, paused=k * 0.02 < 1.9, clutch=True))]
    assert [type(c).__name__ for c in strokes(commands) if not isinstance(c, StrokePoints)] == [
        "StrokeBegin",
        "StrokeEnd",
    ]


def test_always_makes_the_whole_recording_one_stroke(write: Write, at: ContextAt) -> None:
    blind = (None, None, None, None, None)
    commands = strokes(play(opened(write(rests(*FIVE[:3], *blind, *FIVE[3:])), clutch="always"), at, 6.0))
    assert [type(c).__name__ for c in commands if not isinstance(c, StrokePoints)] == ["StrokeBegin", "StrokeEnd"]
    np.testing.assert_allclose(drawn(commands), FIVE, atol=1e-6)


def test_start_shifts_the_recording_on_the_session_clock(write: Write, at: ContextAt) -> None:
    file = write(rests(*FIVE))
    plain = play(opened(file), at, 2.5, held=lambda time: time < 1.9)
    shifted = play(opened(file, start="10"), at, 12.5, held=lambda time: time < 11.9, start=10.0)
    assert drawn(plain) == drawn(shifted)
    assert opened(file, start="10").poll(at(9.9)) == []
    np.testing.assert_allclose(
        drawn(play(opened(file, start="-1.0"), at, 1.5, held=lambda time: time < 0.9)), FIVE[2:], atol=1e-6
    )


def test_a_run_that_starts_again_plays_the_recording_again(write: Write, at: ContextAt) -> None:
    gaze = opened(write(rests(*FIVE)))
    once = play(gaze, at, 3.0, held=lambda time: time < 1.9)
    again = play(gaze, at, 3.0, held=lambda time: time < 1.9)
    assert drawn(once) == drawn(again)
    assert [c.sequence for c in once + again] == list(range(len(once + again)))


def test_the_three_frames_give_the_same_gaze(write: Write, at: ContextAt) -> None:
    screen = fit(InputSpec("gaze").arena, 1600, 900)
    pixels = screen.to_screen(np.array(FIVE, dtype=np.float64)).tolist()
    found = [
        drawn(play(opened(write(rests(*points), name), frame=frame, screen="1600x900", clutch="always"), at, 3.0))
        for name, frame, points in (
            ("a.csv", "arena", FIVE),
            ("s.csv", "screen", [(x, y) for x, y in pixels]),
            ("u.csv", "unit", [(x / 1600, y / 900) for x, y in pixels]),
        )
    ]
    np.testing.assert_allclose(found[1], found[0], atol=1e-6)
    np.testing.assert_allclose(found[2], found[0], atol=1e-6)


def test_the_browsers_viewport_is_used_with_viewport_browser(write: Write, at: ContextAt) -> None:
    file = write(rests((0.5, 0.5)))
    browser = Viewport(800, 600, 100.0, 50.0, 0.5)
    for choice, expected in (("browser", [100, 50]), ("fit", [600, 350])):
        cursor = opened(file, frame="unit", viewport=choice).poll(at(0.1, viewport=browser))[-1]
        assert isinstance(cursor, Cursor)
        np.testing.assert_allclose(cursor.point, expected)


def test_gaze_off_the_screen_is_lost_gaze(write: Write, at: ContextAt) -> None:
    gaze = opened(write(rests((500, 500), (500, 1300), (500, 500))), frame="screen", screen="1920x1080")
    commands = play(gaze, at, 1.1)
    assert any(isinstance(c, Cursor) and np.isnan(c.point).all() for c in commands)
    assert "40 samples off the screen" in gaze.health(1.0).detail


def test_samples_of_low_confidence_are_lost_gaze(write: Write, at: ContextAt) -> None:
    rows = "".join(f"{k / 100},5,5,{0.5 if k < 50 else 0.9}\n" for k in range(100))
    file = write("time,x,y,confidence\n" + rows)
    assert opened(file).poll(at(0.4)) == []
    assert len(opened(file, min_confidence="0.4").poll(at(0.4))) == 1
    with pytest.raises(InputError, match="no gaze sample is confident and on the screen"):
        opened(file, min_confidence="0.95")


def test_gaze_without_a_frame_is_refused_with_the_choices(write: Write) -> None:
    with pytest.raises(InputError, match=r"give frame=arena \(metres\), frame=screen .* or frame=unit"):
        open_gaze(InputSpec("gaze", write(rests(*FIVE))))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"frame": "moon"}, "frame: 'moon' is not one of arena, screen, unit"),
        ({"clutch": "maybe"}, "clutch: 'maybe' is not one of held, paused, always"),
        ({"screen": "big"}, "screen: 'big' is not WIDTHxHEIGHT in pixels"),
        ({"screen": "0x5"}, "screen: '0x5' is not WIDTHxHEIGHT in pixels"),
        ({"px_per_deg": "-1"}, "px_per_deg: -1.0 is not a number from 1 to 1000 px/deg"),
        ({"start": "soon"}, "start: 'soon' is not a number"),
        (
            {"colour": "red"},
            "colour: unknown key; value 'red'; known keys: format, stream, x, y, frame, origin, screen",
        ),
    ],
)
def test_wrong_options_are_refused_with_the_choices(write: Write, options: dict[str, str], message: str) -> None:
    with pytest.raises(InputError) as refusal:
        opened(write(rests(*FIVE)), **options)
    assert message in str(refusal.value)


def test_options_of_the_command_line_take_precedence(write: Write, at: ContextAt) -> None:
    spec = InputSpec(
        "gaze",
        write(rests(*FIVE)),
        options={"start": "0"},
        settings={"frame": "arena", "start": 100.0, "clutch": "always"},
    )
    assert len(strokes(open_gaze(spec).poll(at(0.1)))) == 1


def test_an_assumed_screen_size_is_noted(write: Write) -> None:
    detail = opened(write(rests(*FIVE)), frame="screen").health(0.0).detail
    assert "screen size unknown, assumed 1920 x 1080 px" in detail


def test_health_runs_from_never_seen_over_live_to_ended(write: Write, at: ContextAt) -> None:
    gaze = opened(write(rests(*FIVE, start=1.0)))
    gaze.poll(at(0.5))
    assert gaze.health(0.5).state is ChannelState.NEVER_SEEN
    gaze.poll(at(1.5))
    assert gaze.health(1.5).state is ChannelState.LIVE
    gaze.poll(at(9.0))
    assert gaze.health(9.0).state is ChannelState.ENDED
    assert gaze.health(9.0).detail.startswith("replayed to its end")
    gaze.close()
    gaze.close()


def test_a_gap_in_the_recording_hides_the_cursor_and_makes_the_channel_stale(write: Write, at: ContextAt) -> None:
    rows = "".join(f"{k / 100},5,5\n" for k in [*range(100), *range(400, 500)])
    gaze = opened(write("time,x,y\n" + rows))
    gaze.poll(at(0.99))
    assert gaze.poll(at(1.4)) == [], "the newest sample still counts"
    (lost,) = gaze.poll(at(1.6))
    assert isinstance(lost, Cursor)
    assert np.isnan(lost.point).all()
    assert gaze.health(1.6).state is ChannelState.STALE


def test_the_recorded_tobii_excerpt_draws_one_stroke(sample: Callable[[str], Path], at: ContextAt) -> None:
    file = str(sample("tobii_prolab_de_excerpt/prolab_de_first600rows.tsv"))
    commands = play(open_gaze(InputSpec("gaze", file, options={"clutch": "always"})), at, 5.0)
    points = np.array(drawn(commands))
    assert len(points) == 11
    expected = fit(InputSpec("gaze").arena, 1920, 1080).to_ground(np.array([[950.0, 490.5]]))[0]
    np.testing.assert_allclose(points[0], expected, atol=2.0)
    assert [type(c).__name__ for c in strokes(commands) if not isinstance(c, StrokePoints)] == [
        "StrokeBegin",
        "StrokeEnd",
    ]
