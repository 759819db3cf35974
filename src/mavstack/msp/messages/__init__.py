"""Messages of MSP: typed frozen dataclasses that decode and encode payloads, one module per area."""

from mavstack.msp.messages.base import MspMessage
from mavstack.msp.messages.identification import (
    ApiVersion,
    BoardInfo,
    BuildInfo,
    FcVariant,
    FcVersion,
    Name,
    Uid,
)

__all__ = ["ApiVersion", "BoardInfo", "BuildInfo", "FcVariant", "FcVersion", "MspMessage", "Name", "Uid"]
