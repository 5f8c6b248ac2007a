//! Exercises of chapter 13 that the program judges.

use fredholm::report::exercise::Exercise;

/// All of them.
pub(super) const EXERCISES: &[Exercise] = &[];
