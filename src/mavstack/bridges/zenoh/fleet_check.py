"""Findings about a fleet on Zenoh: its gateways, and the vehicles that they serve."""

from __future__ import annotations

import asyncio
from collections import defaultdict
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.finding import Finding
from mavstack.bridges.core.zenoh_session import close_session, open_session, zenoh_module
from mavstack.bridges.zenoh.keys import VehicleKeys, gateway_key, parse_alive

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mavstack.bridges.core.zenoh_session import SessionOptions

#: Seconds to wait for answers from the network.
ANSWER_TIMEOUT: Final = 2.0


def check_tokens(prefix: str, keys: Iterable[str]) -> list[Finding]:
    """Return the findings about liveliness tokens.

    Args:
        prefix: The prefix of the fleet.
        keys: The tokens of gateways and vehicles.
    """
    gateways, vehicles = set(), defaultdict(list)
    for key in keys:
        if (found := parse_alive(prefix, key)) is not None:
            vehicles[found[0]].append(found[1])
        elif key.startswith(gateway_key(prefix, "")):
            gateways.add(key.removeprefix(gateway_key(prefix, "")))
    if not gateways:
        return [
            Finding(False, f"no gateway serves the fleet {prefix}: is `mav bridge zenoh` connected to it?")
        ]
    findings = [_gateway_finding(each, vehicles) for each in sorted(gateways)]
    for name, serving in sorted(vehicles.items()):
        if len(serving) > 1:
            both = " and ".join(sorted(serving))
            findings.append(
                Finding(False, f"{both} serve a vehicle {name}, and pass no commands on; use --name")
            )
    return findings


def _gateway_finding(gateway: str, vehicles: dict[str, list[str]]) -> Finding:
    served = sorted(name for name, serving in vehicles.items() if gateway in serving)
    if not served:
        return Finding(False, f"gateway {gateway} hears no vehicle")
    return Finding(True, f"gateway {gateway} serves {', '.join(served)}")


async def check_fleet(options: SessionOptions, prefix: str) -> list[Finding]:
    """Return the findings about a fleet.

    Args:
        options: How to reach a router.
        prefix: The prefix of the fleet.

    Raises:
        LinkError: No router answers.
    """
    session = await open_session(zenoh_module("a fleet over Zenoh"), options)
    try:
        keys = await asyncio.get_running_loop().run_in_executor(None, _tokens, session, prefix)
    finally:
        await close_session(session)
    return check_tokens(prefix, keys)


def _tokens(session: Any, prefix: str) -> list[str]:
    expressions = (gateway_key(prefix, "*"), VehicleKeys(prefix, "*").alive("*"))
    replies = (each for key in expressions for each in session.liveliness().get(key, timeout=ANSWER_TIMEOUT))
    return [str(reply.ok.key_expr) for reply in replies if reply.ok is not None]
