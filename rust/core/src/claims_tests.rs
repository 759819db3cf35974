use super::*;
use proptest::prelude::*;

const A: usize = 0;
const B: usize = 1;
const C: usize = 2;
const VEHICLE: (u8, u8) = (1, 1);
const SECOND: u64 = 1_000_000;
const NONE: Authority = Authority::None;
const KEY: Authority = Authority::Key;

/// Senders of a place each; those with a group are redundant links.
#[derive(Default)]
struct Links {
    groups: Vec<usize>,
    places: Vec<usize>,
}

impl Paths for Links {
    fn place(&self, sender: usize) -> usize {
        self.places.get(sender).copied().unwrap_or(sender)
    }

    fn shares_group(&self, one: usize, other: usize) -> bool {
        let group = |sender: usize| self.groups.get(sender).copied().unwrap_or(0);
        group(one) != 0 && group(one) == group(other)
    }
}

/// A table with its clock, in seconds.
#[derive(Default)]
struct Table {
    claims: Claims,
    links: Links,
}

impl Table {
    fn hear(&mut self, sender: usize, authority: Authority, second: f64) -> Standing {
        self.claims.hear(VEHICLE, sender, authority, (second * 1e6) as u64, &self.links)
    }

    fn routes(&self) -> Vec<usize> {
        self.claims.routes(1, 1).map_or_else(Vec::new, |routes| routes.iter().collect())
    }
}

#[test]
fn an_address_is_reached_over_its_first_sender_and_a_contested_claim_leads_nowhere() {
    let mut table = Table::default();
    assert_eq!(table.hear(A, NONE, 0.0), Standing::New);
    assert_eq!(table.hear(B, NONE, 1.0), Standing::Contested);
    assert_eq!((table.hear(A, NONE, 2.0), table.routes()), (Standing::Held, vec![A]));
    for half in 4..40 {
        assert_eq!(table.hear(A, NONE, f64::from(half) / 2.0), Standing::Held);
        assert_eq!(table.hear(B, NONE, f64::from(half) / 2.0 + 0.1), Standing::Contested);
    }
    assert_eq!(table.routes(), [A]);
    assert_eq!(table.claims.routes(1, 0).map(|routes| routes.iter().collect()), Some(vec![A]));
    assert_eq!(table.claims.routes(1, 99), table.claims.routes(1, 0), "an unknown component");
    assert_eq!(table.claims.routes(2, 1), None);
}

#[test]
fn a_silent_sender_is_replaced_without_losing_its_route_and_comes_back() {
    let mut table = Table::default();
    table.hear(A, NONE, 0.0);
    assert_eq!(table.hear(B, NONE, 2.4), Standing::Contested);
    assert_eq!((table.hear(B, NONE, 2.6), table.routes()), (Standing::Held, vec![A, B]));
    assert_eq!((table.hear(A, NONE, 3.0), table.routes()), (Standing::Held, vec![A]));
    assert_eq!(table.hear(B, NONE, 3.1), Standing::Contested);
    assert_eq!((table.hear(B, NONE, 63.0), table.routes()), (Standing::Held, vec![A, B]));
    assert_eq!(table.hear(B, NONE, 64.0), Standing::Held);
    assert_eq!(table.hear(A, NONE, 64.1), Standing::Contested, "after so long a silence it comes last");
    assert_eq!(table.routes(), [B]);
}

#[test]
fn an_unproven_packet_of_a_proven_sender_takes_no_address_from_another_one() {
    let mut table = Table::default();
    table.hear(A, Authority::Session, 0.0);
    assert_eq!(table.hear(B, Authority::Certificate, 1.0), Standing::Contested);
    for second in [4.0, 70.0, 200.0] {
        assert_eq!((table.hear(B, NONE, second), table.routes()), (Standing::Contested, vec![A]));
    }
    assert_eq!((table.hear(B, Authority::Certificate, 201.0), table.routes()), (Standing::Held, vec![A, B]));
}

