"""The requests of a client as payloads, and replies to them."""

from __future__ import annotations

from mavstack.services.ftp.payload import FtpPayload, Opcode
from tests.services.network import GROUND, START, VEHICLE
from tests.services.single_service import deliver, sent_by


def asked(client, now=START) -> list[FtpPayload]:
    """Return the requests that a client sends."""
    return [FtpPayload.read(message) for message in sent_by(client, now)]


def reply(client, request, data=b"", *, opcode=Opcode.ACK, now=START, **fields) -> None:
    """Let the client receive an ACK with these data and fields."""
    values = {"session": request.session, "offset": request.offset, "size": len(data)} | fields
    payload = FtpPayload(
        (request.sequence + values.pop("ahead", 1)) % 65536,
        opcode,
        req_opcode=values.pop("req_opcode", request.opcode),
        data=data,
        **values,
    )
    deliver(client, payload.to_message(*GROUND), VEHICLE, now)


def nak(client, request, *codes, **fields) -> None:
    """Let the client receive a NAK with these codes."""
    reply(client, request, bytes(codes), opcode=Opcode.NAK, **fields)
