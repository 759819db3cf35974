"""Motors, their telemetry and settings, servos and the mixer."""

from __future__ import annotations

from mavstack.msp.commands import MspCommand
from mavstack.msp.messages.codecs import ByVariant, Number
from mavstack.msp.messages.fields import Record, i8, i16, items_of, of, record, u8, u16, u32
from mavstack.msp.messages.layout import BETAFLIGHT_ONLY, INAV_ONLY, TableMessage, reply, request

_PULSES = Number("u16")
_MIX_RATE = ByVariant(Number("i8"), Number("i16"))


@reply(MspCommand.MSP_MOTOR)
class Motor(TableMessage):
    """Pulse widths of eight motors in microseconds; 0 for a motor that the vehicle does not have."""

    motors: tuple[int, ...] = items_of(_PULSES, unit="us")


@request(MspCommand.MSP_SET_MOTOR)
class SetMotor(TableMessage):
    """Turn motors of a disarmed vehicle, each by a pulse width in microseconds; take the propellers off."""

    motors: tuple[int, ...] = items_of(_PULSES, unit="us")


@record
class MotorTelemetryItem(Record):
    """Telemetry of one ESC; `invalid` is the share of broken telemetry packets."""

    rpm: int = u32(unit="1/min")
    invalid: float = u16(100, "%")
    temperature: int = u8(unit="degC")
    voltage: float = u16(100, "V")
    current: float = u16(100, "A")
    consumed_charge: int = u16(unit="mAh")


@reply(MspCommand.MSP_MOTOR_TELEMETRY, BETAFLIGHT_ONLY, since="1.42")
class MotorTelemetry(TableMessage):
    """Telemetry of the ESCs."""

    motors: tuple[MotorTelemetryItem, ...] = items_of(MotorTelemetryItem, counted=True)


@record
class EscSensorItem(Record):
    """Temperature and rotational speed of one ESC."""

    temperature: int = u8(unit="degC")
    rpm: int = u16(unit="1/min")


@reply(MspCommand.MSP_ESC_SENSOR_DATA, BETAFLIGHT_ONLY)
class EscSensorData(TableMessage):
    """Temperatures and rotational speeds of the ESCs; newer versions also have MSP_MOTOR_TELEMETRY."""

    motors: tuple[EscSensorItem, ...] = items_of(EscSensorItem, counted=True)


@reply(MspCommand.MSP_MOTOR_CONFIG, BETAFLIGHT_ONLY)
class MotorConfig(TableMessage):
    """Range of the pulses for the motors, and their telemetry."""

    min_throttle: int = u16(unit="us")
    max_throttle: int = u16(unit="us")
    min_command: int = u16(unit="us")
    motor_count: int | None = u8(since="1.42", default=None)
    pole_count: int | None = u8(since="1.42", default=None)
    use_dshot_telemetry: bool | None = u8(kind=bool, since="1.42", default=None)
    use_esc_sensor: bool | None = u8(kind=bool, since="1.42", default=None)


@request(MspCommand.MSP_SET_MOTOR_CONFIG, BETAFLIGHT_ONLY)
class SetMotorConfig(TableMessage):
    """Set the range of the pulses for the motors, and their telemetry."""

    min_throttle: int = u16(unit="us")
    max_throttle: int = u16(unit="us")
    min_command: int = u16(unit="us")
    pole_count: int | None = u8(since="1.42", default=None)
    use_dshot_telemetry: bool | None = u8(kind=bool, since="1.42", default=None)


@reply(MspCommand.MSP_MOTOR_3D_CONFIG)
class Motor3dConfig(TableMessage):
    """Pulses of motors that turn in both directions."""

    deadband_low: int = u16(unit="us")
    deadband_high: int = u16(unit="us")
    neutral: int = u16(unit="us")


@request(MspCommand.MSP_SET_MOTOR_3D_CONFIG)
class SetMotor3dConfig(Motor3dConfig):
    """Set the pulses of motors that turn in both directions."""


