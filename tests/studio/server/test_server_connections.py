import socket
from collections.abc import Iterator
from contextlib import contextmanager

import psutil
import pytest
from studio_client import asking
from studio_process import Studio, send, slow

PATHS = (
    *("/page/../app.py", "/page/%2e%2e/app.py", "/page/..%2fapp.py", "/page//etc/passwd"),
    *("/../../etc/passwd", "/page/%252e%252e%252fapp.py"),
    *("/page/..%5capp.py", "/api/projects/..%2f..%2fsecret", "/page/%252e%252e/app.py", "/page/%00"),
)


def head(studio: Studio, length: str) -> bytes:
    """Return the head of a request that paints."""
    lines = ("POST /api/predict HTTP/1.1", f"Host: 127.0.0.1:{studio.port}", "Content-Type: application/json")
    return "\r\n".join((*lines, length, "", "")).encode()


@contextmanager
def paused(studio: Studio) -> Iterator[None]:
    """Have what is sent inside come in at once, while the server is at what was sent before."""
    server = psutil.Process(studio.process.pid)
    server.suspend()
    try:
        yield
    finally:
        server.resume()


def worked(studio: Studio) -> float:
    """Return for how many seconds the server has used the processor, whatever else the machine does."""
    times = psutil.Process(studio.process.pid).cpu_times()
    return float(times.user + times.system)


def test_of_a_tabs_requests_only_the_newest_is_answered(served: Studio) -> None:
    sent = [send(served, "/api/height", asking(1, tab="a", **slow()))]
    with paused(served):
        sent += [send(served, "/api/height", asking(number, tab="a")) for number in range(2, 8)]
        sent.append(send(served, "/api/height", asking(1, tab="b")))
    statuses = [connection.getresponse().status for connection in sent]
    for connection in sent:
        connection.close()
    # Even the one that had begun: its answer would be older than what the tab knows by now.
    assert statuses == [204] * 6 + [200, 200]
    assert served.ask("POST", "/api/height", asking(3, tab="a"))[0] == 204
    assert served.ask("POST", "/api/predict", asking(3, tab="a"))[0] == 200  # counted by themselves


def test_a_request_whose_tab_has_gone_is_not_worked_for(served: Studio) -> None:
    large = slow()
    hints = [[{"x": i, "y": 5, "normal": [0, 0, 1]}] for i in range(100, 140)]  # no two alike to remember
    start = worked(served)
    for i, hint in enumerate(hints[:15]):
        send(served, "/api/height", asking(1, tab=f"gone-{i}", hints=hint, **large)).close()
    assert served.ask("POST", "/api/height", asking(1, tab="here"))[0] == 200
    for_those = worked(served) - start
    served.ask("POST", "/api/height", asking(1, tab="one", hints=hints[20], **large))
    for_one = worked(served) - start - for_those
    assert for_those < 5 * for_one  # and not fifteen times: at most what had begun was finished


def test_a_body_without_end_is_refused_and_not_kept(served: Studio) -> None:
    server = psutil.Process(served.process.pid)
    before = server.memory_info().rss
    with socket.create_connection(("127.0.0.1", served.port), timeout=60) as client:
        client.sendall(head(served, "Transfer-Encoding: chunked"))
        for _ in range(22):
            client.sendall(b"100000\r\n" + bytes(2**20) + b"\r\n")
        assert client.recv(100).startswith(b"HTTP/1.1 413")  # while there is more to come
        for _ in range(128):
            client.sendall(b"100000\r\n" + bytes(2**20) + b"\r\n")
    assert server.memory_info().rss - before < 80 * 2**20
    assert served.ask("GET", "/api/about")[0] == 200


@pytest.mark.parametrize("path", PATHS)
def test_no_file_outside_is_served_however_its_path_is_written(served: Studio, path: str) -> None:
    status, content, _ = served.ask("GET", path)  # as it is: http.client cleans no path
    assert status in {400, 404}
    assert list(content) == ["error"]


def test_a_request_that_breaks_off_harms_nobody(served: Studio) -> None:
    for _ in range(5):
        with socket.create_connection(("127.0.0.1", served.port), timeout=60) as client:
            client.sendall(head(served, "Content-Length: 5000") + b"{")
    with socket.create_connection(("127.0.0.1", served.port), timeout=60) as client:
        client.sendall(b"no HTTP at all\r\n\r\n")
        assert client.recv(100).startswith(b"HTTP/1.1 400")
    assert served.ask("POST", "/api/predict", asking(1, tab="after"))[0] == 200
