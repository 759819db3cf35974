//! The ULog reader counts every byte, gives the same result on any number of threads and for any division of the file
//! into parts, and does not fail on data that changed after indexing, or on an index that was saved and damaged.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mavstack_logs::ulog::header::{HEADER, Header, MAGIC};
use mavstack_logs::ulog::index::{Index, Options};

const KINDS: &[u8] = b"DDDDABCFILMOPQRSZ";
const DEFINITIONS: [(u8, &[u8]); 5] = [
    (b'F', b"inner:float x;uint8_t _padding0;"),
    (b'F', b"outer:uint64_t timestamp;inner[2] i;char[3] text;bool on;uint8_t[4] _padding0;"),
    (b'A', b"\0\0\0inner"),
    (b'A', b"\x01\x01\0outer"),
    (b'A', b"\x02\x02\0outer"),
];

fn message(out: &mut Vec<u8>, kind: u8, body: &[u8]) {
    out.extend((body.len() as u16).to_le_bytes());
    out.push(kind);
    out.extend(body);
}

/// A log of valid messages and plain bytes, composed from the fuzzer's bytes.
fn compose(mut plan: &[u8]) -> Vec<u8> {
    let mut out = [MAGIC, &[1; 9]].concat();
    for (kind, body) in DEFINITIONS {
        message(&mut out, kind, body);
    }
    while let [choice, size, rest @ ..] = plan {
        let (body, left) = rest.split_at(rest.len().min(usize::from(*size) % 40));
        plan = left;
        match choice {
            0..=99 => message(&mut out, KINDS[usize::from(*choice) % KINDS.len()], body),
            100..=199 => {
                let id = u16::from(choice % 3);
                let mut record = id.to_le_bytes().to_vec();
                record.extend(body);
                record.resize(if id == 0 { 6 } else { 24 + usize::from(size % 5) }, *size);
                message(&mut out, b'D', &record);
            }
            200..=219 => message(&mut out, b'S', b"\x2f\x73\x13\x20\x25\x0c\xbb\x12"),
            _ => out.extend(body),
        }
    }
    out
}

fn rows(index: &Index, data: &[u8]) -> Vec<(String, Vec<u8>)> {
    let tables = index.tables().iter().enumerate();
    let decode = |(number, table): (usize, &mavstack_logs::ulog::catalog::Table)| {
        let mut buffer = vec![0; index.rows(number) * table.layout.row_size];
        index.decode(data, vec![(number, &mut buffer)], Some(-5), 2);
        (table.name.clone(), buffer)
    };
    tables.map(decode).collect()
}

fuzz_target!(|data: &[u8]| {
    let [choice, plan @ ..] = data else { return };
    let log = if choice & 1 == 1 { compose(plan) } else { [MAGIC, plan].concat() };
    let Ok(header) = Header::parse(&log) else { return };
    let whole = Index::build(&log, &header, Options::default());
    let damage = &whole.damage;
    assert_eq!(whole.message_bytes + damage.bad_bytes + damage.truncated_bytes, (log.len() - HEADER) as u64);
    let expected = rows(&whole, &log);
    let min_segment = usize::from(*choice) + 1;
    let several = Index::build(&log, &header, Options { threads: 3, min_segment, positions: true });
    assert_eq!((rows(&several, &log), &several.damage), (expected.clone(), damage));
    let mut part = Some(Index::first(&log, &header, min_segment, Options::default()));
    let mut sizes = vec![0; expected.len()];
    while let Some(index) = part {
        for (size, (_, rows)) in sizes.iter_mut().zip(rows(&index, &log)) {
            *size += rows.len();
        }
        part = index.following(&log, min_segment, Options::default());
    }
    assert!(sizes.iter().zip(&expected).all(|(size, (_, rows))| *size == rows.len()));
    rows(&whole, &log[..log.len() / 2]);
    let mut saved = whole.save();
    let restored = Index::restore(&saved, &log, &header).expect("the index that was saved");
    assert_eq!((rows(&restored, &log), &restored.damage), (expected, damage));
    let place = plan.iter().fold(0, |sum, &byte| (sum * 31 + usize::from(byte)) % 65_521) % saved.len();
    saved[place] ^= choice | 1;
    if let Some(damaged) = Index::restore(&saved, &log, &header) {
        rows(&damaged, &log);
        let _part = damaged.following(&log, min_segment, Options::default());
    }
});
