//! Memory and processor time of the model checker's processes, as the launcher `cargo xtask` measured them.

use std::collections::HashMap;

/// Memory and processor time of one harness (proof).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Usage {
    /// Highest total memory of all processes that ran for the harness (proof) at the same time, in KiB.
    pub memory_kib: u64,
    /// Processor time of all processes of the harness (proof) together, in seconds.
    pub processor_s: f64,
}

/// Reads lines with the name of a harness's (proof's) file, kibibytes and seconds. Errors: a line has another form.
pub fn read(text: &str) -> Result<HashMap<&str, Usage>, String> {
    let line = |line| {
        let mut words = str::split_whitespace(line);
        let mut next = || words.next();
        let usage = (|| {
            Some((
                next()?,
                Usage {
                    memory_kib: next()?.parse().ok()?,
                    processor_s: next()?.parse().ok()?,
                },
            ))
        })();
        usage.ok_or_else(|| format!("not a name, kibibytes and seconds: `{line}`"))
    };
    text.lines().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::read;

    #[test]
    fn what_processes_took_is_read_by_their_names() {
        let found = read("a__R 1024 1.5\nb__R 2 0.25\n").expect("it is a list");
        assert_eq!(found["b__R"].memory_kib, 2);
        assert_eq!(found["a__R"].processor_s, 1.5);
        assert!(read("a__R 1024\n").is_err());
    }
}
