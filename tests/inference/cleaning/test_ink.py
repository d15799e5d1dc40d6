from pathlib import Path

import cv2
import numpy as np
import pytest

from normalgan.arrays import Floats
from normalgan.errors import InputError
from normalgan.inference.cleaning.ink import Cleaned, clean
from normalgan.inference.cleaning.reader import read
from normalgan.inference.mask.decision import decide
from normalgan.inference.preparation import prepare
from normalgan.inference.reading.picture import Picture
from pens import blob, outline, overlap

FILLED = blob()
INK = outline(FILLED)
RNG = np.random.default_rng(0)


def grey(ink: Floats, paper: float = 1.0, pen: float = 0.0) -> Floats:
    return np.asarray(np.multiply.outer(paper + (pen - paper) * ink, np.ones(3)), np.float32)


def shaded(colour: Floats) -> Floats:
    """Return a photo of a drawing: yellowish paper, light from one side, grain."""
    x = np.linspace(0, 1, colour.shape[1])[None, :, None]
    tinted = colour * np.array([0.9, 0.84, 0.7]) * (1 - 0.5 * x)
    return np.asarray(np.clip(tinted + RNG.normal(0, 0.015, colour.shape), 0, 1), np.float32)


def cleaned_of(picture: Picture) -> Cleaned:
    return clean(picture, read(picture))


def assert_only_its_edge_is_shown(picture: Picture) -> None:
    """Hold a drawing without lines to its object, and what the network is shown to that one's edge."""
    prepared = prepare(picture, 128)
    assert prepared.mask is not None
    assert overlap(prepared.mask, FILLED) > 0.95
    within = prepared.frame.cut(np.asarray(cv2.erode(FILLED, np.ones((25, 25))), np.float32)) > 0.5
    assert prepared.model_input[within].max() < 0.3
    assert (prepared.model_input > 0.5).sum() > 128


def assert_same_lines(ink: Floats, truth: Floats = INK) -> None:
    """Hold lines to those drawn: all of them are there, and nothing else is."""
    drawn, found = truth > 0.5, ink > 0.5
    assert (ink[cv2.erode(drawn.astype(np.uint8), np.ones((2, 2))) > 0] > 0.3).mean() > 0.97
    near = cv2.dilate(drawn.astype(np.uint8), np.ones((5, 5))) > 0
    assert found[~near].sum() <= 2
    assert overlap(decide(ink, None).mask, np.maximum(FILLED, truth > 0.5)) > 0.95


@pytest.mark.parametrize(
    "colour",
    [
        grey(INK),
        grey(INK, 0.93, 0.55),
        shaded(grey(INK)),
        shaded(grey(INK, 1, 0.4)),
        grey(INK, 0.1, 0.9),
        1 - INK[..., None] * np.array([0.1, 0.8, 0.7], np.float32),
        1 - INK[..., None] * np.array([0.02, 0.1, 0.7], np.float32),
        np.array([0.1, 0.2, 0.6], np.float32) + INK[..., None] * np.array([0.8, 0.7, 0.4], np.float32),
    ],
    ids=["ink", "pencil", "photo", "pale photo", "chalk", "red", "yellow", "blueprint"],
)
def test_lines_are_found_on_any_paper(colour: Floats) -> None:
    cleaned = cleaned_of(Picture(colour, None))
    assert cleaned.silhouette is None
    assert_same_lines(cleaned.ink)


def test_a_clean_drawing_stays_as_it_is() -> None:
    ink = cleaned_of(Picture(grey(INK), None)).ink
    assert np.abs(ink - INK).mean() < 0.003
    assert ((ink > 0.5) == (INK > 0.5)).mean() > 0.99


def test_strokes_are_the_ink_as_they_are() -> None:
    assert np.abs(clean(Picture(grey(INK), None), None).ink - INK).max() < 1e-6
    with pytest.raises(InputError, match="no lines were found"):
        clean(Picture(grey(0 * INK), None), None)


