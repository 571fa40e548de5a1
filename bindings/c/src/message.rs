//! Texts in buffers of C code.

use crate::memory;

/// Writes an error message into a C buffer. The text is cut to the buffer's length and ends with a zero byte.
pub(crate) struct Words<'a> {
    buffer: &'a mut [u8],
    used: usize,
}

impl<'a> Words<'a> {
    /// Starts an empty text in a buffer. The buffer's last byte is kept for the final zero.
    pub(crate) fn new(buffer: &'a mut [u8]) -> Self {
        memory::terminate(buffer, 0);
        Self { buffer, used: 0 }
    }
}

impl core::fmt::Write for Words<'_> {
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        for byte in text.bytes() {
            // One byte is kept for the final zero.
            if self.used.saturating_add(1) >= self.buffer.len() {
                break;
            }
            if let Some(place) = self.buffer.get_mut(self.used) {
                *place = byte;
                self.used = self.used.saturating_add(1);
            }
        }
        memory::terminate(self.buffer, self.used);
        Ok(())
    }
}
