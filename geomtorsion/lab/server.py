"""server: the page, served to this machine, or with a token to others."""

from __future__ import annotations

import ipaddress
import secrets
import socket
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from geomtorsion.errors import LimitError, MissingExtraError
from geomtorsion.exercises.worker_pool import Json
from geomtorsion.lab.access import LOOPBACK, AccessControl
from geomtorsion.lab.settings import PAGE
from geomtorsion.lab.tasks import common_runner
from geomtorsion.lab.views import copying
from geomtorsion.pictures.math_font import font_face

# What the tabs begin with; the motions among it are compiled.
_SO3 = {"space": "so3", "velocity": [0.4, 0.3, 1.0], "t": 5.0}
_TOP = {"moments": [1.0, 2.0, 3.0], "omega": [0.1, 2.0, 0.1], "tilt": 0.3, "t": 12.0}
FIRST: tuple[tuple[str, Json], ...] = (
    ("loop", {"space": "so3", "centre": [0.3, 1.0, 0.2], "radius": 0.3, "plane": [0, 1]}),
    ("paths", {**_SO3, "moments": None}),
    ("paths", {**_SO3, "moments": [1.0, 2.0, 3.0]}),
    ("top", {**_TOP, "effects": [], "watch": ["nutation"]}),
)


@dataclass(frozen=True)
class Address:
    """Where the page is served.

    host: name or number of an interface; port: 0 takes a free one.
    token: what a browser must bring; made where the host is not this machine alone.
    """

    host: str = "127.0.0.1"
    port: int = 2718
    token: str = field(default="", repr=False)

    @property
    def is_local(self) -> bool:
        """Whether nobody but this machine can reach it.

        Examples
        --------
        >>> Address("localhost").is_local, Address("0.0.0.0").is_local
        (True, False)
        """
        try:
            return ipaddress.ip_address(self.host).is_loopback
        except ValueError:
            return self.host == "localhost"

    def guarded(self) -> Address:
        """The same with a token, if others can reach it.

        Examples
        --------
        >>> bool(Address("0.0.0.0").guarded().token), Address().guarded().token
        (True, '')
        """
        if self.is_local or self.token:
            return self
        return Address(self.host, self.port, secrets.token_urlsafe(18))

    def url(self, port: int) -> str:
        """What to type into a browser, token included."""
        name = socket.gethostname() if self.host in ("0.0.0.0", "::") else self.host
        name = f"[{name}]" if ":" in name else name
        return f"http://{name}:{port}/" + (f"?access_token={self.token}" if self.token else "")


def application(address: Address, sessions: int = PAGE.sessions) -> Any:
    """The page as an ASGI application, behind its access control.

    Raises
    ------
    MissingExtraError
        marimo is not installed.
    """
    try:
        # An extra, and 0.5 s.
        import marimo
    except ImportError:
        raise MissingExtraError(
            "the page needs marimo, which is not installed. Run `pip install geomtorsion[lab]`; "
            "`geomtorsion lab --export DIR` writes pages without it."
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
        # A mounted application is not told that the server ends; its threads would go on.
        for manager in managers:
            await manager.shutdown()

    return AccessControl(inner, hosts, sessions, ending)


def serve(
    address: Address,
    ready: Callable[[str], object] = lambda _: None,
    sessions: int = PAGE.sessions,
) -> None:
    """Serve until interrupted; ready hears the address once it is answered.

    Raises
    ------
    LimitError
        The port is taken, or the host is none of this machine.
    MissingExtraError
        marimo is not installed.
    """
    address = address.guarded()
    app = application(address, sessions)
    # It comes with marimo, whose absence has been told by now.
    import uvicorn

    taken = _socket(address)
    port = taken.getsockname()[1]
    common_runner().warm(FIRST)
    config = uvicorn.Config(
        app,
        log_level="warning",
        timeout_graceful_shutdown=2,
        ws_max_size=2**20,
        # A class that begins at once keeps the machine busy longer than the usual 20 s.
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
    found = socket.socket(family, socket.SOCK_STREAM)
    found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        found.bind((address.host, address.port))
    except OSError as error:
        found.close()
        raise LimitError(
            f"{address.host}, port {address.port} cannot be used: {error.strerror or error}. "
            "Give another with --port; --port 0 takes one that is free."
        ) from None
    found.listen(128)
    return found
