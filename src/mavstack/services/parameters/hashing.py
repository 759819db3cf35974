"""`_HASH_CHECK`: PX4's hash of all its parameters, so that a known set need not be downloaded.

The hash is a CRC-32 (reflected, initial value 0, without final inversion) over the name and the value bytes
of each parameter in the order of the table. Volatile parameters are excluded, and only the vehicle knows
which those are; so the hash that it sent for a set is as good as one computed here, and often better.
"""

from __future__ import annotations

from typing import TYPE_CHECKING
from zlib import crc32

from mavstack.services.parameters.value import Parameter, is_known, whole_bytes

if TYPE_CHECKING:
    from collections.abc import Iterable

HASH_NAME = "_HASH_CHECK"
_ALL_ONES = 0xFFFFFFFF


def hash_of(parameters: Iterable[Parameter]) -> int:
    """Return the hash of parameters in the order of their table."""
    state = _ALL_ONES  # zlib's crc32 inverts its initial value and its result, PX4's does not
    for parameter in parameters:
        state = crc32(parameter.name.encode(errors="surrogateescape"), state)
        if is_known(parameter.type):
            state = crc32(whole_bytes(parameter.value, parameter.type), state)
    return state ^ _ALL_ONES
