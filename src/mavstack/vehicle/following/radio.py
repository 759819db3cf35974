"""Followers that fly by their firmware's own mode, while this program relays the leader's motion.

The parameters of each follower are set before its mode is entered, and restored if that fails. While they
follow, the program watches: a leader that is no longer heard, a follower that left its mode or stays behind,
two followers that come too near. None of the firmwares reports the first or the third, so the block ends with
an error and the followers hold. The parameters keep their values at the end.
"""

from __future__ import annotations

import asyncio
import math
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.dialects import common
from mavstack.errors import (
    ActionInterrupted,
    CommandDenied,
    ContactLost,
    GroupError,
    MessageTimeout,
    RemoteError,
    SwarmStopped,
)
from mavstack.geodesy import LocalFrame
from mavstack.node.messaging import send
from mavstack.services.arguments import check_numbers
from mavstack.swarm.guard import Breach, Guard, GuardLimits
from mavstack.vehicle.actions.preconditions import check_preconditions
from mavstack.vehicle.firmware.changes import Changes, undone_on_failure
from mavstack.vehicle.following.relay import LeaderMotion
from mavstack.vehicle.following.settings import SURFACE, SURFACE_GAIN, FollowSettings, Place, follow_settings
from mavstack.vehicle.status_text_capture import with_status_texts

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.swarm.arrays import Points
    from mavstack.vehicle.vehicle import Vehicle

_OPERATION: Final = "following with"
#: Timeout in seconds of holding the followers at the end, if one of them does not answer.
_HOLD_TIMEOUT: Final = 5.0
_CHECK_INTERVAL: Final = 0.2
#: Timeout in seconds of the request for the rate of the leader's positions.
_INTERVAL_TIMEOUT: Final = 3.0
#: Rate in hertz at which followers report their positions.
_FOLLOWER_RATE: Final = 2.0
#: The age in seconds above which a follower's position is not compared with its place.
_OLD: Final = 2.0


@dataclass(frozen=True, slots=True)
class FollowOptions:
    """How vehicles follow by radio.

    Attributes:
        rate: At least this many positions of the leader per second; firmwares follow unevenly below 4. The
            leader keeps sending them at the end.
        relay: True: this program sends the leader's motion to the followers. False: they receive the leader
            itself, as on a radio network; only ArduPilot can follow then, unless the leader sends
            FOLLOW_TARGET.
        max_error: Metres between a follower and its place at which following ends. A copter of ArduPilot
            stays behind its place by the distance in which it can stop.
        guard: The distance that followers keep, and the age of positions.
    """

    rate: float = 5.0
    relay: bool = True
    max_error: float = 50.0
    guard: GuardLimits = field(default_factory=GuardLimits)

    def __post_init__(self) -> None:
        check_numbers(rate=self.rate, max_error=self.max_error)


async def follow_by_radio(
    places: Mapping[Vehicle, Place],
    leader: Vehicle,
    *,
    duration: float | None = None,
    options: FollowOptions | None = None,
) -> float:
    """Let vehicles follow a leader by their firmware's own mode.

    Args:
        places: The place of each follower.
        leader: The vehicle to follow, which another program flies.
        duration: Seconds; None: until the task is cancelled.
        options: How they follow; None: the defaults.

    Returns:
        The smallest distance of two followers in metres, heights divided by 2; infinite for a single one.

    Raises:
        ActionRefused: A follower is not armed, or on the ground; nothing was sent.
        ActionUnsupported: A follower has no such mode; nothing was sent.
        InvalidArgumentError: A firmware cannot keep a place; nothing was sent.
        ContactLost: No position of the leader, or no heartbeat of a follower arrives.
        ActionInterrupted: A follower left its mode, or stays behind.
        SwarmStopped: Two followers came too near to each other.
        GroupError: Several followers did not begin to follow.
    """
    for vehicle in places:
        check_preconditions(vehicle, "follow", _OPERATION)
    flight = _RadioFlight(places, leader, options or FollowOptions())
    await flight.prepare()
    return await flight.fly(duration)


