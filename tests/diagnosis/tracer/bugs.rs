//! Mistakes that people make in path tracers.
//!
//! Each entry says what the programmer did wrong. [`Kind`] is the same for the program: the tracer asks for it at the
//! line where the mistake is made. Where the effect on the terms is known, it is given as
//!
//! ```text
//! factor of T_k = (picture with the mistake) / (right picture)
//! ```

/// One mistake, or none ([`RIGHT`]).
pub struct Bug {
    pub name: &'static str,
    /// What the programmer did wrong, in one line.
    pub what: &'static str,
    pub kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    Right,
    /// T_k times π^k.
    NoPi,
    /// T_k times π, for k ≥ 1.
    NoPiInConnection,
    /// T_k times this, for k ≥ 1.
    ConnectionFactor(f64),
    /// T_k times 2, for k ≥ 1.
    LampTwice,
    /// T_0 is black.
    EmissionForgotten,
    /// Roulette from the reflection `from` on. T_k times (survive · factor)^(k − from), for k > from.
    Roulette {
        from: usize,
        survive: f64,
        factor: f64,
    },
    /// One term times `factor`.
    TermFactor {
        term: usize,
        factor: f64,
    },
    /// No terms after this one.
    EndsAfter {
        bounces: usize,
    },
    /// The picture called T_k is T_{k+1}.
    LayersOffByOne,
    /// The camera rays are moved by so many pixels, and the picture the other way.
    Shift {
        right: f64,
        down: f64,
    },
    LeftRight,
    UpsideDown,
    RedBlueSwapped,
    /// The finished pixels are encoded for the screen.
    Srgb,
    Gamma,
    /// Each path is encoded, then the mean is taken.
    PathsEncoded,
    /// No path brings more than 1.
    PathsClamped,
    /// No finished pixel is larger than 1.
    PixelsClamped,
    NoCosine,
    NoLampCosine,
    DistanceNotSquared,
    NoShadows,
    /// Directions are uniform on the hemisphere, but β grows as if they followed the cosine.
    UniformDirections,
    /// Directions follow the cosine, but β grows as if they were uniform.
    UniformDensity,
    AlbedoTwice,
    /// Everything times 0.95.
    Darker,
    HalfLamp,
    LampBothSides,
    SameSeed,
    /// One pixel of T_2 and of the whole picture times this.
    Firefly(f32),
    NotANumber,
    /// T_1 and the whole picture plus this.
    Ambient(f32),
    BlocksInsideOut,
    TallBlockCastsNoShadow,
}

const fn bug(name: &'static str, what: &'static str, kind: Kind) -> Bug {
    Bug { name, what, kind }
}

/// No mistake.
pub const RIGHT: Bug = bug("right", "nothing", Kind::Right);

