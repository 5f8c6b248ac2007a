//! The programs of the chapters, compiled in. They stand outside `src`, because each is also an example of its own.
#![allow(dead_code)] // their `main` is for `cargo run --example`

use fredholm::report::book::Chapter;

#[path = "../../chapters/08_change_of_measure.rs"]
mod change_of_measure;
#[path = "../../chapters/03_choosing_directions.rs"]
mod choosing_directions;
#[path = "../../chapters/04_furnace.rs"]
mod furnace;
#[path = "../../chapters/05_naive_recursion.rs"]
mod naive_recursion;
#[path = "../../chapters/06_neumann_series.rs"]
mod neumann_series;
#[path = "../../chapters/01_one_box_three_answers.rs"]
mod one_box_three_answers;
#[path = "../../chapters/07_radiosity.rs"]
mod radiosity;
#[path = "../../chapters/02_reflection_equation.rs"]
mod reflection_equation;

/// All chapters, in their order.
pub const CHAPTERS: [Chapter; 8] = [
    one_box_three_answers::CHAPTER,
    reflection_equation::CHAPTER,
    choosing_directions::CHAPTER,
    furnace::CHAPTER,
    naive_recursion::CHAPTER,
    neumann_series::CHAPTER,
    radiosity::CHAPTER,
    change_of_measure::CHAPTER,
];
