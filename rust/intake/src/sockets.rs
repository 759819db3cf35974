//! The sockets and streams of an intake: read by the thread, or by the program itself.

use crate::intake::Intake;
use crate::pace::{Mode, Pace};
use crate::queue::Urgency;
use mavstack_router::engine::batch::{self, Batches};
use mavstack_router::engine::datagrams::{BATCH, ReceiveBuffer};
use mavstack_router::engine::stream::RawStream;
use mio::event::Source;
use mio::net::UdpSocket;
use std::cell::RefCell;
use std::collections::HashMap;
use std::io;
use std::sync::{Mutex, MutexGuard, PoisonError};

thread_local! {
    /// The headers of a system call: each thread that reads needs its own, which cannot be sent to another one.
    static BATCHES: RefCell<Batches> = RefCell::default();
}

/// Batches of one socket, and reads of one stream, in a turn.
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
    /// Streams that ended, with the number of the error; 0: without one.
    pub ended: Vec<(u32, i32)>,
}

/// The socket of datagrams, or the stream, that is read.
pub enum Transport {
    Datagrams { udp: UdpSocket, is_v6: bool },
    Stream { stream: RawStream, is_terminal: bool },
}

impl Transport {
    #[must_use]
    pub fn datagrams(udp: UdpSocket) -> Self {
        let is_v6 = udp.local_addr().is_ok_and(|address| address.is_ipv6());
        Self::Datagrams { udp, is_v6 }
    }

    /// Calls `use_source` with the event source.
    pub fn with_source(&mut self, use_source: impl FnOnce(&mut dyn Source) -> io::Result<()>) -> io::Result<()> {
        match self {
            Self::Datagrams { udp, .. } => use_source(udp),
            Self::Stream { stream, .. } => stream.with_source(use_source),
        }
    }

    /// Bytes that the system surely keeps until they are read; `None`: it slows down the sender.
    fn buffer_bytes(&self) -> Option<usize> {
        match self {
            Self::Datagrams { udp, .. } => Some(batch::receive_buffer(udp).unwrap_or_default()),
            Self::Stream { is_terminal, .. } => is_terminal.then_some(0),
        }
    }
}

struct Input {
    transport: Transport,
    is_ready: bool,
    /// It is not read until the program has taken packets.
    is_blocked: bool,
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

    pub fn add(&mut self, number: u32, transport: Transport) {
        if let Some(bytes) = transport.buffer_bytes() {
            self.pace.limit_collected(bytes);
        }
        self.inputs.insert(number, Input { transport, is_ready: true, is_blocked: false });
    }

    #[must_use]
    pub fn remove(&mut self, number: u32) -> Option<Transport> {
        self.inputs.remove(&number).map(|removed| removed.transport)
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
        self.inputs.values().any(|input| input.is_ready && !input.is_blocked)
    }

    /// Reads streams again that were not read because the program did not keep up.
    pub fn unblock(&mut self) {
        self.inputs.values_mut().for_each(|input| input.is_blocked = false);
    }

    /// Reads the sockets until they are empty, for a limited time each.
    pub fn read(&mut self, scope: Scope, intake: &Mutex<Intake>, now: f64) -> Turn {
        let mut turn = Turn::default();
        for (&number, input) in &mut self.inputs {
            if (input.is_ready && !input.is_blocked) || scope == Scope::All {
                Reading { buffer: &mut self.buffer, intake, now }.read(number, input, &mut turn);
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

/// The reading of one socket or stream.
struct Reading<'a> {
    buffer: &'a mut ReceiveBuffer,
    intake: &'a Mutex<Intake>,
    now: f64,
}

impl Reading<'_> {
    fn read(&mut self, number: u32, input: &mut Input, turn: &mut Turn) {
        for _ in 0..MAX_BATCHES {
            let is_left = match &mut input.transport {
                Transport::Datagrams { udp, is_v6 } => self.read_datagrams(number, (udp, *is_v6), turn),
                Transport::Stream { stream, .. } => {
                    input.is_blocked = self.lock().queue.blocks_streams();
                    if input.is_blocked {
                        // The system keeps the bytes, and slows down the sender.
                        return;
                    }
                    self.read_stream(number, stream, turn)
                }
            };
            input.is_ready = is_left;
            if !is_left {
                return;
            }
        }
        turn.is_cut = true;
    }

    /// Reads a batch; returns whether the socket may have more.
    fn read_datagrams(&mut self, number: u32, (udp, is_v6): (&UdpSocket, bool), turn: &mut Turn) -> bool {
        match BATCHES.with_borrow_mut(|batches| batches.receive(udp, is_v6, BATCH, self.buffer)) {
            Ok(()) => {}
            // An unreachable peer may become reachable: any other error is about one datagram.
            Err(error) => return error.kind() != io::ErrorKind::WouldBlock,
        }
        let count = self.buffer.received.len();
        turn.count += count;
        if !self.deliver(number) {
            turn.overloaded.push(number);
            return false;
        }
        // The system reports a datagram that comes after the last one of an incomplete batch.
        count == BATCH
    }

    /// Reads a part of a stream; returns whether it may have more.
    fn read_stream(&mut self, number: u32, stream: &mut RawStream, turn: &mut Turn) -> bool {
        let length = match stream.read(self.buffer.stream()) {
            Ok(length) if length > 0 => length,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => return true,
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => return false,
            end => {
                let code = end.err().and_then(|error| error.raw_os_error()).unwrap_or_default();
                turn.ended.push((number, code));
                return false;
            }
        };
        turn.count += self.lock().read(number, self.buffer.first(length), self.now).max(1);
        // The system reports an end that came together with bytes only once.
        true
    }

    fn lock(&self) -> MutexGuard<'_, Intake> {
        self.intake.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Passes the datagrams that were read to the intake; returns whether the program keeps up.
    fn deliver(&self, number: u32) -> bool {
        let mut intake = self.lock();
        for index in 0..self.buffer.received.len() {
            let (data, address) = self.buffer.datagram(index);
            intake.receive(number, address, data, self.now);
        }
        !intake.queue.is_full()
    }
}
