//! Who reads the sockets, and how long packets may collect in them: decided by the packets of the last moment.

use crate::queue::Urgency;
use std::time::Duration;

/// Who waits for the sockets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// The thread wakes for each datagram, and rests for a moment after it.
    Watching,
    /// The thread looks at times, since no part of the program handles single packets.
    Resting,
    /// The program reads, since it handles most packets; the thread only looks whether it does.
    Direct,
}

/// Longest rest of a thread that watches: the longest delay of a packet that a listener takes.
const SHORT_REST: f64 = 0.0002;
/// The same for packets that may come together with others.
const REST: f64 = 0.0005;
/// Longest rest between two looks.
const LONG_REST: f64 = 0.11;
/// Longest time between two looks whether the program reads.
const GUARD_REST: f64 = 0.25;
/// Datagrams that may collect, fewest and most: a small socket buffer holds twice the fewest.
const MIN_COLLECTED: usize = 128;
const MAX_COLLECTED: usize = 4096;
/// Most that may collect while the thread reads.
const MAX_BY_THREAD: usize = 512;
/// Bytes of a socket buffer for each datagram that may collect: twice what a short one takes there.
const BYTES_COLLECTED: usize = 1600;
/// Seconds of traffic that decide.
const WINDOW: f64 = 0.2;
/// Seconds with fewer than `MANY` turns with packets for listeners or services before the thread only looks at times.
const CALM: f64 = 1.0;
const MANY: usize = 4;
/// Datagrams per second below which waking for each costs little.
const MIN_RESTING_RATE: f64 = 100.0;
/// Seconds for which the thread reads after the program could not empty the sockets.
const PRESSURE: f64 = 0.5;

/// The traffic of the last moment.
#[derive(Debug)]
pub struct Pace {
    mode: Mode,
    /// The mode that the traffic calls for.
    wanted: Mode,
    began_at: f64,
    datagrams: usize,
    turns: usize,
    prompt_turns: usize,
    /// The times of the last prompt turns, in a ring.
    prompt_at: [f64; MANY],
    prompt_count: usize,
    hurry_until: f64,
    pressed_until: f64,
    /// Datagrams per second, about.
    rate: f64,
    /// Datagrams that may collect.
    max_collected: usize,
}

impl Pace {
    #[must_use]
    pub fn new(now: f64) -> Self {
        Self {
            mode: Mode::Watching,
            wanted: Mode::Watching,
            began_at: now,
            datagrams: 0,
            turns: 0,
            prompt_turns: 0,
            prompt_at: [now; MANY],
            prompt_count: 0,
            hurry_until: 0.0,
            pressed_until: 0.0,
            rate: 0.0,
            max_collected: MAX_COLLECTED,
        }
    }

    /// Limits the datagrams that may collect to those that a socket buffer of this many bytes surely holds.
    pub fn limit_collected(&mut self, buffer_bytes: usize) {
        self.max_collected = self.max_collected.min((buffer_bytes / BYTES_COLLECTED).max(MIN_COLLECTED));
    }

    #[must_use]
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// Lets the program read for some time, because it waits for an answer.
    pub fn hurry(&mut self, now: f64, seconds: f64) {
        self.hurry_until = self.hurry_until.max(now + seconds);
        if now >= self.pressed_until {
            self.wanted = Mode::Direct;
        }
    }

    #[must_use]
    pub fn is_in_hurry(&self, now: f64) -> bool {
        now < self.hurry_until
    }

    /// Lets the thread read for a while, because the program could not empty the sockets.
    pub fn press(&mut self, now: f64) {
        self.pressed_until = now + PRESSURE;
        self.wanted = Mode::Watching;
    }

    /// Notes that datagrams were read, and how urgent they are.
    pub fn note(&mut self, count: usize, urgency: Urgency, now: f64) {
        self.datagrams += count;
        self.turns += 1;
        if urgency >= Urgency::Prompt {
            self.prompt_turns += 1;
            self.prompt_at[self.prompt_count % MANY] = now;
            self.prompt_count += 1;
        }
        if now - self.began_at >= WINDOW {
            self.decide(now);
        } else if self.mode == Mode::Resting && !self.is_calm(now) {
            self.wanted = Mode::Watching;
        }
    }

    fn is_calm(&self, now: f64) -> bool {
        now - self.prompt_at[self.prompt_count % MANY] >= CALM
    }

    fn decide(&mut self, now: f64) {
        self.rate = self.datagrams as f64 / (now - self.began_at);
        let is_prompt = 2 * self.prompt_turns >= self.turns && self.prompt_turns > 1;
        self.wanted = if now < self.pressed_until {
            Mode::Watching
        } else if is_prompt || self.is_in_hurry(now) {
            Mode::Direct
        } else if self.rate >= MIN_RESTING_RATE && self.is_calm(now) {
            Mode::Resting
        } else {
            Mode::Watching
        };
        (self.began_at, self.datagrams, self.turns, self.prompt_turns) = (now, 0, 0, 0);
    }

