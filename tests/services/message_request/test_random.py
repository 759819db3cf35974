"""Requests and rates over random networks."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import CommandDenied, CommandTimeout, MessageTimeout
from mavstack.services.message_request import GetMessageInterval, Interval, RequestMessage, SetMessageInterval
from tests.services.message_request.harness import RequestHarness
from tests.services.network import random_impairment, with_cuts

if TYPE_CHECKING:
    from tests.seeds import Seeds

DEADLINE = 300.0


def scenario(seed: int) -> None:
    random = Random(seed)
    harness = RequestHarness(seed, random_impairment(random))
    with_cuts(harness.network, harness.pipes)
    if random.random() < 0.2:
        harness.network.at(random.uniform(0, 3), harness.vehicle.restart)
    home = harness.begin(RequestMessage(common.HomePosition))
    denied = harness.begin(RequestMessage(common.GpsRawInt))
    rate = Interval.hertz(random.choice([1, 2, 5]))
    setting = harness.begin(SetMessageInterval(common.Attitude, rate))
    getting = harness.begin(GetMessageInterval(common.Attitude))
    operations = [home, denied, setting, getting]
    assert harness.network.run(lambda: all(operation.done for operation in operations), timeout=DEADLINE)
    if home.error is None:
        assert home.result().altitude == 584_000
    else:
        assert isinstance(home.error, MessageTimeout)
    assert isinstance(denied.error, CommandDenied | MessageTimeout)
    if getting.error is None:
        assert getting.result() in (rate, Interval.hertz(4))
    else:
        assert isinstance(getting.error, MessageTimeout)
    assert setting.error is None or isinstance(setting.error, CommandTimeout)


def test_requests_over_bad_links(seeds: Seeds) -> None:
    seeds.check(scenario)
