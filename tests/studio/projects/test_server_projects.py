import json
import os
import queue
import threading
import time
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path
from typing import Any

import pytest
from filelock import FileLock
from starlette.testclient import TestClient
from studio_client import circle, document, png, serving

from normalgan.errors import InputError, RunError
from normalgan.studio.projects import document_store
from normalgan.studio.projects.document_store import DocumentStore
from normalgan.studio.projects.opening import find_opened
from normalgan.studio.server.refusals import ChangedError

NEW = {"If-None-Match": "*"}


@pytest.fixture
def client(model: Path, tmp_path: Path) -> Iterator[TestClient]:
    with serving(model, tmp_path / "projects") as client:
        yield client


def test_a_project_is_kept_read_and_deleted(client: TestClient, tmp_path: Path) -> None:
    assert client.get("/api/projects").json() == []
    content = document(strokes=[{"points": [1, 2.5, 0.5], "text": "ü"}], settings={"source": None})
    saved = client.put("/api/projects/Füchse 2", json=content, headers=NEW)
    assert (saved.status_code, saved.content) == (204, b"")
    read = client.get("/api/projects/Füchse 2")
    assert read.json() == content
    assert read.headers["etag"] == saved.headers["etag"]
    (entry,) = client.get("/api/projects").json()
    assert entry["name"] == "Füchse 2"
    assert entry["bytes"] == len(read.content)
    assert abs(datetime.fromisoformat(entry["changed"]).timestamp() - time.time()) < 60
    assert json.loads((tmp_path / "projects" / "Füchse 2.normalgan").read_bytes()) == content
    assert (
        client.delete("/api/projects/Füchse 2", headers={"If-Match": read.headers["etag"]}).status_code == 204
    )
    assert client.get("/api/projects/Füchse 2").status_code == 404
    assert client.get("/api/projects").json() == []


@pytest.mark.parametrize(
    "content",
    [
        json.dumps(document(settings={"zoom": float("nan")})).encode(),
        json.dumps(document(settings={"zoom": float("-inf")})).encode(),
        json.dumps(document()).encode("utf-16"),
        json.dumps(document()).encode("utf-8-sig"),
    ],
    ids=["NaN", "infinity", "UTF-16", "a mark"],
)
def test_what_a_browser_cannot_parse_is_not_kept(client: TestClient, content: bytes) -> None:
    headers = {**NEW, "Content-Type": "application/json"}
    assert client.put("/api/projects/fox", content=content, headers=headers).status_code == 400
    assert client.get("/api/projects").json() == []


def test_a_name_is_the_same_however_its_letters_are_composed(client: TestClient) -> None:
    assert client.put("/api/projects/Fu\u0308chse", json=document(), headers=NEW).status_code == 204
    assert client.get("/api/projects/F\u00fcchse").status_code == 200
    assert client.put("/api/projects/F\u00fcchse", json=document(), headers=NEW).status_code == 412


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes with names are those of Unix")
def test_what_is_no_project_hides_none_and_is_waited_for_by_nobody(
    client: TestClient, tmp_path: Path
) -> None:
    assert client.put("/api/projects/fox", json=document(), headers=NEW).status_code == 204
    folder = tmp_path / "projects"
    os.mkfifo(folder / "pipe.normalgan")
    (folder / "loop.normalgan").symlink_to("loop.normalgan")
    (folder / "zero.normalgan").symlink_to("/dev/zero")
    (folder / "folder.normalgan").mkdir()
    with (folder / "large.normalgan").open("wb") as file:
        file.truncate(3 * 2**30)  # sparse
    assert {entry["name"] for entry in client.get("/api/projects").json()} == {"fox", "large"}
    for name, words in {
        "pipe": "is a pipe or a device",
        "loop": "cannot be read: ",
        "zero": "is a pipe or a device",
        "folder": "cannot be read: ",
        "large": "has more than 20971520 bytes",
    }.items():
        read = client.get(f"/api/projects/{name}")
        assert (read.status_code, words in read.json()["error"]) == (400, True), name
        assert client.put(f"/api/projects/{name}", json=document(), headers=NEW).status_code == 400
        assert client.delete(f"/api/projects/{name}", headers={"If-Match": '"0"'}).status_code == 400
    assert client.get("/api/projects/fox").status_code == 200
    assert client.put("/api/projects/cub", json=document(), headers=NEW).status_code == 204