#[test]
fn an_authenticated_claim_outranks_others_however_late_and_silent_it_is() {
    let mut table = Table::default();
    table.hear(A, NONE, 0.0);
    assert_eq!((table.hear(B, KEY, 0.5), table.routes()), (Standing::Held, vec![B]));
    assert_eq!(table.hear(A, NONE, 1000.0), Standing::Outranked);
    assert_eq!(table.hear(B, NONE, 1001.0), Standing::Held, "an unsigned packet that its link accepts");
    assert!(!table.claims.contradict(VEHICLE, A, Contradiction::Position, 1001 * SECOND));
    assert_eq!(table.hear(C, KEY, 1001.0), Standing::Shared, "another link with the key");
    assert_eq!(table.routes(), [B, C]);
    table.claims.withdraw(B);
    assert_eq!(table.routes(), [C]);
    table.claims.withdraw(C);
    assert_eq!(table.hear(C, NONE, 1002.0), Standing::Held);
    assert_eq!(table.hear(A, NONE, 1002.1), Standing::Contested, "a refused claim gained no place");
}

#[test]
fn identities_that_differ_share_nothing() {
    let mut table = Table::default();
    table.hear(A, Authority::Certificate, 0.0);
    assert_eq!(table.hear(B, Authority::Ticket, 0.1), Standing::Contested);
    assert_eq!(table.routes(), [A]);
}

#[test]
fn links_of_a_group_share_an_address_but_not_with_another_peer_of_their_socket() {
    let mut table = Table { links: Links { groups: vec![1, 1, 1], places: vec![7, 8, 7] }, ..Table::default() };
    table.hear(A, NONE, 0.0);
    assert_eq!(table.hear(B, NONE, 0.1), Standing::Shared);
    assert_eq!(table.hear(C, NONE, 0.2), Standing::Contested, "a stranger on the socket of A");
    assert_eq!(table.routes(), [A, B]);
    for second in 1..9 {
        table.hear(B, NONE, f64::from(second));
        assert_eq!(table.hear(C, NONE, f64::from(second)), Standing::Contested, "B is heard while A is silent");
    }
    table.claims.remove(A);
    assert_eq!(table.routes(), [B]);
    assert_eq!((table.hear(C, NONE, 9.0), table.routes()), (Standing::Shared, vec![B, C]), "the socket has one peer");
}

#[test]
fn ground_stations_share_their_address() {
    let mut table = Table::default();
    table.hear(A, NONE, 0.0);
    table.claims.note_ground_station(VEHICLE, A, true);
    assert_eq!(table.hear(B, NONE, 0.1), Standing::Contested);
    table.claims.note_ground_station(VEHICLE, B, true);
    assert_eq!(table.routes(), [A, B], "from its first heartbeat on");
    assert_eq!((table.hear(B, NONE, 0.2), table.routes()), (Standing::Shared, vec![A, B]));
    table.claims.note_ground_station(VEHICLE, A, false);
    assert_eq!((table.hear(B, NONE, 0.3), table.routes()), (Standing::Contested, vec![A]));
}

#[test]
fn a_boot_clock_that_agrees_is_no_conflict_and_no_route() {
    let mut table = Table::default();
    table.hear(A, NONE, 0.0);
    assert_eq!(table.claims.note_boot_time(VEHICLE, A, 90_000, 0), BootClock::Agrees);
    table.hear(B, NONE, 1.0);
    assert_eq!(table.claims.note_boot_time(VEHICLE, B, 90_500, SECOND), BootClock::Agrees);
    assert_eq!((table.hear(B, NONE, 1.1), table.routes()), (Standing::Shared, vec![A]));
    assert_eq!(table.claims.note_boot_time(VEHICLE, B, 3_000, SECOND), BootClock::Differs, "not from the holder");
    assert_eq!(table.hear(B, NONE, 1.2), Standing::Contested);
    assert_eq!(table.claims.note_boot_time(VEHICLE, A, 89_000, SECOND), BootClock::Agrees, "overtaken");
}

