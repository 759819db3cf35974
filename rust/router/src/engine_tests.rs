use super::*;
use crate::tests::{command, dialect, heartbeat, packet_bytes};
use std::io::{Read, Write};
use std::net::SocketAddr;
use std::time::Duration;

const TIMEOUT: Duration = Duration::from_secs(10);

fn engine() -> Engine {
    Engine::start(Arc::new(dialect()), 0).expect("a thread")
}

/// Starts an endpoint that was added.
fn started(engine: &Engine, endpoint: EndpointNumber) -> EndpointNumber {
    engine.start_endpoint(endpoint);
    endpoint
}

fn add_queue(engine: &Engine, capacity: usize) -> EndpointNumber {
    started(engine, engine.add_queue(capacity))
}

fn add_udp(engine: &Engine, socket: UdpSocket, options: UdpOptions) -> EndpointNumber {
    started(engine, engine.add_udp(socket, options).expect("added"))
}

fn socket() -> UdpSocket {
    let socket = UdpSocket::bind("127.0.0.1:0").expect("a port");
    socket.set_read_timeout(Some(TIMEOUT)).expect("a timeout");
    socket
}

fn address(socket: &UdpSocket) -> SocketAddr {
    socket.local_addr().expect("bound")
}

fn listening(max_peers: usize) -> UdpOptions {
    UdpOptions { peer: None, idle: 60_000_000, max_peers, trusts_senders: true }
}

fn receive(socket: &UdpSocket) -> Vec<u8> {
    let mut buffer = [0; 2048];
    let length = socket.recv(&mut buffer).expect("a datagram");
    buffer[..length].to_vec()
}

