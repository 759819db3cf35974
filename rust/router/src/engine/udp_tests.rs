use super::*;

#[test]
fn a_peer_is_kept_for_as_long_as_it_was_heard() {
    let socket = UdpSocket::bind(([127, 0, 0, 1], 0).into()).expect("a port");
    let mut link = UdpLink::new(socket, options(8)).expect("a link");
    let address = |port| SocketAddr::from(([127, 0, 0, 1], port));
    for port in 1..=4u16 {
        link.add_peer(address(port), usize::from(port), 0);
        assert_eq!(link.accept(&address(port), false, 0), Accepted::New);
    }
    let (twice, long, longer) = (address(2), address(3), address(4));
    assert_eq!(link.sender(twice, 1), Sender::Port(2));
    assert_eq!(link.sender(long, 30_000_000), Sender::Port(3));
    assert_eq!(link.sender(longer, 900_000_000), Sender::Port(4));
    let mut expired = |now| {
        let addresses = link.expired(now);
        assert!(addresses.iter().all(|address| link.remove_peer(address).is_some()));
        addresses
    };
    assert_eq!((expired(MIN_IDLE - 1), expired(MIN_IDLE)), (vec![], vec![address(1)]));
    assert_eq!((expired(MIN_IDLE + 1), expired(59_999_999)), (vec![twice], vec![]));
    assert_eq!((expired(60_000_000), expired(959_999_999)), (vec![long], vec![]));
    assert_eq!(expired(960_000_000), [longer]);
}

fn options(max_peers: usize) -> UdpOptions {
    UdpOptions { peer: None, idle: 60_000_000, max_peers, trusts_senders: false }
}

#[test]
fn a_verified_sender_replaces_any_that_is_not() {
    let socket = UdpSocket::bind(([127, 0, 0, 1], 0).into()).expect("a port");
    let mut link = UdpLink::new(socket, options(8)).expect("a link");
    let address = |port| SocketAddr::from(([127, 0, 0, 1], port));
    let add = |link: &mut UdpLink, port: u16, is_verified| {
        link.add_peer(address(port), usize::from(port), 0);
        link.sender(address(port), 1);
        link.accept(&address(port), is_verified, 1)
    };
    assert!((1..=8).all(|port| add(&mut link, port, false) == Accepted::New));
    assert_eq!(add(&mut link, 9, false), Accepted::NoRoom);
    let Accepted::InPlaceOf(replaced) = add(&mut link, 10, true) else { panic!("no room") };
    assert!(link.remove_peer(&replaced).is_some_and(|peer| !peer.is_verified));
    assert_eq!(link.accept(&address(10), true, 1), Accepted::Known);
    (100..400).for_each(|port| assert_eq!(add(&mut link, port, false), Accepted::NoRoom));
    assert!(link.peers[&address(10)].is_accepted && link.make_room_to_wait().is_some());
    assert!(!link.expired(MAX_WAITING_TIME).contains(&address(10)));
}

#[test]
fn one_address_leaves_half_of_the_places_to_others() {
    let socket = UdpSocket::bind(([127, 0, 0, 1], 0).into()).expect("a port");
    let options = UdpOptions { peer: None, idle: 60_000_000, max_peers: 4, trusts_senders: true };
    let mut link = UdpLink::new(socket, options).expect("a link");
    let mut add = |host, port: u16, is_verified| {
        let address = SocketAddr::from(([10, 0, 0, host], port));
        link.add_peer(address, usize::from(port), 0);
        link.sender(address, u64::from(port));
        link.accept(&address, is_verified, 10)
    };
    assert_eq!(add(1, 1, true), Accepted::New);
    assert!((2..=4).all(|port| add(1, port, false) == Accepted::New));
    assert_eq!(add(1, 5, false), Accepted::NoRoom, "another port of the same address");
    let second = SocketAddr::from(([10, 0, 0, 1], 2));
    assert_eq!(add(2, 6, false), Accepted::InPlaceOf(second), "not the verified one");
}

#[test]
fn a_packet_that_comes_alone_passes_the_queue_if_that_is_empty() {
    let client = std::net::UdpSocket::bind("127.0.0.1:0").expect("a port");
    client.set_nonblocking(true).expect("an option");
    let address = client.local_addr().ok();
    let mut link =
        UdpLink::new(UdpSocket::bind(([127, 0, 0, 1], 0).into()).expect("a port"), options(8)).expect("a link");
    let origin = Origin { endpoint: 0, is_urgent: false };
    let received = || {
        let mut buffer = [0; 64];
        std::iter::from_fn(|| client.recv(&mut buffer).ok().map(|length| buffer[..length].to_vec())).collect::<Vec<_>>()
    };
    assert_eq!((link.send_alone(b"one", address, origin), received()), (Ok(false), vec![b"one".to_vec()]));
    link.send(b"two", address, origin).expect("room");
    assert_eq!((link.send_alone(b"three", address, origin), received()), (Ok(true), vec![]));
    assert!(!link.flush());
    assert_eq!(received(), [b"two".to_vec(), b"three".to_vec()]);
    let oversized = vec![0; 70_000];
    assert_eq!((link.send_alone(&oversized, address, origin), link.refused, link.queue.len()), (Ok(true), 1, 0));
    link.is_blocked = true;
    assert_eq!((link.send_alone(b"four", address, origin), link.queue.len()), (Ok(true), 1));
}
