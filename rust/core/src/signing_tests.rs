use super::*;
use crate::encode::{Sender, Version, encode};
use crate::layout::tests::dialect;
use crate::parser::Parser;

const SECOND: u64 = UNITS_PER_SECOND;
const NOW: u64 = 1_000_000 * SECOND;

fn key() -> Key {
    Key::new([7; 32])
}

fn signing(policy: Policy) -> Signing {
    Signing::new(key(), 3, NOW, policy)
}

fn packet_at(timestamp: u64) -> Vec<u8> {
    let mut out = Vec::new();
    let mut signer = Signing::new(key(), 9, timestamp - 1, Policy::default());
    let sender = Sender { system: 1, component: 1, sequence: 0 };
    let dialect = dialect();
    encode(&mut out, Version::V2, &dialect.layouts()[0], &[2; 9], sender, Some((&mut signer, None))).expect("encodes");
    out
}

fn check(signing: &mut Signing, raw: &[u8]) -> Result<(), Refusal> {
    check_at(signing, raw, NOW)
}

fn check_at(signing: &mut Signing, raw: &[u8], now: u64) -> Result<(), Refusal> {
    let mut verdict = None;
    Parser::default().feed(&dialect(), raw, |packet| verdict = Some(signing.check(&packet, Some(now))));
    verdict.expect("a packet")
}

fn forged(timestamp: u64) -> Vec<u8> {
    let mut raw = packet_at(timestamp);
    let last = raw.len() - 1;
    raw[last] ^= 1;
    raw
}

#[test]
fn a_replay_is_refused() {
    let mut signing = signing(Policy::default());
    assert_eq!(check(&mut signing, &packet_at(NOW)), Ok(()));
    assert_eq!(check(&mut signing, &packet_at(NOW)), Err(Refusal::Replayed));
    assert_eq!(check(&mut signing, &packet_at(NOW - 1)), Err(Refusal::Replayed));
    assert_eq!(check(&mut signing, &packet_at(NOW + 1)), Ok(()));
    assert_eq!(signing.refusals().replayed, 2);
}

#[test]
fn a_forged_packet_from_the_far_future_does_not_block_its_stream() {
    let mut signing = signing(Policy::default());
    assert_eq!(check(&mut signing, &packet_at(NOW)), Ok(()));
    assert_eq!(check(&mut signing, &forged(MAX_TIMESTAMP)), Err(Refusal::Forged));
    assert_eq!(check(&mut signing, &packet_at(NOW + 1)), Ok(()));
    assert_eq!(signing.clock(), NOW + 1, "the clock does not move");
}

#[test]
fn a_valid_packet_from_the_far_future_is_refused() {
    let mut signing = signing(Policy::default());
    assert_eq!(check(&mut signing, &packet_at(MAX_TIMESTAMP)), Err(Refusal::Future));
    assert_eq!(check(&mut signing, &packet_at(NOW)), Ok(()));
    assert_eq!(signing.clock(), NOW);
}

#[test]
fn a_new_stream_may_begin_up_to_a_minute_behind_the_clock() {
    let mut late = signing(Policy::default());
    assert_eq!(check(&mut late, &packet_at(NOW - 6_000_001)), Err(Refusal::Stale));
    assert_eq!(check(&mut late, &packet_at(NOW - 6_000_000)), Ok(()));
}

#[test]
fn a_forged_packet_creates_no_stream() {
    let mut signing = signing(Policy::default());
    assert_eq!(check(&mut signing, &forged(NOW)), Err(Refusal::Forged));
    assert_eq!(signing.streams(), 0);
}

#[test]
fn the_table_of_streams_is_bounded() {
    let mut signing = signing(Policy { max_streams: 0, ..Policy::default() });
    assert_eq!(check(&mut signing, &packet_at(NOW)), Err(Refusal::TooManyStreams));
}

