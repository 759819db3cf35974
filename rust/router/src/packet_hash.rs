//! The hash of a packet, by a multiplication for each sixteen bytes.
//!
//! The words of the packet are added to random keys, and the products of their pairs are summed (NH, of UMAC and VMAC):
//! two packets have one sum with a probability of 2^-64, whatever was chosen, as long as the keys are unknown.

use mavstack_core::header::MAX_PACKET;
use std::hash::{BuildHasher, RandomState};

/// Bytes of a pair of words.
const PAIR: usize = 16;
/// The pairs of the longest packet.
const PAIRS: usize = MAX_PACKET.div_ceil(PAIR);

/// Hashes packets with random keys.
#[derive(Debug)]
pub struct PacketHasher {
    keys: [[u64; 2]; PAIRS],
    last: [u64; 2],
}

impl Default for PacketHasher {
    fn default() -> Self {
        let random = RandomState::new();
        let key = |number: usize| random.hash_one(number);
        Self { keys: std::array::from_fn(|pair| [key(2 * pair), key(2 * pair + 1)]), last: [key(1000), key(1001)] }
    }
}

impl PacketHasher {
    /// Returns the hash of at most [`MAX_PACKET`] bytes; more are not looked at.
    #[inline]
    #[must_use]
    pub fn hash(&self, packet: &[u8]) -> u64 {
        let (pairs, rest) = packet.as_chunks::<PAIR>();
        // Packets that end in zeros differ by their length.
        let mut sum = packet.len() as u128;
        for (pair, keys) in pairs.iter().zip(&self.keys) {
            sum = sum.wrapping_add(product(u128::from_le_bytes(*pair), keys));
        }
        if !rest.is_empty()
            && let Some(keys) = self.keys.get(pairs.len())
        {
            sum = sum.wrapping_add(product(last_pair(packet), keys));
        }
        let mixed = product(sum, &self.last);
        mixed as u64 ^ (mixed >> 64) as u64
    }
}

#[inline]
fn product(words: u128, keys: &[u64; 2]) -> u128 {
    u128::from((words as u64).wrapping_add(keys[0])) * u128::from(((words >> 64) as u64).wrapping_add(keys[1]))
}

/// The last sixteen bytes, of which some were in the pair before: they cost no call, unlike those of a part. Of a shorter
/// packet the first and the last eight.
#[inline]
fn last_pair(packet: &[u8]) -> u128 {
    if let Some(last) = packet.last_chunk::<PAIR>() {
        return u128::from_le_bytes(*last);
    }
    if let (Some(first), Some(last)) = (packet.first_chunk(), packet.last_chunk()) {
        return u128::from(u64::from_le_bytes(*first)) << 64 | u128::from(u64::from_le_bytes(*last));
    }
    packet.iter().fold(0, |words, byte| words << 8 | u128::from(*byte))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn each_bit_and_the_length_of_a_packet_count() {
        let hasher = PacketHasher::default();
        let mut packets = HashSet::new();
        for length in 0..=MAX_PACKET {
            let mut packet = vec![0; length];
            packets.insert(hasher.hash(&packet));
            for bit in 0..8 * length {
                packet[bit / 8] ^= 1 << (bit % 8);
                packets.insert(hasher.hash(&packet));
                packet[bit / 8] = 0;
            }
        }
        assert_eq!(packets.len(), (0..=MAX_PACKET).map(|length| 8 * length + 1).sum());
    }

    #[test]
    fn tables_and_tags_are_filled_evenly() {
        let hasher = PacketHasher::default();
        let values: Vec<_> = (0..4096u32).map(|number| hasher.hash(&[number.to_le_bytes(); 10].concat())).collect();
        let distinct = |part: &dyn Fn(u64) -> u64| values.iter().map(|hash| part(*hash)).collect::<HashSet<_>>().len();
        // Of 256 places all are met by chance, and of 4096 all but one in e.
        assert_eq!(distinct(&|hash| hash & 0xFF), 256);
        assert!((2400..2800).contains(&distinct(&|hash| hash & 0xFFF)));
        assert!(distinct(&|hash| hash >> 32) > 4090);
    }

    #[test]
    fn hashers_have_different_keys() {
        assert_ne!(PacketHasher::default().hash(b"packet"), PacketHasher::default().hash(b"packet"));
    }
}
