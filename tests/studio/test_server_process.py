import contextlib
import http.client
import json
import re
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from studio_client import asking, circle, document, png
from studio_process import Studio, running, send, slow, until

from normalgan.__main__ import main
from normalgan.studio.projects.document_store import DocumentStore


@pytest.mark.slow  # starts two studios
def test_a_server_killed_while_it_saves_leaves_a_whole_project(model: Path, tmp_path: Path) -> None:
    def filled(number: int) -> dict[str, object]:
        return document(strokes=[number] * 200_000)

    known = [document(strokes=[number] * 200_000) for number in range(3)]
    for kill in range(2):
        with running(model, tmp_path) as studio:
            status, _, headers = studio.ask("GET", "/api/projects/fox")
            tag = headers["etag"] if status == 200 else None
            saved = threading.Event()

            def save(studio: Studio = studio, tag: str | None = tag, saved: threading.Event = saved) -> None:
                with contextlib.suppress(OSError, http.client.HTTPException):
                    for content in known * 50:
                        guard = {"If-Match": tag} if tag else {"If-None-Match": "*"}
                        status, _, headers = studio.ask("PUT", "/api/projects/fox", content, guard)
                        assert status == 204
                        tag = headers["etag"]
                        saved.set()

            saving = threading.Thread(target=save)
            saving.start()
            assert saved.wait(60)
            time.sleep(0.02 + 0.013 * kill)
            studio.process.kill()
            saving.join()
        assert json.loads((tmp_path / "fox.normalgan").read_bytes()) in known
    assert [entry["name"] for entry in DocumentStore(tmp_path).entries()] == ["fox"]
    assert not list(tmp_path.glob(".*.tmp"))


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no signals that a process may answer")
@pytest.mark.parametrize(("number", "code"), [(signal.SIGTERM, 0), (signal.SIGINT, 130)])
def test_a_signal_ends_it_once_all_is_answered(model: Path, tmp_path: Path, number: int, code: int) -> None:
    (tmp_path / "cat.png").write_bytes(png(circle()))
    with running(model, tmp_path / "p", str(tmp_path / "cat.png")) as studio:
        assert studio.ask("GET", "/api/open")[1] == {"kind": "drawing", "name": "cat"}
        assert studio.ask("GET", "/api/open/file")[1] == png(circle())
        connection = send(studio, "/api/predict", asking(1, **slow()))
        until(lambda: studio.ask("GET", "/api/about")[0] == 200)
        studio.process.send_signal(number)
        assert connection.getresponse().status == 200
        connection.close()
        out, err = studio.process.communicate(timeout=60)
        assert studio.process.returncode == code
        assert "Traceback" not in out + err
        assert err == ("normalgan: stopped.\n" if code else "")


def test_a_taken_port_is_told(model: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        taken = other.getsockname()[1]
        for port, sentence in (
            (taken, f"normalgan: port {taken} is taken, perhaps by another studio; give another --port"),
            (70000, "normalgan: port is 70000; use 1 to 65535, or 0 for a free port."),
        ):
            assert main(["studio", "--model", str(model), "--port", str(port), "--no-browser"]) == 2
            said = capsys.readouterr()
            assert said.err.startswith(sentence)
            assert said.out == ""
            assert len(said.err.splitlines()) == 1


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--model", "none.onnx"], "there is no model none.onnx"),
        (["nothing"], "there is neither a project nor a file called nothing"),
        (["--port", "x"], "expected a whole number, not x"),
        (["--prot", "1"], "there is no option --prot. Did you mean --port?"),
    ],
)
def test_what_cannot_be_used_is_told_before_it_starts(
    model: Path, tmp_path: Path, arguments: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    more = [] if "--model" in arguments else ["--model", str(model)]
    assert main(["studio", *arguments, *more, "--projects", str(tmp_path), "--no-browser"]) == 2
    said = capsys.readouterr().err
    assert sentence in said
    assert len(said.splitlines()) == 1


def test_help_and_imports_are_light(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["studio", "--help"]) == 0
    assert re.search(r"--projects .*\n?.*folder of the projects", capsys.readouterr().out)
    code = (
        "import sys, normalgan.studio.command; heavy = {'torch', 'lightning', 'kornia', 'trimesh', "
        "'skimage', 'matplotlib', 'scipy.sparse', 'pyamg'}; sys.exit(str(heavy & set(sys.modules) or ''))"
    )
    done = subprocess.run([sys.executable, "-c", code], check=False, capture_output=True, text=True)
    assert done.stderr.strip() == ""
