"""Versions over random networks."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import MessageTimeout
from mavstack.services.version import ProtocolVersion, RequestAutopilotVersion, RequestProtocolVersion
from tests.services.network import random_impairment, with_cuts
from tests.services.version.test_version import VERSION, VersionHarness

if TYPE_CHECKING:
    from tests.seeds import Seeds


def scenario(seed: int) -> None:
    random = Random(seed)
    harness = VersionHarness(seed, random_impairment(random))
    with_cuts(harness.network, harness.pipes)
    if random.random() < 0.3:
        harness.commands.support(common.MavCmd.REQUEST_MESSAGE, lambda _: common.MavResult.UNSUPPORTED)
    autopilot, protocol = harness.begin(RequestAutopilotVersion()), harness.begin(RequestProtocolVersion())
    assert harness.network.run(lambda: autopilot.done and protocol.done, timeout=300)
    for operation, right in ((autopilot, VERSION), (protocol, ProtocolVersion())):
        if operation.error is None:
            assert operation.result() == right
        else:
            assert isinstance(operation.error, MessageTimeout)


def test_versions_over_bad_links(seeds: Seeds) -> None:
    seeds.check(scenario)
