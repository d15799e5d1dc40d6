"""Guard: accept only requests from the studio's own page on this machine."""

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from normalgan.studio.server.refusals import RefusedError
from normalgan.studio.server.responses import refused


class Guard:
    """Refuses requests under another host name and requests from other pages.

    A foreign host name may resolve to this machine (DNS rebinding), and a page from there would then have the
    studio's origin.

    Args:
        app: the application.
        port: the port that serves the application.
    """

    def __init__(self, app: ASGIApp, port: int) -> None:
        self._app = app
        self._hosts = {f"{name}:{port}" for name in ("127.0.0.1", "localhost")}
        if port == 80:
            self._hosts |= {"127.0.0.1", "localhost"}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve or refuse a request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        refusal = self._refusal(Headers(scope=scope), scope["path"].startswith("/api/"))
        if refusal is not None:
            await refused(refusal)(scope, receive, send)
            return
        await self._app(scope, receive, send)

    def _refusal(self, headers: Headers, api: bool) -> RefusedError | None:
        host, origin = headers.get("host", ""), headers.get("origin")
        if host not in self._hosts:
            known = " or ".join(sorted(self._hosts))
            return RefusedError(f"the studio is at {known}, not at {host[:80]!r}.", 403)
        elsewhere = origin is not None and origin != f"http://{host}"
        if elsewhere or (api and headers.get("sec-fetch-site", "none") not in {"same-origin", "none"}):
            return RefusedError("the request comes from another page; the studio only answers its own.", 403)
        return None
