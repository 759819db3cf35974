"""Landing on a target that a companion computer sees: ArduPilot's LAND, PX4's Precision Land."""

from __future__ import annotations

from math import hypot, inf, nan

import pytest

from mavstack.dialects import common
from mavstack.rotation import from_euler, rotate_back
from mavstack.services.external import landing_angles, landing_message
from mavstack.sim.px4.modes import PRECISION_LAND
from tests.sim.harness import RESULT, VehicleHarness, grounded

TARGET = (4.0, -3.0)
#: Reports after which the target is seen.
SEARCHING = 80


class Camera:
    """A camera that sees the target, and reports it in one of the forms of LANDING_TARGET."""

    def __init__(
        self,
        harness: VehicleHarness,
        form: str,
        *,
        lowest: float = 0.0,
        target: tuple[float, float] = TARGET,
    ) -> None:
        self.harness, self.form, self.lowest, self.target = harness, form, lowest, target
        self.blind = False

    def report(self) -> None:
        truth = self.harness.vehicle.body.truth
        if self.blind or -truth.down < self.lowest:
            return
        seen = self.target[0] - truth.north, self.target[1] - truth.east, -truth.down
        body = rotate_back(from_euler(truth.roll, truth.pitch, truth.yaw), seen)
        message = landing_message(body, 0, angles=landing_angles(*body))
        if self.form == "local":
            message = landing_message((*self.target, 0.0), 0, frame=common.MavFrame.LOCAL_NED)
        elif self.form == "angles":
            message = message.replace(position_valid=0)
        elif self.form == "height":
            message = message.replace(position_valid=0, distance=0.0)
        self.harness.send(message)


def flying(firmware: str, **parameters: float) -> VehicleHarness:
    harness = grounded("copter", firmware)
    if firmware == "ardupilot":
        harness.vehicle.parameters.set("PLND_ENABLED", 1)
        parameters = {"PLND_TYPE": 1, **parameters}
    for name, value in parameters.items():
        harness.vehicle.parameters.set(name, value)
    harness.vehicle.reboot()
    return harness.run(12).place_in_air().run(2.5).without_telemetry()


def land(harness: VehicleHarness, camera: Camera) -> float:
    """Land; return the distance from the target."""
    if harness.vehicle.firmware == "ardupilot":
        harness.vehicle.autopilot.enter(harness.mode_number("LAND"), "test")
    else:
        assert harness.command(common.MavCmd.DO_SET_MODE, 1, 4, 9) == RESULT.ACCEPTED
        assert harness.vehicle.autopilot.mode.number == PRECISION_LAND
    harness.run_until(lambda: harness.vehicle.autopilot.landed, timeout=120, each=camera.report)
    truth = harness.vehicle.body.truth
    return hypot(truth.north - TARGET[0], truth.east - TARGET[1])


@pytest.mark.parametrize(
    ("firmware", "form"), [("ardupilot", "body"), ("ardupilot", "angles"), ("px4", "local")]
)
def test_a_copter_lands_on_the_target(firmware, form):
    harness = flying(firmware)
    assert land(harness, Camera(harness, form)) < 0.5
    if firmware == "ardupilot":
        assert "PrecLand: Target Found" in harness.texts
        assert "PrecLand: Init Complete" in harness.texts


@pytest.mark.parametrize(("firmware", "form"), [("ardupilot", "local"), ("px4", "body"), ("px4", "angles")])
def test_other_forms_do_not_count(firmware, form):
    harness = flying(firmware)
    assert land(harness, Camera(harness, form)) > 3.0
    refusals = {
        "ardupilot": "Plnd: Frame not supported",
        "px4": "Landing target: coordinate frame 12 unsupported",
    }
    assert bool(harness.texts.first(refusals[firmware])) == (form != "angles")


@pytest.mark.parametrize("angles", [(inf, 0.0), (0.0, -inf), (nan, 0.0)])
def test_angles_that_are_not_finite_do_not_count(angles):
    harness = flying("ardupilot")
    message = common.LandingTarget(angle_x=angles[0], angle_y=angles[1], distance=10.0)
    harness.run(1, lambda: harness.send(message))
    assert "PrecLand: Target Found" not in harness.texts


def test_a_target_above_the_vehicle_does_not_count():
    harness = flying("ardupilot")
    message = landing_message((1.0, 0.0, -5.0), 0)
    harness.run(1, lambda: harness.send(message))
    assert "PrecLand: Target Found" not in harness.texts


