"""The HEARTBEAT of a ground station on a link that is only watched: many vehicles are silent without one.

The options of the link's URL apply: `id`, `mavlink`, `heartbeat_rate`, and the key, with which the channel
signs. The version "auto" follows the packets that the channel received.
"""

from __future__ import annotations

import asyncio
from time import time
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import LinkClosedError
from mavstack.wire import Encoder

if TYPE_CHECKING:
    from mavstack.cli.watch.link_follower import Follower
    from mavstack.links import Channel, Link

GROUND_STATION: Final = 255
MISSION_PLANNER: Final = 190
DEFAULT_RATE: Final = 1.0

_MESSAGE: Final = common.Heartbeat(
    type=common.MavType.GCS,
    autopilot=common.MavAutopilot.INVALID,
    system_status=common.MavState.ACTIVE,
    mavlink_version=3,
)


async def send_heartbeats(link: Link, follower: Follower) -> None:
    """Send heartbeats over all channels of a followed link until cancelled; a rate of 0 sends none."""
    settings = link.settings
    rate = DEFAULT_RATE if settings.heartbeat_rate is None else settings.heartbeat_rate
    sequences: dict[str, int] = {}
    while rate:
        for channel in link.channels:
            if channel.name in follower.signings:
                sequences[channel.name] = _send(channel, link, follower, sequences.get(channel.name, 0))
        await asyncio.sleep(1 / rate)


def _send(channel: Channel, link: Link, follower: Follower, sequence: int) -> int:
    """Send one heartbeat; return the sequence number of the next."""
    settings, signing = link.settings, follower.signings[channel.name]
    encoder = Encoder(
        settings.system or GROUND_STATION,
        settings.component or MISSION_PLANNER,
        version=2 if signing is not None else _version(settings.version or 2, channel.name, follower),
        signing=signing,
    )
    encoder.sequence = sequence
    try:
        channel.write(encoder.encode(_MESSAGE, time()))
    except LinkClosedError:
        return sequence
    return encoder.sequence


def _version(version: int | str, channel: str, follower: Follower) -> int:
    """Return the version to send; "auto" is 1 if the channel has only received version 1."""
    if isinstance(version, int):
        return version
    parser = follower.observer.channels.get(channel)
    heard = parser.statistics if parser is not None else None
    return 1 if heard is not None and heard.version_1 and not heard.version_2 else 2