@pytest.mark.parametrize("pen", [0.0, 0.4, 1.0])
def test_lines_on_nothing_are_ink_whatever_their_colour(pen: float) -> None:
    cleaned = cleaned_of(Picture(np.full((*INK.shape, 3), pen, np.float32), INK))
    assert cleaned.silhouette is None
    assert_same_lines(cleaned.ink)


@pytest.mark.parametrize("paint", [0.0, 0.5, 1.0])
def test_a_cut_out_figure_has_its_silhouette_and_its_edge_as_a_line(paint: float) -> None:
    colour = np.full((*FILLED.shape, 3), paint, np.float32)
    cleaned = cleaned_of(Picture(colour, FILLED))
    assert cleaned.silhouette is not None
    assert (cleaned.silhouette == (FILLED > 0.5)).all()
    assert_only_its_edge_is_shown(Picture(colour, FILLED))


@pytest.mark.parametrize("glass", [0.3, 0.45])
def test_translucent_areas_that_a_figure_encloses_belong_to_it_and_holes_do_not(glass: float) -> None:
    lines = INK.copy()
    lines[55:95, 155:195] = 1
    lines[60:90, 160:190] = 0
    alpha = np.maximum(glass * FILLED, lines).astype(np.float32)
    alpha[60:90, 160:190] = 0
    alpha[-3:] = glass  # a shadow below it
    cleaned = cleaned_of(Picture(np.repeat(0.5 * (1 - lines[..., None]), 3, -1), alpha))
    assert cleaned.silhouette is not None
    inside = cv2.erode(FILLED, np.ones((3, 3), np.uint8)) > 0.5
    inside[60:90, 160:190] = False
    assert cleaned.silhouette[inside].all()
    assert not cleaned.silhouette[60:90, 160:190].any()
    assert not cleaned.silhouette[-3:].any()


def test_much_black_ink_on_nothing_is_no_silhouette() -> None:
    # A black belly below a white face.
    alpha = FILLED.copy()
    alpha[:100] = 0
    alpha = np.maximum(alpha, INK)
    assert cleaned_of(Picture(np.zeros((*alpha.shape, 3), np.float32), alpha)).silhouette is None
    assert cleaned_of(Picture(np.full((*alpha.shape, 3), 0.5, np.float32), alpha)).silhouette is not None


@pytest.mark.parametrize("paint", [0.05, 0.5, 0.7])
def test_a_painted_shape_on_paper_becomes_its_outline(paint: float) -> None:
    assert_only_its_edge_is_shown(Picture(grey(FILLED, 1, paint), None))


def test_lines_on_a_painted_body_are_seen() -> None:
    eye = np.zeros_like(INK)
    cv2.line(eye, (150, 80), (190, 100), 1, 3)
    ink = cleaned_of(Picture(grey(np.maximum(0.5 * FILLED, eye), 1, 0), None)).ink
    assert (ink[eye > 0] > 0.5).mean() > 0.9


@pytest.mark.parametrize("mortar", [(70, 40, 40), (220, 215, 205)], ids=["dark", "light"])
def test_the_joints_of_a_surface_that_repeats_are_its_lines(mortar: tuple[int, int, int]) -> None:
    wall = np.full((256, 256, 3), (170, 80, 60), np.float32)
    joints = np.zeros((256, 256), np.bool_)
    for row, top in enumerate(range(0, 256, 32)):
        joints[top : top + 3] = True
        for left in range(32 * (row % 2), 256, 64):
            joints[top : top + 32, left : left + 3] = True
    wall[joints] = mortar
    picture = Picture(wall / np.float32(255), None)
    ink = clean(picture, read(picture), repeats=True).ink
    assert ink[joints].mean() > 0.9
    assert ink[~joints].mean() < 0.1


