"""server: the page, served to this machine, or with a token to others."""

from __future__ import annotations

import asyncio
import socket
from collections import Counter
from collections.abc import Awaitable, Callable, Iterable, Mapping, MutableMapping
from contextlib import suppress
from pathlib import Path
from typing import Any
from urllib.parse import SplitResult, parse_qs, urlsplit

from geomtorsion.errors import LimitError, MissingExtraError
from geomtorsion.pictures.formula import font_face
from geomtorsion.teaching.exercises.chapter_folder import load_folder
from geomtorsion.teaching.exercises.registry import Own
from geomtorsion.teaching.exercises.worker_pool import Json
from geomtorsion.teaching.lab.address import Address
from geomtorsion.teaching.lab.control_values import ControlValues, ValueRefusedError
from geomtorsion.teaching.lab.localized import App, Receive, Scope, Send, localized, with_chapter
from geomtorsion.teaching.lab.notebook_path import without_path
from geomtorsion.teaching.lab.settings import PAGE
from geomtorsion.teaching.lab.tasks import common_runner
from geomtorsion.teaching.lab.views import copying
from geomtorsion.teaching.texts import ENGLISH

# The policy forbids the browser to load anything from another origin.
POLICY = (
    "default-src 'self'; script-src 'self' 'unsafe-inline' 'unsafe-eval' blob:; "
    "style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; font-src 'self' data:; "
    "connect-src 'self'; worker-src 'self' blob:; frame-src 'self' data: blob:; "
    "object-src 'none'; base-uri 'self'; form-action 'self'"
)
LOOPBACK = ("127.0.0.1", "localhost", "::1")
# Route for values of controls; a file is also such a value, so its requests may be longer.
CONTROL = "/api/kernel/set_ui_element_value"
# (method, path) -> its use by the page. The server refuses every other route of marimo. A
# path that ends with * is a prefix.
ROUTES: Mapping[tuple[str, str], str] = {
    ("GET", "/"): "the page itself",
    ("GET", "/assets/*"): "scripts, styles and fonts of marimo's front end",
    ("GET", "/favicon.ico"): "the icon of the window",
    ("GET", "/apple-touch-icon.png"): "the icon on a telephone",
    ("GET", "/manifest.json"): "the page as it is kept on a telephone",
    ("GET", "/android-chrome-192x192.png"): "the icon that it names, loaded with it",
    ("GET", "/android-chrome-512x512.png"): "the same, larger",
    ("GET", "/public-files-sw.js"): "a script that the front end registers when it begins",
    ("GET", "/health"): "whether the server is still there, asked when the page begins",
    ("GET", "/auth/login"): "the form for the token, if there is one",
    ("POST", "/auth/login"): "the token that was typed",
    ("POST", CONTROL): "a slider was moved, a text typed, a file of a map given",
    ("WEBSOCKET", "/ws"): "the session: what the cells show",
}
# Start of the message that ends the first run of a session, or reports that it resumes.
_BEGUN = ('{"op": "completed-run"', '{"op": "reconnected"')
_FULL = (
    "<!doctype html><meta charset=utf-8><title>Torsion lab</title><p>The lab is full: {most} pages "
    "are open. Close one and load this page again.</p>"
)