#[test]
fn a_reboot_of_the_holder_leaves_it_alone() {
    let mut table = Table { links: Links { groups: vec![1, 1], places: vec![] }, ..Table::default() };
    table.hear(A, NONE, 0.0);
    table.hear(B, NONE, 0.0);
    table.claims.note_boot_time(VEHICLE, A, 90_000, 0);
    assert_eq!(table.claims.note_boot_time(VEHICLE, B, 3_000, SECOND), BootClock::Rebooted);
    assert_eq!(table.routes(), [B]);
    table.hear(A, NONE, 1.1);
    table.hear(B, NONE, 1.2);
    assert_eq!(table.routes(), [A, B]);
}

#[test]
fn conflicts_begin_once_and_end_after_a_time_without_contradictions() {
    let mut table = Table::default();
    table.hear(A, NONE, 0.0);
    table.hear(B, NONE, 0.0);
    let mut contradict = |kind, second: u64| table.claims.contradict(VEHICLE, B, kind, second * SECOND);
    assert!(contradict(Contradiction::Position, 1));
    assert!(!contradict(Contradiction::UniqueId, 20));
    let conflict = table.claims.conflict(1, 1).expect("a conflict");
    assert_eq!((conflict.began_at, &conflict.senders), (SECOND, &vec![A, B]));
    assert!(conflict.contradictions().eq([Contradiction::UniqueId, Contradiction::Position]));
    assert!(table.claims.end_conflicts(49 * SECOND).is_empty());
    assert_eq!(table.claims.end_conflicts(50 * SECOND), [VEHICLE]);
    assert_eq!(table.claims.conflict(1, 1), None);
}

#[test]
fn asking_for_a_standing_changes_nothing() {
    let mut table = Table::default();
    let ask = |table: &Table, sender, authority| table.claims.standing(VEHICLE, sender, authority, 1, &table.links);
    assert_eq!(ask(&table, A, NONE), Standing::New);
    table.hear(A, NONE, 0.0);
    assert_eq!((ask(&table, B, NONE), ask(&table, B, KEY)), (Standing::Contested, Standing::Held));
    assert_eq!((table.routes(), table.claims.claims_on(1, 1).count()), (vec![A], 1));
}

#[test]
fn the_table_is_bounded_and_keeps_what_was_heard_for_long_or_proven() {
    let (mut claims, links) = (Claims::default(), Links::default());
    claims.hear((1, 1), A, KEY, 0, &links);
    claims.hear((2, 1), B, NONE, 0, &links);
    claims.hear((2, 1), B, NONE, 2 * SECOND, &links);
    for forged in 0..=u16::MAX {
        let [system, component] = forged.to_be_bytes();
        claims.hear((system, component), C, NONE, 2 * SECOND + u64::from(forged), &links);
        assert!(claims.entries.len() <= MAX_ADDRESSES);
    }
    assert_eq!(claims.holder(1, 1).map(|claim| claim.sender), Some(A));
    assert_eq!(claims.holder(2, 1).map(|claim| claim.sender), Some(B));
}

#[test]
fn many_claims_on_an_address_displace_no_earlier_sender() {
    let mut table = Table::default();
    (0..5).for_each(|second| {
        table.hear(A, NONE, f64::from(second));
    });
    for step in 0..2_000u32 {
        table.hear(1 + step as usize % 200, NONE, 5.0 + f64::from(step) / 100.0);
        assert!(table.claims.claims_on(1, 1).count() <= MAX_CLAIMS);
    }
    assert_eq!((table.hear(A, NONE, 30.0), table.routes()), (Standing::Held, vec![A]));
}

fn party(host: u64, authority: Authority, opened_at: u64, heard_at: u64) -> Party {
    Party { place: 0, group: 0, host, authority, opened_at, heard_at }
}

