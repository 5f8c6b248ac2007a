//! The figures by name: the figures of the lecture in its order, then the others.

use super::slides::{drawings, renders};
use fredholm::report::book::Slide;
use fredholm::study::stages::{KAJIYA, NOISE, Recipe};

/// A figure with a name.
pub struct Named {
    pub id: &'static str,
    /// The topic of the lecture, or the title.
    pub topic: &'static str,
    /// Words that a teacher can read aloud.
    pub caption: &'static str,
    /// The picture in the folder of the figure.
    pub picture: String,
    pub kind: Kind,
}

/// The way in which a figure is made.
#[derive(Clone, Copy)]
pub enum Kind {
    /// A program of the lecture.
    Slide(&'static Slide),
    /// One image at growing numbers of paths per pixel.
    Stages(&'static Recipe),
    /// The figure of another command: its words, and the words that make it short.
    Command(&'static [&'static str], &'static [&'static str]),
    /// The pictures of a homework.
    Homework,
    /// Time and memory against the size of the work.
    Growth,
}

/// A figure that another command makes.
struct OfCommand {
    id: &'static str,
    topic: &'static str,
    caption: &'static str,
    picture: &'static str,
    words: &'static [&'static str],
    quick: &'static [&'static str],
}

const SMALL: &[&str] = &["--size", "32x32", "--spp", "16"];
const SMALL_MESH: &[&str] = &["--size", "32x32", "--spp", "16", "--patches", "120"];

const COMMANDS: &[OfCommand] = &[
    OfCommand {
        id: "equilibrium-cornell",
        topic: "The rendering equation: equilibrium at every point",
        caption: "At points chosen at random, the radiance is estimated twice: once as L, once as E + T L. Each mark is one point \
                  with the difference of the two and its error bar. All of them lie around zero: the light is in equilibrium.",
        picture: "equilibrium.png",
        words: &["check", "equilibrium", "cornell", "--spp", "16384"],
        quick: &["--size", "32x32", "--spp", "256"],
    },
    OfCommand {
        id: "decay-cornell",
        topic: "The Neumann series and its decay",
        caption: "The mean of each term over all surfaces, on a logarithmic axis. The terms fall, at first \
                  by different factors, later by the same factor each time: the spectral radius of T. The bound from the largest \
                  albedo lies far above.",
        picture: "decay.png",
        words: &[
            "series",
            "cornell",
            "--size",
            "128x128",
            "--spp",
            "128",
            "--max-bounces",
            "12",
            "--estimator",
            "single",
        ],
        quick: SMALL_MESH,
    },
    OfCommand {
        id: "three-answers",
        topic: "One equation, three solutions",
        caption: "The same room three times: the sum of the terms, the path tracer, and the radiosity matrix. They are different \
                  programs for the same equation, and the verdicts say with error bars whether they agree.",
        picture: "three.png",
        words: &["series", "cornell", "--size", "600x600", "--spp", "16", "--patches", "2400"],
        quick: SMALL_MESH,
    },
    OfCommand {
        id: "modes-cornell",
        topic: "T as a matrix: eigenvalues and modes",
        caption: "The operator T cut into patches is a matrix. Its largest eigenvalue is the factor by which late terms fall, \
                  and its mode, painted on the walls, is the form that they approach.",
        picture: "modes-painted.png",
        words: &["radiosity", "cornell", "--modes", "8", "--patches", "1200", "--size", "444x444", "--spp", "32"],
        quick: SMALL_MESH,
    },
    OfCommand {
        id: "variance-cornell",
        topic: "Variance against samples per pixel",
        caption: "The variance of a pixel falls as 1/n for every estimator: with four times the samples, half the noise. The \
                  estimators differ in height, not in slope.",
        picture: "variance.png",
        words: &[
            "sweep",
            "cornell",
            "--over",
            "spp",
            "--estimator",
            "single,prefix,path",
            "--size",
            "64x64",
            "--max-bounces",
            "6",
        ],
        quick: SMALL,
    },
    OfCommand {
        id: "sobol-cornell",
        topic: "Independent and Sobol points",
        caption: "Evenly spread points make the variance of the first terms fall faster than 1/n. Independent points never do.",
        picture: "variance.png",
        words: &[
            "sweep",
            "cornell",
            "--over",
            "spp",
            "--points",
            "independent,sobol",
            "--size",
            "64x64",
            "--max-bounces",
            "4",
        ],
        quick: SMALL,
    },
    OfCommand {
        id: "drifting-eigenvalues",
        topic: "Eigenvalues on finer meshes: the scene's settle, the mesh's drift",
        caption: "Each line follows one eigenvalue of T from a coarse mesh to a fine one. Those of the scene settle; those \
                  inside the band belong to the mesh and drift.",
        picture: "eigenvalues.png",
        words: &[
            "sweep",
            "cornell",
            "--over",
            "patches",
            "--values",
            "129,516,2064",
            "--eigenvalues",
            "8",
            "--spp",
            "16",
            "--size",
            "32x32",
            "--max-bounces",
            "2",
        ],
        quick: &["--values", "33,129,258"],
    },
    OfCommand {
        id: "split-cornell",
        topic: "Where samples go: equal split, optimal split, one path for all terms",
        caption: "The same number of rays, divided among the terms in three ways. Bars show the variance of the whole image.",
        picture: "covariance.png",
        words: &["sweep", "cornell", "--over", "split", "--size", "64x64", "--max-bounces", "6"],
        quick: SMALL,
    },
];

