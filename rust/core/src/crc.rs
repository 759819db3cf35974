//! CRC-16/MCRF4XX: reflected polynomial 0x1021, initial value 0xFFFF, no final xor.
//!
//! Sixteen bytes are folded at a time: `TABLES[k][b]` is the CRC of byte `b` followed by `k` zero bytes,
//! so the sixteen look-ups of a block are independent. The bytes that do not fill a block are processed first, as a
//! block padded with leading zero bytes: the state is mixed into the first two data bytes and then starts at zero, and
//! zero bytes leave a zero state unchanged. No tail remains to be processed byte by byte.

pub const INITIAL: u16 = 0xFFFF;

const BLOCK: usize = 16;
const TABLES: [[u16; 256]; BLOCK] = tables();

const fn tables() -> [[u16; 256]; BLOCK] {
    let mut tables = [[0u16; 256]; BLOCK];
    let mut byte = 0;
    while byte < 256 {
        let mut crc = byte as u16;
        let mut bit = 0;
        while bit < 8 {
            crc = if crc & 1 == 1 { (crc >> 1) ^ 0x8408 } else { crc >> 1 };
            bit += 1;
        }
        tables[0][byte] = crc;
        byte += 1;
    }
    let mut zeros = 1;
    while zeros < BLOCK {
        let mut byte = 0;
        while byte < 256 {
            let previous = tables[zeros - 1][byte];
            tables[zeros][byte] = (previous >> 8) ^ tables[0][(previous & 0xFF) as usize];
            byte += 1;
        }
        zeros += 1;
    }
    tables
}

/// Continues `crc` over one more byte.
#[inline]
#[must_use]
pub fn accumulate(crc: u16, byte: u8) -> u16 {
    (crc >> 8) ^ TABLES[0][usize::from((crc as u8) ^ byte)]
}

/// Continues `crc` over `data`.
#[inline]
#[must_use]
pub fn update(mut crc: u16, data: &[u8]) -> u16 {
    let Some(&first) = data.first_chunk::<BLOCK>() else {
        return data.iter().fold(crc, |crc, &byte| accumulate(crc, byte));
    };
    let (rest, blocks) = data.as_rchunks::<BLOCK>();
    if rest.len() >= 2 {
        let mixed = u128::from_le_bytes(first) ^ u128::from(crc);
        crc = fold(0, &(mixed << (8 * (BLOCK - rest.len()))).to_le_bytes());
    } else if let [byte] = rest {
        crc = accumulate(crc, *byte);
    }
    for block in blocks {
        crc = fold(crc, block);
    }
    crc
}

#[inline]
fn fold(crc: u16, block: &[u8; BLOCK]) -> u16 {
    let [low, high] = crc.to_le_bytes();
    let mut next = TABLES[BLOCK - 1][usize::from(block[0] ^ low)] ^ TABLES[BLOCK - 2][usize::from(block[1] ^ high)];
    for (index, &byte) in block.iter().enumerate().skip(2) {
        next ^= TABLES[BLOCK - 1 - index][usize::from(byte)];
    }
    next
}

/// Maximum number of zero bytes that [`append_zeros`] appends.
const MAX_ZEROS: usize = BLOCK * (LONG_TABLES.len() + 1) - 1;
/// `LONG_TABLES[k]` holds, for each low and high byte of a CRC, that CRC after `16 * (k + 1)` zero bytes.
static LONG_TABLES: [[[u16; 256]; 2]; 17] = long_tables();

#[expect(clippy::large_stack_arrays, reason = "evaluated by the compiler")]
const fn long_tables() -> [[[u16; 256]; 2]; 17] {
    let mut tables = [[[0u16; 256]; 2]; 17];
    let mut step = 0;
    while step < tables.len() {
        let mut entry = 0;
        while entry < 512 {
            let (half, byte) = (entry / 256, entry % 256);
            let before = if step == 0 { (byte as u16) << (8 * half) } else { tables[step - 1][half][byte] };
            tables[step][half][byte] =
                TABLES[BLOCK - 1][(before & 0xFF) as usize] ^ TABLES[BLOCK - 2][(before >> 8) as usize];
            entry += 1;
        }
        step += 1;
    }
    tables
}

/// Continues `crc` over `count` zero bytes, at most 287, in constant time.
#[inline]
#[must_use]
pub fn append_zeros(mut crc: u16, count: usize) -> u16 {
    debug_assert!(count <= MAX_ZEROS);
    if let Some(long) = (count / BLOCK).checked_sub(1).and_then(|index| LONG_TABLES.get(index)) {
        crc = long[0][usize::from(crc as u8)] ^ long[1][usize::from(crc >> 8)];
    }
    let [low, high] = crc.to_le_bytes();
    match count % BLOCK {
        0 => crc,
        1 => accumulate(crc, 0),
        rest => TABLES[rest - 1][usize::from(low)] ^ TABLES[rest - 2][usize::from(high)],
    }
}

/// The byte whose entry of `TABLES[0]` has a given high byte; every high byte occurs once.
static BYTES_BY_HIGH: [u8; 256] = bytes_by_high();

const fn bytes_by_high() -> [u8; 256] {
    let mut bytes = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        bytes[(TABLES[0][byte] >> 8) as usize] = byte as u8;
        byte += 1;
    }
    bytes
}

/// Finds the `CRC_EXTRA` that leads from `before` to `after`, or `None` if no byte does.
///
/// A packet of an unknown id cannot be verified completely, but only 1 in 256 damaged packets has a solution.
#[must_use]
pub fn solve_extra(before: u16, after: u16) -> Option<u8> {
    let target = after ^ (before >> 8);
    let byte = BYTES_BY_HIGH[usize::from(target >> 8)];
    (TABLES[0][usize::from(byte)] == target).then_some(byte ^ (before as u8))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn bitwise(mut crc: u16, data: &[u8]) -> u16 {
        for &byte in data {
            crc ^= u16::from(byte);
            for _ in 0..8 {
                crc = if crc & 1 == 1 { (crc >> 1) ^ 0x8408 } else { crc >> 1 };
            }
        }
        crc
    }

    #[test]
    fn matches_the_published_check_value() {
        assert_eq!(update(INITIAL, b"123456789"), 0x6F91);
    }

    proptest! {
        #[test]
        fn equals_the_bitwise_implementation(data in prop::collection::vec(any::<u8>(), 0..300), start: u16) {
            prop_assert_eq!(update(start, &data), bitwise(start, &data));
        }

        #[test]
        fn append_zeros_equals_an_update(start: u16, count in 0..=MAX_ZEROS) {
            prop_assert_eq!(append_zeros(start, count), update(start, &vec![0; count]));
        }

        #[test]
        fn solve_extra_finds_exactly_the_solutions(before: u16, after: u16) {
            let exists = (0..=255).any(|extra| accumulate(before, extra) == after);
            prop_assert_eq!(solve_extra(before, after).is_some(), exists);
        }

        #[test]
        fn solve_extra_inverts_accumulate(before: u16, extra: u8) {
            prop_assert_eq!(solve_extra(before, accumulate(before, extra)), Some(extra));
        }
    }
}
