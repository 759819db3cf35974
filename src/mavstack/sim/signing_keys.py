"""The signing key of a simulated vehicle: set up over a link (SETUP_SIGNING), and kept over reboots.

A simulated vehicle follows ArduPilot and PX4. Without a key it accepts the first one unsigned, over any link.
From then on every request must be signed with the present key, also the one that turns signing off: a key of
zeros with the timestamp zero. An armed vehicle refuses. A key counts at once, on all links of the vehicle and
on those that open later, instead of the keys that the URLs of the links name.

It is stricter in one thing: of unsigned packets it accepts only RADIO_STATUS. ArduPilot accepts everything on
its first port, which is USB, and PX4 HEARTBEAT, ADSB_VEHICLE and COLLISION on all.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.node.signing_states import SigningStates

if TYPE_CHECKING:
    from mavstack.security import SigningKey
    from mavstack.services.signing_setup import KeySettled, SigningRequest
    from mavstack.sim.port import Port
    from mavstack.sim.vehicle import SimulatedVehicle


class SigningKeys:
    """The signing key of one vehicle, and the signing states of its ports.

    Attributes:
        states: The signing states; they outlive a reboot, so that no packet is accepted twice.
        key: The key that was set up; None if signing was turned off, or never set up.
    """

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        self.states = SigningStates()
        self.key: SigningKey | None = None
        self._vehicle = vehicle
        self._was_set_up = False

    def key_of_port(self, key: SigningKey | None) -> SigningKey | None:
        """Return the key of a new port: the one that was set up, or else the given one."""
        return self.key if self._was_set_up else key

    def sign(self, port: Port) -> None:
        """Sign and verify with the key of a port."""
        channel, engine = port.state, self._vehicle.engine
        if channel is None or (port.key is None and channel.signing is None):
            return
        clock = max(engine.signing_clock, channel.clock)
        channel.signing = self.states.create(port.key, channel.link_id, clock)
        if port.key is None:
            engine.routes.unverify(channel)

    def refusal(self, request: SigningRequest) -> str | None:
        """Return the reason why a key may not be set up now; None if it may."""
        return "the vehicle is armed" if self._vehicle.autopilot.armed else None

    def settled(self, event: KeySettled) -> None:
        """Use a key that was set up on all ports."""
        if not event.changed:
            return
        self.key, self._was_set_up = event.key, True
        others = [port for port in self._vehicle.ports if port.key != event.key]
        # Channels on which the engine itself has already applied the key.
        applied = self._vehicle.engine.routes.heard_on(event.peer)
        for port in others:
            port.key = event.key
            if port.state not in applied:
                self.sign(port)
        if others:
            text = "signing turned off" if event.key is None else "signing key set"
            self._vehicle.announce("signing", text)
