//! Settings compared at equal cost: the samples that each got, and the noise that is left.
//!
//! ```text
//! n_i c_i ≈ max_j n c_j        noise = √(V_i/n_i)
//! ```
//!
//! At equal cost the setting with the least noise is the most efficient one.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | c_i | rays, or seconds, of one sample of value i | [`Budget`] |
//! | n_i | its samples per pixel | [`Row::spp`](super::Row::spp) |
//! | V_i | its variance of one sample | [`Row::total`](super::Row::total) |
//!
//! Reference: Hammersley and Handscomb, *Monte Carlo Methods* (1964), section 3.

use super::pictures::{Shown, setting};
use super::rows::Sweep;
use crate::report::text::{
    number::{count, significant},
    prose::wrapped,
    table::{Side, aligned},
};

/// Most lines of the table.
const MOST: usize = 10;

/// What all values have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Budget {
    /// Every value has about the same number of rays.
    Rays,
    /// Every value has about the same wall-clock time, as a pilot on this machine measured it.
    Time,
}

/// The table: samples per pixel, rays, seconds and noise of every value.
pub fn budget_table(sweep: &Sweep, shown: &[Shown], budget: Budget) -> String {
    let head = match budget {
        Budget::Rays => "Equal rays: every value has about as many rays as the most expensive one.",
        Budget::Time => {
            "Equal time: every value has the samples that fit into the time of the most expensive one, measured by a short \
             pilot. The numbers of samples depend on this machine."
        }
    };
    let header = [&sweep.over, "spp", "rays", "seconds", "noise, k ≥ 1", "noise, all k"];
    let mut lines = vec![header.map(String::from).to_vec()];
    for (r, s) in sweep.rows.iter().zip(shown).take(MOST) {
        let setting = setting(r, s);
        let cost = [r.spp.to_string(), count(r.rays.iter().sum()), significant(r.seconds, 3)];
        lines.push([r.value.clone()].into_iter().chain(cost).chain([0, 1].map(|part| setting.shown(part))).collect());
    }
    let head = format!("{head} Noise: standard deviation of a pixel (± 95 %).");
    let more = sweep.rows.len().saturating_sub(MOST);
    let more = if more == 0 { String::new() } else { format!("{more} more values: --verbose\n") };
    format!("{}\n{}{more}", wrapped(&head), aligned(&lines, &[[Side::Left].as_slice(), &[Side::Right; 5]].concat()))
}
