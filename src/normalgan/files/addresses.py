"""Files from https:// and hf:// addresses, cached on this machine after their hash is checked."""

import hashlib
import json
import os
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from http.client import HTTPException, IncompleteRead
from pathlib import Path
from threading import Thread
from time import monotonic
from urllib.error import HTTPError, URLError
from urllib.parse import unquote, urlsplit
from urllib.request import Request, urlopen

from platformdirs import user_cache_path

from normalgan.errors import InputError, brief
from normalgan.files.limits import MOST_BYTES
from normalgan.files.writing import write_bytes
from normalgan.progress import progress_bar

CACHE = "NORMALGAN_CACHE"
"""Environment variable with the folder of downloaded files."""
_TIMEOUT = 30
"""Timeout for a server's answer, and interval over which its speed is measured, in seconds."""
_LOWEST_SPEED = 10
"""Minimum speed of a server in bytes per second, as in cargo, which also measures over 30 s. A socket
timeout restarts with each byte, so a slow server could block us forever."""
_STEP = 1
"""Time between two looks at a download, in seconds."""
_HASH = re.compile(r"sha256=([0-9a-fA-F]{64})")
_HUB_FILE = "model.onnx"
"""Default file of a repository on the hub."""
_SOURCE = "source.json"


@dataclass(frozen=True)
class Address:
    """Address of a file elsewhere.

    Args:
        text: the address as given, without the hash.
        sha256: SHA-256 hash of the file's content, as 64 lower-case hexadecimal digits.
        name: name of the file.
    """

    text: str
    sha256: str
    name: str


@dataclass(frozen=True)
class Kept:
    """A downloaded file.

    Args:
        path: path of the file.
        address: address that it was downloaded from, with its hash.
    """

    path: Path
    address: str


def is_address(name: str) -> bool:
    r"""Return whether a name is an address rather than a path.

    >>> is_address("hf://owner/name"), is_address("runs/last.ckpt"), is_address(r"C:\model.onnx")
    (True, False, False)
    """
    return re.match(r"[A-Za-z][A-Za-z0-9+.-]+://", name) is not None


def parse_address(text: str) -> Address:
    """Parse the address of a file.

    Args:
        text: ``https://host/file#sha256=…`` or ``hf://owner/name[@revision][/file]#sha256=…``.

    Raises:
        InputError: if the scheme is not supported, or the address has no hash.

    >>> parse_address("hf://owner/name@v1#sha256=" + 64 * "a").name
    'model.onnx'
    """
    address, _, fragment = text.partition("#")
    scheme = address.partition("://")[0].lower()
    if scheme not in {"https", "http", "hf"}:
        raise InputError(f"{address} has the scheme {scheme}; a model is at https://… or hf://owner/name.")
    found = _HASH.fullmatch(fragment)
    if found is None:
        raise InputError(
            f"{address} needs the hash of its file, so that the file cannot be replaced: end it in "
            "#sha256= and 64 digits, as its author publishes them."
        )
    name = _hub_place(address)[2] if scheme == "hf" else unquote(urlsplit(address).path)
    name = re.split(r"[/\\]", name)[-1]
    if not re.fullmatch(r"\w[\w.+ -]{0,200}", name):
        raise InputError(f"{address} does not end in the name of a file, such as model.onnx.")
    return Address(address, found[1].lower(), name)


def local_file(name: str) -> Path:
    """Return the path of a file; a file at an address is downloaded once and cached.

    Raises:
        InputError: if an address is invalid, does not answer, or its file has another hash.
        OSError: if the file cannot be cached.
    """
    if not is_address(name):
        return Path(name)
    address = parse_address(name)
    path = _folder() / address.sha256 / address.name
    if path.is_file() and _hash(path.read_bytes()) == address.sha256:
        return path
    content = _from_hub(address) if address.text.lower().startswith("hf://") else _from_web(address)
    if (found := _hash(content)) != address.sha256:
        raise InputError(
            f"the file at {address.text} has the SHA-256 hash {found}, not {address.sha256}; it was not kept."
        )
    write_bytes(path, content)
    source = json.dumps({"address": f"{address.text}#sha256={address.sha256}", "name": address.name})
    write_bytes(path.with_name(_SOURCE), source.encode())
    return path


def kept_files() -> Iterator[Kept]:
    """Yield the downloaded files."""
    for source in sorted(_folder().glob(f"*/{_SOURCE}")):
        try:
            said = json.loads(source.read_text(encoding="utf-8"))
            kept = Kept(source.with_name(str(said["name"])), str(said["address"]))
        except (OSError, ValueError, KeyError, TypeError):
            continue  # not ours, or removed in the meantime
        if kept.path.is_file():
            yield kept


def _folder() -> Path:
    return Path(os.environ[CACHE]) if os.environ.get(CACHE) else user_cache_path("normalgan") / "models"


