//! The reader of sockets and streams into an [`Intake`]: a thread, and the program where that is cheaper (see [`crate::pace`]).
//!
//! The thread wakes the program by a descriptor, and only if something waits for it. After a turn without urgent packets
//! it rests, so that packets which come soon after each other cost one wake-up of the thread and one of the program.

use crate::intake::Intake;
use crate::pace::Mode;
use crate::queue::Urgency;
use crate::sockets::{Scope, Sockets, Transport, Turn};
use mavstack_router::engine::notify::Notifier;
use mavstack_router::engine::stream::RawStream;
use mio::net::UdpSocket;
use mio::{Events, Interest, Poll, Registry, Token, Waker};
use std::io;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{JoinHandle, Thread};
use std::time::{Duration, Instant};

/// Seconds after a look at the sockets for which latest packets are fresh enough.
const FRESHNESS: f64 = 0.001;
/// Rest that is not worth to be continued.
const SOON: Duration = Duration::from_micros(100);
const WAKE: Token = Token(usize::MAX);

/// The state that the program and the thread share.
struct Shared {
    intake: Arc<Mutex<Intake>>,
    sockets: Mutex<Sockets>,
    registry: Registry,
    is_closed: AtomicBool,
    /// The mode of the pace, to be read without the lock.
    mode: AtomicU8,
    waker: Waker,
    notifier: Notifier,
    started: Instant,
    /// Time of the program's clock when the reader started.
    base: f64,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Shared {
    fn now(&self) -> f64 {
        self.base + self.started.elapsed().as_secs_f64()
    }

    fn is_in(&self, mode: Mode) -> bool {
        self.mode.load(Ordering::Relaxed) == mode as u8
    }

    /// Reads the sockets.
    fn read(&self, scope: Scope) -> Turn {
        let mut sockets = lock(&self.sockets);
        let turn = sockets.read(scope, &self.intake, self.now());
        for &number in &turn.overloaded {
            self.remove(&mut sockets, number);
            lock(&self.intake).queue.overload(number);
        }
        for &(number, error) in &turn.ended {
            self.remove(&mut sockets, number);
            lock(&self.intake).queue.end(number, error);
        }
        turn
    }

    /// Wakes the program if something waits for it that must not wait longer.
    fn announce(&self) {
        let calls_program = lock(&self.sockets).pace.calls_program();
        if lock(&self.intake).queue.announce() || calls_program {
            self.notifier.set();
        }
    }

    /// Changes the mode if the traffic calls for it; returns whether it changed.
    fn adapt(&self, by_program: bool) -> bool {
        let mut sockets = lock(&self.sockets);
        let is_changed = sockets.pace.adapt(by_program);
        if is_changed {
            sockets.suspect_all();
            self.mode.store(sockets.pace.mode() as u8, Ordering::Relaxed);
        }
        is_changed
    }

    fn remove(&self, sockets: &mut Sockets, number: u32) {
        if let Some(mut removed) = sockets.remove(number) {
            // It fails only if the thread's poll is gone.
            let _ = removed.with_source(|source| source.deregister(&self.registry));
        }
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
            sockets: Mutex::new(Sockets::new(now)),
            registry: poll.registry().try_clone()?,
            is_closed: AtomicBool::new(false),
            mode: AtomicU8::new(Mode::Watching as u8),
            waker: Waker::new(poll.registry(), WAKE)?,
            notifier: Notifier::new()?,
            started: Instant::now(),
            base: now,
        });
        let for_thread = Arc::clone(&shared);
        let run = move || Worker { poll, shared: for_thread }.run();
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
        self.add_transport(number, Transport::datagrams(UdpSocket::from_std(socket)))
    }

    /// Reads a stream from now on, for the channel of the same number.
    pub fn add_stream(&self, number: u32, stream: RawStream, is_terminal: bool) -> io::Result<()> {
        self.add_transport(number, Transport::Stream { stream, is_terminal })
    }

    fn add_transport(&self, number: u32, mut transport: Transport) -> io::Result<()> {
        let registry = &self.shared.registry;
        transport.with_source(|source| source.register(registry, Token(number as usize), Interest::READABLE))?;
        lock(&self.shared.sockets).add(number, transport);
        self.wake();
        Ok(())
    }

    /// Closes the copy of a socket or stream. Idempotent.
    pub fn remove(&self, number: u32) {
        self.shared.remove(&mut lock(&self.shared.sockets), number);
    }

    /// Takes the signal back, before the program takes what waits; reads the sockets if the program is to do so.
    /// Returns whether it is, from now on.
    #[must_use]
    pub fn begin_to_take(&self) -> bool {
        self.shared.notifier.clear();
        if self.shared.is_in(Mode::Direct) {
            self.shared.read(Scope::All);
        }
        if self.shared.adapt(true) {
            self.wake();
        }
        self.shared.is_in(Mode::Direct)
    }

    /// Reads streams again that were not read because the program did not keep up: it has taken packets.
    pub fn unblock(&self) {
        lock(&self.shared.sockets).unblock();
        self.wake();
    }

    /// Signals that something is left after the program took a part.
    pub fn signal(&self) {
        self.shared.notifier.set();
    }

    /// Reads the sockets unless they were read a moment ago, because the program asks for latest packets.
    pub fn refresh(&self) {
        let is_stale = || self.shared.now() - lock(&self.shared.sockets).read_at > FRESHNESS;
        if self.shared.is_in(Mode::Resting) && is_stale() {
            self.shared.read(Scope::All);
            self.shared.adapt(false);
            self.shared.announce();
        }
    }

    /// Lets no packet rest for some time, because the program waits for an answer; returns whether the program is to
    /// read the sockets from now on.
    #[must_use]
    pub fn hurry(&self, seconds: f64) -> bool {
        lock(&self.shared.sockets).pace.hurry(self.shared.now(), seconds);
        self.shared.adapt(true);
        self.shared.is_in(Mode::Direct)
    }

    fn wake(&self) {
        // It fails only if the thread's poll is gone.
        let _ = self.shared.waker.wake();
        self.thread.as_ref().map(JoinHandle::thread).map(Thread::unpark);
    }

    /// Ends the thread. Idempotent.
    pub fn close(&mut self) {
        self.shared.is_closed.store(true, Ordering::Release);
        self.wake();
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has ended too.
            let _ = thread.join();
        }
    }
}

