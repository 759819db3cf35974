use super::*;
use crate::addressing::COMMAND_IDS;
use crate::event::Event;
use crate::gateway::Gateway;
use crate::rules::{Action, Rule};
use crate::tests::{command, dialect, heartbeat, packet_bytes};
use mavstack_core::parser::Parser;
use mavstack_core::signing::{Key, Policy, Signing};
use proptest::prelude::*;

/// A router with ports A, B, C … of an endpoint each, and what it sent.
pub(super) struct Network {
    pub(super) router: Router,
    pub(super) ports: Vec<PortId>,
    sent: Vec<(PortId, Vec<u8>)>,
    pub(super) time: Time,
}

pub(super) const A: usize = 0;
pub(super) const B: usize = 1;
pub(super) const C: usize = 2;
pub(super) const D: usize = 3;
pub(super) const VEHICLE: (u8, u8, u8) = (1, 1, 0);
pub(super) const STATION: (u8, u8, u8) = (255, 190, 0);

impl Sink for Vec<(PortId, Vec<u8>)> {
    fn send(&mut self, port: PortId, packet: &[u8], _: Origin) -> Result<(), Unsent> {
        self.push((port, packet.to_vec()));
        Ok(())
    }
}

impl Network {
    pub(super) fn new(ports: usize) -> Self {
        let mut router = Router::new(Arc::new(dialect()), 0);
        let ports = (0..ports as u32).map(|number| {
            let endpoint = router.add_endpoint(number);
            router.add_port(endpoint).expect("room")
        });
        let ports = ports.collect();
        Self { router, ports, sent: Vec::new(), time: Time { now: 1, signing: 1_000_000 } }
    }

    pub(super) fn endpoint(&mut self, index: usize) -> &mut Endpoint {
        self.router.endpoint_mut(index).expect("an endpoint")
    }

    /// Routes bytes from a port; returns the ports that got them, unchanged.
    pub(super) fn route(&mut self, from: usize, raw: &[u8]) -> Vec<usize> {
        let sent = self.route_changed(from, raw);
        assert!(sent.iter().all(|(_, bytes)| bytes == raw), "changed");
        sent.into_iter().map(|(port, _)| port).collect()
    }

    pub(super) fn route_changed(&mut self, from: usize, raw: &[u8]) -> Vec<(usize, Vec<u8>)> {
        self.time.now += 10;
        let dialect = Arc::clone(self.router.dialect());
        Parser::new(false)
            .feed(&dialect, raw, |packet| self.router.route(self.ports[from], &packet, self.time, &mut self.sent));
        self.take_sent()
    }

    pub(super) fn take_sent(&mut self) -> Vec<(usize, Vec<u8>)> {
        let index = |port| self.ports.iter().position(|&known| known == port).expect("a port");
        let mut sent: Vec<_> = self.sent.drain(..).map(|(port, bytes)| (index(port), bytes)).collect();
        sent.sort();
        sent
    }

    pub(super) fn dropped(&self, endpoint: usize, cause: Cause) -> u64 {
        self.router.endpoint(endpoint).map_or(0, |endpoint| endpoint.counters.dropped(cause))
    }
}

#[test]
fn broadcasts_go_to_all_others_and_addressed_packets_to_their_target() {
    let mut network = Network::new(4);
    assert_eq!(network.route(A, &heartbeat(VEHICLE)), [B, C, D]);
    assert_eq!(network.route(B, &heartbeat(STATION)), [A, C, D]);
    assert_eq!(network.route(B, &command((1, 1), STATION)), [A]);
    assert_eq!(network.route(B, &command((1, 0), STATION)), [A]);
    assert_eq!(network.route(B, &command((1, 99), STATION)), [A], "an unknown component of a known system");
    assert_eq!(network.route(B, &command((0, 0), STATION)), [A, C, D]);
    assert_eq!(network.route(B, &command((9, 1), STATION)), [] as [usize; 0]);
    assert_eq!(network.dropped(B, Cause::NoRoute), 1);
    assert_eq!(network.route(A, &command((1, 1), (1, 100, 0))), [] as [usize; 0], "never back");
}

#[test]
fn packets_of_one_link_stay_there() {
    let mut network = Network::new(2);
    assert!(network.route(A, &packet_bytes(109, &[1; 9], (51, 68, 0))).is_empty());
    assert!(network.route(A, &packet_bytes(256, &[0; 42], STATION)).is_empty());
    assert_eq!((network.dropped(A, Cause::LinkStatus), network.dropped(A, Cause::SigningKey)), (1, 1));
    assert!(network.router.claims().addresses().is_empty(), "a radio is no address");
    assert_eq!(network.endpoint(A).radio_status, [1; 9]);
}

