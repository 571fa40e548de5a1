//! Splits a text file into words with their line numbers, for the readers of mesh files.

/// Whether a byte is white space, including the vertical tab as in C.
pub(crate) fn is_space(byte: &u8) -> bool {
    byte.is_ascii_whitespace() || *byte == b'\x0b'
}

/// The words of a text with their line numbers. LF, CR or CRLF ends a line.
pub(crate) struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Line number of the reading position, from 1.
    pub line: usize,
}

#[derive(Clone, Copy)]
pub(crate) struct Word<'a> {
    pub bytes: &'a [u8],
    /// Line number of the word, from 1.
    pub line: usize,
}

impl<'a> Words<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self::from_line(bytes, 1)
    }

    /// Words of a text that begins at line number `line` of its file.
    pub fn from_line(bytes: &'a [u8], line: usize) -> Self {
        Self { bytes, at: 0, line }
    }

    fn ends_line(&self) -> bool {
        match self.bytes[self.at] {
            b'\n' => true,
            b'\r' => self.bytes.get(self.at + 1) != Some(&b'\n'),
            _ => false,
        }
    }

    /// Skips the rest of the line, such as the name of a solid, which may have any encoding.
    pub fn skip_line(&mut self) {
        while self.at < self.bytes.len() && !self.ends_line() {
            self.at += 1;
        }
    }

    pub fn wanted(&mut self, wanted: &str) -> Result<(), String> {
        match self.next() {
            Some(word) if word.is(wanted) => Ok(()),
            Some(word) => Err(word.instead_of(wanted)),
            None => Err(format!(
                "the text ends at line {} where \"{wanted}\" must follow",
                self.line
            )),
        }
    }

    pub fn number(&mut self) -> Result<f32, String> {
        let Some(word) = self.next() else {
            return Err(format!(
                "the text ends at line {} where a number must follow",
                self.line
            ));
        };
        word.number()
    }
}

impl<'a> Iterator for Words<'a> {
    type Item = Word<'a>;

    fn next(&mut self) -> Option<Word<'a>> {
        while is_space(self.bytes.get(self.at)?) {
            self.line += usize::from(self.ends_line());
            self.at += 1;
        }
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(is_space).unwrap_or(rest.len());
        self.at += length;
        Some(Word {
            bytes: &rest[..length],
            line: self.line,
        })
    }
}

impl Word<'_> {
    pub fn is(&self, wanted: &str) -> bool {
        self.bytes.eq_ignore_ascii_case(wanted.as_bytes())
    }

    /// Reads the word as a finite number.
    ///
    /// # Errors
    /// The word is not a number, or is too large for `f32`.
    pub fn number(&self) -> Result<f32, String> {
        let text = std::str::from_utf8(self.bytes).ok();
        let number = text.and_then(|text| text.parse::<f32>().ok());
        number
            .filter(|number| number.is_finite())
            .ok_or_else(|| self.instead_of("a number"))
    }

    pub fn instead_of(&self, wanted: &str) -> String {
        let text: String = String::from_utf8_lossy(self.bytes)
            .chars()
            .take(40)
            .collect();
        format!("line {}: \"{text}\" instead of {wanted}", self.line)
    }
}
