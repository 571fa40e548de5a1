//! Decodes a program's log messages. They are numbers in the log; their texts are in the ELF file's section `.defmt`.

use defmt_decoder::{DecodeError, Frame, Locations, StreamDecoder, Table};

/// The texts of all messages that a program can log.
pub struct Words {
    table: Table,
    locations: Locations,
}

/// A log message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Line {
    /// Time on the board's clock, if its program logs it.
    pub time: Option<String>,
    /// Level of the message; `None` for a plain print.
    pub level: Option<&'static str>,
    /// Text of the message.
    pub text: String,
    /// Place in the source code: file and line, if the ELF file has them.
    pub location: Option<String>,
}

impl Words {
    /// Reads the messages' texts from an ELF file.
    ///
    /// # Errors
    /// What is wrong with the file, as text without the file's name.
    pub fn read(elf: &[u8]) -> Result<Self, String> {
        let table = Table::parse(elf)
            .map_err(|why| format!("has messages that cannot be read: {why}"))?
            .ok_or("has no messages in it: no section .defmt")?;
        // Only a place in the sources is lost with them.
        let locations = table.get_locations(elf).unwrap_or_default();
        Ok(Self { table, locations })
    }

    /// A decoder for the bytes of a log.
    pub(super) fn stream(&self) -> Stream<'_> {
        Stream {
            words: self,
            decoder: self.table.new_stream_decoder(),
        }
    }

    fn line(&self, frame: &Frame<'_>) -> Line {
        let location = self.locations.get(&frame.index());
        Line {
            time: frame.display_timestamp().map(|time| time.to_string()),
            level: frame.level().map(|level| level.as_str()),
            text: printable(&frame.display_message().to_string()),
            location: location.map(|at| format!("{}:{}", at.file.display(), at.line)),
        }
    }
}

/// A decoder that takes the log's bytes and returns messages.
pub(super) struct Stream<'w> {
    words: &'w Words,
    decoder: Box<dyn StreamDecoder + Send + Sync + 'w>,
}

impl Stream<'_> {
    /// Adds bytes and returns the messages that are complete; `None` for a damaged one.
    pub fn take(&mut self, bytes: &[u8]) -> Vec<Option<Line>> {
        self.decoder.received(bytes);
        let mut lines = Vec::new();
        loop {
            match self.decoder.decode() {
                Ok(frame) => lines.push(Some(self.words.line(&frame))),
                Err(DecodeError::Malformed) => lines.push(None),
                Err(DecodeError::UnexpectedEof) => return lines,
            }
        }
    }
}

/// Replaces characters of a board's text that cannot be printed on one line.
fn printable(text: &str) -> String {
    let shown = |letter: char| if letter.is_control() { ' ' } else { letter };
    text.chars().map(shown).collect()
}
