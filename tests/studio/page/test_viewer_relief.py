"""The viewer's relief, how it is moved, and what becomes of it when WebGL goes away."""

from collections.abc import Iterator

import numpy as np
import pytest
import viewer_references as references
from numpy.typing import NDArray
from scipy import ndimage
from viewer_page import Viewer, open_viewer

from chromium import browser
from normalgan.inference.outputs.lighting import shade, to_srgb

pytestmark = pytest.mark.slow  # a browser, which takes seconds to start
SIDE = 120
BACKGROUND = (60, 70, 80)
QUARTER_TURN = 18  # presses of an arrow


@pytest.fixture(scope="module")
def only_page() -> Iterator[Viewer]:
    """One page for all tests: opening one takes longer than they do."""
    tolerated = ("CONTEXT_LOST_WEBGL",)  # a test takes the context away
    with browser() as opened, open_viewer(opened, SIDE, SIDE, tolerate=tolerated) as viewer:
        yield viewer


@pytest.fixture
def viewer(only_page: Viewer) -> Viewer:
    """A viewer that nothing has been done to."""
    only_page.renew()
    return only_page


def drawn(viewer: Viewer) -> NDArray[np.bool_]:
    """Where the canvas shows something."""
    difference = np.abs(viewer.screen().astype(int) - BACKGROUND)
    return np.asarray(difference.max(axis=-1) > 8)


def press(viewer: Viewer, key: str, times: int = 1) -> None:
    viewer.page.focus("canvas")
    for _ in range(times):
        viewer.page.keyboard.press(key)


def leaning_cone(side: int = 240) -> NDArray[np.float32]:
    """Heights of a cone whose tip lies above and to the right of the middle."""
    at = (np.arange(side) + 0.5) / side * 2 - 1
    x, y = np.meshgrid(at, -at)
    to_tip = np.hypot(x - 0.3, y - 0.4)
    heights = np.where(np.hypot(x, y) < 0.8, side * (0.5 - 0.4 * to_tip), np.nan)
    return heights.astype(np.float32)


@pytest.mark.parametrize(
    ("key", "times", "yaw", "pitch"),
    [
        ("ArrowRight", QUARTER_TURN, 90, 0),
        ("ArrowLeft", 7, -35, 0),
        ("ArrowDown", 8, 0, 40),
        ("ArrowUp", 30, 0, -90),
    ],
)
def test_the_silhouette_is_that_of_the_heights(
    viewer: Viewer, key: str, times: int, yaw: float, pitch: float
) -> None:
    heights = leaning_cone()
    right, down = np.deg2rad([yaw, pitch])
    viewer.set_height(heights)
    viewer.set_view("relief")
    viewer.set_light((np.sin(right), -np.sin(down), np.cos(right) * np.cos(down)))
    press(viewer, key, times)
    shown = drawn(viewer)
    wanted = ndimage.binary_closing(references.silhouette(heights, right, down, SIDE))
    # The rim is smoothed, by less than a pixel of the screen but for a sharp tip.
    assert (ndimage.binary_erosion(wanted) & ~shown).sum() < 6
    assert not (shown & ~ndimage.binary_dilation(wanted)).any()


