"""Versions over random networks."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import MessageTimeout
from mavstack.services.version import ProtocolVersion, RequestAutopilotVersion, RequestProtocolVersion
from tests.services.network import random_impairment, with_cuts
from tests.services.version.test_version import VERSION, Versioned

if TYPE_CHECKING:
    from tests.seeds import Seeds


def scenario(seed: int) -> None:
    random = Random(seed)
    peers = Versioned(seed, random_impairment(random))
    with_cuts(peers.network, peers.pipes)
    if random.random() < 0.3:
        peers.commands.support(common.MavCmd.REQUEST_MESSAGE, lambda _: common.MavResult.UNSUPPORTED)
    autopilot, protocol = peers.begin(RequestAutopilotVersion()), peers.begin(RequestProtocolVersion())
    assert peers.network.run(lambda: autopilot.done and protocol.done, timeout=300)
    for operation, right in ((autopilot, VERSION), (protocol, ProtocolVersion())):
        if operation.error is None:
            assert operation.result() == right
        else:
            assert isinstance(operation.error, MessageTimeout)


def test_versions_over_bad_links(seeds: Seeds) -> None:
    seeds.check(scenario)
