from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import LinkError, LinkURLError
from mavstack.links import open_link
from mavstack.links.options import Options
from mavstack.links.role_gate import RoleGate
from mavstack.links.url import parse_url
from mavstack.security.roles import Role
from mavstack.wire import encode

from .conformance import receive

HEARTBEAT = encode(common.Heartbeat(), system=255, component=190)
ARM = encode(common.CommandLong(command=400, param1=1.0), system=255, component=190)
REBOOT = encode(common.CommandInt(command=246), system=255, component=190)


def gate(query: str) -> RoleGate:
    url = parse_url(f"tcpin://0.0.0.0:5760?{query}")
    return RoleGate(url, Options(url))


def test_the_lowest_of_link_list_and_ticket_counts(tmp_path):
    path = tmp_path / "roles"
    path.write_text("# crew\nadminister  CN=a,O=Fleet One\n\noperate CN=b\n")
    listed = gate(f"roles={path}")
    assert listed.role_of("CN=a,O=Fleet One") is Role.ADMINISTER
    assert listed.role_of("CN=a,O=Fleet One", Role.OPERATE) is Role.OPERATE
    assert listed.role_of("CN=b") is Role.OPERATE
    assert listed.role_of("CN=c") is Role.OBSERVE
    assert listed.role_of("") is Role.OBSERVE
    assert gate(f"roles={path}&role=operate").role_of("CN=a,O=Fleet One") is Role.OPERATE
    assert gate("role=observe").role_of("CN=a") is Role.OBSERVE
    assert gate("").filter_of("") is None


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("operate", "line 1: a role needs an identity behind it"),
        ("\nfly CN=a", "line 2: there is no role 'fly'"),
        ("operate CN=a\nobserve CN=a", "line 2: CN=a is named twice"),
        ("x" * 300_000, "longer than"),
    ],
)
def test_mistakes_in_a_file_are_named(tmp_path, text, problem):
    path = tmp_path / "roles"
    path.write_text(text)
    with pytest.raises(LinkError, match=problem):
        gate(f"roles={path}")


def test_an_unknown_role_or_file():
    with pytest.raises(LinkURLError, match="administer, operate, observe"):
        gate("role=fly")
    with pytest.raises(LinkError, match="cannot read the roles"):
        gate("roles=/no/file")


@pytest.mark.parametrize(("server", "client"), [("tcpin", "tcpout"), ("wsin", "ws")])
async def test_a_link_removes_the_packets_that_the_role_does_not_allow(server, client):
    if server == "wsin":
        pytest.importorskip("websockets")
    link = await open_link(f"{server}://127.0.0.1:0?role=operate")
    async with link, open_link(f"{client}://127.0.0.1:{link.address[1]}") as other:
        (await anext(other)).channel.write(REBOOT + HEARTBEAT + REBOOT + ARM)
        channel = (await anext(link)).channel
        assert await receive(link, len(HEARTBEAT + ARM)) == HEARTBEAT + ARM
        assert channel.role_filter.refused == {"COMMAND_INT 246": 2}
