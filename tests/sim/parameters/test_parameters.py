"""Parameters of a simulated vehicle: reads, changes, reboots, and the view of clients."""

from __future__ import annotations

from itertools import product

import pytest

from mavstack.dialects import common
from mavstack.errors import LocalProtocolError, ParameterDenied
from mavstack.services.parameters import Encoding, ParameterClient, ParameterServer, ParameterWritten
from mavstack.services.parameters.value import same
from mavstack.sim.parameters import Parameters
from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.services.network import GROUND, VEHICLE, Network

COPTER = (Firmware.ARDUPILOT, VehicleType.COPTER)


class ParameterNetwork:
    """A vehicle that has only parameters, and a ground station."""

    def __init__(self, firmware=Firmware.ARDUPILOT, vehicle_type=VehicleType.COPTER) -> None:
        self.parameters = Parameters(firmware, vehicle_type)
        self.network = Network(keep_packets=True)
        self.vehicle = self.network.node(VEHICLE, self._boot)
        self.ground = self.network.node(GROUND)
        self.client = self.ground.engine.add(ParameterClient(GROUND, VEHICLE, self.parameters.encoding))
        self.network.connect(self.ground, self.vehicle)

    def _boot(self, engine) -> None:
        self.server = engine.add(self.parameters.new_server(VEHICLE, engine.touch))

    def run(self, operation, timeout=60.0):
        self.ground.engine.touch(self.client)
        assert self.network.run(lambda: operation.done, timeout=timeout)
        for event in self.vehicle.events_of(ParameterWritten):
            self.parameters.written(event)
        self.vehicle.events.clear()
        return operation.result()

    def received_values(self) -> list[tuple[str, float]]:
        self.network.run(timeout=1.0)
        messages = [packet.message for packet in self.ground.received]
        return [(m.param_id, m.param_value) for m in messages if isinstance(m, common.ParamValue)]


def test_value_has_its_type() -> None:
    parameters = Parameters(*COPTER)
    assert parameters["RTL_ALT"] == 1500
    assert isinstance(parameters["RTL_ALT"], int)
    assert isinstance(parameters["WPNAV_SPEED"], float)
    assert parameters.get("WPNAV_SPEED", 1.0) == 1000.0
    assert parameters.get("NOT_THERE", None) is None
    assert "RTL_ALT" in parameters
    assert "MPC_XY_CRUISE" not in parameters
    assert len(parameters) == len(parameters.table)


def test_unknown_name_raises_key_error() -> None:
    parameters = Parameters(*COPTER)
    for access in (
        lambda: parameters["MPC_XY_CRUISE"],
        lambda: parameters.set("MPC_XY_CRUISE", 1.0),
        lambda: parameters.on_change("MPC_XY_CRUISE", print),
    ):
        with pytest.raises(KeyError, match="MPC_XY_CRUISE"):
            access()


def test_value_out_of_range_of_its_type_is_refused() -> None:
    parameters = Parameters(*COPTER)
    with pytest.raises(LocalProtocolError):
        parameters.set("FLTMODE1", 300)
    assert parameters["FLTMODE1"] == 7


@pytest.mark.parametrize(("firmware", "name"), [("ardupilot", "SYSID_THISMAV"), ("px4", "MAV_SYS_ID")])
def test_system_id_is_a_parameter_with_its_own_default(firmware, name) -> None:
    parameters = Parameters(Firmware(firmware), VehicleType.SUB, 42)
    assert (parameters[name], parameters.system) == (42, 42)
    parameters.set(name, 7)
    assert parameters.system == 7
    parameters.reset()
    assert parameters.system == 42
    assert Parameters(Firmware(firmware), VehicleType.SUB).system == 1


def test_vehicles_have_independent_values() -> None:
    one, other = Parameters(*COPTER), Parameters(*COPTER)
    one.set("RTL_ALT", 3000)
    assert other["RTL_ALT"] == 1500


@pytest.mark.parametrize(("firmware", "vehicle_type"), list(product(Firmware, VehicleType)))
def test_client_lists_the_whole_table(firmware, vehicle_type) -> None:
    setup = ParameterNetwork(firmware, vehicle_type)
    setup.run(setup.client.download(setup.network.now))
    assert setup.client.complete
    listed = setup.client.parameters
    table = setup.parameters.table
    assert set(listed) == {definition.name for definition in table}
    for definition in table:
        found = listed[definition.name]
        assert same(found.value, definition.value)
        assert (found.type, found.index) == (definition.kind, table.index_of(definition.name))


