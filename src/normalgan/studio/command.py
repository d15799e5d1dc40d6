"""normalgan studio: draw, pin normals, light and export in the browser."""

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
from normalgan.studio.predictions.predictor import DrawingPredictor
from normalgan.studio.projects.document_store import DocumentStore
from normalgan.studio.projects.opening import find_opened
from normalgan.studio.server.serving import listen, serve
from normalgan.weights.shipped import find_model


def run(arguments: list[str]) -> int:
    """Serve the studio until it is stopped, and return the exit code.

    Raises:
        InputError: if an argument is invalid.
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
        "--model", type=str | None, help="model written by normalgan export; by default the shipped model"
    )
    parser.add_argument(
        "--port",
        type=int,
        default=8400,
        help="port on this machine (default %(default)s); 0 picks a free one",
    )
    parser.add_argument(
        "--address",
        default="127.0.0.1",
        help="address to listen on (default %(default)s); in a container use 0.0.0.0, and publish the port "
        "on 127.0.0.1 of the host",
    )
    parser.add_argument(
        "--projects", type=str | None, help="folder of the projects; by default in the user's data folder"
    )
    parser.add_argument("--no-browser", action="store_true", help="only print the address")
    return parser


def studio(settings: Namespace) -> int:
    """Serve the studio until it is stopped, and return the exit code.

    Raises:
        InputError: if a setting is invalid.
    """
    keep_memory()
    OUTPUTS.load_entry_points()
    decoding.start()  # starts up while the model is loaded
    store = DocumentStore(
        Path(settings.projects) if settings.projects else user_data_path("normalgan", False)
    )
    opened = None if settings.opened is None else find_opened(settings.opened, store)
    with listen(settings.port, settings.address) as listening:
        port = listening.getsockname()[1]
        app = build_app(DrawingPredictor(find_model(settings.model, [".onnx"])), store, port, opened)
        address = f"http://127.0.0.1:{port}/"
        print(f"The studio is at {address} (Ctrl-C stops it).", flush=True)
        if not settings.no_browser:
            # Some browsers only return when they are closed.
            threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()
        serve(app, listening)
    return 0
