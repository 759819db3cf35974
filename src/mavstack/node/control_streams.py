"""The streams that steer a remote component: setpoints, sticks, channels, and its shell."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.node.control import ControlStream
from mavstack.node.shell import Shell
from mavstack.services.manual_control import ManualControlSender, OverrideSender
from mavstack.services.setpoints import SetpointStreamer

if TYPE_CHECKING:
    from mavstack.node.host import NodeHost
    from mavstack.services import Address
    from mavstack.services.manual_control import ChannelOverride, ManualInput
    from mavstack.services.setpoints import Setpoint


class ControlStreams:
    """The part of a remote component that steers it."""

    address: Address
    _host: NodeHost

    def setpoints(self, rate: float = 20.0) -> ControlStream[Setpoint]:
        """Stream setpoints while a block runs, as the offboard and guided modes need them.

        Args:
            rate: Hertz at which the last setpoint is repeated.

        Returns:
            An async context manager with `set(setpoint)`.
        """
        streamer = SetpointStreamer(self._host.address, self.address, rate)
        return ControlStream(self._host, streamer, streamer)

    def manual_control(self, rate: float = 20.0) -> ControlStream[ManualInput]:
        """Stream stick positions while a block runs (MANUAL_CONTROL).

        Args:
            rate: Hertz at which the last stick positions are repeated.

        Returns:
            An async context manager with `set(input)`.
        """
        sender = ManualControlSender(self._host.address, self.address, rate)
        return ControlStream(self._host, sender, sender)

    def override_channels(self, rate: float = 20.0) -> ControlStream[ChannelOverride]:
        """Override radio control channels while a block runs (RC_CHANNELS_OVERRIDE).

        Args:
            rate: Hertz at which the last values are repeated.

        Returns:
            An async context manager with `set(override)`.
        """
        sender = OverrideSender(self._host.address, self.address, rate)
        return ControlStream(self._host, sender, sender)

    def shell(self) -> Shell:
        """Open a shell on the component while a block runs (SERIAL_CONTROL).

        Returns:
            An async context manager; write lines to it, iterate over its output.
        """
        return Shell(self._host, self.address)
