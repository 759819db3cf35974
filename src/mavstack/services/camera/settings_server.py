"""The settings of a camera as extended parameters, checked by its definition file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.extended_parameters import ExtendedParameterServer

if TYPE_CHECKING:
    from mavstack.services.addressing import Address
    from mavstack.services.camera.definition import CameraDefinition
    from mavstack.services.extended_parameters import ExtendedSetRequest


class CameraSettingsServer(ExtendedParameterServer):
    """The extended parameters of a camera; values that the definition does not allow are refused.

    Args:
        local: The component of the camera.
        definition: The definition, whose defaults are the values at the start.
    """

    def __init__(self, local: Address, definition: CameraDefinition) -> None:
        super().__init__(local)
        self.definition = definition
        for setting in definition.settings.values():
            self.add(setting.name, setting.default, setting.type, handler=self._check)

    @property
    def values(self) -> dict[str, object]:
        """The present values by name."""
        return {name: self[name] for name in self.definition.settings}

    def reset(self) -> None:
        """Set every setting to its default, and broadcast those that changed."""
        for setting in self.definition.settings.values():
            self.set(setting.name, setting.default)

    def _check(self, request: ExtendedSetRequest) -> common.ParamAck:
        try:
            self.definition.check(request.parameter.name, request.parameter.value, self.values)
        except InvalidArgumentError:
            return common.ParamAck.VALUE_UNSUPPORTED
        return common.ParamAck.ACCEPTED
