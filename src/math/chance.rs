//! Numbers for tests: evenly spread from −½ to ½, and always the same.

/// The numbers, one after the other.
pub(crate) fn numbers() -> impl FnMut() -> f64 {
    let mut seed = 1u32;
    move || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(seed >> 8) / f64::from(1 << 24) - 0.5
    }
}