@reply(MspCommand.MSP2_MOTOR_OUTPUT_REORDERING, BETAFLIGHT_ONLY, since="1.43")
class MotorOutputReordering(TableMessage):
    """Which output each motor has."""

    outputs: tuple[int, ...] = items_of(Number("u8"), counted=True)


@request(MspCommand.MSP2_SET_MOTOR_OUTPUT_REORDERING, BETAFLIGHT_ONLY, since="1.43")
class SetMotorOutputReordering(MotorOutputReordering):
    """Set which output each motor has."""


@reply(MspCommand.MSP_SERVO)
class Servo(TableMessage):
    """Pulse widths of the servos in microseconds."""

    servos: tuple[int, ...] = items_of(_PULSES, unit="us")


@record
class ServoSettings(Record):
    """Range of one servo; `forward_channel` is 255 where it follows no channel."""

    minimum: int = u16(unit="us")
    maximum: int = u16(unit="us")
    middle: int = u16(unit="us")
    rate: int = i8(unit="%")
    reserved: int | None = u16(variant="INAV", default=0)
    forward_channel: int = u8(default=255)
    reversed_sources: int = u32(default=0)


@reply(MspCommand.MSP_SERVO_CONFIGURATIONS)
class ServoConfigurations(TableMessage):
    """Ranges of all servos."""

    servos: tuple[ServoSettings, ...] = items_of(ServoSettings)


@request(MspCommand.MSP_SET_SERVO_CONFIGURATION)
class SetServoConfiguration(TableMessage):
    """Set the range of one servo; `forward_channel` is 255 where it follows no channel."""

    index: int = u8()
    minimum: int = u16(unit="us")
    maximum: int = u16(unit="us")
    middle: int = u16(unit="us")
    rate: int = i8(unit="%")
    reserved: int | None = u16(variant="INAV", default=0)
    forward_channel: int = u8(default=255)
    reversed_sources: int = u32(default=0)


@record
class ServoMixRule(Record):
    """Share that an input has in the position of a servo."""

    target: int = u8()
    source: int = u8()
    rate: int = of(_MIX_RATE, "%")
    speed: int = u8()
    minimum: int = i8(unit="%")
    maximum: int = i8(unit="%")
    box: int = u8()


@reply(MspCommand.MSP_SERVO_MIX_RULES)
class ServoMixRules(TableMessage):
    """Rules by which the inputs move the servos."""

    rules: tuple[ServoMixRule, ...] = items_of(ServoMixRule)


@request(MspCommand.MSP_SET_SERVO_MIX_RULE)
class SetServoMixRule(TableMessage):
    """Set one of the rules by which the inputs move the servos."""

    index: int = u8()
    target: int = u8()
    source: int = u8()
    rate: int = of(_MIX_RATE, "%")
    speed: int = u8()
    minimum: int = i8(unit="%")
    maximum: int = i8(unit="%")
    box: int = u8()


@reply(MspCommand.MSP_MIXER_CONFIG)
class MixerConfig(TableMessage):
    """Kind of the frame, by the numbers of Betaflight (3 is a quadcopter X), and direction of its motors."""

    mixer: int = u8()
    yaw_motors_reversed: bool | None = u8(kind=bool, variant="BTFL", default=None)


@request(MspCommand.MSP_SET_MIXER_CONFIG)
class SetMixerConfig(MixerConfig):
    """Set the kind of the frame and the direction of its motors."""


@reply(MspCommand.MSP2_INAV_MIXER, INAV_ONLY)
class InavMixer(TableMessage):
    """Kind of the vehicle of iNav: 0 multirotor, 1 airplane, 2 helicopter, 3 tricopter, 4 rover, 5 boat."""

    motor_direction_inverted: bool = u8(kind=bool)
    reserved: int = u8()
    motor_stop_on_low: bool = u8(kind=bool)
    platform_type: int = u8()
    has_flaps: bool = u8(kind=bool)
    preset: int = i16()
    max_motors: int = u8()
    max_servos: int = u8()


@request(MspCommand.MSP2_INAV_SET_MIXER, INAV_ONLY)
class SetInavMixer(InavMixer):
    """Set the kind of the vehicle of iNav; the last two fields are ignored."""
