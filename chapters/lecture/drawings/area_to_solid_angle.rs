//! A patch of a lamp and the solid angle that it covers at a point.
//!
//! ```text
//! dω = cos θ_y dA / d²
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | dA | area of the patch, a square of side a, m² | [`Patch::side`] |
//! | d | distance from x to the middle y of the patch, m | [`Patch::distance`] |
//! | θ_y | angle between the patch's normal and the direction from y to x | [`Patch::tilt`] |
//! | dω | solid angle of the patch at x, sr: by the formula, and counted from random directions | [`Patch::formula`], [`counted`] |
//!
//! The formula is the limit for small patches. A square that faces x covers a²/d² (1 − a²/(4d²) + …).
//!
//! Reference: Veach, *Robust Monte Carlo Methods for Light Transport Simulation* (1997), section 3.6.

use super::page::{LEFT, SIZE, View, WIDTH, arc, maths, paragraph, title, words};
use fredholm::math::{Key, Purpose, Rng};
use fredholm::report::book::{Folder, Result, Slide};
use fredholm::report::plot::{
    BLACK, BLUE, Canvas, Colour, Drawn, GREY, GRID, ORANGE, Place, Stroke, VERMILION, figure,
};
use fredholm::report::text::csv::Csv;
use fredholm::report::text::number::{plus_minus, significant};
use glam::DVec3;
use std::f64::consts::PI;

/// This figure.
pub const SLIDE: Slide = Slide {
    id: "area-to-solid-angle",
    topic: "Change of measure: from area on the lamp to solid angle",
    caption: "A patch dA of the lamp is projected onto the unit sphere around x. Its solid angle is the area of the patch, \
              times the cosine at the patch, divided by the squared distance. Twice the distance leaves a quarter of the \
              solid angle, a tilt by 60 degrees leaves one half.",
    scene: "none",
    program,
};

/// A square patch on the axis above x, tilted about the y axis.
#[derive(Clone, Copy)]
struct Patch {
    side: f64,
    distance: f64,
    /// θ_y in degrees.
    tilt: f64,
}

impl Patch {
    fn middle(self) -> DVec3 {
        self.distance * DVec3::Z
    }

    /// Unit vectors along its two edges.
    fn edges(self) -> [DVec3; 2] {
        let (sin, cos) = self.tilt.to_radians().sin_cos();
        [DVec3::new(cos, 0.0, sin), DVec3::Y]
    }

    /// The normal on the side of x.
    fn normal(self) -> DVec3 {
        let [u, v] = self.edges();
        -u.cross(v)
    }

    /// The point with coordinates in [−1, 1]².
    fn point(self, [s, t]: [f64; 2]) -> DVec3 {
        let [u, v] = self.edges();
        self.middle() + 0.5 * self.side * (s * u + t * v)
    }

    /// cos θ_y dA/d².
    fn formula(self) -> f64 {
        self.tilt.to_radians().cos() * self.side.powi(2) / self.distance.powi(2)
    }

    /// Returns true if the direction `w` hits the patch.
    fn hit(self, w: DVec3) -> bool {
        let n = self.normal();
        let p = w * (self.middle().dot(n) / w.dot(n)) - self.middle();
        self.edges().iter().all(|e| e.dot(p).abs() <= 0.5 * self.side)
    }
}

/// Solid angle of the patch and its standard error: the share of `samples` uniform directions inside a cone that hit it,
/// times the solid angle of the cone. Uses no distance law.
fn counted(patch: Patch, samples: u32, seed: u64) -> [f64; 2] {
    // the cone encloses a sphere through the corners of the patch
    let reach: f64 = patch.side * 0.5f64.sqrt() / patch.distance;
    let lowest = (1.0 - reach * reach).sqrt();
    let key = Key::new(seed, "solid angle");
    let hits = (0..samples).filter(|&i| {
        let [u, v, ..] = Rng::at(key, i, 0, 0, Purpose::Start).four().map(f64::from);
        let z = 1.0 - u * (1.0 - lowest);
        let (sin, cos) = (2.0 * PI * v).sin_cos();
        patch.hit(DVec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + z * DVec3::Z)
    });
    let (n, cone) = (f64::from(samples), 2.0 * PI * (1.0 - lowest));
    let share = hits.count() as f64 / n;
    [cone * share, cone * (share * (1.0 - share) / n).sqrt()]
}

/// How the solid angles of the panels are counted.
const COUNTED: &str = "Counted: the share of random directions that hit a square of 0.1 m. The drawing is not to scale. The \
                       formula holds for small patches, here to 0.2 %.";
/// Margin of the formula for the patches shown: a²/(4d²) is below 0.07 %.
const MARGIN: f64 = 0.002;
const FIRST: Patch = Patch { side: 0.1, distance: 2.0, tilt: 0.0 };
const CASES: [(&str, Patch); 3] = [
    ("facing x, d = 2 m", FIRST),
    ("twice the distance, d = 4 m", Patch { distance: 4.0, ..FIRST }),
    ("tilted, θ_y = 60°, d = 2 m", Patch { tilt: 60.0, ..FIRST }),
];

