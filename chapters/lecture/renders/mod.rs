use fredholm::report::book::Slide;

pub const SLIDES: &[Slide] = &[];
