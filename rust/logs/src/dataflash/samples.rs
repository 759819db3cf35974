//! Logs for the tests.

use super::format::HEADER;

/// A log that is written record by record.
#[derive(Default)]
pub struct Log(pub Vec<u8>);

impl Log {
    /// A log with the types of most tests: 1 is `A` (8 bytes of time, an instance, a `c`), 2 is `T` (a text).
    pub fn with_types() -> Self {
        let mut log = Self::default();
        log.define(1, "A", "QBc", "TimeUS,I,V", 14).define(2, "T", "QN", "TimeUS,Text", 27);
        log
    }

    pub fn define(&mut self, kind: u8, name: &str, format: &str, labels: &str, length: u8) -> &mut Self {
        let mut body = [0; 86];
        (body[0], body[1]) = (kind, length);
        for (start, text) in [(2, name), (6, format), (22, labels)] {
            body[start..start + text.len()].copy_from_slice(text.as_bytes());
        }
        self.record(0x80, &body)
    }

    pub fn record(&mut self, kind: u8, body: &[u8]) -> &mut Self {
        self.0.extend_from_slice(&HEADER);
        self.0.push(kind);
        self.0.extend_from_slice(body);
        self
    }

    pub fn a(&mut self, time: u64, instance: u8, value: i16) -> &mut Self {
        let mut body = time.to_le_bytes().to_vec();
        body.push(instance);
        body.extend_from_slice(&value.to_le_bytes());
        self.record(1, &body)
    }

    pub fn t(&mut self, time: u64, text: &str) -> &mut Self {
        let mut body = [0; 24];
        body[..8].copy_from_slice(&time.to_le_bytes());
        body[8..8 + text.len()].copy_from_slice(text.as_bytes());
        self.record(2, &body)
    }

    pub fn junk(&mut self, bytes: &[u8]) -> &mut Self {
        self.0.extend_from_slice(bytes);
        self
    }

    /// Removes the last bytes.
    pub fn cut(&mut self, bytes: usize) -> &mut Self {
        self.0.truncate(self.0.len() - bytes);
        self
    }
}

/// A pseudo-random sequence.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }

    pub fn below(&mut self, limit: u64) -> u64 {
        self.next() % limit
    }
}

/// A log with everything that a walk must cope with: damage of every kind, redefinitions, unknown types.
pub fn random_log(seed: u64, length: usize) -> Vec<u8> {
    let mut random = Random(seed | 1);
    let mut log = Log::with_types();
    while log.0.len() < length {
        let time = random.next();
        match random.below(100) {
            0 => log.junk(&vec![random.next() as u8; random.below(5000) as usize]),
            1 => log.junk(&time.to_le_bytes()),
            2 => log.a(time, 1, 2).cut(random.below(13) as usize),
            3 => log.record(9, &time.to_le_bytes()),
            4 => log.junk(&HEADER),
            // A definition of a new type, which later runs do not know.
            5 if random.below(20) == 0 => log.define(3 + random.below(4) as u8, "N", "Q", "TimeUS", 11),
            // A number that means something else from here on.
            6 if random.below(40) == 0 => log.define(2, "B", "QBc", "TimeUS,I,V", 27),
            7 => log.record(3, &time.to_le_bytes()),
            // Records inside a record, which mislead a walk that begins there.
            8..20 => {
                log.t(time, "\u{1}").cut(16).junk(&[0xA3, 0x95, 1, 0xA3, 0x95, 1, 0xA3, 0x95, 1, 0, 0, 0, 0, 0, 0, 0])
            }
            20..50 => log.t(time, "text"),
            _ => log.a(time, (time & 3) as u8, time as i16),
        };
    }
    log.0
}
