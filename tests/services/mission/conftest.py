from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from tests.services.mission.server_harness import make_server

if TYPE_CHECKING:
    from tests.services.mission.scripted_peer import ScriptedStation


@pytest.fixture
def station() -> ScriptedStation:
    return make_server()
