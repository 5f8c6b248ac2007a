//! Russian roulette: three rules that end paths, at equal time.
//!
//! ```text
//! continue with probability 1 − q, then divide by it:  E[ 1{continued} X/(1 − q) ] = X      for every q < 1
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | q | probability of termination, tested at vertices 2, 3, … | [`Roulette`] |
//! | none | paths end after K reflections; longer paths are missing | [`Roulette::Never`] |
//! | lecture | q = 0.5 | [`Roulette::LECTURE`] |
//! | albedo | q = 1 − the largest channel of the albedo | [`Roulette::Albedo`] |
//! | V, t | variance of the indirect light 2 ≤ k ≤ K, seconds; efficiency = 1/(V t) | [`Shot`] |
//! | growth | factor per vertex of the second moment of the weight; above 1 the whole sum has infinite variance | [`growth`] |
//!
//! Reference: Arvo and Kirk, *Particle Transport and Image Synthesis* (SIGGRAPH 1990).

use super::board::{Board, Tile};
use super::measure::{Interval, Shot, built_in, in_equal_time, seconds};
use fredholm::engine::{Settings, by_rays};
use fredholm::estimator::{Plan, Prefix, Roulette, Technique};
use fredholm::report::book::{Folder, Number, Result, Slide};
use fredholm::report::half_width_95;
use fredholm::report::image::picture::{auto_gain, gain_label};
use fredholm::report::text::csv::Csv;
use fredholm::report::text::number::{percent, plus_minus, significant};
use fredholm::scene::Scene;
use fredholm::scene::bsdf::Sampling;
use std::ops::Range;

/// This slide.
pub(crate) const SLIDE: Slide = Slide {
    id: "roulette",
    topic: "Russian roulette",
    caption: "Indirect light after the same time, with three rules that end paths. Without roulette all paths have the \
              same length, and the light of longer paths is missing. Roulette makes paths shorter, so more of them fit \
              into the time, and no light is missing. A large q also adds noise, because survivors get a large weight.",
    scene: "cornell",
    program,
};

/// K: the last term with a slot of its own, and the last one of paths without roulette.
const K: usize = 16;
/// Independent populations of walkers from which the engine computes the error of a growth.
const POPULATIONS: u64 = 8;
/// Slots of the indirect light that all three rules find; for every rule its variance is finite.
const INDIRECT: Range<usize> = 2..K + 1;

fn rules() -> [(&'static str, Roulette); 3] {
    [
        ("none: k ≤ 16", Roulette::Never),
        ("lecture: q = 0.5 from vertex 2", Roulette::LECTURE),
        ("albedo: q = 1 − max ρ", Roulette::Albedo { from: 2 }),
    ]
}

fn program(folder: &Folder<'_>) -> Result<()> {
    let size = folder.pick(300, 100);
    let scene = Scene::new(&built_in("cornell", [size, size])?);
    let time = folder.pick(2.5, 0.2);
    let shots = in_equal_time(time, |i, spp, stream| {
        let prefix = Prefix(Plan { max_bounces: K, technique: Technique::Mis, roulette: rules()[i].1.clone() });
        Shot::new(&scene, Sampling::Bsdf, &prefix, spp, stream, folder)
    });
    let [none, lecture, albedo] = &shots;
    let gain = auto_gain(&albedo.image(INDIRECT).mean);
    let mut csv = Csv::new(
        "rule,rays_per_path,spp,seconds,mean,std_error,variance,variance_std_error,efficiency_by_time,efficiency_by_rays",
    );
    let tiles = rules().into_iter().zip(&shots).map(|((name, _), shot)| {
        let relative = shot.efficiency(INDIRECT).over(none.efficiency(INDIRECT));
        let (mean, v) = (shot.mean(INDIRECT), shot.variance(INDIRECT));
        let rays = (none.film.rays.iter().sum::<u64>() as f64) / (shot.film.rays.iter().sum::<u64>() as f64);
        let per_ray = none.variance(INDIRECT).over(v).times(rays);
        let [efficiency, by_rays] =
            [relative, per_ray].map(|r| if std::ptr::eq(shot, none) { "1".into() } else { r.words() });
        let numbers = [shot.seconds, mean.value, mean.std_error, v.value, v.std_error, relative.value, per_ray.value];
        csv.put(name).numbers([shot.rays_per_path()]).put(shot.spp).numbers(numbers).end();
        let notes = vec![
            format!("{} rays per path", significant(shot.rays_per_path(), 3)),
            format!("{} samples per pixel in {}", shot.spp, seconds(shot)),
            format!("noise √V = {}", shot.noise(INDIRECT).words()),
            format!("relative efficiency by time {efficiency}"),
            format!("relative efficiency by rays {by_rays}"),
        ];
        Tile::new(size, &shot.image(INDIRECT).mean, gain, name, notes).enlarged(folder.pick(1, 3))
    });
    let tiles = tiles.collect::<Vec<_>>();
    let mut board = Board::new(
        "Russian roulette: shorter paths, the same mean",
        &format!(
            "Indirect light only, 2 ≤ k ≤ {K}. The same time for each rule; gain {}. Efficiency: 1/(V · seconds) or \
             1/(V · rays); ±: error of V, 95 %.",
            gain_label(gain)
        ),
    );
    board.wide_row(tiles);
    let apart = lecture.mean(INDIRECT).minus(none.mean(INDIRECT));
    let grows = growth(folder)?;
    let tail = albedo.mean(K + 1..K + 2).over(albedo.mean(INDIRECT));
    board.lines(
        &format!(
            "Mean of lecture − mean of none = {}, of albedo − none = {} (95 %). Without roulette, k > {K} is missing: {} \
             of the indirect light. With q = 0.5 the second moment of a path's weight grows by {} per vertex: the variance \
             of the sum over all k is infinite.",
            apart.words(),
            albedo.mean(INDIRECT).minus(none.mean(INDIRECT)).words(),
            percent(tail.value),
            plus_minus(grows.value, half_width_95(grows.std_error, POPULATIONS), 2),
        ),
        14.0,
    );
    if apart.at_most() > 0.05 * albedo.mean(INDIRECT).value {
        return Err(format!("the means are not proved equal to 5 %: difference {}", apart.words()).into());
    }
    if grows.value - 4.0 * grows.std_error < 1.0 {
        return Err(format!("the variance is not proved infinite for q = 0.5: growth {}", grows.words()).into());
    }
    if albedo.rays_per_path() >= none.rays_per_path() {
        return Err("paths with roulette are not shorter".into());
    }
    folder.text("roulette.csv", &csv.text())?;
    board.finish(folder, &SLIDE, |_| Ok(()))
}

/// Growth of the second moment of a path's weight per vertex with the lecture's roulette, as the engine measures it.
fn growth(folder: &Folder<'_>) -> Result<Number> {
    let scene = Scene::new(&built_in("cornell", [16, 16])?);
    let roulette = Roulette::LECTURE;
    let settings = Settings { spp: 16, max_bounces: 2, roulette, seed: folder.seed, ..Settings::default() };
    let found = by_rays::terms(&scene, by_rays::Estimator::Prefix, &settings, folder.progress);
    let growth = found.doubt.ok_or("no growth of the weights was measured")?;
    Ok(Number { value: growth.rate, std_error: growth.std_error })
}
