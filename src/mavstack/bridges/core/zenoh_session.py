"""Sessions of Zenoh: how a program of Mavstack connects to a router.

Callbacks of Zenoh come on its own threads. They pass through a `Handoff` into the event loop, and are called
directly in those threads: by default each callback has a thread.
"""

from __future__ import annotations

import asyncio
import json
import logging
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import LinkError, MissingExtraError

if TYPE_CHECKING:
    from collections.abc import Callable

logger = logging.getLogger("mavstack.bridges")
DEFAULT_ROUTER: Final = "tcp/127.0.0.1:7447"
#: Seconds in which the router must answer.
OPEN_TIMEOUT: Final = 5.0
#: Milliseconds without data after which the other end closes the session; Zenoh's default is 10 s.
LEASE: Final = 4000
#: Maximum number of batches of reliable samples that wait for the network; Zenoh has no more than 16.
RELIABLE_BATCHES: Final = 16
_START_ROUTER: Final = "start one with `zenohd` or `ros2 run rmw_zenoh_cpp rmw_zenohd`"


@dataclass(frozen=True, slots=True)
class SessionOptions:
    """How a session connects.

    Attributes:
        routers: The endpoints of routers, such as "tcp/127.0.0.1:7447" or "tls/ground.example:7447".
        mode: "client" of a router, or "peer".
        ca: The file with the authority that the router's certificate must be of; empty: that of the system.
        certificate: The file with the own certificate; empty: none.
        private_key: The file with its private key.
        timeout: Seconds in which a router must answer.
    """

    routers: tuple[str, ...] = (DEFAULT_ROUTER,)
    mode: str = "client"
    ca: str = ""
    certificate: str = ""
    private_key: str = ""
    timeout: float = OPEN_TIMEOUT

    def values(self) -> dict[str, object]:
        """Return the keys of Zenoh's configuration, with their values."""
        values: dict[str, object] = {
            "mode": self.mode,
            "connect/endpoints": list(self.routers),
            "connect/timeout_ms": round(self.timeout * 1000),
            "connect/exit_on_failure": True,
            "scouting/multicast/enabled": False,
            "timestamping/enabled": True,  # for the cache of advanced publishers and the age of data
            "transport/link/tx/lease": LEASE,
            # By default a put waits a millisecond for room in a full queue, in the event loop.
            "transport/link/tx/queue/congestion_control/drop/wait_before_drop": 0,
            # Batches of 64 KiB. Reliable samples come in bursts, such as all parameters of a vehicle; the
            # queue of telemetry stays short, since old telemetry has no value.
            "transport/link/tx/queue/size/data_high": RELIABLE_BATCHES,
            "metadata": {"name": "mavstack"},
        }
        if self.mode == "peer":
            values["listen/endpoints"] = ["tcp/localhost:0"]
        if self.ca:
            values["transport/link/tls/root_ca_certificate"] = self.ca
        if self.certificate:
            values["transport/link/tls/enable_mtls"] = True
            values["transport/link/tls/connect_certificate"] = self.certificate
            values["transport/link/tls/connect_private_key"] = self.private_key
        return values


def zenoh_module(purpose: str, extra: str = "zenoh") -> Any:
    """Return the library.

    Args:
        purpose: The subject of the error text, such as "ROS 2 over Zenoh".
        extra: The extra that brings the library.

    Raises:
        MissingExtraError: It is not installed.
    """
    try:
        import zenoh
    except ImportError:
        raise MissingExtraError(purpose, extra) from None
    return zenoh


async def open_session(zenoh: Any, options: SessionOptions) -> Any:
    """Connect to a router.

    Raises:
        LinkError: No router answers, or a certificate cannot be used.
    """
    config = zenoh.Config()
    for key, value in options.values().items():
        config.insert_json5(key, json.dumps(value))
    try:
        return await asyncio.get_running_loop().run_in_executor(None, zenoh.open, config)
    except zenoh.ZError as error:
        where = ", ".join(options.routers)
        reason = str(error).split(" at ")[0].strip().rstrip(".")
        raise LinkError(
            f"connecting to the Zenoh router {where} failed: {reason}; {_START_ROUTER}, or name it with "
            "--connect"
        ) from None


class RouterReports:
    """Warnings when the router of a session is lost and when it is back: all samples between are lost.

    A router is lost too when this program, or the router, did not run for the time of a lease.

    Args:
        zenoh: The library.
        session: The open session.
        routers: The endpoints of its routers, for the warnings.
    """

    def __init__(self, zenoh: Any, session: Any, routers: tuple[str, ...]) -> None:
        self._put = zenoh.SampleKind.PUT
        self._where = ", ".join(routers)
        self._lost_at: float | None = None
        self._listener: Any = None
        listen = getattr(session.info, "declare_transport_events_listener", None)
        if listen is not None:  # Zenoh from 1.10 on
            self._listener = listen(direct(zenoh, lambda event: self.receive(event.kind)), history=False)

    def receive(self, kind: Any) -> None:
        """Report that a connection exists or is gone; called in a thread of Zenoh."""
        now = time.monotonic()
        if kind != self._put:
            self._lost_at = now
            logger.warning("the Zenoh router %s is lost; samples are lost until it is back", self._where)
        elif self._lost_at is not None:
            logger.warning("the Zenoh router %s is back after %.1f s", self._where, now - self._lost_at)
            self._lost_at = None

    def end(self) -> None:
        """Report no more: the session is about to close. Idempotent."""
        listener, self._listener = self._listener, None
        if listener is not None:
            listener.undeclare()


async def close_session(session: Any) -> None:
    """Close a session; it waits for the network, but not in the event loop."""
    await asyncio.get_running_loop().run_in_executor(None, session.close)


def direct(zenoh: Any, callback: Callable[[Any], None]) -> Any:
    """Return a handler that calls in the thread of Zenoh."""
    return zenoh.handlers.Callback(callback, indirect=False)
