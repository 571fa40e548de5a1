//! Searches assembly text for float operations and panics, in the functions of a crate and in all functions that these call.

use std::collections::{BTreeMap, BTreeSet};

use crate::cortex::is_soft_float;

/// The lines of all functions and tables in the assembly files, by label.
#[derive(Default)]
pub struct Code {
    blocks: BTreeMap<String, Vec<String>>,
}

/// Result of a search through assembly.
#[derive(Debug, Default)]
pub struct Scan {
    pub functions: usize,
    pub instructions: usize,
    /// Places found, each as `function: instruction`.
    pub findings: Vec<String>,
}

impl Code {
    /// Adds the text of one assembly file; returns the labels that the file defines.
    pub fn add(&mut self, text: &str) -> Vec<String> {
        let mut labels: Vec<String> = Vec::new();
        for line in text.lines() {
            let code = line.split(['#', '@']).next().unwrap_or("");
            if let Some(label) = global_label(code) {
                self.blocks.entry(label.to_owned()).or_default();
                labels.push(label.to_owned());
            } else if let Some(block) = labels.last().and_then(|at| self.blocks.get_mut(at)) {
                // Lines with a local label end in a colon, directives start with a dot. Of the directives only those of tables name
                // other labels.
                let code = code.trim();
                let names_others = [".quad", ".long", ".word", ".xword", ".8byte", ".4byte"];
                let keep = !code.is_empty()
                    && !code.ends_with(':')
                    && (!code.starts_with('.') || names_others.iter().any(|d| code.starts_with(d)));
                if keep {
                    block.push(code.to_owned());
                }
            }
        }
        labels
    }

    /// Searches the code at the labels `from`, and all code that it refers to by label, for instructions that `is_found` accepts.
    pub fn scan(&self, from: &[String], is_found: impl Fn(&str) -> bool) -> Scan {
        let mut scan = Scan::default();
        let mut open: Vec<&str> = from.iter().map(String::as_str).collect();
        let mut seen: BTreeSet<&str> = open.iter().copied().collect();
        while let Some(label) = open.pop() {
            let Some(block) = self.blocks.get(label) else {
                continue;
            };
            scan.functions += usize::from(block.iter().any(|line| !line.starts_with('.')));
            for line in block {
                if !line.starts_with('.') {
                    scan.instructions += 1;
                    if is_found(line) {
                        let line = line.split_whitespace().collect::<Vec<_>>().join(" ");
                        scan.findings.push(format!("{label}: {line}"));
                    }
                }
                for word in line.split(|c: char| !(c.is_alphanumeric() || "_$.".contains(c))) {
                    if let Some((name, _)) = self.blocks.get_key_value(word)
                        && seen.insert(name)
                    {
                        open.push(name);
                    }
                }
            }
        }
        scan
    }
}

/// Whether a line names a panic function of `core`, such as `core::panicking::panic_…`, however its name is mangled.
pub fn is_panic(line: &str) -> bool {
    line.contains("panicking")
}

/// The label that a line defines; `None` for other lines and for labels that are local to a function.
fn global_label(line: &str) -> Option<&str> {
    let label = line.trim_end().strip_suffix(':')?;
    let plain = !label.is_empty() && !label.starts_with(['.', ' ', '\t']);
    plain.then(|| label.trim_matches('"'))
}

/// Returns the function that recognises float operations in an architecture's assembly; `None` for an unknown architecture.
pub fn float_operation(architecture: &str) -> Option<fn(&str) -> bool> {
    match architecture {
        "x86_64" => Some(is_x86_float),
        "aarch64" => Some(is_aarch64_float),
        _ if architecture.starts_with("thumb") => Some(is_thumb_float),
        _ => None,
    }
}

fn mnemonic(line: &str) -> &str {
    line.split_whitespace().next().unwrap_or("")
}

