use super::*;
use crate::engine::queue::Queue;
use crate::engine::stream::{Framing, RawStream};
use crate::engine::udp::UdpOptions;
use crate::tests::{command, dialect, heartbeat};
use std::io::Write;
use std::net::UdpSocket;
use std::os::unix::net::UnixStream;
use std::sync::atomic::{AtomicU64, Ordering};

#[path = "soak_tests.rs"]
mod soak;

/// Packets that a processor forwards in 50 ms, if it forwards half a million per second.
const MAX_PACKETS: u64 = 25_000;

/// An engine without a thread, whose turns and time the test makes.
struct Engine {
    worker: Worker,
    clock: Arc<AtomicU64>,
    events: Events,
    added: EndpointNumber,
}

impl Engine {
    fn new() -> Self {
        let (shared, poll) = Shared::new().expect("an event queue");
        let clock = Arc::new(AtomicU64::new(1));
        let now = Arc::clone(&clock);
        let time = move || Time { now: now.load(Ordering::Relaxed), signing: 0 };
        let worker = Worker::new(poll, Arc::new(shared), Arc::new(dialect()), 0, Clock::Other(Box::new(time)));
        Self { worker, clock, events: Events::with_capacity(MAX_EVENTS), added: 0 }
    }

    fn add(&mut self, add: impl FnOnce(EndpointNumber) -> Command) -> EndpointNumber {
        let number = self.added;
        self.added += 1;
        self.worker.execute(add(number));
        self.worker.execute(Command::Start(number));
        number
    }

    fn add_queue(&mut self) -> (EndpointNumber, Arc<Queue>) {
        let queue = Arc::new(Queue::new(1000));
        (self.add(|number| Command::AddQueue(number, Arc::clone(&queue))), queue)
    }

    fn push(&mut self, (number, queue): &(EndpointNumber, Arc<Queue>), data: &[u8]) {
        queue.push(data).expect("room");
        self.worker.execute(Command::Pushed(*number));
    }

    /// Makes a turn, which does not wait for something to do.
    fn turn(&mut self) {
        self.worker.shared.send(Command::Pause(EndpointNumber::MAX, false));
        assert!(self.worker.turn(&mut self.events));
    }

    fn received(&self) -> u64 {
        self.worker.snapshot(0).endpoints.iter().map(|endpoint| endpoint.counters.received).sum()
    }
}

fn flood(system: u8, packets: u32) -> Vec<u8> {
    (0..packets).flat_map(|number| heartbeat((system, 1, number as u8))).collect()
}

#[test]
fn a_command_passes_in_one_turn_beside_floods_of_all_kinds() {
    let mut engine = Engine::new();
    let (vehicle, station, pushed) = (engine.add_queue(), engine.add_queue(), engine.add_queue());
    engine.push(&vehicle, &heartbeat((1, 1, 0)));
    engine.turn();
    engine.turn();
    // Long datagrams, a stream with all that the system holds, and the most that the program can push.
    let listener = UdpSocket::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("an address");
    listener.set_nonblocking(true).expect("an option");
    let options = UdpOptions { peer: None, idle: 1 << 40, max_peers: 8, trusts_senders: false };
    let listener = mio::net::UdpSocket::from_std(listener);
    engine.add(|number| Command::AddUdp(number, listener, options));
    let sender = UdpSocket::bind("127.0.0.1:0").expect("a port");
    for _ in 0..4 {
        sender.send_to(&flood(7, 2500), address).expect("sent");
    }
    let (ours, mut theirs) = UnixStream::pair().expect("a pair");
    let stream = RawStream::new(ours.into()).expect("a stream");
    engine.add(|number| Command::AddStream(number, stream, Framing::None, 1 << 16));
    theirs.set_nonblocking(true).expect("an option");
    while theirs.write(&flood(8, 1000)).is_ok() {}
    engine.push(&pushed, &flood(9, 190_000));
    let before = engine.received();
    engine.push(&station, &command((1, 1), (255, 190, 0)));
    engine.turn();
    assert!(vehicle.1.pull().contains(&command((1, 1), (255, 190, 0))));
    let in_turn = engine.received() - before;
    assert!((2000..MAX_PACKETS).contains(&in_turn), "{in_turn} packets in one turn");
}