class _RadioFlight:
    """One flight of followers behind a leader."""

    def __init__(self, places: Mapping[Vehicle, Place], leader: Vehicle, options: FollowOptions) -> None:
        self._places, self._leader, self._options = places, leader, options
        self._guard = Guard(options.guard)
        self._modes: dict[Vehicle, str] = {}
        self._now = leader.connection.now

    async def prepare(self) -> None:
        """Learn where all vehicles are, and check the settings; nothing is changed but rates of messages."""
        await self._request_leader_positions()
        here = await self._leader.wait_for_message(common.GlobalPositionInt)
        self._frame = LocalFrame(here.lat / 1e7, here.lon / 1e7, 0.0)
        on_surface = all(vehicle.vehicle_type in SURFACE for vehicle in self._places)
        steers = self._leader.vehicle_type in SURFACE
        self._motion = LeaderMotion(self._frame, SURFACE_GAIN if on_surface else None, steers=steers)
        self._motion.update(here, self._now())
        await asyncio.gather(*(self._request_position(vehicle) for vehicle in self._places))
        own, leader = self._leader.connection.address.system, self._leader.system
        system = own if self._options.relay else leader
        self._settings = {
            vehicle: follow_settings(vehicle, place, system, self._height(vehicle, place, here))
            for vehicle, place in self._places.items()
        }

    async def fly(self, duration: float | None) -> float:
        """Follow for some seconds; see `follow_by_radio`."""
        relay = asyncio.create_task(self._relay())
        try:
            await self._begin()
            end = math.inf if duration is None else self._now() + duration
            while self._now() < end:
                if relay.done():
                    relay.result()  # raises the error that ended the relay
                self._check()
                await asyncio.sleep(_CHECK_INTERVAL)
        except BaseException:
            await self._end(quietly=True)
            raise
        finally:
            relay.cancel()
        await self._end(quietly=False)
        return self._guard.smallest_separation

    async def _begin(self) -> None:
        starting = (self._enter(vehicle, settings) for vehicle, settings in self._settings.items())
        outcomes = await asyncio.gather(*starting, return_exceptions=True)
        errors = {
            vehicle.system: outcome
            for vehicle, outcome in zip(self._settings, outcomes, strict=True)
            if isinstance(outcome, Exception)
        }
        if len(outcomes) == 1 and errors:
            raise next(iter(errors.values()))
        if errors:
            raise GroupError("following", errors, len(outcomes))

    async def _enter(self, vehicle: Vehicle, settings: FollowSettings) -> None:
        changes = Changes(vehicle)
        async with undone_on_failure(changes):
            for name, value in settings.parameters.items():
                await changes.set_parameter(name, value)
            await with_status_texts(vehicle, changes.set_mode(settings.mode))
        self._modes[vehicle] = settings.mode.lower()

    async def _relay(self) -> None:
        while True:
            message = self._leader.latest(common.GlobalPositionInt)
            if message is not None and self._leader_age <= 1.0:
                self._motion.update(message, self._now() - self._leader_age)
                for sent in self._motion.messages(self._now()):
                    if self._options.relay:
                        for vehicle in self._places:
                            send(self._leader.connection, sent, vehicle.address)
            await asyncio.sleep(0.5 / self._options.rate)

    def _check(self) -> None:
        if self._leader_age > self._options.guard.link_age:
            raise ContactLost("following", str(self._leader.address), answer="no position arrives")
        for vehicle, mode in self._modes.items():
            if not vehicle.alive:
                raise ContactLost(_OPERATION, str(vehicle.address), answer="it fell silent")
            if (vehicle.mode or mode).lower() != mode:
                raise ActionInterrupted(
                    _OPERATION, str(vehicle.address), answer=f"it changed to {vehicle.mode}"
                )
            self._check_place(vehicle)
        self._check_separation()

    def _check_place(self, vehicle: Vehicle) -> None:
        place = self._places[vehicle]
        slot = self._motion.slot((place.forward, place.right, place.up), self._now())
        error = float(np.linalg.norm((self._position(vehicle) - slot)[:2]))
        if error > self._options.max_error:
            answer = f"it is {error:.0f} m from its place: the leader is faster than the follower may be"
            raise ActionInterrupted(_OPERATION, str(vehicle.address), answer=answer)

    def _check_separation(self) -> None:
        vehicles = list(self._places)
        positions = np.array([self._position(vehicle) for vehicle in vehicles]).reshape(-1, 3)
        for finding in self._guard.check(positions, [0.0] * len(vehicles)):
            if finding.breach is Breach.SEPARATION:
                systems = tuple(vehicles[index].system for index in finding.members)
                names = " and ".join(f"vehicle {system}" for system in systems)
                raise SwarmStopped(f"{finding.breach} of {names}: {finding.text}", systems)

    async def _end(self, *, quietly: bool) -> None:
        """Let the followers hold that still follow."""
        following = [vehicle for vehicle, mode in self._modes.items() if (vehicle.mode or "").lower() == mode]
        holding = asyncio.gather(*(each.hold() for each in following), return_exceptions=True)
        try:
            async with asyncio.timeout(_HOLD_TIMEOUT if quietly else None):
                outcomes = await holding
        except TimeoutError:
            return
        errors = [outcome for outcome in outcomes if isinstance(outcome, RemoteError)]
        if errors and not quietly:
            raise errors[0]

    def _height(self, vehicle: Vehicle, place: Place, leader: common.GlobalPositionInt) -> float:
        own = vehicle.latest(common.GlobalPositionInt)
        home = 0.0 if own is None else (own.alt - own.relative_alt) / 1e3
        return leader.alt / 1e3 + place.up - home

    def _position(self, vehicle: Vehicle) -> Points:
        message, age = (vehicle.latest(common.GlobalPositionInt), vehicle.age(common.GlobalPositionInt))
        if message is None or age is None or age > _OLD:
            return np.full(3, math.nan)
        north, east, down = self._frame.to_local(message.lat / 1e7, message.lon / 1e7, message.alt / 1e3)
        velocity = np.array((message.vx, message.vy, -message.vz)) / 100.0
        return np.array((north, east, -down)) + age * velocity

    @property
    def _leader_age(self) -> float:
        age = self._leader.age(common.GlobalPositionInt)
        return math.inf if age is None else age

    async def _request_leader_positions(self) -> None:
        """Let the leader send positions as often as followers need them.

        A leader that sends more keeps its rate, since another program may need it.
        """
        leader = self._leader
        with suppress(CommandDenied, MessageTimeout):  # not every firmware reports its rates
            now = await leader.component.get_message_interval(
                common.GlobalPositionInt, timeout=_INTERVAL_TIMEOUT
            )
            if now.rate >= self._options.rate:
                return
        await leader.set_message_rate(common.GlobalPositionInt, self._options.rate)

    async def _request_position(self, vehicle: Vehicle) -> None:
        if (vehicle.age(common.GlobalPositionInt) or math.inf) > 1.0 / _FOLLOWER_RATE:
            await vehicle.set_message_rate(common.GlobalPositionInt, _FOLLOWER_RATE)
        await vehicle.wait_for_message(common.GlobalPositionInt)
