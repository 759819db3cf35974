//! A channel of which the intake parses the packets.

use mavstack_core::parser::Parser;
use std::collections::HashMap;
use std::sync::{Arc, Mutex};

/// Seconds after which a packet with an expected boot time is passed on, so that the program sees every sender.
pub const INTERVAL: f64 = 0.1;
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
        Self { offset: f64::from(boot_ms) / 1000.0 - now, expires_at: now + INTERVAL, seen_at: now }
    }

    /// Returns whether a packet only continues those before, and notes its arrival if so. The first one of each interval
    /// does not count as such.
    pub fn is_expected(&mut self, boot_ms: u32, now: f64) -> bool {
        let deviation = f64::from(boot_ms) / 1000.0 - now - self.offset;
        if deviation.abs() >= TOLERANCE {
            return false;
        }
        self.seen_at = now;
        let is_due = now >= self.expires_at;
        if is_due {
            self.expires_at = now + INTERVAL;
        }
        !is_due
    }
}

/// Where the fields of a position are in its message: the boot time in milliseconds, degrees and metres per second.
#[derive(Clone, Copy, Debug)]
pub struct PositionFields {
    pub message_id: u32,
    pub latitude: usize,
    pub longitude: usize,
    pub speeds: [usize; 2],
}

/// Metres of a degree of latitude.
const DEGREE: f64 = 111_195.0;
/// Metres, and metres per second in addition to the speed, by which positions of one vehicle surely may differ: less
/// than the program allows, which looks at all others.
const POSITION_TOLERANCE: f64 = 10.0;
const SPEED_TOLERANCE: f64 = 5.0;
/// Seconds of boot time by which a position may follow the one before.
const MAX_STEP: f64 = 1.0;

/// A position of a source: seconds since its boot, degrees, and the horizontal speed in metres per second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Position {
    pub time: f64,
    pub latitude: f64,
    pub longitude: f64,
    pub speed: f64,
}

impl Position {
    /// Returns whether one vehicle surely can have had both positions, one after the other.
    #[must_use]
    pub fn continues(&self, before: &Self) -> bool {
        let elapsed = self.time - before.time;
        let north = (self.latitude - before.latitude) * DEGREE;
        let east = (self.longitude - before.longitude) * DEGREE * self.latitude.to_radians().cos();
        let fastest = self.speed.max(before.speed) + SPEED_TOLERANCE;
        (0.0..=MAX_STEP).contains(&elapsed) && north.hypot(east) <= POSITION_TOLERANCE + fastest * elapsed
    }
}

/// A source whose packets need not reach the program.
#[derive(Clone, Copy, Debug, Default)]
pub struct Source {
    /// Time of the last packet; 0: none since the source was granted.
    pub heard_at: f64,
    pub boot: Option<Boot>,
    pub position: Option<Position>,
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
    pub sources: HashMap<(u8, u8), Source>,
    pub activity: Activity,
}
