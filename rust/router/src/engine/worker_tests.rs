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
        let worker = Worker::new(poll, Arc::new(shared), Arc::new(dialect()), 0, Box::new(time));
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
        self.worker.snapshot().endpoints.iter().map(|endpoint| endpoint.counters.received).sum()
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
    let options = UdpOptions { peer: None, idle: 1 << 40, max_peers: 8 };
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
    let options = UdpOptions { peer: None, idle: 1 << 40, max_peers: 8 };
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
    let counters = &engine.worker.snapshot().endpoints[0].counters;
    assert_eq!((counters.sent + counters.dropped(Cause::FullQueue), turns), (10_000, 3));
}