class AccessControl:
    """An ASGI application in front of another: hosts, origins, sizes and the number of sessions.

    hosts: accepted names of the page; empty: any. A page of another site that is open
    in the same browser has another origin, and is refused. sessions: open at once; reserve:
    sessions at the end for clients with fewer sessions, a client being an address on the network.
    ending: awaited before the server ends. notebook: the file of the page, whose path is removed
    from the answer.
    """

    def __init__(
        self,
        app: App,
        hosts: Iterable[str] = LOOPBACK,
        sessions: int = PAGE.sessions,
        ending: Callable[[], Awaitable[None]] | None = None,
        reserve: int = PAGE.reserve,
        notebook: Path | None = None,
        starting: Callable[[str], bool] = lambda _: False,
    ) -> None:
        self.app = app
        self.notebook = notebook
        self.starting = starting
        self.ending = ending
        self.hosts: frozenset[str] = frozenset(hosts)
        self.sessions = sessions
        # With few sessions a quarter is reserved, so that a single user gets nearly all of them.
        self.reserve = min(reserve, sessions // 4)
        # Client -> its open sessions.
        self.open: Counter[str] = Counter()
        self.values = ControlValues()
        self._opening = asyncio.Lock()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Refuse a request, or pass it on."""
        if scope["type"] == "lifespan":
            await self._life(receive, send)
            return
        headers = {
            key.decode("latin-1").lower(): value.decode("latin-1")
            for key, value in scope["headers"]
        }
        reason = self._refused(scope, headers)
        # A browser that takes too long has gone; its connection ends with this call.
        with suppress(TimeoutError):
            await self._answered(scope, receive, send, reason)

    async def _answered(
        self, scope: Scope, receive: Receive, send: Send, reason: tuple[int, str] | None
    ) -> None:
        """Answer a request, or send the reason for refusing it."""
        if scope["type"] == "websocket":
            await self._session(scope, receive, send, reason)
        elif reason:
            await _tell(send, *reason)
        elif scope["path"] == "/":
            # The page is read again for each browser, see `_opened`. It is sent after the lock is
            # released: a browser that does not read it delays no other browser.
            answer: list[MutableMapping[str, Any]] = []

            async def kept(message: MutableMapping[str, Any]) -> None:
                answer.append(message)

            async with self._opening:
                await asyncio.wait_for(self.app(scope, _with_body(b""), kept), PAGE.opening)
            for message in answer if self.notebook is None else without_path(answer, self.notebook):
                await _guarded(send)(message)
        elif scope["path"] == CONTROL:
            await self._values(scope, receive, send)
        else:
            await self.app(scope, _bounded(receive, most_bytes(scope)), _guarded(send))

    async def _values(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass values of controls on if they fit the controls, or send the reason."""
        body, more, bounded = b"", True, _bounded(receive, most_bytes(scope))
        while more:
            message = await bounded()
            if message["type"] != "http.request":
                return
            body += message.get("body", b"")
            more = message.get("more_body", False)
        session = dict(scope["headers"]).get(b"marimo-session-id", b"").decode("latin-1")
        try:
            checked = self.values.checked(session, body)
        except ValueRefusedError as error:
            await _tell(send, error.status, str(error))
            return
        headers = [
            (key, str(len(checked)).encode() if key.lower() == b"content-length" else value)
            for key, value in scope["headers"]
        ]
        await self.app({**scope, "headers": headers}, _with_body(checked), _guarded(send))

    async def _life(self, receive: Receive, send: Send) -> None:
        """Start and end of the server."""
        await receive()
        await send({"type": "lifespan.startup.complete"})
        await receive()
        if self.ending is not None:
            await self.ending()
        await send({"type": "lifespan.shutdown.complete"})

    def _refused(self, scope: Scope, headers: dict[str, str]) -> tuple[int, str] | None:
        """Status and reason, or None for a request that may pass."""
        host = headers.get("host", "")
        name = _split(f"//{host}").hostname or ""
        if self.hosts and name not in self.hosts:
            return 421, f"This server is not called {name!r}. Use the address that it printed."
        origin = headers.get("origin", "")
        # A proxy may change the scheme, but not the host and port.
        if origin not in ("", "null") and _split(origin).netloc != host:
            return 403, "This server answers only requests of its own page."
        reads = scope["type"] == "http" and scope.get("method", "GET") in ("GET", "HEAD")
        if origin == "null" and not reads:
            return 403, "This server answers only requests that name its own page as origin."
        if not is_used(scope):
            return 404, "This server has no such page. Open its first page, /."
        length = headers.get("content-length", "0")
        most = most_bytes(scope)
        if not length.isdecimal() or len(length) > 12 or int(length) > most:
            return 413, f"This request is too large. The server reads at most {most:,} bytes."
        if scope["path"] == "/":
            most = self._full(scope)
            return (503, _FULL.format(most=most)) if most else None
        return None

    def _full(self, scope: Scope) -> int:
        """The number of open pages, of all clients or of this one, if no more may open; else 0."""
        own, left = self.open[_client(scope)], self.sessions - self.open.total()
        if left <= 0:
            return self.sessions
        return own if left <= self.reserve <= own else 0

    async def _session(
        self, scope: Scope, receive: Receive, send: Send, reason: tuple[int, str] | None
    ) -> None:
        """One session, counted from its start to its end."""
        if reason or self._full(scope):
            await receive()
            await send({"type": "websocket.close", "code": 1013, "reason": "the lab is full"})
            return
        client, name = _client(scope), _session_name(scope)
        self.open[client] += 1
        self.values.open(name)
        try:
            await self._opened(scope, receive, send, name)
        finally:
            self.open[client] -= 1
            self.values.close(name)

    async def _opened(self, scope: Scope, receive: Receive, send: Send, name: str) -> None:
        """A session whose start completes before the next session starts.

        marimo compiles the page in a thread for each session, and in Python before 3.13 two threads
        that call `ast.parse` at once can fail ("AST constructor recursion depth mismatch").
        """
        begun = asyncio.Event()
        outgoing: asyncio.Queue[MutableMapping[str, Any]] = asyncio.Queue()

        async def watched(message: MutableMapping[str, Any]) -> None:
            text = message.get("text") or ""
            if text.startswith(_BEGUN):
                begun.set()
            self.values.record(name, text)
            outgoing.put_nowait(message)

        async def passed_on() -> None:
            while True:
                message = await outgoing.get()
                await asyncio.wait_for(send(message), PAGE.sending)
                outgoing.task_done()

        async with self._opening:
            session = asyncio.ensure_future(self.app(scope, receive, watched))
            # Messages wait in a queue: while a session begins, no task waits for its browser, which
            # may never read.
            sender = asyncio.create_task(passed_on())
            waiting = asyncio.create_task(begun.wait())
            every = (session, sender, waiting)
            try:
                await asyncio.wait(every, timeout=PAGE.opening, return_when=asyncio.FIRST_COMPLETED)
                # A browser may go at once: the thread of its session still compiles the page.
                with suppress(TimeoutError):
                    await asyncio.wait_for(_passed(self.starting, name), PAGE.opening)
            except asyncio.CancelledError:
                for task in every:
                    task.cancel()
                raise
        try:
            await asyncio.wait((session, sender), return_when=asyncio.FIRST_COMPLETED)
            if session.done() and not sender.done():
                with suppress(TimeoutError):
                    await asyncio.wait_for(outgoing.join(), PAGE.sending)
        finally:
            for task in (waiting, sender, session):
                task.cancel()
        await asyncio.gather(session, sender, return_exceptions=True)
        error = None if session.cancelled() else session.exception()
        if error is not None:
            raise error from None


async def _passed(starting: Callable[[str], bool], name: str) -> None:
    """Wait until the thread of a session has compiled the page."""
    while starting(name):
        await asyncio.sleep(PAGE.polling)


def _session_name(scope: Scope) -> str:
    """The name that a browser gives its session."""
    query = parse_qs(scope.get("query_string", b"").decode("latin-1"))
    return query.get("session_id", [""])[0]


def _client(scope: Scope) -> str:
    """Network address of the client."""
    client = scope.get("client")
    return str(client[0]) if client else ""


def _with_body(body: bytes) -> Receive:
    """A request that has arrived completely, with this body."""
    given = False

    async def receive() -> MutableMapping[str, Any]:
        nonlocal given
        if given:
            # The caller waits for a disconnect, which the server notices when it sends the answer.
            await asyncio.Event().wait()
        given = True
        return {"type": "http.request", "body": body, "more_body": False}

    return receive


def is_used(scope: Scope) -> bool:
    """Whether a request is one of `ROUTES`.

    Examples
    --------
    >>> is_used({"type": "http", "method": "GET", "path": "/assets/index.js"})
    True
    >>> is_used({"type": "http", "method": "POST", "path": "/api/home/workspace_files"})
    False
    """
    method = "WEBSOCKET" if scope["type"] == "websocket" else scope.get("method", "GET")
    # A HEAD request is allowed for every route that may be read.
    method = "GET" if method == "HEAD" else method
    path = scope["path"]
    for allowed, pattern in ROUTES:
        head = pattern.removesuffix("*")
        if method == allowed and (path == head or (head != pattern and path.startswith(head))):
            return True
    return False


def most_bytes(scope: Scope) -> int:
    """Largest size of a request in bytes; larger where files arrive.

    Examples
    --------
    >>> most_bytes({"path": CONTROL}) > most_bytes({"path": "/auth/login"}) == PAGE.body
    True
    """
    return PAGE.carried if scope["path"] == CONTROL else PAGE.body


def _split(address: str) -> SplitResult:
    """The parts of an address, which are empty if it is not valid."""
    try:
        return urlsplit(address)
    except ValueError:
        return SplitResult("", "", "", "", "")


def _bounded(receive: Receive, most: int) -> Receive:
    """Refuse a body at the size limit, whatever its header claims."""
    seen = 0

    async def bounded() -> MutableMapping[str, Any]:
        nonlocal seen
        message = await receive()
        seen += len(message.get("body", b""))
        return {"type": "http.disconnect"} if seen > most else message

    return bounded


def _guarded(send: Send) -> Send:
    """An answer with the policy in its header."""

    async def guarded(message: MutableMapping[str, Any]) -> None:
        if message["type"] == "http.response.start":
            more = [
                (b"content-security-policy", POLICY.encode()),
                (b"referrer-policy", b"no-referrer"),
                (b"x-content-type-options", b"nosniff"),
            ]
            message = {**message, "headers": [*message.get("headers", []), *more]}
        await asyncio.wait_for(send(message), PAGE.sending)

    return guarded


async def _tell(send: Send, status: int, text: str) -> None:
    """A short text as answer."""
    kind = b"text/html; charset=utf-8" if text.startswith("<") else b"text/plain; charset=utf-8"
    await send(
        {"type": "http.response.start", "status": status, "headers": [(b"content-type", kind)]}
    )
    await send({"type": "http.response.body", "body": text.encode()})


# First requests of the tabs; the motions among them are compiled.
_SO3 = {"space": "so3", "velocity": [0.4, 0.3, 1.0], "t": 5.0}
_TOP = {"moments": [2.0, 2.0, 1.0], "omega": [1.0, 0.0, 2.0], "tilt": 0.3, "t": 12.0}
FIRST: tuple[tuple[str, Json], ...] = (
    ("compass", {"course": PAGE.course}),
    ("loop", {"space": "so3", "centre": [0.3, 1.0, 0.2], "radius": 0.3, "plane": [0, 1]}),
    ("paths", {**_SO3, "moments": None}),
    ("paths", {**_SO3, "moments": [1.0, 2.0, 3.0]}),
    ("top", {**_TOP, "effects": [], "watch": ["nutation"]}),
)


def application(
    address: Address,
    sessions: int = PAGE.sessions,
    language: str = ENGLISH,
    chapter: str = "",
) -> Any:
    """The page in a language as an ASGI application, behind its access control.

    chapter: the folder of a teacher's chapter, or "".

    Raises
    ------
    MissingExtraError
        marimo is not installed.
    """
    try:
        # marimo is an extra, and its import takes 0.5 s.
        import marimo
    except ImportError:
        raise MissingExtraError(
            "the page needs marimo, which is not installed. Run `pip install 'geomtorsion[lab]'`, "
            "or write pages that need no server with `geomtorsion lab --export DIR`."
        ) from None
    builder = marimo.create_asgi_app(
        quiet=True,
        include_code=False,
        token=address.token,
        session_ttl=PAGE.reopening,
        html_head=f"<style>{font_face()}</style><script>{copying()}</script>",
    )
    page = Path(__file__).with_name("page.py")
    inner: Any = builder.with_app(path="", root=str(page)).build()
    hosts = (*LOOPBACK, address.host) if address.is_local else ()
    managers = [route.app.state.session_manager for route in inner.routes]

    async def ending() -> None:
        # A mounted application gets no event when the server ends; its threads would keep running.
        for manager in managers:
            await manager.shutdown()

    def starting(name: str) -> bool:
        found = [one for manager in managers if (one := manager.get_session(name)) is not None]
        return any(not one.session_view.last_execution_time for one in found)

    inner = with_chapter(localized(inner, language), chapter)
    return AccessControl(inner, hosts, sessions, ending, notebook=page, starting=starting)


def serve(
    address: Address,
    ready: Callable[[str], object] = lambda _: None,
    sessions: int = PAGE.sessions,
    language: str = ENGLISH,
    chapter: Own = None,
) -> None:
    """Serve until interrupted; `ready` is called with the address when the port is open.

    chapter: the folder of a teacher's chapter, shown with the shipped ones; see
    `exercises.load_folder`.

    Raises
    ------
    LimitError
        The port is taken, or the host is not an address of this machine.
    MissingExtraError
        marimo is not installed.
    FileFormatError
        The folder of the chapter has a mistake; the message names the file and the line.
    """
    address = address.guarded()
    # Mistakes are reported to the teacher before a student opens the page.
    folder = "" if chapter is None else load_folder(chapter).folder
    app = application(address, sessions, language, folder)
    # uvicorn comes with marimo, and a missing marimo has already raised an error.
    import uvicorn

    taken = _socket(address)
    port = taken.getsockname()[1]
    common_runner().warm([(name, {**case, "language": language}) for name, case in FIRST])
    config = uvicorn.Config(
        app,
        log_level="warning",
        timeout_graceful_shutdown=2,
        ws_max_size=2**20,
        # A class that starts together keeps the machine busy for more than the usual 20 s.
        ws_ping_timeout=120,
        lifespan="on",
    )
    server = uvicorn.Server(config)
    ready(address.url(port))
    try:
        server.run(sockets=[taken])
    finally:
        common_runner().close()


def _socket(address: Address) -> socket.socket:
    """A bound socket, so that the port is known before anything is served."""
    family = socket.AF_INET6 if ":" in address.host else socket.AF_INET
    listener = socket.socket(family, socket.SOCK_STREAM)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listener.bind((address.host, address.port))
    # A port that exceeds 16 bits raises an OverflowError instead of an OSError.
    except (OSError, OverflowError) as error:
        listener.close()
        reason = getattr(error, "strerror", None) or error
        raise LimitError(
            f"{address.host}, port {address.port} cannot be used: {str(reason).rstrip('.')}. "
            "Give another port with --port; --port 0 takes a free port."
        ) from None
    listener.listen(128)
    return listener
