//! Ranges of addresses and ports.

use std::net::{IpAddr, SocketAddr};

/// Addresses and ports of which peers are accepted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PeerRange {
    pub network: IpAddr,
    /// Bits of the network that count.
    pub prefix: u8,
    pub ports: std::ops::RangeInclusive<u16>,
}

impl PeerRange {
    /// Returns whether the range contains an address.
    #[must_use]
    pub fn contains(&self, address: &SocketAddr) -> bool {
        let bits = |value: IpAddr| match value.to_canonical() {
            IpAddr::V4(v4) => (32, u128::from(u32::from(v4))),
            IpAddr::V6(v6) => (128, u128::from(v6)),
        };
        let ((width, network), (other_width, other)) = (bits(self.network), bits(address.ip()));
        let ignored = width - u32::from(self.prefix).min(width);
        let is_inside = width == other_width && (network ^ other).checked_shr(ignored).unwrap_or(0) == 0;
        is_inside && self.ports.contains(&address.port())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_contain_addresses_of_their_network_and_ports() {
        let range = PeerRange { network: "10.1.0.0".parse().expect("valid"), prefix: 16, ports: 14_550..=14_560 };
        let contains = |address: &str| range.contains(&address.parse().expect("valid"));
        assert!(contains("10.1.200.3:14550") && contains("[::ffff:10.1.2.3]:14560"));
        assert!(!contains("10.2.0.1:14550") && !contains("10.1.0.1:14561") && !contains("[::1]:14550"));
        let all = PeerRange { network: "0.0.0.0".parse().expect("valid"), prefix: 0, ports: 0..=u16::MAX };
        assert!(all.contains(&"203.0.113.9:1".parse().expect("valid")));
    }
}