def test_ardupilot_takes_angles_with_the_height_of_a_rangefinder():
    harness = flying("ardupilot")
    assert land(harness, Camera(harness, "height")) < 0.5


@pytest.mark.parametrize(
    ("firmware", "form", "parameters"),
    [
        ("ardupilot", "body", {"PLND_XY_DIST_MAX": 0.0}),
        ("px4", "local", {"PLD_MAX_SRCH": 0}),
    ],
)
def test_limits_of_zero(firmware, form, parameters):
    """ArduPilot then descends at any distance, and PX4 tries once."""
    harness = flying(firmware, **parameters)
    assert land(harness, Camera(harness, form)) < 0.5


def test_ardupilot_uses_a_raw_sensor_at_once():
    harness = flying("ardupilot", PLND_EST_TYPE=0)
    harness.run(0.5, Camera(harness, "body").report)
    assert harness.vehicle.autopilot.landing_aim() is not None
    assert "PrecLand: Init Complete" not in harness.texts


@pytest.mark.parametrize("target", [(0.0, -30.0), (30.0, 0.0)])
def test_px4_descends_above_the_target(target):
    harness = flying("px4")
    camera, begin = Camera(harness, "local", target=target), harness.vehicle.body.truth.down
    harness.command(common.MavCmd.DO_SET_MODE, 1, 4, 9)

    def has_descended() -> bool:
        return harness.vehicle.body.truth.down > begin + 2

    harness.run_until(has_descended, timeout=60, each=camera.report)
    truth = harness.vehicle.body.truth
    assert hypot(truth.north - target[0], truth.east - target[1]) < 0.5


def test_ardupilot_needs_the_parameters():
    harness = flying("ardupilot", PLND_TYPE=0)
    assert land(harness, Camera(harness, "body")) > 3.0
    assert "PLND_TYPE" not in grounded("copter").vehicle.parameters


def test_ardupilot_descends_when_it_is_near():
    harness = flying("ardupilot", PLND_XY_DIST_MAX=1.0)
    camera = Camera(harness, "body")
    harness.run(3, camera.report)
    harness.vehicle.autopilot.enter(harness.mode_number("LAND"), "test")
    before = harness.vehicle.body.truth.down
    harness.run(1, camera.report)
    assert harness.vehicle.body.truth.down == pytest.approx(before, abs=0.5)
    assert land(harness, camera) < 0.5


def test_a_target_that_is_lost_near_the_ground():
    harness = flying("ardupilot")
    assert land(harness, Camera(harness, "body", lowest=3.0)) < 0.7
    harness = flying("px4")
    assert land(harness, Camera(harness, "local", lowest=0.05)) < 0.7


def test_ardupilot_reports_the_loss():
    harness = flying("ardupilot")
    camera = Camera(harness, "body")
    harness.run(1, camera.report).run(1)
    assert "PrecLand: Init Failed" in harness.texts
    harness.run(3, camera.report).run(3)
    assert "PrecLand: Target Lost" in harness.texts


def test_px4_searches_and_then_lands_where_it_is():
    harness = flying("px4", PLD_SRCH_ALT=25.0)
    camera, heights = Camera(harness, "local"), []
    camera.blind = True

    def watch() -> None:
        heights.append(-harness.vehicle.body.truth.down)
        camera.blind = len(heights) < SEARCHING
        camera.report()

    harness.command(common.MavCmd.DO_SET_MODE, 1, 4, 9)
    harness.run_until(lambda: harness.vehicle.autopilot.landed, timeout=150, each=watch)
    truth = harness.vehicle.body.truth
    assert max(heights) > heights[0] + 3
    assert hypot(truth.north - TARGET[0], truth.east - TARGET[1]) < 0.5


def test_px4_lands_where_it_is_without_a_target():
    harness = flying("px4", PLD_SRCH_TOUT=0.0)
    camera = Camera(harness, "local")
    camera.blind = True
    assert land(harness, camera) > 3.0


def test_px4_stops_climbing_a_metre_above_the_height_at_which_it_sees_the_target():
    harness = flying("px4", PLD_SRCH_ALT=40.0)
    camera, heights, begin = Camera(harness, "local"), [], -harness.vehicle.body.truth.down

    def watch() -> None:
        heights.append(-harness.vehicle.body.truth.down)
        camera.blind = max(heights) < begin + 5
        camera.report()

    harness.command(common.MavCmd.DO_SET_MODE, 1, 4, 9)
    harness.run_until(lambda: harness.vehicle.autopilot.landed, timeout=150, each=watch)
    assert begin + 5.5 < max(heights) < begin + 9
    truth = harness.vehicle.body.truth
    assert hypot(truth.north - TARGET[0], truth.east - TARGET[1]) < 0.5