fn program(folder: &Folder<'_>) -> Result<()> {
    let samples = folder.pick(4_000_000, 400_000);
    let mut csv = Csv::new("patch,side,distance,tilt,formula,counted,std_error");
    let mut measured = vec![];
    for (name, patch) in CASES {
        let [solid, error] = counted(patch, samples, folder.seed);
        if (solid - patch.formula()).abs() > MARGIN * patch.formula() + 4.0 * error {
            return Err(format!("{name}: counted {solid} ± {error} sr, formula {} sr", patch.formula()).into());
        }
        csv.put(name).numbers([patch.side, patch.distance, patch.tilt, patch.formula(), solid, error]).end();
        measured.push([solid, error]);
    }
    let drawing = figure(SLIDE.id, WIDTH, 552, &folder.caption(SLIDE.scene), |page| {
        title(page, SLIDE.topic)?;
        sphere(page)?;
        equation(page)?;
        let cases = CASES.iter().zip(&measured).enumerate();
        paragraph(page, COUNTED, (540.0, 300.0), 400.0, words(SIZE, GREY))?;
        for (i, (&(name, patch), &solid)) in cases {
            case(page, (name, patch), (solid, measured[0]), LEFT + 312.0 * i as f64)?;
        }
        Ok(())
    })?;
    folder.figure(SLIDE.id, &drawing)?;
    folder.text("area-to-solid-angle.csv", &csv.text())?;
    Ok(())
}

/// A point on the unit hemisphere by polar angle and azimuth.
fn on_sphere(theta: f64, phi: f64) -> DVec3 {
    DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
}

/// The boundary of a patch, with `n` points on each edge.
fn boundary(patch: Patch, n: usize) -> Vec<DVec3> {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let edge = |c: usize| {
        let [a, b] = [corners[c], corners[(c + 1) % 4]];
        (0..n).map(move |i| {
            let t = i as f64 / n as f64;
            patch.point([0, 1].map(|j| a[j] + t * (b[j] - a[j])))
        })
    };
    (0..4).flat_map(edge).collect()
}

/// The drawing in space: hemisphere, patch, the cone between x and the patch, and the projected patch.
fn sphere(page: &Canvas<'_>) -> Drawn {
    let [raised, turned] = [20.0f64, 38.0].map(f64::to_radians);
    let right = DVec3::new(turned.cos(), -turned.sin(), 0.0);
    let up = DVec3::new(raised.sin() * turned.sin(), raised.sin() * turned.cos(), raised.cos());
    let view = View { right, up, scale: 122.0, origin: (LEFT + 170.0, 282.0) };
    let grid = Stroke::solid(GRID, 1.2);
    let circle = |theta: f64| (0..=72).map(|i| on_sphere(theta, PI * f64::from(i) / 36.0)).collect::<Vec<_>>();
    for i in 1..6 {
        page.path(&view.all(&circle(PI / 12.0 * f64::from(i))), grid)?;
    }
    for i in 0..12 {
        let meridian: Vec<DVec3> =
            (0..=24).map(|j| on_sphere(PI / 48.0 * f64::from(j), PI / 6.0 * f64::from(i))).collect();
        page.path(&view.all(&meridian), grid)?;
    }
    page.path(&view.all(&circle(0.5 * PI)), Stroke::solid(GREY, 1.6))?;
    arc(page, view.origin, view.scale, [0.0, PI], Stroke::solid(GREY, 1.6))?;

    // the patch of the drawing is larger than those of the panels, turned away from the axis, and tilted
    let lean = 52.0f64.to_radians();
    let turn = glam::DQuat::from_rotation_y(lean);
    let patch = Patch { side: 0.75, distance: 1.95, tilt: -35.0 };
    let outer: Vec<DVec3> = boundary(patch, 12).into_iter().map(|p| turn * p).collect();
    let inner: Vec<DVec3> = outer.iter().map(|p| p.normalize()).collect();
    for i in (0..outer.len()).step_by(12) {
        page.line(view.origin, view.at(outer[i]), Stroke { color: ORANGE, width: 1.3, dash: Some((5.0, 4.0)) })?;
    }
    page.polygon(&view.all(&inner), BLUE)?;
    page.polygon(&view.all(&outer), ORANGE)?;
    let y = turn * patch.middle();
    page.line(view.origin, view.at(y), Stroke::solid(BLACK, 1.6))?;
    page.disk(view.origin, 4.5, BLACK)?;
    page.disk(view.at(y), 4.0, BLACK)?;
    let tip = y + 0.62 * (turn * patch.normal());
    page.arrow(view.at(y), view.at(tip), Stroke::solid(VERMILION, 2.2))?;
    angle(page, view.at(y), [view.at(tip), view.origin], 40.0, VERMILION)?;
    page.arrow(view.origin, view.at(1.3 * DVec3::Z), Stroke::solid(GREY, 1.8))?;
    angle(page, view.origin, [view.at(DVec3::Z), view.at(y)], 46.0, GREY)?;

    let label = |text: &str, (x, y): Place, (dx, dy): Place, color: Colour| {
        maths(page, text, (x + dx, y + dy), words(17.0, color))
    };
    label("x", view.origin, (-6.0, 18.0), BLACK)?;
    label("n", view.at(1.3 * DVec3::Z), (-18.0, 4.0), GREY)?;
    label("θ_x", view.origin, (10.0, -58.0), GREY)?;
    label("y", view.at(y), (8.0, -10.0), BLACK)?;
    label("d", view.at(0.72 * y), (8.0, 14.0), BLACK)?;
    label("n_y", view.at(tip), (-10.0, 16.0), VERMILION)?;
    label("dA", view.at(outer[12]), (14.0, 0.0), ORANGE)?;
    label("dω", view.at(inner[12]), (26.0, 22.0), BLUE)
}