/// The homework.
pub const HOMEWORK: &str = "cs184-part4";

/// The figure of times and memory.
pub const GROWTH: &str = "growth";

/// The figures of the lecture, in its order.
pub const LECTURE: &[&str] = &[
    "reflection-equation",
    "radiance-along-a-ray",
    "captured-environments",
    "directions",
    "area-to-solid-angle",
    "equilibrium-cornell",
    "recursion-tree",
    "kajiya-series",
    "path-lengths",
    "decay-cornell",
    "three-answers",
    "modes-cornell",
    "one-path",
    "prefix-reuse",
    "pseudocode",
    "emission-rules",
    "roulette",
    "mis",
    "fresnel-choice",
    "noise-paths",
    "variance-cornell",
    "unbiased-and-consistent",
];

/// Every figure: the lecture's first, in its order.
pub fn all() -> Vec<Named> {
    let slides = drawings::SLIDES.iter().chain(renders::SLIDES).map(|s| Named {
        id: s.id,
        topic: s.topic,
        caption: s.caption,
        picture: format!("{}.png", s.id),
        kind: Kind::Slide(s),
    });
    let captions = [
        (
            &KAJIYA,
            "The same view with 4, 8, … 128 paths per pixel. The noise falls as one over the square root of the number of paths. \
             The mean stays: what looks darker with few paths is light that the screen cuts off.",
        ),
        (
            &NOISE,
            "A caustic with 10, 100 and 1000 paths per pixel. Few paths find the light, and those that do are very bright. The \
             mean is right each time.",
        ),
    ];
    let stages = captions.into_iter().map(|(recipe, caption)| Named {
        id: recipe.id,
        topic: recipe.title,
        caption,
        picture: format!("{}.png", recipe.id),
        kind: Kind::Stages(recipe),
    });
    let commands = COMMANDS.iter().map(|c| Named {
        id: c.id,
        topic: c.topic,
        caption: c.caption,
        picture: c.picture.into(),
        kind: Kind::Command(c.words, c.quick),
    });
    let homework = Named {
        id: HOMEWORK,
        topic: "Homework: every bounce alone and added up, roulette, 1 to 1024 samples",
        caption: "Every bounce alone, then added up; the same with Russian roulette; and the image with 1 to 1024 samples per \
                  pixel. The terms with and without roulette are compared: roulette changes the noise, not the mean.",
        picture: "bounces-one-exposure.png".into(),
        kind: Kind::Homework,
    };
    let growth = Named {
        id: GROWTH,
        topic: "How cost grows: samples, pixels, K, triangles, lights, patches, threads",
        caption: "CPU time against the size of the work, both on logarithmic axes. The slope is the exponent: 1 means that twice the \
                  work takes twice the time, 0 that it costs nothing more. Dashed is what the algorithm promises.",
        picture: "growth.png".into(),
        kind: Kind::Growth,
    };
    let mut all: Vec<Named> = slides.chain(stages).chain(commands).chain([homework, growth]).collect();
    all.sort_by_key(|f| LECTURE.iter().position(|id| *id == f.id).unwrap_or(LECTURE.len()));
    all
}