#[test]
fn a_batch_of_long_datagrams_is_followed_by_smaller_ones() {
    let mut engine = Engine::new();
    let listener = UdpSocket::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("an address");
    listener.set_nonblocking(true).expect("an option");
    let options = UdpOptions { peer: None, idle: 1 << 40, max_peers: 8, trusts_senders: false };
    let listener = mio::net::UdpSocket::from_std(listener);
    engine.add(|number| Command::AddUdp(number, listener, options));
    let sender = UdpSocket::bind("127.0.0.1:0").expect("a port");
    let (mut received, mut turns) = (Vec::new(), 0);
    while turns < 4 {
        for _ in 0..6 {
            sender.send_to(&flood(7, 2500), address).expect("sent");
        }
        engine.turn();
        received.push(engine.received());
        turns += 1;
    }
    let in_turns: Vec<_> = received.windows(2).map(|pair| pair[1] - pair[0]).collect();
    assert!(received[0] > 5000 && in_turns.iter().all(|&packets| packets <= 5000), "{in_turns:?}");
}

/// Adds a listening socket; returns its number and address.
fn add_listener(engine: &mut Engine) -> (EndpointNumber, std::net::SocketAddr) {
    let listener = UdpSocket::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("an address");
    listener.set_nonblocking(true).expect("an option");
    let options = UdpOptions { peer: None, idle: 60_000_000, max_peers: 8, trusts_senders: false };
    let listener = mio::net::UdpSocket::from_std(listener);
    (engine.add(|number| Command::AddUdp(number, listener, options)), address)
}

fn stranger() -> UdpSocket {
    let socket = UdpSocket::bind("127.0.0.1:0").expect("a port");
    socket.set_nonblocking(true).expect("an option");
    socket
}

/// Receives what waits at a socket; returns its bytes.
fn received(socket: &UdpSocket) -> usize {
    let mut buffer = [0; 2048];
    std::iter::from_fn(|| socket.recv(&mut buffer).ok()).sum()
}

/// Waits for events, without a command that wakes the thread, for at most a tick.
fn wait(engine: &mut Engine) {
    assert!(engine.worker.turn(&mut engine.events));
}

#[test]
fn datagrams_behind_the_one_that_was_received_alone_are_reported_again() {
    let mut engine = Engine::new();
    let (_, address) = add_listener(&mut engine);
    engine.turn();
    engine.clock.store(10_000_000, Ordering::Relaxed);
    let sender = UdpSocket::bind("127.0.0.1:0").expect("a port");
    for number in 0..3 {
        sender.send_to(&heartbeat((1, 1, number)), address).expect("sent");
    }
    wait(&mut engine);
    wait(&mut engine);
    assert_eq!(engine.received(), 3, "the first alone, and the others together");
    engine.clock.store(20_000_000, Ordering::Relaxed);
    sender.send_to(&heartbeat((1, 1, 3)), address).expect("sent");
    wait(&mut engine);
    assert_eq!(engine.received(), 4);
}

#[test]
fn a_thread_without_packets_wakes_each_second_and_finds_silent_peers() {
    let mut engine = Engine::new();
    let (ground, address) = add_listener(&mut engine);
    let sender = stranger();
    sender.send_to(&heartbeat((1, 1, 0)), address).expect("sent");
    wait(&mut engine);
    wait(&mut engine);
    let peers = |engine: &Engine| engine.worker.snapshot(0).endpoints[ground as usize].peers.len();
    assert_eq!(peers(&engine), 1);
    engine.clock.store(100_000_000, Ordering::Relaxed);
    wait(&mut engine);
    assert_eq!(peers(&engine), 0);
}

#[test]
fn a_sender_whose_packets_are_refused_is_no_peer() {
    let mut engine = Engine::new();
    let vehicle = engine.add_queue();
    let (ground, address) = add_listener(&mut engine);
    let signing = mavstack_core::signing::Signing::new(
        mavstack_core::signing::Key::new([1; 32]),
        1,
        0,
        mavstack_core::signing::Policy::default(),
    );
    let gateway = crate::gateway::Gateway { incoming: Some(signing), ..Default::default() };
    engine.worker.execute(Command::SetGateway(ground, Box::new(gateway)));
    let sender = stranger();
    for number in 0..30u8 {
        sender.send_to(&heartbeat((255, 190, number)), address).expect("sent");
        engine.push(&vehicle, &flood(1, 3));
        engine.turn();
        engine.turn();
        engine.clock.fetch_add(500_000, Ordering::Relaxed);
    }
    let snapshot = engine.worker.snapshot(0);
    let endpoint = &snapshot.endpoints[1];
    assert_eq!((endpoint.peers.len(), endpoint.counters.dropped(Cause::Unsigned), received(&sender)), (0, 30, 0));
    assert!(engine.worker.shared.take_events().iter().all(|event| !matches!(event, Event::PeerOpened { .. })));
}

