"""Commands by MQTT: requests on `…/cmd/<verb>`, answers on their response topics or `…/result/<verb>`.

Requests that the broker kept are refused, since their age is not known. The subscription is "at most
once", so that no command is carried out twice. At most `MAX_COMMANDS` of one vehicle are under way.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.plain_json import MAX_REQUEST, json_bytes
from mavstack.bridges.mqtt.verbs import answer, failure
from mavstack.errors import InvalidArgumentError, InvalidStateError

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.bridges.mqtt.broker import Arrived
    from mavstack.security.roles import Role
    from mavstack.vehicle import Vehicle

#: Maximum number of commands of one vehicle that run at the same time.
MAX_COMMANDS: Final = 8
#: Maximum length of a response topic in characters.
_MAX_TOPIC: Final = 512


class Commands:
    """The commands of one vehicle.

    Args:
        vehicle: The vehicle.
        base: The beginning of its topics, such as "mavstack/uav1".
        role: The role of the bus.
        publish: Publishes a topic, a payload and the data that correlates answer and request.
        reserved: Beginnings of topics on which no answers are published.
    """

    def __init__(
        self,
        vehicle: Vehicle,
        base: str,
        role: Role,
        publish: Callable[[str, bytes, bytes], object],
        *,
        reserved: tuple[str, ...] = (),
    ) -> None:
        #: The number of requests that were refused or failed.
        self.refused = 0
        self._vehicle = vehicle
        self._prefix = f"{base}/cmd/"
        self._results = f"{base}/result/"
        self._role = role
        self._publish = publish
        self._reserved = reserved
        self._tasks: set[asyncio.Task[None]] = set()

    @property
    def topic(self) -> str:
        """The topic to subscribe to."""
        return f"{self._prefix}+"

    def receive(self, message: Arrived) -> None:
        """Begin to carry out a request."""
        verb = message.topic.removeprefix(self._prefix)
        if message.retained:
            self._reply(message, verb, failure(InvalidArgumentError(_RETAINED)))
        elif message.discarded:
            self._reply(message, verb, failure(InvalidArgumentError(_TOO_LARGE.format(message.discarded))))
        elif len(self._tasks) >= MAX_COMMANDS:
            self._reply(message, verb, failure(InvalidStateError(_BUSY)))
        else:
            task = asyncio.get_running_loop().create_task(self._carry_out(message, verb))
            self._tasks.add(task)
            task.add_done_callback(self._tasks.discard)

    async def close(self) -> None:
        """Cancel the commands that are under way."""
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    async def _carry_out(self, message: Arrived, verb: str) -> None:
        self._reply(message, verb, await answer(self._vehicle, verb, message.payload, self._role))

    def _reply(self, message: Arrived, verb: str, fields: dict[str, Any]) -> None:
        self.refused += not fields["ok"]
        topic = message.response_topic if self._is_allowed(message.response_topic) else self._results + verb
        self._publish(topic, json_bytes({"command": verb, **fields}), message.correlation)

    def _is_allowed(self, topic: str) -> bool:
        """Return whether an answer may be published there: a client must not write our own topics by us."""
        return (
            0 < len(topic) <= _MAX_TOPIC
            and not any(letter in topic for letter in "+#\0")
            and not topic.startswith(("$", *self._reserved))
        )


_RETAINED: Final = (
    "the broker kept this command from an unknown time; publish commands without the flag `retain`"
)
_TOO_LARGE: Final = f"the request has {{}} bytes, at most {MAX_REQUEST} are allowed"
_BUSY: Final = f"{MAX_COMMANDS} commands are under way; wait until one of them is done"
