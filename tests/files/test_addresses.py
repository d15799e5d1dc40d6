"""Models by address, from a server of this machine."""

import contextlib
import hashlib
import http.server
import re
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

import normalgan
from normalgan.__main__ import main
from normalgan.errors import InputError
from normalgan.files.addresses import kept_files, local_file, parse_address
from normalgan.weights.shipped import SHIPPED

SHA = hashlib.sha256(SHIPPED.read_bytes()).hexdigest()
COMMIT = "0123456789abcdef0123456789abcdef01234567"


class Handler(http.server.BaseHTTPRequestHandler):
    """Serves one file at any address that ends in model.onnx, as the hub's server does."""

    asked: list[str]
    shown = threading.Event()  # whether the half of a file that is sent at once was shown

    def do_HEAD(self) -> None:
        self._answer(False)

    def do_GET(self) -> None:
        # Where the client hangs up, the server's traceback would reach the error stream of a later test.
        with contextlib.suppress(ConnectionError):
            self._answer(True)

    def _answer(self, body: bool) -> None:
        if "/slow/headers/" in self.path:
            self._drip()
        self.asked.append(f"{self.command} {self.path}")
        there = self.path.endswith("model.onnx") and not re.search("/private/|/v9/", self.path)
        self.send_response(200 if there else 404)
        content = SHIPPED.read_bytes() if there else b""
        if "/private/" in self.path:
            self.send_header("X-Error-Code", "RepoNotFound")
        elif "/v9/" in self.path:
            self.send_header("X-Error-Code", "RevisionNotFound")
        elif not there:
            self.send_header("X-Error-Code", "EntryNotFound")
        self.send_header("ETag", f'"{SHA}"')
        self.send_header("X-Repo-Commit", COMMIT)
        if "/chunks/" in self.path:
            self.send_header("Transfer-Encoding", "chunked")
            content = b"3e8\r\n" + content[:10]  # of 1000 bytes that are announced
        else:
            self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        if "/slow/body/" in self.path:
            self._drip()
        elif body and "/half/" in self.path:
            self.wfile.write(content[: len(content) // 2])
            self.wfile.flush()
            self.shown.wait(30)
            self.wfile.write(content[len(content) // 2 :])
        elif body:
            self.wfile.write(content[:1000] if "/cut/" in self.path else content)

    def _drip(self) -> None:
        """Send a byte every tenth of a second, until nobody listens or for half a minute."""
        with contextlib.suppress(OSError):
            for _ in range(300):
                self.wfile.write(b"a")
                self.wfile.flush()
                time.sleep(0.1)

    def log_message(self, *_: object) -> None:
        """Say nothing."""


@pytest.fixture(name="asked")
def make_asked() -> list[str]:
    return []


@pytest.fixture(name="server")
def make_server(asked: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    handler = type("_Handler", (Handler,), {"asked": asked})
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        monkeypatch.setenv("NORMALGAN_CACHE", str(tmp_path / "kept"))
        monkeypatch.setenv("HF_ENDPOINT", f"http://127.0.0.1:{server.server_port}")
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


def test_a_model_is_fetched_once_and_loaded(server: str, asked: list[str], tmp_path: Path) -> None:
    address = f"{server}/v1/model.onnx#sha256={SHA}"
    assert normalgan.load(address).backend.size == 256
    assert normalgan.load(address).backend.size == 256
    assert asked == ["GET /v1/model.onnx"]
    (kept,) = kept_files()
    assert (kept.address, kept.path.name) == (address, "model.onnx")
    kept.path.write_bytes(b"damaged")  # is fetched again
    assert local_file(address).read_bytes() == SHIPPED.read_bytes()


def test_models_lists_what_comes_with_the_package_and_what_was_fetched(
    server: str, capsys: pytest.CaptureFixture[str]
) -> None:
    address = f"{server}/model.onnx#sha256={SHA}"
    local_file(address)
    assert main(["models"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0] == "shipped"
    assert said[2] == said[5]
    assert said[2].startswith("  15.2 MB, ResidualUNetGenerator, 256 pixels, licence ")
    assert said[3] == address


def test_a_hash_that_differs_is_refused_and_nothing_is_kept(server: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=f"has the SHA-256 hash {SHA}, not {64 * 'a'}; it was not kept"):
        normalgan.load(f"{server}/model.onnx#sha256={64 * 'a'}")
    assert not [path for path in (tmp_path / "kept").rglob("*") if path.is_file()]


@pytest.mark.parametrize(
    ("kind", "said"),
    [
        ("cut", rf"stopped after 1000 of {SHIPPED.stat().st_size} bytes; try again\.$"),
        ("chunks", "in the middle"),
    ],
)
def test_an_answer_that_is_cut_off_is_told_as_such(server: str, tmp_path: Path, kind: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        normalgan.load(f"{server}/{kind}/model.onnx#sha256={SHA}")
    assert not (tmp_path / "kept").exists()


@pytest.mark.parametrize(
    ("where", "said"),
    [("body", "sends less than 20 bytes a second"), ("headers", "does not answer: timed out")],
)
def test_a_server_that_drips_does_not_hold_us(
    server: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, where: str, said: str
) -> None:
    monkeypatch.setattr("normalgan.files.addresses._TIMEOUT", 1)
    monkeypatch.setattr("normalgan.files.addresses._LOWEST_SPEED", 20)
    with pytest.raises(InputError, match=said):
        normalgan.load(f"{server}/slow/{where}/model.onnx#sha256={SHA}")
    assert not (tmp_path / "kept").exists()


def test_a_slow_download_is_shown_while_it_lasts(server: str, monkeypatch: pytest.MonkeyPatch) -> None:
    bars: list[tuple[str, int]] = []
    steps: list[int] = []

    def advance(more: int) -> None:
        steps.append(more)
        if sum(steps) >= SHIPPED.stat().st_size // 2000:
            Handler.shown.set()

    @contextlib.contextmanager
    def bar(title: str, total: int, unit: str, shown: bool, stays: bool) -> Iterator[Callable[[int], None]]:
        bars.append((f"{title}, {unit}", total))
        assert shown
        assert not stays
        yield advance

    monkeypatch.setattr("normalgan.files.addresses.progress_bar", bar)
    monkeypatch.setattr("normalgan.files.addresses._STEP", 0.01)
    Handler.shown.clear()
    assert local_file(f"{server}/half/model.onnx#sha256={SHA}").is_file()
    assert bars == [("downloading model.onnx, kB", SHIPPED.stat().st_size // 1000)]
    assert Handler.shown.is_set()


def test_an_address_that_does_not_answer_is_told_in_a_sentence(server: str, tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
    with pytest.raises(InputError, match=r"does not answer: .*refused"):
        normalgan.load(f"http://127.0.0.1:{port}/model.onnx#sha256={SHA}")
    with pytest.raises(InputError, match="answers 404"):
        normalgan.load(f"{server}/gone.onnx#sha256={SHA}")
    assert not (tmp_path / "kept").exists()


@pytest.mark.parametrize(
    ("address", "sentence"),
    [
        ("https://example.org/model.onnx", "needs the hash of its file"),
        ("https://example.org/model.onnx#sha256=12", "needs the hash of its file"),
        (f"ftp://example.org/model.onnx#sha256={SHA}", "has the scheme ftp"),
        (f"https://example.org/#sha256={SHA}", "does not end in the name of a file"),
        (f"https://example.org/%2e%2e#sha256={SHA}", "does not end in the name of a file"),
        (f"hf://owner#sha256={SHA}", "is not hf://owner/name"),
    ],
)
def test_an_address_that_cannot_be_used_is_refused(address: str, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        normalgan.load(address)


LOAD = """
import sys, normalgan
from normalgan.errors import InputError
for address in sys.argv[1:]:
    try:
        print(normalgan.load(address).backend.size)
    except InputError as error:
        print(error)
"""
"""A program that says of each address how large the model there paints, or why there is none."""


@pytest.mark.slow
def test_a_model_on_the_hub(
    server: str, asked: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HF_HOME", str(tmp_path / "hub"))  # read when the library is imported
    address = f"hf://owner/name@v1#sha256={SHA}"
    wrong = [
        f"hf://owner/name/other.bin#sha256={SHA}",
        f"hf://private/name#sha256={SHA}",
        f"hf://owner/name@v9#sha256={SHA}",
    ]
    # The right one comes last: what is kept is found by its hash, whatever the address.
    command = [sys.executable, "-c", LOAD, *wrong, address]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    *refusals, size = done.stdout.splitlines()
    assert size == "256"
    assert refusals[0].startswith("owner/name on the hub has no file other.bin")
    assert refusals[1].startswith("the hub has no repository private/name")
    assert refusals[2].startswith("owner/name on the hub has no revision v9")
    assert len(refusals) == 3
    assert "GET /owner/name/resolve/v1/model.onnx" in asked[-1] or COMMIT in asked[-1]
    assert [kept.address for kept in kept_files()] == [address]


@pytest.mark.slow
def test_a_hub_that_does_not_answer_is_told_in_a_sentence(
    server: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        monkeypatch.setenv("HF_ENDPOINT", f"http://127.0.0.1:{taken.getsockname()[1]}")
    monkeypatch.setenv("HF_HOME", str(tmp_path / "hub"))
    command = [sys.executable, "-c", LOAD, f"hf://owner/name#sha256={SHA}"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert re.fullmatch(r"hf://owner/name does not answer: .*refused\.", done.stdout.strip())
    assert not (tmp_path / "kept").exists()


def test_the_hub_needs_an_extra(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("NORMALGAN_CACHE", str(tmp_path))
    monkeypatch.setitem(sys.modules, "huggingface_hub", None)
    with pytest.raises(
        InputError, match=r"needs huggingface_hub; install it with pip install 'normalgan\[hub\]'"
    ):
        normalgan.load(f"hf://owner/name#sha256={SHA}")


def test_the_hash_may_be_in_capitals() -> None:
    assert parse_address(f"https://example.org/a/model.onnx#sha256={SHA.upper()}").sha256 == SHA
