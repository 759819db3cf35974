//! The hash of the addresses of peers: a few multiplications, since one is looked up for each datagram.
//!
//! Its key is random, and a socket has a bounded number of peers, so that invented addresses do not slow it down.

use std::hash::{BuildHasher, Hasher, RandomState};

/// An odd number with as many ones as zeros.
const MULTIPLIER: u64 = 0x9E37_79B9_7F4A_7C15;

/// Hashes addresses with one random key.
#[derive(Clone, Debug)]
pub struct PeerHashers(u64);

impl Default for PeerHashers {
    fn default() -> Self {
        Self(RandomState::new().hash_one(()))
    }
}

impl BuildHasher for PeerHashers {
    type Hasher = PeerHasher;

    fn build_hasher(&self) -> PeerHasher {
        PeerHasher(self.0)
    }
}

/// Hashes one address.
#[derive(Debug)]
pub struct PeerHasher(u64);

impl PeerHasher {
    /// Both halves of the product count: the lower bits of a product depend on the lower bits of its factors alone.
    #[inline]
    fn add(&mut self, word: u64) {
        let product = u128::from(self.0 ^ word) * u128::from(MULTIPLIER);
        self.0 = product as u64 ^ (product >> 64) as u64;
    }
}

impl Hasher for PeerHasher {
    #[inline]
    fn finish(&self) -> u64 {
        self.0
    }

    #[inline]
    fn write(&mut self, bytes: &[u8]) {
        for chunk in bytes.chunks(8) {
            let mut word = [0; 8];
            word[..chunk.len()].copy_from_slice(chunk);
            self.add(u64::from_le_bytes(word));
        }
    }

    #[inline]
    fn write_u16(&mut self, number: u16) {
        self.add(number.into());
    }

    #[inline]
    fn write_u32(&mut self, number: u32) {
        self.add(number.into());
    }

    #[inline]
    fn write_usize(&mut self, number: usize) {
        self.add(number as u64);
    }

    #[inline]
    fn write_isize(&mut self, number: isize) {
        self.add(number as u64);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;
    use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr};

    #[test]
    fn addresses_of_a_network_and_ports_of_a_host_have_different_hashes() {
        let hashers = PeerHashers::default();
        let hosts = (0..=255).map(|host| SocketAddr::from((Ipv4Addr::new(10, 0, 0, host), 14550)));
        let v6 = (0..=255).map(|host| SocketAddr::from((Ipv6Addr::new(0xFE80, 0, 0, 0, 0, 0, 0, host), 14550)));
        let ports = (1..=u16::MAX).map(|port| SocketAddr::from(([127, 0, 0, 1], port)));
        let all: Vec<_> = hosts.chain(v6).chain(ports).map(|address| hashers.hash_one(address)).collect();
        let distinct = |part: &dyn Fn(u64) -> u64| all.iter().map(|hash| part(*hash)).collect::<HashSet<_>>().len();
        assert!(distinct(&|hash| hash) > all.len() - 8);
        assert_eq!((distinct(&|hash| hash & 0xFF), distinct(&|hash| hash >> 57)), (256, 128));
    }

    #[test]
    fn sockets_have_different_keys() {
        let address = SocketAddr::from(([127, 0, 0, 1], 14550));
        assert_ne!(PeerHashers::default().hash_one(address), PeerHashers::default().hash_one(address));
    }
}
