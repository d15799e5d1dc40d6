"""What the studio's viewer draws, with WebGL and without, against NumPy."""

import base64
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
import pytest
import viewer_references as references
from numpy.typing import NDArray
from viewer_page import View, Viewer, open_viewer

from chromium import browser

if TYPE_CHECKING:
    from playwright.sync_api import Browser

SIDE = 96
BACKGROUND = (60, 70, 80)
LIGHT = (0.3, 0.7, 0.6)


@pytest.fixture(
    scope="module", params=[True, pytest.param(False, marks=pytest.mark.slow)], ids=["webgl", "plain"]
)
def webgl(request: pytest.FixtureRequest) -> bool:
    """First a browser with WebGL, then one without."""
    return bool(request.param)


@pytest.fixture(scope="module")
def opened(webgl: bool) -> Iterator["Browser"]:
    """Chromium, with WebGL or without."""
    with browser(webgl=webgl) as chromium:
        yield chromium


@pytest.fixture(scope="module")
def only_page(opened: "Browser") -> Iterator[Viewer]:
    """One page for all tests: opening one takes longer than they do."""
    with open_viewer(opened, SIDE, SIDE) as viewer:
        yield viewer


@pytest.fixture
def viewer(only_page: Viewer) -> Viewer:
    """A viewer that nothing has been done to."""
    only_page.renew()
    return only_page


