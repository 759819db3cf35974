"""A model of vehicles that fly transitions: latency, loss, position errors and wind.

Positions and setpoints are late, and some of each are lost. A vehicle corrects the place that it believes in,
and its velocity, with an acceleration that is limited. The mean wind is balanced at the start; gusts are not.
Setpoints are ahead by the delay that is learned of each vehicle, as the controller sends them.

Many swarms fly at once, in the same arrays and 10 km apart, since most of the time would be spent in calls
of numpy otherwise.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from mavstack.swarm.avoidance import Avoidance
from mavstack.swarm.delays import Delays
from mavstack.swarm.separation import scaled
from mavstack.swarm.steering import steer_members
from mavstack.swarm.transitions import Leg

RATE = 30
CONTROL_STEPS = 3
#: Those of the controller: seconds after the end of a course, metres from a slot.
ARRIVAL_TIMEOUT = 20.0
ARRIVAL_DISTANCE = 1.0
#: The age in seconds above which no delay is learned from a position.
LATE = 0.5
#: The largest separation that is measured, in metres.
LARGEST = 6.0
#: Pairs of vehicles nearer than this, in metres, are searched after this number of steps.
NEAR = 10.0
SEARCH_STEPS = 10
#: Metres from one swarm to the next one, north.
APART = 10_000.0


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


class Courses:
    """The straight transitions of several swarms of one size."""

    def __init__(self, plans):
        assert {plan.method for plan in plans} == {"straight"}
        self.swarms, self.count = len(plans), len(plans[0].slots)
        legs = [plan.legs[0] for plan in plans]
        apart = np.repeat(APART * np.arange(self.swarms), self.count)[:, None] * (1.0, 0.0, 0.0)
        starts, ends = (
            np.vstack([getattr(leg, name) for leg in legs]) + apart for name in ("starts", "ends")
        )
        begin, duration = (
            np.concatenate([getattr(leg, name) for leg in legs]) for name in ("begin", "duration")
        )
        self._leg = Leg(starts, ends, begin, duration)
        self.goals = ends
        self.durations = np.array([plan.duration for plan in plans])

    def state(self, time):
        """Return positions and velocities at a time, or at the time of each vehicle."""
        return self._leg.state(time)

    def in_swarms(self, values):
        return values.reshape(self.swarms, self.count, *values.shape[1:])


class Separations:
    """The smallest scaled distance of two vehicles in each swarm, at most `LARGEST`.

    Only pairs that were near at the last search are measured: the others are still further apart than
    `LARGEST`, since no vehicle is faster than 6 m/s.
    """

    def __init__(self, courses):
        self._courses = courses
        self.smallest = np.full(courses.swarms, LARGEST)
        self._pairs = np.empty((0, 2), int)

    def measure(self, step, positions, flying):
        place, count = scaled(positions), self._courses.count
        if step % SEARCH_STEPS == 0:
            self._pairs = cKDTree(place).query_pairs(NEAR, output_type="ndarray")
        first, second = self._pairs.T
        apart = place[first] - place[second]
        between = np.sqrt((apart * apart).sum(axis=1))
        swarms = first // count
        counted = flying[swarms]
        np.minimum.at(self.smallest, swarms[counted], between[counted])


class Setpoints:
    """The setpoints of courses, as the controller makes them."""

    def __init__(self, courses, margins, avoidance):
        self._courses, self._avoidance = courses, avoidance
        self._delays = Delays(len(courses.goals), margins.latency)
        self._rows = np.arange(len(courses.goals))

    def step(self, now, positions, velocities, ages):
        """Return places, velocities and accelerations; places are NaN where a vehicle avoids another one."""
        courses, step = self._courses, CONTROL_STEPS / RATE
        course = courses.state(now)
        steering = steer_members(positions, velocities, course, self._avoidance)
        learning = self._rows[~steering.deviates & (ages <= LATE)]
        self._delays.learn(learning, (course[0] - positions)[learning], course[1][learning], step)
        after = np.repeat(np.median(courses.in_swarms(self._delays.seconds), axis=1), courses.count)
        places, motion = courses.state(now + after)
        acceleration = (courses.state(now + after + step)[1] - motion) / step
        places, motion = self._delays.lead(self._rows, (places, motion, acceleration), after[:, None])
        off = steering.deviates[:, None]
        return (
            np.where(off, steering.places, places),
            np.where(off, steering.velocities, motion),
            np.where(off, 0.0, acceleration),
        )


class Radio:
    """Packets that arrive late, or not at all."""

    def __init__(self, random, given):
        self._random, self._loss, self._late = random, given.loss, round(given.latency * RATE)
        self._flying = []

    def send(self, step, *values):
        self._flying.append((step + self._late, values))

    def receive(self, step, kept):
        """Write the values that have arrived into the arrays of those that are known."""
        while self._flying and self._flying[0][0] <= step:
            _, values = self._flying.pop(0)
            got = np.flatnonzero(self._random.random(len(kept[0])) >= self._loss)
            for known, value in zip(kept, values, strict=True):
                known[got] = value[got]


class Bodies:
    """Vehicles that track the setpoints that they have, beside the place in which they believe."""

    def __init__(self, random, start, given):
        self._feedforward = given.feedforward
        self._bias = Drift(random, start.shape, given.noise, given.noise_time)
        self._gust = Drift(random, start.shape, given.gusts * given.wind, 2.0)
        self.position = start - self._bias.value  # each vehicle believes to be at its start
        self.velocity = np.zeros_like(start)
        self.setpoint = [start.copy(), np.zeros_like(start), np.zeros_like(start)]

    def believed(self):
        """Return the places in which the vehicles believe at the next step."""
        return self.position + self._bias.step()

    def move(self, believed):
        place, motion, thrust = self.setpoint
        wanted = motion + np.where(np.isnan(place), 0.0, 1.0 * (place - believed))
        push = 0.3 * (self._gust.step() - self.velocity * 0.2)
        acceleration = self._feedforward * thrust + 2.5 * (wanted - self.velocity)
        length = np.sqrt(np.maximum((acceleration * acceleration).sum(axis=1, keepdims=True), 1e-18))
        acceleration *= np.minimum(1.0, 5.0 / length)
        self.velocity = self.velocity + (acceleration + push) / RATE
        self.position = self.position + self.velocity / RATE


def fly(plans, random, margins, limits, conditions=None):
    """Return for each swarm the smallest true separation of two vehicles, and the largest error of a slot."""
    given, courses = conditions or Conditions(), Courses(plans)
    bodies = Bodies(random, courses.state(0.0)[0], given)
    heard = [bodies.setpoint[0].copy(), np.zeros_like(bodies.velocity), np.zeros(len(courses.goals))]
    avoidance = Avoidance(
        distance=(margins.minimum + margins.planned_distance) / 2.0,
        speed=limits.speed,
        acceleration=limits.acceleration,
        step=CONTROL_STEPS / RATE,
    )
    setpoints = Setpoints(courses, margins, avoidance)
    up, down = Radio(random, given), Radio(random, given)
    separations, error = Separations(courses), np.zeros(courses.swarms)
    flying = np.full(courses.swarms, True)
    for step in range(math.ceil((courses.durations.max() + ARRIVAL_TIMEOUT) * RATE)):
        now, believed = step / RATE, bodies.believed()
        away = courses.in_swarms(np.linalg.norm(believed - courses.goals, axis=1)).max(axis=1)
        error[flying] = away[flying]
        ended = (now > courses.durations) & (away < ARRIVAL_DISTANCE)
        flying &= ~(ended | (now > courses.durations + ARRIVAL_TIMEOUT))
        if not flying.any():
            break
        if step % CONTROL_STEPS == 0:
            down.send(step, believed, bodies.velocity, np.full(len(believed), now))
            down.receive(step, heard)
            # The controller knows when a position was received, not when it was measured.
            age = np.clip(now - heard[2] - given.latency, 0.0, 1.0)
            up.send(step, *setpoints.step(now, heard[0] + age[:, None] * heard[1], heard[1], age))
        up.receive(step, bodies.setpoint)
        bodies.move(believed)
        separations.measure(step, bodies.position, flying)
    return separations.smallest, error