def test_a_relief_is_lit_by_the_normals_of_the_map_turned_with_it(viewer: Viewer) -> None:
    rgba = np.full((32, 32, 4), 255, np.uint8)
    rgba[..., :2] = 128  # everything looks at the viewer
    flat = np.zeros((32, 32), np.float32)
    viewer.set_map(rgba)
    viewer.set_height(flat)
    viewer.set_light((1, 0, 1))
    viewer.set_view("relief")
    for turns in (0, 6, -6):
        press(viewer, "ArrowRight" if turns > 0 else "ArrowLeft", abs(turns))
        centre = viewer.screen()[SIDE // 2, SIDE // 2].astype(int)
        press(viewer, "Home")
        yaw = turns * np.pi / 36
        normal = np.array([np.sin(yaw), 0, np.cos(yaw)], np.float32)
        wanted = to_srgb(shade(normal, (1, 0, 1))).astype(int)
        assert np.abs(centre - wanted).max() <= 3


def test_jumps_in_depth_are_cut_and_slopes_are_not(viewer: Viewer) -> None:
    step = np.repeat(np.array([[0, 40]], np.float32), 24, axis=1).repeat(48, axis=0)
    slope = np.tile(np.linspace(0, 40, 48, dtype=np.float32), (48, 1))
    gaps = []
    viewer.set_view("relief")
    press(viewer, "ArrowRight", 9)  # the right half, which is nearer, moves away from the left one
    for heights in (step, slope):
        viewer.set_height(heights)
        row = drawn(viewer)[SIDE // 2]
        first, last = np.flatnonzero(row)[[0, -1]]
        gaps.append(int((~row[first:last]).sum()))
    assert gaps[0] > 5
    assert gaps[1] == 0


def test_dragging_turns_the_relief_and_the_front_goes_with_the_pointer(viewer: Viewer) -> None:
    viewer.set_height(leaning_cone())
    viewer.set_view("relief")
    front = drawn(viewer)
    viewer.page.mouse.move(60, 60)
    viewer.page.mouse.down()
    viewer.page.mouse.move(90, 60, steps=3)  # a half of the radius: an eighth of a turn
    viewer.page.mouse.up()
    viewer.page.mouse.move(20, 100)  # no button is down: nothing turns
    dragged = drawn(viewer)
    press(viewer, "Home")
    press(viewer, "ArrowRight", QUARTER_TURN // 2)
    pressed = drawn(viewer)
    viewer.page.mouse.wheel(0, -400)
    enlarged = drawn(viewer)
    assert (front ^ dragged).sum() > 500
    assert (dragged ^ pressed).sum() < 20
    assert enlarged.sum() > 1.2 * pressed.sum()


def test_dragging_keys_and_wheel_move_the_light(viewer: Viewer) -> None:
    rgba = references.ball(SIDE)
    viewer.set_map(rgba)
    viewer.page.mouse.move(90, 30)
    viewer.page.mouse.down()
    viewer.page.mouse.up()
    assert viewer.page.evaluate("moves.at(-1)") == pytest.approx([0.5, 0.5, np.sqrt(0.5)], abs=1e-6)
    wanted = references.lit(rgba, (0.5, 0.5, np.sqrt(0.5)))
    difference = np.abs(viewer.screen().astype(int) - wanted)
    assert np.percentile(difference[rgba[..., 3] == 255], 95) <= 2
    press(viewer, "ArrowLeft")
    press(viewer, "Shift+ArrowDown")
    assert viewer.page.evaluate("moves.at(-1)")[:2] == pytest.approx([0.42, 0.26], abs=1e-6)
    viewer.page.mouse.wheel(0, 80)
    lower = viewer.page.evaluate("moves.at(-1)")
    assert lower[:2] == pytest.approx([0.42 * np.exp(0.1), 0.26 * np.exp(0.1)], abs=1e-6)
    press(viewer, "+")
    assert viewer.page.evaluate("moves.at(-1)")[2] > lower[2]
    count = viewer.page.evaluate("moves.length")
    viewer.set_view("map")
    press(viewer, "ArrowLeft")
    viewer.page.mouse.down()
    viewer.page.mouse.up()
    assert viewer.page.evaluate("moves.length") == count


def test_a_lost_context_comes_back_with_its_picture(viewer: Viewer) -> None:
    viewer.set_map(references.ball(SIDE))
    viewer.set_height(leaning_cone())
    before = viewer.screen()
    viewer.page.evaluate(
        "window.loser = document.querySelector('canvas').getContext('webgl2')"
        ".getExtension('WEBGL_lose_context'); loser.loseContext()"
    )
    viewer.page.wait_for_function("said.length === 1")
    viewer.set_view("lit")  # while it is away, nothing breaks
    viewer.set_map(references.ball(SIDE, 0.5))
    viewer.page.evaluate("loser.restoreContext()")
    viewer.page.wait_for_function("said.length === 2")
    smaller = viewer.screen()
    viewer.set_map(references.ball(SIDE))
    after = viewer.screen()
    viewer.set_view("relief")
    assert drawn(viewer).sum() > 1000
    assert viewer.page.evaluate("said") == ["lost", None]
    assert (smaller != before).any()
    assert (after == before).all()


def test_dispose_gives_everything_back(viewer: Viewer) -> None:
    left = viewer.page.evaluate("""async () => {
        const made = new Map();
        const kinds = ["Texture", "Buffer", "VertexArray", "Program", "Shader"];
        const gl = WebGL2RenderingContext.prototype;
        for (const kind of kinds) {
            const [create, remove] = [gl[`create${kind}`], gl[`delete${kind}`]];
            gl[`create${kind}`] = function (...args) {
                const thing = create.apply(this, args);
                made.set(thing, kind);
                return thing;
            };
            gl[`delete${kind}`] = function (thing) { made.delete(thing); remove.call(this, thing); };
        }
        const { Viewer } = await import("./result/viewer.js");
        const canvas = document.createElement("canvas");
        canvas.style.width = canvas.style.height = "50px";
        document.body.append(canvas);
        const moves = [];
        const second = new Viewer(canvas, { text: {}, onMove: () => moves.push(1) });
        const key = () => canvas.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowLeft" }));
        second.setHeight(new Float32Array(9), 3, 3);
        second.setView("matcap");
        key();
        await shown();
        const during = new Set(made.values());
        second.dispose();
        key();
        second.setView("lit");
        second.resize();
        return { during: during.size, after: made.size, moves: moves.length };
    }""")
    assert left == {"during": 4, "after": 0, "moves": 1}


def test_shaders_that_do_not_compile_are_reported_and_break_nothing(viewer: Viewer) -> None:
    said = viewer.page.evaluate("""async () => {
        const gl = WebGL2RenderingContext.prototype;
        const right = gl.shaderSource;
        gl.shaderSource = function (shader) { right.call(this, shader, "nonsense"); };
        renew(50, 50);
        gl.shaderSource = right;
        viewer.setMap(new Uint8Array(16), 2, 2);
        viewer.setView("relief");
        await shown();
        return said;
    }""")
    assert len(said) == 1
    assert said[0].startswith("failed: ")
    assert "syntax error" in said[0]
