//! Sets of ports. A port is a place that packets come from and go to: a stream, a queue, or one peer of a socket.

/// Index of a port; indices of removed ports are used again.
pub type PortId = usize;

/// Maximum number of ports of a router, so that a set has a bounded size.
pub const MAX_PORTS: usize = 4096;

/// A set of ports as bits.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PortSet {
    words: Vec<u64>,
}

impl PortSet {
    #[inline]
    #[must_use]
    pub fn contains(&self, port: PortId) -> bool {
        self.words.get(port / 64).is_some_and(|word| word >> (port % 64) & 1 == 1)
    }

    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.words.iter().all(|&word| word == 0)
    }

    /// Adds a port; returns whether it is new.
    pub fn insert(&mut self, port: PortId) -> bool {
        if self.words.len() <= port / 64 {
            self.words.resize(port / 64 + 1, 0);
        }
        let word = &mut self.words[port / 64];
        let before = *word;
        *word |= 1 << (port % 64);
        *word != before
    }

    pub fn remove(&mut self, port: PortId) {
        if let Some(word) = self.words.get_mut(port / 64) {
            *word &= !(1 << (port % 64));
        }
    }

    pub fn clear(&mut self) {
        self.words.clear();
    }

    /// Adds all ports of another set.
    pub fn extend(&mut self, other: &Self) {
        if self.words.len() < other.words.len() {
            self.words.resize(other.words.len(), 0);
        }
        self.words.iter_mut().zip(&other.words).for_each(|(word, more)| *word |= more);
    }

    /// The ports in ascending order.
    pub fn iter(&self) -> impl Iterator<Item = PortId> {
        self.words.iter().enumerate().flat_map(|(index, &word)| {
            let mut rest = word;
            std::iter::from_fn(move || {
                let bit = (rest != 0).then(|| rest.trailing_zeros() as usize)?;
                rest &= rest - 1;
                Some(index * 64 + bit)
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_holds_its_ports_in_order() {
        let mut set = PortSet::default();
        assert!(set.is_empty());
        assert!([200, 3, 64].into_iter().all(|port| set.insert(port)));
        assert!(!set.insert(3));
        assert_eq!(set.iter().collect::<Vec<_>>(), [3, 64, 200]);
        set.remove(64);
        set.remove(9999);
        assert!(!set.contains(64) && set.contains(200) && !set.contains(9999));
        let mut other = PortSet::default();
        other.insert(700);
        set.extend(&other);
        assert_eq!(set.iter().collect::<Vec<_>>(), [3, 200, 700]);
    }
}
