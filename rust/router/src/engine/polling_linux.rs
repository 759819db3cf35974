//! The links that have something to read, and the wake-ups, by `epoll` itself.
//!
//! Streams are reported once for all that is new, as by mio, which does this on other systems. UDP sockets are reported
//! as long as datagrams wait: a turn may then receive one, without a second system call that finds no other. A timer
//! ends the waiting each second, since a timeout would be set and removed again for each packet.

use crate::engine::links::{Link, Transport};
use rustix::buffer::spare_capacity;
use rustix::event::epoll::{self, CreateFlags, Event, EventData, EventFlags};
use rustix::event::{EventfdFlags, eventfd};
use rustix::fd::{AsFd, BorrowedFd, OwnedFd};
use rustix::time::{
    Itimerspec, TimerfdClockId, TimerfdFlags, TimerfdTimerFlags, Timespec, timerfd_create, timerfd_settime,
};
use std::io;
use std::time::Duration;

/// UDP sockets are reported as long as they have datagrams.
pub const REPORTS_WAITING: bool = true;

/// The events of the waker and of the timer, which are about no link.
const WAKE: u64 = u64::MAX;
const TICK: u64 = u64::MAX - 1;

/// Events of one wait.
pub struct Events(Vec<Event>);

impl Events {
    #[must_use]
    pub fn with_capacity(capacity: usize) -> Self {
        Self(Vec::with_capacity(capacity))
    }

    /// The indices of the links that can be read, and whether they can be written.
    pub fn links(&self) -> impl Iterator<Item = (usize, bool)> {
        let values = self.0.iter().map(|&Event { data, flags }| (data.u64(), flags));
        let links = values.filter(|(data, _)| !matches!(*data, WAKE | TICK));
        links.map(|(data, flags)| (data as usize, flags.contains(EventFlags::OUT)))
    }
}

/// Ends the waiting of the thread.
#[derive(Debug)]
pub struct Waker(OwnedFd);

impl Waker {
    pub fn wake(&self) {
        // Its counter is never full, and it is gone only with the thread.
        let _ = rustix::io::write(&self.0, &1_u64.to_ne_bytes());
    }
}

/// The registered links.
#[derive(Debug)]
pub struct Polling {
    epoll: OwnedFd,
    timer: OwnedFd,
}

impl Polling {
    /// Creates a list without links, whose waiting ends after `interval` at the latest.
    pub fn new(interval: Duration) -> io::Result<(Self, Waker)> {
        let epoll = epoll::create(CreateFlags::CLOEXEC)?;
        let wake = eventfd(0, EventfdFlags::CLOEXEC | EventfdFlags::NONBLOCK)?;
        let timer = timerfd_create(TimerfdClockId::Monotonic, TimerfdFlags::CLOEXEC | TimerfdFlags::NONBLOCK)?;
        let interval = Timespec::try_from(interval).map_err(|_| io::ErrorKind::InvalidInput)?;
        let setting = Itimerspec { it_interval: interval, it_value: interval };
        timerfd_settime(&timer, TimerfdTimerFlags::empty(), &setting)?;
        // Each of their events is reported once, so that the waker is never read.
        epoll::add(&epoll, &wake, EventData::new_u64(WAKE), EventFlags::IN | EventFlags::ET)?;
        epoll::add(&epoll, &timer, EventData::new_u64(TICK), EventFlags::IN | EventFlags::ET)?;
        Ok((Self { epoll, timer }, Waker(wake)))
    }

    /// Waits until there are events, or takes those that there are.
    pub fn wait(&mut self, events: &mut Events, is_waiting: bool) -> io::Result<()> {
        events.0.clear();
        let timeout = if is_waiting { None } else { Some(&Timespec { tv_sec: 0, tv_nsec: 0 }) };
        epoll::wait(&self.epoll, spare_capacity(&mut events.0), timeout)?;
        if events.0.iter().any(|&Event { data, .. }| data.u64() == TICK) {
            // The system sets it again when it is read.
            let _ = rustix::io::read(&self.timer, &mut [0; 8]);
        }
        Ok(())
    }

    /// Registers a link for events with its index.
    pub fn register(&self, link: &mut Link, index: usize) -> io::Result<()> {
        if let Some((descriptor, flags)) = source(link) {
            epoll::add(&self.epoll, descriptor, EventData::new_u64(index as u64), flags)?;
        }
        Ok(())
    }

    /// Asks for an event when a blocked link can send again, or for no more of them: sockets that are not blocked would
    /// cause one for each packet.
    pub fn await_writable(&self, link: &mut Link, index: usize, is_blocked: bool) {
        if let Some((descriptor, mut flags)) = source(link) {
            flags.set(EventFlags::OUT, is_blocked);
            // A source that is gone is reported when it is read.
            let _ = epoll::modify(&self.epoll, descriptor, EventData::new_u64(index as u64), flags);
        }
    }

    /// Ends the registration of a link.
    pub fn deregister(&self, link: &mut Link) {
        if let Some((descriptor, _)) = source(link) {
            // A socket that is gone already is not registered any more.
            let _ = epoll::delete(&self.epoll, descriptor);
        }
    }
}

/// The descriptor of a link, if it has one, and how it is reported.
fn source(link: &Link) -> Option<(BorrowedFd<'_>, EventFlags)> {
    let read = EventFlags::IN | EventFlags::RDHUP;
    match &link.transport {
        Transport::Udp(udp) => Some((udp.socket.as_fd(), read)),
        Transport::Stream(stream) => Some((stream.stream.0.as_fd(), read | EventFlags::ET)),
        Transport::Queue(_) => None,
    }
}