#[test]
fn unsigned_packets_are_refused_unless_allowed() {
    let raw = crate::scan::tests::heartbeat(Version::V2, 0);
    let version_1 = crate::scan::tests::heartbeat(Version::V1, 0);
    assert_eq!(check(&mut signing(Policy::default()), &raw), Err(Refusal::Unsigned));
    assert_eq!(check(&mut signing(Policy::default()), &version_1), Err(Refusal::Unsigned), "no downgrade");
    let allowed = Policy { unsigned_ids: vec![0], ..Policy::default() };
    assert_eq!(check(&mut signing(allowed), &raw), Ok(()));
    let open = Policy { accept_unsigned: true, ..Policy::default() };
    assert_eq!(check(&mut signing(open), &raw), Ok(()));
}

#[test]
fn reorder_slack_accepts_reordered_packets_and_no_replays() {
    let mut strict = signing(Policy::default());
    let mut slack = signing(Policy { reorder_slack: 10, ..Policy::default() });
    for signing in [&mut strict, &mut slack] {
        assert_eq!(check(signing, &packet_at(NOW + 5)), Ok(()));
    }
    assert_eq!(check(&mut strict, &packet_at(NOW + 3)), Err(Refusal::Replayed));
    assert_eq!(check(&mut slack, &packet_at(NOW + 3)), Ok(()));
    assert_eq!(check(&mut slack, &packet_at(NOW + 3)), Err(Refusal::Replayed));
    assert_eq!(check(&mut slack, &packet_at(NOW + 5)), Err(Refusal::Replayed));
    assert_eq!(check(&mut slack, &packet_at(NOW - 6)), Err(Refusal::Replayed), "older than the slack");
}

#[test]
fn reorder_slack_accepts_no_replays_when_its_list_is_full() {
    let mut signing = signing(Policy { reorder_slack: SECOND, ..Policy::default() });
    for step in (0..2 * MAX_RECENT as u64).map(|step| step * 2) {
        assert_eq!(check(&mut signing, &packet_at(NOW + step)), Ok(()));
    }
    assert_eq!(check(&mut signing, &packet_at(NOW + 2)), Err(Refusal::Replayed), "no longer in the list, so refused");
    assert_eq!(check(&mut signing, &packet_at(NOW + 1001)), Ok(()), "within the list and not accepted before");
}

#[test]
fn the_clock_only_moves_forward_when_signing() {
    let mut signer = signing(Policy::default());
    let (mut first, mut second) = (vec![0xFD; 12], vec![0xFD; 12]);
    signer.sign(&mut first, Some(NOW + 50)).expect("signs");
    signer.sign(&mut second, Some(NOW)).expect("signs");
    assert_eq!(link_and_timestamp(&first), (3, NOW + 50));
    assert_eq!(link_and_timestamp(&second), (3, NOW + 51));
}

#[test]
fn the_first_packet_sets_an_unset_clock() {
    let mut signing = Signing::new(key(), 0, 0, Policy::default());
    let mut verdict = None;
    Parser::default().feed(&dialect(), &packet_at(NOW * 5), |packet| verdict = Some(signing.check(&packet, None)));
    assert_eq!(verdict, Some(Ok(())));
    assert_eq!(signing.clock(), NOW * 5);
}

#[test]
fn keys_are_not_printed() {
    assert_eq!(format!("{:?}", Key::new([0x41; 32])), "Key(…)");
}

#[test]
fn the_clock_cannot_be_advanced_step_by_step() {
    let mut signing = signing(Policy::default());
    let day = 24 * 3600 * SECOND;
    assert_eq!(check(&mut signing, &packet_at(NOW + day)), Ok(()));
    assert_eq!(check(&mut signing, &packet_at(NOW + 2 * day)), Err(Refusal::Future));
    assert_eq!(signing.clock(), NOW + day);
}