#[test]
fn links_of_a_group_deliver_once_and_get_nothing_from_each_other() {
    let mut network = Network::new(4);
    network.endpoint(A).group = Some("radio".into());
    network.endpoint(B).group = Some("radio".into());
    let raw = heartbeat(VEHICLE);
    assert_eq!(network.route(A, &raw), [C, D]);
    assert!(network.route(B, &raw).is_empty());
    assert_eq!(network.dropped(B, Cause::Duplicate), 1);
    assert_eq!(network.route(C, &command((1, 1), STATION)), [A, B], "both are redundant links to the vehicle");
    network.time.now += COPY_WINDOW + 100;
    assert_eq!(network.route(B, &raw), [C, D], "equal bytes later are another packet");
}

#[test]
fn a_packet_that_comes_back_is_dropped_and_teaches_nothing() {
    let mut network = Network::new(3);
    let raw = heartbeat(VEHICLE);
    network.route(A, &raw);
    assert!(network.route(B, &raw).is_empty());
    assert_eq!(network.dropped(B, Cause::Loop), 1);
    assert!(matches!(network.router.events.take()[0], Event::Notice { endpoint: 1, notice: Notice::Loop, .. }));
    assert_eq!(network.route(C, &command((1, 1), STATION)), [A]);
    assert_eq!(network.route(A, &raw), [B, C], "equal packets of one port are no copies");
}

#[test]
fn a_duplicate_window_covers_all_endpoints() {
    let mut network = Network::new(3);
    network.router.duplicate_window = 1000;
    network.route(C, &heartbeat((2, 1, 0)));
    let raw = command((2, 1), STATION);
    assert_eq!(network.route(A, &raw), [C]);
    assert!(network.route(B, &raw).is_empty(), "it was not sent to B, so it is a copy");
    assert_eq!(network.dropped(B, Cause::Duplicate), 1);
    network.time.now += 2000;
    assert_eq!(network.route(B, &raw), [C]);
}

#[test]
fn listen_only_and_paused_endpoints() {
    let mut network = Network::new(3);
    network.endpoint(A).listen_only = true;
    assert!(network.route(A, &heartbeat(STATION)).is_empty());
    assert_eq!(network.route(B, &heartbeat(VEHICLE)), [A, C]);
    network.endpoint(C).paused = true;
    assert_eq!(network.route(B, &heartbeat((1, 1, 1))), [A]);
    assert!(network.route(C, &heartbeat((3, 1, 0))).is_empty());
    assert_eq!((network.dropped(A, Cause::ListenOnly), network.dropped(C, Cause::Paused)), (1, 2));
}

#[test]
fn a_monitor_gets_every_accepted_packet_and_is_no_route() {
    let mut network = Network::new(4);
    network.router.set_monitor(D, true);
    assert_eq!(network.route(A, &heartbeat(VEHICLE)), [B, C, D]);
    assert_eq!(network.route(B, &command((1, 1), STATION)), [A, D]);
    assert_eq!(network.route(B, &command((9, 1), STATION)), [D], "no route");
    let own = command((1, 1), (1, 100, 0));
    assert_eq!(network.route(A, &own), [D], "for its own link");
    assert!(network.route(D, &heartbeat((7, 1, 0))).is_empty());
    assert_eq!(network.route(A, &command((7, 1), VEHICLE)), [D], "it teaches nothing");
    assert_eq!(network.dropped(D, Cause::ListenOnly), 1);
    let dialect = Arc::clone(network.router.dialect());
    let rule = Rule { action: Action::Drop, messages: vec![76], ..Rule::default() };
    network.endpoint(D).outgoing = Rules::new(vec![rule], Action::Pass, &dialect);
    assert!(network.route(A, &command((9, 1), VEHICLE)).is_empty(), "its outgoing rules apply");
    network.router.set_monitor(D, false);
    assert_eq!(network.route(D, &heartbeat((7, 1, 1))), [A, B, C]);
    assert_eq!(network.route(A, &heartbeat((1, 1, 5))), [B, C, D]);
}

#[test]
fn a_monitor_gets_each_packet_once_and_changes_no_decision() {
    let mut network = Network::new(4);
    network.router.set_monitor(C, true);
    let raw = heartbeat(VEHICLE);
    assert_eq!(network.route(A, &raw), [B, C, D]);
    assert!(network.route(B, &raw).is_empty() && network.route(C, &raw).is_empty());
    assert_eq!((network.dropped(B, Cause::Loop), network.dropped(C, Cause::ListenOnly)), (1, 1));
    let addressed = command((1, 1), STATION);
    assert_eq!(network.route(D, &addressed), [A, C]);
    assert_eq!(network.route(B, &addressed), [A, C], "a copy on a path that is no loop, as without the monitor");
    assert!(network.route(A, &addressed).is_empty());
    assert_eq!(network.dropped(A, Cause::Loop), 1);
    network.router.remove_port(network.ports[C]);
    assert_eq!(network.route(A, &heartbeat((1, 1, 9))), [B, D]);
}

