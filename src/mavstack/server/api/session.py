"""Sessions: a client shows a password or a ticket, and gets a cookie, a token and tickets for WebSockets."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Annotated, Any, Final

from msgspec import Meta
from starlette.responses import JSONResponse, Response

from mavstack.http.bodies import RefusedError, read_json_object
from mavstack.http.request_fields import Fields, read_fields
from mavstack.server.access import COOKIE, SESSION_LIFETIME
from mavstack.server.request_types import Text

if TYPE_CHECKING:
    from starlette.requests import Request

    from mavstack.server.access import Access, Client

#: Seconds to receive the body of a log-in, the only request with a body that needs no session.
LOG_IN_TIMEOUT: Final = 20.0


class LogIn(Fields):
    """Begin a session."""

    password: Annotated[
        Text | None, Meta(description="The password of a role.", examples=["correct horse battery"])
    ] = None
    ticket: Annotated[Text | None, Meta(description="A ticket instead of a password.")] = None


class Sessions:
    """The requests that begin, show and end sessions; a client needs no session for them.

    Args:
        access: The sessions.
        secure: True if the station is served with TLS only.
    """

    def __init__(self, access: Access, *, secure: bool) -> None:
        self._access = access
        self._secure = secure

    async def begin(self, request: Request) -> Response:
        """Begin a session; a station without a password answers with the highest role."""
        self._access.check_page(request.headers)
        try:
            async with asyncio.timeout(LOG_IN_TIMEOUT):
                given = read_fields(LogIn, await read_json_object(request))
        except TimeoutError:
            raise RefusedError(408, f"the request did not arrive within {LOG_IN_TIMEOUT:g} s") from None
        if self._access.is_open:
            client = self._access.check_request(request)
            return JSONResponse(self._values(client) | {"token": None}, 201)
        password, ticket = given.password, given.ticket
        if (password is None) == (ticket is None):
            raise RefusedError(400, "either a password or a ticket is needed")
        address = request.client.host if request.client is not None else ""
        client = self._access.log_in(address, password=password, ticket=ticket)
        values = self._values(client) | {"token": client.session}
        answer = JSONResponse(values, 201, {"Cache-Control": "no-store"})
        self._set_cookie(answer, client.session, request)
        return answer

    async def show(self, request: Request) -> Response:
        """Show the role of a client, with a new ticket; a cookie lasts as long as its session again."""
        client = self._access.check_request(request)
        answer = JSONResponse(self._values(client), headers={"Cache-Control": "no-store"})
        if client.session and request.cookies.get(COOKIE) == client.session:
            self._set_cookie(answer, client.session, request)
        return answer

    async def end(self, request: Request) -> Response:
        """End the session of a client."""
        client = self._access.check_request(request)
        self._access.log_out(client.session)
        answer = JSONResponse({"role": None})
        answer.delete_cookie(COOKIE)
        return answer

    def _set_cookie(self, answer: Response, token: str, request: Request) -> None:
        answer.set_cookie(
            COOKIE,
            token,
            max_age=int(SESSION_LIFETIME),
            httponly=True,
            samesite="strict",
            # the scheme is https behind a proxy with TLS
            secure=self._secure or request.url.scheme == "https",
        )

    def _values(self, client: Client) -> dict[str, Any]:
        is_open = self._access.is_open
        ticket = None if is_open else self._access.make_ticket(client.session)
        return {"role": client.role.word, "needs_password": not is_open, "ticket": ticket}
