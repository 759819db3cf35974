use super::*;
use crate::tests::{command, dialect, heartbeat, parse};
use mavstack_core::encode::{Sender, Version, encode};
use mavstack_core::signing::{Key, Policy};

const NOW: u64 = 1_000_000;

fn signing(key: u8) -> Signing {
    Signing::new(Key::new([key; 32]), 3, 0, Policy::default())
}

fn rewritten(raw: &[u8], mut signing: Option<Signing>) -> Option<Vec<u8>> {
    let mut out = Vec::new();
    parse(&dialect(), raw, |packet| rewrite(&mut out, packet, signing.as_mut(), NOW)).then_some(out)
}

#[test]
fn signing_and_stripping_restore_the_packet() {
    let plain = command((1, 1), (255, 190, 7));
    let signed = rewritten(&plain, Some(signing(1))).expect("signed");
    assert_eq!(signed.len(), plain.len() + 13);
    assert_eq!(parse(&dialect(), &signed, |packet| signing(1).check(packet, Some(NOW))), Ok(()));
    assert_eq!(rewritten(&signed, None), Some(plain.clone()));
    assert_eq!(rewritten(&plain, None), None, "nothing to strip");
    let again = rewritten(&signed, Some(signing(2))).expect("signed with another key");
    assert_eq!(parse(&dialect(), &again, |packet| signing(2).check(packet, Some(NOW))), Ok(()));
}

#[test]
fn a_version_1_packet_becomes_version_2_where_it_is_signed() {
    let (dialect, mut raw) = (dialect(), Vec::new());
    let (layout, sender) = (dialect.layout(0).expect("HEARTBEAT"), Sender { system: 1, component: 1, sequence: 5 });
    encode(&mut raw, Version::V1, layout, &[0, 0, 0, 0, 2, 3, 81, 3, 3], sender, None).expect("fits");
    let signed = rewritten(&raw, Some(signing(1))).expect("signed");
    assert_eq!(rewritten(&signed, None), Some(heartbeat((1, 1, 5))));
}

#[test]
fn only_verified_packets_teach_where_packets_are_verified() {
    let mut gateway =
        Gateway { incoming: Some(signing(1)), allow_unsigned: vec![0], strip: true, ..Gateway::default() };
    let mut admit = |raw: &[u8]| parse(&dialect(), raw, |packet| gateway.admit(packet, NOW));
    assert_eq!(admit(&command((1, 1), (255, 190, 0))), Err(Refusal::Unsigned));
    assert_eq!(admit(&heartbeat((1, 1, 0))), Ok(Admission::default()));
    let signed = rewritten(&heartbeat((1, 1, 0)), Some(signing(1))).expect("signed");
    assert_eq!(admit(&signed), Ok(Admission { verified: true, strip: true, teaches: true }));
    let forged = rewritten(&heartbeat((1, 1, 0)), Some(signing(9))).expect("signed");
    assert_eq!(admit(&forged), Err(Refusal::Forged));
    assert!(Gateway::default().admit(&parse_any(), NOW).is_ok_and(|admission| admission.teaches));
}

fn parse_any() -> Packet<'static> {
    let raw: &'static [u8] = Box::leak(heartbeat((1, 1, 0)).into_boxed_slice());
    let header = mavstack_core::header::Header::parse(raw).expect("a header");
    Packet { raw, header, slot: Some(0), timestamp: None }
}
