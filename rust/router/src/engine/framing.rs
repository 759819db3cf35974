//! Frames of a 4-byte big-endian length and bytes, as agents of ground stations send them over Unix sockets.

/// Length of the length.
const PREFIX: usize = 4;
/// Longest frame that is accepted: a false length must not fill the memory.
const MAX_FRAME: usize = 1 << 20;

/// A frame longer than the limit: the stream has no frames, or lost its place in them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameTooLong(pub usize);

/// Removes the lengths from a stream of frames.
#[derive(Debug, Default)]
pub struct Decoder {
    prefix: Vec<u8>,
    /// Bytes of the current frame that are still to come.
    rest: usize,
}

impl Decoder {
    /// Passes the content of the frames in `data` to `sink`, in parts.
    pub fn feed(&mut self, mut data: &[u8], mut sink: impl FnMut(&[u8])) -> Result<(), FrameTooLong> {
        while !data.is_empty() {
            if self.rest > 0 {
                let (content, later) = data.split_at(self.rest.min(data.len()));
                self.rest -= content.len();
                data = later;
                sink(content);
                continue;
            }
            let (head, later) = data.split_at((PREFIX - self.prefix.len()).min(data.len()));
            self.prefix.extend_from_slice(head);
            data = later;
            if let Some(length) = self.prefix.first_chunk::<PREFIX>() {
                self.rest = u32::from_be_bytes(*length) as usize;
                self.prefix.clear();
                if self.rest > MAX_FRAME {
                    return Err(FrameTooLong(self.rest));
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn frames_are_decoded_for_any_division_into_chunks(
            frames in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..40), 0..8),
            chunk in 1usize..20,
        ) {
            let stream: Vec<u8> = frames
                .iter()
                .flat_map(|frame| (frame.len() as u32).to_be_bytes().into_iter().chain(frame.iter().copied()))
                .collect();
            let (mut decoder, mut content) = (Decoder::default(), Vec::new());
            for part in stream.chunks(chunk) {
                prop_assert_eq!(decoder.feed(part, |bytes| content.extend_from_slice(bytes)), Ok(()));
            }
            prop_assert_eq!(content, frames.concat());
        }
    }

    #[test]
    fn a_false_length_is_refused() {
        let length = MAX_FRAME as u32 + 1;
        assert_eq!(Decoder::default().feed(&length.to_be_bytes(), |_| {}), Err(FrameTooLong(MAX_FRAME + 1)));
    }
}
