//! The rule when emission counts on a hit, and what happens if one part of it is broken.
//!
//! ```text
//! right:  at the eye 1        on a hit, p° > 0: w_s = p/(p + p°)        on a hit, p° = 0: 1        r_k = T_k^wrong/T_k^right
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | p, p° | densities of the direction and of a connection to the same point; p° = 0 after a mirror or glass | [`Technique`] |
//! | w_s, w_c | weights of a hit and of a connection; w_s + w_c = 1 | [`Technique::hit`], [`Technique::connection`] |
//! | r_k | ratio of the k-th term of a wrong renderer to the right one | [`Ratio`] |
//!
//! The wrong renderers are members of the zoo. Reference: Veach, *Robust Monte Carlo Methods for Light Transport Simulation*
//! (1997), ch. 9.

use super::board::{Board, Tile};
use super::measure::{REPLICATES, Shot, built_in};
use fredholm::estimator::{Plan, Roulette, Technique};
use fredholm::report::book::{Folder, Result, Slide};
use fredholm::report::half_width_95;
use fredholm::report::image::picture::{auto_gain_beside_lamps, gain_label};
use fredholm::report::text::csv::Csv;
use fredholm::report::text::number::plus_minus;
use fredholm::scene::Scene;
use fredholm::scene::bsdf::Sampling;
use fredholm::zoo::{self, Mistake, Right, Walk, signature::Ratio};

/// This slide.
pub(crate) const SLIDE: Slide = Slide {
    id: "emission-rules",
    topic: "When does emission count?",
    caption: "On the left the correct image. In the other pictures one rule is broken. If emission does not count at the \
              eye, the lamp is black. If it counts twice, everything but the lamp and its mirror image is about twice as bright. If it never counts \
              after a mirror or glass, the spheres lose the lamp and the floor loses the caustics.",
    scene: "cornell-spheres",
    program,
};

/// K: the last term.
const K: usize = 4;

/// A renderer: its name in the zoo (none: the correct one), its technique, the rule that it breaks, and what to look at.
struct Case {
    name: Option<&'static str>,
    technique: Technique,
    label: &'static str,
    look: &'static str,
}

const CASES: [Case; 4] = [
    Case { name: None, technique: Technique::Mis, label: "Right", look: "every path counts once" },
    Case {
        name: Some("emission-missing"),
        technique: Technique::Mis,
        label: "Broken: 0 at the eye",
        look: "the lamp is black",
    },
    Case {
        name: Some("double-emission"),
        technique: Technique::Mis,
        label: "Broken: weights 1 + 1",
        look: "hit 1 and connection 1",
    },
    Case {
        name: Some("no-emission-after-mirror"),
        technique: Technique::Connect,
        label: "Broken: 0 after a mirror",
        look: "and after glass: no caustics",
    },
];

fn program(folder: &Folder<'_>) -> Result<()> {
    let size = folder.pick(222, 111);
    let scene = Scene::new(&built_in("cornell-spheres", [size, size])?);
    let spp = folder.pick(32, 16);
    let shots = CASES.iter().map(|case| {
        let mistake: &dyn Mistake = match case.name {
            None => &Right,
            Some(name) => zoo::find(name).ok_or_else(|| format!("the zoo has no member {name}"))?.mistake,
        };
        let plan = Plan { max_bounces: K, technique: case.technique, roulette: Roulette::Never };
        Ok(Shot::new(&scene, Sampling::Bsdf, &Walk { plan, mistake }, spp, case.label, folder))
    });
    let shots = shots.collect::<Result<Vec<Shot>>>()?;
    let right = &shots[0];
    let gain = auto_gain_beside_lamps(&right.image(0..K + 1).mean, &right.image(0..1).mean);
    let ratio = |shot: &Shot, k: usize| Ratio::of(&shot.estimate(k..k + 1), &right.estimate(k..k + 1));
    let mut csv = Csv::new("renderer,term,ratio,std_error");
    let mut tiles = vec![];
    for (case, shot) in CASES.iter().zip(&shots) {
        let mut notes = vec![case.look.to_string()];
        if case.name.is_some() {
            let mean = Ratio::of(&shot.estimate(0..K + 1), &right.estimate(0..K + 1));
            notes.push(format!("mean/right = {}", words(mean)));
            notes.extend((0..4).map(|k| format!("r{} = {}", subscript(k), words(ratio(shot, k)))));
            (0..=K).for_each(|k| {
                let r = ratio(shot, k);
                csv.put(case.label).put(k).numbers([r.value, r.std_error]).end();
            });
        } else {
            notes.push(format!("mean {}", super::measure::words(&shot.estimate(0..K + 1))));
            notes.push("rₖ = 1 for every k".into());
        }
        tiles.push(Tile::new(size, &shot.image(0..K + 1).mean, gain, case.label, notes).enlarged(folder.pick(1, 2)));
    }
    check(&ratio, &shots)?;
    let mut board = Board::new(
        "Emission counts once: at the eye, and on a hit with the weight of MIS",
        &format!(
            "p: density of the sampled direction. p°: density with which a connection finds the same point. Scene with a \
             mirror and a glass sphere, k ≤ {K}, {spp} samples per pixel, gain {}.",
            gain_label(gain)
        ),
    );
    let rules = [
        "at the eye: weight 1",
        "on a hit with p° > 0: weight p/(p + p°), and the connection gets p°/(p + p°)",
        "on a hit with p° = 0 (after a mirror or glass, where no connection is possible): weight 1",
    ];
    for rule in rules {
        board.lines(&format!("•  {rule}"), 15.0);
    }
    board.y += 8.0;
    board.wide_row(tiles);
    board.lines("rₖ = term k of the wrong image over term k of the right one; ± is the 95 % interval.", 14.0);
    folder.text("emission-rules.csv", &csv.text())?;
    board.finish(folder, &SLIDE, |_| Ok(()))
}

fn subscript(k: usize) -> char {
    ['₀', '₁', '₂', '₃'][k]
}

/// A ratio with its 95 % interval.
fn words(r: Ratio) -> String {
    if r.std_error > 0.0 {
        return plus_minus(r.value, half_width_95(r.std_error, u64::from(REPLICATES)), 1);
    }
    format!("{:.2}", r.value)
}

/// What the pictures are said to show: r_0 = 0, r_1 nearly 2 (paths over the mirror count once), and less than 1 for k = 3.
fn check(ratio: &impl Fn(&Shot, usize) -> Ratio, shots: &[Shot]) -> Result<()> {
    let [_, missing, double, mirror] = shots else { return Err("four renderers are expected".into()) };
    let (r0, r1, r3) = (ratio(missing, 0), ratio(double, 1), ratio(mirror, 3));
    if r0.value != 0.0 {
        return Err(format!("without emission at the eye, r_0 = {}", r0.value).into());
    }
    if (r1.value - 1.9).abs() + 2.0 * r1.std_error > 0.2 {
        return Err(format!("with emission counted twice, r_1 = {} ± {}", r1.value, r1.std_error).into());
    }
    if r3.value + 3.0 * r3.std_error > 1.0 {
        return Err(format!("without emission after mirrors, r_3 = {} ± {}", r3.value, r3.std_error).into());
    }
    Ok(())
}
