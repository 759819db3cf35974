//! The fields of messages that the program compares with those before: boot times, positions and headings.
//!
//! The tolerances are less than those of the program (`mavstack.services.heartbeat`), which gets every packet that
//! exceeds them, and thus misses no contradiction.

use crate::channel::Source;
use mavstack_core::parser::Packet;
use std::collections::HashMap;

/// Whether a packet continues those before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Continuity {
    Continues,
    Deviates,
}

/// Where the fields of a position are in its message: degrees and metres per second.
#[derive(Clone, Copy, Debug)]
pub struct PositionFields {
    pub message_id: u32,
    pub latitude: usize,
    pub longitude: usize,
    pub speeds: [usize; 2],
}

/// Where the fields of an attitude are in its message: radians and radians per second.
#[derive(Clone, Copy, Debug)]
pub struct HeadingFields {
    pub message_id: u32,
    pub roll: usize,
    pub pitch: usize,
    pub yaw: usize,
    pub yaw_speed: usize,
}

/// The fields that are compared.
#[derive(Debug)]
pub struct Fields {
    /// Offset of the boot time in the messages that have one.
    pub boot: HashMap<u32, usize>,
    pub position: PositionFields,
    pub heading: HeadingFields,
}

/// Metres of a degree of latitude.
const DEGREE: f64 = 111_195.0;
/// Metres, and metres per second in addition to the speed, by which positions of one vehicle surely may differ.
const POSITION_TOLERANCE: f64 = 10.0;
const SPEED_TOLERANCE: f64 = 5.0;
/// Degrees, and degrees per second in addition to the rate, by which headings of one vehicle surely may differ.
const HEADING_TOLERANCE: f64 = 20.0;
const RATE_TOLERANCE: f64 = 30.0;
/// Degrees of roll or pitch beyond which a heading means nothing.
const MAX_TILT: f64 = 45.0;
/// Seconds of boot time by which a state may follow the one before.
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

/// A heading of a source: seconds since its boot, degrees, and degrees per second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heading {
    pub time: f64,
    pub heading: f64,
    pub rate: f64,
}

impl Heading {
    /// Returns whether one vehicle surely can have had both headings, one after the other; NaN fits all.
    #[must_use]
    pub fn continues(&self, before: &Self) -> bool {
        let elapsed = self.time - before.time;
        let turn = ((self.heading - before.heading + 180.0).rem_euclid(360.0) - 180.0).abs();
        let fastest = self.rate.max(before.rate) + RATE_TOLERANCE;
        let is_beyond = turn > HEADING_TOLERANCE + fastest * elapsed;
        (0.0..=MAX_STEP).contains(&elapsed) && !is_beyond
    }
}

impl Fields {
    /// Compares the boot time, the position and the heading of a packet with those of its source before.
    pub fn compare(&self, source: &mut Source, packet: &Packet<'_>, now: f64) -> Continuity {
        let id = packet.header.message_id;
        let Some(&offset) = self.boot.get(&id) else {
            return Continuity::Deviates;
        };
        let boot_ms = u32::from_le_bytes(bytes_at(packet, offset));
        let state = if id == self.position.message_id {
            self.compare_position(source, packet, boot_ms)
        } else if id == self.heading.message_id {
            self.compare_heading(source, packet, boot_ms)
        } else {
            Continuity::Continues
        };
        let boot = source.boot.as_mut().map_or(Continuity::Deviates, |boot| boot.compare(boot_ms, now));
        boot.max(state)
    }

    fn compare_position(&self, source: &mut Source, packet: &Packet<'_>, boot_ms: u32) -> Continuity {
        let position = self.position_of(packet, boot_ms);
        let before = source.position.replace(position);
        let is_near = before.is_some_and(|before| position.continues(&before));
        if is_near { Continuity::Continues } else { Continuity::Deviates }
    }

    fn compare_heading(&self, source: &mut Source, packet: &Packet<'_>, boot_ms: u32) -> Continuity {
        let Some(heading) = self.heading_of(packet, boot_ms) else {
            return Continuity::Continues;
        };
        let before = source.heading.replace(heading);
        let is_near = before.is_some_and(|before| heading.continues(&before));
        if is_near { Continuity::Continues } else { Continuity::Deviates }
    }

    fn position_of(&self, packet: &Packet<'_>, boot_ms: u32) -> Position {
        let degrees = |offset| f64::from(i32::from_le_bytes(bytes_at(packet, offset))) / 1e7;
        let speed = |offset| f64::from(i16::from_le_bytes(bytes_at(packet, offset))) / 100.0;
        let [north, east] = self.position.speeds.map(speed);
        Position {
            time: f64::from(boot_ms) / 1000.0,
            latitude: degrees(self.position.latitude),
            longitude: degrees(self.position.longitude),
            speed: north.hypot(east),
        }
    }

    /// Returns the heading of an attitude; `None` if the vehicle is tilted far, or if there is no number.
    fn heading_of(&self, packet: &Packet<'_>, boot_ms: u32) -> Option<Heading> {
        let degrees = |offset| f64::from(f32::from_le_bytes(bytes_at(packet, offset))).to_degrees();
        let fields = self.heading;
        let is_level = degrees(fields.roll).abs() < MAX_TILT && degrees(fields.pitch).abs() < MAX_TILT;
        let time = f64::from(boot_ms) / 1000.0;
        let heading = Heading { time, heading: degrees(fields.yaw), rate: degrees(fields.yaw_speed).abs() };
        is_level.then_some(heading)
    }
}

/// Returns bytes of a payload; those that were trimmed are zero.
fn bytes_at<const N: usize>(packet: &Packet<'_>, offset: usize) -> [u8; N] {
    let payload = packet.payload();
    std::array::from_fn(|index| payload.get(offset + index).copied().unwrap_or(0))
}
