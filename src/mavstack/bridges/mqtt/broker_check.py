"""Findings about vehicles on a broker of MQTT: who is there, what they allow, and whether they answer."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.finding import Finding
from mavstack.bridges.core.plain_json import parse_object
from mavstack.bridges.mqtt.broker import Session
from mavstack.errors import InvalidArgumentError
from mavstack.security.roles import Role

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from mavstack.bridges.mqtt.broker import Arrived, Broker

#: Seconds in which a broker must send its retained messages, and in which bridges must answer.
ANSWER_TIMEOUT: Final = 1.5
#: A request without a command: every bridge refuses it, which shows that requests and answers arrive.
PROBE: Final = "check"
_CLIENTS: Final = "$SYS/broker/clients/connected"
#: Maximum number of digits of the number of clients.
_MAX_DIGITS: Final = 9


async def check_broker(broker: Broker, prefix: str) -> list[Finding]:
    """Return the findings about a broker.

    Args:
        broker: The broker.
        prefix: The beginning of all topics.

    Raises:
        LinkError: The broker does not answer, or refuses.
    """
    kept: dict[str, bytes] = {}

    def take(message: Arrived) -> None:
        kept[message.topic] = message.payload

    topics = [f"{prefix}/+/{end}" for end in ("status", "state", f"result/{PROBE}")]
    session = Session(broker, subscriptions=[*topics, _CLIENTS], take=take, retained=True)
    await session.open()
    try:
        await asyncio.sleep(ANSWER_TIMEOUT)
        for name in _vehicles(prefix, kept):
            session.publish(f"{prefix}/{name}/cmd/{PROBE}", b"{}", qos=1)
        await asyncio.sleep(ANSWER_TIMEOUT)
    finally:
        await session.close()
    return list(describe(str(broker), prefix, kept))


def describe(broker: str, prefix: str, kept: dict[str, bytes]) -> Iterator[Finding]:
    """Yield the findings about the messages that a broker sent.

    Args:
        broker: The broker, in words.
        prefix: The beginning of all topics.
        kept: The last payload of each topic.
    """
    count = kept.get(_CLIENTS, b"").decode("ascii", "replace")
    if count.isdecimal() and len(count) <= _MAX_DIGITS:
        others = max(int(count) - 1, 0)
        clients = "1 client" if others == 1 else f"{others} clients"
        text = f"the broker {broker} has {clients}, with one for each vehicle of a bridge"
        yield Finding(True, text)
    else:
        yield Finding(True, f"the broker {broker} accepts clients, and does not report their number")
    names = _vehicles(prefix, kept)
    if not names:
        yield Finding(
            False,
            f"no vehicle is below {prefix}/: does `mav bridge mqtt` run with this broker and --prefix, and "
            "may this client read its topics?",
        )
    for name in names:
        yield from _of_vehicle(name, f"{prefix}/{name}", kept)


def _vehicles(prefix: str, kept: Iterable[str]) -> list[str]:
    ends = (topic.removeprefix(f"{prefix}/") for topic in kept if topic.startswith(f"{prefix}/"))
    return sorted(
        {name for name, slash, end in (each.rpartition("/") for each in ends) if slash and end == "status"}
    )


def _of_vehicle(name: str, base: str, kept: dict[str, bytes]) -> Iterator[Finding]:
    if kept[f"{base}/status"] != b"online":
        yield Finding(False, f"{name} is offline: its bridge has ended, or receives no heartbeats of it")
        return
    state = _object(kept.get(f"{base}/state", b""))
    words = [str(state[key]) for key in ("autopilot", "type", "mode") if state.get(key)]
    yield Finding(True, f"{name} is online ({', '.join(words) or 'no state was published'})")
    if f"{base}/result/{PROBE}" not in kept:
        yield Finding(
            False,
            f"{name} does not answer requests: may this client publish on {base}/cmd/ and read "
            f"{base}/result/?",
        )
    elif state.get("role", Role.OBSERVE.word) == Role.OBSERVE.word:
        yield Finding(
            True, f"{name} answers requests and refuses commands: its bridge has no --allow-control"
        )
    else:
        yield Finding(True, f"{name} answers requests, with the role {state['role']}")


def _object(payload: bytes) -> dict[str, Any]:
    try:
        return parse_object(payload)
    except InvalidArgumentError:
        return {}
