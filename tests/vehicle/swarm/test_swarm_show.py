"""A show that simulated vehicles fly."""

from __future__ import annotations

import numpy as np
import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.swarm.shows.reading import parse_show
from tests.swarm.shows.samples import skyc
from tests.vehicle.swarm.test_swarm import COPTERS, launch, places
from tests.vehicle.world import fly

pytestmark = pytest.mark.flight


@pytest.mark.nightly
def test_a_show_is_flown_by_setpoints():
    async def scenario(world, _vehicle):
        vehicles = await launch(world)
        show = parse_show(skyc(3))
        async with world.node.swarm() as swarm:
            with pytest.raises(InvalidArgumentError, match="the show has 4 vehicles, the swarm has 3"):
                await swarm.show(parse_show(skyc(4)))
            with pytest.raises(InvalidArgumentError, match="the show cannot be flown: Drone"):
                await swarm.show(parse_show(skyc(3, radius=2.0)))
            await swarm.show(show, orientation=90.0)
            assert swarm.smallest_separation > 3.0
            found = places(vehicles)
        assert found[:, 2] == pytest.approx([2.0] * 3, abs=1.0)
        middle = found.mean(axis=0)
        assert np.hypot(*(found - middle)[:, :2].T) == pytest.approx([15.0] * 3, abs=1.0)

    fly(COPTERS, scenario)
