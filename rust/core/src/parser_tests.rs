use super::*;
use crate::encode::Version;
use crate::layout::tests::dialect;
use crate::scan::tests::{heartbeat, signed_heartbeat};
use proptest::prelude::*;

type Seen = (Vec<u8>, Option<u64>);

fn parse(chunks: &[&[u8]], timestamped: bool) -> (Vec<Seen>, Statistics) {
    let dialect = dialect();
    let mut parser = Parser::new(timestamped);
    let mut seen = Vec::new();
    for chunk in chunks {
        parser.feed(&dialect, chunk, |packet| seen.push((packet.raw.to_vec(), packet.timestamp)));
    }
    parser.flush(&dialect, |packet| seen.push((packet.raw.to_vec(), packet.timestamp)));
    assert_eq!(parser.pending(), 0);
    (seen, *parser.statistics())
}

/// Pieces of a stream: packets of both versions, with or without a time, and garbage rich in magics.
pub(crate) fn piece() -> impl Strategy<Value = Vec<u8>> {
    let stamp = prop::option::of(1_600_000_000_000_000u64..1_800_000_000_000_000);
    prop_oneof![
        3 => (any::<bool>(), any::<u8>(), stamp).prop_map(|(v1, sequence, stamp)| {
            let mut bytes = stamp.map_or(vec![], |stamp| stamp.to_be_bytes().to_vec());
            bytes.extend(heartbeat(if v1 { Version::V1 } else { Version::V2 }, sequence));
            bytes
        }),
        2 => (any::<u8>(), 0usize..14).prop_map(|(sequence, missing)| {
            let mut bytes = signed_heartbeat(sequence);
            bytes.truncate(bytes.len() - missing);
            bytes
        }),
        2 => prop::collection::vec(prop_oneof![Just(0xFDu8), Just(0xFE), Just(0), Just(1), any::<u8>()], 0..40),
    ]
}

#[test]
fn a_packet_that_is_all_of_a_chunk_counts_for_its_source_as_one_in_parts() {
    let dialect = dialect();
    let packets =
        [0, 1, 4, 5].map(|sequence| heartbeat(if sequence < 4 { Version::V2 } else { Version::V1 }, sequence));
    let (mut whole, mut divided) = (Parser::new(false), Parser::new(false));
    let mut seen = 0;
    for packet in &packets {
        whole.feed(&dialect, packet, |_| seen += 1);
        let (head, tail) = packet.split_at(5);
        divided.feed(&dialect, head, |_| seen += 1);
        divided.feed(&dialect, tail, |_| seen += 1);
    }
    assert_eq!((seen, whole.statistics()), (8, divided.statistics()));
    let source = whole.sources().all()[0].2;
    assert_eq!((source.received, source.lost, whole.sources().all()), (4, 2, divided.sources().all()));
}

proptest! {
    #[test]
    fn chunking_does_not_change_the_result(
        pieces in prop::collection::vec(piece(), 0..20),
        cuts in prop::collection::vec(0usize..2000, 0..12),
        timestamped: bool,
    ) {
        let stream = pieces.concat();
        let mut cuts: Vec<usize> = cuts.into_iter().map(|cut| cut.min(stream.len())).collect();
        cuts.extend([0, stream.len()]);
        cuts.sort_unstable();
        let chunks: Vec<&[u8]> = cuts.windows(2).map(|pair| &stream[pair[0]..pair[1]]).collect();
        let whole = parse(&[&stream], timestamped);
        prop_assert_eq!(&parse(&chunks, timestamped), &whole);
        let bytes: Vec<&[u8]> = stream.chunks(1).collect();
        prop_assert_eq!(&parse(&bytes, timestamped), &whole);
        let datagrams: Vec<&[u8]> = pieces.iter().map(Vec::as_slice).collect();
        prop_assert_eq!(&parse(&datagrams, timestamped), &whole);
    }

    #[test]
    fn every_byte_is_counted(pieces in prop::collection::vec(piece(), 0..20)) {
        let stream = pieces.concat();
        let (seen, statistics) = parse(&[&stream], false);
        let packets: usize = seen.iter().map(|(raw, _)| raw.len()).sum();
        prop_assert!(packets as u64 >= statistics.packet_bytes, "an incomplete signature shares bytes with the next");
        prop_assert_eq!(statistics.packet_bytes + statistics.bad_bytes, stream.len() as u64);
    }

    #[test]
    fn garbage_hides_only_the_span_of_one_false_magic(
        garbage in prop::collection::vec(prop_oneof![Just(0xFDu8), Just(0xFE), any::<u8>()], 0..300),
    ) {
        // The last false magic may span at most 280 bytes, fourteen heartbeats: all later ones must be found.
        let mut stream = garbage;
        for sequence in 0..40 {
            stream.extend(heartbeat(Version::V2, sequence));
        }
        let (seen, _) = parse(&[&stream], false);
        let expected = heartbeat(Version::V2, 15);
        prop_assert!(seen.iter().any(|(raw, _)| *raw == expected));
    }
}
