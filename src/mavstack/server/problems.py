"""Errors as answers: the status of each kind of error, and its JSON.

{"error": {"kind": "CommandDenied", "text": "arming 1/1 failed: FAILED (PreArm: …)",
           "code": 4, "status_texts": ["PreArm: …"]}}
"""

from __future__ import annotations

from http import HTTPStatus
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import (
    ActionInterrupted,
    ActionUnsupported,
    GroupError,
    InvalidStateError,
    LinkError,
    LinkURLError,
    LocalProtocolError,
    LogError,
    MavstackError,
    MetadataError,
    MissingExtraError,
    ParameterFileError,
    PlanFileError,
    RemoteCancelled,
    RemoteDenied,
    RemoteError,
    RemoteProtocolError,
    RemoteTimeout,
    SwarmStopped,
    SystemIdConflictError,
    UnknownMessageError,
)
from mavstack.flashing.failures import FirmwareFileError, FlashingError, FlashingRefused
from mavstack.http.bodies import RefusedError
from mavstack.maps.failures import MapError

if TYPE_CHECKING:
    from collections.abc import Sequence

#: The HTTP status of each class of errors; the first matching class is used.
STATUSES: Final[Sequence[tuple[type[Exception], HTTPStatus]]] = (
    (RemoteDenied, HTTPStatus.CONFLICT),
    (SystemIdConflictError, HTTPStatus.CONFLICT),
    (ActionInterrupted, HTTPStatus.CONFLICT),
    (RemoteTimeout, HTTPStatus.GATEWAY_TIMEOUT),
    (RemoteCancelled, HTTPStatus.SERVICE_UNAVAILABLE),
    (RemoteProtocolError, HTTPStatus.BAD_GATEWAY),
    (ActionUnsupported, HTTPStatus.CONFLICT),
    (InvalidStateError, HTTPStatus.CONFLICT),
    (GroupError, HTTPStatus.CONFLICT),
    (SwarmStopped, HTTPStatus.CONFLICT),
    (LocalProtocolError, HTTPStatus.BAD_REQUEST),
    (LinkURLError, HTTPStatus.BAD_REQUEST),
    (LinkError, HTTPStatus.CONFLICT),
    (PlanFileError, HTTPStatus.BAD_REQUEST),
    (ParameterFileError, HTTPStatus.BAD_REQUEST),
    (MetadataError, HTTPStatus.BAD_REQUEST),
    (FirmwareFileError, HTTPStatus.BAD_REQUEST),
    (FlashingRefused, HTTPStatus.CONFLICT),
    (FlashingError, HTTPStatus.BAD_GATEWAY),
    (MapError, HTTPStatus.BAD_GATEWAY),
    (UnknownMessageError, HTTPStatus.NOT_FOUND),
    (LogError, HTTPStatus.CONFLICT),
    (MissingExtraError, HTTPStatus.NOT_IMPLEMENTED),
)


def status_of(error: Exception) -> int:
    """Return the status of the answer to a request that ended in an error."""
    if isinstance(error, RefusedError):
        return error.status
    found = (status for kind, status in STATUSES if isinstance(error, kind))
    return next(found, HTTPStatus.INTERNAL_SERVER_ERROR)


def problem_json(error: Exception) -> dict[str, Any]:
    """Return an error as JSON; one that the program did not expect is not described."""
    if isinstance(error, RefusedError):
        return _problem(_kind_of(error.status), str(error))
    if not isinstance(error, MavstackError):
        return _problem("InternalError", "the server failed; its log has the details")
    details: dict[str, Any] = {}
    if isinstance(error, RemoteDenied):
        details["code"] = int(error.code)
    if isinstance(error, RemoteError) and error.status_texts:
        details["status_texts"] = list(error.status_texts)
    if isinstance(error, RemoteError) and error.events:
        details["events"] = list(error.events)
    if isinstance(error, SwarmStopped):
        details["systems"] = list(error.systems)
    return _problem(type(error).__name__, str(error), **details)


def _problem(kind: str, text: str, **details: object) -> dict[str, Any]:
    return {"error": {"kind": kind, "text": text, **details}}


def _kind_of(status: int) -> str:
    return HTTPStatus(status).phrase.title().replace(" ", "").replace("-", "")