#[rustfmt::skip] // one line says what, one line says how
pub const BUGS: &[Bug] = &[
    bug("no-pi", "used the albedo as the reflectance everywhere and forgot to divide it by pi",
        Kind::NoPi),
    bug("no-pi-in-connection", "forgot to divide the albedo by pi in the connection to the lamp",
        Kind::NoPiInConnection),
    bug("connection-3-percent-weak", "made the connection to the lamp 3 percent too weak",
        Kind::ConnectionFactor(0.97)),
    bug("connection-half-too-strong", "made the connection to the lamp 1.5 times too strong",
        Kind::ConnectionFactor(1.5)),
    bug("lamp-twice", "connected to the lamp and also counted the lamp when a reflected path ran into it",
        Kind::LampTwice),
    bug("emission-forgotten", "only connected to the lamp and forgot that the camera sees it",
        Kind::EmissionForgotten),
    bug("roulette-unweighted", "let 80 percent of the paths go on after each bounce and did not divide by 0.8",
        Kind::Roulette { from: 1, survive: 0.8, factor: 1.0 }),
    bug("late-roulette-unweighted", "let 70 percent of the paths go on from bounce 3 on and did not divide by 0.7",
        Kind::Roulette { from: 3, survive: 0.7, factor: 1.0 }),
    bug("roulette-weighted-twice", "let 80 percent of the paths go on and divided by 0.8 in two places",
        Kind::Roulette { from: 1, survive: 0.8, factor: 1.0 / (0.8 * 0.8) }),
    bug("roulette-wrong-divisor", "let 60 percent of the paths go on and divided by the 0.4 with which they end",
        Kind::Roulette { from: 1, survive: 0.6, factor: 1.0 / 0.4 }),
    bug("term-2-stronger", "left a factor of 1.2 on the second bounce after looking for another mistake",
        Kind::TermFactor { term: 2, factor: 1.2 }),
    bug("term-3-missing", "left an `if depth != 3` in the loop, so that the third bounce is not added",
        Kind::TermFactor { term: 3, factor: 0.0 }),
    bug("ends-after-3", "ended all paths after three bounces, in the whole picture too",
        Kind::EndsAfter { bounces: 3 }),
    bug("layers-off-by-one", "counted the bounces from 1 and stored them from 0, so that each layer holds the next one",
        Kind::LayersOffByOne),
    bug("half-pixel-right", "added half a pixel to a position that was random in the pixel already",
        Kind::Shift { right: 0.5, down: 0.0 }),
    bug("one-pixel-down", "counted the rows from 1",
        Kind::Shift { right: 0.0, down: 1.0 }),
    bug("left-right", "let the x axis of the camera point to the left",
        Kind::LeftRight),
    bug("upside-down", "stored the rows from the bottom",
        Kind::UpsideDown),
    bug("red-blue-swapped", "stored the channels as blue, green, red",
        Kind::RedBlueSwapped),
    bug("srgb", "stored the values of the screen (sRGB) and not the light",
        Kind::Srgb),
    bug("gamma", "stored the light to the power 1/2.2",
        Kind::Gamma),
    bug("paths-encoded", "took each path to the power 1/2.2 and then the mean",
        Kind::PathsEncoded),
    bug("paths-clamped", "cut each path at 1 to get rid of noise",
        Kind::PathsClamped),
    bug("pixels-clamped", "cut the finished pixels at 1",
        Kind::PixelsClamped),
    bug("no-cosine", "forgot the cosine at the surface in the connection to the lamp",
        Kind::NoCosine),
    bug("no-lamp-cosine", "forgot the cosine at the lamp in the connection to it",
        Kind::NoLampCosine),
    bug("distance-not-squared", "divided by the distance to the lamp and not by its square",
        Kind::DistanceNotSquared),
    bug("no-shadows", "did not look whether something stands between the surface and the lamp",
        Kind::NoShadows),
    bug("uniform-directions", "took uniform directions, but the weight that belongs to the cosine density",
        Kind::UniformDirections),
    bug("uniform-density", "took directions with the cosine density, but the weight that belongs to uniform ones",
        Kind::UniformDensity),
    bug("albedo-twice", "multiplied by the albedo twice at each bounce",
        Kind::AlbedoTwice),
    bug("darker", "divided by the number of paths plus one, when there were 19 paths",
        Kind::Darker),
    bug("half-lamp", "took points on the left half of the lamp only, but with the area of the whole lamp",
        Kind::HalfLamp),
    bug("lamp-both-sides", "took the absolute value of the cosine at the lamp, so that its back shines too",
        Kind::LampBothSides),
    bug("same-seed", "started the random numbers of all pixels with the same seed",
        Kind::SameSeed),
    bug("firefly", "divided by a number near zero in one pixel, which became 3000 times too bright",
        Kind::Firefly(3000.0)),
    bug("not-a-number", "divided zero by zero once in each of three pixels",
        Kind::NotANumber),
    bug("ambient", "added a constant of 0.02 to brighten the shadows",
        Kind::Ambient(0.02)),
    bug("blocks-inside-out", "let the normals of the two blocks point inwards",
        Kind::BlocksInsideOut),
    bug("tall-block-casts-no-shadow", "left the tall block out of the shadow rays",
        Kind::TallBlockCastsNoShadow),
];
