"""normalgan studio: draw, pin normals, light and export in the browser, with an exported model."""

import threading
import webbrowser
from pathlib import Path

from jsonargparse import Namespace
from platformdirs import user_data_path

from normalgan import decoding
from normalgan.cli.parsing.light_parser import LightParser
from normalgan.inference.outputs import OUTPUTS
from normalgan.studio.app import build_app
from normalgan.studio.predictions.memory import keep_memory
from normalgan.studio.predictions.predictor import Predictor
from normalgan.studio.projects.document_store import DocumentStore
from normalgan.studio.projects.opening import find_opened
from normalgan.studio.server.serving import listen, serve
from normalgan.weights.shipped import find_model

__all__ = ["build_parser", "run", "studio"]


def run(arguments: list[str]) -> int:
    """Serve the studio until it is ended, and return the exit code.

    Raises:
        InputError: if something that was given cannot be used.
    """
    return studio(build_parser().parse_args(arguments))


def build_parser() -> LightParser:
    """Return the parser of the command line."""
    parser = LightParser(
        prog="normalgan studio",
        usage="%(prog)s [PROJECT|DRAWING] [--SETTING VALUE]...",
        description="Draw, pin normals, light and export in the browser.",
    )
    parser.add_argument(
        "opened",
        nargs="?",
        type=str | None,
        metavar="PROJECT|DRAWING",
        help="what to open: a project's name, a .normalgan file, or a drawing",
    )
    parser.add_argument(
        "--model", type=str | None, help="a model that normalgan export wrote; by default the package's own"
    )
    parser.add_argument(
        "--port",
        type=int,
        default=8400,
        help="port on this machine (default %(default)s); 0 takes a free one",
    )
    parser.add_argument(
        "--address",
        default="127.0.0.1",
        help="where to listen (default %(default)s); 0.0.0.0 in a container, whose port is published on "
        "127.0.0.1 of its host",
    )
    parser.add_argument(
        "--projects", type=str | None, help="folder of the projects; by default in the user's folder for data"
    )
    parser.add_argument("--no-browser", action="store_true", help="only print the address")
    return parser


def studio(settings: Namespace) -> int:
    """Serve the studio until it is ended, and return the exit code.

    Raises:
        InputError: if something cannot be used.
    """
    keep_memory()
    OUTPUTS.load_entry_points()
    decoding.start()  # while the model is loaded
    store = DocumentStore(
        Path(settings.projects) if settings.projects else user_data_path("normalgan", False)
    )
    opened = None if settings.opened is None else find_opened(settings.opened, store)
    with listen(settings.port, settings.address) as listening:
        port = listening.getsockname()[1]
        app = build_app(Predictor(find_model(settings.model, [".onnx"])), store, port, opened)
        address = f"http://127.0.0.1:{port}/"
        print(f"The studio is at {address} (Ctrl-C ends it).", flush=True)
        if not settings.no_browser:
            # Some browsers return only when they are closed.
            threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()
        serve(app, listening)
    return 0
