//! A program's messages: numbers on the wire, words in its ELF file's section `.defmt`.

use defmt_decoder::{DecodeError, Frame, Locations, StreamDecoder, Table};

/// The messages that a program can send.
pub struct Words {
    table: Table,
    locations: Locations,
}

/// One message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Line {
    /// Time on the board's clock, if its program sends it.
    pub time: Option<String>,
    /// Level of the message; `None` for a plain print.
    pub level: Option<&'static str>,
    /// The message.
    pub text: String,
    /// Where in the sources it stands: file and line, if the ELF file still says so.
    pub location: Option<String>,
}

impl Words {
    /// The messages of an ELF file. Errors are in words without a place.
    pub fn read(elf: &[u8]) -> Result<Self, String> {
        let table = Table::parse(elf)
            .map_err(|why| format!("has messages that cannot be read: {why}"))?
            .ok_or("has no messages in it: no section .defmt")?;
        // Only a place in the sources is lost with them.
        let locations = table.get_locations(elf).unwrap_or_default();
        Ok(Self { table, locations })
    }

    /// Takes the bytes of a log as they come.
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

/// Bytes in, messages out.
pub(super) struct Stream<'w> {
    words: &'w Words,
    decoder: Box<dyn StreamDecoder + Send + Sync + 'w>,
}

impl Stream<'_> {
    /// The messages that are whole now; `None` for one that was damaged.
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

/// Makes a board's text printable on one line.
fn printable(text: &str) -> String {
    let shown = |letter: char| if letter.is_control() { ' ' } else { letter };
    text.chars().map(shown).collect()
}
