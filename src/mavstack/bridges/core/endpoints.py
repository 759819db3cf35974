"""The endpoints of one vehicle that take data: topics to it, and its services.

Whatever a bus delivers ends here. Nothing raises: bad samples are counted, and the last reason is kept.
"""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

from mavstack.bridges.core.freshness import Freshness
from mavstack.bridges.core.inbound import MAX_AGE
from mavstack.bridges.core.services.refusals import refused
from mavstack.bridges.core.types import codec_of, definition_of
from mavstack.errors import CdrError, InvalidArgumentError, InvalidStateError, MavstackError

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from mavstack.bridges.core.inbound import Inbound
    from mavstack.bridges.core.qos import Qos
    from mavstack.bridges.core.row import Subscription
    from mavstack.dialects import Message

logger = logging.getLogger("mavstack.bridges")
#: The error text for a request that needs permission to control the vehicle.
NO_CONTROL = "control is not allowed: start the bridge with --allow-control"


class Inlet:
    """A subscription of one vehicle.

    Args:
        row: The row.
        name: The full name.
        inbound: The vehicle.
        send: Sends a message to the vehicle.
        now: Returns the Unix time in nanoseconds.
        reject: Called with the reason of each sample that is refused.
    """

    def __init__(
        self,
        row: Subscription,
        name: str,
        inbound: Inbound,
        send: Callable[[Message], None],
        now: Callable[[], int],
        *,
        reject: Callable[[str], None],
    ) -> None:
        #: The table row that defines the endpoint.
        self.row = row
        #: The full name, such as "/mavros/setpoint_raw/local".
        self.name = name
        #: The full name of its node, such as "/mavros/mavstack".
        self.node = ""
        #: The number of samples that were passed to the vehicle.
        self.accepted = 0
        #: The number of samples that were refused.
        self.refused = 0
        #: The reason for the last refusal.
        self.last_reason = ""
        self._inbound = inbound
        self._send = send
        self._now = now
        self._reject = reject
        self._codec = codec_of(row.type)
        self._freshness = Freshness()

    @property
    def type(self) -> str:
        """The full name of the type."""
        return self.row.type

    @property
    def qos(self) -> Qos:
        """The profile."""
        return self.row.qos

    def receive(self, payload: bytes, source: str = "", sent: int = 0) -> bool:
        """Pass a sample in CDR to the vehicle.

        Args:
            payload: The sample.
            source: The publisher.
            sent: When the publisher sent it, in nanoseconds of its own clock; 0: not known.

        Returns:
            Whether it was accepted.
        """
        try:
            if sent > 0 and self.row.stream:
                self._check_delay(source, sent)
            fields = self._codec.decode_fields(payload)
        except (CdrError, InvalidArgumentError) as error:
            return self._refuse(error)
        return self.receive_fields(fields)

    def receive_fields(self, fields: dict[str, Any]) -> bool:
        """Pass a sample by the names of its fields to the vehicle; return whether it was accepted."""
        self._inbound.now = self._now()
        try:
            if self.row.stream:
                self._inbound.check_age(fields)
            for message in self.row.receive(fields, self._inbound):
                self._send(message)
        except Exception as error:  # noqa: BLE001 (a sample may hold anything)
            return self._refuse(error)
        self.accepted += 1
        return True

    def _check_delay(self, source: str, sent: int) -> None:
        """Raise InvalidArgumentError if the network held a sample back; some types have no header."""
        age = self._freshness.age(source, sent / 1e9, self._now() / 1e9)
        if age > MAX_AGE / 1e9:
            raise InvalidArgumentError(
                f"the sample arrived {age:.1f} s later than others of its publisher, "
                "at most 0.5 s are allowed"
            )

    def _refuse(self, error: Exception) -> bool:
        self.refused += 1
        text = str(error) or type(error).__name__
        if text != self.last_reason:
            self.last_reason = text
            self._reject(f"{self.name}: {text}")
        return False


class ServiceEndpoint:
    """A service of one vehicle.

    Args:
        name: The full name.
        type: The full name of the type.
        handle: Answers the fields of a request.
        allowed: The role of the bridge suffices.
        reject: Called with the text of each failure.
        node: The full name of its node, such as "/mavros/mavstack".
    """

    def __init__(
        self,
        name: str,
        type: str,  # noqa: A002 (the name of the concept in ROS)
        handle: Callable[[dict[str, Any]], Awaitable[dict[str, Any]]],
        *,
        allowed: bool = True,
        reject: Callable[[str], None] = logger.warning,
        node: str = "",
    ) -> None:
        self.name = name
        self.type = type
        self.node = node
        self.allowed = allowed
        self._handle = handle
        self._reject = reject
        self._request = codec_of(f"{type}_Request")
        self._response = codec_of(f"{type}_Response")

    async def call(self, payload: bytes) -> bytes:
        """Answer a request in CDR.

        Raises:
            CdrError: The bytes are not such a request; there is no answer.
        """
        fields = await self.call_fields(self._request.decode_fields(payload))
        return self._response.encode_fields(fields)

    async def call_fields(self, request: dict[str, Any]) -> dict[str, Any]:
        """Answer a request by the names of its fields; a failure is an answer too."""
        definition = definition_of(f"{self.type}_Response")
        try:
            if not self.allowed:
                raise InvalidStateError(NO_CONTROL)
            response = await self._handle(request)
            self._response.encode_fields(response)
        except MavstackError as error:
            return self._failure(definition, error)
        except Exception as error:
            logger.debug("a request to %s failed", self.name, exc_info=True)
            return self._failure(definition, error)
        return response

    def _failure(self, definition: Any, error: Exception) -> dict[str, Any]:
        self._reject(f"{self.name}: {str(error) or type(error).__name__}")
        return refused(definition, error)
