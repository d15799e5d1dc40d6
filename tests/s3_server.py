"""An S3 server in this process, and an environment in which everything finds it."""

import logging
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest


@contextmanager
def s3_server() -> Iterator[str]:
    """Yield the address of a server on a free port."""
    from moto.server import ThreadedMotoServer  # here: few tests need it

    logging.getLogger("werkzeug").setLevel(logging.ERROR)
    server = ThreadedMotoServer(ip_address="127.0.0.1", port=0)
    server.start()
    host, port = server.get_host_and_port()
    try:
        yield f"http://{host}:{port}"
    finally:
        server.stop()


@pytest.fixture(scope="module", name="endpoint")
def make_endpoint() -> Iterator[str]:
    """The address of an S3 server in this process."""
    with s3_server() as address:
        yield address


@pytest.fixture(name="bucket")
def make_bucket(endpoint: str, monkeypatch: pytest.MonkeyPatch) -> str:
    """The URL of a fresh bucket."""
    return fresh_bucket(endpoint, monkeypatch)


def fresh_bucket(endpoint: str, monkeypatch: pytest.MonkeyPatch) -> str:
    """Return the URL of a new bucket; environment variables say where, as workers inherit them."""
    import fsspec  # type: ignore[import-untyped]

    monkeypatch.setenv("AWS_ENDPOINT_URL", endpoint)
    monkeypatch.setenv("AWS_ACCESS_KEY_ID", "somebody")
    monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", "secret")
    monkeypatch.setenv("AWS_DEFAULT_REGION", "us-east-1")
    monkeypatch.setenv("AWS_EC2_METADATA_DISABLED", "true")
    forget()
    name = f"bucket-{uuid.uuid4().hex}"
    fsspec.filesystem("s3").mkdir(name)
    return f"s3://{name}"


def forget() -> None:
    """Make fsspec open its file systems anew: they keep the credentials they were opened with."""
    import fsspec

    fsspec.get_filesystem_class("s3").clear_instance_cache()


def download(url: str, folder: Path) -> Path:
    """Return a folder after copying the content of a URL into it."""
    import fsspec

    fsspec.filesystem("s3", use_listings_cache=False).get(url, str(folder), recursive=True)
    return folder
