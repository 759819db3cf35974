"""Download of all parameters: pitfalls, and durations on various links."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import ParameterDenied, ParameterTimeout, RemoteCancelled
from mavstack.links import Impairment
from mavstack.services import Address, Progress
from mavstack.services.parameters import Encoding, ParameterClient, Snapshot
from mavstack.services.parameters.value import NO_INDEX
from tests.services.network import GROUND, START, VEHICLE, HalfDuplexRadio, Network
from tests.services.parameters.harness import ParameterHarness, table_of, values_of

PX4_COUNT = 955


def requests_of(harness: ParameterHarness, name: str = "PARAM_REQUEST_READ") -> list:
    return [packet.message for packet in harness.vehicle.received if packet.name == name]


class ScriptedVehicle:
    """The vehicle of a client, played by the test: it records requests and sends values."""

    def __init__(self, encoding: Encoding = Encoding.BYTEWISE) -> None:
        self.network = Network(keep_packets=True)
        self.ground = self.network.node(GROUND)
        self.vehicle = self.network.node(VEHICLE)
        self.network.connect(self.ground, self.vehicle)
        self.client = self.ground.engine.add(ParameterClient(GROUND, VEHICLE, encoding))

    def send_value(self, name: str, value: float, index: int, count: int) -> None:
        message = common.ParamValue(
            param_id=name,
            param_value=value,
            param_type=common.MavParamType.REAL32,
            param_index=index,
            param_count=count,
        )
        self.send(message)

    def send(self, message) -> None:
        self.vehicle.engine.send(message, self.network.now)

    def run(self, seconds: float) -> list:
        """Advance the time; return the messages that the vehicle received."""
        self.ground.engine.touch(self.client)
        del self.vehicle.received[:]
        self.network.run(timeout=seconds)
        return [packet.message for packet in self.vehicle.received]


def indexes(messages) -> set[int]:
    return {message.param_index for message in messages if isinstance(message, common.ParamRequestRead)}


@pytest.mark.parametrize("encoding", Encoding)
def test_all_parameters_come(encoding) -> None:
    harness = ParameterHarness(200, encoding=encoding)
    listing = harness.client.download(harness.network.now)
    harness.run(listing)
    assert values_of(listing.result()) == table_of(harness.server)
    assert list(listing.result()) == list(table_of(harness.server))
    assert harness.client.complete
    assert requests_of(harness) == []


def test_an_unsolicited_value_does_not_mask_a_missing_index() -> None:
    vehicle = ScriptedVehicle()
    listing = vehicle.client.download(vehicle.network.now)
    vehicle.run(0.1)
    vehicle.send_value("A", 1.0, 0, 3)
    vehicle.send_value("C", 3.0, 2, 3)
    vehicle.run(0.01)
    vehicle.send_value("B", 2.0, NO_INDEX, 3)  # B is known now, but not that it is number 1
    asked = vehicle.run(1.0)
    assert indexes(asked) == {1}
    assert not listing.done
    vehicle.send_value("B", 2.0, 1, 3)
    vehicle.run(0.1)
    assert list(listing.result()) == ["A", "B", "C"]


def test_a_count_that_changes_while_listing_starts_it_again() -> None:
    vehicle = ScriptedVehicle()
    listing = vehicle.client.download(vehicle.network.now)
    vehicle.run(0.1)
    vehicle.send_value("A", 1.0, 0, 2)
    vehicle.run(0.01)
    for index, name in enumerate(["NEW", "A", "B"]):
        vehicle.send_value(name, 5.0, index, 3)
    asked = vehicle.run(0.1)
    assert any(isinstance(message, common.ParamRequestList) for message in asked)
    assert not listing.done
    for index, name in enumerate(["NEW", "A", "B"]):
        vehicle.send_value(name, 5.0, index, 3)
    vehicle.run(0.1)
    assert list(listing.result()) == ["NEW", "A", "B"]


def test_a_count_that_shrinks_is_no_endless_wait() -> None:
    harness = ParameterHarness(30, radio=HalfDuplexRadio(5760.0), bandwidth=5760.0)
    listing = harness.client.download(harness.network.now)
    name = harness.rows[3][0]

    def shrink() -> None:
        harness.server.table.remove(name)
        del harness.rows[3]
        harness.touch()

    harness.network.at(0.05, shrink)
    harness.run(listing)
    assert values_of(listing.result()) == table_of(harness.server)
    assert name not in harness.client.parameters


def test_a_table_that_never_stops_changing_ends_in_a_timeout() -> None:
    vehicle = ScriptedVehicle()
    listing = vehicle.client.download(vehicle.network.now)
    for count in range(3, 40):
        vehicle.run(0.05)
        vehicle.send_value("A", 1.0, 0, count)
        vehicle.send_value("B", 1.0, 1, 2)
    vehicle.run(60.0)
    assert isinstance(listing.error, ParameterTimeout)


def test_one_name_in_two_places_is_not_believed() -> None:
    vehicle = ScriptedVehicle()
    listing = vehicle.client.download(vehicle.network.now)
    vehicle.run(0.1)
    vehicle.send_value("A", 1.0, 0, 2)
    vehicle.send_value("A", 1.0, 1, 2)
    vehicle.run(0.1)
    assert not listing.done
    vehicle.send_value("NEW", 1.0, 0, 2)
    vehicle.send_value("A", 1.0, 1, 2)
    vehicle.run(0.1)
    assert list(listing.result()) == ["NEW", "A"]


def test_a_parameter_that_cannot_be_read_is_reported() -> None:
    vehicle = ScriptedVehicle()
    listing = vehicle.client.download(vehicle.network.now)
    vehicle.run(0.1)
    vehicle.send_value("A", 1.0, 0, 2)
    vehicle.run(0.2)
    error = common.MavParamError.READ_FAIL
    vehicle.send(common.ParamError(target_system=255, target_component=190, param_index=1, error=error))
    vehicle.run(1.5)
    assert isinstance(listing.error, ParameterDenied)
    assert listing.error.code == error


def test_a_timeout_names_the_number_of_received_parameters() -> None:
    vehicle = ScriptedVehicle()
    listing = vehicle.client.download(vehicle.network.now, idle_timeout=5.0)
    asked = vehicle.run(4.0)
    assert len([message for message in asked if isinstance(message, common.ParamRequestList)]) > 1
    vehicle.send_value("A", 1.0, 0, 2)
    vehicle.run(20.0)
    assert isinstance(listing.error, ParameterTimeout)
    assert "1 of 2 entries arrived" in str(listing.error)
    assert vehicle.client.parameters["A"].value == 1.0


def test_gaps_are_not_requested_all_at_once() -> None:
    vehicle = ScriptedVehicle()
    vehicle.client.download(vehicle.network.now)
    vehicle.run(0.1)
    vehicle.send_value("A", 1.0, 0, 500)
    vehicle.send_value("Z", 1.0, 499, 500)
    vehicle.run(0.01)
    vehicle.run(1.0)
    assert len(indexes(vehicle.run(0.05))) <= 20


@pytest.mark.parametrize("count", [32768, 65535])
def test_a_count_that_cannot_be_harms_nothing(count) -> None:
    vehicle = ScriptedVehicle()
    listing = vehicle.client.download(vehicle.network.now, idle_timeout=5.0)
    vehicle.run(0.1)
    for index in (0, count - 2, count - 1):
        vehicle.send_value("A", 1.0, index, count)
    vehicle.run(60.0)
    assert isinstance(listing.error, ParameterTimeout)


def test_a_restarted_vehicle_continues_where_it_was() -> None:
    harness = ParameterHarness(100, impairment=Impairment(bandwidth=5760.0, queue=1 << 16))
    listing = harness.client.download(harness.network.now)
    harness.network.at(0.3, harness.vehicle.restart)
    harness.run(listing)
    assert values_of(listing.result()) == table_of(harness.server)


def test_two_lists_of_one_client_go_one_after_the_other() -> None:
    harness = ParameterHarness(50)
    lists = [harness.client.download(harness.network.now) for _ in range(2)]
    harness.run(*lists)
    assert [len(listing.result()) for listing in lists] == [50, 50]
    assert len(requests_of(harness, "PARAM_REQUEST_LIST")) == 2


def test_progress_is_reported() -> None:
    harness = ParameterHarness(10)
    listing = harness.client.download(harness.network.now)
    harness.run(listing)
    assert [(event.done, event.total) for event in harness.ground.events_of(Progress)][-1] == (10, 10)


# The hash


def test_a_known_hash_saves_the_transfer() -> None:
    first = ParameterHarness(300)
    first.run(first.client.download(first.network.now))
    snapshot = first.client.snapshot()
    assert snapshot is not None
    assert snapshot.hash == first.server.table.hash()
    again = ParameterHarness(300, radio=HalfDuplexRadio(), bandwidth=5760.0)
    listing = again.client.download(again.network.now, known=snapshot)
    assert again.run(listing) < 0.3
    assert values_of(listing.result()) == table_of(again.server)
    again.network.run(timeout=5.0)
    values = [packet for packet in again.ground.received if packet.name == "PARAM_VALUE"]
    assert len(values) < 30  # the list was stopped


def test_a_changed_hash_means_download() -> None:
    first = ParameterHarness(50)
    first.run(first.client.download(first.network.now))
    snapshot = first.client.snapshot()
    again = ParameterHarness(50)
    again.server.set(again.rows[7][0], 1)
    listing = again.client.download(again.network.now, known=snapshot)
    again.run(listing)
    assert values_of(listing.result()) == table_of(again.server)


def test_a_vehicle_without_hash_is_download_without_delay() -> None:
    harness = ParameterHarness(50, hash_check=False)
    listing = harness.client.download(harness.network.now, known=Snapshot((), 5))
    assert harness.run(listing) < 0.2
    assert len(listing.result()) == 50


def test_the_hash_of_older_values_is_not_kept() -> None:
    harness = ParameterHarness(20)
    harness.run(harness.client.download(harness.network.now))
    harness.run(harness.client.set(harness.rows[0][0], 1, harness.network.now))
    snapshot = harness.client.snapshot()
    assert snapshot is not None
    assert snapshot.hash is None


def test_cancelling_stops_the_list() -> None:
    harness = ParameterHarness(300, radio=HalfDuplexRadio(), bandwidth=5760.0)
    listing = harness.client.download(harness.network.now)
    harness.network.run(timeout=0.5)
    harness.ground.engine.touch(harness.client)
    harness.network.run(timeout=0.5)
    harness.client.cancel(listing, harness.network.now)
    harness.ground.engine.touch(harness.client)
    harness.network.run(timeout=0.5)
    assert isinstance(listing.error, RemoteCancelled)
    count_before = len(harness.ground.received)
    harness.network.run(timeout=5.0)
    assert len(harness.ground.received) == count_before


# How long it takes


def seconds_for(**link) -> float:
    harness = ParameterHarness(PX4_COUNT, **link)
    listing = harness.client.download(harness.network.now)
    seconds = harness.run(listing)
    assert values_of(listing.result()) == table_of(harness.server)
    return seconds


def test_a_clean_link_takes_a_moment() -> None:
    assert seconds_for() < 0.5


@pytest.mark.parametrize("seed", range(5))
def test_one_percent_of_loss_costs_little(seed) -> None:
    assert seconds_for(impairment=Impairment(latency=0.02, loss=0.01, seed=seed), seed=seed) < 1.5


@pytest.mark.parametrize("seed", range(10))
def test_ten_percent_of_loss_costs_a_second_or_two(seed) -> None:
    assert seconds_for(impairment=Impairment(latency=0.02, loss=0.1), seed=seed) < 3.5


def test_a_half_duplex_radio_is_used_to_the_full() -> None:
    radio = HalfDuplexRadio(5760.0)
    seconds = seconds_for(radio=radio, bandwidth=5760.0)
    assert seconds < 1.05 * PX4_COUNT * 37 / 5760.0
    assert radio.overflowed == 0


@pytest.mark.parametrize("seed", range(5))
def test_a_half_duplex_radio_that_loses_some(seed) -> None:
    impairment = Impairment(loss=0.05)
    assert (
        seconds_for(radio=HalfDuplexRadio(5760.0), bandwidth=5760.0, impairment=impairment, seed=seed)
        < 1.25 * 6.13
    )


def test_a_vehicle_that_does_not_pace_itself_is_survived() -> None:
    radio = HalfDuplexRadio(5760.0)
    seconds = seconds_for(radio=radio)
    assert radio.overflowed > 500  # the radio's queue dropped most of the list
    assert seconds < 1.6 * PX4_COUNT * 37 / 5760.0


def test_a_radio_that_reports_its_queue_is_used_fully() -> None:
    radio = HalfDuplexRadio(5760.0)
    harness = ParameterHarness(PX4_COUNT, radio=radio)

    def report() -> None:
        for node, direction in ((harness.ground, 0), (harness.vehicle, 1)):
            free = radio.free_percent(direction, harness.network.now)
            node.ports[0].channel.pacer.radio_status(free, harness.network.now)
        harness.network.at(0.5, report)

    report()
    listing = harness.client.download(harness.network.now)
    seconds = harness.run(listing)
    assert values_of(listing.result()) == table_of(harness.server)
    assert seconds < 1.25 * 6.13


def test_two_clients_list_at_once_over_one_radio() -> None:
    from mavstack.services.parameters import ParameterClient

    harness = ParameterHarness(200, radio=HalfDuplexRadio(5760.0), bandwidth=5760.0)
    other = harness.ground.engine.add(ParameterClient(Address(255, 191), VEHICLE))
    lists = [harness.client.download(START), other.download(START)]
    harness.ground.engine.touch(other)
    assert harness.run(*lists) < 1.3 * 2 * 200 * 37 / 5760.0
    assert values_of(lists[0].result()) == values_of(lists[1].result()) == table_of(harness.server)