def test_of_two_tabs_the_one_that_has_not_seen_the_others_work_is_told(client: TestClient) -> None:
    first = client.put("/api/projects/fox", json=document(), headers=NEW).headers["etag"]
    # Both tabs have opened it; one saves, and saves again.
    second = client.put("/api/projects/fox", json=document(hints=[1]), headers={"If-Match": first})
    third = client.put(
        "/api/projects/fox", json=document(hints=[2]), headers={"If-Match": second.headers["etag"]}
    )
    assert (second.status_code, third.status_code) == (204, 204)
    late = client.put("/api/projects/fox", json=document(hints=[3]), headers={"If-Match": first})
    assert late.status_code == 412
    assert late.json() == {
        "error": "'fox' was changed elsewhere in the meantime; save it under another name."
    }
    assert client.delete("/api/projects/fox", headers={"If-Match": first}).status_code == 412
    assert client.get("/api/projects/fox").json()["hints"] == [2]
    new = client.put("/api/projects/fox", json=document(hints=[4]), headers=NEW)
    assert new.json() == {"error": "there is a project called 'fox' already."}
    assert client.delete("/api/projects/fox", headers={"If-Match": third.headers["etag"]}).status_code == 204
    gone = client.put("/api/projects/fox", json=document(), headers={"If-Match": third.headers["etag"]})
    assert gone.json() == {
        "error": "'fox' was deleted elsewhere in the meantime; save it under another name."
    }


def test_a_project_is_not_overwritten_unseen(client: TestClient) -> None:
    client.put("/api/projects/fox", json=document(hints=[1]), headers=NEW)
    for answer in (client.put("/api/projects/fox", json=document()), client.delete("/api/projects/fox")):
        assert answer.status_code == 400
        assert "If-Match and its ETag" in answer.json()["error"]
    assert client.get("/api/projects/fox").json()["hints"] == [1]


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        ({"a": 1}, "that is not a studio project"),
        ({**document(), "format": "psd"}, "that is not a studio project"),
        (document(version=6), "the project has an unknown version; this studio supports 1 to 5"),
        (document(version=4), "the project is damaged: pictures is missing."),
        (document(width=2), "width is 2; it should be greater than or equal to 16."),
        (document(height="9"), 'height is "9"'),
        (document(strokes=None), "the project is damaged: strokes is null; it should be a valid list."),
        (document(settings=[]), "the project is damaged: settings is []"),
        ([], "the request is not a JSON object"),
    ],
)
def test_what_is_no_project_is_not_kept(client: TestClient, content: object, sentence: str) -> None:
    for path in ("/api/projects/fox", "/api/autosave/tab1"):
        answer = client.put(path, json=content, headers=NEW)
        assert answer.status_code == 400
        assert sentence in answer.json()["error"]
        assert client.get(path).status_code == 404


def test_autosaves_are_listed_newest_first_and_the_oldest_go(client: TestClient, tmp_path: Path) -> None:
    for i in range(52):
        assert client.put(f"/api/autosave/tab-{i}", json=document(hints=[i])).status_code == 204
        path = tmp_path / "projects" / "autosave" / f"tab-{i}.normalgan"
        os.utime(path, (1e9 + i, 1e9 + i))
    assert client.put("/api/autosave/tab-51", json=document(hints=["again"])).status_code == 204
    names = [entry["name"] for entry in client.get("/api/autosave").json()]
    assert names == [f"tab-{i}" for i in range(51, 1, -1)]
    assert client.get("/api/autosave/tab-51").json()["hints"] == ["again"]
    assert client.delete("/api/autosave/tab-51").status_code == 204
    assert client.get("/api/autosave/tab-51").status_code == 404
    assert client.get("/api/projects").json() == []


