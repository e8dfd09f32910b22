"""Both themes are legible, and tell apart by more than hue; computed, without a browser."""

from itertools import combinations

import numpy as np
import pytest

from higvf_console.ui.theme import (
    CSS,
    DARK,
    LIGHT,
    LIGHT_GAIN,
    NOMINAL,
    TEXT_SIZES,
    THEMES,
    Look,
    Palette,
    batch_rgb,
    hex_rgb,
    line_rgb,
    mesh_rgb,
    vertex_rgb,
)
from higvf_console.ui.widgets.html import style_html

BOTH = pytest.mark.parametrize("palette", [DARK, LIGHT], ids=["dark", "light"])
# WCAG 2.2, success criteria 1.4.3 and 1.4.11: https://www.w3.org/TR/WCAG22/
TEXT, MARK = 4.5, 3.0
IN_ARENA = ("axis_text", "robot_text", "fire_edge", "scorched_text")
IN_PANEL = ("text", "dim", "warning", "alarm", "progress", "operator", "own_target")
ON_BADGE = ("robot", "warning", "alarm", "progress")
MARKS = (
    "robot", "operator", "stroke", "fire", "fire_edge", "fighting", "progress", "trouble", "gaze", "obstacle_edge",
    "scorched_edge", "own_target", "neighbours", "so_far", "formation", "way_round", "hold", "safety",
)  # fmt: skip
# What must never be taken for each other: in the arena, and among the bands of authority shares.
TOLD_APART = (
    ("robot", "operator", "fire", "trouble"),
    ("operator", "own_target", "neighbours", "safety"),
)
# Machado, Oliveira and Fernandes (2009), severity 1.0, on linear light.
BLINDNESS = {
    "none": np.eye(3),
    "protan": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "deutan": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    "tritan": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
}
LEAST_APART = 15.0  # CIE76 difference; some 2 are just seen


def linear(colour: str) -> np.ndarray:
    encoded = np.array(hex_rgb(colour)) / 255
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def contrast(one: str, other: str) -> float:
    """WCAG contrast ratio of two colours, in [1, 21]."""
    low, high = sorted(float(linear(colour) @ [0.2126, 0.7152, 0.0722]) for colour in (one, other))
    return (high + 0.05) / (low + 0.05)


def lab(light: np.ndarray) -> np.ndarray:
    """CIE L*a*b* of linear sRGB light (3,), white D65."""
    to_xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
    ratio = to_xyz @ np.clip(light, 0.0, 1.0) / to_xyz.sum(axis=1)
    x, y, z = np.where(ratio > 0.008856, np.cbrt(ratio), 7.787 * ratio + 16 / 116)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def test_the_measure_of_contrast_knows_its_ends() -> None:
    assert contrast("#000000", "#ffffff") == pytest.approx(21.0)
    assert contrast("#777777", "#ffffff") == pytest.approx(4.48, abs=0.01)


@BOTH
def test_text_stands_out_from_what_it_is_written_on(palette: Palette) -> None:
    pairs = [(name, "floor") for name in IN_ARENA] + [("axis_text", "surround"), ("fire_text", "fire")]
    pairs += [(name, ground) for name in IN_PANEL for ground in ("panel", "card")] + [("text", "key")]
    pairs += [("badge_text", name) for name in ON_BADGE]
    found = {pair: contrast(*(getattr(palette, name) for name in pair)) for pair in pairs}
    assert {pair: round(ratio, 2) for pair, ratio in found.items() if ratio < TEXT} == {}


@BOTH
def test_marks_stand_out_from_the_floor(palette: Palette) -> None:
    found = {name: contrast(getattr(palette, name), palette.floor) for name in MARKS}
    assert {name: round(ratio, 2) for name, ratio in found.items() if ratio < MARK} == {}


@BOTH
@pytest.mark.parametrize("blindness", BLINDNESS)
def test_what_must_not_be_mistaken_differs_for_colour_blind_people_too(palette: Palette, blindness: str) -> None:
    def seen(name: str) -> np.ndarray:
        return lab(np.array(BLINDNESS[blindness]) @ linear(getattr(palette, name)))

    gaps = {
        pair: float(np.linalg.norm(seen(pair[0]) - seen(pair[1])))
        for group in TOLD_APART
        for pair in combinations(group, 2)
    }
    assert {pair: round(gap, 1) for pair, gap in gaps.items() if gap < LEAST_APART} == {}


@BOTH
def test_the_style_sheet_gives_every_colour_its_value(palette: Palette) -> None:
    style = style_html(Look(palette))
    for name, colour in palette._asdict().items():
        assert f"--hg-{name}:{colour};" in style
    assert all(variable.startswith("var(--hg-") for variable in CSS)
    assert "#" not in style.split("}", 1)[1], "a colour outside the palette"


def test_a_text_size_scales_lettering_and_leaves_marks_alone() -> None:
    large = NOMINAL.lettered(TEXT_SIZES["Large"])
    assert large.text / NOMINAL.text == large.axis_text / NOMINAL.axis_text == pytest.approx(TEXT_SIZES["Large"])
    assert large.robot == NOMINAL.robot
    assert THEMES["Dark"] == Look().palette


def aces(light: np.ndarray) -> np.ndarray:
    """three.js' film curve, from its shader."""
    matrix_in = np.array([[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]])
    matrix_out = np.array([[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]])
    v = matrix_in @ (light / 0.6)
    return np.clip(
        matrix_out @ ((v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081)), 0, 1
    )


def to_linear(encoded: np.ndarray) -> np.ndarray:
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def to_bytes(linear: np.ndarray) -> np.ndarray:
    return 255 * np.where(linear <= 0.0031308, linear * 12.92, 1.055 * linear ** (1 / 2.4) - 0.055)


@pytest.mark.parametrize(
    ("colour", "tolerance"),  # bright saturated colours lie a little beyond what the curve can reach
    [("#141414", 3), ("#1c2127", 3), ("#8b96a5", 3), ("#cc79a7", 3), ("#56b4e9", 13), ("#d55e00", 13)],
)
def test_a_colour_is_seen_as_it_is_written_in_spite_of_the_film_curve(colour: str, tolerance: int) -> None:
    written = np.array(hex_rgb(colour))
    mesh = aces(LIGHT_GAIN * to_linear(np.array(mesh_rgb(colour)) / 255))
    line = aces(to_linear(np.array(line_rgb(colour)) / 255))
    assert np.abs(to_bytes(mesh) - written).max() <= tolerance
    assert np.abs(to_bytes(line) - written).max() <= tolerance


@pytest.mark.parametrize("colour", ["#56b4e9", "#d55e00", "#009e73", "#cc79a7"])
def test_batches_and_line_ends_whose_bytes_are_linear_show_the_same_colour(colour: str) -> None:
    written = np.array(hex_rgb(colour))
    batch = aces(LIGHT_GAIN * np.array(batch_rgb(colour)) / 255)
    vertex = aces(np.array(vertex_rgb(colour)) / 255)
    assert np.abs(to_bytes(batch) - written).max() < 12
    assert np.abs(to_bytes(vertex) - written).max() < 12