#[test]
fn a_port_that_does_not_hear_gets_packets_with_its_target_alone() {
    let mut network = Network::new(3);
    network.router.set_hearing(network.ports[B], false);
    network.route(B, &heartbeat(STATION));
    assert_eq!(network.route(A, &heartbeat(VEHICLE)), [C]);
    assert_eq!(network.route(A, &command((255, 190), VEHICLE)), [B]);
    network.router.set_hearing(network.ports[B], true);
    assert_eq!(network.route(A, &heartbeat((1, 1, 1))), [B, C]);
}

#[test]
fn rules_apply_in_both_directions() {
    let mut network = Network::new(3);
    let dialect = Arc::clone(network.router.dialect());
    let rules = |rule| Rules::new(vec![rule], Action::Pass, &dialect);
    network.endpoint(A).incoming =
        rules(Rule { action: Action::Drop, commands: vec![22], name: "no takeoff".into(), ..Rule::default() });
    network.endpoint(C).outgoing = rules(Rule { action: Action::Drop, messages: vec![0], ..Rule::default() });
    assert_eq!(network.route(B, &heartbeat(VEHICLE)), [A]);
    assert!(network.route(A, &command((1, 1), STATION)).is_empty());
    assert_eq!((network.dropped(A, Cause::RuleIn), network.dropped(C, Cause::RuleOut)), (1, 1));
    let notices = network.router.events.take();
    let is_rule = |event: &Event| matches!(event, Event::Notice { notice: Notice::Rule { name, .. }, .. } if name == "no takeoff");
    assert!(notices.iter().any(is_rule));
}

#[test]
fn inspected_packets_wait_for_a_decision() {
    let mut network = Network::new(3);
    let dialect = Arc::clone(network.router.dialect());
    let inspect = || vec![Rule { action: Action::Inspect, messages: COMMAND_IDS.to_vec(), ..Rule::default() }];
    network.endpoint(A).incoming = Rules::new(inspect(), Action::Pass, &dialect);
    network.endpoint(B).outgoing = Rules::new(inspect(), Action::Pass, &dialect);
    network.route(B, &heartbeat(VEHICLE));
    let raw = command((1, 1), STATION);
    let token = |network: &mut Network| match network.router.events.take().pop_back() {
        Some(Event::Inspect { token, outgoing, packet, .. }) => (token, outgoing, packet),
        other => panic!("{other:?}"),
    };
    assert!(network.route(A, &raw).is_empty());
    let (first, outgoing, packet) = token(&mut network);
    assert!(!outgoing && packet == raw);
    network.router.decide(first, true, network.time, &mut network.sent);
    let (second, outgoing, _) = token(&mut network);
    assert!(outgoing && network.sent.is_empty());
    network.router.decide(second, true, network.time, &mut network.sent);
    assert_eq!(network.take_sent(), [(B, raw.clone())]);
    network.time.now += 2 * COPY_WINDOW;
    network.route(A, &raw);
    let (third, ..) = token(&mut network);
    network.router.decide(third, false, network.time, &mut network.sent);
    network.router.decide(third, true, network.time, &mut network.sent);
    assert!(network.take_sent().is_empty());
    assert_eq!(network.dropped(A, Cause::Inspected), 1);
}

#[test]
fn a_decision_that_comes_too_late_or_while_paused_passes_nothing() {
    let mut network = Network::new(2);
    let dialect = Arc::clone(network.router.dialect());
    let inspect = Rule { action: Action::Inspect, messages: COMMAND_IDS.to_vec(), ..Rule::default() };
    network.endpoint(A).incoming = Rules::new(vec![inspect], Action::Pass, &dialect);
    network.route(B, &heartbeat(VEHICLE));
    let mut decide_after = |wait: u64, paused: bool, number: u8| {
        assert!(network.route(A, &command((1, 1), (255, 190, number))).is_empty());
        let Some(Event::Inspect { token, .. }) = network.router.events.take().pop_back() else { panic!("no event") };
        network.time.now += wait;
        network.endpoint(A).paused = paused;
        network.router.decide(token, true, network.time, &mut network.sent);
        network.endpoint(A).paused = false;
        network.take_sent().len()
    };
    assert_eq!((decide_after(5_000_000, false, 1), decide_after(0, true, 2)), (1, 0));
    assert_eq!(decide_after(5_000_001, false, 3), 0);
    assert_eq!((network.dropped(A, Cause::Paused), network.dropped(A, Cause::NotInspected)), (1, 1));
}

