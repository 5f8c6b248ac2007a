//! Multiple importance sampling: two ways to find the light, their combination, and its weights.
//!
//! ```text
//! direct light = E[ w_s f cos θ/p_s · E(y) ] + E[ w_c f cos θ/p_c · E(y) ]      w_s = p_s/(p_s + p_c),   w_s + w_c = 1
//! share = D_s/(D_s + D_c)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | p_s, p_c | densities of BSDF sampling and of light sampling for the same direction | `Factors::pair` |
//! | w_s, w_c | weights of the balance heuristic | [`Technique::hit`], [`Technique::connection`] |
//! | D_s, D_c | the two parts of the direct light that MIS takes from BSDF sampling and from light sampling | slots 0 and 1 of [`Parts`] |
//!
//! With `Scatter` the weights are (1, 0), with `Connect` (0, 1); so one estimator renders all pictures. Reference: Veach and
//! Guibas, *Optimally Combining Sampling Techniques* (1995).

use super::board::{Board, GAP, MARGIN, Tile, WIDTH};
use super::measure::{Interval, Shot};
use fredholm::estimator::{Job, Paths, Technique, TermEstimator, TermSink};
use fredholm::math::{Columns, Purpose, Rgb, Rng};
use fredholm::operator::{Kernel, Sensor};
use fredholm::report::book::{Folder, Number, Result, Slide};
use fredholm::report::image::picture::{Picture, auto_gain, gain_label, luminance};
use fredholm::report::plot::{Align, GREY, Words};
use fredholm::report::text::csv::Csv;
use fredholm::scene::Scene;
use fredholm::scene::bsdf::Sampling;

/// This slide.
pub(crate) const SLIDE: Slide = Slide {
    id: "mis",
    topic: "Multiple importance sampling",
    caption: "Four plates, from smooth at the top to rough at the bottom, reflect four lamps of equal power. BSDF \
              sampling is good for smooth plates and large lamps, light sampling for rough plates and small lamps. MIS \
              weighs every sample by both densities. The map shows which technique it takes the light from.",
    scene: "veach-mis",
    program,
};

/// Direct light at the first vertex, in two parts: slot 0 by BSDF sampling, slot 1 by light sampling.
struct Parts(Technique);

impl Parts {
    /// Both parts of the light that leaves `x`, each with its weight.
    fn of<T: Kernel>(&self, t: &T, x: &T::State, scatter: &mut Rng, connect: &mut Rng) -> [Rgb; 2] {
        let hit = t.sample_direction(x, scatter).map_or(Rgb::ZERO, |y| {
            let [p, other] = y.pair;
            y.f * (y.cos / y.pdf) * t.emission(&y.state) * self.0.hit(p, other)
        });
        let connection = t.sample_emitter(x, connect).map_or(Rgb::ZERO, |y| {
            let [p, other] = y.pair;
            y.f * (y.cos / y.pdf) * t.emission(&y.state) * self.0.connection(p, other)
        });
        [hit, connection]
    }
}

impl<T: Kernel> TermEstimator<T> for Parts {
    fn slots(&self) -> usize {
        2
    }

    fn sample<S: Sensor<T>>(&self, job: &Job<'_, T, S>, _: &mut Paths<T::Wave>, sink: &mut impl TermSink) {
        let &Job { t, sensor, batch } = job;
        let mut value = Columns::new(1);
        for sample in batch.samples.clone() {
            for pixel in batch.pixels.clone() {
                let numbers = |purpose| Rng::at(batch.key, pixel, sample, 0, purpose);
                let Some(x) = sensor.start(t, pixel, &mut numbers(Purpose::Start)) else { continue };
                let parts = self.of(t, &x, &mut numbers(Purpose::Scatter), &mut numbers(Purpose::Connect));
                for (slot, part) in parts.into_iter().enumerate() {
                    value.set(0, part);
                    sink.add(slot, &[pixel], &[sample], &value);
                }
            }
        }
    }
}

const BLUE: [f64; 3] = [0.0, 90.0, 181.0];
const ORANGE: [f64; 3] = [230.0, 126.0, 0.0];

/// Colour of a share: blue for 0, white for 1/2, orange for 1; grey where it is not defined.
fn colour(share: f64) -> [u8; 3] {
    if share.is_nan() {
        return [128; 3];
    }
    let end = if share < 0.5 { BLUE } else { ORANGE };
    let t = (2.0 * share - 1.0).abs();
    end.map(|c| (255.0 + t * (c - 255.0)).round() as u8)
}

const TECHNIQUES: [(Technique, &str); 3] = [
    (Technique::Scatter, "BSDF sampling: w_s = 1"),
    (Technique::Connect, "light sampling: w_c = 1"),
    (Technique::Mis, "MIS: w_s + w_c = 1"),
];