def test_close_lines_of_a_surface_stay_apart() -> None:
    drawn = np.zeros((512, 512), np.float32)
    drawn[40::64] = drawn[41::64] = drawn[45::64] = drawn[46::64] = 1
    picture = Picture(grey(drawn), None)
    ink = clean(picture, read(picture), repeats=True).ink
    assert ink[drawn > 0].min() > 0.9
    assert ink[drawn == 0].max() < 0.1


def test_a_small_figure_on_a_large_page_has_its_silhouette() -> None:
    alpha, colour = np.zeros((900, 900), np.float32), np.full((900, 900, 3), 0.5, np.float32)
    alpha[40:100, 700:790] = cv2.resize(FILLED, (90, 60), interpolation=cv2.INTER_AREA)
    assert cleaned_of(Picture(colour, alpha)).silhouette is not None


def test_a_white_figure_with_a_dark_outline_on_nothing_has_just_that_line() -> None:
    line = INK * FILLED
    colour = np.repeat(1 - line[..., None], 3, axis=-1)
    ink = cleaned_of(Picture(colour, FILLED)).ink
    inner = cv2.erode(FILLED, np.ones((15, 15))) > 0
    assert ink[line > 0.9].mean() > 0.9
    assert ink[inner].max() < 0.1


def test_dust_is_left_out() -> None:
    dusty = INK.copy()
    dusty[10, 10] = dusty[180, 280] = 1
    ink = cleaned_of(Picture(grey(dusty), None)).ink
    assert max(ink[:20, :20].max(), ink[170:, 270:].max()) < 0.3


@pytest.mark.parametrize("level", [0.0, 0.5, 1.0])
def test_an_empty_sheet_is_refused(level: float) -> None:
    with pytest.raises(InputError, match="no lines were found"):
        cleaned_of(Picture(np.full((50, 60, 3), level, np.float32), None))


@pytest.mark.slow
def test_shared_sketches_are_all_seen(shared_sketches: list[Path]) -> None:
    from normalgan.inference.reading.picture import read_picture

    for path in shared_sketches:
        cleaned = cleaned_of(read_picture(path))
        assert (cleaned.ink > 0.5).mean() > 0.002, path
        if path.suffix == ".svg":
            assert cleaned.silhouette is not None, path


@pytest.mark.parametrize("painted", [False, True])
def test_a_grey_drawing_has_the_ink_of_one_with_a_touch_of_colour(painted: bool) -> None:
    colour = grey(0.5 * FILLED) if painted else np.repeat(shaded(grey(INK))[..., :1], 3, axis=-1)
    tinted = colour.copy()
    tinted[0, 0] += np.array([0, 1e-6, 0], np.float32)
    assert (tinted != colour).any()
    assert np.abs(cleaned_of(Picture(colour, None)).ink - cleaned_of(Picture(tinted, None)).ink).max() < 1e-4


def test_what_is_transparent_all_over_has_no_line() -> None:
    with pytest.raises(InputError, match="no lines were found in it"):
        prepare(Picture(np.zeros((40, 40, 3), np.float32), np.zeros((40, 40), np.float32)), 64)


def test_the_lines_of_a_tile_are_the_dark_outlines_of_its_spots_and_not_the_spots() -> None:
    tile = np.full((48, 48), 85, np.uint8)
    outline, inside = np.zeros_like(tile), np.zeros_like(tile)
    for x, y, radius in ((8, 10, 4), (30, 8, 3), (20, 24, 5), (40, 30, 4), (9, 38, 4), (30, 42, 2)):
        cv2.circle(inside, (x, y), radius - 1, 1, -1)
        cv2.circle(outline, (x, y), radius, 1)
    tile[inside > 0], tile[outline > 0] = 110, 50
    picture = Picture(np.repeat(tile[..., None] / np.float32(255), 3, -1), None)
    ink = clean(picture, read(picture), repeats=True).ink
    assert ink[outline > 0].mean() > 0.5
    assert ink[(inside > 0) & (outline == 0)].mean() < 0.1
