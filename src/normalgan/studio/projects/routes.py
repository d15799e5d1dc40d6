"""Routes: list, read, write and delete documents."""

from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from normalgan.errors import InputError
from normalgan.studio.projects.document_store import ANYTHING, DocumentStore, Expected
from normalgan.studio.projects.format import check_document
from normalgan.studio.server.bodies import read_json


class DocumentRoutes:
    """The routes of a document store.

    Args:
        path: prefix of the addresses.
        store: the documents.
        guarded: whether a change must name the version that it replaces.
        most: maximum number of documents; older ones are deleted. None keeps all.
    """

    def __init__(self, path: str, store: DocumentStore, guarded: bool, most: int | None = None) -> None:
        self._path, self._store, self._guarded, self._most = path, store, guarded, most

    def routes(self) -> list[Route]:
        """Return the routes."""
        one = f"{self._path}/{{name}}"
        return [
            Route(self._path, self.entries, methods=["GET"]),
            Route(one, self.read, methods=["GET"]),
            Route(one, self.write, methods=["PUT"]),
            Route(one, self.delete, methods=["DELETE"]),
        ]

    async def entries(self, _: Request) -> Response:
        """Return all names, newest first."""
        return JSONResponse(await run_in_threadpool(self._store.entries))

    async def read(self, request: Request) -> Response:
        """Return a document."""
        content, tag = await run_in_threadpool(self._store.read, request.path_params["name"])
        return Response(content, headers={"ETag": tag}, media_type="application/json")

    async def write(self, request: Request) -> Response:
        """Save a document."""
        expected, name = self._expected(request), request.path_params["name"]
        content = await read_json(request)
        await run_in_threadpool(check_document, content)
        tag = await run_in_threadpool(self._store.write, name, content, expected)
        if self._most is not None:
            await run_in_threadpool(self._store.prune, self._most)
        return Response(status_code=204, headers={"ETag": tag})

    async def delete(self, request: Request) -> Response:
        """Delete a document."""
        expected = self._expected(request)
        await run_in_threadpool(self._store.delete, request.path_params["name"], expected)
        return Response(status_code=204)

    def _expected(self, request: Request) -> Expected:
        if tag := request.headers.get("if-match"):
            return tag.strip()
        if request.headers.get("if-none-match", "").strip() == "*":
            return None
        if self._guarded:
            raise InputError(
                "a project is changed with If-Match and its ETag, or made with If-None-Match: *."
            )
        return ANYTHING
