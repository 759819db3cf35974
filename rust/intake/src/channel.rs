//! A channel of which the intake parses the packets.

use crate::fields::{Continuity, Heading, Position};
use crate::messages::KeyMap;
use mavstack_core::parser::Parser;
use std::sync::{Arc, Mutex};

/// Seconds of which the first packet with an expected boot time is passed on, so that the program sees every sender.
pub const INTERVAL: f64 = 0.5;
/// Returns the time from which the next packet is passed on after one at `now`: those of all sources and messages come
/// together, in one wake-up of the program.
#[must_use]
pub fn next_due(now: f64) -> f64 {
    ((now / INTERVAL).floor() + 1.0) * INTERVAL
}

/// Seconds by which a boot time may deviate.
const TOLERANCE: f64 = 1.0;

/// A parser that the program uses too.
pub type SharedParser = Arc<Mutex<Parser>>;

/// The boot time that the next packets of a source will have if it does not reboot.
#[derive(Clone, Copy, Debug)]
pub struct Boot {
    offset: f64,
    expires_at: f64,
    /// Time of the last packet that was expected.
    pub seen_at: f64,
}

impl Boot {
    #[must_use]
    pub fn new(boot_ms: u32, now: f64) -> Self {
        Self { offset: f64::from(boot_ms) / 1000.0 - now, expires_at: next_due(now), seen_at: now }
    }

    /// Compares the boot time of a packet with those before, and notes its arrival if it continues them.
    pub fn compare(&mut self, boot_ms: u32, now: f64) -> Continuity {
        let deviation = f64::from(boot_ms) / 1000.0 - now - self.offset;
        if deviation.abs() >= TOLERANCE {
            return Continuity::Deviates;
        }
        self.seen_at = now;
        if now < self.expires_at {
            return Continuity::Continues;
        }
        self.expires_at = next_due(now);
        Continuity::IsDue
    }
}

/// A source whose packets need not reach the program.
#[derive(Clone, Copy, Debug, Default)]
pub struct Source {
    /// Time of the last packet; 0: none since the source was granted.
    pub heard_at: f64,
    pub boot: Option<Boot>,
    pub position: Option<Position>,
    pub heading: Option<Heading>,
    /// Time from which the program gets a position in any case.
    pub position_due: f64,
}

/// The bytes and packets that were received on a channel since the last look.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Activity {
    pub bytes: u64,
    pub datagrams: u64,
    /// Time of the last bytes, and of the last valid packet; 0: none.
    pub received_at: f64,
    pub valid_at: f64,
}

/// A channel with its granted sources, by system and component id.
#[derive(Debug)]
pub struct Channel {
    pub parser: SharedParser,
    pub sources: KeyMap<(u8, u8), Source>,
    pub activity: Activity,
}