@pytest.mark.parametrize("firmware", Firmware)
def test_server_uses_the_encoding_of_the_firmware(firmware) -> None:
    setup = ParameterNetwork(firmware)
    encoding = Encoding.C_CAST if firmware is Firmware.ARDUPILOT else Encoding.BYTEWISE
    assert isinstance(setup.server, ParameterServer)
    assert setup.server.encoding is encoding
    setup.run(setup.client.download(setup.network.now))
    assert ("_HASH_CHECK" in dict(setup.received_values())) is (firmware is Firmware.PX4)


def test_client_write_takes_effect_and_calls_callbacks() -> None:
    setup = ParameterNetwork()
    changes, all_changes = [], []
    setup.parameters.on_change("RTL_ALT", changes.append)
    setup.parameters.on_any_change(lambda name, value: all_changes.append((name, value)))
    for name, value in (("RTL_ALT", 3000), ("RTL_ALT", 3000), ("WPNAV_SPEED", 750.0)):
        assert setup.run(setup.client.set(name, value, setup.network.now)).value == value
    assert (setup.parameters["RTL_ALT"], setup.parameters["WPNAV_SPEED"]) == (3000, 750.0)
    assert changes == [3000]
    assert all_changes == [("RTL_ALT", 3000), ("WPNAV_SPEED", 750.0)]


def test_vehicle_write_is_broadcast_once() -> None:
    setup = ParameterNetwork()
    changes = []
    setup.parameters.on_change("STAT_BOOTCNT", changes.append)
    setup.parameters.set("STAT_BOOTCNT", 5)
    setup.parameters.set("STAT_BOOTCNT", 5)
    assert setup.received_values() == [("STAT_BOOTCNT", 5.0)]
    assert changes == [5]


def test_callback_may_set_another_parameter() -> None:
    parameters = Parameters(*COPTER)
    parameters.on_change("RTL_ALT", lambda value: parameters.set("RTL_CLIMB_MIN", value // 2))
    parameters.set("RTL_ALT", 3000)
    assert parameters["RTL_CLIMB_MIN"] == 1500


def test_values_survive_a_reboot_and_callbacks_do_not() -> None:
    setup = ParameterNetwork()
    changes = []
    setup.parameters.on_change("RTL_ALT", changes.append)
    setup.parameters.on_any_change(lambda *change: changes.append(change))
    setup.parameters.set("RTL_ALT", 3000)
    before, changes[:] = setup.server, []
    setup.vehicle.restart()
    assert setup.server is not before
    assert setup.run(setup.client.get("RTL_ALT", setup.network.now)).value == 3000
    setup.run(setup.client.set("RTL_ALT", 4000, setup.network.now))
    assert setup.parameters["RTL_ALT"] == 4000
    assert not changes


def test_reset_restores_defaults_but_keeps_counters() -> None:
    setup = ParameterNetwork()
    changes = []
    setup.parameters.set("STAT_BOOTCNT", 9)
    setup.parameters.set("RTL_ALT", 3000)
    setup.run(setup.client.set("WPNAV_SPEED", 750.0, setup.network.now))
    setup.parameters.on_any_change(lambda *change: changes.append(change))
    setup.ground.received.clear()
    setup.parameters.reset()
    assert sorted(changes) == [("RTL_ALT", 1500), ("WPNAV_SPEED", 1000.0)]
    assert sorted(setup.received_values()) == sorted(changes)
    assert setup.parameters["STAT_BOOTCNT"] == 9


@pytest.mark.parametrize(
    ("firmware", "name", "value", "error"),
    [
        ("ardupilot", "SYSID_THISMAV", 0, common.MavParamError.VALUE_OUT_OF_RANGE),
        ("ardupilot", "SYSID_THISMAV", 256, common.MavParamError.VALUE_OUT_OF_RANGE),
        ("ardupilot", "STAT_BOOTCNT", 0, common.MavParamError.READ_ONLY),
        ("ardupilot", "MIS_TOTAL", 5, common.MavParamError.READ_ONLY),
        ("px4", "MAV_SYS_ID", 251, common.MavParamError.VALUE_OUT_OF_RANGE),
        ("px4", "MAV_COMP_ID", 0, common.MavParamError.VALUE_OUT_OF_RANGE),
    ],
)
def test_invalid_write_is_refused(firmware, name, value, error) -> None:
    setup = ParameterNetwork(Firmware(firmware))
    before = setup.parameters[name]
    with pytest.raises(ParameterDenied) as refused:
        setup.run(setup.client.set(name, value, setup.network.now))
    assert refused.value.code == error
    assert setup.parameters[name] == before


def test_px4_hash_excludes_volatile_parameters() -> None:
    parameters = Parameters(Firmware.PX4, VehicleType.COPTER)
    before = parameters.table.hash()
    parameters.set("LND_FLIGHT_T_LO", 123)
    assert parameters.table.hash() == before
    parameters.set("RTL_TYPE", 1)
    assert parameters.table.hash() != before