/// Waits for a condition on the statistics.
fn wait_for(engine: &Engine, is_met: impl Fn(&Snapshot) -> bool) -> Snapshot {
    for _ in 0..10_000 {
        let snapshot = engine.statistics().expect("open");
        if is_met(&snapshot) {
            return snapshot;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    panic!("{:?}", engine.statistics());
}

#[test]
fn peers_of_a_socket_and_a_fixed_peer_reach_each_other() {
    let engine = engine();
    let (listener, vehicle, first, second) = (socket(), socket(), socket(), socket());
    let at = address(&listener);
    let out = socket();
    let out_address = address(&out);
    add_udp(&engine, listener, listening(8));
    add_udp(&engine, out, UdpOptions { peer: Some(address(&vehicle)), ..listening(1) });
    let hello = heartbeat((1, 1, 0));
    let (one, two) = (heartbeat((254, 190, 0)), heartbeat((255, 190, 0)));
    first.send_to(&one, at).expect("sent");
    assert_eq!(receive(&vehicle), one);
    second.send_to(&two, at).expect("sent");
    assert_eq!((receive(&vehicle), receive(&first)), (two.clone(), two));
    vehicle.send_to(&hello, out_address).expect("sent");
    assert_eq!((receive(&first), receive(&second)), (hello.clone(), hello));
    let answer = command((255, 190), (1, 1, 1));
    vehicle.send_to(&answer, out_address).expect("sent");
    assert_eq!(receive(&second), answer);
    let snapshot = engine.statistics().expect("open");
    assert_eq!(snapshot.routes.len(), 3);
    assert_eq!((snapshot.endpoints[0].peers.len(), snapshot.endpoints[0].counters.received), (2, 2));
    assert_eq!(snapshot.endpoints[1].counters.sent, 2);
}

#[test]
fn peers_are_bounded_and_need_a_valid_packet() {
    let engine = engine();
    let (listener, senders) = (socket(), [socket(), socket(), socket()]);
    let at = address(&listener);
    let number = add_udp(&engine, listener, listening(2));
    senders[0].send_to(b"no packet", at).expect("sent");
    for (system, sender) in (1..).zip(&senders) {
        sender.send_to(&heartbeat((system, 1, 0)), at).expect("sent");
    }
    let count = |snapshot: &Snapshot, cause| snapshot.endpoints[0].counters.dropped(cause);
    let snapshot = wait_for(&engine, |snapshot| count(snapshot, crate::counters::Cause::TooManyPeers) == 1);
    assert_eq!(count(&snapshot, crate::counters::Cause::OtherPeer), 1);
    assert_eq!(snapshot.endpoints[0].peers.len(), 2);
    let none = PeerRange { network: "192.0.2.0".parse().expect("valid"), prefix: 24, ports: 0..=u16::MAX };
    engine.set_allowed_peers(number, Some(vec![none]));
    wait_for(&engine, |snapshot| snapshot.endpoints[0].peers.is_empty());
}

#[cfg(unix)]
#[test]
fn streams_are_framed_and_their_end_is_reported() {
    use std::os::unix::net::UnixStream;
    let engine = engine();
    let pair = |framing| {
        let (ours, theirs) = UnixStream::pair().expect("a pair");
        theirs.set_read_timeout(Some(TIMEOUT)).expect("a timeout");
        (started(&engine, engine.add_stream(RawStream::new(ours.into()).expect("a stream"), framing, 1 << 16)), theirs)
    };
    let ((plain, mut plain_end), (_, mut framed_end)) = (pair(Framing::None), pair(Framing::Length));
    let packet = heartbeat((1, 1, 0));
    plain_end.write_all(&packet).expect("written");
    let mut framed = vec![0; packet.len() + 4];
    framed_end.read_exact(&mut framed).expect("a frame");
    assert_eq!((&framed[..4], &framed[4..]), (&(packet.len() as u32).to_be_bytes()[..], &packet[..]));
    let two = [heartbeat((2, 1, 0)), heartbeat((2, 1, 1))].concat();
    framed_end.write_all(&[&(two.len() as u32).to_be_bytes()[..], &two].concat()).expect("written");
    let mut received = vec![0; two.len()];
    plain_end.read_exact(&mut received).expect("two packets");
    assert_eq!(received, two);
    drop(plain_end);
    wait_for(&engine, |snapshot| snapshot.endpoints.len() == 1);
    let is_end = |event| matches!(event, Event::Closed { endpoint, .. } if endpoint == plain);
    assert!(engine.events().into_iter().any(is_end));
}

#[cfg(unix)]
#[test]
fn a_slow_stream_loses_its_own_packets_only() {
    use std::os::unix::net::UnixStream;
    let engine = engine();
    let (ours, mut slow) = UnixStream::pair().expect("a pair");
    started(&engine, engine.add_stream(RawStream::new(ours.into()).expect("a stream"), Framing::None, 1 << 14));
    let (source, sink) = (add_queue(&engine, 1), add_queue(&engine, 100_000));
    let packets: Vec<_> = (0..40_000u32).map(|number| heartbeat((1, 1, number as u8))).collect();
    for chunk in packets.chunks(1000) {
        assert_eq!(engine.push(source, &chunk.concat()), Some(true));
    }
    let snapshot = wait_for(&engine, |snapshot| snapshot.endpoints[1].counters.received == 40_000);
    let (slow_counters, fast_counters) = (&snapshot.endpoints[0].counters, &snapshot.endpoints[2].counters);
    let lost = slow_counters.dropped(crate::counters::Cause::FullQueue);
    assert!(lost > 0 && slow_counters.sent + lost == 40_000);
    assert_eq!((fast_counters.sent, engine.pull(sink).map(|pulled| pulled.len())), (40_000, Some(40_000)));
    slow.set_nonblocking(true).expect("set");
    let mut received = Vec::new();
    wait_for(&engine, |_| {
        let _ = (&slow).read_to_end(&mut Vec::new());
        true
    });
    let _ = slow.read_to_end(&mut received);
}

#[test]
fn queues_carry_bytes_of_the_program_and_events_wake_it() {
    let engine = engine();
    let (left, right) = (add_queue(&engine, 10), add_queue(&engine, 10));
    let packet = heartbeat((1, 1, 0));
    assert_eq!((engine.push(left, &packet[..5]), engine.push(left, &packet[5..])), (Some(true), Some(true)));
    wait_for(&engine, |snapshot| snapshot.endpoints[1].queued == 1);
    assert_eq!(engine.events(), [Event::Readable { endpoint: right }]);
    assert_eq!(engine.pull(right), Some(VecDeque::from([packet.clone()])));
    engine.remove(right);
    wait_for(&engine, |snapshot| snapshot.endpoints.len() == 1);
    assert!(engine.pull(right).is_none() && engine.push(right, &packet).is_none());
    engine.close();
    engine.close();
    assert_eq!(engine.statistics().map(|_| ()), Err(Closed));
}

#[test]
fn nothing_passes_an_endpoint_before_it_is_started() {
    let engine = engine();
    let (left, right) = (engine.add_queue(10), add_queue(&engine, 10));
    let packet = heartbeat((1, 1, 0));
    assert_eq!(engine.push(left, &packet), Some(true));
    assert_eq!(engine.push(right, &heartbeat((2, 1, 0))), Some(true));
    wait_for(&engine, |snapshot| snapshot.endpoints[1].counters.received == 1);
    let drop = RuleSet { default_incoming: Action::Drop, ..RuleSet::default() };
    engine.set_rules(left, drop);
    engine.start_endpoint(left);
    engine.start_endpoint(left);
    let snapshot = wait_for(&engine, |snapshot| snapshot.endpoints[0].counters.received == 1);
    assert_eq!(snapshot.endpoints[0].counters.dropped(crate::counters::Cause::RuleIn), 1);
    assert_eq!((engine.pull(left), engine.pull(right)), (Some(VecDeque::new()), Some(VecDeque::new())));
}

#[test]
fn bytes_pushed_just_before_the_removal_are_routed_and_a_full_inbox_refuses() {
    let engine = engine();
    let (left, right) = (add_queue(&engine, 10), add_queue(&engine, 10));
    let packet = heartbeat((1, 1, 0));
    assert_eq!(engine.push(left, &packet), Some(true));
    engine.remove(left);
    wait_for(&engine, |snapshot| snapshot.endpoints.len() == 1);
    assert_eq!(engine.pull(right), Some(VecDeque::from([packet])));
    let waiting = engine.add_queue(10);
    let chunk = vec![0; 1 << 20];
    let taken = (0..10).filter(|_| engine.push(waiting, &chunk) == Some(true)).count();
    assert_eq!(taken, 4);
}

#[test]
fn few_peers_of_one_datagram_hear_what_is_for_all() {
    let engine = engine();
    let (listener, source) = (socket(), add_queue(&engine, 10));
    let at = address(&listener);
    let number = add_udp(&engine, listener, listening(64));
    let senders: Vec<_> = (0..12).map(|_| socket()).collect();
    let of_listener = |snapshot: &Snapshot| {
        snapshot.endpoints.iter().find(|each| each.number == number).map(|each| each.counters.clone()).expect("open")
    };
    for (count, sender) in (1..).zip(&senders) {
        sender.send_to(&packet_bytes(2, &[1; 12], (count, 1, 0)), at).expect("sent");
        wait_for(&engine, |snapshot| of_listener(snapshot).received == u64::from(count));
    }
    let before = of_listener(&engine.statistics().expect("open")).sent;
    assert_eq!(engine.push(source, &heartbeat((200, 1, 0))), Some(true));
    let all = wait_for(&engine, |snapshot| of_listener(snapshot).sent > before);
    assert_eq!(of_listener(&all).sent - before, udp::MAX_UNCONFIRMED as u64);
    let last = &senders[11];
    last.send_to(&heartbeat((12, 1, 1)), at).expect("sent");
    wait_for(&engine, |snapshot| of_listener(snapshot).received == 13);
    let next = heartbeat((200, 1, 1));
    assert_eq!(engine.push(source, &next), Some(true));
    assert_eq!(receive(last), next, "its second datagram confirmed it");
}

#[test]
fn datagrams_that_are_sent_together_arrive_unchanged() {
    let (near, far) = (engine(), engine());
    let listener = socket();
    let peer = Some(address(&listener));
    let (source, sink) = (add_queue(&near, 10), add_queue(&far, 1000));
    add_udp(&far, listener, listening(8));
    add_udp(&near, socket(), UdpOptions { peer, ..listening(1) });
    let packets: Vec<_> = (0..150).map(|number| heartbeat((1, 1, number))).collect();
    assert_eq!(near.push(source, &packets.concat()), Some(true));
    wait_for(&far, |snapshot| snapshot.endpoints[0].queued == 150);
    assert_eq!(far.pull(sink), Some(VecDeque::from(packets)));
}
