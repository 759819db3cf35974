//! The parser finds the same packets for any division of a stream into chunks, counts every byte and never panics.
#![no_main]

use fuzz_dialect::{dialect, stream};
use libfuzzer_sys::fuzz_target;
use mavstack_core::layout::Dialect;
use mavstack_core::parser::Parser;
use mavstack_core::signing::{Key, Policy, Signing};

fn parse(stream: &[u8], chunk: usize, timestamped: bool, dialect: &Dialect) -> (Vec<(Vec<u8>, Option<u64>)>, u64) {
    let mut parser = Parser::new(timestamped);
    let mut signing = Signing::new(Key::new([1; 32]), 0, 0, Policy { reorder_slack: 9, ..Policy::default() });
    let mut packets = Vec::new();
    let mut sink = |packet: mavstack_core::parser::Packet<'_>| {
        let _ = signing.check(&packet, Some(1_000_000));
        packets.push((packet.raw.to_vec(), packet.timestamp));
    };
    for part in stream.chunks(chunk) {
        parser.feed(dialect, part, &mut sink);
    }
    parser.flush(dialect, &mut sink);
    let stamps = 8 * packets.iter().filter(|(_, timestamp)| timestamp.is_some()).count() as u64;
    let totals = parser.statistics();
    let (counted, length) = (totals.packet_bytes + totals.bad_bytes + stamps, stream.len() as u64);
    // A timestamp may begin in bytes that were taken for the signature of the packet before, and were counted there.
    let counted_twice = if timestamped { 8 * totals.signed } else { 0 };
    assert!((length..=length + counted_twice).contains(&counted), "{counted} of {length} bytes");
    (packets, totals.bad_bytes)
}

fuzz_target!(|data: &[u8]| {
    let [choice, plan @ ..] = data else { return };
    let dialect = dialect();
    let composed = if choice & 2 == 2 { stream(plan, &dialect) } else { plan.to_vec() };
    let stream = composed.as_slice();
    let timestamped = choice & 1 == 1;
    let whole = parse(stream, stream.len().max(1), timestamped, &dialect);
    assert_eq!(parse(stream, usize::from(choice / 4) + 1, timestamped, &dialect), whole);
});
