"""App: the ASGI application that serves the studio's page and API."""

import asyncio
import mimetypes
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import partial
from pathlib import Path

from pydantic import ValidationError
from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException
from starlette.middleware import Middleware
from starlette.requests import ClientDisconnect, Request
from starlette.responses import FileResponse, HTMLResponse, JSONResponse, Response
from starlette.routing import BaseRoute, Mount, Route
from starlette.staticfiles import StaticFiles

from normalgan.errors import InputError, sentence_of
from normalgan.inference import structures
from normalgan.inference.outputs.lighting import CLAY_FILE
from normalgan.studio.drawings.imports import import_layers, import_picture
from normalgan.studio.drawings.limits import MOST_HINTS, MOST_SIDE, with_limits
from normalgan.studio.drawings.schemas import ImportQuery
from normalgan.studio.page_files import PAGE, markup, version_of
from normalgan.studio.predictions.exports import with_export_menu
from normalgan.studio.predictions.predictor import DrawingPredictor
from normalgan.studio.predictions.routes import PredictionRoutes
from normalgan.studio.projects.document_store import DocumentStore
from normalgan.studio.projects.opening import Opened
from normalgan.studio.projects.routes import DocumentRoutes
from normalgan.studio.server.bodies import MOST_BYTES, check_type, read_body
from normalgan.studio.server.guard import Guard
from normalgan.studio.server.responses import ResponseMiddleware, failed, refused
from normalgan.version import __version__

_AUTOSAVES = 50
_SENTENCES = {404: "there is nothing at this address.", 405: "this address does not accept that method."}


def build_app(
    predictor: DrawingPredictor, projects: DocumentStore, port: int, opened: Opened | None = None
) -> Starlette:
    """Return the application.

    Args:
        predictor: predicts the drawings.
        projects: the saved projects; unsaved work goes into a subfolder.
        port: the port that serves the application.
        opened: what the page opens first, from `normalgan.studio.projects.opening.find_opened`; or None.
    """
    predictions = PredictionRoutes(predictor)
    autosaved = DocumentStore(projects.folder / "autosave")
    kept, page = _page_routes()

    @asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncIterator[None]:
        yield
        predictions.close()

    app = Starlette(
        routes=[
            _about_route(predictor),
            *_opened_routes(opened),
            _import_route(),
            *predictions.routes(),
            *DocumentRoutes("/api/projects", projects, guarded=True).routes(),
            *DocumentRoutes("/api/autosave", autosaved, False, _AUTOSAVES).routes(),
            *page,
        ],
        middleware=[Middleware(ResponseMiddleware, kept=kept), Middleware(Guard, port=port)],
        exception_handlers={InputError: _on_input_error, HTTPException: _known, ClientDisconnect: _left},
        lifespan=lifespan,
    )
    app.router.redirect_slashes = False  # an empty name is an error, not the list of all
    return app


def _page_routes() -> tuple[str, list[BaseRoute]]:
    """Return the page's routes, and the URL prefix of its cacheable files."""
    mimetypes.add_type("text/javascript", ".js")  # some machines map it to text/plain, which browsers refuse
    kept = f"/page/{version_of([*PAGE.rglob('*.*'), CLAY_FILE, Path(structures.__file__)])}"
    text = (PAGE / "index.html").read_text(encoding="utf-8")
    page = markup(with_limits(with_export_menu(text)), PAGE).replace('"/page/', f'"{kept}/')

    async def index(_: Request) -> Response:
        return HTMLResponse(page)

    async def clay(_: Request) -> Response:
        return FileResponse(CLAY_FILE)  # so that the lit view looks like the previews of `generate`

    files = StaticFiles(directory=PAGE)
    served = [
        route
        for at in (kept, "/page")
        for route in (
            Route(f"{at}/clay.json", clay),
            *(
                Route(f"{at}/{structures.FILE.format(kind)}", partial(_structure, kind))
                for kind in structures.KINDS
            ),
            Mount(at, files),
        )
    ]
    return f"{kept}/", [Route("/", index), *served]


def _structure(kind: structures.Kind, _: Request) -> Response:
    """Return a built-in structure; not async, because it may have to be computed first."""
    return Response(structures.tile_bytes(kind), media_type="application/octet-stream")


def _about_route(predictor: DrawingPredictor) -> Route:
    """Return the route that describes the model and the limits of requests."""
    facts = {
        "version": __version__,
        "model": {"name": predictor.name, "size": predictor.model.size, "confidence": predictor.confident},
        "limits": {"side": MOST_SIDE, "hints": MOST_HINTS, "body": MOST_BYTES},
        "text": f"normalgan {__version__}, {predictor.name} at {predictor.model.size} pixels",
    }

    async def about(_: Request) -> Response:
        return JSONResponse(facts)

    return Route("/api/about", about)


def _opened_routes(opened: Opened | None) -> list[Route]:
    """Return the routes for the drawing or project that the page opens first."""

    async def first(_: Request) -> Response:
        return JSONResponse(opened and {name: value for name, value in opened.items() if name != "content"})

    async def first_file(_: Request) -> Response:
        if opened is None or "content" not in opened:
            raise HTTPException(404)
        return Response(opened["content"], media_type="application/octet-stream")

    return [Route("/api/open", first), Route("/api/open/file", first_file)]


def _import_route() -> Route:
    """Return the route that imports a picture file as a drawing or as layers."""
    importing = asyncio.Semaphore(1)  # one import at a time, because it may take a gigabyte

    async def import_(request: Request) -> Response:
        check_type(request, "image/", "application/octet-stream")
        try:
            asked = ImportQuery.model_validate_strings(dict(request.query_params))
        except ValidationError as error:
            raise InputError(sentence_of(error)) from None
        content = await read_body(request)
        read = partial(import_picture, part=asked.part) if asked.way == "drawing" else import_layers
        async with importing:
            return JSONResponse(await run_in_threadpool(read, content))

    return Route("/api/import", import_, methods=["POST"])


def _on_input_error(_: Request, error: Exception) -> Response:
    assert isinstance(error, InputError)
    return refused(error)


def _known(_: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    sentence = _SENTENCES.get(error.status_code, f"{error.detail}.")
    return failed(sentence, error.status_code, dict(error.headers or {}))


def _left(_: Request, error: Exception) -> Response:
    return failed("the request was cut off.", 400)  # the client is gone, so nobody reads this
