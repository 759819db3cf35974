"""The web interface of a RockBLOCK's gateway, sans-IO: its web hook, and the request that sends a message.

The gateway posts each message of a modem as a form or as JSON with at least `imei`, `momsn` and `data` in
hexadecimal digits, repeats it until it is answered with 200 within 3 s, and may deliver it twice. A message
to a modem is a POST with `imei`, `username`, `password`, `data`, answered by "OK,ID" or "FAILED,CODE,TEXT".
"""

from __future__ import annotations

import json
from collections import OrderedDict
from typing import Final, NamedTuple
from urllib.parse import parse_qsl, urlencode

from mavstack.links.sbd_modem import MAX_SENT

#: The gateway of the manufacturer of RockBLOCK modems.
GATEWAY: Final = "https://rockblock.rock7.com/rockblock/MT"
MAX_BODY: Final = 16_384
_MAX_IMEI: Final = 20
_MAX_FIELDS: Final = 64
_REMEMBERED: Final = 256


class Hook(NamedTuple):
    """A message of a modem, from its web hook."""

    imei: str
    number: str
    data: bytes


def parse_hook(body: bytes) -> Hook | None:
    """Return the message of a web hook; None if it is none."""
    try:
        fields = _fields(body)
        imei, number = str(fields["imei"]), str(fields.get("momsn", ""))
        data = bytes.fromhex(str(fields.get("data", "")))
    except (ValueError, KeyError, TypeError, RecursionError):
        return None
    if not (imei.isascii() and imei.isdecimal() and len(imei) <= _MAX_IMEI) or len(data) > MAX_SENT:
        return None
    return Hook(imei, number[:_MAX_IMEI], data)


def message_form(imei: str, username: str, password: str, data: bytes) -> bytes:
    """Return the body of the request that sends a message to a modem."""
    return urlencode({"imei": imei, "username": username, "password": password, "data": data.hex()}).encode()


def failure_of(answer: bytes) -> str:
    """Return why the gateway refused a message; empty if it has it."""
    text = answer.decode("utf-8", "replace").strip()
    return "" if text.startswith("OK") else text[:200] or "an empty answer"


class Delivered:
    """The messages that were delivered already, by modem and number."""

    def __init__(self) -> None:
        self._known: OrderedDict[tuple[str, str, bytes], None] = OrderedDict()

    def is_new(self, hook: Hook) -> bool:
        """Return whether a message was not delivered before, and remember it."""
        key = (hook.imei, hook.number, hook.data)
        if hook.number and key in self._known:
            return False
        self._known[key] = None
        if len(self._known) > _REMEMBERED:
            self._known.popitem(last=False)
        return True


def _fields(body: bytes) -> dict[str, object]:
    if len(body) > MAX_BODY:
        raise ValueError
    if body.lstrip().startswith(b"{"):
        found = json.loads(body)
        return found if isinstance(found, dict) else {}
    return dict(parse_qsl(body.decode("ascii"), max_num_fields=_MAX_FIELDS))
