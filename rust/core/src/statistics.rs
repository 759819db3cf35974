//! Counters of received bytes and packets: nothing is dropped without being counted here.

use crate::saved::{Reader, Writer};

/// The reason why bytes that begin with a magic are not a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reject {
    Checksum,
    /// An unknown incompatibility flag, so the packet cannot be parsed.
    IncompatFlags,
    /// A version 1 packet shorter than its message.
    Length,
}

/// Totals of one byte stream.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    pub packets: u64,
    /// Total length of the packets in bytes.
    pub packet_bytes: u64,
    pub version_1: u64,
    pub version_2: u64,
    pub signed: u64,
    /// Packets whose message id is not in the dialect.
    pub unknown: u64,
    /// Bytes outside any packet.
    pub bad_bytes: u64,
    pub bad_checksum: u64,
    pub bad_flags: u64,
    pub bad_length: u64,
}

impl Statistics {
    pub(crate) fn reject(&mut self, reason: Reject) {
        match reason {
            Reject::Checksum => self.bad_checksum += 1,
            Reject::IncompatFlags => self.bad_flags += 1,
            Reject::Length => self.bad_length += 1,
        }
    }

    /// Adds the totals of another segment of the same stream.
    pub fn add(&mut self, other: &Self) {
        self.packets += other.packets;
        self.packet_bytes += other.packet_bytes;
        self.version_1 += other.version_1;
        self.version_2 += other.version_2;
        self.signed += other.signed;
        self.unknown += other.unknown;
        self.bad_bytes += other.bad_bytes;
        self.bad_checksum += other.bad_checksum;
        self.bad_flags += other.bad_flags;
        self.bad_length += other.bad_length;
    }

    pub(crate) fn save(&self, writer: &mut Writer) {
        let mut copy = *self;
        copy.all().into_iter().for_each(|count| writer.number(*count));
    }

    pub(crate) fn restore(reader: &mut Reader<'_>) -> Option<Self> {
        let mut statistics = Self::default();
        for count in statistics.all() {
            *count = reader.number()?;
        }
        Some(statistics)
    }

    fn all(&mut self) -> [&mut u64; 10] {
        [
            &mut self.packets,
            &mut self.packet_bytes,
            &mut self.version_1,
            &mut self.version_2,
            &mut self.signed,
            &mut self.unknown,
            &mut self.bad_bytes,
            &mut self.bad_checksum,
            &mut self.bad_flags,
            &mut self.bad_length,
        ]
    }
}
