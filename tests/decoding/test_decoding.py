"""Pictures are decoded in a child: what harms it is refused in a sentence, and the next one is read."""

import io
import multiprocessing
import subprocess
import sys
import threading
import tracemalloc
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import psutil
import pytest
from PIL import Image, PngImagePlugin

from hostile_pictures import LINE, SLOW, chunk, embedded, eps, hostile, secret_picture, svg, white_tiff
from normalgan.decoding import decode, process
from normalgan.errors import InputError, RunError
from normalgan.inference.reading.drawings import read_drawing, read_pixels
from normalgan.inference.reading.picture import read_picture
from normalgan.studio.drawings.imports import import_picture

SIDES = (8, 8192)


@pytest.fixture
def pool(monkeypatch: pytest.MonkeyPatch) -> Iterator[process._Pool]:
    """Give a pool of children of its own, which have a second for each picture."""
    monkeypatch.setattr(process, "CPU_SECONDS", 1)
    monkeypatch.setattr(process, "_pool", process._Pool(2))
    yield process._pool
    process._pool.close()


def encoded(image: Image.Image, kind: str = "PNG", **settings: object) -> bytes:
    file = io.BytesIO()
    image.save(file, kind, **settings)
    return file.getvalue()


def grey(value: int, side: int = 32) -> bytes:
    return encoded(Image.new("L", (side, side), value))


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no limits of processor time and memory")
@pytest.mark.parametrize("endless", [False, pytest.param(True, marks=pytest.mark.slow)])  # seconds each
def test_hostile_pictures_are_refused_in_one_sentence(
    tmp_path: Path, pool: process._Pool, monkeypatch: pytest.MonkeyPatch, endless: bool
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(process, "WALL_SECONDS", 240.0)
    for name, (content, sentence) in hostile(secret_picture(tmp_path / "secret.png")).items():
        if (sentence == SLOW) != endless:
            continue
        with pytest.raises(InputError, match=sentence) as refused:
            read_pixels(Path(name), content)
        told = str(refused.value)
        assert not isinstance(refused.value, RunError), told
        assert name in told
        assert "\n" not in told
        assert len(told) < 300
        assert read_pixels(Path("next.png"), grey(99)).pixels[0, 0] == 99  # in another child, if it must be
    assert [path.name for path in tmp_path.iterdir()] == ["secret.png"]


@pytest.mark.slow
def test_a_crash_is_told_and_the_next_picture_is_read(pool: process._Pool) -> None:
    pool.start()
    child = pool._idle[0]._process
    read_pixels(Path("a.png"), grey(1))
    pool._idle[0]._ready = True
    psutil.Process(child.pid).suspend()  # so that it ends while a picture is waited for
    killer = threading.Timer(0.5, child.kill)
    killer.start()
    with pytest.raises(
        InputError, match=r"^b\.png cannot be decoded: its decoder crashed \((SIGKILL|exit code 1)\)\.$"
    ):
        read_pixels(Path("b.png"), grey(2))
    assert read_pixels(Path("c.png"), grey(3)).pixels[0, 0] == 3
    pool._idle[0]._process.kill()  # while it waits
    pool._idle[0]._process.wait()
    assert read_pixels(Path("d.png"), grey(4)).pixels[0, 0] == 4


def test_the_clock_ends_what_takes_no_processor_time(
    pool: process._Pool, monkeypatch: pytest.MonkeyPatch
) -> None:
    read_pixels(Path("a.png"), grey(1))
    monkeypatch.setattr(process, "WALL_SECONDS", 0.5)
    psutil.Process(pool._idle[0]._process.pid).suspend()
    with pytest.raises(InputError, match=r"b\.png cannot be decoded: it takes more than 0 seconds"):
        read_pixels(Path("b.png"), grey(2))


def test_a_child_that_does_not_start_is_no_fault_of_the_picture(
    pool: process._Pool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(process, "_folders", list)
    with pytest.raises(RunError, match="process that decodes pictures does not start: ModuleNotFoundError"):
        read_pixels(Path("a.png"), grey(1))
    monkeypatch.setattr(sys, "executable", "/nowhere/python")
    with pytest.raises(RunError, match=r"no process can be started to decode pictures: .+\.$"):
        read_pixels(Path("a.png"), grey(1))


def test_threads_get_each_its_own_picture(pool: process._Pool) -> None:
    got: dict[int, int] = {}

    def read(value: int) -> None:
        got[value] = int(read_pixels(Path("a.png"), grey(value, 8 + value)).pixels.mean())

    threads = [threading.Thread(target=read, args=(value,)) for value in range(24)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert got == {value: value for value in range(24)}
    assert len(pool._idle) <= 2


def _read_in_a_fork(value: int) -> int:
    return int(read_pixels(Path("a.png"), grey(value)).pixels[0, 0])


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no fork")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_fork_starts_a_child_of_its_own() -> None:
    assert _read_in_a_fork(5) == 5
    with multiprocessing.get_context("fork").Pool(2) as workers:
        assert workers.map(_read_in_a_fork, [6, 7, 8]) == [6, 7, 8]
    assert _read_in_a_fork(9) == 9


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such limit")
def test_the_child_can_open_no_file_even_if_the_check_were_passed(tmp_path: Path) -> None:
    secret = secret_picture(tmp_path / "secret.png")
    drawing = svg(f'<image width="64" height="64" href="{secret}"/>').decode()
    program = f"""
import sys
sys.path.extend({[process._HERE, *process._folders()]!r})
from decoders.pictures import decode
from decoders.worker import import_all, limit
from resvg_py import svg_to_bytes
dark = []
def draw():
    image, _ = decode(bytes(svg_to_bytes(svg_string={drawing!r}, width=64)), 8, 64, 64, 0, True, [])
    dark.append(image.tobytes().count(0))
import_all('')
draw()
limit(2**31)
draw()
try:
    open({str(secret)!r})
except OSError as error:
    print(*[count > 2000 for count in dark], error.strerror)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split(maxsplit=2) == ["True", "False", "Too many open files\n"]


@pytest.mark.slow
def test_a_small_file_of_a_large_picture_takes_little_memory() -> None:
    content = white_tiff(8192, channels=4)
    assert len(content) < 400_000
    read_pixels(Path("a.png"), grey(1))
    tracemalloc.start()
    try:
        made = import_picture(content)
        assert (made["width"], made["height"]) == (2048, 2048)
        assert tracemalloc.get_traced_memory()[1] < 250e6
        tracemalloc.reset_peak()
        assert read_picture(Path("a.tiff"), content).shape == (8192, 8192)
        assert tracemalloc.get_traced_memory()[1] < 250e6
    finally:
        tracemalloc.stop()


def test_a_picture_whose_notes_hold_an_svg_is_a_picture(tmp_path: Path) -> None:
    notes = PngImagePlugin.PngInfo()
    notes.add_text("source", '<svg xmlns="http://www.w3.org/2000/svg"></svg>')
    assert read_pixels(Path("a.png"), encoded(Image.new("L", (16, 16), 7), pnginfo=notes)).pixels.max() == 7


@pytest.mark.parametrize(
    "content",
    [
        svg("").decode().encode("utf-16"),
        b"\xef\xbb\xbf\n" + svg(""),
        svg("", '<?xml version="1.0" encoding="windows-1252"?><!-- ' + "long " * 2000 + "-->"),
        f'<!DOCTYPE svg [<!ENTITY ns "http://www.w3.org/2000/svg">]><svg xmlns="&ns;" viewBox="0 0 64 64">'
        f"{LINE}</svg>".encode(),
        b'<s:svg xmlns:s="http://www.w3.org/2000/svg" viewBox="0 0 64 64">'
        + f"{LINE.replace('<', '<s:')}</s:svg>".encode(),
        svg('<a href="https://example.org"><text>"&lt;&amp;</text></a><style>a { fill: "#000" }</style>'),
        svg(f'<use xlink:href="#b"/><g id="b">{LINE}</g><use href="other.svg#b"/>'),
    ],
    ids=["UTF-16", "a mark", "a long comment", "an entity", "a prefix", "a link", "uses"],
)
def test_sound_svgs_are_drawn(content: bytes) -> None:
    pixels = read_pixels(Path("a.svg"), content, 64).pixels
    assert pixels.shape == (64, 64, 4)
    assert pixels[32, 32].tolist() == [0, 0, 0, 255]
    assert pixels[32, 2, 3] == 0


def test_a_picture_in_an_svg_is_drawn() -> None:
    inner = encoded(Image.new("RGB", (9, 9), (0, 128, 255)))
    assert read_pixels(Path("a.svg"), svg(embedded(inner)), 64).pixels[60, 4].tolist() == [0, 128, 255, 255]


@pytest.mark.parametrize("kind", ["TIFF", "MPO", "WEBP", "BMP"])
def test_formats_are_read_that_need_more_of_pillow(kind: str) -> None:
    image = Image.new("RGB", (40, 24), (200, 100, 50))
    more = {"save_all": True, "append_images": [image]} if kind == "MPO" else {}
    pixels = read_pixels(Path("a"), encoded(image, kind, **more)).pixels
    assert pixels.shape == (24, 40, 3)
    assert np.abs(pixels.astype(int) - (200, 100, 50)).max() < 4


def test_reduced_pictures_keep_their_shape_and_the_colours_that_are_seen() -> None:
    image = Image.new("RGBA", (200, 100), (255, 0, 0, 0))
    image.paste((0, 0, 255, 255), (0, 0, 101, 100))
    decoded = decode("a", encoded(image), SIDES, 64, longest=50)
    assert decoded.shape == (100, 200)
    assert decoded.pixels.shape == (25, 50, 4)
    assert decoded.pixels[5, 25].tolist() == [0, 0, 255, 64]  # a quarter of it; nothing of the unseen red
    deep = Image.fromarray(np.full((100, 200), 40_000, np.uint16))
    assert np.unique(decode("a", encoded(deep), SIDES, 64, longest=50).pixels).tolist() == [40_000]
    done, floats = cv2.imencode(
        ".tiff", np.full((100, 200, 3), 0.5, np.float32)
    )  # which Pillow does not read
    assert done
    decoded = decode("a", floats.tobytes(), SIDES, 64, longest=50)
    assert (decoded.shape, decoded.pixels.shape, decoded.pixels[0, 0, 0]) == ((100, 200), (25, 50, 3), 0.5)


def test_a_program_under_the_name_of_a_picture_is_not_run(tmp_path: Path) -> None:
    (tmp_path / "a.png").write_bytes(eps())
    with pytest.raises(InputError, match=r"a\.png is not an image that can be read"):
        read_drawing(tmp_path / "a.png")


def test_a_header_that_lies_about_a_chunk_is_refused() -> None:
    content = grey(1)
    with pytest.raises(InputError, match="cannot be read as an image"):
        read_pixels(Path("a.png"), content[:33] + chunk(b"tRNS", b"") * 2 + content[33:40])