#[test]
fn a_clock_at_its_last_timestamp_cannot_sign() {
    let mut signer = Signing::new(key(), 0, MAX_TIMESTAMP - 1, Policy::default());
    let mut packet = vec![0xFD; 12];
    assert_eq!(signer.sign(&mut packet, None), Ok(()));
    assert_eq!(signer.sign(&mut packet, None), Err(ClockExhausted));
}

#[test]
fn a_packet_accepted_on_one_link_is_a_replay_on_all_links_of_its_key() {
    let mut first = signing(Policy::default());
    let mut second = first.for_link(4);
    assert_eq!(check(&mut first, &packet_at(NOW)), Ok(()));
    assert_eq!(check(&mut second, &packet_at(NOW)), Err(Refusal::Replayed));
    drop(first);
    assert_eq!(check(&mut second.for_link(5), &packet_at(NOW)), Err(Refusal::Replayed), "the first link is gone");
    assert_eq!(second.refusals().replayed, 1, "refusals are counted per link");
}

#[test]
fn links_of_one_key_never_sign_with_one_timestamp() {
    let mut first = signing(Policy::default());
    let mut second = first.for_link(4);
    let (mut one, mut other) = (vec![0xFD; 12], vec![0xFD; 12]);
    first.sign(&mut one, Some(NOW + 50)).expect("signs");
    second.sign(&mut other, Some(NOW + 50)).expect("signs");
    assert_eq!((link_and_timestamp(&one), link_and_timestamp(&other)), ((3, NOW + 50), (4, NOW + 51)));
}

#[test]
fn restored_streams_refuse_what_the_last_run_accepted() {
    for reorder_slack in [0, SECOND] {
        let policy = Policy { reorder_slack, ..Policy::default() };
        let mut last_run = signing(policy.clone());
        assert_eq!(check(&mut last_run, &packet_at(NOW)), Ok(()));
        let mut next_run = Signing::new(key(), 0, last_run.clock(), policy);
        next_run.restore(last_run.newest(), 0);
        assert_eq!(check(&mut next_run, &packet_at(NOW)), Err(Refusal::Replayed));
        assert_eq!(check(&mut next_run, &packet_at(NOW - 1)), Err(Refusal::Replayed));
        assert_eq!(check(&mut next_run, &packet_at(NOW + 1)), Ok(()));
    }
}

#[test]
fn a_floor_refuses_older_packets_in_every_stream() {
    let mut signing = signing(Policy::default());
    signing.restore([((9, 1, 1), NOW - 5)], NOW);
    assert_eq!(check(&mut signing, &packet_at(NOW)), Err(Refusal::Replayed), "a restored stream");
    let mut other = self::signing(Policy::default());
    other.restore([], NOW);
    assert_eq!(check(&mut other, &packet_at(NOW)), Err(Refusal::Stale), "a new stream");
    assert_eq!(check(&mut other, &packet_at(NOW + 1)), Ok(()));
}

#[test]
fn a_full_table_forgets_streams_whose_packets_would_be_stale() {
    let mut signing = signing(Policy { max_streams: 2, ..Policy::default() });
    let old = NOW - 61 * SECOND;
    signing.restore([((1, 1, 1), old), ((2, 1, 1), NOW)], 0);
    assert_eq!(check(&mut signing, &packet_at(NOW)), Ok(()));
    assert_eq!(signing.newest(), [((2, 1, 1), NOW), ((9, 1, 1), NOW)]);
}

#[test]
fn without_a_current_time_the_lead_is_still_limited() {
    let mut signing = Signing::new(key(), 0, 0, Policy::default());
    let mut verdicts = Vec::new();
    for timestamp in [NOW + 2 * 24 * 3600 * SECOND, NOW - 5 * 24 * 3600 * SECOND] {
        Parser::default().feed(&dialect(), &packet_at(timestamp), |packet| {
            verdicts.push(signing.check_with_limit(&packet, None, Some(NOW)));
        });
    }
    assert_eq!(verdicts, [Err(Refusal::Future), Ok(())]);
}
