//! The links that have something to read, and the wake-ups, by mio.

use crate::engine::links::{Link, Transport};
use mio::event::Source;
use mio::{Interest, Poll, Token};
use std::io;
use std::time::Duration;

/// UDP sockets are reported once for all datagrams that are new.
pub const REPORTS_WAITING: bool = false;

/// The token of the waker.
const WAKE: Token = Token(usize::MAX);

/// Events of one wait.
#[derive(Debug)]
pub struct Events(mio::Events);

impl Events {
    #[must_use]
    pub fn with_capacity(capacity: usize) -> Self {
        Self(mio::Events::with_capacity(capacity))
    }

    /// The indices of the links that can be read, and whether they can be written.
    pub fn links(&self) -> impl Iterator<Item = (usize, bool)> {
        let links = self.0.iter().filter(|event| event.token() != WAKE);
        links.map(|event| (event.token().0, event.is_writable()))
    }
}

/// Ends the waiting of the thread.
#[derive(Debug)]
pub struct Waker(mio::Waker);

impl Waker {
    pub fn wake(&self) {
        // It fails only if the thread's poll is gone.
        let _ = self.0.wake();
    }
}

/// The registered links.
#[derive(Debug)]
pub struct Polling {
    poll: Poll,
    interval: Duration,
}

impl Polling {
    /// Creates a list without links, whose waiting ends after `interval` at the latest.
    pub fn new(interval: Duration) -> io::Result<(Self, Waker)> {
        let poll = Poll::new()?;
        let waker = Waker(mio::Waker::new(poll.registry(), WAKE)?);
        Ok((Self { poll, interval }, waker))
    }

    /// Waits until there are events, or takes those that there are.
    pub fn wait(&mut self, events: &mut Events, is_waiting: bool) -> io::Result<()> {
        let timeout = if is_waiting { self.interval } else { Duration::ZERO };
        self.poll.poll(&mut events.0, Some(timeout))
    }

    /// Registers a link for events with its index.
    pub fn register(&self, link: &mut Link, index: usize) -> io::Result<()> {
        with_source(link, |source| source.register(self.poll.registry(), Token(index), Interest::READABLE))
    }

    /// Asks for an event when a blocked link can send again, or for no more of them: sockets that are not blocked would
    /// cause one for each packet.
    pub fn await_writable(&self, link: &mut Link, index: usize, is_blocked: bool) {
        let interest = if is_blocked { Interest::READABLE | Interest::WRITABLE } else { Interest::READABLE };
        // A source that is gone is reported when it is read.
        let _ = with_source(link, |source| source.reregister(self.poll.registry(), Token(index), interest));
    }

    /// Ends the registration of a link.
    pub fn deregister(&self, link: &mut Link) {
        // A socket that is gone already is not registered any more.
        let _ = with_source(link, |source| source.deregister(self.poll.registry()));
    }
}

/// Calls `use_source` with the event source of a link, if it has one.
fn with_source(link: &mut Link, use_source: impl FnOnce(&mut dyn Source) -> io::Result<()>) -> io::Result<()> {
    match &mut link.transport {
        Transport::Udp(udp) => use_source(&mut udp.socket),
        Transport::Stream(stream) => stream.stream.with_source(use_source),
        Transport::Queue(..) => Ok(()),
    }
}
