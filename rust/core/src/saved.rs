//! Numbers as bytes, for indexes that are saved in a file. Reading never trusts a length that the bytes state.

/// Collects numbers as bytes, least significant first.
#[derive(Debug, Default)]
pub struct Writer {
    bytes: Vec<u8>,
}

impl Writer {
    pub fn number(&mut self, value: u64) {
        self.bytes.extend_from_slice(&value.to_le_bytes());
    }

    pub fn size(&mut self, value: usize) {
        self.number(value as u64);
    }

    pub fn optional(&mut self, value: Option<u64>) {
        self.number(value.is_some().into());
        self.number(value.unwrap_or(0));
    }

    pub fn offsets(&mut self, values: &[u32]) {
        self.size(values.len());
        self.bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    }

    pub fn octets(&mut self, values: &[u8]) {
        self.size(values.len());
        self.bytes.extend_from_slice(values);
    }

    /// Writes counts by key.
    pub fn counts<K: Copy + Into<u64>>(&mut self, counts: impl ExactSizeIterator<Item = (K, u64)>) {
        self.size(counts.len());
        for (key, count) in counts {
            self.number(key.into());
            self.number(count);
        }
    }

    #[must_use]
    pub fn finish(self) -> Vec<u8> {
        self.bytes
    }
}

/// Reads what a [`Writer`] wrote; each method returns `None` where the bytes cannot be that.
#[derive(Debug)]
pub struct Reader<'a> {
    bytes: &'a [u8],
}

impl<'a> Reader<'a> {
    #[must_use]
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes }
    }

    pub fn number(&mut self) -> Option<u64> {
        let (&number, rest) = self.bytes.split_first_chunk()?;
        self.bytes = rest;
        Some(u64::from_le_bytes(number))
    }

    pub fn size(&mut self) -> Option<usize> {
        usize::try_from(self.number()?).ok()
    }

    /// Reads the number of elements that follow, each of at least `least` bytes.
    pub fn length(&mut self, least: usize) -> Option<usize> {
        let length = self.size()?;
        (length <= self.bytes.len() / least.max(1)).then_some(length)
    }

    pub fn optional(&mut self) -> Option<Option<u64>> {
        let (known, value) = (self.number()?, self.number()?);
        (known <= 1).then_some((known == 1).then_some(value))
    }

    pub fn offsets(&mut self) -> Option<Vec<u32>> {
        let length = self.length(size_of::<u32>())?;
        let (numbers, rest) = self.bytes.split_at_checked(length * size_of::<u32>())?;
        self.bytes = rest;
        Some(
            numbers
                .chunks_exact(size_of::<u32>())
                .map(|number| u32::from_le_bytes([number[0], number[1], number[2], number[3]]))
                .collect(),
        )
    }

    pub fn octets(&mut self) -> Option<&'a [u8]> {
        let length = self.length(1)?;
        let (octets, rest) = self.bytes.split_at_checked(length)?;
        self.bytes = rest;
        Some(octets)
    }

    /// Reads counts by key.
    pub fn counts<K: TryFrom<u64>, C: FromIterator<(K, u64)>>(&mut self) -> Option<C> {
        let length = self.length(2 * size_of::<u64>())?;
        (0..length).map(|_| Some((K::try_from(self.number()?).ok()?, self.number()?))).collect()
    }

    /// Returns `Some` if all bytes are read.
    #[must_use]
    pub fn end(self) -> Option<()> {
        self.bytes.is_empty().then_some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    #[test]
    fn what_is_written_is_read_and_what_is_cut_is_not() {
        let counts = BTreeMap::from([(3_u16, 5), (700, u64::MAX)]);
        let mut writer = Writer::default();
        writer.optional(None);
        writer.optional(Some(7));
        writer.offsets(&[1, u32::MAX]);
        writer.octets(b"abc");
        writer.counts(counts.iter().map(|(&key, &count)| (key, count)));
        let bytes = writer.finish();
        let read = |bytes: &[u8]| {
            let mut reader = Reader::new(bytes);
            let read = (reader.optional()?, reader.optional()?, reader.offsets()?, reader.octets()?.to_vec());
            let counts: BTreeMap<u16, u64> = reader.counts()?;
            reader.end()?;
            Some((read, counts))
        };
        assert_eq!(read(&bytes), Some(((None, Some(7), vec![1, u32::MAX], b"abc".to_vec()), counts)));
        for end in 0..bytes.len() {
            assert_eq!(read(&bytes[..end]), None);
        }
        assert_eq!(read(&[&bytes[..], &[0]].concat()), None);
    }

    #[test]
    fn a_length_beyond_the_bytes_allocates_nothing() {
        let mut writer = Writer::default();
        writer.number(u64::MAX / 8);
        let bytes = writer.finish();
        assert_eq!(Reader::new(&bytes).offsets(), None);
        assert_eq!(Reader::new(&bytes).octets(), None);
        assert_eq!(Reader::new(&bytes).counts::<u8, BTreeMap<_, _>>(), None);
    }
}
