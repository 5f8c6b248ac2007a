//! Exercises of chapter 14 that the program judges.

use fredholm::report::exercise::Exercise;

/// All of them.
pub(super) const EXERCISES: &[Exercise] = &[];
