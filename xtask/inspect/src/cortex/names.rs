//! Recognises panic functions and float functions by their names.

/// Whether a name is that of a panic function such as `core::panicking::panic_…`, however it is mangled.
pub fn is_panic(name: &str) -> bool {
    ["panic", "unwrap_failed", "expect_failed", "slice_index"]
        .iter()
        .any(|word| name.contains(word))
}

/// Whether a name is that of a software float function: one of the Arm ABI (RTABI32, chapter 4.1) or of the compiler's library,
/// such as `__addsf3`.
pub fn is_soft_float(name: &str) -> bool {
    if let Some(name) = name.strip_prefix("__aeabi_") {
        let conversions = ["i2", "ui2", "l2", "ul2"];
        return name.starts_with(['f', 'd', 'h'])
            || name.starts_with("cf")
            || name.starts_with("cd")
            || conversions.iter().any(|from| name.starts_with(from));
    }
    name.strip_prefix("__").is_some_and(|name| {
        (name.contains("sf") || name.contains("df"))
            && name.ends_with(|c: char| c.is_ascii_digit() || c == 'i' || c == 'f')
    })
}

#[cfg(test)]
mod tests {
    use super::{is_panic, is_soft_float};

    #[test]
    fn names_of_floats_and_panics_are_known() {
        for float in [
            "__aeabi_fadd",
            "__aeabi_dmul",
            "__aeabi_i2f",
            "__aeabi_l2d",
            "__aeabi_f2iz",
            "__aeabi_h2f",
            "__aeabi_cfcmple",
            "__addsf3",
            "__muldf3",
            "__fixsfsi",
            "__floatdidf",
        ] {
            assert!(is_soft_float(float), "{float}");
        }
        for integer in [
            "__aeabi_uldivmod",
            "__aeabi_lmul",
            "__aeabi_idiv",
            "__aeabi_memcpy4",
            "__udivmoddi4",
        ] {
            assert!(!is_soft_float(integer), "{integer}");
        }
        assert!(is_panic("_ZN4core9panicking5panic17h0E"));
        assert!(!is_panic("_ZN15touchstone_thumb12tick_fixed32E"));
    }
}
