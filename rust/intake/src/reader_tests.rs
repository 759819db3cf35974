//! The thread over real sockets.

use super::{address, heartbeat, intake, taken};
use crate::queue::MAX_WAITING;
use crate::reader::Reader;
use std::net::UdpSocket;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Waits for a condition, which is met in milliseconds on an idle machine.
fn wait_for(mut is_met: impl FnMut() -> bool) {
    let end = Instant::now() + Duration::from_secs(20);
    while !is_met() {
        assert!(Instant::now() < end, "the condition is not met");
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn a_thread_reads_sockets_and_gives_one_back_that_the_program_cannot_follow() {
    let shared = Arc::new(Mutex::new(intake()));
    let mut reader = Reader::start(Arc::clone(&shared), 100.0).expect("a thread");
    let socket = UdpSocket::bind(address(0)).expect("a socket");
    let target = socket.local_addr().expect("an address");
    reader.add(5, socket.try_clone().expect("a copy")).expect("nonblocking");
    let sender = UdpSocket::bind(address(0)).expect("a socket");
    sender.send_to(&heartbeat(), target).expect("sent");
    wait_for(|| taken(&mut shared.lock().expect("no panic")) == (0, 0, 1));
    let mut is_given_back = false;
    wait_for(|| {
        for _ in 0..MAX_WAITING / 64 {
            let _ = sender.send_to(&heartbeat(), target);
        }
        let intake = shared.lock().expect("no panic");
        is_given_back = intake.queue.is_full();
        is_given_back
    });
    wait_for(|| shared.lock().expect("no panic").queue.take().overloaded == [5]);
    reader.remove(5);
    reader.close();
    reader.close();
}

#[test]
fn the_program_reads_while_it_waits_for_an_answer() {
    let shared = Arc::new(Mutex::new(intake()));
    let reader = Reader::start(Arc::clone(&shared), 100.0).expect("a thread");
    let socket = UdpSocket::bind(address(0)).expect("a socket");
    let target = socket.local_addr().expect("an address");
    reader.add(5, socket.try_clone().expect("a copy")).expect("nonblocking");
    let sender = UdpSocket::bind(address(0)).expect("a socket");
    assert!(!reader.begin_to_take());
    assert!(reader.hurry(60.0));
    for _ in 0..100 {
        sender.send_to(&heartbeat(), target).expect("sent");
        assert!(reader.begin_to_take());
        assert_eq!(taken(&mut shared.lock().expect("no panic")), (0, 0, 1), "it comes with the call");
    }
}
