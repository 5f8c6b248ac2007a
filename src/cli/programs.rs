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
#[path = "../../chapters/14_is_it_right.rs"]
pub mod is_it_right;
#[path = "../../chapters/12_mirrors_and_glass.rs"]
pub mod mirrors_and_glass;
#[path = "../../chapters/11_multiple_importance_sampling.rs"]
pub mod multiple_importance_sampling;
#[path = "../../chapters/05_naive_recursion.rs"]
pub mod naive_recursion;
#[path = "../../chapters/06_neumann_series.rs"]
pub mod neumann_series;
#[path = "../../chapters/13_noise.rs"]
pub mod noise;
#[path = "../../chapters/01_one_box_three_answers.rs"]
pub mod one_box_three_answers;
#[path = "../../chapters/09_path_tracing.rs"]
pub mod path_tracing;
#[path = "../../chapters/07_radiosity.rs"]
pub mod radiosity;
#[path = "../../chapters/02_reflection_equation.rs"]
pub mod reflection_equation;
#[path = "../../chapters/10_russian_roulette.rs"]
pub mod russian_roulette;
#[path = "../../chapters/15_spectrum_and_guiding.rs"]
pub mod spectrum_and_guiding;
#[path = "../../chapters/16_where_it_breaks.rs"]
pub mod where_it_breaks;

/// All chapters, in their order.
pub static CHAPTERS: [Chapter; 16] = [
    one_box_three_answers::CHAPTER,
    reflection_equation::CHAPTER,
    choosing_directions::CHAPTER,
    furnace::CHAPTER,
    naive_recursion::CHAPTER,
    neumann_series::CHAPTER,
    radiosity::CHAPTER,
    change_of_measure::CHAPTER,
    path_tracing::CHAPTER,
    russian_roulette::CHAPTER,
    multiple_importance_sampling::CHAPTER,
    mirrors_and_glass::CHAPTER,
    noise::CHAPTER,
    is_it_right::CHAPTER,
    spectrum_and_guiding::CHAPTER,
    where_it_breaks::CHAPTER,
];
