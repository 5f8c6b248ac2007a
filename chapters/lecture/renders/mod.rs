//! Figures of the lecture that are rendered: sheets of pictures with their numbers.
//!
//! | file | figure |
//! |---|---|
//! | [`reflection_equation`] | one reflection of a sky, a lamp and a point light |
//! | [`captured_environments`] | a mirror ball, its map, and an object lit by it |
//! | [`directions`] | uniform, cosine and BSDF directions at equal time |
//! | [`fresnel_choice`] | glass: reflection chosen with the Fresnel probability and with one half |
//! | [`mis`] | BSDF sampling, light sampling, their combination and its weights |
//! | [`roulette`] | three rules that end paths, at equal time |
//! | [`emission_rules`] | when emission counts, and each rule broken once |
//! | [`path_lengths`] | every term and every partial sum at one exposure |
//! | [`unbiased_and_consistent`] | three methods with growing effort |
//!
//! Shared: [`board`] places pictures and text on a slide, [`measure`] renders and measures, [`stage`] has scenes.

use fredholm::report::book::Slide;

mod board;
mod captured_environments;
mod directions;
mod emission_rules;
mod fresnel_choice;
mod measure;
mod mis;
mod path_lengths;
mod reflection_equation;
mod roulette;
mod stage;
mod unbiased_and_consistent;

/// The figures, in the order of the lecture.
pub(crate) const SLIDES: &[Slide] = &[
    reflection_equation::SLIDE,
    captured_environments::SLIDE,
    directions::SLIDE,
    fresnel_choice::SLIDE,
    mis::SLIDE,
    path_lengths::SLIDE,
    roulette::SLIDE,
    emission_rules::SLIDE,
    unbiased_and_consistent::SLIDE,
];
