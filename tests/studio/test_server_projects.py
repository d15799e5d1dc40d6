import json
import os
import time
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path

import pytest
from starlette.testclient import TestClient
from studio_client import circle, document, png, serving

from normalgan.errors import InputError
from normalgan.studio.document_store import DocumentStore
from normalgan.studio.opening import find_opened

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


def test_a_name_is_the_same_however_its_letters_are_composed(client: TestClient) -> None:
    assert client.put("/api/projects/Fu\u0308chse", json=document(), headers=NEW).status_code == 204
    assert client.get("/api/projects/F\u00fcchse").status_code == 200
    assert client.put("/api/projects/F\u00fcchse", json=document(), headers=NEW).status_code == 412


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
        ({"a": 1}, "that is no project of the studio"),
        ({**document(), "format": "psd"}, "that is no project of the studio"),
        (document(version=2), "the project is of another version; this studio knows 1"),
        (document(width=2), "width is 2; it is to be a whole number from 16 to 2048."),
        (document(height="9"), 'height is "9"'),
        (document(strokes=None), "the project has no strokes; the file is damaged."),
        (document(settings=[]), "the project has no settings"),
        ([], "the request is no JSON object"),
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

    monkeypatch.setattr("normalgan.normals.os.fsync", full)
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
    assert sorted(path.name for path in tmp_path.iterdir()) == ["fox.normalgan", "notes.txt"]


def test_a_folder_that_cannot_be_used_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(
        InputError, match=r"projects cannot be kept in .*file/sub: .*; give another --projects"
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
    assert (drawing["kind"], drawing["name"], drawing["width"], drawing["height"]) == (
        "drawing",
        "cat",
        160,
        120,
    )
    with (tmp_path / "huge.normalgan").open("wb") as file:
        file.truncate(2**40)
    for given, sentence in (
        (str(tmp_path / "huge.normalgan"), "huge.normalgan has more than 20971520 bytes"),
        ("cat", "there is neither a project nor a file called cat"),
        ("../fox", "there is neither a project nor a file called ../fox"),
        (str(tmp_path / "bad.normalgan"), "bad.normalgan: that is no project of the studio"),
        (str(tmp_path / "bad.png"), "bad.png is not an image that can be read"),
    ):
        with pytest.raises(InputError, match=sentence):
            find_opened(given, store)
