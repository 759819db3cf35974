"""Members of a swarm without vehicles or a link, in virtual time."""

from __future__ import annotations

import asyncio
from contextlib import suppress

import numpy as np

from mavstack.sim.virtual import run_virtually
from mavstack.swarm.separation import Margins
from mavstack.vehicle.swarm.controller import SwarmController, SwarmOptions
from mavstack.vehicle.swarm.fleet import Readings

STARTS = np.array([[0.0, 0.0, 20.0], [20.0, 0.0, 20.0]])
GOALS = STARTS + np.array([0.0, 30.0, 0.0])


class PerfectMember:
    """A member that is where its last setpoint was, or a step of a tenth of a second along its velocity."""

    def __init__(self, system, place):
        self.system = system
        self.place, self.velocity = place, np.zeros(3)
        self.age = 0.0
        self.error = None

    @property
    def is_following(self):
        return self.error is None

    def state(self):
        return self.place, self.velocity

    def follow(self, place, velocity):
        self.place = self.place + 0.1 * velocity if np.isnan(place).any() else place
        self.velocity = velocity


class Stranger(PerfectMember):
    """A vehicle that is not a member, which flies west along the way of the first member."""

    is_following = False

    def __init__(self):
        super().__init__(9, STARTS[0] + (0.0, 25.0, 0.0))
        self.velocity = np.array([0.0, -2.0, 0.0])

    def state(self):
        self.place = self.place + 0.1 * self.velocity
        return super().state()

    def follow(self, place, velocity):
        raise AssertionError("it gets no setpoints")


class PerfectFleet:
    """Members and other vehicles without a link, on the clock of the loop."""

    def __init__(self, members):
        self.members = tuple(members)
        self.now = asyncio.get_running_loop().time

    def read(self, others=()):
        vehicles = (*self.members, *others)
        positions, velocities = (np.array(each) for each in zip(*(v.state() for v in vehicles), strict=True))
        ages = np.array([each.age for each in vehicles])
        return Readings(positions, velocities, ages, positions[:, 2])

    def check(self):
        pass

    def send(self, members, setpoints, heights):
        for member, place, velocity in zip(members, setpoints.places, setpoints.velocities, strict=True):
            member.follow(place, velocity)


def run(scenario, options=None, kind=PerfectMember, starts=STARTS):
    async def whole():
        fleet = PerfectFleet(kind(index + 1, place) for index, place in enumerate(starts))
        members, options_ = fleet.members, options or SwarmOptions(Margins(latency=0.0))
        controller = SwarmController(fleet, options_)
        loop = asyncio.create_task(controller.run())
        try:
            await scenario(controller, members)
        finally:
            loop.cancel()
            with suppress(asyncio.CancelledError):
                await loop

    run_virtually(whole())
