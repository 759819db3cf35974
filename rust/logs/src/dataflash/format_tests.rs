use super::*;
use crate::dataflash::samples::Log;

fn apply(formats: &mut Formats, log: &mut Log) -> Outcome {
    let outcome = formats.define(&log.0, 0);
    log.0.clear();
    outcome
}

#[test]
fn a_definition_has_the_content_of_its_fmt() {
    let (mut formats, mut log) = (Formats::default(), Log::default());
    log.define(7, "ATT", "Qcc", "TimeUS,Roll,Pitch", 15);
    assert_eq!(apply(&mut formats, &mut log), Outcome::Defined(Redefinition { position: 0, kind: 7, slot: 1 }));
    let expected = Definition {
        name: b"ATT".to_vec(),
        format: b"Qcc".to_vec(),
        labels: b"TimeUS,Roll,Pitch".to_vec(),
        length: 15,
    };
    assert_eq!(formats.definitions()[1], expected);
    assert_eq!((formats.types.slot(7), formats.types.length(7)), (1, 15));
}

#[test]
fn names_may_fill_their_field_without_nul() {
    let (mut formats, mut log) = (Formats::default(), Log::default());
    log.define(7, "XKF1", "QBccCfffffffccce", &"x".repeat(64), 60);
    apply(&mut formats, &mut log);
    let definition = &formats.definitions()[1];
    assert_eq!((definition.name.len(), definition.format.len(), definition.labels.len()), (4, 16, 64));
}

#[test]
fn equal_definitions_share_a_slot() {
    let (mut formats, mut log) = (Formats::default(), Log::default());
    let outcomes = [(7, "A"), (7, "A"), (8, "A"), (7, "B"), (7, "A")].map(|(kind, name)| {
        log.define(kind, name, "Q", "TimeUS", 11);
        apply(&mut formats, &mut log)
    });
    let slots = outcomes.map(|outcome| match outcome {
        Outcome::Defined(redefinition) => Some(redefinition.slot),
        _ => None,
    });
    assert_eq!(slots, [Some(1), None, Some(1), Some(2), Some(1)]);
    assert_eq!(outcomes[1], Outcome::Repeated);
}

#[test]
fn senseless_definitions_are_rejected() {
    let (mut formats, mut log) = (Formats::default(), Log::default());
    for (kind, name, format, length) in
        [(7, "", "Q", 11), (7, "A\u{1}", "Q", 11), (7, "A", "Q\u{7f}", 11), (7, "A", "Q", 2), (0x80, "FMT", "B", 4)]
    {
        log.define(kind, name, format, "TimeUS", length);
        assert_eq!(apply(&mut formats, &mut log), Outcome::Rejected);
    }
    assert_eq!(formats.define(&[0xA3, 0x95, 0x80, 1], 0), Outcome::Rejected);
    assert_eq!(formats, Formats::default());
}

#[test]
fn the_number_of_definitions_is_limited() {
    let (mut formats, mut log) = (Formats::default(), Log::default());
    for number in 0..5000 {
        log.define(7, "A", "Q", &format!("F{number}"), 11);
        apply(&mut formats, &mut log);
    }
    assert_eq!(formats.definitions().len(), MAX_DEFINITIONS);
}
