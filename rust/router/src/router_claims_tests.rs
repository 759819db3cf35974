use super::tests::{A, B, C, D, Network, STATION, VEHICLE, signing};
use super::*;
use crate::event::Event;
use crate::gateway::Gateway;
use crate::tests::{command, dialect, heartbeat, packet_bytes};
use mavstack_core::claims::Authority;
use mavstack_core::parser::Parser;

/// A router whose endpoint A is a socket with two peers, A and the last port; the vehicle is the first of them.
fn shared_socket() -> (Network, usize) {
    let mut network = Network::new(3);
    network.ports.push(network.router.add_port(A).expect("room"));
    network.route(A, &heartbeat(VEHICLE));
    network.route(C, &heartbeat((255, 190, 0)));
    (network, D)
}

fn attitude(from: (u8, u8, u8)) -> Vec<u8> {
    packet_bytes(2, &[9; 8], from)
}

#[test]
fn a_stranger_that_names_itself_as_the_vehicle_gets_none_of_its_commands() {
    let (mut network, stranger) = shared_socket();
    for number in 0..30 {
        network.time.now += 500_000;
        network.route(A, &attitude((1, 1, number)));
        network.route(B, &attitude((1, 1, 100 + number)));
        network.route(stranger, &command((255, 190), (1, 1, 200 + number)));
        assert_eq!(network.route(C, &command((1, 1), (255, 190, number))), [A]);
        assert_eq!(network.route(C, &command((1, 0), (255, 190, number))), [A]);
    }
    let events = network.router.events.take();
    let is_contested = |event: &&Event| matches!(event, Event::Notice { notice: Notice::Contested, .. });
    assert_eq!(events.iter().filter(is_contested).count(), 1, "one conflict, reported once");
    assert!(network.router.claims().conflict(1, 1).is_some());
}

#[test]
fn commands_whose_signatures_are_removed_do_not_reach_a_stranger_on_the_socket_of_the_vehicle() {
    let (mut network, stranger) = shared_socket();
    network.endpoint(C).gateway = Gateway { incoming: Some(signing(1)), strip: true, ..Gateway::default() };
    for number in 0..30u8 {
        network.route(stranger, &attitude((1, 1, number)));
        network.time.now += 100_000;
        network.route(A, &attitude((1, 1, number)));
        let (mut signed, signing_time) = (Vec::new(), 1_000_000 + u64::from(number));
        let raw = command((1, 1), (255, 190, number));
        Parser::new(false).feed(&dialect(), &raw, |packet| {
            assert!(rewrite(&mut signed, &packet, Some(&mut signing(1)), signing_time));
        });
        assert_eq!(network.route_changed(C, &signed), [(A, raw)]);
    }
}

#[test]
fn another_link_takes_over_when_the_vehicle_is_silent_and_stations_share_their_address() {
    let mut network = Network::new(4);
    network.route(A, &heartbeat(VEHICLE));
    network.route(B, &heartbeat((1, 1, 1)));
    assert_eq!(network.route(C, &command((1, 1), STATION)), [A]);
    network.time.now += 2_600_000;
    network.route(B, &heartbeat((1, 1, 2)));
    assert_eq!(network.route(C, &command((1, 1), STATION)), [A, B], "an outage costs no vehicle its route");
    network.route(A, &heartbeat((1, 1, 3)));
    assert_eq!(network.route(C, &command((1, 1), STATION)), [A]);
    let station = |number| packet_bytes(0, &[0, 0, 0, 0, 6, 8, 0, 0, 3], (255, 190, number));
    network.route(C, &station(1));
    network.route(D, &station(2));
    network.route(D, &station(3));
    assert_eq!(network.route(A, &command((255, 190), VEHICLE)), [C, D]);
}

#[test]
fn a_reboot_that_a_stranger_claims_leads_no_packets_to_it() {
    let mut network = Network::new(3);
    let system_time = |boot_time: u32, number| {
        let mut payload = [0; 12];
        payload[8..].copy_from_slice(&boot_time.to_le_bytes());
        packet_bytes(2, &payload, (1, 1, number))
    };
    network.route(A, &system_time(90_000, 1));
    network.route(B, &system_time(10, 2));
    assert_eq!(network.route(C, &command((1, 1), STATION)), [A]);
    network.route(A, &system_time(10, 3));
    let events = network.router.events.take();
    let rebooted = events.iter().filter(|event| matches!(event, Event::Notice { notice: Notice::Rebooted, .. }));
    assert!(rebooted.eq([&Event::Notice {
        endpoint: 0,
        notice: Notice::Rebooted,
        system: 1,
        component: 1,
        message_id: 2
    }]));
}

#[test]
fn an_endpoint_with_a_proven_peer_holds_its_addresses() {
    let mut network = Network::new(3);
    network.route(A, &heartbeat(VEHICLE));
    network.router.set_authority(B, Authority::Certificate);
    network.route(B, &heartbeat((1, 1, 1)));
    assert!(network.route(A, &heartbeat((1, 1, 2))).is_empty());
    assert_eq!((network.dropped(A, Cause::Spoofed), network.route(C, &command((1, 1), STATION))), (1, vec![B]));
    network.router.set_authority(B, Authority::None);
    assert_eq!(network.route(A, &heartbeat((1, 1, 3))), [B, C]);
}
