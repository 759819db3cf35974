"""Names of commands: official ones, those of a user's dialect, and numbers."""

from __future__ import annotations

import pytest

from mavstack.dialects import Dialect, common
from mavstack.services import Address
from mavstack.services.command import Command
from mavstack.services.command_names import command_name, command_of_dialect
from mavstack.services.mission import MissionItem


@pytest.fixture
def dialect(tmp_path):
    path = tmp_path / "mine.xml"
    path.write_text(
        '<mavlink><include>common.xml</include><enums><enum name="MAV_CMD">'
        '<entry value="31900" name="MAV_CMD_SPRAY"/></enum></enums></mavlink>'
    )
    return Dialect.from_xml(path)


def test_a_command_has_the_name_of_its_dialect(dialect):
    spray = dialect.enums["MAV_CMD"].SPRAY
    assert command_name(spray) == "SPRAY"
    assert command_name(31900) == "MAV_CMD 31900"
    assert command_name(22) == command_name(common.MavCmd.NAV_TAKEOFF) == "NAV_TAKEOFF"
    assert command_name(common.MavFrame.LOCAL_NED) == "MAV_FRAME_LOCAL_NED"
    assert Command.of(spray, [1]).name == MissionItem(spray).name == "SPRAY"
    assert MissionItem(spray).description.startswith("SPRAY in frame")
    assert Command.of(spray, [1]) == Command.of(31900, [1])
    assert Command.of(spray, [1]).to_long(Address(1, 1)).command == 31900


def test_a_number_becomes_a_member_where_only_the_dialect_knows_it(dialect):
    member = command_of_dialect(31900, dialect)
    assert member is dialect.enums["MAV_CMD"].SPRAY
    assert command_of_dialect(member, common) is member
    assert type(command_of_dialect(22, dialect)) is type(command_of_dialect(31901, dialect)) is int
    assert type(command_of_dialect(31900, common)) is int
    assert type(command_of_dialect(31900, dialect.core_dialect)) is int
