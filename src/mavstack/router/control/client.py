"""A client of the control API, for scripts and `mav route ctl`; it needs no extra."""

from __future__ import annotations

import json
from http.client import HTTPConnection, HTTPException
from typing import Any, Final
from urllib.parse import quote

from mavstack.errors import LinkError

DEFAULT_TIMEOUT: Final = 10.0
MAX_ANSWER: Final = 64 << 20
_BAD_REQUEST: Final = 400


class ControlClient:
    """A client of one router.

    Args:
        address: Host and port of the control API.
        token: The token of the router; empty: none.
        timeout: Seconds that an answer may take.
    """

    def __init__(self, address: str, *, token: str = "", timeout: float = DEFAULT_TIMEOUT) -> None:
        self._address = address
        self._token = token
        self._timeout = timeout

    def endpoints(self) -> list[dict[str, Any]]:
        """Return the endpoints with their counters: see `EndpointState`."""
        found: list[dict[str, Any]] = self.request("GET", "/endpoints")
        return found

    def routes(self) -> list[dict[str, Any]]:
        """Return the learned addresses: see `RouteState`."""
        found: list[dict[str, Any]] = self.request("GET", "/routes")
        return found

    def add(self, name: str, values: dict[str, Any]) -> None:
        """Add an endpoint with the keys and values of its table in a configuration."""
        self.request("POST", "/endpoints", {"name": name, **values})

    def change(self, name: str, values: dict[str, Any]) -> None:
        """Change keys of an endpoint."""
        self.request("PATCH", f"/endpoints/{quote(name)}", values)

    def remove(self, name: str) -> None:
        """Remove an endpoint."""
        self.request("DELETE", f"/endpoints/{quote(name)}")

    def pause(self, name: str, *, paused: bool = True) -> None:
        """Pause an endpoint, or let it continue."""
        self.request("POST", f"/endpoints/{quote(name)}/{'pause' if paused else 'resume'}")

    def reload(self) -> list[str]:
        """Read the configuration file again; return notes about what could not be done."""
        notes: list[str] = self.request("POST", "/reload")["notes"]
        return notes

    def request(self, method: str, path: str, body: dict[str, Any] | None = None) -> Any:  # noqa: ANN401 (JSON)
        """Make one request.

        Args:
            method: The HTTP method.
            path: The path.
            body: The values of the request; None: none.

        Returns:
            The values of the answer.

        Raises:
            LinkError: The router cannot be reached, or refuses the request; the text is its own.
        """
        headers = {"Content-Type": "application/json"}
        if self._token:
            headers["Authorization"] = f"Bearer {self._token}"
        connection = HTTPConnection(self._address, timeout=self._timeout)
        try:
            connection.request(method, path, None if body is None else json.dumps(body), headers)
            answer = connection.getresponse()
            data = answer.read(MAX_ANSWER)
        except (OSError, HTTPException) as error:
            reason = getattr(error, "strerror", None) or str(error) or type(error).__name__
            raise LinkError(
                f"cannot reach the router at {self._address}: {reason}: "
                "is it running with control = true, or --control?"
            ) from None
        finally:
            connection.close()
        try:
            values = json.loads(data)
        except ValueError:
            raise LinkError(f"{self._address} is not a router of Mavstack: {answer.status}") from None
        if answer.status >= _BAD_REQUEST:
            problem = values.get("problem") if isinstance(values, dict) else None
            raise LinkError(f"the router refused: {problem or answer.status}")
        return values