#[test]
fn a_new_peer_gets_three_times_what_it_sent_until_it_answers() {
    let mut engine = Engine::new();
    let vehicle = engine.add_queue();
    let (_, address) = add_listener(&mut engine);
    let sender = stranger();
    let system_time = |number| crate::tests::packet_bytes(2, &[9; 12], (1, 1, number));
    let mut sent = 0;
    for number in 0..10u8 {
        sent += sender.send_to(&heartbeat((255, 190, number)), address).expect("sent");
        engine.turn();
        engine.push(&vehicle, &[flood(1, 40), system_time(number)].concat());
        engine.turn();
        engine.turn();
        engine.clock.fetch_add(100_000, Ordering::Relaxed);
    }
    let before = received(&sender);
    assert!(before > sent && before <= 3 * sent, "{before} bytes for {sent}");
    sender.send_to(&command((1, 1), (255, 190, 99)), address).expect("sent");
    engine.turn();
    engine.push(&vehicle, &flood(1, 1000));
    engine.turn();
    engine.turn();
    assert!(received(&sender) > 10 * sent, "it answered");
    assert!(engine.worker.snapshot(0).endpoints[1].counters.dropped(Cause::Unanswered) > 300);
}

#[test]
fn a_blocked_peer_gets_and_sends_nothing() {
    let mut engine = Engine::new();
    let vehicle = engine.add_queue();
    let (ground, address) = add_listener(&mut engine);
    let (pilot, other) = (stranger(), stranger());
    let hello = |engine: &mut Engine, number| {
        pilot.send_to(&heartbeat((255, 190, number)), address).expect("sent");
        other.send_to(&heartbeat((254, 190, number)), address).expect("sent");
        engine.turn();
        engine.turn();
        engine.clock.fetch_add(1_000_000, Ordering::Relaxed);
        vehicle.1.pull().len()
    };
    assert_eq!(hello(&mut engine, 1), 2);
    let blocked = [other.local_addr().expect("an address")].into();
    engine.worker.execute(Command::SetBlockedPeers(ground, blocked));
    assert_eq!((hello(&mut engine, 2), hello(&mut engine, 3)), (1, 1));
    assert_eq!(engine.worker.snapshot(0).endpoints[1].peers.len(), 1);
    engine.worker.execute(Command::SetBlockedPeers(ground, std::collections::HashSet::new()));
    assert_eq!(hello(&mut engine, 4), 2);
}

#[test]
fn a_removed_queue_is_routed_to_its_end_in_turns() {
    let mut engine = Engine::new();
    let (left, right) = (engine.add_queue(), engine.add_queue());
    engine.push(&left, &flood(1, 10_000));
    engine.worker.execute(Command::Remove(left.0));
    assert_eq!(engine.worker.links.all.len(), 2);
    let mut turns = 0;
    while engine.worker.links.all.len() == 2 {
        engine.turn();
        right.1.pull();
        turns += 1;
    }
    let counters = &engine.worker.snapshot(0).endpoints[0].counters;
    assert_eq!((counters.sent + counters.dropped(Cause::FullQueue), turns), (10_000, 3));
}

#[test]
fn packets_that_come_alone_are_counted_if_the_system_refuses_them() {
    let mut engine = Engine::new();
    let (_, address) = add_listener(&mut engine);
    let sender = stranger();
    // Sockets may not send to all hosts of a network unless they asked for it.
    let all = std::net::SocketAddr::from(([127, 255, 255, 255], 9));
    let options = UdpOptions { peer: Some(all), idle: 1 << 40, max_peers: 1, trusts_senders: false };
    let out = mio::net::UdpSocket::bind(([127, 0, 0, 1], 0).into()).expect("a port");
    let client = engine.add(|number| Command::AddUdp(number, out, options));
    engine.turn();
    for number in 0..4 {
        engine.clock.fetch_add(1_000_000, Ordering::Relaxed);
        sender.send_to(&heartbeat((1, 1, number)), address).expect("sent");
        engine.turn();
        engine.turn();
    }
    let counters = &engine.worker.snapshot(0).endpoints[client as usize].counters;
    assert_eq!((counters.sent, counters.dropped(Cause::NotSent)), (0, 4));
}