def inside(rgba: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """Where neither the object's rim nor the background is near: at rims, GPUs filter as they like."""
    full = rgba[..., 3] == 255
    around = [np.roll(full, (dy, dx), (0, 1)) for dy in (-1, 0, 1) for dx in (-1, 0, 1)]
    return np.asarray(np.all(around, axis=0))


def luminance(picture: NDArray[np.uint8]) -> NDArray[np.float64]:
    return np.asarray(np.mean(picture, axis=-1, dtype=np.float64))


@pytest.mark.parametrize(
    ("view", "typical", "worst"),
    # A matcap is a table of 256 × 256 and steps are steep, so that a few pixels may differ by more.
    [("lit", 0.5, 2), ("matcap", 0.8, 60), ("flat", 0.5, 12)],
)
def test_each_view_is_the_shading_of_the_reference(
    viewer: Viewer, view: View, typical: float, worst: int
) -> None:
    rgba = references.ball(SIDE)
    viewer.set_map(rgba)
    viewer.set_light(LIGHT)
    viewer.set_view(view)
    shown = viewer.screen()
    wanted = getattr(references, view)(rgba, LIGHT)
    difference = np.abs(shown - wanted.astype(float))[inside(rgba)]
    assert difference.mean() < typical
    assert difference.max() <= worst
    assert np.percentile(difference, 99) <= 8
    assert (np.abs(shown - np.array(BACKGROUND))[rgba[..., 3] == 0] <= 1).all()


def test_the_map_is_shown_as_it_is_on_a_checker(viewer: Viewer) -> None:
    rgba = references.ball(SIDE)
    viewer.set_map(rgba)
    viewer.set_view("map")
    shown = viewer.screen().astype(int)
    full = rgba[..., 3] == 255
    assert np.abs(shown - rgba[..., :3])[full].max() <= 1
    assert (np.abs(shown[:8, :8] - np.array(BACKGROUND)) <= 1).all()
    half_grey = 0.75 * np.array(BACKGROUND) + 0.25 * 127.5
    assert (np.abs(shown[:8, 8:16] - half_grey) <= 2).all()


@pytest.mark.slow
def test_a_large_map_is_shaded_whole_when_the_light_rests(viewer: Viewer) -> None:
    # More pixels than are shaded at once while the light moves, where there is no WebGL.
    rgba = references.ball(1024)
    viewer.set_map(rgba)
    viewer.set_view("lit")
    viewer.set_light(LIGHT)
    viewer.page.evaluate("rested()")
    whole = viewer.screen()
    for light in ((1, 0, 0.2), (0, 1, 0.2)):
        viewer.set_light(light)
        moving = viewer.screen()
    assert np.abs(moving.astype(int) - whole).max() > 50
    viewer.set_light(LIGHT)
    near = viewer.screen().astype(int)
    viewer.page.evaluate("rested()")
    assert np.array_equal(viewer.screen(), whole)
    assert np.abs(near - whole).mean() < 3  # what is shown meanwhile is the same light


def test_colours_and_falloff_are_the_same_with_and_without_a_graphics_card(viewer: Viewer) -> None:
    rgba = references.ball(SIDE)
    viewer.set_map(rgba)
    viewer.set_view("lit")
    viewer.set_light(LIGHT)
    clay = viewer.screen().astype(float)
    viewer.page.evaluate(
        """([side, light]) => {
          const pixels = new Uint8Array(4 * side * side);
          for (let i = 0; i < side * side; i++)
            pixels.set([220, 30, 20, i % side < side / 2 ? 255 : 0], 4 * i);
          viewer.setColours({ rgba: pixels, width: side, height: side });
          viewer.setLights({ direction: light, colour: [1, 1, 1] }, null, 0.5);
        }""",
        [SIDE, list(LIGHT)],
    )
    # What the file is made of is what is on show, however that is drawn.
    shaded = viewer.page.evaluate(
        """([text, side]) => {
          const pixels = new Uint8Array(4 * side * side);
          for (let i = 0; i < side * side; i++)
            pixels.set([220, 30, 20, i % side < side / 2 ? 255 : 0], 4 * i);
          const map = { rgba: bytes(text), width: side, height: side };
          return Array.from(viewer.shaded(map, { rgba: pixels, width: side, height: side }));
        }""",
        [base64.b64encode(rgba.tobytes()).decode(), SIDE],
    )
    wanted = np.array(shaded, np.uint8).reshape(SIDE, SIDE, 4)[..., :3].astype(float)
    shown = viewer.screen().astype(float)
    full = inside(rgba)
    left, right = full.copy(), full.copy()
    left[:, SIDE // 2 - 2 :] = right[:, : SIDE // 2 + 2] = False
    assert np.abs(shown - wanted)[left | right].mean() < 1
    assert (shown[left][:, 0] - shown[left][:, 2]).mean() > 60  # red paint
    assert (shown[right] - clay[right]).mean() > -120  # white paper
    assert np.abs(shown[right][:, 0] - shown[right][:, 2]).mean() < 40


def test_light_from_the_right_and_from_above_lights_the_right_and_the_top(viewer: Viewer) -> None:
    viewer.set_map(references.ball(SIDE))
    for view in ("lit", "matcap", "flat"):
        viewer.set_view(view)
        viewer.set_light((1, 0, 0.2))
        sideways = luminance(viewer.screen())
        viewer.set_light((0, 1, 0.2))
        upright = luminance(viewer.screen())
        middle = slice(SIDE // 3, 2 * SIDE // 3)
        assert sideways[middle, 60:80].mean() > sideways[middle, 16:36].mean() + 20, view
        assert upright[16:36, middle].mean() > upright[60:80, middle].mean() + 20, view


def test_an_enlarged_rim_has_no_colour_of_the_background(viewer: Viewer) -> None:
    rgba = np.zeros((12, 12, 4), np.uint8)
    rgba[...] = 128, 128, 255, 0
    rgba[3:9, 3:9] = 230, 128, 204, 255
    viewer.set_map(rgba)
    light = (1.0, -2.0, 0.0)  # a normal that is mixed with the background's would lie in the shade
    viewer.set_view("flat")
    viewer.set_light(light)
    shown = viewer.screen().astype(float)
    wanted = references.flat(rgba[3:4, 3:4], light)[0, 0]
    background = np.array(BACKGROUND, float)
    assert np.abs(shown[44:52, 44:52] - wanted).max() <= 2
    # Every pixel lies on the straight line between the surface's colour and the background.
    along = wanted - background
    share = np.clip((shown - background) @ along / (along @ along), 0, 1)[..., None]
    assert np.abs(shown - background - share * along).max() <= 4


def test_a_map_of_another_shape_lies_in_the_middle_and_wrong_sizes_are_refused(viewer: Viewer) -> None:
    rgba = np.full((24, 48, 4), 255, np.uint8)
    rgba[..., :2] = 128
    viewer.set_map(rgba)
    bright = luminance(viewer.screen()) > 120
    with pytest.raises(Exception, match="16 values do not make 5 × 5 × 4"):
        viewer.page.evaluate("viewer.setMap(new Uint8Array(16), 5, 5)")
    with pytest.raises(Exception, match="no view is called plaid"):
        viewer.page.evaluate("viewer.setView('plaid')")
    viewer.page.evaluate("viewer.setMap(null)")
    empty = viewer.screen()
    assert bright[26:70].all()
    assert not bright[:22].any()
    assert not bright[74:].any()
    assert (empty == BACKGROUND).all()


@pytest.mark.slow
def test_a_dense_screen_gets_a_dense_canvas_that_follows_its_size(opened: "Browser") -> None:
    with open_viewer(opened, SIDE, SIDE, scale=2) as viewer:
        viewer.set_map(references.ball(SIDE))
        assert viewer.page.evaluate("[document.querySelector('canvas').width]") == [2 * SIDE]
        assert viewer.screen().shape == (2 * SIDE, 2 * SIDE, 3)
        viewer.page.evaluate("document.querySelector('canvas').style.width = '48px'")
        shown = viewer.screen()
        assert viewer.page.evaluate("[document.querySelector('canvas').width]") == [SIDE]
    assert (shown[:, 2 * 48 :] == BACKGROUND).all()
    assert luminance(shown)[SIDE, SIDE // 2] > 100


def test_without_webgl_the_relief_says_so_in_words(viewer: Viewer, webgl: bool) -> None:
    viewer.set_map(references.ball(SIDE))
    viewer.set_view("relief")
    letters = int((luminance(viewer.screen()) > 200).sum())
    viewer.set_view("lit")
    assert luminance(viewer.screen())[SIDE // 2, SIDE // 2] > 100
    assert viewer.page.evaluate("viewer.available") is webgl
    assert viewer.page.evaluate("said") == ([] if webgl else ["no relief here", None])
    assert letters == 0 if webgl else 30 < letters < 1500
