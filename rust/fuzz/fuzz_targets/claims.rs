//! The table of claims never panics and stays bounded; nothing unauthenticated takes an address from an authenticated
//! sender, and packets are led only to senders that are known.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mavstack_core::claims::{Authority, Claims, Contradiction, MAX_ADDRESSES, MAX_CLAIMS, Paths, Standing};

const SENDERS: usize = 12;

/// Senders of three places, of which the first two places are one group of redundant links.
struct Network;

impl Paths for Network {
    fn place(&self, sender: usize) -> usize {
        sender % 3
    }

    fn shares_group(&self, one: usize, other: usize) -> bool {
        one % 3 < 2 && other % 3 < 2
    }
}

fn authority(choice: u8) -> Authority {
    match choice % 8 {
        0..=3 => Authority::None,
        4 => Authority::Session,
        5 => Authority::Ticket,
        6 => Authority::Certificate,
        _ => Authority::Key,
    }
}

fuzz_target!(|data: &[u8]| {
    let mut claims = Claims::default();
    let mut now = 0_u64;
    for step in data.chunks_exact(6) {
        let &[action, sender, system, component, detail, pause] = step else { return };
        let (sender, address) = (usize::from(sender) % SENDERS, (system, component));
        now += u64::from(pause).pow(3) * 5;
        match action % 8 {
            0..=3 => {
                let (before, authority) = (claims.holder(system, component).cloned(), authority(detail));
                let standing = claims.hear(address, sender, authority, now, &Network);
                if let Some(before) = before.filter(|before| before.authority.is_authenticated()) {
                    let is_held = claims.holder(system, component).is_some_and(|holder| holder.sender == before.sender);
                    assert!(authority.is_authenticated() || is_held, "an address was taken without proof");
                    let is_own = before.sender == sender || authority.is_authenticated();
                    assert!(is_own || !matches!(standing, Standing::Held | Standing::New));
                }
            }
            4 => claims.note_ground_station(address, sender, detail & 1 == 1),
            5 => drop(claims.note_boot_time(address, sender, u32::from(detail) * 1000, now)),
            6 => drop(claims.contradict(address, sender, Contradiction::Sender, now)),
            _ => match detail % 3 {
                0 => claims.remove(sender),
                1 => claims.withdraw(sender),
                _ => drop(claims.end_conflicts(now)),
            },
        }
        assert_eq!(claims.claims_on(0, component).count(), 0, "system 0 was claimed");
        assert!(claims.claims_on(system, component).count() <= MAX_CLAIMS);
        if let Some(routes) = claims.routes(system, component) {
            assert!(routes.iter().all(|sender| sender < SENDERS));
        }
    }
    assert!(claims.addresses().len() <= MAX_ADDRESSES);
});