def test_px4_searches_above_home():
    harness = flying("px4", PLD_SRCH_ALT=25.0, PLD_SRCH_TOUT=30.0)
    autopilot, heights = harness.vehicle.autopilot, []
    autopilot.home = autopilot.home._replace(altitude=autopilot.home.altitude + 15)
    harness.command(common.MavCmd.DO_SET_MODE, 1, 4, 9)
    harness.run(20, lambda: heights.append(-harness.vehicle.body.truth.down))
    assert max(heights) == pytest.approx(25 - autopilot.home_position[2], abs=1.0)


@pytest.mark.parametrize(("precision", "sees"), [(0, True), (1, True), (1, False), (2, True)])
def test_px4_lands_precisely_at_the_end_of_its_return(precision, sees):
    heights = {"RTL_RETURN_ALT": 15.0, "RTL_DESCEND_ALT": 10.0, "PLD_SRCH_ALT": 40.0}
    harness = flying("px4", RTL_PLD_MD=precision, **heights)
    camera, highest = Camera(harness, "local"), 0.0

    def watch() -> None:
        nonlocal highest
        highest = max(highest, -harness.vehicle.body.truth.down)
        camera.report()

    camera.blind = not sees
    harness.run(1, camera.report)
    harness.vehicle.autopilot.enter(harness.vehicle.profile.return_to_launch, "test")
    harness.run_until(lambda: harness.vehicle.autopilot.landed, timeout=150, each=watch)
    assert highest < 25.0, "it searches for a target only if the target is required"
    truth = harness.vehicle.body.truth
    away = hypot(truth.north - TARGET[0], truth.east - TARGET[1])
    assert away < 0.5 if precision and sees else away > 3.0


def lose(**parameters: float) -> tuple[VehicleHarness, list[float]]:
    """Land until the target is lost at half the height; return the heights after the loss."""
    harness = flying("ardupilot", RNGFND1_TYPE=1, PLND_ALT_MAX=30.0, **parameters)
    camera, heights, begin = Camera(harness, "body"), [], -harness.vehicle.body.truth.down
    harness.run(3, camera.report)
    harness.vehicle.autopilot.enter(harness.mode_number("LAND"), "test")

    def watch() -> None:
        height = -harness.vehicle.body.truth.down
        camera.blind = camera.blind or height < begin / 2
        if camera.blind:
            heights.append(height)
        camera.report()

    harness.run(60, watch)
    return harness, heights


def test_ardupilot_tries_again_above_the_height_at_which_it_still_used_the_target():
    harness, heights = lose(PLND_TIMEOUT=2.0)
    assert "PrecLand: Retrying" in harness.texts
    assert "PrecLand: Retry Completed" in harness.texts
    assert "PrecLand: Failsafe Measures" in harness.texts
    lowest = heights.index(min(heights[: len(heights) // 3]))
    assert max(heights[lowest:]) > heights[lowest] + 1.0
    assert harness.vehicle.autopilot.landed


@pytest.mark.parametrize(
    ("parameters", "lands"), [({"PLND_STRICT": 0}, True), ({"PLND_STRICT": 2, "PLND_RET_MAX": 0}, False)]
)
def test_the_strictness_of_a_precision_landing(parameters, lands):
    harness, heights = lose(PLND_TIMEOUT=1.0, **parameters)
    assert harness.vehicle.autopilot.landed is lands
    assert "PrecLand: Retrying" not in harness.texts
    assert ("PrecLand: Failsafe Measures" in harness.texts) is not lands
    assert lands or heights[-1] > 1.0


def test_ardupilot_stays_seven_seconds_if_it_never_saw_a_target():
    harness = flying("ardupilot", PLND_ALT_MIN=0.0, PLND_ALT_MAX=0.0)
    harness.vehicle.autopilot.enter(harness.mode_number("LAND"), "test")
    before = harness.vehicle.body.truth.down
    harness.run(6)
    assert harness.vehicle.body.truth.down == pytest.approx(before, abs=0.5)
    harness.run_until(lambda: harness.vehicle.autopilot.landed, timeout=60)
    assert harness.vehicle.autopilot.landed


def test_a_landing_item_of_px4_names_its_precision():
    autopilot = flying("px4").vehicle.autopilot
    assert [each for each in range(4) if autopilot.precise_landing(each)] == [1, 2]
