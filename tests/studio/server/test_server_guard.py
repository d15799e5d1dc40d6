import re
import socket
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import quote

import pytest
from starlette.testclient import TestClient
from studio_client import PORT, asking, document, serving

from normalgan.inference.outputs.lighting import Clay
from normalgan.studio.page_files import PAGE, modules_of, version_of

NO_NAMES = (
    *(
        "",
        "..",
        ".hidden",
        "../secret",
        "../../secret.txt",
        "/etc/passwd",
        "..\\secret",
        "a/b",
        "C:",
        "con.txt",
    ),
    *("a\0b", "a\nb", " a", "a ", "~", "💾", "x" * 81, "名" * 80),
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two folders above that of the projects: what a name of dots and slashes could reach."""
    folder = tmp_path_factory.mktemp("studio")
    (folder / "secret.txt").write_text("hush")
    (folder / "beside").mkdir()
    (folder / "beside" / "secret.txt").write_text("hush")
    return folder


@pytest.fixture(scope="module")
def client(model: Path, folder: Path) -> Iterator[TestClient]:
    with serving(model, folder / "beside" / "projects") as client:
        yield client


@pytest.mark.parametrize("path", ["/api/about", "/page/text/text.js", "/"])
@pytest.mark.parametrize(
    "host", ["evil.example", f"evil.example:{PORT}", "127.0.0.1", "127.0.0.1:1", f"[::1]:{PORT}", ""]
)
def test_another_host_is_refused(client: TestClient, path: str, host: str) -> None:
    answer = client.get(path, headers={"Host": host})
    assert answer.status_code == 403
    assert "the studio is at 127.0.0.1:8400 or localhost:8400" in answer.json()["error"]


@pytest.mark.parametrize(
    "headers",
    [
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": f"https://127.0.0.1:{PORT}"},
        {"Origin": f"http://localhost:{PORT}"},  # of another page, though it is ours as well
        {"Sec-Fetch-Site": "cross-site"},
        {"Sec-Fetch-Site": "same-site"},
    ],
)
def test_another_page_is_refused(client: TestClient, headers: dict[str, str]) -> None:
    for answer in (
        client.post("/api/predict", json=asking(), headers=headers),
        client.get("/api/projects", headers=headers),
        client.put("/api/autosave/a", json=document(), headers=headers),
    ):
        assert answer.status_code == 403
        assert "the request comes from another page" in answer.json()["error"]
    assert client.get("/api/autosave").json() == []


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost"])
def test_its_own_page_is_served(client: TestClient, host: str) -> None:
    own = {"Host": f"{host}:{PORT}", "Origin": f"http://{host}:{PORT}", "Sec-Fetch-Site": "same-origin"}
    assert client.get("/api/about", headers=own).status_code == 200
    assert (
        client.get("/page/text/text.js", headers={"Sec-Fetch-Site": "cross-site"}).status_code == 200
    )  # a link


def test_every_answer_has_its_headers(client: TestClient) -> None:
    for answer in (
        client.get("/page/text/text.js"),
        client.get("/api/about"),
        client.get("/nothing"),
        client.get("/api/about", headers={"Host": "evil.example"}),
    ):
        policy = answer.headers["content-security-policy"]
        assert policy.startswith("default-src 'self'; img-src 'self' data: blob:;")
        assert "unsafe" not in policy
        assert answer.headers["x-content-type-options"] == "nosniff"
        assert answer.headers["cross-origin-resource-policy"] == "same-origin"
        assert "server" not in answer.headers
    assert client.get("/api/about").headers["cache-control"] == "no-store"


def test_files_of_the_page_are_served_and_no_others(client: TestClient) -> None:
    answer = client.get("/page/text/text.js")
    assert answer.content == (PAGE / "text" / "text.js").read_bytes()
    assert answer.headers["content-type"].startswith("text/javascript")
    assert answer.headers["cache-control"] == "no-cache"
    assert (
        client.get("/page/text/text.js", headers={"If-None-Match": answer.headers["etag"]}).status_code == 304
    )
    for path in ("../app.py", "../../errors.py", "../../../../../../../../../../etc/passwd", "/etc/passwd"):
        for written in (path, quote(path, safe=""), quote(path).replace(".", "%2e"), path.replace("/", "\\")):
            assert client.get(f"/page/{written}").status_code == 404
    assert client.get("/page/text/text.js%00.png").status_code == 404
    assert client.get("/page/").status_code == 404


def test_the_page_names_all_its_modules_ahead_at_addresses_that_are_kept(client: TestClient) -> None:
    page = client.get("/")
    assert page.headers["cache-control"] == "no-cache"
    ahead = re.findall(r'<link rel="modulepreload" href="([^"]+)">', page.text)
    root = ahead[0].removesuffix("main.js")
    assert sorted(url.removeprefix(root) for url in ahead) == sorted(
        path.relative_to(PAGE).as_posix()
        for path in PAGE.rglob("*.js")
        if not path.name.startswith("text_")  # one is fetched when chosen
        and path.name not in ("cutting.js", "inpainting.js")  # a worker, which is made when the lasso cuts
    )
    script = re.search(r'<script type="module" src="([^"]+)">', page.text)
    assert script is not None
    assert ahead[0] == script[1]  # or the browser would fetch it twice
    for url in (*ahead[:2], *re.findall(r'<link rel="stylesheet" href="([^"]+)">', page.text)):
        answer = client.get(url)
        assert answer.content == (PAGE / url.removeprefix(root)).read_bytes()
        assert "immutable" in answer.headers["cache-control"]
    assert client.get(f"{ahead[0]}.not").headers["cache-control"] == "no-cache"
    assert client.get(f"{root}clay.json").json() == client.get("/page/clay.json").json()


def test_another_page_has_another_version(tmp_path: Path) -> None:
    (tmp_path / "main.js").write_text('import { a } from "./a.js";\nexport * from "./b.js";\n')
    (tmp_path / "a.js").write_text('import {\n  b,\n} from "./b.js";\nimport "./c.js";\n')
    (tmp_path / "b.js").write_text('// import { x } from "./x.js";\n')
    (tmp_path / "c.js").write_text('import { a } from "./a.js";\nimport "./in/d.js";\n')
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "d.js").write_text('import { a } from "../a.js";\nimport "./e.js";\n')
    (tmp_path / "in" / "e.js").write_text("")
    assert modules_of(tmp_path, "main.js") == ["main.js", "a.js", "b.js", "c.js", "in/d.js", "in/e.js"]
    before = version_of(tmp_path.glob("*.js"))
    assert version_of(tmp_path.glob("*.js")) == before
    (tmp_path / "b.js").write_text("// nothing\n")
    assert version_of(tmp_path.glob("*.js")) != before


@pytest.mark.parametrize("store", ["projects", "autosave"])
@pytest.mark.parametrize("name", NO_NAMES)
def test_no_path_is_a_name(client: TestClient, folder: Path, store: str, name: str) -> None:
    before = sorted(folder.rglob("*"))
    for written in {quote(name, safe=""), quote(name, safe="").replace(".", "%2E")}:
        path = f"/api/{store}/{written}"
        for answer in (
            client.get(path),
            client.put(path, json=document(), headers={"If-None-Match": "*"}),
            client.delete(path, headers={"If-Match": '"a"'}),
        ):
            assert answer.status_code in {400, 404, 405}, answer.text
            assert "hush" not in answer.text
    assert sorted(folder.rglob("*")) == before


def test_too_much_is_not_read(client: TestClient) -> None:
    large = b" " * (20 * 2**20 + 1)
    headers = {"Content-Type": "application/json", "If-None-Match": "*"}
    for method, path in (("POST", "/api/predict"), ("PUT", "/api/projects/fox"), ("POST", "/api/import")):
        kind = {"Content-Type": "image/png"} if path.endswith("import") else headers
        answer = client.request(method, path, content=large, headers=kind)
        assert answer.status_code == 413
        assert answer.json() == {"error": "it is larger than 20 MB; make it smaller."}


def test_only_this_machine_can_reach_it() -> None:
    from normalgan.studio.server.serving import listen

    with listen(0) as listening:
        assert listening.getsockname()[0] == "127.0.0.1"
        assert listening.family == socket.AF_INET


def test_the_page_gets_the_clay_of_previews(client: TestClient) -> None:
    """Its colours were written down in JavaScript a second time."""
    clay = client.get("/page/clay.json").json()
    assert {name: tuple(v) if isinstance(v, list) else v for name, v in clay.items()} == vars(Clay())