def test_a_full_disk_is_told_and_leaves_the_old_project(
    client: TestClient, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tag = client.put("/api/projects/fox", json=document(hints=[1]), headers=NEW).headers["etag"]

    def full(file: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("normalgan.files.writing.os.fsync", full)
    answer = client.put("/api/projects/fox", json=document(hints=[2]), headers={"If-Match": tag})
    assert answer.status_code == 500
    assert answer.json() == {"error": "'fox' cannot be saved: No space left on device."}
    assert client.get("/api/projects/fox").json()["hints"] == [1]
    assert [path.name for path in (tmp_path / "projects").glob("*fox*")] == ["fox.normalgan"]


def test_what_a_killed_server_left_is_cleared_away(tmp_path: Path) -> None:
    (tmp_path / ".fox.normalgan.77.tmp").write_text("half")
    (tmp_path / "fox.normalgan").write_text("whole")
    (tmp_path / "notes.txt").write_text("mine")
    assert [entry["name"] for entry in DocumentStore(tmp_path).entries()] == ["fox"]
    left = {path.name for path in tmp_path.iterdir()} - {".lock"}
    assert left == {"fox.normalgan", "notes.txt"}


def test_of_two_studios_on_one_folder_one_save_is_told(tmp_path: Path) -> None:
    stores = [DocumentStore(tmp_path), DocumentStore(tmp_path)]
    tag = stores[0].write("fox", b"0", None)
    for attempt in range(20):
        ready, outcomes = threading.Barrier(2), queue.SimpleQueue[str]()

        def save(number: int, tag: str, attempt: int, ready: threading.Barrier, outcomes: Any) -> None:
            ready.wait()
            try:
                outcomes.put(stores[number].write("fox", b"%d %d" % (number, attempt), tag))
            except ChangedError:
                outcomes.put("")

        threads = [
            threading.Thread(target=save, args=(number, tag, attempt, ready, outcomes)) for number in (0, 1)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        (tag,) = filter(None, [outcomes.get(), outcomes.get()])
        assert stores[0].read("fox")[1] == tag


def test_opening_a_folder_leaves_what_another_studio_is_writing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store, opened = DocumentStore(tmp_path), threading.Thread(target=DocumentStore, args=(tmp_path,))
    sync = os.fsync

    def open_meanwhile(file: int) -> None:
        if not opened.ident:
            assert list(tmp_path.glob(".fox.*.tmp"))
            opened.start()
            opened.join(0.5)
        sync(file)

    monkeypatch.setattr("normalgan.files.writing.os.fsync", open_meanwhile)
    store.write("fox", b"whole", None)
    opened.join()
    assert store.read("fox")[0] == b"whole"


def test_a_folder_that_another_program_holds_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(document_store, "_PATIENCE", 0.1)
    store = DocumentStore(tmp_path)
    with FileLock(tmp_path / ".lock"), pytest.raises(RunError, match=r"another program holds .*--projects"):
        store.write("fox", b"whole", None)


def test_a_project_whose_name_came_decomposed_is_opened_and_kept(client: TestClient, tmp_path: Path) -> None:
    # As a folder copied from macOS has them.
    path = tmp_path / "projects" / "Fu\u0308chse.normalgan"
    path.write_text(json.dumps(document(hints=[1])))
    assert [entry["name"] for entry in client.get("/api/projects").json()] == ["F\u00fcchse"]
    read = client.get("/api/projects/F\u00fcchse")
    assert read.json()["hints"] == [1]
    tag = {"If-Match": read.headers["etag"]}
    assert client.put("/api/projects/Fu\u0308chse", json=document(), headers=tag).status_code == 204
    assert [file.name for file in path.parent.glob("*.normalgan")] == [path.name]


def test_a_folder_that_cannot_be_used_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(
        InputError, match=r"projects cannot be saved in .*file.sub: .*; give another --projects"
    ):
        DocumentStore(tmp_path / "file" / "sub")


def test_a_project_a_file_or_a_drawing_is_opened(tmp_path: Path) -> None:
    store = DocumentStore(tmp_path / "projects")
    store.write("fox", json.dumps(document()).encode(), None)
    (tmp_path / "my (fox).normalgan").write_text(json.dumps(document(hints=[1])))
    (tmp_path / "cat.png").write_bytes(png(circle()))
    (tmp_path / "bad.normalgan").write_text("{}")
    (tmp_path / "bad.png").write_text("text")
    assert find_opened("fox", store) == {"kind": "project", "name": "fox"}
    opened = find_opened(str(tmp_path / "my (fox).normalgan"), store)
    assert opened == {"kind": "document", "name": "my fox", "document": document(hints=[1])}
    drawing = find_opened(str(tmp_path / "cat.png"), store)
    assert drawing == {"kind": "drawing", "name": "cat", "content": png(circle())}
    with (tmp_path / "huge.normalgan").open("wb") as file:
        file.truncate(2**40)
    for given, sentence in (
        (str(tmp_path / "huge.normalgan"), "huge.normalgan has more than 20971520 bytes"),
        ("cat", "there is neither a project nor a file called cat"),
        ("../fox", "there is neither a project nor a file called ../fox"),
        (str(tmp_path / "bad.normalgan"), "bad.normalgan: that is not a studio project"),
        (str(tmp_path / "bad.png"), "bad.png is not an image that can be read"),
    ):
        with pytest.raises(InputError, match=sentence):
            find_opened(given, store)
