//! r_k in closed form, for the mistakes that have one.
//!
//! | c falls on | r_k, k ≥ 1 | what is wrong |
//! |---|---|---|
//! | every term alike | c | the connection to the light |
//! | every bounce | c^(k−1) | the bounce, or the roulette |
//! | every reflection | c^k | the BSDF |
//!
//! r_0 = 1 in all three: what the eye sees directly goes through neither.

/// c for k ≥ 1.
pub fn flat(c: f64, k: usize) -> Option<f64> {
    Some(if k == 0 { 1.0 } else { c })
}

/// c^(k−1) for k ≥ 1.
pub fn per_bounce(c: f64, k: usize) -> Option<f64> {
    Some(c.powi(k.saturating_sub(1) as i32))
}

/// c^k.
pub fn per_reflection(c: f64, k: usize) -> Option<f64> {
    Some(c.powi(k as i32))
}

/// r_k that depends on the scene.
pub fn unknown(_: usize) -> Option<f64> {
    None
}