    /// Changes the mode as the traffic calls for; only the program, which must look itself, begins and ends to read.
    /// Returns whether it changed.
    pub fn adapt(&mut self, by_program: bool) -> bool {
        let concerns_program = (self.mode == Mode::Direct) != (self.wanted == Mode::Direct);
        if self.mode == self.wanted || (concerns_program && !by_program) {
            return false;
        }
        self.mode = self.wanted;
        true
    }

    /// Returns whether the program is to begin to read.
    #[must_use]
    pub fn calls_program(&self) -> bool {
        self.wanted == Mode::Direct && self.mode != Mode::Direct
    }

    /// Returns how long datagrams may collect now.
    #[must_use]
    pub fn rest(&self, urgency: Urgency) -> Duration {
        let max = match (self.mode, urgency) {
            (Mode::Direct, _) => GUARD_REST,
            (Mode::Resting, _) => LONG_REST,
            (Mode::Watching, Urgency::Now) => 0.0,
            (Mode::Watching, Urgency::Prompt) => SHORT_REST,
            (Mode::Watching, _) => REST,
        };
        let limit = if self.mode == Mode::Direct { self.max_collected } else { self.max_collected.min(MAX_BY_THREAD) };
        Duration::from_secs_f64(max.min(limit as f64 / self.rate.max(1.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mode after two seconds in which datagrams come in turns at this rate, of which one in `every` is prompt.
    fn mode_after(turns_per_second: u32, every: u32) -> Mode {
        let mut pace = Pace::new(0.0);
        for turn in 0..2 * turns_per_second {
            let urgency = if turn % every == 0 { Urgency::Prompt } else { Urgency::None };
            pace.note(8, urgency, f64::from(turn) / f64::from(turns_per_second));
            pace.adapt(true);
        }
        pace.mode()
    }

    #[test]
    fn the_program_reads_if_it_handles_many_packets_and_the_thread_rests_if_it_handles_few() {
        assert_eq!(mode_after(50, 1), Mode::Direct);
        assert_eq!(mode_after(50, 5), Mode::Watching);
        assert_eq!(mode_after(50, 20), Mode::Resting, "two or three in a second");
        assert_eq!(mode_after(6, 1000), Mode::Watching, "few datagrams");
    }

    #[test]
    fn packets_for_a_listener_end_a_rest_and_an_answer_that_is_awaited_calls_the_program() {
        let mut pace = Pace::new(0.0);
        for turn in 0..=75 {
            pace.note(8, Urgency::None, f64::from(turn) / 50.0);
            pace.adapt(true);
        }
        assert_eq!((pace.mode(), pace.rest(Urgency::None).as_millis()), (Mode::Resting, 110));
        for (number, is_over) in [false, false, false, true].into_iter().enumerate() {
            pace.note(1, Urgency::Prompt, 1.51 + 0.01 * number as f64);
            assert_eq!(pace.adapt(false), is_over);
        }
        assert_eq!((pace.mode(), pace.rest(Urgency::Now)), (Mode::Watching, Duration::ZERO));
        pace.hurry(1.6, 0.1);
        assert!(!pace.adapt(false) && pace.calls_program() && pace.adapt(true));
        assert_eq!(pace.mode(), Mode::Direct);
        pace.press(1.65);
        assert!(!pace.adapt(false) && pace.adapt(true));
        pace.hurry(1.7, 0.1);
        assert!(!pace.adapt(true), "the program could not empty the sockets");
        assert_eq!(pace.mode(), Mode::Watching);
    }

    #[test]
    fn no_more_datagrams_collect_than_a_small_buffer_holds() {
        let mut pace = Pace::new(0.0);
        pace.limit_collected(212_992);
        pace.limit_collected(8 << 20);
        for turn in 0..1500 {
            pace.note(100, Urgency::None, f64::from(turn) / 1000.0);
            pace.adapt(true);
        }
        assert_eq!(pace.mode(), Mode::Resting);
        assert!(pace.rest(Urgency::None) < Duration::from_millis(2));
    }

    #[test]
    fn the_guard_of_a_program_that_reads_lets_more_collect_in_a_large_buffer_than_the_thread_does() {
        let rest_with = |buffer, urgency| {
            let mut pace = Pace::new(0.0);
            pace.limit_collected(buffer);
            for turn in 0..1500 {
                pace.note(100, urgency, f64::from(turn) / 1000.0);
                pace.adapt(true);
            }
            pace.rest(Urgency::None).as_secs_f64() * 1e5
        };
        let near = |rest: f64, datagrams: f64| (rest / datagrams - 1.0).abs() < 0.05;
        assert!(near(rest_with(8 << 20, Urgency::Prompt), 4096.0));
        assert!(near(rest_with(8 << 20, Urgency::None), 512.0));
        assert!(near(rest_with(212_992, Urgency::Prompt), 133.0));
    }
}
