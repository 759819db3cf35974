//! The sockets of an intake: read by the thread, or by the program itself.

use crate::intake::Intake;
use crate::pace::{Mode, Pace};
use crate::queue::Urgency;
use mavstack_router::engine::batch::{self, Batches};
use mavstack_router::engine::datagrams::{BATCH, ReceiveBuffer};
use mio::net::UdpSocket;
use std::cell::RefCell;
use std::collections::HashMap;
use std::io;
use std::sync::{Mutex, PoisonError};

thread_local! {
    /// The headers of a system call: each thread that reads needs its own, which cannot be sent to another one.
    static BATCHES: RefCell<Batches> = RefCell::default();
}

/// Batches of one socket in a turn.
const MAX_BATCHES: usize = 16;

/// Which sockets to read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// Those of which the system reported that they have something.
    Ready,
    All,
}

/// The result of a turn.
#[derive(Debug, Default)]
pub struct Turn {
    pub count: usize,
    /// The urgency of everything that waits.
    pub urgency: Urgency,
    /// Something is left in a socket.
    pub is_cut: bool,
    /// Sockets that the program must read itself, because it did not keep up.
    pub overloaded: Vec<u32>,
}

struct Input {
    udp: UdpSocket,
    is_v6: bool,
    is_ready: bool,
}

pub struct Sockets {
    inputs: HashMap<u32, Input>,
    buffer: ReceiveBuffer,
    pub pace: Pace,
    pub read_at: f64,
}

impl Sockets {
    #[must_use]
    pub fn new(now: f64) -> Self {
        let (inputs, buffer) = (HashMap::new(), ReceiveBuffer::default());
        Self { inputs, buffer, pace: Pace::new(now), read_at: now }
    }

    pub fn add(&mut self, number: u32, udp: UdpSocket) {
        let is_v6 = udp.local_addr().is_ok_and(|address| address.is_ipv6());
        self.pace.limit_collected(batch::receive_buffer(&udp).unwrap_or_default());
        self.inputs.insert(number, Input { udp, is_v6, is_ready: true });
    }

    #[must_use]
    pub fn remove(&mut self, number: u32) -> Option<UdpSocket> {
        self.inputs.remove(&number).map(|removed| removed.udp)
    }

    /// Notes that the system reported that a socket has something.
    pub fn note_ready(&mut self, number: u32) {
        if let Some(input) = self.inputs.get_mut(&number) {
            input.is_ready = true;
        }
    }

    /// Has all sockets looked at, because another one read them.
    pub fn suspect_all(&mut self) {
        self.inputs.values_mut().for_each(|input| input.is_ready = true);
    }

    #[must_use]
    pub fn has_ready(&self) -> bool {
        self.inputs.values().any(|input| input.is_ready)
    }

    /// Reads the sockets until they are empty, for a limited time each.
    pub fn read(&mut self, scope: Scope, intake: &Mutex<Intake>, now: f64) -> Turn {
        let mut turn = Turn::default();
        for (&number, input) in &mut self.inputs {
            if input.is_ready || scope == Scope::All {
                let mut reading = Reading { buffer: &mut self.buffer, intake, now };
                reading.read(number, input, &mut turn);
            }
        }
        self.read_at = now;
        let mut intake = intake.lock().unwrap_or_else(PoisonError::into_inner);
        let fresh = intake.queue.take_fresh();
        turn.urgency = intake.queue.urgency;
        if turn.count > 0 {
            self.pace.note(turn.count, fresh, now);
        }
        if turn.is_cut && self.pace.mode() == Mode::Direct {
            self.pace.press(now);
        }
        turn
    }
}

/// The reading of one socket.
struct Reading<'a> {
    buffer: &'a mut ReceiveBuffer,
    intake: &'a Mutex<Intake>,
    now: f64,
}

impl Reading<'_> {
    fn read(&mut self, number: u32, input: &mut Input, turn: &mut Turn) {
        for _ in 0..MAX_BATCHES {
            let received =
                BATCHES.with_borrow_mut(|batches| batches.receive(&input.udp, input.is_v6, BATCH, self.buffer));
            match received {
                Ok(()) => {}
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {
                    input.is_ready = false;
                    return;
                }
                // An unreachable peer may become reachable.
                Err(_) => continue,
            }
            let count = self.buffer.received.len();
            // The system reports a datagram that comes after the last one of an incomplete batch.
            input.is_ready = count == BATCH;
            turn.count += count;
            if !self.deliver(number) {
                turn.overloaded.push(number);
                return;
            }
            if count < BATCH {
                return;
            }
        }
        turn.is_cut = true;
    }

    /// Passes the datagrams that were read to the intake; returns whether the program keeps up.
    fn deliver(&self, number: u32) -> bool {
        let mut intake = self.intake.lock().unwrap_or_else(PoisonError::into_inner);
        for index in 0..self.buffer.received.len() {
            let (data, address) = self.buffer.datagram(index);
            intake.receive(number, address, data, self.now);
        }
        !intake.queue.is_full()
    }
}
