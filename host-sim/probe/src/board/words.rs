//! Decodes the log messages of a program (defmt format). The log holds a number per message; the texts are in the ELF file's
//! section `.defmt`.

use defmt_decoder::{DecodeError, Frame, Locations, StreamDecoder, Table};

/// The texts of all messages that a program can log, from its ELF file.
pub struct Words {
    table: Table,
    locations: Locations,
}

/// A decoded log message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Line {
    /// Time on the board's clock as text; `None` if the program does not log it.
    pub time: Option<String>,
    /// Level of the message, e.g. `warn`; `None` for a message without a level.
    pub level: Option<&'static str>,
    /// Text of the message.
    pub text: String,
    /// File and line of the source code that logs the message; `None` if the ELF file does not have them.
    pub location: Option<String>,
}

impl Words {
    /// Reads the texts of a program's log messages from its ELF file.
    ///
    /// # Errors
    /// What is wrong with the file, as text without the file's name.
    pub fn read(elf: &[u8]) -> Result<Self, String> {
        let table = Table::parse(elf)
            .map_err(|why| format!("has messages that cannot be read: {why}"))?
            .ok_or("has no messages in it: no section .defmt")?;
        // A program without source locations is accepted; its messages then have no location.
        let locations = table.get_locations(elf).unwrap_or_default();
        Ok(Self { table, locations })
    }

    /// Creates a decoder for the bytes of the program's log.
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

/// A decoder that accepts the bytes of a log in pieces and returns messages.
pub(super) struct Stream<'w> {
    words: &'w Words,
    decoder: Box<dyn StreamDecoder + Send + Sync + 'w>,
}

impl Stream<'_> {
    /// Decodes further bytes of the log. Returns the messages that are now complete; `None` stands for a damaged message.
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

/// Replaces the characters of a log text that cannot be printed on one line.
fn printable(text: &str) -> String {
    let shown = |letter: char| if letter.is_control() { ' ' } else { letter };
    text.chars().map(shown).collect()
}
