//! The thread that reads UDP sockets into an [`Intake`].
//!
//! It wakes the program by a descriptor, and only if something waits for it. After a turn without urgent packets it rests,
//! so that packets which come soon after each other cost one wake-up of the thread and one of the program together.

use crate::intake::Intake;
use crate::queue::Urgency;
use mavstack_router::engine::batch::Batches;
use mavstack_router::engine::datagrams::{BATCH, ReceiveBuffer};
use mavstack_router::engine::notify::Notifier;
use mio::net::UdpSocket;
use mio::{Events, Interest, Poll, Token, Waker};
use std::collections::HashMap;
use std::io;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// The longest rest after a turn: the longest delay of a packet that is not urgent.
pub const REST: Duration = Duration::from_micros(500);
/// Datagrams that may collect during a rest: a small socket buffer holds as many.
const MAX_RESTING: f64 = 64.0;
/// Batches of one socket in a turn.
const MAX_BATCHES: usize = 16;
const WAKE: Token = Token(usize::MAX);

enum Command {
    Add(u32, UdpSocket),
    Remove(u32, SyncSender<()>),
}

/// The state that the program and the thread share.
struct Shared {
    intake: Arc<Mutex<Intake>>,
    commands: Mutex<Vec<Command>>,
    is_closed: AtomicBool,
    waker: Waker,
    notifier: Notifier,
    started: Instant,
    /// Time of the program's clock when the reader started.
    base: f64,
    /// Microseconds after the start until which the thread does not rest.
    hurry_until: AtomicU64,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Shared {
    fn now(&self) -> f64 {
        self.base + self.started.elapsed().as_secs_f64()
    }

    fn is_in_hurry(&self) -> bool {
        self.hurry_until.load(Ordering::Relaxed) > self.started.elapsed().as_micros() as u64
    }

    fn send(&self, command: Command) {
        lock(&self.commands).push(command);
        // It fails only if the thread's poll is gone.
        let _ = self.waker.wake();
    }
}

/// The handle of a running reader. Dropping it ends the thread.
pub struct Reader {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

impl Reader {
    /// Starts a reader; `now` is the time of the program's clock, in seconds.
    pub fn start(intake: Arc<Mutex<Intake>>, now: f64) -> io::Result<Self> {
        let poll = Poll::new()?;
        let shared = Arc::new(Shared {
            intake,
            commands: Mutex::default(),
            is_closed: AtomicBool::new(false),
            waker: Waker::new(poll.registry(), WAKE)?,
            notifier: Notifier::new()?,
            started: Instant::now(),
            base: now,
            hurry_until: AtomicU64::new(0),
        });
        let for_thread = Arc::clone(&shared);
        let run = move || Worker::new(poll, for_thread).run();
        let thread = std::thread::Builder::new().name("mavstack-intake".into()).spawn(run)?;
        Ok(Self { shared, thread: Some(thread) })
    }

    /// A descriptor (a socket on Windows) that is readable while something waits.
    #[must_use]
    pub fn descriptor(&self) -> i64 {
        self.shared.notifier.descriptor()
    }

    /// Reads a socket from now on.
    pub fn add(&self, number: u32, socket: std::net::UdpSocket) -> io::Result<()> {
        socket.set_nonblocking(true)?;
        self.shared.send(Command::Add(number, UdpSocket::from_std(socket)));
        Ok(())
    }

    /// Closes the thread's copy of a socket, and waits until it is closed. Idempotent.
    pub fn remove(&self, number: u32) {
        let (sender, receiver) = sync_channel(1);
        self.shared.send(Command::Remove(number, sender));
        // An error: the thread has ended, and its sockets are closed.
        let _ = receiver.recv();
    }

    /// Takes the signal back, before the program takes what waits.
    pub fn clear(&self) {
        self.shared.notifier.clear();
    }

    /// Lets the thread not rest for some time, because the program waits for an answer.
    pub fn hurry(&self, duration: Duration) {
        let until = (self.shared.started.elapsed() + duration).as_micros() as u64;
        self.shared.hurry_until.fetch_max(until, Ordering::Relaxed);
    }

    /// Ends the thread. Idempotent.
    pub fn close(&mut self) {
        self.shared.is_closed.store(true, Ordering::Release);
        let _ = self.shared.waker.wake();
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has ended too.
            let _ = thread.join();
        }
        lock(&self.shared.commands).clear();
    }
}

impl Drop for Reader {
    fn drop(&mut self) {
        self.close();
    }
}

struct Input {
    udp: UdpSocket,
    is_v6: bool,
    is_ready: bool,
}

/// The state of the thread.
struct Worker {
    poll: Poll,
    shared: Arc<Shared>,
    sockets: HashMap<u32, Input>,
    batches: Batches,
    buffer: ReceiveBuffer,
    read_at: Instant,
    /// Datagrams per second, about.
    rate: f64,
}

impl Worker {
    fn new(poll: Poll, shared: Arc<Shared>) -> Self {
        let (sockets, batches, buffer) = (HashMap::new(), Batches::default(), ReceiveBuffer::default());
        Self { poll, shared, sockets, batches, buffer, read_at: Instant::now(), rate: 0.0 }
    }

