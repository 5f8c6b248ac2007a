//! Figures of the lecture that are drawings: geometry, paths, trees, and the program itself.

mod area_to_solid_angle;
mod one_path;
mod page;
mod prefix_reuse;
mod pseudocode;
mod radiance_along_a_ray;
mod recursion_tree;

use fredholm::report::book::Slide;

/// The figures of this folder.
pub const SLIDES: &[Slide] = &[
    one_path::SLIDE,
    prefix_reuse::SLIDE,
    recursion_tree::SLIDE,
    area_to_solid_angle::SLIDE,
    pseudocode::SLIDE,
    radiance_along_a_ray::SLIDE,
];
