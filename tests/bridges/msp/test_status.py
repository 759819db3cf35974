"""The status of a flight controller in HEARTBEAT and SYS_STATUS."""

from __future__ import annotations

from mavstack.bridges.msp.status import ControllerStatus, base_mode, extended_state, sys_status, system_status
from mavstack.bridges.msp.telemetry import Power
from mavstack.dialects import common
from mavstack.msp.messages.arming import SensorFlag

_SENSOR, _FLAG = common.MavSysStatusSensor, common.MavModeFlag
ARMED = ControllerStatus(frozenset({0, 1}))


def test_heartbeat() -> None:
    assert base_mode(ControllerStatus(), 0, 0) == _FLAG.CUSTOM_MODE_ENABLED | _FLAG.MANUAL_INPUT_ENABLED
    assert base_mode(ARMED, 0, 1) & (_FLAG.SAFETY_ARMED | _FLAG.STABILIZE_ENABLED) == 0x90
    assert base_mode(ARMED, common.MavStandardMode.MISSION, 28) & _FLAG.AUTO_ENABLED
    states = common.MavState
    assert system_status(ControllerStatus()) == states.STANDBY
    assert system_status(ARMED) == states.ACTIVE
    assert system_status(ControllerStatus(frozenset({0, 27}))) == states.CRITICAL
    assert system_status(ControllerStatus(reasons=("SENSORS_CALIBRATING",))) == states.CALIBRATING


def test_sensors_and_checks() -> None:
    sensors = int(SensorFlag.GYRO | SensorFlag.ACCELEROMETER)
    status = ControllerStatus(reasons=("ACC_CALIBRATION", "RX_FAILSAFE"), sensors=sensors, load=150)
    message = sys_status(status, Power(16.2, 5.5, 300, 80, 1), ready=False)
    health = message.onboard_control_sensors_health
    assert message.onboard_control_sensors_present & _SENSOR.SENSOR_3D_GYRO
    assert not message.onboard_control_sensors_present & _SENSOR.SENSOR_GPS
    assert health & _SENSOR.SENSOR_3D_GYRO
    for failed in (_SENSOR.SENSOR_3D_ACCEL, _SENSOR.SENSOR_RC_RECEIVER, _SENSOR.PREARM_CHECK):
        assert not health & failed
    assert (message.voltage_battery, message.current_battery, message.load) == (16200, 550, 1000)


def test_unknown_power_and_a_missing_signal_that_channels_end() -> None:
    message = sys_status(ControllerStatus(reasons=("RX_FAILSAFE",)), None, ready=True)
    assert message.onboard_control_sensors_health & _SENSOR.SENSOR_RC_RECEIVER
    assert (message.voltage_battery, message.current_battery, message.battery_remaining) == (0xFFFF, -1, -1)


def test_an_armed_vehicle_has_no_failed_checks() -> None:
    assert ControllerStatus(frozenset({0}), ("ARM_SWITCH",)).failed_checks(by_channels=False) == ()


def test_the_landed_state_of_an_armed_vehicle_is_not_known() -> None:
    states = common.MavLandedState
    assert extended_state(ControllerStatus()).landed_state == states.ON_GROUND
    assert extended_state(ARMED).landed_state == states.UNDEFINED
