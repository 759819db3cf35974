"""Dashboards of tests: a sender of lines of values, and files that the station opens."""

from __future__ import annotations

import json
import socket
from contextlib import closing
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

    from tests.interop.station import StationPage

COLUMNS = "alt:m,roll:deg,pitch:deg,yaw:deg,lat:deg,lon:deg,mode"


class Sender:
    """A program that sends lines of values to the station."""

    def __init__(self) -> None:
        self._server = socket.create_server(("127.0.0.1", 0))
        self._server.settimeout(60)
        self._receiver: socket.socket | None = None
        self.url = f"csv+tcp://127.0.0.1:{self._server.getsockname()[1]}?name=bench&template={COLUMNS}"

    def send(self, altitude: float, mode: str = "FLYING") -> None:
        """Send a line, once the station is there."""
        if self._receiver is None:
            self._receiver, _ = self._server.accept()
        self._receiver.sendall(f"{altitude},10,-5,90,46.0,7.74,{mode}\n".encode())

    def close(self) -> None:
        for each in (self._receiver, self._server):
            if each is not None:
                each.close()


def sending() -> AbstractContextManager[Sender]:
    return closing(Sender())


def widget(kind: str, *fields: str, **more: Any) -> dict[str, Any]:
    return {"kind": kind, "title": f"The {kind}", "fields": [f"bench:ROW.{each}" for each in fields], **more}


def dashboard(*widgets: dict[str, Any], **more: Any) -> str:
    return json.dumps(
        {"type": "mavstack-dashboard", "version": 1, "title": "Test", "widgets": widgets, **more}
    )


def show(shown: StationPage, url: str, text: str) -> None:
    """Open a dashboard from a file."""
    shown.page.goto(f"{url}#/dashboards")
    file = {"name": "test.json", "mimeType": "application/json", "buffer": text.encode()}
    shown.page.locator(".dashboards input[type=file]").set_input_files(file)


def region(shown: StationPage, kind: str) -> Any:
    return shown.page.get_by_role("region", name=f"The {kind}")
