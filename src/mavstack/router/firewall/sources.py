"""Addresses and networks in the configuration of the firewall; each function raises `ValueError`."""

from __future__ import annotations

import re
from ipaddress import IPv4Network, IPv6Network, ip_network
from typing import Final, TypeAlias

from mavstack.services import Address

Network: TypeAlias = IPv4Network | IPv6Network

_SOURCE: Final = re.compile(r"(\d{1,3})/(\d{1,3})")
_RANGE: Final = re.compile(r"(\d{1,5})(?:\s*-\s*(\d{1,5}))?")
_MAX_ID, _MAX_PORT = 255, 65535


def source(value: object) -> Address:
    """Return an address such as `255/190`."""
    match = _SOURCE.fullmatch(value) if isinstance(value, str) else None
    if match is None or max(int(match[1]), int(match[2])) > _MAX_ID or "0" in match.groups():
        raise ValueError(f"{value!r} is not SYSTEM/COMPONENT such as '255/190'")
    return Address(int(match[1]), int(match[2]))


def network(value: object) -> Network:
    """Return a network such as `10.0.0.0/8`, or one host."""
    try:
        return ip_network(value if isinstance(value, str) else "")
    except ValueError as error:
        raise ValueError(f"{value!r} is not a network such as '10.0.0.0/8' ({error})") from None


def ports(value: object) -> range:
    """Return the ports of a text such as `14550-14560`, or of one number."""
    return _numbers(value, _MAX_PORT, "a port or a range such as '14550-14560'")


def system_range(value: object) -> range:
    """Return the system ids of a text such as `200-254`."""
    found = _numbers(value, _MAX_ID, "a range of system ids such as '200-254'")
    if found.start == 0:
        raise ValueError("a range of system ids from 1 to 255")
    return found


def _numbers(value: object, maximum: int, expected: str) -> range:
    match = _RANGE.fullmatch(str(value)) if isinstance(value, str | int) else None
    if match is None:
        raise ValueError(expected)
    first, last = int(match[1]), int(match[2] or match[1])
    if not first <= last <= maximum:
        raise ValueError(expected)
    return range(first, last + 1)