#[test]
fn a_crowd_makes_room_first_and_a_proven_sender_never_for_another() {
    let mut roster = Roster::default();
    let proven = roster.open(party(1, KEY, 0, 0)).expect("room");
    let pilot = roster.open(party(2, NONE, 0, 9 * SECOND)).expect("room");
    let crowd: Vec<_> = (0..20).filter_map(|_| roster.open(party(3, NONE, 0, 9 * SECOND))).collect();
    let newcomer = party(4, NONE, 9 * SECOND, 9 * SECOND);
    assert_eq!(roster.first_to_evict(&newcomer, Some(0), 9 * SECOND), Some(crowd[0]));
    assert_eq!(roster.first_to_evict(&newcomer, Some(1), 9 * SECOND), None, "another place");
    assert_eq!(roster.first_to_evict(&party(3, NONE, 0, 0), None, 9 * SECOND), None, "one more of the crowd");
    assert!(crowd.iter().all(|&sender| roster.close(sender)));
    assert_eq!(roster.first_to_evict(&newcomer, None, 9 * SECOND), None, "the pilot is heard");
    assert_eq!(roster.first_to_evict(&newcomer, None, 20 * SECOND), Some(pilot));
    assert_eq!(roster.first_to_evict(&party(4, KEY, 0, 0), None, 9 * SECOND), Some(pilot));
    assert!(roster.close(pilot) && !roster.close(pilot));
    assert_eq!(roster.first_to_evict(&newcomer, None, 900 * SECOND), None);
    assert!(roster.get(proven).is_some());
}

proptest! {
    #[test]
    fn nothing_unauthenticated_costs_an_authenticated_sender_anything(
        steps in prop::collection::vec((1usize..6, 1u8..3, 0u64..4_000_000, 0u8..5), 0..300)
    ) {
        let links = Links { groups: vec![1, 1, 1, 0, 0, 0], places: vec![0, 1, 0, 0, 2, 3] };
        let (mut claims, mut now) = (Claims::default(), 0);
        claims.hear((1, 1), A, KEY, now, &links);
        for (sender, component, wait, kind) in steps {
            now += wait;
            let standing = claims.hear((1, component), sender, NONE, now, &links);
            if component == 1 {
                prop_assert_eq!(standing, Standing::Outranked);
            }
            match kind {
                0 => claims.note_ground_station((1, component), sender, true),
                1 => drop(claims.note_boot_time((1, component), sender, wait as u32, now)),
                2 => drop(claims.contradict((1, component), sender, Contradiction::Type, now)),
                3 => claims.remove(sender),
                _ => claims.withdraw(sender),
            }
            prop_assert_eq!(claims.routes(1, 1).map(|routes| routes.iter().collect()), Some(vec![A]));
            prop_assert_eq!(claims.routes(1, 0).map(|routes| routes.iter().collect()), Some(vec![A]));
            prop_assert!(claims.conflict(1, 1).is_none());
        }
    }

    #[test]
    fn routes_are_those_of_the_leading_claims_and_a_heard_holder_keeps_its_address(
        steps in prop::collection::vec((1usize..5, 0u64..3_000_000, 0u8..4), 0..300)
    ) {
        let links = Links::default();
        let (mut claims, mut now) = (Claims::default(), 0);
        claims.hear(VEHICLE, A, NONE, now, &links);
        for (sender, wait, kind) in steps {
            for _ in 0..wait / SECOND {
                now += SECOND;
                claims.hear(VEHICLE, A, NONE, now, &links);
            }
            now += wait % SECOND;
            claims.hear(VEHICLE, A, NONE, now, &links);
            claims.hear(VEHICLE, sender, NONE, now, &links);
            match kind {
                0 => drop(claims.note_boot_time(VEHICLE, sender, now as u32, now)),
                1 => claims.note_ground_station(VEHICLE, sender, true),
                2 => claims.remove(sender),
                _ => {}
            }
            let leading: Vec<_> = claims.claims_on(1, 1).filter(|claim| claim.leads).map(|claim| claim.sender).collect();
            prop_assert_eq!(&leading, &vec![A]);
            prop_assert_eq!(claims.routes(1, 1).map(|routes| routes.iter().collect()), Some(leading));
        }
    }
}
