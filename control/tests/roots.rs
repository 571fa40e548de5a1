//! Tests that this crate's square roots of floating-point numbers have the same bits as those of the standard library.
#![cfg(feature = "float")]

use touchstone_control::Number;

/// Pseudo-random bit patterns of numbers of all sizes: multiples of 2^64 over the golden ratio.
fn bits() -> impl Iterator<Item = u64> {
    (1..1_000_000_u64).map(|index| index.wrapping_mul(0x9E37_79B9_7F4A_7C15))
}

#[test]
fn the_root_of_a_double_is_the_standard_librarys() {
    let special = [
        0.0,
        f64::MIN_POSITIVE,
        5e-324,
        1.0,
        2.0,
        f64::MAX,
        f64::INFINITY,
    ];
    for x in special
        .into_iter()
        .chain(bits().map(|bits| f64::from_bits(bits >> 1)))
    {
        let expected = if x > 0.0 { x.sqrt() } else { 0.0 };
        assert_eq!(
            <f64 as Number>::root(x).to_bits(),
            expected.to_bits(),
            "{x:e}"
        );
    }
}

#[test]
fn the_root_of_a_single_is_the_standard_librarys() {
    let special = [
        0.0,
        f32::MIN_POSITIVE,
        1e-45,
        1.0,
        2.0,
        f32::MAX,
        f32::INFINITY,
    ];
    for x in special
        .into_iter()
        .chain(bits().map(|bits| f32::from_bits((bits >> 33) as u32)))
    {
        let expected = if x > 0.0 { x.sqrt() } else { 0.0 };
        assert_eq!(
            <f32 as Number>::root(x).to_bits(),
            expected.to_bits(),
            "{x:e}"
        );
    }
}
