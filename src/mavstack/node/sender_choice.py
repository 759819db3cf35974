"""The choice between several vehicles that use one system id; see `chosen_senders`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.links.scheme_table import find_scheme
from mavstack.node.api_object import LoopBound

if TYPE_CHECKING:
    from mavstack.links import Channel, Link
    from mavstack.node.component import RemoteComponent
    from mavstack.node.host import NodeHost
    from mavstack.services import Address
    from mavstack.services.heartbeat import Conflict


class SenderChoice(LoopBound):
    """The calls of a node about several senders with one address."""

    links: list[Link]
    _host: NodeHost
    _remotes: dict[Address, RemoteComponent]

    def has_address_conflict(self, address: Address) -> bool:
        """Return whether several senders use one address.

        Args:
            address: The address of a component.

        Returns:
            True while packets of that address contradict each other (boot time, type or unique id).
        """
        return self._host.discovery.has_conflict(address)

    def id_conflict(self, system: int) -> Conflict | None:
        """Return the vehicles that use one system id.

        Args:
            system: The system id.

        Returns:
            The senders and what tells them apart; None if no more than one vehicle uses the system id.
        """
        return self._host.discovery.vehicle_conflict(system)

    def choose_sender(self, system: int, channel: Channel | str | None) -> None:
        """Choose the vehicle to work with, where several use one system id.

        Its packets count only on that channel, and packets for it go over that channel alone, until another
        choice or until the channel closes.

        Args:
            system: The system id.
            channel: The channel, its name, or its remote address, such as "192.168.1.20:14550"; None: take
                the choice back.

        Raises:
            InvalidArgumentError: No open channel is named so, or the vehicles share the channel.
        """
        name = channel if channel is None or isinstance(channel, str) else channel.name
        before = self._host.engine.senders.chosen(system)
        if self._host.engine.senders.choose(system, name) != before:
            for address, remote in self._remotes.items():
                if address.system == system and self._host.is_open:
                    remote.clear_cache()

    async def check_sender(self, system: int, operation: str = "acting on") -> None:
        """Wait until it is clear whether several vehicles use a system id, and refuse if they do.

        Every call that acts is refused in any case; this one comes before it does anything.

        Args:
            system: The system id.
            operation: The operation in the text of the error, with its preposition.

        Raises:
            SystemIdConflictError: Several vehicles use the system id, and none was chosen.
        """
        address = self._host.discovery.autopilot_of(system)
        if address is not None:
            await self._host.wait_until_examined(address, acting=True)
        self.refuse_conflict(system, operation)

    def refuse_conflict(self, system: int, operation: str = "acting on") -> None:
        """Refuse if several vehicles are known to use a system id.

        Args:
            system: The system id.
            operation: The operation in the text of the error, with its preposition.

        Raises:
            SystemIdConflictError: Several vehicles use the system id, and none was chosen.
        """
        address = self._host.discovery.conflicts.get(system)
        if address is not None and (error := self._host.refusal_of(address, operation)) is not None:
            raise error

    def forget_sender(self, system: int) -> None:
        """Forget the chosen vehicle of a system id, because it has another system id now.

        Args:
            system: The system id that it had.
        """
        discovery, senders = self._host.discovery, self._host.engine.senders
        name, address = senders.chosen(system), discovery.conflicts.get(system)
        senders.choose(system, None)
        if name is not None and address is not None:
            discovery.forget_channel(name, self._host.now(), address)
            self._host.wake(discovery)

    def chosen_sender(self, system: int) -> str | None:
        """Return the name of the channel that was chosen for a system id.

        Args:
            system: The system id.

        Returns:
            The name of the channel; None if none was chosen.
        """
        return self._host.engine.senders.chosen(system)

    def _follow_conflicts(self, channel: str | None) -> None:
        """Let the engine refuse what would act on one of several vehicles with one system id."""
        engine, discovery = self._host.engine, self._host.discovery
        engine.senders.limit_to(channel)
        engine.senders.systems = discovery.conflicts
        engine.senders.conflict_of = discovery.vehicle_conflict
        self._host.may_have_several_peers = self._may_have_several_peers

        def forget(name: str) -> None:
            discovery.forget_channel(name, self._host.now())

        engine.on_channel_closed = forget

    def _may_have_several_peers(self) -> bool:
        return len(self.links) > 1 or any(_listens(link.url.scheme) for link in self.links)


def _listens(name: str) -> bool:
    scheme = find_scheme(name)
    return scheme is not None and scheme.listens
