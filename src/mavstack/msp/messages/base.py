"""The interface of all MSP messages: one class per layout, which decodes and encodes its payload."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, ClassVar, Self

if TYPE_CHECKING:
    from mavstack.msp.firmware_info import FirmwareInfo


class MspMessage(ABC):
    """One message of MSP: the payload of a request or of a reply.

    Subclasses are frozen dataclasses. Firmwares append fields to a layout: a field that this side of the
    payload's end does not have is None.

    Attributes:
        COMMAND: Number of the command.
        NAME: Official name of the command, such as `MSP_ATTITUDE`.
    """

    __slots__ = ()

    COMMAND: ClassVar[int]
    NAME: ClassVar[str]

    @classmethod
    @abstractmethod
    def decode(cls, payload: bytes, firmware: FirmwareInfo | None = None) -> Self:
        """Return the message of a payload.

        Args:
            payload: The bytes of a frame.
            firmware: The firmware that sent it; None: not known.

        Returns:
            The message; bytes behind its last field are ignored.

        Raises:
            MspDecodeError: The payload is too short, or contradicts the layout.
        """

    @abstractmethod
    def encode(self, firmware: FirmwareInfo | None = None) -> bytes:
        """Return the payload of the message.

        Args:
            firmware: The firmware that receives or sends it; None: not known.

        Raises:
            InvalidArgumentError: A field is out of the range of its type.
        """