impl Drop for Reader {
    fn drop(&mut self) {
        self.close();
    }
}

/// The state of the thread.
struct Worker {
    poll: Poll,
    shared: Arc<Shared>,
}

impl Worker {
    fn run(mut self) {
        let mut events = Events::with_capacity(64);
        while !self.shared.is_closed.load(Ordering::Acquire) {
            if self.shared.is_in(Mode::Watching) {
                if !self.watch(&mut events) {
                    return;
                }
            } else {
                self.look();
            }
            self.shared.adapt(false);
        }
    }

    /// Waits for a datagram, and reads; returns false if waiting is not possible.
    fn watch(&mut self, events: &mut Events) -> bool {
        if let Err(error) = self.poll.poll(events, self.poll_timeout())
            && error.kind() != io::ErrorKind::Interrupted
        {
            return false;
        }
        let mut sockets = lock(&self.shared.sockets);
        events.iter().for_each(|event| sockets.note_ready(event.token().0 as u32));
        drop(sockets);
        let turn = self.shared.read(Scope::Ready);
        let rest = if turn.count > 0 { self.rest(turn.urgency) } else { Duration::ZERO };
        if !rest.is_zero() && turn.overloaded.is_empty() {
            std::thread::sleep(rest);
            self.shared.read(Scope::All);
        }
        self.shared.announce();
        true
    }

    /// Returns how long to wait for a datagram.
    fn poll_timeout(&self) -> Option<Duration> {
        lock(&self.shared.sockets).has_ready().then_some(Duration::ZERO)
    }

    fn rest(&self, urgency: Urgency) -> Duration {
        let sockets = lock(&self.shared.sockets);
        if sockets.pace.is_in_hurry(self.shared.now()) { Duration::ZERO } else { sockets.pace.rest(urgency) }
    }

    /// Rests since the last reading, and reads unless the program did so meanwhile.
    fn look(&self) {
        std::thread::park_timeout(self.rest_left());
        if self.rest_left() < SOON {
            while self.shared.read(Scope::All).is_cut {}
            self.shared.announce();
        }
    }

    fn rest_left(&self) -> Duration {
        let sockets = lock(&self.shared.sockets);
        let rested = Duration::from_secs_f64((self.shared.now() - sockets.read_at).max(0.0));
        sockets.pace.rest(Urgency::None).saturating_sub(rested)
    }
}