#[test]
fn a_byte_rate_keeps_a_reserve_for_addressed_packets() {
    let mut network = Network::new(2);
    network.endpoint(B).limit(Some(1000.0));
    network.route(B, &heartbeat(VEHICLE));
    let telemetry = |number| packet_bytes(2, &[9; 12], (7, 1, number));
    let passed = (0..100).filter(|&number| !network.route(A, &telemetry(number)).is_empty()).count();
    assert!((30..50).contains(&passed), "{passed}");
    assert_eq!(network.route(A, &command((1, 1), STATION)), [B]);
    assert_eq!(network.dropped(B, Cause::Rate), 100 - passed as u64);
}

pub(super) fn signing(key: u8) -> Signing {
    Signing::new(Key::new([key; 32]), 1, 0, Policy::default())
}

#[test]
fn a_gateway_verifies_strips_and_signs() {
    let mut network = Network::new(4);
    network.endpoint(A).gateway = Gateway { incoming: Some(signing(1)), strip: true, ..Gateway::default() };
    network.endpoint(C).gateway = Gateway { outgoing: Some(signing(2)), ..Gateway::default() };
    let plain = heartbeat(VEHICLE);
    assert!(network.route(A, &plain).is_empty());
    assert_eq!(network.dropped(A, Cause::Unsigned), 1);
    let mut signed = Vec::new();
    let parsed = |raw: &[u8], use_packet: &mut dyn FnMut(&Packet<'_>)| {
        Parser::new(false).feed(&dialect(), raw, |packet| use_packet(&packet));
    };
    parsed(&plain, &mut |packet| assert!(rewrite(&mut signed, packet, Some(&mut signing(1)), 1_000_000)));
    let sent = network.route_changed(A, &signed);
    assert_eq!(sent[0], (B, plain.clone()), "stripped");
    assert_eq!(sent[1].0, C);
    parsed(&sent[1].1, &mut |packet| assert_eq!(signing(2).check(packet, Some(1_000_000)), Ok(())));
    assert!(network.route(A, &signed).is_empty(), "replayed");
    assert_eq!(network.dropped(A, Cause::Replayed), 1);
    assert!(network.route(D, &heartbeat((1, 1, 7))).is_empty(), "not signed, from a verified address");
    assert_eq!(network.dropped(D, Cause::Spoofed), 1);
    assert_eq!(network.route_changed(D, &command((1, 1), STATION)).len(), 1);
    let mut later = Vec::new();
    parsed(&heartbeat((1, 1, 8)), &mut |packet| {
        assert!(rewrite(&mut later, packet, Some(&mut signing(1)), 1_000_100));
    });
    assert!(network.route(D, &later).is_empty(), "a copy that overtakes the packet");
    assert_eq!(network.route_changed(A, &later).len(), 3, "does not hide it");
    assert_eq!((network.dropped(D, Cause::Spoofed), network.dropped(A, Cause::Loop)), (2, 0));
}

#[test]
fn ports_that_are_used_again_are_other_ports() {
    let mut network = Network::new(3);
    let raw = heartbeat(VEHICLE);
    network.route(A, &raw);
    network.router.remove_port(network.ports[A]);
    network.ports[A] = network.router.add_port(A).expect("room");
    assert_eq!(network.ports[A], A);
    assert!(network.route(C, &command((1, 1), STATION)).is_empty(), "its routes were forgotten");
    assert_eq!(network.route(B, &raw), [A, C]);
}

/// A step of a random network: the port, the source, the target or none.
fn step() -> impl Strategy<Value = (usize, (u8, u8), Option<(u8, u8)>)> {
    (0usize..4, (0u8..3, 0u8..3), prop::option::of((0u8..3, 0u8..3)))
}

proptest! {
    /// The guide's rules, written as a list of what each port heard first.
    #[test]
    fn packets_go_where_the_guide_sends_them(steps in prop::collection::vec(step(), 1..60)) {
        let mut network = Network::new(4);
        let mut heard: Vec<Vec<(u8, u8)>> = vec![Vec::new(); 4];
        for (number, (from, source, target)) in steps.into_iter().enumerate() {
            let ids = (source.0, source.1, number as u8);
            let raw = target.map_or_else(|| heartbeat(ids), |target| command(target, ids));
            let sent = network.route(from, &raw);
            if source.0 != 0 && heard.iter().all(|known| !known.contains(&source)) {
                heard[from].push(source);
            }
            let (system, component) = target.unwrap_or((0, 0));
            let exact = component != 0 && heard.iter().any(|known| known.contains(&(system, component)));
            let leads = |known: &Vec<(u8, u8)>| match (system, exact) {
                (0, _) => true,
                (_, true) => known.contains(&(system, component)),
                (_, false) => known.iter().any(|(other, _)| *other == system),
            };
            let expected: Vec<_> = (0..4).filter(|&port| port != from && leads(&heard[port])).collect();
            prop_assert_eq!(sent, expected);
        }
    }
}