fn program(folder: &Folder<'_>) -> Result<()> {
    let size: [u32; 2] = folder.pick([288, 192], [144, 96]);
    let scene = Scene::new(&super::measure::built_in("veach-mis", size)?);
    let spp = folder.pick(32, 16);
    let shots =
        TECHNIQUES.map(|(t, label)| (label, Shot::new(&scene, Sampling::Bsdf, &Parts(t), spp, &t.to_string(), folder)));
    let many = folder.pick(96, 32);
    let weights = Shot::new(&scene, Sampling::Bsdf, &Parts(Technique::Mis), many, "weights", folder);
    let gain = auto_gain(&weights.image(0..2).mean);
    let enlarged = |tile: Tile| tile.enlarged(folder.pick(1, 2));
    let tiles = shots.iter().map(|(label, shot)| {
        let note = format!("noise √V = {}", shot.noise(0..2).words());
        enlarged(Tile::new(size[0], &shot.image(0..2).mean, gain, *label, vec![note]))
    });
    let mut tiles: Vec<Tile> = tiles.collect();
    let (hits, connections) = (weights.image(0..1).mean, weights.image(1..2).mean);
    let share = |(hit, connection): (&[f32; 3], &[f32; 3])| {
        let (s, c) = (luminance(*hit), luminance(*connection));
        s / (s + c)
    };
    let shares: Vec<f64> = hits.iter().zip(&connections).map(share).collect();
    let map = Picture {
        width: size[0] as usize,
        height: size[1] as usize,
        pixels: shares.iter().map(|&s| colour(s)).collect(),
    };
    let (from_hits, direct) = (weights.mean(0..1), weights.mean(0..2));
    let note = format!("whole image: {:.0} % of the direct light", 100.0 * from_hits.value / direct.value);
    tiles.push(enlarged(Tile {
        image: map,
        fine: 1,
        label: "MIS: share from BSDF sampling".into(),
        notes: vec![note],
    }));

    let mut board = Board::new(
        "Two ways to find the light, weighted by their densities",
        "Direct light on four plates, smooth at the top and rough at the bottom, under four lamps of equal power.",
    );
    let right = MARGIN + 2.0 * 288.0 + GAP;
    let top = board.y;
    let lower = tiles.split_off(2);
    board.row(tiles, [MARGIN, right]);
    board.row(lower, [MARGIN, right]);
    let bottom = board.y;
    let variances = shots.each_ref().map(|(_, shot)| shot.variance(0..2));
    let apart = shots[2].1.mean(0..2).minus(shots[0].1.mean(0..2));
    beside(&mut board, (right + 2.0 * GAP, top + 10.0), [spp, many], gain, (variances, apart));
    board.y = bottom;
    check(variances)?;
    let mut csv = Csv::new("technique,spp,mean,std_error,variance,variance_std_error");
    for (label, shot) in &shots {
        let (mean, v) = (shot.mean(0..2), shot.variance(0..2));
        csv.put(label).put(spp).numbers([mean.value, mean.std_error, v.value, v.std_error]).end();
    }
    folder.text("mis.csv", &csv.text())?;
    board.finish(folder, &SLIDE, |_| Ok(()))
}

/// The legend and the result, to the right of the pictures.
fn beside(
    board: &mut Board,
    (x, mut y): (f64, f64),
    [spp, many]: [u32; 2],
    gain: f64,
    (v, apart): ([Number; 3], Number),
) {
    let room = WIDTH - MARGIN - x;
    let mut say = |board: &mut Board, text: &str, size: f64, space: f64| {
        y = board.paragraph(text, (x, y), room, size) + space;
        y
    };
    say(board, "w_s = p_s/(p_s + p_c)", 18.0, 2.0);
    say(board, "w_c = p_c/(p_s + p_c)", 18.0, 8.0);
    say(
        board,
        "p_s, p_c: densities of BSDF sampling and of light sampling for the same direction. The weights sum to 1, so the \
         mean is right.",
        14.0,
        8.0,
    );
    say(
        board,
        &format!("{spp} samples per pixel for each picture, gain {}; {many} for the map.", gain_label(gain)),
        14.0,
        8.0,
    );
    let [scatter, connect, mis] = v;
    let end = say(
        board,
        &format!(
            "Variance of MIS: {} of that of BSDF sampling, {} of that of light sampling. Mean of MIS − mean of BSDF sampling: \
             {} (95 %).",
            mis.over(scatter).words(),
            mis.over(connect).words(),
            apart.words()
        ),
        14.0,
        14.0,
    );
    let (w, h) = (2 * room.floor() as usize, 36);
    let bar = (0..w * h).map(|i| colour(((i % w) as f64 + 0.5) / w as f64)).collect();
    board.picture(Picture { width: w, height: h, pixels: bar }, [x as u32, end as u32], 2);
    let words = Words { size: 13.0, ..Words::default() };
    board.text("0: light sampling", (x, end + 28.0), room / 2.0, words);
    board.text("1: BSDF sampling", (x + room, end + 28.0), room / 2.0, Words { align: Align::Right, ..words });
    let note = Words { size: 13.0, color: GREY, ..Words::default() };
    board.text("share of BSDF sampling; grey: no light", (x, end + 46.0), room, note);
}

/// MIS must be proved less noisy than each of the two techniques.
fn check([scatter, connect, mis]: [Number; 3]) -> Result<()> {
    for other in [scatter, connect] {
        let ratio = mis.over(other);
        if ratio.value + 3.0 * ratio.std_error > 1.0 {
            return Err(format!("MIS is not proved less noisy: ratio of the variances {}", ratio.words()).into());
        }
    }
    Ok(())
}
