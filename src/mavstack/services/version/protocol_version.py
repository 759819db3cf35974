"""The MAVLink versions that a component supports, from PROTOCOL_VERSION: 100 is 1.0, 200 is 2.0."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.dialects import common

if TYPE_CHECKING:
    from typing import Self


@dataclass(frozen=True, slots=True)
class ProtocolVersion:
    """The version in use, and the smallest and largest supported version, times 100."""

    version: int = 200
    minimum: int = 100
    maximum: int = 200
    specification_hash: bytes = bytes(8)
    library_hash: bytes = bytes(8)

    def supports(self, major: int) -> bool:
        """Return whether the component supports MAVLink `major`."""
        return self.minimum <= major * 100 + 99 and major * 100 <= self.maximum

    @classmethod
    def read(cls, message: common.ProtocolVersion) -> Self:
        """Return the content of a message; a largest version of 0 is the version in use."""
        return cls(
            version=message.version,
            minimum=message.min_version,
            maximum=message.max_version or message.version,
            specification_hash=message.spec_version_hash,
            library_hash=message.library_version_hash,
        )

    def to_message(self) -> common.ProtocolVersion:
        """Return the message."""
        return common.ProtocolVersion(
            version=self.version,
            min_version=self.minimum,
            max_version=self.maximum,
            spec_version_hash=self.specification_hash,
            library_version_hash=self.library_hash,
        )
