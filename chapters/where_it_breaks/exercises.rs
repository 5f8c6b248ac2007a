//! Exercises of chapter 16 that the program judges.

use fredholm::report::exercise::Exercise;

/// All of them.
pub(super) const EXERCISES: &[Exercise] = &[];
