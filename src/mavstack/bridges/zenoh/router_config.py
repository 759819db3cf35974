"""The configuration of a Zenoh router for a fleet: mutual TLS, and an access list for each certificate.

A certificate has the name of its owner as the common name. A vehicle's may write the keys of its vehicles and
read what is for them; a station's may read the fleet, and with control write to vehicles; a router's may do
everything. All others have a valid certificate at most, and get nothing.

The access list of a router is checked at its sessions: `ingress` is what it receives from a session, `egress`
what it sends to one. A wildcard does not match a part that begins with @, so the caches of the snapshots are
named.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from mavstack.bridges.core.zenoh_session import LEASE
from mavstack.bridges.zenoh.keys import DEFAULT_PREFIX, VehicleKeys, checked_name, checked_prefix, gateway_key
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

DEFAULT_LISTEN: Final = "tls/0.0.0.0:7447"
#: The kinds of messages that are allowed with their direction, and the keys for which they are allowed.
_Right: TypeAlias = "tuple[tuple[tuple[str, ...], str], list[str]]"
_FROM_VEHICLE: Final = (("put", "delete", "declare_queryable", "liveliness_token", "reply"), "ingress")
_WATCH: Final = (
    (("declare_subscriber", "query", "declare_liveliness_subscriber", "liveliness_query"), "ingress"),
    (("put", "delete", "reply", "liveliness_token"), "egress"),
)
_CONTROL: Final = ((("put", "query"), "ingress"), (("reply",), "egress"))
_ALL: Final = (
    "put",
    "delete",
    "declare_subscriber",
    "query",
    "declare_queryable",
    "reply",
    "liveliness_token",
    "declare_liveliness_subscriber",
    "liveliness_query",
)


@dataclass(frozen=True, slots=True)
class Fleet:
    """The owners of certificates, and their rights.

    Attributes:
        gateways: The names of the vehicles of each gateway; one with a single vehicle has its name.
        observers: Stations that read.
        pilots: Stations that control all vehicles too.
        routers: Other routers.
        prefix: The prefix of all keys.
    """

    gateways: Mapping[str, tuple[str, ...]]
    observers: tuple[str, ...] = ()
    pilots: tuple[str, ...] = ()
    routers: tuple[str, ...] = ()
    prefix: str = DEFAULT_PREFIX

    def __post_init__(self) -> None:
        names = self.owners()
        for name in names:
            checked_name(name, "the name of a certificate")
        if double := sorted({name for name in names if names.count(name) > 1}):
            raise InvalidArgumentError(f"the certificate {double[0]!r} has two roles: give each its own")
        served = [vehicle for vehicles in self.gateways.values() for vehicle in vehicles]
        for vehicle in served:
            checked_name(vehicle, "the name of a vehicle")
        if double := sorted({vehicle for vehicle in served if served.count(vehicle) > 1}):
            raise InvalidArgumentError(f"two gateways serve the vehicle {double[0]!r}")
        checked_prefix(self.prefix)

    def owners(self) -> list[str]:
        """Return the names of all certificates."""
        return [*self.gateways, *self.observers, *self.pilots, *self.routers]


@dataclass(slots=True)
class _AccessList:
    rules: list[dict[str, Any]] = field(default_factory=list)
    subjects: list[dict[str, Any]] = field(default_factory=list)
    policies: list[dict[str, Any]] = field(default_factory=list)

    def allow(self, owners: Iterable[str], rights: Iterable[_Right]) -> None:
        """Allow owners of certificates some messages on some keys."""
        names = list(owners)
        if not names:
            return
        subject = names[0] if len(names) == 1 else f"{names[0]} and others"
        self.subjects.append({"id": subject, "cert_common_names": names})
        ids = []
        for number, ((messages, flow), keys) in enumerate(rights):
            ids.append(f"{subject} {number}")
            self.rules.append(
                {
                    "id": ids[-1],
                    "permission": "allow",
                    "flows": [flow],
                    "messages": list(messages),
                    "key_exprs": keys,
                }
            )
        self.policies.append({"rules": ids, "subjects": [subject]})


def access_control(fleet: Fleet) -> dict[str, Any]:
    """Return the value of `access_control` in the configuration of a router."""
    found = _AccessList()
    prefix = fleet.prefix
    everything = [*_with_caches(f"{prefix}/*"), gateway_key(prefix, "*")]
    for gateway, vehicles in fleet.gateways.items():
        found.allow([gateway], _rights_of_gateway(prefix, vehicles, everything))
    fleet_keys = VehicleKeys(prefix, "*")
    read = [key for key in everything if key != f"{prefix}/*/**"] + [
        fleet_keys.frames_out,
        fleet_keys.messages,
        fleet_keys.state("*"),
        fleet_keys.alive("*"),
    ]
    watch = [(right, read) for right in _WATCH]
    found.allow(fleet.observers, watch)
    inbound = [fleet_keys.frames_in, fleet_keys.commands]
    control = [(right, inbound) for right in _CONTROL]
    declared = [((("declare_subscriber", "declare_queryable"), "egress"), inbound)]
    found.allow(fleet.pilots, [*watch, *control, *declared])
    found.allow(fleet.routers, [((_ALL, flow), ["**", *everything]) for flow in ("ingress", "egress")])
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": found.rules,
        "subjects": found.subjects,
        "policies": found.policies,
    }


def _rights_of_gateway(prefix: str, vehicles: Iterable[str], everything: list[str]) -> list[_Right]:
    keys = [VehicleKeys(prefix, name) for name in vehicles]
    own = [expression for each in keys for expression in _with_caches(each.root)]
    return [
        (_FROM_VEHICLE, [*own, gateway_key(prefix, "*")]),
        # The router may send the gateway subscriptions and queries for all vehicles: the rule above lets it
        # publish and answer only for its own vehicles.
        ((("declare_subscriber", "query"), "egress"), everything),
        ((("declare_subscriber",), "ingress"), [each.frames_in for each in keys]),
        ((("put", "delete"), "egress"), [each.frames_in for each in keys]),
        # Let the gateway find other gateways that serve its vehicles.
        ((("declare_liveliness_subscriber", "liveliness_query"), "ingress"), [f"{prefix}/*/alive/*"]),
        ((("liveliness_token", "reply"), "egress"), [f"{each.root}/alive/*" for each in keys]),
    ]


def _with_caches(root: str) -> list[str]:
    """Return the expressions of all keys below a root, and of the caches and tokens of its snapshots."""
    return [f"{root}/**", f"{root}/state/*/@adv/**"]


def router_config(
    fleet: Fleet,
    *,
    certificate: str,
    private_key: str,
    ca: str,
    listen: Iterable[str] = (DEFAULT_LISTEN,),
    connect: Iterable[str] = (),
) -> str:
    """Return the configuration of a router as JSON, which is JSON5 too.

    Args:
        fleet: The owners of certificates.
        certificate: The file with the router's certificate.
        private_key: The file with its private key.
        ca: The file with the authority of all certificates.
        listen: The endpoints on which it listens.
        connect: The endpoints of other routers.
    """
    config = {
        "mode": "router",
        "listen": {"endpoints": list(listen)},
        "connect": {"endpoints": list(connect), "exit_on_failure": False, "timeout_ms": -1},
        "scouting": {"multicast": {"enabled": False}},
        "timestamping": {"enabled": True},
        "transport": {
            "link": {
                "tx": {"lease": LEASE},
                "tls": {
                    "root_ca_certificate": ca,
                    "enable_mtls": True,
                    "listen_certificate": certificate,
                    "listen_private_key": private_key,
                    "connect_certificate": certificate,
                    "connect_private_key": private_key,
                    "close_link_on_expiration": True,
                },
            }
        },
        "access_control": access_control(fleet),
    }
    return json.dumps(config, indent=2) + "\n"