/// Whether an x86-64 instruction is a float operation: arithmetic, comparison or conversion. Moves through float registers do not
/// count.
fn is_x86_float(line: &str) -> bool {
    let name = mnemonic(line);
    let name = name.strip_prefix('v').unwrap_or(name);
    // All instructions of the old x87 coprocessor start with f; no other instruction does.
    if name.starts_with('f') || name.starts_with("cvt") {
        return true;
    }
    let operations = [
        "add", "sub", "mul", "div", "sqrt", "rsqrt", "rcp", "min", "max", "comi", "ucomi", "cmp",
        "round", "hadd", "hsub", "addsub", "dp",
    ];
    let kinds = ["ss", "sd", "ps", "pd"];
    kinds.iter().any(|kind| {
        name.strip_suffix(kind).is_some_and(|stem| {
            operations.contains(&stem) || (stem.starts_with("cmp") && stem.len() > 3)
        })
    })
}

fn is_aarch64_float(line: &str) -> bool {
    let name = mnemonic(line);
    (name.starts_with('f') && name != "fmov")
        || name.starts_with("scvtf")
        || name.starts_with("ucvtf")
}

/// Whether a line of Thumb assembly is a float operation: a call of the soft-float library, by Arm's names or the compiler's, or an
/// instruction of the float unit that is not a move.
fn is_thumb_float(line: &str) -> bool {
    let name = mnemonic(line);
    if name.starts_with('v') && (name.contains(".f32") || name.contains(".f64")) {
        let moves = ["vmov", "vldr", "vstr"];
        return !moves.iter().any(|plain| name.starts_with(plain));
    }
    line.split(|c: char| !(c.is_alphanumeric() || c == '_'))
        .any(is_soft_float)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instructions_are_told_apart() {
        for line in [
            "addsd\t%xmm1, %xmm0",
            "vmulss %xmm1, %xmm0, %xmm0",
            "cvtsi2sd %eax, %xmm0",
            "ucomisd %xmm0, %xmm1",
            "cmpltps %xmm0, %xmm1",
            "fldl (%rsp)",
        ] {
            assert!(is_x86_float(line), "{line}");
        }
        for line in [
            "movaps %xmm0, (%rsp)",
            "addl %eax, %ebx",
            "paddd %xmm0, %xmm1",
            "xorps %xmm0, %xmm0",
            "subq $8, %rsp",
            "cmpq %rax, %rbx",
            "mulq %rcx",
        ] {
            assert!(!is_x86_float(line), "{line}");
        }
        for line in [
            "bl\t__aeabi_fadd",
            "bl __aeabi_l2d",
            "bl __muldf3",
            "vadd.f32 s0, s0, s1",
        ] {
            assert!(is_thumb_float(line), "{line}");
        }
        for line in [
            "bl __aeabi_uldivmod",
            "bl __aeabi_lmul",
            "bl __aeabi_idiv",
            "bl __aeabi_memcpy",
            "smull r0, r1, r2, r3",
            "vldr d0, [sp]",
        ] {
            assert!(!is_thumb_float(line), "{line}");
        }
        assert!(is_aarch64_float("fadd d0, d0, d1") && !is_aarch64_float("fmov d0, x0"));
    }

    #[test]
    fn floats_and_panics_are_found_through_calls_and_tables_but_not_where_nobody_goes() {
        let own = "\
law:
\tcallq\t*helper@GOTPCREL(%rip)
\tleaq\ttable(%rip), %rax
\tretq
";
        let other = "\
helper:
.LBB0_1:
\taddl %eax, %ebx
\tretq
table:
\t.quad\thidden
hidden:
\tmulsd %xmm0, %xmm1
\tcallq\t*_ZN4core9panicking5panic17h00E@GOTPCREL(%rip)
unused:
\taddss %xmm0, %xmm1
\tcallq\t_ZN4core9panicking5panic17h01E
";
        let mut code = Code::default();
        let from = code.add(own);
        code.add(other);
        let panics = code.scan(&from, is_panic).findings;
        let call = "callq *_ZN4core9panicking5panic17h00E@GOTPCREL(%rip)";
        assert_eq!(
            panics,
            [format!("hidden: {}", call.split('@').next().unwrap())]
        );
        let scan = code.scan(&from, is_x86_float);
        assert_eq!(scan.findings, ["hidden: mulsd %xmm0, %xmm1"]);
        assert_eq!((scan.functions, scan.instructions), (3, 7));
    }
}
