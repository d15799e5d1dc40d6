from io import BytesIO

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from PIL.GifImagePlugin import GifImageFile

from normalgan.arrays import Floats
from normalgan.errors import InputError
from normalgan.inference.normal_map import NormalMap
from normalgan.inference.outputs.lighting import Clay, lamp_direction, shade
from normalgan.inference.outputs.preview import Preview, lit, preview_gif, preview_png, sheet, turn


def ball(size: int = 64) -> tuple[Floats, NDArray[np.bool_]]:
    along = ((np.arange(size) + 0.5) / size * 2 - 1) / 0.7
    x, y = np.meshgrid(along, -along)
    mask = x**2 + y**2 < 1
    z = np.sqrt(np.maximum(1 - x**2 - y**2, 0))
    return (np.stack([x, y, z], axis=-1) * mask[..., None]).astype(np.float32), mask


def brightest(picture: NDArray[np.uint8]) -> tuple[float, float]:
    """Where the light is, x right and y up from the middle in units of the ball's radius."""
    level = picture[:-12, :-12].astype(np.float64).sum(-1)  # without the ball in the corner
    y, x = np.nonzero(level > np.quantile(level, 0.99))
    half = picture.shape[0] / 2
    return (x.mean() + 0.5 - half) / half / 0.7, -(y.mean() + 0.5 - half) / half / 0.7


@pytest.mark.parametrize("azimuth", [0, 45, 90, 200, 315])
def test_the_light_comes_from_where_it_is_said_to(azimuth: float) -> None:
    x, y = brightest(lit(*ball(), azimuth=azimuth, elevation=40))
    assert np.hypot(x, y) > 0.4
    turned = (np.degrees(np.arctan2(y, x)) - azimuth + 180) % 360 - 180
    assert abs(turned) < 12


def test_shading_is_lamberts_law_without_gloss_and_sky() -> None:
    normals, mask = ball()
    black = (0.0, 0.0, 0.0)
    matt = Clay(colour=(0.5, 0.5, 0.5), lamp=(1.0, 1.0, 1.0), sky=black, ground=black, gloss=0)
    light = lamp_direction(130, 35)
    assert np.linalg.norm(light) == pytest.approx(1)
    shaded = shade(normals, light, matt)[mask]
    expected = 0.5 * np.clip(normals[mask] @ np.array(light, np.float32), 0, None)
    np.testing.assert_allclose(shaded, np.repeat(expected[:, None], 3, axis=1), atol=1e-6)


def test_the_highlight_stands_between_lamp_and_viewer() -> None:
    normals, mask = ball(129)
    light = lamp_direction(90, 30)
    gloss = shade(normals, light, Clay(gloss=1)) - shade(normals, light, Clay(gloss=0))
    y, x = np.unravel_index(np.argmax(gloss[..., 0] * mask), mask.shape)
    halfway = np.add(light, (0, 0, 1))
    np.testing.assert_allclose(normals[y, x], halfway / np.linalg.norm(halfway), atol=0.04)


def test_the_light_goes_around_clockwise_from_the_upper_left() -> None:
    places = [brightest(picture) for picture in turn(*ball(), frames=4)]
    signs = [(x > 0, y > 0) for x, y in places]
    assert signs == [(False, True), (True, True), (True, False), (False, False)]


def test_the_ball_in_the_corner_is_lit_as_the_object() -> None:
    normals, mask = ball(128)
    picture = lit(normals, mask, azimuth=0)
    small = picture[-20:-4, -20:-4].astype(int).sum(-1)
    assert small[8, 12] > small[8, 3] + 100


def test_off_the_object_there_is_paper_and_alpha_blends() -> None:
    normals, mask = ball()
    nothing = lit(normals, np.zeros(mask.shape, dtype=bool), 90)
    paper = nothing[0, 0]
    assert (lit(normals, mask, 90)[:4, :4] == paper).all()
    assert (nothing[:40] == paper).all()
    full, half = (lit(normals, a * mask.astype(np.float32), 90)[32, 32].astype(int) for a in (1.0, 0.5))
    assert (paper < half).all()
    assert (half < full).all()


def test_the_animation_turns_and_is_the_same_every_time() -> None:
    normals, mask = ball()
    first = preview_gif(normals, mask, frames=8, seconds=1.6)
    assert first == preview_gif(normals, mask, frames=8, seconds=1.6)
    with Image.open(BytesIO(first)) as gif:
        assert isinstance(gif, GifImageFile)
        assert gif.n_frames == 8
        assert gif.info["duration"] == 200
        assert gif.info["loop"] == 0
        for i, wanted in enumerate(turn(normals, mask, 8)):
            gif.seek(i)
            error = np.abs(np.asarray(gif.convert("RGB")).astype(int) - wanted)
            assert error.max() < 24
            assert error.mean() < 2


def test_the_sheet_holds_the_turn() -> None:
    normals, mask = ball()
    png = preview_png(normals, mask, frames=8)
    assert png == preview_png(normals, mask, frames=8)
    whole = np.asarray(Image.open(BytesIO(png)))
    pictures = turn(normals, mask, 8)
    assert whole.shape == (2 * 64 + 2, 4 * 64 + 3 * 2, 3)
    assert (whole[66:, 66:130] == pictures[5]).all()
    assert (whole == sheet(pictures)).all()


def test_the_preview_of_a_large_map_is_reduced() -> None:
    normals, mask = np.tile(np.array([0, 0, 1], np.float32), (1100, 2200, 1)), np.ones((1100, 2200), np.bool_)
    preds = NormalMap(normals, mask, mask.astype(np.float32))
    (content,) = Preview("gif").encode(preds).values()
    with Image.open(BytesIO(content)) as gif:
        assert gif.size == (1024, 512)


def test_tiny_pictures_have_no_room_for_the_ball() -> None:
    normals, mask = ball(8)
    assert lit(normals, mask, 0).shape == (8, 8, 3)


def test_what_cannot_be_lit_is_refused() -> None:
    normals, mask = ball(16)
    with pytest.raises(InputError, match="not a direction"):
        shade(normals, (0, 0, 0))
    with pytest.raises(InputError, match=r"shape \(16, 16, 3\) does not match an opacity of \(15, 16\)"):
        lit(normals, mask[1:], 0)
    with pytest.raises(InputError, match="at least one frame, not 0"):
        turn(normals, mask, 0)
