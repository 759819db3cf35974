//! A day of traffic in virtual time.

use super::*;
use crate::ports::MAX_PORTS;
use crate::rules::{Action, Rule};
use crate::tests::packet_bytes;
use mavstack_core::claims::MAX_ADDRESSES;

const SECOND: u64 = 1_000_000;
const DAY: u64 = 86_400;
const HOUR: u64 = 3600;
const MAX_PEERS: usize = 8;
/// Commands of every tenth second are never decided about; the others pass.
const UNDECIDED: u64 = 10;

/// A vehicle on two redundant links, ground stations on a UDP socket, a stream that is seldom read, and a monitor.
struct Day {
    engine: Engine,
    links: [(EndpointNumber, Arc<Queue>); 2],
    ground: EndpointNumber,
    monitor: Arc<Queue>,
    stations: Vec<UdpSocket>,
    slow: UnixStream,
    /// Packets of the vehicle, commands of the first station, and those that arrived at the vehicle.
    sent: u64,
    commands: u64,
    arrived: u64,
    monitored: u64,
    rebooted: u64,
}

impl Day {
    fn new() -> Self {
        let mut engine = Engine::new();
        let links = [engine.add_queue(), engine.add_queue()];
        for (number, _) in &links {
            engine.worker.execute(Command::SetGroup(*number, Some("radio".into())));
        }
        let listener = UdpSocket::bind("127.0.0.1:0").expect("a port");
        let address = listener.local_addr().expect("an address");
        listener.set_nonblocking(true).expect("an option");
        let options = UdpOptions { peer: None, idle: 60 * SECOND, max_peers: MAX_PEERS, trusts_senders: false };
        let listener = mio::net::UdpSocket::from_std(listener);
        let ground = engine.add(|number| Command::AddUdp(number, listener, options));
        let inspect = Rule { action: Action::Inspect, messages: vec![76], name: "commands".into(), ..Rule::default() };
        let limit = Rule { messages: vec![0], rate: Some(0.5), name: "heartbeats".into(), ..Rule::default() };
        let rules = RuleSet { incoming: vec![inspect], outgoing: vec![limit], ..RuleSet::default() };
        engine.worker.execute(Command::SetRules(ground, Box::new(rules)));
        let (ours, slow) = UnixStream::pair().expect("a pair");
        slow.set_nonblocking(true).expect("an option");
        let stream = RawStream::new(ours.into()).expect("a stream");
        engine.add(|number| Command::AddStream(number, stream, Framing::Length, 1 << 16));
        let (number, monitor) = engine.add_queue();
        engine.worker.execute(Command::SetMonitor(number, true));
        let stations = (0..2 * MAX_PEERS).map(|_| {
            let station = UdpSocket::bind("127.0.0.1:0").expect("a port");
            station.set_nonblocking(true).expect("an option");
            station.connect(address).expect("connected");
            station
        });
        let stations = stations.collect();
        let (sent, commands, arrived, monitored, rebooted) = (0, 0, 0, 0, 0);
        Self { engine, links, ground, monitor, stations, slow, sent, commands, arrived, monitored, rebooted }
    }

    fn second(&mut self, second: u64) {
        self.engine.clock.store((second + 1) * SECOND, Ordering::Relaxed);
        for packet in vehicle_packets(second) {
            for link in self.links.clone() {
                self.engine.push(&link, &packet);
            }
            self.sent += 1;
        }
        self.send_of_stations(second);
        if second % HOUR == 1 {
            self.send_of_unknown_components(second);
        }
        self.engine.turn();
        self.engine.turn();
        self.take(second);
    }

    /// One station is always there; the others each for some minutes, more of them than there may be.
    fn send_of_stations(&mut self, second: u64) {
        let sequence = second as u8;
        self.stations[0].send(&heartbeat((255, 190, sequence))).expect("sent");
        self.stations[0].send(&command((1, 1), (255, 190, sequence))).expect("sent");
        self.commands += 1;
        let visitor = 1 + (second / 600) as usize % (self.stations.len() - 1);
        for station in [visitor, 1 + visitor % (self.stations.len() - 1)] {
            // A port whose peer was removed may refuse.
            let _ = self.stations[station].send(&heartbeat((200, station as u8, sequence)));
        }
    }

