//! Mistakes that only the diagnosis simulates: members of the zoo with other parameters, and mistakes that have no page of their own.
//!
//! | family | what is varied |
//! |---|---|
//! | clamped samples | the level |
//! | albedo | its power: used twice, encoded for a display, decoded twice |
//! | roulette without its weight | survival by albedo or by throughput, and its start |
//! | points on a light | which part of the light they cover |
//! | factors of the connection | powers of the distance and of the cosines |
//! | weights of two techniques | which of the two has a weight |

use crate::estimator::{Plan, Roulette, Technique};
use crate::math::Rgb;
use crate::scene::Scene;
use crate::zoo::bookkeeping::Clamped;
use crate::zoo::mistake::{Connection, Mistake};
use std::f32::consts::FRAC_1_PI;

/// Its effect is nearly that of a light that is moved by a quarter of its width.
const HALF: &str = "points are sampled on one half of the light only, or the light is moved";

/// A mistake with a parameter.
pub(super) struct Variant {
    pub(super) name: String,
    pub(super) what: String,
    technique: Technique,
    roulette: Option<Roulette>,
    pub(super) mistake: Box<dyn Mistake>,
}

impl Variant {
    /// The plan of its renderer, given that of the settings.
    pub(super) fn plan(&self, max_bounces: usize, usual: &Roulette) -> Plan {
        let roulette = self.roulette.clone().unwrap_or_else(|| usual.clone());
        Plan { max_bounces, technique: self.technique, roulette }
    }
}

/// All variants.
// long, because it is a table: a line or two for each variant
pub(super) fn all() -> Vec<Variant> {
    let connect = |name: &str, what: &str, mistake: Box<dyn Mistake>| Variant {
        name: name.into(),
        what: what.into(),
        technique: Technique::Connect,
        roulette: None,
        mistake,
    };
    let clamped = |level: f32| {
        connect(&format!("clamped at {level}"), &format!("samples are clamped at {level}"), Box::new(Clamped(level)))
    };
    let mut all: Vec<Variant> = [0.1, 0.25, 1.0, 2.0, 5.0, 10.0, 20.0].map(clamped).into();
    all.extend([
        connect("albedo-twice", "every reflection is multiplied by the albedo twice", Box::new(Albedo(2.0))),
        connect(
            "albedo-encoded",
            "the albedo is encoded for a display: ρ^(1/2.2) instead of ρ",
            Box::new(Albedo(1.0 / 2.2)),
        ),
        connect(
            "albedo-decoded",
            "the albedo is decoded although it is linear: ρ^2.2 instead of ρ",
            Box::new(Albedo(2.2)),
        ),
        connect("half-lamp", HALF, Box::new(Points(|u| [0.5 * u[0], u[1]]))),
        connect("half-lamp, other half", HALF, Box::new(Points(|u| [0.5 + 0.5 * u[0], u[1]]))),
        connect("half-lamp, other side", HALF, Box::new(Points(|u| [u[0], 0.5 * u[1]]))),
        connect("half-lamp, far side", HALF, Box::new(Points(|u| [u[0], 0.5 + 0.5 * u[1]]))),
        connect(
            "lamp-corner",
            "points on the light cluster in a corner: u² instead of u",
            Box::new(Points(|u| [u[0] * u[0], u[1] * u[1]])),
        ),
        connect(
            "lamp-edge",
            "points on the light cluster at an edge: u² instead of u in one direction",
            Box::new(Points(|u| [u[0] * u[0], u[1]])),
        ),
        connect("lamp-centre", "the centre of the light is always sampled", Box::new(Points(|_| [0.5, 0.5]))),
        connect(
            "distance-not-squared",
            "the connection is divided by r instead of r²",
            Box::new(Factor(|c| c.r2.sqrt())),
        ),
        connect(
            "light-cosine-twice",
            "the connection contains the cosine at the light twice",
            Box::new(Factor(|c| c.cos_y)),
        ),
        connect(
            "receiver-cosine-twice",
            "the connection contains the cosine at the surface twice",
            Box::new(Factor(|c| c.cos_x)),
        ),
        connect(
            "both-cosines-missing",
            "the connection lacks both cosines",
            Box::new(Factor(|c| 1.0 / (c.cos_x * c.cos_y))),
        ),
    ]);
    let mis = |name: &str, what: &str, shares: [bool; 2], hits: bool| Variant {
        technique: Technique::Mis,
        ..connect(name, what, Box::new(Shares { shares, hits }))
    };
    all.extend([
        mis("mis-hits-unweighted", "connections have their MIS weight, and hits count fully", [true, false], true),
        mis(
            "mis-connections-unweighted",
            "hits have their MIS weight, and connections count fully",
            [false, true],
            true,
        ),
        mis("mis-hits-missing", "connections have their MIS weight, and hits are not counted", [true, false], false),
    ]);
    for from in 0..4 {
        let unweighted = |rule: &str, roulette| Variant {
            roulette: Some(roulette),
            ..connect(
                &format!("roulette-unweighted by {rule} from vertex {from}"),
                &format!("survivors of Russian roulette are not weighted; survival by {rule}, from vertex {from} on"),
                Box::new(Unweighted),
            )
        };
        all.push(unweighted("throughput", Roulette::Throughput { from }));
        all.push(unweighted("albedo", Roulette::Albedo { from }));
    }
    all
}

/// The albedo is raised to a power.
struct Albedo(f32);
impl Mistake for Albedo {
    fn lambert(&self, rho: Rgb) -> Rgb {
        rho.powf(self.0) * FRAC_1_PI
    }
}

/// Points on a light are sampled with other numbers.
struct Points(fn([f32; 2]) -> [f32; 2]);
impl Mistake for Points {
    fn light_numbers(&self, _: &Scene, u: [f32; 4]) -> [f32; 4] {
        let [a, b] = self.0([u[2], u[3]]);
        [u[0], u[1], a, b]
    }
}

/// The connection has one more factor.
struct Factor(fn(&Connection) -> f32);
impl Mistake for Factor {
    fn density(&self, c: &Connection) -> f32 {
        c.per_angle / (self.0)(c)
    }
}

/// Which of connections and hits have their MIS weight; the others count fully, or hits not at all.
struct Shares {
    shares: [bool; 2],
    hits: bool,
}
impl Mistake for Shares {
    fn connection_share(&self, technique: Technique, c: &Connection, other: f32) -> f32 {
        if self.shares[0] { technique.connection(c.per_angle, other) } else { 1.0 }
    }

    fn hit_share(&self, technique: Technique, p: f32, other: f32) -> f32 {
        match (self.hits, self.shares[1]) {
            (false, _) => 0.0,
            (true, true) => technique.hit(p, other),
            (true, false) => 1.0,
        }
    }
}

/// Survivors of roulette keep their weight.
struct Unweighted;
impl Mistake for Unweighted {
    fn survivor(&self, _: f32) -> f32 {
        1.0
    }
}
