import numpy as np
import pytest

from normalgan.arrays import Floats
from normalgan.rendering.media import Medium, bleed, on_paper, pencil, scanned


@pytest.fixture
def ink() -> Floats:
    """A soft cross, away from the border."""
    ink = np.zeros((64, 64), np.float32)
    ink[30:33, 10:54] = 1
    ink[10:54, 30:33] = 0.6
    return ink


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def test_strength_0_is_the_drawing_to_the_bit(ink: Floats) -> None:
    np.testing.assert_array_equal(Medium(strength=(0, 0)).apply(ink, rng()), ink)


def test_the_same_seed_gives_the_same_picture_and_another_another(ink: Floats) -> None:
    medium = Medium(strength=(1, 1))
    np.testing.assert_array_equal(medium.apply(ink, rng(1)), medium.apply(ink, rng(1)))
    assert not np.array_equal(medium.apply(ink, rng(1)), medium.apply(ink, rng(2)))


@pytest.mark.parametrize("seed", range(20))
def test_the_picture_stays_within_black_and_white_and_the_lines_stand_out(ink: Floats, seed: int) -> None:
    picture = Medium(strength=(1, 1)).apply(ink, rng(seed))
    assert picture.dtype == np.float32
    assert 0 <= picture.min() <= picture.max() <= 1
    assert picture[31, 12:50].mean() > 0.2 + picture[ink == 0].mean()


def test_bleeding_loses_no_ink_and_spreads_it_by_its_sigma(ink: Floats) -> None:
    dot = np.zeros((65, 65), np.float32)
    dot[32, 32] = 1
    run = bleed(dot, 2.0)
    assert run.sum() == pytest.approx(1, rel=1e-4)
    x = np.arange(65) - 32
    assert np.sqrt((run.sum(axis=0) * x**2).sum()) == pytest.approx(2, rel=0.02)
    np.testing.assert_array_equal(bleed(ink, 0), ink)


def test_pencil_never_darkens_and_spares_a_light_touch_more(ink: Floats) -> None:
    drawn = pencil(ink, 0.8, rng())
    assert (drawn <= ink).all()
    assert (drawn[ink == 1].mean() / 1.0) > (drawn[ink == np.float32(0.6)].mean() / 0.6)
    assert drawn[ink == 1].std() > 0.05  # the tooth of the paper shows
    np.testing.assert_array_equal(pencil(ink, 0, rng()), ink)


def test_tinted_paper_is_even_and_a_shadow_falls_from_one_side() -> None:
    blank = np.zeros((32, 48), np.float32)
    np.testing.assert_allclose(on_paper(blank, 0.1, 0, rng()), 0.1, atol=1e-6)
    shaded = on_paper(blank, 0, 0.3, rng())
    assert (shaded.min(), shaded.max()) == pytest.approx((0, 0.3), abs=1e-6)
    black = on_paper(np.ones((8, 8), np.float32), 0.1, 0.3, rng())
    np.testing.assert_allclose(black, 1)  # no light comes back from black


def test_noise_has_its_deviation() -> None:
    grey = np.full((128, 128), 0.5, np.float32)
    assert scanned(grey, 0.03, rng()).std() == pytest.approx(0.03, rel=0.05)
