//! The programs of the chapters, compiled in. They stand outside `src`, because each is also an example of its own. The tests
//! of the chapters read this list, too.
#![allow(dead_code)] // their `main` is for `cargo run --example`

use fredholm::report::book::Chapter;

#[path = "../../chapters/08_change_of_measure.rs"]
pub mod change_of_measure;
#[path = "../../chapters/03_choosing_directions.rs"]
pub mod choosing_directions;
#[path = "../../chapters/04_furnace.rs"]
pub mod furnace;
#[path = "../../chapters/05_naive_recursion.rs"]
pub mod naive_recursion;
#[path = "../../chapters/06_neumann_series.rs"]
pub mod neumann_series;
#[path = "../../chapters/01_one_box_three_answers.rs"]
pub mod one_box_three_answers;
#[path = "../../chapters/07_radiosity.rs"]
pub mod radiosity;
#[path = "../../chapters/02_reflection_equation.rs"]
pub mod reflection_equation;

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
