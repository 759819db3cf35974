//! The clock of the thread.

use crate::router::Time;
use mavstack_core::signing::EPOCH;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// Microseconds between two looks at the calendar of the system: after a pause of the machine it differs from the
/// monotonic clock.
const CALENDAR_INTERVAL: u64 = 100_000;

/// Gives the current time; never 0 microseconds, so that it differs from "never".
pub enum Clock {
    System(SystemClock),
    /// The clock of a test.
    #[cfg(test)]
    Other(Box<dyn Fn() -> Time + Send>),
}

impl Clock {
    #[inline]
    pub fn time(&mut self) -> Time {
        match self {
            Self::System(clock) => clock.time(),
            #[cfg(test)]
            Self::Other(time) => time(),
        }
    }
}

/// The clock of the system.
pub struct SystemClock {
    started: Instant,
    calendar_at: u64,
    signing: u64,
}

impl Default for SystemClock {
    fn default() -> Self {
        Self { started: Instant::now(), calendar_at: 0, signing: signing_time() }
    }
}

impl SystemClock {
    #[inline]
    fn time(&mut self) -> Time {
        let now = self.started.microseconds() + 1;
        if now - self.calendar_at >= CALENDAR_INTERVAL {
            (self.calendar_at, self.signing) = (now, signing_time());
        }
        Time { now, signing: self.signing + (now - self.calendar_at) / 10 }
    }
}

#[cold]
fn signing_time() -> u64 {
    let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    (since_1970.saturating_sub(Duration::from_secs(EPOCH)).as_micros() / 10) as u64
}

/// A moment in microseconds: the differences of the standard library's cost several times as much.
#[cfg(target_os = "linux")]
struct Instant(u64);

#[cfg(target_os = "linux")]
impl Instant {
    fn now() -> Self {
        use nix::time::{ClockId, clock_gettime};
        let microseconds =
            |time: nix::sys::time::TimeSpec| time.tv_sec() as u64 * 1_000_000 + time.tv_nsec() as u64 / 1000;
        Self(clock_gettime(ClockId::CLOCK_MONOTONIC).map_or(0, microseconds))
    }

    /// Returns the microseconds since the moment.
    #[inline]
    fn microseconds(&self) -> u64 {
        Self::now().0.saturating_sub(self.0)
    }
}

#[cfg(not(target_os = "linux"))]
struct Instant(std::time::Instant);

#[cfg(not(target_os = "linux"))]
impl Instant {
    fn now() -> Self {
        Self(std::time::Instant::now())
    }

    fn microseconds(&self) -> u64 {
        self.0.elapsed().as_micros() as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_clock_of_the_system_counts_from_its_start_and_knows_the_calendar() {
        let mut clock = Clock::System(SystemClock::default());
        let (first, second) = (clock.time(), clock.time());
        assert!((1..1_000_000).contains(&first.now) && second.now >= first.now);
        let calendar = signing_time();
        assert!(calendar - 100_000 < second.signing && second.signing <= calendar + 1, "ten microseconds");
    }

    #[test]
    fn the_calendar_is_read_again_after_an_interval() {
        let mut clock = SystemClock { signing: 0, ..SystemClock::default() };
        let calendar = signing_time();
        std::thread::sleep(Duration::from_micros(CALENDAR_INTERVAL));
        assert!(clock.time().signing >= calendar);
    }
}
