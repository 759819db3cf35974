//! A channel of which the intake parses the packets.

use crate::fields::{Continuity, Heading, Position};
use crate::messages::KeyMap;
use mavstack_core::parser::Parser;
use std::sync::{Arc, Mutex};

/// Seconds after which the expected boot time follows the clock of the vehicle.
const INTERVAL: f64 = 0.5;

/// Seconds by which a boot time may deviate.
const TOLERANCE: f64 = 1.0;

/// A parser that the program uses too.
pub type SharedParser = Arc<Mutex<Parser>>;

/// The boot time that the next packets of a source will have if it does not reboot.
#[derive(Clone, Copy, Debug)]
pub struct Boot {
    offset: f64,
    follows_at: f64,
    /// Boot time and arrival of the last packet that was expected.
    pub boot_ms: u32,
    pub seen_at: f64,
}

impl Boot {
    #[must_use]
    pub fn new(boot_ms: u32, now: f64) -> Self {
        Self { offset: f64::from(boot_ms) / 1000.0 - now, follows_at: now + INTERVAL, boot_ms, seen_at: now }
    }

    /// Compares the boot time of a packet with those before, and notes its arrival if it continues them.
    pub fn compare(&mut self, boot_ms: u32, now: f64) -> Continuity {
        let deviation = f64::from(boot_ms) / 1000.0 - now - self.offset;
        if deviation.abs() >= TOLERANCE {
            return Continuity::Deviates;
        }
        (self.boot_ms, self.seen_at) = (boot_ms, now);
        if now >= self.follows_at {
            *self = Self::new(boot_ms, now);
        }
        Continuity::Continues
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
