"""A model of vehicles that fly a transition: latency, loss, position errors and wind.

Positions and setpoints are late, and some of each are lost. A vehicle corrects the place that it believes in,
and its velocity, with an acceleration that is limited. The mean wind is balanced at the start; gusts are not.
Setpoints are ahead by the delay that is learned of each vehicle, as the controller sends them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial.distance import pdist

from mavstack.swarm.avoidance import Avoidance
from mavstack.swarm.delays import Delays
from mavstack.swarm.separation import scaled
from mavstack.swarm.steering import steer_members

RATE = 30
CONTROL_STEPS = 3
#: Those of the controller: seconds after the end of a course, metres from a slot.
ARRIVAL_TIMEOUT = 20.0
ARRIVAL_DISTANCE = 1.0
#: The age in seconds above which no delay is learned from a position.
LATE = 0.5


@dataclass(frozen=True)
class Conditions:
    """Latency in seconds each way, part of packets lost, position noise in metres, wind in m/s."""

    latency: float = 0.2
    loss: float = 0.05
    noise: float = 0.5
    noise_time: float = 20.0
    wind: float = 8.0
    gusts: float = 0.15
    #: Part of the acceleration of a setpoint that the vehicle adds to its own: 1 of PX4, 0 of ArduPilot.
    feedforward: float = 0.0


class Drift:
    """A random value with a standard deviation and a time constant."""

    def __init__(self, random, shape, deviation, time):
        self._random, self._deviation = random, deviation
        self._keep = math.exp(-1.0 / (RATE * time))
        self.value = deviation * random.normal(size=shape)

    def step(self):
        fresh = self._deviation * math.sqrt(1.0 - self._keep**2)
        self.value = self._keep * self.value + fresh * self._random.normal(size=self.value.shape)
        return self.value


class Setpoints:
    """The setpoints of a plan, as the controller makes them."""

    def __init__(self, plan, margins, avoidance):
        self._plan, self._avoidance = plan, avoidance
        self._delays = Delays(len(plan.slots), margins.latency)
        self._rows = np.arange(len(plan.slots))

    def step(self, now, positions, velocities, ages):
        """Return places, velocities and accelerations; places are NaN where a vehicle avoids another one."""
        course, step = self._plan.state(now), CONTROL_STEPS / RATE
        steering = steer_members(positions, velocities, course, self._avoidance)
        learning = self._rows[~steering.deviates & (ages <= LATE)]
        self._delays.learn(learning, (course[0] - positions)[learning], course[1][learning], step)
        after = float(np.median(self._delays.seconds))
        places, motion = self._plan.state(now + after)
        acceleration = (self._plan.state(now + after + step)[1] - motion) / step
        places, motion = self._delays.lead(self._rows, (places, motion, acceleration), after)
        off = steering.deviates[:, None]
        return (
            np.where(off, steering.places, places),
            np.where(off, steering.velocities, motion),
            np.where(off, 0.0, acceleration),
        )


def fly(plan, random, margins, limits, conditions=None):
    """Return the smallest true separation of two vehicles, and the largest error of a slot."""
    given = conditions or Conditions()
    count, late = len(plan.slots), round(given.latency * RATE)
    position, velocity = plan.state(0.0)[0].copy(), np.zeros((count, 3))
    bias = Drift(random, (count, 3), given.noise, given.noise_time)
    position -= bias.value  # each vehicle believes to be at its start
    gust = Drift(random, (count, 3), given.gusts * given.wind, 2.0)
    heard = [position + bias.value, velocity.copy(), np.zeros(count)]
    place, motion, thrust = position + bias.value, np.zeros((count, 3)), np.zeros((count, 3))
    avoidance = Avoidance(
        distance=(margins.minimum + margins.planned_distance) / 2.0,
        speed=limits.speed,
        acceleration=limits.acceleration,
        step=CONTROL_STEPS / RATE,
    )
    setpoints = Setpoints(plan, margins, avoidance)
    up, down, smallest = [], [], math.inf
    goals = plan.state(plan.duration)[0]
    for step in range(math.ceil((plan.duration + ARRIVAL_TIMEOUT) * RATE)):
        now, believed = step / RATE, position + bias.step()
        if now > plan.duration and np.linalg.norm(believed - goals, axis=1).max() < ARRIVAL_DISTANCE:
            break
        if step % CONTROL_STEPS == 0:
            down.append((step + late, now, believed.copy(), velocity.copy()))
            while down and down[0][0] <= step:
                _, sent, there, moving = down.pop(0)
                for index in np.flatnonzero(random.random(count) >= given.loss):
                    heard[0][index], heard[1][index], heard[2][index] = there[index], moving[index], sent
            # The controller knows when a position was received, not when it was measured.
            age = np.clip(now - heard[2] - given.latency, 0.0, 1.0)[:, None]
            sent = setpoints.step(now, heard[0] + age * heard[1], heard[1], age[:, 0])
            up.append((step + late, *sent))
        while up and up[0][0] <= step:
            _, *values = up.pop(0)
            got = random.random(count) >= given.loss
            for kept, value in zip((place, motion, thrust), values, strict=True):
                kept[got] = value[got]
        wanted = motion + np.where(np.isnan(place), 0.0, 1.0 * (place - believed))
        push = 0.3 * (gust.step() - velocity * 0.2)
        acceleration = given.feedforward * thrust + 2.5 * (wanted - velocity)
        length = np.maximum(np.linalg.norm(acceleration, axis=1, keepdims=True), 1e-9)
        acceleration *= np.minimum(1.0, 5.0 / length)
        velocity = velocity + (acceleration + push) / RATE
        position = position + velocity / RATE
        smallest = min(smallest, float(pdist(scaled(position)).min()))
    error = np.linalg.norm(position + bias.value - goals, axis=1)
    return smallest, float(error.max())