    fn run(mut self) {
        let mut events = Events::with_capacity(64);
        loop {
            let is_idle = self.sockets.values().all(|socket| !socket.is_ready);
            let timeout = if is_idle { None } else { Some(Duration::ZERO) };
            if let Err(error) = self.poll.poll(&mut events, timeout)
                && error.kind() != io::ErrorKind::Interrupted
            {
                return;
            }
            for event in &events {
                if let Some(socket) = self.sockets.get_mut(&(event.token().0 as u32)) {
                    socket.is_ready = true;
                }
            }
            if self.shared.is_closed.load(Ordering::Acquire) {
                return;
            }
            self.execute_commands();
            self.turn();
        }
    }

    fn execute_commands(&mut self) {
        let commands = std::mem::take(&mut *lock(&self.shared.commands));
        for command in commands {
            match command {
                Command::Add(number, mut socket) => {
                    let is_v6 = socket.local_addr().is_ok_and(|address| address.is_ipv6());
                    let token = Token(number as usize);
                    if self.poll.registry().register(&mut socket, token, Interest::READABLE).is_err() {
                        self.give_back(number);
                    } else {
                        self.sockets.insert(number, Input { udp: socket, is_v6, is_ready: true });
                    }
                }
                Command::Remove(number, done) => {
                    self.remove(number);
                    // The program may not wait any more.
                    let _ = done.try_send(());
                }
            }
        }
    }

    fn remove(&mut self, number: u32) {
        if let Some(mut removed) = self.sockets.remove(&number) {
            let _ = self.poll.registry().deregister(&mut removed.udp);
        }
    }

    /// Lets the program read a socket itself.
    fn give_back(&mut self, number: u32) {
        self.remove(number);
        let mut intake = lock(&self.shared.intake);
        intake.queue.overload(number);
        if intake.queue.announce() {
            self.shared.notifier.set();
        }
    }

    /// Reads the sockets that have something, and wakes the program.
    fn turn(&mut self) {
        let ready = self.ready();
        let mut count = self.read(&ready);
        if count == 0 {
            return;
        }
        if self.urgency() < Urgency::Now && !self.shared.is_in_hurry() {
            std::thread::sleep(self.rest(count));
            count += self.read(&ready);
        }
        self.note_rate(count);
        if lock(&self.shared.intake).queue.announce() {
            self.shared.notifier.set();
        }
    }

    fn ready(&self) -> Vec<u32> {
        self.sockets.iter().filter(|(_, one)| one.is_ready).map(|(&number, _)| number).collect()
    }

    fn urgency(&self) -> Urgency {
        lock(&self.shared.intake).queue.urgency
    }

    fn note_rate(&mut self, count: usize) {
        let elapsed = self.read_at.elapsed().as_secs_f64().max(1e-5);
        self.read_at = Instant::now();
        self.rate += 0.5 * (count as f64 / elapsed - self.rate);
    }

    /// Returns how long to rest after a turn with some datagrams.
    fn rest(&self, count: usize) -> Duration {
        if count >= BATCH / 2 {
            return Duration::ZERO;
        }
        REST.min(Duration::from_secs_f64(MAX_RESTING / self.rate.max(1.0)))
    }

    /// Reads each of these sockets until it is empty; returns the number of datagrams.
    fn read(&mut self, numbers: &[u32]) -> usize {
        numbers.iter().map(|&number| self.read_socket(number)).sum()
    }

    fn read_socket(&mut self, number: u32) -> usize {
        let mut total = 0;
        for _ in 0..MAX_BATCHES {
            let Some(socket) = self.sockets.get_mut(&number) else {
                return total;
            };
            match self.batches.receive(&socket.udp, socket.is_v6, BATCH, &mut self.buffer) {
                Ok(()) => {}
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {
                    socket.is_ready = false;
                    return total;
                }
                // An unreachable peer may become reachable.
                Err(_) => continue,
            }
            let count = self.buffer.received.len();
            // The system reports a datagram that comes after the last one of an incomplete batch.
            socket.is_ready = count == BATCH;
            total += count;
            if !self.deliver(number) {
                self.give_back(number);
                return total;
            }
            if count < BATCH {
                return total;
            }
        }
        total
    }

    /// Passes the datagrams that were read to the intake; returns whether the program keeps up.
    fn deliver(&self, number: u32) -> bool {
        let mut intake = lock(&self.shared.intake);
        let now = self.shared.now();
        for index in 0..self.buffer.received.len() {
            let (data, address) = self.buffer.datagram(index);
            intake.receive(number, address, data, now);
        }
        !intake.queue.is_full()
    }
}