/// The arc of an angle at `at` between the directions to two places.
fn angle(page: &Canvas<'_>, at: Place, ends: [Place; 2], radius: f64, color: Colour) -> Drawn {
    let [from, to] = ends.map(|(x, y)| (at.1 - y).atan2(x - at.0));
    // the short way round
    let turn = (to - from + 3.0 * PI).rem_euclid(2.0 * PI) - PI;
    arc(page, at, radius, [from, from + turn], Stroke::solid(color, 1.8))
}

/// The equation with its words.
fn equation(page: &Canvas<'_>) -> Drawn {
    let x = 540.0;
    maths(page, "dω = cos θ_y dA / d²", (x, 84.0), words(26.0, BLACK))?;
    let rows = [
        ("dA", "area of the patch, m²", ORANGE),
        ("θ_y", "angle between its normal n_y and the direction to x", VERMILION),
        ("d", "distance from x to y, m", BLACK),
        ("dω", "solid angle at x, sr: an area on the unit sphere", BLUE),
    ];
    for (i, (symbol, meaning, color)) in rows.into_iter().enumerate() {
        let y = 128.0 + 25.0 * i as f64;
        maths(page, symbol, (x, y), words(16.0, color))?;
        maths(page, meaning, (x + 34.0, y), words(SIZE, BLACK))?;
    }
    maths(page, "In densities: p_ω = p_A d² / cos θ_y", (x, 242.0), words(18.0, BLACK))?;
    maths(page, "θ_x belongs to the irradiance, not to dω.", (x, 270.0), words(SIZE, GREY))
}

/// A panel: the patch from the side, and its solid angle by formula and by count, as a multiple of the first.
fn case(
    page: &Canvas<'_>,
    (name, patch): (&str, Patch),
    ([solid, error], [first, first_error]): ([f64; 2], [f64; 2]),
    left: f64,
) -> Drawn {
    let top = 361.0;
    maths(page, name, (left, top), words(16.0, BLACK))?;
    // the side view: x on the left, the patch on the right; the patch is drawn six times as wide
    let (scale, wide) = (58.0, 6.0);
    let x = (left + 14.0, top + 64.0);
    let at = |p: DVec3| (x.0 + scale * p.z, x.1 - scale * p.x);
    let drawn = Patch { side: wide * patch.side, ..patch };
    let ends = [drawn.point([-1.0, 0.0]), drawn.point([1.0, 0.0])];
    arc(page, x, scale, [-0.5 * PI * 0.8, 0.5 * PI * 0.8], Stroke::solid(GREY, 1.4))?;
    for end in ends {
        page.line(x, at(end), Stroke { color: ORANGE, width: 1.3, dash: Some((5.0, 4.0)) })?;
    }
    page.line(at(ends[0]), at(ends[1]), Stroke::solid(ORANGE, 5.0))?;
    let [low, high] = ends.map(|p| p.x.atan2(p.z));
    arc(page, x, scale, [low, high], Stroke::solid(BLUE, 5.0))?;
    page.disk(x, 4.0, BLACK)?;
    if patch.tilt != 0.0 {
        let (y, tip) = (at(patch.middle()), at(patch.middle() + 0.8 * patch.normal()));
        page.arrow(y, tip, Stroke::solid(VERMILION, 1.8))?;
        angle(page, y, [tip, x], 26.0, VERMILION)?;
        maths(page, "θ_y", (y.0 - 50.0, y.1 - 22.0), words(SIZE, VERMILION))?;
    }
    let milli = |value: f64, error: f64| format!("{} · 10⁻³ sr", plus_minus(1e3 * value, 1e3 * error, 1));
    let ratio = solid / first;
    let relative = if ratio == 1.0 {
        "1".into()
    } else {
        plus_minus(ratio, ratio * (error / solid).hypot(first_error / first), 1)
    };
    let lines = [
        (format!("by the formula: {} · 10⁻³ sr", significant(1e3 * patch.formula(), 4)), BLACK),
        (format!("counted: {}", milli(solid, error)), BLUE),
        (format!("relative to the first: {relative}"), BLUE),
    ];
    for (i, (line, color)) in lines.iter().enumerate() {
        page.text(line, (left, top + 129.0 + 20.0 * i as f64), words(SIZE, *color))?;
    }
    Ok(())
}