def _hash(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


class _Fetch(Thread):
    """Downloads a file in a thread, because a slow server may stall anywhere, even within its headers."""

    def __init__(self, address: Address) -> None:
        super().__init__(daemon=True)
        self._address = address
        self._received = bytearray()
        self._promised = 0
        self._error: Exception | None = None

    def run(self) -> None:
        """Read the server's answer."""
        request = Request(self._address.text, headers={"User-Agent": "normalgan"})
        try:
            with urlopen(request, timeout=_TIMEOUT) as answer:
                self._promised = int(answer.headers.get("Content-Length") or 0)
                while len(self._received) <= MOST_BYTES and (part := answer.read1(2**16)):
                    self._received += part
        except Exception as error:
            self._error = error

    def content(self) -> tuple[bytes, int]:
        """Return the file's content, and the number of bytes that the server announced.

        Raises:
            InputError: if the server is too slow.
            Exception: any error of urllib.
        """
        since = monotonic()
        while self.is_alive() and not self._received:
            self.join(_STEP)
            if monotonic() - since >= _TIMEOUT and self.is_alive() and not self._received:
                raise TimeoutError("timed out")
        title = f"downloading {self._address.name}"
        with progress_bar(title, self._promised // 1000, "kB", shown=self.is_alive(), stays=False) as advance:
            self._watch(advance)
        if self._error is not None:
            raise self._error
        return bytes(self._received), self._promised

    def _watch(self, advance: Callable[[int], None]) -> None:
        """Wait until the download ends, and advance a bar of kB. Raises `InputError` as `content` does."""
        shown, before, since = 0, 0, monotonic()
        while self.is_alive():
            received = len(self._received)
            advance(received // 1000 - shown)
            shown = received // 1000
            if monotonic() - since >= _TIMEOUT:
                if received - before < _LOWEST_SPEED * _TIMEOUT:
                    raise InputError(
                        f"{self._address.text} sends less than {_LOWEST_SPEED} bytes a second; try again "
                        "later."
                    )
                before, since = received, monotonic()
            self.join(_STEP)


def _from_web(address: Address) -> bytes:
    fetch = _Fetch(address)
    fetch.start()
    try:
        content, promised = fetch.content()
    except InputError:
        raise
    except HTTPError as error:
        error.close()
        raise InputError(f"{address.text} answers {error.code} {error.reason}.") from error
    except IncompleteRead as error:
        raise InputError(f"{address.text} stopped in the middle of its answer; try again.") from error
    except (URLError, TimeoutError, HTTPException, OSError, ValueError) as error:
        reason = error.reason if isinstance(error, URLError) else brief(error)
        raise InputError(f"{address.text} does not answer: {reason}.") from error
    if len(content) > MOST_BYTES:
        raise InputError(
            f"the file at {address.text} has more than {MOST_BYTES} bytes; no model is that large."
        )
    if len(content) < promised:  # read() does not report it for answers of known length
        raise InputError(f"{address.text} stopped after {len(content)} of {promised} bytes; try again.")
    return content


def _hub_place(address: str) -> tuple[str, str | None, str]:
    """Return repository, revision and file of a hub address."""
    found = re.fullmatch(
        r"hf://(?P<repo>[\w.-]+/[\w.-]+)(?:@(?P<revision>[\w.-]+))?(?:/(?P<file>[^?]+))?",
        address,
        re.IGNORECASE,
    )
    if found is None:
        raise InputError(f"{address} is not hf://owner/name, perhaps followed by @revision and /file.")
    return found["repo"], found["revision"], found["file"] or _HUB_FILE


def _from_hub(address: Address) -> bytes:
    try:
        from huggingface_hub import hf_hub_download
        from huggingface_hub.errors import (
            EntryNotFoundError,
            HfHubHTTPError,
            LocalEntryNotFoundError,
            RepositoryNotFoundError,
            RevisionNotFoundError,
        )
    except ImportError:
        raise InputError(
            f"{address.text} needs huggingface_hub; install it with pip install 'normalgan[hub]'."
        ) from None
    repository, revision, name = _hub_place(address.text)
    try:
        path = hf_hub_download(repository, name, revision=revision, endpoint=os.environ.get("HF_ENDPOINT"))
    except LocalEntryNotFoundError as error:  # neither on the hub, which is out of reach, nor in its cache
        raise InputError(f"{address.text} does not answer: {brief(error.__cause__ or error)}.") from error
    except EntryNotFoundError as error:
        raise InputError(f"{repository} on the hub has no file {name}.") from error
    except RevisionNotFoundError as error:
        raise InputError(f"{repository} on the hub has no revision {revision}.") from error
    except RepositoryNotFoundError as error:
        raise InputError(f"the hub has no repository {repository}, or it is private.") from error
    except (HfHubHTTPError, OSError, ValueError) as error:
        raise InputError(f"{address.text} does not answer: {brief(error)}.") from error
    return Path(path).read_bytes()