    /// Packets of more addresses than the table holds.
    fn send_of_unknown_components(&mut self, second: u64) {
        let link = self.links[0].clone();
        for number in 0..MAX_ADDRESSES as u32 + 500 {
            let (system, component) = (10 + (number >> 8) as u8, number as u8);
            self.engine.push(&link, &packet_bytes(2, &[0; 12], (system, component, second as u8)));
        }
        for _ in 0..8 {
            self.engine.turn();
            self.monitored += self.monitor.pull().len() as u64;
        }
    }

    fn take(&mut self, second: u64) {
        for event in self.engine.worker.shared.take_events() {
            match event {
                Event::Inspect { token, .. } if !second.is_multiple_of(UNDECIDED) => {
                    self.engine.worker.execute(Command::Decide(token, true));
                }
                Event::Notice { notice: crate::event::Notice::Rebooted, .. } => self.rebooted += 1,
                _ => {}
            }
        }
        let commands = |queue: &Queue| queue.pull().iter().filter(|packet| packet[7] == 76).count() as u64;
        self.arrived += self.links.iter().map(|(_, queue)| commands(queue)).sum::<u64>();
        self.monitored += self.monitor.pull().len() as u64;
        let mut buffer = vec![0; 1 << 16];
        for station in &self.stations {
            while station.recv(&mut buffer).is_ok() {}
        }
        if second.is_multiple_of(900) {
            while std::io::Read::read(&mut self.slow, &mut buffer).is_ok() {}
        }
    }

    /// Everything has its bound.
    fn check(&self) {
        let snapshot = self.engine.worker.snapshot(0);
        let peers = snapshot.endpoints.iter().map(|endpoint| endpoint.peers.len()).max().expect("endpoints");
        assert!((1..=MAX_PEERS).contains(&peers), "{peers} peers");
        assert!(snapshot.routes.len() <= MAX_ADDRESSES);
        assert!(self.engine.worker.parsers.len() < 64 && MAX_PORTS > 64, "ports are used again");
        assert!(snapshot.endpoints.iter().all(|endpoint| endpoint.queued < 1 << 16));
        assert_eq!(snapshot.dropped_events, 0);
    }
}

fn vehicle_packets(second: u64) -> [Vec<u8>; 4] {
    let boot_time = (second % (6 * HOUR)) as u32 * 1000;
    let mut clock = [0; 12];
    clock[8..].copy_from_slice(&boot_time.to_le_bytes());
    clock[..8].copy_from_slice(&second.to_le_bytes());
    let sequence = |number: u64| (second * 4 + number) as u8;
    [
        packet_bytes(2, &clock, (1, 1, sequence(0))),
        heartbeat((1, 1, sequence(1))),
        heartbeat((1, 100, sequence(2))),
        packet_bytes(109, &[second as u8; 9], (51, 68, sequence(3))),
    ]
}

fn run(seconds: u64) {
    let mut day = Day::new();
    for second in 0..seconds {
        day.second(second);
        if second % 600 == 599 {
            day.check();
        }
    }
    let snapshot = day.engine.worker.snapshot(0);
    let counters = |number: EndpointNumber| {
        &snapshot.endpoints.iter().find(|endpoint| endpoint.number == number).expect("open").counters
    };
    let [first, second] = [counters(day.links[0].0), counters(day.links[1].0)];
    let unknown = (seconds.div_ceil(HOUR)) * (MAX_ADDRESSES as u64 + 500);
    assert_eq!((first.received, second.received), (day.sent + unknown, day.sent));
    assert_eq!(second.dropped(Cause::Duplicate), day.sent / 4 * 3, "all but RADIO_STATUS");
    assert_eq!(second.dropped(Cause::LinkStatus), day.sent / 4);
    let ground = counters(day.ground);
    let undecided = seconds.div_ceil(UNDECIDED);
    assert_eq!((day.commands, day.arrived), (seconds, 2 * (seconds - undecided)), "over both links");
    assert!((undecided - 1..=undecided).contains(&ground.dropped(Cause::NotInspected)));
    assert_eq!(day.rebooted, (seconds - 1) / (6 * HOUR));
    assert!(ground.dropped(Cause::RuleOut) > seconds, "half of the heartbeats of both components, and more");
    assert!(day.monitored > 3 * seconds);
}

#[test]
fn an_hour_of_traffic_leaves_everything_in_its_bounds() {
    run(HOUR + 60);
}

#[test]
#[ignore = "takes seconds: the nightly tests run it"]
fn a_day_of_traffic_leaves_everything_in_its_bounds() {
    run(DAY);
}
